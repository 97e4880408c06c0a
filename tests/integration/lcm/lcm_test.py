#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A live crane on LCM, with the programs of the LCM package on the other side:

lcm_test.py SOURCES BUILD SLEWRING 1|0 short|long

lcm-gen generates a controller that closes the position loop through the bridge while 1 % of all LCM datagrams are dropped,
lcm-logger records it, lcm-logplayer plays that back; damaged and false inputs are counted by cause, a parameter is
changed; the session's recording is exported as a log, and a second run with the log as its input gives the same values.
Short: one place to drive to, and no playback. Everything is in a network namespace of its own.
"""
import csv
import json
import os
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from waiting import DEADLINE, require, skip, text_of, wait_for  # noqa: E402

GROUP = "239.255.76.67"
PORT = 7667
SESSION = "lcm_test"
PREFIX = f"SLEWRING_{SESSION}"
SIGNALS = "crane=Cyl_Lift.stroke,Cyl_Lift.force"
STEP = 0.004  # s; a machine that is busy keeps up with it
EVERY = 2  # steps between two messages of the bridge


class Processes:
    def __init__(self, folder):
        self.folder = folder
        self.all = []

    def start(self, name, *command):
        with open(f"{self.folder}/{name}.out", "w") as out, open(f"{self.folder}/{name}.err", "w") as err:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out, stderr=err, cwd=self.folder)
        self.all.append(process)
        return process

    def end(self):
        for process in self.all:
            if process.poll() is None:
                process.kill()
                process.wait()


def run(*command, code=0, cwd=None):
    done = subprocess.run(command, capture_output=True, text=True, timeout=DEADLINE, cwd=cwd)
    require(done.returncode == code, f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def events(path):
    """Channel, time [us] and data of each event of a log."""
    found = []
    with open(path, "rb") as file:
        while head := file.read(28):
            sync, _, stamp, channel, data = struct.unpack(">IqqII", head)
            require(sync == 0xEDA1DA01, f"{path} is no event log")
            found.append((file.read(channel).decode(), stamp, file.read(data)))
    return found


def lcm_string(text):
    return struct.pack(">i", len(text) + 1) + text.encode() + b"\0"


class Sender:
    """Sends inputs without LCM's library: its small message is a magic word, a number, the channel and the data."""

    def __init__(self, fingerprint):
        self.fingerprint = fingerprint
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.number = 0

    def send(self, data, channel=f"{PREFIX}_INPUT"):
        self.number += 1
        self.socket.sendto(struct.pack(">II", 0x4C433032, self.number) + channel.encode() + b"\0" + data, (GROUP, PORT))

    def input(self, sequence, value=0.0, channel="Input_Slew", controller="other", step=-1):
        return (self.fingerprint + lcm_string(controller) + struct.pack(">qq", 1, sequence) + lcm_string(channel)
                + struct.pack(">dq", value, step))


def close_the_loop(processes, handler, folder, targets):
    """The generated handler drives the lift cylinder to its places while 1 % of the datagrams are dropped."""
    # not each 100th: five datagrams a period would let it meet the same kind each time
    run("nft", "add", "table", "ip", "lossy")
    run("nft", "add", "chain", "ip", "lossy", "in", "{ type filter hook input priority 0 ; }")
    run("nft", "add", "rule", "ip", "lossy", "in", "udp", "dport", str(PORT), "numgen", "inc", "mod", "97", "==", "0",
        "counter", "drop")
    for target in targets:
        process = processes.start(f"handler{target}", handler, SESSION, target, "60")
        wait_for("the end of the handler", lambda: process.poll() is not None)
        out = text_of(f"{folder}/handler{target}.out")
        require(process.returncode == 0 and "reached" in out,
                f"the position was not reached: {out}{text_of(f'{folder}/handler{target}.err')}")
        print(out.strip())
    dropped = run("nft", "list", "table", "ip", "lossy")
    require("packets 0 " not in dropped, f"no datagram was dropped:\n{dropped}")
    print(dropped[dropped.index("counter"):].split(" drop")[0])
    run("nft", "delete", "table", "ip", "lossy")


