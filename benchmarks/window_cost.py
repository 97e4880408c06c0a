#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a window costs the session beside it: deadlines of the flexible crane at 1 kHz with all variables recorded.

benchmarks/window_cost.py BUILD_DIRECTORY [ROUNDS=1] [SECONDS=20]

Sessions of a round: without a window; with a window without a client; with one client, with three, and with one that
subscribes and then reads nothing. A client subscribes to every JSON channel (60 values a second each) and reads all that
comes. Columns beside the deadlines: processor time of the window over the wall time, its largest memory, and what the
clients received. The clients run on this machine too; their own processor time is in the last column. Quote the figures
with the load below them.
"""
import base64
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True
from paced_crane import finish_session, print_load, scene_path, start_session  # noqa: E402

DOMAIN = "94"
DEADLINE = 60  # s


class Client(threading.Thread):
    """Subscribes to all JSON channels; reads what comes, or nothing once it has subscribed."""

    def __init__(self, address, reads):
        super().__init__(daemon=True)
        self.reads = reads
        self.received = self.channels = 0
        self.fault = None
        self.is_over = threading.Event()
        host, port = address.rsplit(":", 1)
        self.connection = socket.create_connection((host, int(port)), timeout=DEADLINE)
        key = base64.b64encode(os.urandom(16)).decode()
        self.connection.sendall((f"GET / HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                                 f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                                 "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n").encode())
        self.stream = self.connection.makefile("rb")
        while self.stream.readline().strip():
            pass

    def receive(self):
        first, size = self.stream.read(2)
        if size >= 126:
            size = int.from_bytes(self.stream.read(2 if size == 126 else 8), "big")
        return first & 15, self.stream.read(size)

    def subscribe(self, channels):
        wanted = [{"id": one["id"], "channelId": one["id"]} for one in channels if one["encoding"] == "json"]
        self.channels += len(wanted)
        text = json.dumps({"op": "subscribe", "subscriptions": wanted}).encode()
        head = b"\x81" + (bytes([128 | len(text)]) if len(text) < 126 else b"\xfe" + len(text).to_bytes(2, "big"))
        self.connection.sendall(head + b"\0\0\0\0" + text)

    def run(self):
        try:
            while not self.is_over.is_set():
                opcode, data = self.receive()
                self.received += len(data)
                if opcode == 1 and (message := json.loads(data))["op"] == "advertise":
                    self.subscribe(message["channels"])
                if not self.reads and self.channels > 40:
                    return
                if opcode == 8:
                    return
        except (OSError, ValueError) as fault:
            self.fault = fault


def used_by(pid):
    """Processor seconds and largest memory [MB] of a process."""
    with open(f"/proc/{pid}/stat", encoding="utf-8") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    with open(f"/proc/{pid}/status", encoding="utf-8") as file:
        memory = int(re.search(r"VmHWM:\s*(\d+) kB", file.read())[1]) / 1024
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), memory


class Window:
    def __init__(self, bin_folder, folder):
        self.process = subprocess.Popen([bin_folder + "/view_node", "--session", f"bench{os.getpid()}", "--domain", DOMAIN,
                                         "--port", "0", "--json"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, text=True,
                                        cwd=folder)
        line = self.process.stdout.readline()
        self.address = re.search(r'"page":"http://([^/]*)/', line)[1]


def measure(bin_folder, seconds, folder, clients, reads=True, has_window=True):
    """Report of the session; of the window processor share, memory; of the clients channels, bytes, processor share."""
    session = start_session(bin_folder, scene_path("truck_crane_flexible.yaml"), "real", seconds, folder, DOMAIN, "--set",
                            "recording.every=1")
    if not has_window:
        return finish_session(session), None
    window = Window(bin_folder, folder)
    open_clients = [Client(window.address, reads) for _ in range(clients)]
    for client in open_clients:
        client.start()
    time.sleep(2)  # names and subscriptions
    begin, (cpu, _), own = time.monotonic(), used_by(window.process.pid), time.process_time()
    while session.poll() is None and time.monotonic() - begin < seconds - 5:
        time.sleep(0.2)
    if session.poll() is not None:
        sys.exit(f"the session ended early: {session.communicate()[0]}")
    wall = time.monotonic() - begin
    used, memory = used_by(window.process.pid)
    own = time.process_time() - own
    faults = [str(client.fault) for client in open_clients if client.fault]
    if faults or any(client.channels == 0 for client in open_clients):
        sys.exit(f"clients failed: {faults}")
    received = sum(client.received for client in open_clients)
    report = finish_session(session)
    for client in open_clients:
        client.is_over.set()
        client.connection.close()
    window.process.wait(DEADLINE)
    return report, {"cpu": 100 * (used - cpu) / wall, "memory": memory, "rate": received / wall / 1e6,
                    "channels": max((client.channels for client in open_clients), default=0), "own": 100 * own / wall}


def row(name, report, window):
    books = report["deadline"]
    response = books["response"]
    missed = 100 * books["overruns"] / max(1, response["count"])
    cells = [name, books["steps_run"], books["overruns"], f"{missed:.3f}", books["longest_overrun"],
             *(f"{response[key] * 1e6:.0f}" for key in ("p50", "p99", "p999", "max"))]
    cells += ["", "", "", "", ""] if window is None else [
        f"{window['cpu']:.1f}", f"{window['memory']:.1f}", window["channels"], f"{window['rate']:.2f}", f"{window['own']:.1f}"]
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.split("\n\n")[1])
    bin_folder = os.path.abspath(sys.argv[1]) + "/bin"
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 1
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    if seconds < 10:
        sys.exit("SECONDS is at least 10: 2 s for names, 5 s for a slow start; nothing was started")
    print("| session | steps | missed | % | in a row | response p50 [us] | p99 | p99.9 | max | window [% of a processor] | "
          "[MB] | channels | clients [MB/s] | [% of a processor] |\n|" + "---|" * 14)
    for number in range(1, rounds + 1):
        for name, options in (("no window", {"clients": 0, "has_window": False}), ("no client", {"clients": 0}),
                              ("one client", {"clients": 1}), ("three clients", {"clients": 3}),
                              ("one stalled client", {"clients": 1, "reads": False})):
            with tempfile.TemporaryDirectory(prefix="slewring_window_cost_") as folder:
                print(row(f"{name} {number}", *measure(bin_folder, seconds, folder, **options)), flush=True)
    print_load()


if __name__ == "__main__":
    main()
