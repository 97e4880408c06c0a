#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A live crane and its devices, with other programs on the other side:

devices_test.py SOURCES SLEWRING CASE
"""
import binascii
import json
import os
import re
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from domains import take_domain  # noqa: E402
from waiting import DEADLINE, require, skip, text_of, wait_for  # noqa: E402

SOURCES, SLEWRING, CASE = sys.argv[1:4]
SCENE = f"{SOURCES}/scenes/truck_crane_devices.yaml"
EV_SYN, EV_KEY, EV_ABS = 0, 1, 3
ABS_X, ABS_Y, BTN_TRIGGER = 0, 1, 288


def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def event(time_us, kind, code, value):
    return struct.pack("<qqHHi", time_us // 1_000_000, time_us % 1_000_000, kind, code, value)


def report(time_us, *events):
    return b"".join(event(time_us, *e) for e in events) + event(time_us, EV_SYN, 0, 0)


class Crane:
    """A run of the scene as processes."""

    def __init__(self, folder, domain, *more):
        self.folder, self.domain = folder, domain
        self.rig, self.dash = free_port(), free_port()
        self.process = None
        # a machine under load may stop a process for longer than the scene allows
        self.arguments = [SLEWRING, "run", SCENE, "--set", "session.give_up_after=60", "--domain", domain,
                          "--out", f"{folder}/runs", "--quiet", "--json", "--set", "Rig.timeout=5s",
                          "--set", f"Rig.listen=127.0.0.1:{self.rig}", "--set", f"Dash.send=127.0.0.1:{self.dash}", *more]

    def start(self):
        with open(f"{self.folder}/run.out", "w") as out, open(f"{self.folder}/run.err", "w") as err:
            self.process = subprocess.Popen(self.arguments, stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                            cwd=self.folder)

    def err(self):
        return text_of(f"{self.folder}/run.err")

    def wait_for_line(self, part):
        wait_for(f"'{part}' in {self.err()}",
                 lambda: part in self.err() or (self.process.poll() is not None and sys.exit(
                     f"FAILED: the run ended with {self.process.poll()} before '{part}':\n{self.err()}")))

    def device_pid(self, name):
        for entry in os.listdir("/proc"):
            if not entry.isdigit():
                continue
            try:
                words = open(f"/proc/{entry}/cmdline", "rb").read().split(b"\0")
                parent = int(open(f"/proc/{entry}/stat").read().rsplit(")", 1)[1].split()[1])
            except OSError:
                continue
            if parent == self.process.pid and words[1:3] == [b"--device", name.encode()]:
                return int(entry)
        return None

    def wait_for_value(self, name, expected):
        """Until the session has published it; the recording then has it too."""
        def is_published():
            done = subprocess.run([SLEWRING, "watch", name, "--session", "truck_crane_devices", "--domain",
                                   self.domain, "--count", "1", "--json"], capture_output=True, text=True)
            return done.returncode == 0 and json.loads(done.stdout)["values"].get(name) == expected

        wait_for(f"{name} = {expected}", is_published)

    def stop(self, code):
        if self.process.poll() is None:
            done = subprocess.run([SLEWRING, "control", "stop", "--session", "truck_crane_devices", "--domain",
                                   self.domain], capture_output=True, text=True, timeout=DEADLINE)
            require(done.returncode == 0, f"stop: {done.stdout}{done.stderr}")
        self.process.wait(DEADLINE)
        require(self.process.returncode == code, f"the run ended with {self.process.returncode}, not {code}:\n{self.err()}")
        return json.loads(text_of(f"{self.folder}/run.out"))

    def kill(self):
        if self.process is not None and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()


def slewing_events(path):
    """A joystick that is enabled, pushed to the left, and let go."""
    begin = 1_700_000_000_000_000
    data = report(begin + 500_000, (EV_KEY, BTN_TRIGGER, 1))
    for i in range(100):
        data += report(begin + 1_000_000 + 10_000 * i, (EV_ABS, ABS_X, 512 - 5 * i))
    data += report(begin + 4_000_000, (EV_ABS, ABS_X, 512))
    data += report(begin + 600_000_000, (EV_KEY, BTN_TRIGGER, 0))
    with open(path, "wb") as file:
        file.write(data)


def value_at_end(result, name):
    path = result["recording"]
    done = subprocess.run([SLEWRING, "export", path, name, "--csv"], capture_output=True, text=True,
                          timeout=DEADLINE)
    require(done.returncode == 0, f"export: {done.stdout}{done.stderr}")
    return [float(line.split(",")[1]) for line in done.stdout.strip().split("\n") if re.match(r"[0-9]", line)]


def case_closed_loop(folder, domain):
    slewing_events(f"{folder}/stick.events")
    crane = Crane(folder, domain, "--set", f"Stick.path={folder}/stick.events", "--set", 'Stick.match=""')
    try:
        crane.start()
        crane.wait_for_line("device Rig: listens on")
        crane.wait_for_line("device Dash: sends to")
        for target in ("0.82", "0.84"):
            peer = subprocess.run([sys.executable, f"{SOURCES}/examples/udp/position_loop.py", "--target", target,
                                   "--listen", str(crane.dash), "--send", str(crane.rig), "--seconds", str(DEADLINE)],
                                  capture_output=True, text=True, timeout=DEADLINE + 20)
            print(peer.stdout, end="")
            require(peer.returncode == 0, f"the peer did not reach {target}:\n{peer.stdout}{peer.stderr}\n{crane.err()}")
            require(re.search(r"stroke 0\.[0-9]+ m.*: reached", peer.stdout), peer.stdout)
            # the peer is silent now: neutral, and the next one begins its sequence again
            crane.wait_for_line("device Rig: no values: its inputs go to neutral")
        # false packets are counted by cause and move nothing
        link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        link.sendto(b"short", ("127.0.0.1", crane.rig))
        link.sendto(b"x" * 100, ("127.0.0.1", crane.rig))
        link.sendto(struct.pack("<HBfH", 7, 1, 1.0, 1), ("127.0.0.1", crane.rig))
        stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        stranger.bind(("127.0.0.2", 0))
        stranger.sendto(struct.pack("<HBfH", 7, 1, 1.0, 1), ("127.0.0.1", crane.rig))
        crane.wait_for_line("packets from 127.0.0.2 are refused; to accept them, add it to Rig.from")
        crane.wait_for_line("wrong checksum")
        result = crane.stop(0)
    finally:
        crane.kill()
    rig, stick, dash = (result["devices"][name]["summary"] for name in ("Rig", "Stick", "Dash"))
    print("latency Rig", rig["inputs"]["latency"], "Stick", stick["inputs"]["latency"])
    refused = rig["packets"]["refused"]
    for cause in ("too short", "too long", "wrong checksum", "sender not in from"):
        require(refused[cause] == 1, f"{cause}: {refused}")
    require(refused["not finite"] == 0, f"{refused}")
    require(rig["packets"]["used"] > 200, f"{rig}")
    require(rig["inputs"]["silences"] >= 1 and rig["inputs"]["enable_losses"] >= 1, f"{rig}")
    for one in (rig, stick):
        require(one["inputs"]["latency"]["count"] > 0, f"{one}")
        require(0 < one["inputs"]["latency"]["p50"] <= one["inputs"]["latency"]["p99"], f"{one}")
    require(dash["packets"]["sent"] > 200 and dash["packets"]["not_finite"] == 0, f"{dash}")
    changes = dash["packets"]["output_changes"]["Lamp_Pressure"]
    require(changes >= 1, f"{dash}")
    # the recording has them too: as many as the device made, unless it missed blocks
    done = subprocess.run([SLEWRING, "info", "--json", result["recording"]], capture_output=True, text=True,
                          timeout=DEADLINE)
    require(done.returncode == 0, done.stderr)
    lamp = [e["text"] for e in json.loads(done.stdout)["events"] if e["text"].startswith("output Lamp_Pressure goes ")]
    require(lamp and lamp[0].endswith("on") and all(a != b for a, b in zip(lamp, lamp[1:])), f"{lamp}")
    require(dash["packets"]["incomplete_steps"] > 0 or len(lamp) >= changes, f"{lamp}, {changes}")
    require(stick["events"]["reports"] >= 102, f"{stick}")
    raw = value_at_end(result, "Input_Slew.raw")
    # (512 - 495 counts)/512, the dead zone of 5 % stretched: -(495/512 - 0.05)/0.95
    require(abs(min(raw) + (495 / 512 - 0.05) / 0.95) < 1e-9, f"smallest raw value {min(raw)}")
    require(raw[0] == 0 and raw[-1] == 0, f"{raw[0]} {raw[-1]}")
    angle = value_at_end(result, "Body_Pillar.position")
    # how far depends on how far the session came while the recorded stick was held; at rest it turns by 3e-4 rad
    require(angle[-1] < angle[0] - 5e-3, f"the crane did not slew with the stick: {angle[0]} to {angle[-1]}")


def case_dead_or_hanging(folder, domain):
    crane = Crane(folder, domain)
    try:
        crane.start()
        crane.wait_for_line("device Stick: waiting for a device named '*Joystick*' in /dev/input")
        crane.wait_for_line("device Rig: listens on")
        link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

        def send(count, enable, lift):
            body = struct.pack("<HBf", count, enable, lift)
            link.sendto(body + struct.pack("<H", binascii.crc_hqx(body, 0xFFFF)), ("127.0.0.1", crane.rig))

        count = 0

        def push_until(part):
            nonlocal count

            def step():
                nonlocal count
                for _ in range(5):
                    send(count & 0xFFFF, count > 20, 0.5 if count > 40 else 0.0)
                    count += 1
                    time.sleep(0.005)
                return part in crane.err()

            wait_for(part, step)

        push_until("device Rig: enabled")
        for _ in range(100):
            push_until("device Rig: enabled")
        hanging = wait_for("Rig's process", lambda: crane.device_pid("Rig"))
        os.kill(hanging, signal.SIGSTOP)
        crane.wait_for_line(f"device Rig (process {hanging}) has given no sign of life for 2 s; its inputs are at neutral")
        os.kill(hanging, signal.SIGCONT)
        crane.wait_for_line("device Rig: answers again")
        os.kill(hanging, signal.SIGKILL)
        crane.wait_for_line(f"device Rig (process {hanging}) was killed by signal 9 (Killed); its inputs go to neutral")
        crane.wait_for_value("Input_Lift.raw", 0)
        result = crane.stop(3)
    finally:
        crane.kill()
    rig = result["devices"]["Rig"]
    require("killed by signal 9" in rig["fault"] and rig["hangs"] == 1 and rig["summary"] is None, f"{rig}")
    require(result["devices"]["Stick"]["fault"] == "", f"{result['devices']}")
    raw = value_at_end(result, "Input_Lift.raw")
    require(max(raw) == 0.5 and raw[-1] == 0, f"{max(raw)} {raw[-1]}")
    # ticks went on all the time
    require(result["lost"] == "none" and result["deadline"]["books_balance"], f"{result['lost']} {result['deadline']}")


def case_without_a_scene(folder, domain):
    """A session that has no devices, and a device from a file of its own."""
    port = free_port()
    with open(f"{folder}/dash.yaml", "w") as file:
        file.write("outputs:\n  Lamp: {type: switched, condition: Cyl_Lift.stroke > 10 mm}\n"
                   f"devices:\n  Panel:\n    type: udp_out\n    send: 127.0.0.1:{port}\n    byte_order: big\n"
                   "    fields: [{name: stroke, as: float64, variable: Cyl_Lift.stroke}, {name: lamp, as: uint8, output: Lamp}]\n")
    with open(f"{folder}/wrong.yaml", "w") as file:
        file.write("outputs:\n  Lamp: {type: switched, condition: Cyl_Lift.stroke > 10 bar}\n"
                   f"devices:\n  Panel: {{type: udp_out, send: 127.0.0.1:{port}, fields: [{{name: lamp, output: Lamp}}]}}\n")
    crane = Crane(folder, domain, "--without-devices")
    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.bind(("127.0.0.1", port))
    link.settimeout(DEADLINE)
    common = ["--domain", domain, "--session-timeout", str(DEADLINE)]
    device = None
    try:
        crane.start()
        done = subprocess.run([SLEWRING, "device", "run", "Panel", "--devices", "wrong.yaml", "--session",
                               "truck_crane_devices", *common], capture_output=True, text=True, cwd=folder,
                              timeout=2 * DEADLINE)
        require(done.returncode == 2 and "Lamp.condition: 'Cyl_Lift.stroke' is in m, not in bar" in done.stderr,
                f"{done.returncode} {done.stdout}{done.stderr}")
        done = subprocess.run([SLEWRING, "device", "run", "Panle", "--devices", "dash.yaml", *common],
                              capture_output=True, text=True, cwd=folder, timeout=2 * DEADLINE)
        require(done.returncode == 2 and "dash.yaml has no device 'Panle'; nothing was started; did you mean 'Panel'?" in
                done.stderr, f"{done.returncode} {done.stdout}{done.stderr}")
        device = subprocess.Popen([SLEWRING, "device", "run", "Panel", "--devices", "dash.yaml", "--json", *common],
                                  stdout=subprocess.PIPE, text=True, cwd=folder)
        packets = [link.recv(100) for _ in range(50)]
        result = crane.stop(0)
        out, _ = device.communicate(timeout=DEADLINE)
        require(device.returncode == 0, out)
    finally:
        crane.kill()
        if device is not None and device.poll() is None:
            device.kill()
    require(result["devices"] == {}, f"{result['devices']}")
    stroke = value_at_end(result, "Cyl_Lift.stroke")
    seen = [struct.unpack(">dB", packet) for packet in packets]
    require(all(value in stroke for value, _ in seen), f"{seen[0]} is not among the recorded values")
    require(seen[-1][1] == 1, f"{seen[-1]}")


def case_verbs(folder, domain):
    def run(*arguments, code=0, **more):
        done = subprocess.run([SLEWRING, "device", *arguments], capture_output=True, text=True, cwd=folder,
                              timeout=DEADLINE, **more)
        require(done.returncode == code, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}")
        return done.stdout + done.stderr

    listed = json.loads(run("list", SCENE, "--json"))
    require([one["type"] for one in listed] == ["joystick", "udp_in", "udp_out"], f"{listed}")
    run("list")
    # at rest, to both ends, at rest again
    begin = 1_700_000_000_000_000
    data = report(begin, (EV_ABS, ABS_X, 512), (EV_ABS, ABS_Y, 100))
    counts = [512] * 3 + [512 - 40 * i for i in range(11)] + [112 + 44 * i for i in range(19)] + [512]
    for i, value in enumerate(counts):
        data += report(begin + 1_300_000 + 25_000 * i, (EV_ABS, ABS_X, value), (EV_ABS, ABS_Y, value // 5))
    with open(f"{folder}/stick.events", "wb") as file:
        file.write(data)
    # the end of the recorded events ends the motion; standard input is closed and gives no Enter
    without_enter = subprocess.Popen([SLEWRING, "device", "calibrate", "stick.events"], stdin=subprocess.DEVNULL,
                                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, cwd=folder)
    try:
        require("not all axes were moved" in run("calibrate", "stick.events", "--ends-time", "0.1", code=2), "no refusal")
        out = without_enter.communicate(timeout=DEADLINE)[0]
    finally:
        without_enter.kill()
    print(out)
    require(without_enter.returncode == 0, out)
    require(re.search(r"code: ABS_X, channel: 0, lowest: 112, centre: 512, highest: 904, dead_zone: 0\.[0-9]+", out), out)
    require(re.search(r"code: ABS_Y, channel: 1, lowest: 22, ", out), out)
    out = run("monitor", "stick.events", "--duration", "3", "--every", "0")
    require("ABS_X +1.000 (904)" in out and "ABS_X -1.000 (112)" in out and "the recorded events are over" in out, out)
    out = run("monitor", "nothing", code=2)
    require("nothing: No such file or directory; nothing was read" in out, out)
    header = run("layout", SCENE, "Dash")
    with open(f"{folder}/size.c", "w") as file:
        file.write(header + "\n#include <stdio.h>\nint main(void) { printf(\"%zu\\n\", sizeof(struct Dash)); return 0; }\n")
    if subprocess.run(["cc", "--version"], capture_output=True).returncode == 0:
        subprocess.run(["cc", "-std=c11", "-o", f"{folder}/size", f"{folder}/size.c"], check=True, timeout=DEADLINE)
        size = int(subprocess.run([f"{folder}/size"], capture_output=True, text=True, check=True).stdout)
        require(size == struct.calcsize("<IdfBf"), f"{size} bytes in C")
    require("UDP" in run("layout", SCENE, "Rig", "--simulink"), "no note for Simulink")
    out = run("layout", SCENE, "Stick", code=2)
    require("the scene has no udp_in, udp_out or motion_platform 'Stick'; nothing was done" in out, out)


MACHINE = """BO_ 256 Panel: 4 X
 SG_ Lift : 0|16@1- (0.5,0) [-100|100] "%" X
 SG_ Enable : 16|1@1+ (1,0) [0|0] "" X