def fall_silent(folder, slewring, fingerprint):
    """A stick that is held at a tenth goes to neutral when its messages stop, and the bridge reports it."""
    def stick():
        line = run(slewring, "watch", "Input_Jib.raw", "--session", SESSION, "--count", "1", "--json")
        return json.loads(line)["values"]["Input_Jib.raw"]

    def notices():
        return text_of(f"{folder}/bridge.err").count("channel Input_Jib goes to neutral")

    is_over = threading.Event()

    def hold():
        sender, sequence = Sender(fingerprint), 0
        while not is_over.wait(0.02):
            sender.send(sender.input(sequence, 0.1, "Input_Jib", "silent"))
            sequence += 1

    holder = threading.Thread(target=hold, daemon=True)
    holder.start()
    wait_for("the stick at a tenth", lambda: stick() == 0.1)
    before = notices()
    is_over.set()
    holder.join()
    wait_for("the notice of a silent stick", lambda: notices() > before)
    wait_for("a silent stick at neutral", lambda: stick() == 0)


def send_wrong_inputs(fingerprint):
    """Number of refusals by cause that the bridge must count."""
    sender = Sender(fingerprint)
    wrong = {
        "damaged": [sender.input(0)[:-1], sender.input(0) + b"\0", sender.input(-5),
                    fingerprint + struct.pack(">I", 0x80000000) + sender.input(0)[12:]],
        "another type": [b"", b"\0" * 40, bytes([fingerprint[0] ^ 1]) + sender.input(0)[1:]],
        "not finite": [sender.input(1, value) for value in (float("nan"), float("inf"))],
        "no such channel": [sender.input(2, channel="Input_Slow")],
        "other controller": [sender.input(3, controller="stranger")],
        "step not come yet": [sender.input(3, step=1 << 40)],
    }
    wrong["not finite"][1] = sender.input(2, float("inf"))
    wrong["no such channel"][0] = sender.input(3, channel="Input_Slow")
    wrong["step not come yet"][0] = sender.input(4, step=1 << 40)
    wrong["old sequence"] = [sender.input(4), sender.input(0)]
    for messages in wrong.values():
        for message in messages:
            sender.send(message)
    return {cause: len(messages) for cause, messages in wrong.items()}


def request_parameters(types, folder, live):
    """Requests by the Python types of lcm-gen, which need no library of LCM: each is answered with its number."""
    run("lcm-gen", "--python", "--ppath", folder, types)
    sys.path.insert(0, folder)
    import slewring as generated

    sender = Sender(b"")

    def reply_to(number, path, is_change, value):
        request = generated.parameter_t()
        request.request, request.path, request.is_change, request.value, request.over = number, path, is_change, value, 0.0
        sender.send(request.encode(), f"{PREFIX}_PARAMETER")
        found = [generated.reply_t.decode(data) for channel, _, data in events_so_far(live) if channel == f"{PREFIX}_REPLY"]
        return next((reply for reply in found if reply.request == number), None)

    def reply(*request):
        return wait_for(f"the reply to {request}", lambda: reply_to(*request))

    before = reply(11, "Bag.mass", False, 0.0)
    require(before.is_accepted and before.value > 0, before.reason)
    changed = reply(12, "Bag.mass", True, before.value + 10)
    require(changed.is_accepted and changed.step > 0, changed.reason)
    wait_for("the new value", lambda: reply(13, "Bag.mass", False, 0.0).value == before.value + 10)
    wrong = reply(14, "Bag.mas", True, 1.0)
    require(not wrong.is_accepted and "Bag.mass" in wrong.reason, wrong.reason)
    require(not reply(15, "Bag.mass", True, float("nan")).is_accepted, "a mass that is not finite was accepted")
    print(f"parameters: Bag.mass {before.value} -> {before.value + 10} kg from step {changed.step}; '{wrong.reason}'")
    return changed.step


class Listener:
    """Keeps LCM's small messages of some channels, in their order."""

    def __init__(self, channels):
        self.channels = channels
        self.messages = []
        self.has_ended = threading.Event()
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEPORT, 1)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 24)
        self.socket.bind((GROUP, PORT))
        self.socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                               socket.inet_aton(GROUP) + socket.inet_aton("127.0.0.1"))
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while not self.has_ended.is_set():
            channel, _, data = self.socket.recv(65536)[8:].partition(b"\0")
            if channel == b"END":
                self.has_ended.set()
            elif channel.decode() in self.channels:
                self.messages.append((channel.decode(), data))


