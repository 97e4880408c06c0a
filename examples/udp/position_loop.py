#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Closes a position loop on the lift cylinder of scenes/truck_crane_devices.yaml, by UDP alone:

    position_loop.py --target 0.86

The packets are those of the scene's devices Dash (received here) and Rig (sent from here). Nothing of Slewring is used:
a program in any language, Simulink or a PLC does the same.
"""
import argparse
import binascii
import math
import socket
import struct
import sys
import time

DASH = struct.Struct("<IdfBf")  # count, stroke [m], force [N], lamps, gauge [mA]
RIG = struct.Struct("<HBf")     # count, enable, lift; then the checksum


def main():
    parser = argparse.ArgumentParser(description="Closes a position loop by UDP.")
    parser.add_argument("--target", type=float, default=0.86, help="stroke of the lift cylinder [m]")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="[m]")
    parser.add_argument("--listen", type=int, default=5006, help="port of Dash.send")
    parser.add_argument("--send", type=int, default=5005, help="port of Rig.listen")
    parser.add_argument("--seconds", type=float, default=60, help="gives up after this wall time")
    o = parser.parse_args()

    def stick(stroke):
        error = o.target - stroke
        if abs(error) < 0.5 * o.tolerance:
            return 0.0
        # the valve does nothing below 0.32
        return math.copysign(0.32 + 0.68 * min(1.0, abs(20 * error)), error)

    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.bind(("127.0.0.1", o.listen))
    link.settimeout(0.5)
    end = time.monotonic() + o.seconds
    sent = received = steady = armed = still = 0
    stroke, lamps = math.nan, 0
    while steady < 100 and time.monotonic() < end:
        try:
            packet = link.recv(2048)
        except socket.timeout:
            continue  # no session, or a pause
        if len(packet) != DASH.size:
            sys.exit(f"a packet of Dash has {DASH.size} bytes, this one {len(packet)}")
        before = stroke
        _, stroke, _, lamps, _ = DASH.unpack(packet)
        received += 1
        armed += 1
        # the dead-man input is pressed after a while at neutral: pressed from the start it would not count. A machine
        # that does not follow was put to neutral, after a silence for instance: release it and press it again
        still = still + 1 if armed > 40 and stick(stroke) != 0 and abs(stroke - before) < 1e-7 else 0
        if still > 50:
            armed = still = 0
        body = RIG.pack(sent & 0xFFFF, armed > 20, stick(stroke) if armed > 40 else 0.0)
        link.sendto(body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF)), ("127.0.0.1", o.send))
        sent += 1
        steady = steady + 1 if abs(o.target - stroke) < o.tolerance else 0
    print(f"stroke {stroke:.5f} m, target {o.target:.5f} m: {'reached' if steady >= 100 else 'not reached'}; "
          f"pressure lamp {'on' if lamps & 1 else 'off'}; {received} packets received, {sent} sent")
    return 0 if steady >= 100 else 1


if __name__ == "__main__":
    sys.exit(main())
