#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Devices of a live session on a virtual CAN bus, with programs of others on the other side:

can_network_test.py SOURCES SLEWRING CASE
"""
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from domains import take_domain  # noqa: E402
from waiting import DEADLINE, require, skip, text_of, wait_for  # noqa: E402

SOURCES, SLEWRING, CASE = sys.argv[1:4]
BUS = "slewvcan2"

SCENE = """scene: can_network
session: {duration: 0, step: 10 ms, pace: real, give_up_after: 60 s}
bodies:
  Ball: {mass: 2 kg, inertia: [0.1, 0.1, 0.1]}
joints:
  Free: {type: floating, body2: Ball}
forces:
  Push: {type: point_force, body: Ball, force: 1 N, direction: [1, 0, 0]}
inputs:
  Input_Push: {type: analog, primitive: Push, block: 0, channel: 0, scale: 1}
outputs:
  Lamp: {type: switched, condition: Input_Push.raw > 0.3}
devices:
"""

CANOPEN = f"""  Lever:
    type: can_in
    interface: {BUS}
    protocol: canopen
    timeout: 10 s
    nodes: [{{node: 5, heartbeat: 2 s}}]
    pdos: [{{name: Lever, node: 5, number: 1}}]
    objects: [{{pdo: Lever, name: lift, as: int16, scale: 0.001}}, {{pdo: Lever, name: enable, as: bool}}]
    signals: [{{signal: Lever.lift, input: Input_Push}}, {{signal: Lever.enable}}]
    dead_man: Lever.enable
  Lamps:
    type: can_out
    interface: {BUS}
    protocol: canopen
    nodes: [{{node: 6, heartbeat: 2 s}}]
    pdos: [{{name: Lamps, node: 6, number: 1}}]
    objects: [{{pdo: Lamps, name: lamp, as: bool}}]
    signals: [{{signal: Lamps.lamp, output: Lamp}}]
"""

J1939 = f"""  Engine:
    type: can_out
    interface: {BUS}
    protocol: j1939
    address: 128
    identity: 1234
    arbitrary_address: ARBITRARY
    function: 200
    signals: [{{signal: EEC1.EngineSpeed_190, variable: Input_Push.raw}}]