def play_back(live):
    """lcm-logplayer's events are those that lcm-logger recorded live."""
    channels = (f"{PREFIX}_crane", f"{PREFIX}_INPUT")
    first = [(event[0], event[2]) for event in events(live) if event[0] in channels]
    missing = set(first)
    require(len(missing) == len(first), "two events of the log are alike")
    sender = Sender(b"")

    # LCM drops messages for a receiver without room, here on a busy machine: what was lost is played again
    def play():
        listener = Listener(channels)
        run("lcm-logplayer", f"--regexp={'|'.join(channels)}", live)
        wait_for("the end of the playback", lambda: sender.send(b"", "END") or listener.has_ended.is_set())
        rest = iter(first)
        is_in_order = all(event in rest for event in listener.messages)
        require(is_in_order, "an event was played that was not recorded, or out of order")
        missing.difference_update(listener.messages)
        print(f"lcm-logplayer: {len(listener.messages)} of {len(first)} events, as recorded live")
        return not missing

    wait_for("the playback of every event", play)


def check_log(path):
    """Counts by channel, and the order of the steps of one node."""
    counts = {}
    last = -1
    for channel, _, data in events(path):
        counts[channel] = counts.get(channel, 0) + 1
        if channel == f"{PREFIX}_crane":
            step = struct.unpack(">q", data[8:16])[0]
            require(step > last and step % EVERY == 0, f"step {step} behind {last}")
            last = step
    for name in ("VARIABLES", "DIRECTORY", "HEALTH", "crane"):
        require(counts.get(f"{PREFIX}_{name}", 0) > 0, f"no event on {PREFIX}_{name}: {counts}")
    return counts


def column(slewring, recording, variable):
    rows = list(csv.reader(run(slewring, "export", recording, "--csv", variable).splitlines()))
    return [row for row in rows[1:] if len(row) == 2]


def refuse_exports(slewring, recording, folder):
    """What would be a log without its content is no log."""
    for wrong, text in ((("--signals", "crane=Cyl_Lift.stroek"), "did you mean 'Cyl_Lift.stroke'?"),
                        (("--signals", "input=Cyl_Lift.stroke"), "has the name input already"),
                        (("--from", "10000 s"), "no variables in this time"),
                        (("--channel", "x" * 60), "at most 63 characters")):
        refusal = run(slewring, "export", recording, "--lcm", f"{folder}/wrong.lcm", *wrong, code=2)
        require(text in refusal, refusal)
        left = [name for name in os.listdir(folder) if name.startswith("wrong")]
        require(not left, f"left behind: {left}")
    require("a name" in run(slewring, "export", recording, "--lcm", "-", code=2), "a log named '-'")
    run(slewring, "export", recording, "--csv", "--every", "10", code=2)  # --every is of --lcm alone


def export_and_drive(slewring, scene, recording, folder, steps):
    """The recording as a log; a run with the log as its input has the same inputs and the same motion, to the bit, up to
    the step in which a parameter was changed or of which a busy machine's recorder lacks values."""
    log = f"{folder}/exported.lcm"
    run(slewring, "export", recording, "--lcm", log, "--channel", PREFIX, "--signals", SIGNALS,
        "--every", str(EVERY))
    counts = check_log(log)
    stamps = [stamp for _, stamp, _ in events(log)]
    require(stamps == sorted(stamps) and stamps[0] == 0, "the times of the log are not in order")
    print(f"export --lcm: {counts}")
    recorded = {variable: column(slewring, recording, variable)
                for variable in ("Input_Lift.raw", "Input_Jib.raw", "Cyl_Lift.stroke", "Cyl_Lift.force")}
    for rows in recorded.values():
        missing = (i for i, row in enumerate(rows) if round(float(row[0]) / STEP) != i)
        steps = min(steps, len(rows), next(missing, len(rows)))
    end = steps * STEP
    run(slewring, "run", scene, "--input", log, "--in-process", "--pace", "free", "--duration", f"{end} s",
        "--step", f"{STEP} s", "--set", "recording.every=1", "--session", "again", "--out", f"{folder}/again", "--quiet", cwd=folder)
    second = f"{folder}/again/" + os.listdir(f"{folder}/again")[0]
    moved = 0
    require(steps > 500, f"only {steps} steps")
    for variable, first in recorded.items():
        again = column(slewring, second, variable)
        require(len(again) >= steps, f"only {len(again)} rows of {variable}")
        differs = [i for i in range(steps) if first[i] != again[i]]
        require(not differs, f"{variable} differs: {[(first[i], again[i]) for i in differs[:1]]}")
        moved = max(moved, len({row[1] for row in first[:steps]}))
    require(moved > 100, "nothing moved")
    print(f"run --input: {steps} steps, equal bit for bit")