BO_ 257 Load: 8 X
 SG_ Force : 7|32@0- (1,0) [0|0] "N" X
"""


def write_panel(folder, bus):
    os.makedirs(folder, exist_ok=True)
    with open(f"{folder}/machine.dbc", "w") as file:
        file.write(MACHINE)
    with open(f"{folder}/panel.yaml", "w") as file:
        file.write("devices:\n  Panel:\n    type: can_in\n    " + bus + "\n    database: machine.dbc\n    dead_man: Panel.Enable\n"
                   "    signals: [{signal: Panel.Lift, input: Input_Lift, gain: 0.01}, {signal: Panel.Enable}]\n"
                   "  Load:\n    type: can_out\n    interface: slewvcan\n    database: machine.dbc\n"
                   "    signals: [{signal: Load.Force, variable: Cyl_Lift.force}]\n")


def panel_frame(lift_percent, enable):
    return struct.pack("<hBB", round(lift_percent / 0.5), enable, 0).hex().upper()


def case_recorded_can(folder, domain):
    write_panel(f"{folder}/panel", "path: panel.log")
    with open(f"{folder}/panel/panel.log", "w") as file:
        for i in range(200):
            lift = 0 if i < 50 else min(50, i - 50)
            file.write(f"({1700000000 + i // 50}.{20000 * (i % 50):06d}) can0 100#{panel_frame(lift, i >= 25)}\n")
    crane = Crane(folder, domain, "--without-devices")
    try:
        crane.start()
        device = subprocess.Popen([SLEWRING, "device", "run", "Panel", "--devices", "panel/panel.yaml", "--session",
                                   "truck_crane_devices", "--domain", domain, "--session-timeout", str(DEADLINE),
                                   "--json"], stdout=open(f"{folder}/panel.out", "w"), stderr=subprocess.STDOUT, cwd=folder)
        wait_for("the end of the frames", lambda: "the recorded frames are over" in text_of(f"{folder}/panel.out"))
        wait_for("neutral", lambda: "no values: its inputs go to neutral" in text_of(f"{folder}/panel.out"))
        crane.wait_for_value("Input_Lift.raw", 0)
        result = crane.stop(0)
        device.wait(DEADLINE)
    finally:
        crane.kill()
    out = text_of(f"{folder}/panel.out")
    require(device.returncode == 0, out)
    summary = json.loads(out[out.index("\n{") + 1:])
    require(summary["frames"]["used"] == 200 and summary["inputs"]["latency"]["count"] > 0, f"{summary}")
    raw = value_at_end(result, "Input_Lift.raw")
    require(max(raw) == 0.5 and raw[-1] == 0, f"{max(raw)} {raw[-1]}")


BALL = """bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Free: {type: floating, body2: Ball}
forces:
  Push: {type: point_force, body: Ball, force: 1 N, direction: [1, 0, 0]}