"""


class Session:
    """A run of the scene with its devices on the bus."""

    def __init__(self, folder, domain, devices):
        self.folder, self.domain = folder, domain
        with open(f"{folder}/can_network.yaml", "w") as file:
            file.write(SCENE + devices)
        done = subprocess.run(["ip", "link", "add", BUS, "type", "vcan"], capture_output=True, text=True)
        if done.returncode != 0 and "exists" not in done.stderr:
            skip(f"no vcan: {done.stderr.strip()}")
        subprocess.run(["ip", "link", "set", BUS, "up"], check=True, timeout=DEADLINE)
        with open(f"{folder}/run.out", "w") as out, open(f"{folder}/run.err", "w") as err:
            self.process = subprocess.Popen([SLEWRING, "run", f"{folder}/can_network.yaml", "--domain", domain, "--out",
                                             f"{folder}/runs", "--quiet", "--json"], stdin=subprocess.DEVNULL,
                                            stdout=out, stderr=err, cwd=folder)

    def err(self):
        return text_of(f"{self.folder}/run.err")

    def wait_for_line(self, part, times=1):
        wait_for(f"'{part}' in {self.err()}", lambda: self.err().count(part) >= times or (
            self.process.poll() is not None and sys.exit(f"FAILED: the run ended before '{part}':\n{self.err()}")))

    def wait_for_value(self, name, expected):
        def is_published():
            done = subprocess.run([SLEWRING, "watch", name, "--session", "can_network", "--domain", self.domain,
                                   "--count", "1", "--json"], capture_output=True, text=True)
            return done.returncode == 0 and json.loads(done.stdout)["values"].get(name) == expected

        wait_for(f"{name} = {expected}; {self.err()}", is_published)

    def stop(self):
        done = subprocess.run([SLEWRING, "control", "stop", "--session", "can_network", "--domain", self.domain],
                              capture_output=True, text=True, timeout=DEADLINE)
        require(done.returncode == 0, f"stop: {done.stdout}{done.stderr}")
        self.process.wait(DEADLINE)
        require(self.process.returncode == 0, f"the run ended with {self.process.returncode}:\n{self.err()}")
        return json.loads(text_of(f"{self.folder}/run.out"))["devices"]

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        subprocess.run(["ip", "link", "del", BUS], capture_output=True)


def case_canopen(folder, domain):
    try:
        import canopen
    except ImportError as error:
        skip(f"python3 cannot import canopen: {error}")
    session = Session(folder, domain, CANOPEN)
    network = canopen.Network()
    try:
        session.wait_for_line("device Lever: reads interface")
        session.wait_for_line("device Lamps: sends on interface")
        network.connect(interface="socketcan", channel=BUS)
        lamp_states = []
        network.subscribe(0x206, lambda _id, data, _time: lamp_states.append(bytes(data)))

        def boot(number):
            objects = canopen.ObjectDictionary()
            node = canopen.LocalNode(number, objects)
            network.add_node(node)
            node.nmt.state = "INITIALISING"
            node.nmt.state = "PRE-OPERATIONAL"
            node.nmt.start_heartbeat(100)
            wait_for(f"NMT start of node {number}: {session.err()}", lambda: node.nmt.state == "OPERATIONAL")
            return node

        def push():
            for lift, enable in ((0, 0), (0, 1), (500, 1)):
                for _ in range(20):
                    network.send_message(0x185, lift.to_bytes(2, "little", signed=True) + bytes([enable]))
                    time.sleep(0.01)

        boot(6)
        lever = boot(5)
        session.wait_for_line("device Lever: node 5 is operational")
        push()
        session.wait_for_value("Input_Push.raw", 0.5)
        wait_for("the lamp at node 6", lambda: b"\x01" in lamp_states)
        # silence: neutral, and a line
        lever.nmt.stop_heartbeat()
        session.wait_for_line("device Lever: node 5 is missing: its heartbeat did not come in time")
        session.wait_for_value("Input_Push.raw", 0)
        wait_for("the lamp at node 6 off", lambda: lamp_states[-1] == b"\x00")
        # a restart of the node: started again, and at neutral until its stick is pushed again
        del network[5]
        boot(5)
        session.wait_for_line("device Lever: node 5 is operational", 2)
        session.wait_for_value("Input_Push.raw", 0)
        push()
        session.wait_for_value("Input_Push.raw", 0.5)
        devices = session.stop()
    finally:
        network.disconnect()
        session.end()
    node = devices["Lever"]["summary"]["frames"]["nodes"][0]
    print(devices["Lever"]["summary"]["frames"], devices["Lamps"]["summary"]["packets"])
    require(node["losses"] == 1 and node["boot_ups"] == 2 and node["starts"] >= 3, f"{node}")
    require(devices["Lamps"]["summary"]["packets"]["unsent"] == 0, f"{devices['Lamps']}")


def case_j1939(folder, domain):
    """A unit on the kernel's J1939 sockets takes the address of the device, or does not get it."""
    for program in ("j1939acd", "candump"):
        if subprocess.run(["which", program], capture_output=True).returncode != 0:
            skip(f"{program} is not there (can-utils)")
    for is_smaller, arbitrary in ((False, False), (True, False), (True, True)):
        session = Session(folder, domain, J1939.replace("ARBITRARY", str(arbitrary).lower()))
        rival = dump = None
        try:
            session.wait_for_line("device Engine: has claimed address 128")
            dump = subprocess.Popen(["candump", "-L", BUS], stdout=open(f"{folder}/dump", "w"))
            wait_for("EEC1 from the address", lambda: " 0CF00480#" in text_of(f"{folder}/dump"))
            rival = subprocess.Popen(["j1939acd", "-v", "-r", "128", "-c", f"{folder}/rival.jacd",
                                      "0000000000000001" if is_smaller else "7FFFFFFFFFFFFFFF", BUS],
                                     stderr=open(f"{folder}/rival", "w"))
            wait_for("the rival's claim", lambda: " 18EEFF80#" in text_of(f"{folder}/dump"))
            if not is_smaller:
                wait_for("the defence", lambda: re.search(r" 18EEFF80#D204000000C80000", text_of(f"{folder}/dump")))
                count = text_of(f"{folder}/dump").count(" 0CF00480#")
                wait_for("further messages", lambda: text_of(f"{folder}/dump").count(" 0CF00480#") > count + 5)
                require("is lost" not in session.err(), session.err())
            elif arbitrary:
                session.wait_for_line("device Engine: address 128 belongs to the unit with the NAME 0000000000000001; "
                                      "claims address ")
                session.wait_for_line("device Engine: has claimed address ", 2)
                address = int(session.err().rsplit("has claimed address ", 1)[1].split()[0])
                wait_for("EEC1 from the new address", lambda: f" 0CF004{address:02X}#" in text_of(f"{folder}/dump"))
            else:
                session.wait_for_line("device Engine: the claim of address 128 is lost to the unit with the NAME "
                                      "0000000000000001; nothing is sent; choose another address, or arbitrary_address")
                wait_for("Cannot Claim", lambda: " 18EEFFFE#D204000000C80000" in text_of(f"{folder}/dump"))
                after = text_of(f"{folder}/dump").rsplit(" 18EEFFFE#", 1)[1]
                require(" 0CF004" not in after, after)
            packets = session.stop()["Engine"]["summary"]["packets"]
        finally:
            for process in (rival, dump):
                if process is not None:
                    process.kill()
                    process.wait()
            session.end()
        print(packets["address"], text_of(f"{folder}/rival"))
        phase = "claimed" if arbitrary or not is_smaller else "lost"
        require(packets["address"]["phase"] == phase and packets["address"]["contests"] >= 1, f"{packets}")


CASES = {
    "ACanOpenNodeIsStartedWatchedAndStartedAgain": case_canopen,
    "AUnitOnTheKernelsJ1939ContestsTheAddress": case_j1939,
}

with tempfile.TemporaryDirectory(prefix="slewring_can_") as scratch:
    CASES[CASE](scratch, take_domain())
print("passed")