def inside(source, build, slewring, is_long):
    run("ip", "link", "set", "lo", "up", "multicast", "on")
    scene = f"{source}/scenes/truck_crane.yaml"
    with tempfile.TemporaryDirectory(prefix="slewring_lcm_") as folder:
        processes = Processes(folder)
        try:
            session = processes.start("session", slewring, "run", scene, "--input", "none", "--duration", "0",
                                      "--step", f"{STEP} s", "--set", "recording.every=1",
                                      "--set", "session.give_up_after=60 s", "--session", SESSION,
                                      "--out", f"{folder}/runs", "--quiet")
            sessions = lambda: SESSION in subprocess.run([slewring, "sessions", "--json"], capture_output=True,
                                                         text=True).stdout
            wait_for("the session", sessions)
            # without a route to the loopback inputs are refused, since other hosts could send them
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--controller", "lift", code=7)
            require(refusal.startswith(f"slewring: {GROUP} has no route") and "ip route add" in refusal, refusal)
            run("ip", "link", "add", "elsewhere", "type", "veth", "peer", "name", "other_end")
            run("ip", "link", "set", "elsewhere", "up", "multicast", "on")
            run("ip", "route", "add", f"{GROUP}/32", "dev", "elsewhere")
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--controller", "lift", code=7)
            require("is not routed to the loopback but to elsewhere" in refusal, refusal)
            run("ip", "link", "delete", "elsewhere")
            run("ip", "route", "add", f"{GROUP}/32", "dev", "lo")
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--url", f"udpm://{GROUP}:{PORT}?ttl=1", code=2)
            require("--insecure-lan" in refusal, refusal)
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--channel", "x" * 60, code=2)
            require("at most 63 characters" in refusal, refusal)
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--signals", "crane=Cyl_Lift.stroek", code=2)
            require("did you mean 'Cyl_Lift.stroke'?" in refusal, refusal)
            refusal = run(slewring, "bridge", "lcm", "--session", SESSION, "--signals", "input=Cyl_Lift.stroke", code=2)
            require("has the name input already" in refusal, refusal)

            # the types, installed and written, and the handler that lcm-gen makes of them
            run("cmake", "--install", build, "--component", "client", "--prefix", f"{folder}/installed")
            run(slewring, "bridge", "lcm", "--session", SESSION, "--signals", SIGNALS,
                "--write-types", f"{folder}/crane.lcm")
            require(text_of(f"{folder}/crane.lcm") == text_of(f"{source}/examples/lcm/crane.lcm"),
                    "examples/lcm/crane.lcm is not what --write-types writes")
            run("cmake", "-S", f"{source}/examples/lcm", "-B", f"{folder}/handler",
                f"-DTYPES={folder}/installed/share/slewring/slewring.lcm")
            run("cmake", "--build", f"{folder}/handler")

            live = f"{folder}/live.lcm"
            logger = processes.start("logger", "lcm-logger", live)
            bridge = processes.start("bridge", slewring, "bridge", "lcm", "--session", SESSION, "--signals", SIGNALS,
                                     "--every", str(EVERY), "--controller", "lift", "--controller", "other",
                                     "--controller", "silent", "--parameters", "--json")
            wait_for("the first messages in the log", lambda: bridge.poll() is not None or (
                os.path.exists(live) and os.path.getsize(live) > 100_000))
            require(bridge.poll() is None, f"the bridge ended: {text_of(f'{folder}/bridge.err')}")
            sockets = run("ss", "-Huan", f"sport = :{PORT}")
            require(f"%lo:{PORT}" in sockets, f"the bridge's socket is open to the network:\n{sockets}")
            targets = ("0.84", "0.88") if is_long else ("0.84",)
            close_the_loop(processes, f"{folder}/handler/lift_controller", folder, targets)
            inputs = wait_for("the handler's inputs in the log", lambda: [
                data for channel, _, data in events_so_far(live) if channel == f"{PREFIX}_INPUT"])
            fall_silent(folder, slewring, inputs[0][:8])
            changed_at = request_parameters(f"{folder}/installed/share/slewring/slewring.lcm", folder, live)
            wrong = send_wrong_inputs(inputs[0][:8])
            causes = ["damaged", "not finite", "old sequence"]
            wait_for("the reports of wrong inputs",
                     lambda: all(f"'{cause}'" in text_of(f"{folder}/bridge.err") for cause in causes))
            run(slewring, "control", "stop", "--session", SESSION)
            wait_for("the end of the bridge", lambda: bridge.poll() is not None)
            wait_for("the end of the session", lambda: session.poll() is not None)
            logger.send_signal(signal.SIGINT)
            wait_for("the end of lcm-logger", lambda: logger.poll() is not None)
            summary = json.loads(text_of(f"{folder}/bridge.out"))
            print(json.dumps(summary))
            require(bridge.returncode == 0, text_of(f"{folder}/bridge.err"))
            require(f"session '{SESSION}' has ended" in text_of(f"{folder}/bridge.err"), "the end is not reported")
            counted = summary["inputs"]
            for cause, number in wrong.items():
                require(counted["refused"][cause] == number, f"{cause}: {counted['refused'][cause]} and not {number}")
            require(counted["applied"] > 100 and counted["lost"] > 0 and counted["gaps"] > 0, "1 % loss left no gap")

            print(f"lcm-logger: {check_log(live)}")
            if is_long:
                play_back(live)
            recording = f"{folder}/runs/" + os.listdir(f"{folder}/runs")[0]
            refuse_exports(slewring, recording, folder)
            export_and_drive(slewring, scene, recording, folder, changed_at)
            # what lcm-logger recorded drives a run as well
            run(slewring, "run", scene, "--input", live, "--in-process", "--pace", "free", "--duration", "2 s",
                "--no-record", "--quiet", cwd=folder)
        finally:
            processes.end()
            for name in ("bridge.err", "session.err", "session.out"):
                if os.path.exists(f"{folder}/{name}"):
                    sys.stderr.write(f"---- {name}\n{text_of(f'{folder}/{name}')}")


