#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""examples/controller/position_controller.cpp in Python: the same loop on the same library.

    position_controller.py --session truck_crane --target 0.86
"""

import argparse
import math
import sys
import time

import slewring_client


def main():
    parser = argparse.ArgumentParser(description="Closes a position loop on a cylinder of a running session.")
    parser.add_argument("--session", required=True)
    parser.add_argument("--variable", default="Cyl_Lift.stroke")
    parser.add_argument("--channel", default="Input_Lift")
    parser.add_argument("--name", default="position_controller")
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--target", type=float, default=0.86, help="unit of the variable")
    parser.add_argument("--tolerance", type=float, default=1e-3, help="unit of the variable")
    parser.add_argument("--gain", type=float, default=20, help="stick per unit of error")
    parser.add_argument("--overlap", type=float, default=0.32, help="the valve does nothing below this stick value")
    parser.add_argument("--seconds", type=float, default=15, help="gives up after this wall time")
    o = parser.parse_args()

    def stick(value):
        error = o.target - value
        if abs(error) < 0.5 * o.tolerance:
            return 0.0
        share = min(1.0, abs(o.gain * error))
        return math.copysign(o.overlap + (1 - o.overlap) * share, error)

    begin = time.monotonic()
    with slewring_client.Session(o.session, o.name, o.domain, timeout=o.seconds) as session:
        variable = session.find(o.variable)
        channel = session.acquire(o.channel)
        steady = 0
        while steady < 100 and time.monotonic() - begin < o.seconds:
            try:
                if not session.step(1.0):
                    break
            except slewring_client.Error as error:
                if error.code == slewring_client.TIMEOUT:
                    continue  # a pause
                raise
            session.write(channel, stick(session.value(variable)))
            steady = steady + 1 if abs(o.target - session.value(variable)) < o.tolerance else 0
        print(f"{o.variable} = {session.value(variable):.5f}, target {o.target:.5f}: "
              f"{'reached' if steady >= 100 else 'not reached'}")
        return 0 if steady >= 100 else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except slewring_client.Error as error:
        kind = {slewring_client.REFUSED: "refused: ", slewring_client.TIMEOUT: "timeout: "}.get(error.code, "")
        sys.exit(f"position_controller: {kind}{error}")
