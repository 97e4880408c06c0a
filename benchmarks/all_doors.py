#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The books of the deadlines of the crane at 1 kHz, bare and with all doors open at once, side by side.

benchmarks/all_doors.py BUILD_DIRECTORY [ROUNDS=3] [SECONDS=20]

Doors: a joystick (recorded events) slews; packets by UDP at 1 kHz lift and show; the LCM bridge publishes all variables;
sensors; a motion platform at 200 Hz. Bare and open sessions alternate within a round, so that other load meets both. Each
open session is then computed again from its ticks alone, without any door: the physics has the same bits, or the
benchmark fails. Needs LCM, and unshare and ip for a network of its own. Quote the figures with the load below them.
"""
import binascii
import json
import math
import os
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
from paced_crane import finish_session, print_load, scene_path, start_session  # noqa: E402

DOMAIN = "95"
GROUP = "239.255.76.67"  # of LCM
RIG, DASH, SEAT = 5105, 5106, 5107  # ports
STICK = struct.Struct("<qqHHi")
DOORS = """include: {sensors}
scene: all_doors
session: {{duration: 0}}
recording: {{every: 1}}
script: {{inputs: {{Input_Lift: [[0 s, 0]], Input_Slew: [[0 s, 0]]}}}}
devices:
  Stick:
    type: joystick
    path: {stick}
    block: 0
    axes: [{{code: ABS_X, channel: 0, lowest: 0, centre: 512, highest: 1023, dead_zone: 0.05}}]
    dead_man: BTN_TRIGGER
  Rig:
    type: udp_in
    listen: 127.0.0.1:{rig}
    most_lost: 1000
    timeout: 200 ms
    fields:
      - {{name: count, as: uint16, is: sequence}}
      - {{name: enable, as: uint8}}
      - {{name: lift, as: float32, input: Input_Lift}}
      - {{name: check, as: uint16, is: crc16_ccitt}}
    dead_man: enable
  Dash:
    type: udp_out
    send: 127.0.0.1:{dash}
    every: 1 ms
    fields: [{{name: stroke, as: float64, variable: Cyl_Lift.stroke}}, {{name: force, as: float64, variable: Cyl_Lift.force}}]