def events_so_far(path):
    """The whole events of a log that is still written."""
    with open(path, "rb") as file:
        content = file.read()
    found, at = [], 0
    while at + 28 <= len(content):
        _, _, stamp, channel, data = struct.unpack(">IqqII", content[at:at + 28])
        end = at + 28 + channel + data
        if end > len(content):
            break
        found.append((content[at + 28:at + 28 + channel].decode(), stamp, content[at + 28 + channel:end]))
        at = end
    return found


def main():
    source, build, slewring, has_lcm, size = sys.argv[1:6]
    if has_lcm != "1":
        skip("built without LCM; install liblcm-dev and liblcm-bin, and build again")
    for program in ("lcm-gen", "lcm-logger", "lcm-logplayer", "ip", "nft", "unshare", "cmake", "cc"):
        if shutil.which(program) is None:
            skip(f"the program {program} is not installed")
    if len(sys.argv) > 6:
        return inside(source, build, slewring, size == "long")
    if subprocess.run(["unshare", "-rn", "nft", "list", "tables"], capture_output=True).returncode != 0:
        skip("no network namespace with nft can be made here")
    sys.exit(subprocess.run(["unshare", "-rn", sys.executable, *sys.argv, "inside"]).returncode)


if __name__ == "__main__":
    main()