inputs:
  Input_Push: {type: analog, primitive: Push, block: 0, channel: 0}
session: {duration: 0}
devices:
  Stick:
    type: joystick
    path: stick.events
    axes: [{code: ABS_X, channel: 0, lowest: 0, centre: 512, highest: 1024}]
  Dash:
    type: udp_out
    send: 127.0.0.1:PORT
    fields: [{name: count, as: uint8, is: sequence}, {name: push, as: float64, variable: Input_Push.raw}]
"""


def case_recorded_files(folder, domain):
    """The file is beside the scene, and every program runs in another folder; a monitor shows what another device sends."""
    os.mkdir(f"{folder}/joy")
    with open(f"{folder}/joy/ball.yaml", "w") as file:
        file.write(BALL.replace("PORT", str(free_port())))
    missing = subprocess.run([SLEWRING, "check", "joy/ball.yaml"], capture_output=True, text=True, cwd=folder,
                             timeout=DEADLINE)
    require(missing.returncode == 2 and "Stick.path: there is no file 'joy/stick.events'" in missing.stderr,
            f"{missing.returncode} {missing.stdout}{missing.stderr}")
    with open(f"{folder}/joy/stick.events", "wb") as file:
        file.write(report(1_700_000_000_000_000, (EV_ABS, ABS_X, 768)))
    shown = subprocess.run([SLEWRING, "device", "monitor", "Stick", "--scene", "joy/ball.yaml", "--duration", "0.1"],
                           capture_output=True, text=True, cwd=folder, timeout=DEADLINE)
    require(shown.returncode == 0 and "reads joy/stick.events" in shown.stdout, f"{shown.stdout}{shown.stderr}")
    monitor = subprocess.Popen([SLEWRING, "device", "monitor", "Dash", "--scene", "joy/ball.yaml", "--every", "0"],
                               stdout=open(f"{folder}/dash.out", "w"), stderr=subprocess.STDOUT, cwd=folder)
    run = subprocess.Popen([SLEWRING, "run", "joy/ball.yaml", "--domain", domain, "--no-record", "--json"],
                           stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=open(f"{folder}/run.err", "w"),
                           text=True, cwd=folder)
    try:
        wait_for("the end of the events", lambda: "device Stick: the recorded events are over" in
                 text_of(f"{folder}/run.err"))
        wait_for("the other device's packets", lambda: "push " in text_of(f"{folder}/dash.out") or monitor.poll() is not None)
        require(monitor.poll() is None, text_of(f"{folder}/dash.out"))
        run.send_signal(signal.SIGINT)
        out, _ = run.communicate(timeout=DEADLINE)
    finally:
        run.kill()
        run.wait()
        monitor.kill()
        monitor.wait()
    require(json.loads(out)["devices"]["Stick"]["summary"]["events"]["reports"] == 1, out)


def case_can_utils(folder, domain):
    for program in ("cansend", "candump", "ip"):
        if subprocess.run(["which", program], capture_output=True).returncode != 0:
            skip(f"{program} is not there (can-utils, iproute2)")
    done = subprocess.run(["ip", "link", "add", "slewvcan", "type", "vcan"], capture_output=True, text=True)
    if done.returncode != 0 and "exists" not in done.stderr:
        skip(f"no vcan: {done.stderr.strip()}")
    crane = Crane(folder, domain, "--without-devices")
    others = []
    try:
        subprocess.run(["ip", "link", "set", "slewvcan", "up"], check=True, timeout=DEADLINE)
        write_panel(folder, "interface: slewvcan")
        crane.start()
        for name in ("Panel", "Load"):
            others.append(subprocess.Popen([SLEWRING, "device", "run", name, "--devices", "panel.yaml", "--session",
                                            "truck_crane_devices", "--domain", domain, "--session-timeout",
                                            str(DEADLINE)], stdout=open(f"{folder}/{name}.out", "w"),
                                           stderr=subprocess.STDOUT, cwd=folder))
        dump = subprocess.run(["candump", "-n", "20", "slewvcan,101:7FF"], capture_output=True, text=True, timeout=DEADLINE)
        require(len(re.findall(r" 101 +\[8\] ", dump.stdout)) == 20, dump.stdout)

        def push():
            for lift, enable in ((0, 0), (0, 1), (50, 1)):
                for _ in range(10):
                    subprocess.run(["cansend", "slewvcan", f"100#{panel_frame(lift, enable)}"], check=True)
            return "enabled" in text_of(f"{folder}/Panel.out")

        wait_for("the panel's dead-man signal", push)
        push()
        crane.wait_for_value("Input_Lift.raw", 0.5)
        result = crane.stop(0)
    finally:
        crane.kill()
        for other in others:
            if other.poll() is None:
                other.kill()
        subprocess.run(["ip", "link", "del", "slewvcan"], capture_output=True)
    require(max(value_at_end(result, "Input_Lift.raw")) == 0.5, "the input was not moved")


CASES = {
    "NightlyAPeerOnUdpClosesThePositionLoopAndAJoystickSlews": case_closed_loop,
    "ADeadOrHangingDeviceIsNeutralAndStopsNoTick": case_dead_or_hanging,
    "ADeviceRunsWithoutAScene": case_without_a_scene,
    "VerbsWorkWithoutASession": case_verbs,
    "RecordedCanFramesMoveAnInput": case_recorded_can,
    "RecordedFilesAreBesideTheScene": case_recorded_files,
    "CanUtilsAreTheOtherSide": case_can_utils,
}

with tempfile.TemporaryDirectory(prefix="slewring_devices_") as scratch:
    CASES[CASE](scratch, take_domain())
print("passed")