"""


def write_stick(path, seconds):
    """A trigger that is held, and an axis that sweeps 100 times a second."""
    data = b""
    begin = 1_700_000_000

    def report(at, *events):
        micros = round(at * 1e6)
        for kind, code, value in (*events, (0, 0, 0)):
            yield STICK.pack(begin + micros // 1_000_000, micros % 1_000_000, kind, code, value)

    data += b"".join(report(0.2, (1, 288, 1)))
    for i in range(100 * seconds):
        data += b"".join(report(0.5 + i / 100, (3, 0, 512 + round(400 * math.sin(0.5 * i / 100)))))
    with open(path, "wb") as file:
        file.write(data)


def write_scene(folder, seconds):
    """A copy of the scenes; in it the sensors' scene, the devices above, and truck_crane_platform.yaml's on its port."""
    scenes = shutil.copytree(scene_path(""), f"{folder}/scenes")  # a scene includes what lies beside it
    write_stick(f"{folder}/stick.events", seconds)
    with open(scene_path("truck_crane_platform.yaml"), encoding="utf-8") as file:
        platform = file.read().split("devices:\n")[1].replace("127.0.0.1:6000", f"127.0.0.1:{SEAT}")
    with open(f"{scenes}/all_doors.yaml", "w", encoding="utf-8") as file:
        file.write(DOORS.format(sensors="truck_crane_sensors.yaml", stick=f"{folder}/stick.events", rig=RIG,
                                dash=DASH) + platform)
    return f"{scenes}/all_doors.yaml"


class OtherSide:
    """Sends to Rig each millisecond, and takes the packets of Dash and Seat."""

    def __init__(self):
        self.received = {DASH: 0, SEAT: 0}
        self.sent = 0
        self.is_over = threading.Event()
        self.threads = [threading.Thread(target=self.send), *(threading.Thread(target=self.receive, args=(port,))
                                                              for port in self.received)]
        for thread in self.threads:
            thread.start()

    def send(self):
        link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        due = time.monotonic()
        while not self.is_over.is_set():
            lift = 0.6 * math.sin(self.sent / 1000) if self.sent > 4000 else 0.0
            body = struct.pack("<HBf", self.sent & 0xFFFF, self.sent > 3000, lift)
            link.sendto(body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF)), ("127.0.0.1", RIG))
            self.sent += 1
            due = max(due + 1e-3, time.monotonic() - 0.05)
            time.sleep(max(0.0, due - time.monotonic()))

    def receive(self, port):
        link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        link.bind(("127.0.0.1", port))
        link.settimeout(0.2)
        while not self.is_over.is_set():
            try:
                link.recv(2048)
                self.received[port] += 1
            except socket.timeout:
                pass

    def end(self):
        self.is_over.set()
        for thread in self.threads:
            thread.join()


def bare(bin_folder, seconds, folder):
    return finish_session(start_session(bin_folder, scene_path("truck_crane.yaml"), "real", seconds, folder, DOMAIN,
                                        "--set", "recording.every=1"))


def with_all_doors(bin_folder, seconds, folder):
    scene = write_scene(folder, seconds)
    other_side = OtherSide()
    try:
        with open(f"{folder}/run.err", "w", encoding="utf-8") as err, open(f"{folder}/lcm.out", "w", encoding="utf-8") as out:
            process = start_session(bin_folder, scene, "real", seconds, folder, DOMAIN, stderr=err)
            # it waits 3 s for its session, as long as that is not up
            bridge = subprocess.Popen([bin_folder + "/slewring", "bridge", "lcm", "--session", f"bench{os.getpid()}",
                                       "--domain", DOMAIN], stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT)
            report = finish_session(process)
            bridge.wait(30)
    finally:
        other_side.end()
    with open(f"{folder}/lcm.out", encoding="utf-8") as file:
        bridged = file.read().strip().split("\n")
    if process.returncode not in (0, 3) or bridge.returncode != 0:
        with open(f"{folder}/run.err", encoding="utf-8") as file:
            sys.exit(f"code {process.returncode}, of the bridge {bridge.returncode}:\n{file.read()}" + "\n".join(bridged))
    check_doors(report, other_side)
    verified = subprocess.run([bin_folder + "/slewring", "replay", report["recording"], "--verify"], capture_output=True,
                              text=True, cwd=folder)
    if verified.returncode != 0:
        sys.exit(f"the physics with all doors open differs from that of its ticks alone:\n{verified.stdout}{verified.stderr}")
    return report, other_side, bridged, verified.stdout.strip().split("\n")[-1]


def check_doors(report, other_side):
    """A door that was closed costs nothing, and proves nothing."""
    summaries = {name: device["summary"] for name, device in report["devices"].items()}
    for name, device in report["devices"].items():
        if device["fault"] or device["hangs"] or device["summary"] is None:
            sys.exit(f"device {name}: {device}")
    closed = [name for name, is_closed in {
        "Stick": summaries["Stick"]["inputs"]["latency"]["count"] == 0,
        "Rig": summaries["Rig"]["inputs"]["latency"]["count"] == 0,
        "Dash": other_side.received[DASH] == 0,
        "Seat": other_side.received[SEAT] == 0 or summaries["Seat"]["packets"]["platform"]["active_steps"] == 0,
        "sensors": "sensor" not in report["nodes"]}.items() if is_closed]
    if closed:
        sys.exit(f"{', '.join(closed)} did nothing: {json.dumps(summaries, indent=1)}")


def row(name, report):
    books = report["deadline"]
    response = books["response"]
    missed = 100 * books["overruns"] / max(1, response["count"])
    cells = [name, books["steps_due"], books["steps_run"], books["steps_skipped"], books["overruns"], f"{missed:.3f}",
             books["longest_overrun"], *(f"{response[key] * 1e6:.0f}" for key in ("p50", "p99", "p999", "max")),
             f"{books['lag'] * 1e3:.1f}", "yes" if books["books_balance"] else "NO"]
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def latency(summary):
    times = summary["inputs"]["latency"]
    return f"{times['count']} events, " + ", ".join(f"{key} {times[key] * 1e3:.2f} ms" for key in ("p50", "p99", "max"))


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.split("\n\n")[1])
    for program in ("unshare", "ip"):
        if shutil.which(program) is None:
            sys.exit(f"{program} is not there; LCM needs a network with a route for its group: install util-linux and iproute2")
    if os.environ.get("SLEWRING_ALL_DOORS_INSIDE") is None:
        environment = dict(os.environ, SLEWRING_ALL_DOORS_INSIDE="1")
        sys.exit(subprocess.run(["unshare", "-rn", sys.executable, *sys.argv], env=environment).returncode)
    subprocess.run(["ip", "link", "set", "lo", "up", "multicast", "on"], check=True)
    subprocess.run(["ip", "route", "add", f"{GROUP}/32", "dev", "lo"], check=True)
    bin_folder = os.path.abspath(sys.argv[1]) + "/bin"
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    print("| session | due | run | skipped | missed | % | in a row | response p50 [us] | p99 | p99.9 | max | lag [ms] | "
          "books balance |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|")
    notes = []
    for number in range(1, rounds + 1):
        with tempfile.TemporaryDirectory(prefix="slewring_doors_") as folder:
            print(row(f"bare {number}", bare(bin_folder, seconds, folder)), flush=True)
            report, other_side, bridged, verified = with_all_doors(bin_folder, seconds, folder)
            print(row(f"all doors {number}", report), flush=True)
        devices = {name: device["summary"] for name, device in report["devices"].items()}
        notes.append(f"round {number}: from an event to the first sample: Stick {latency(devices['Stick'])}; Rig "
                     f"{latency(devices['Rig'])}")
        notes.append(f"round {number}: {other_side.sent} packets to Rig, {devices['Rig']['packets']['used']} used; "
                     f"{other_side.received[DASH]} of Dash, {other_side.received[SEAT]} of Seat "
                     f"({devices['Seat']['packets']['platform']['active_steps']} active); bridge: {bridged[-1]}")
        notes.append(f"round {number}: computed again from its ticks alone: {verified}")
    print("\n".join(notes))
    print_load()


if __name__ == "__main__":
    main()
