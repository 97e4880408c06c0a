# SPDX-License-Identifier: Apache-2.0
"""What the cases of window_test.py share: programs, packages, requests, and a client of the protocol."""
import csv
import hashlib
import http.client
import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from waiting import DEADLINE, require, skip, text_of, wait_for  # noqa: E402

SOURCES, SLEWRING, PACKAGES, CASE = sys.argv[1:5]
HERE = os.path.dirname(os.path.abspath(__file__))
SESSION = "window_test"


def install_packages(source=HERE, files=None):
    if shutil.which("node") is None or shutil.which("npm") is None:
        skip("node and npm are needed for a client of the Foxglove protocol")
    with open(f"{source}/package-lock.json", "rb") as lock:
        wanted = hashlib.sha256(lock.read()).hexdigest()
    os.makedirs(PACKAGES, exist_ok=True)
    stamp = f"{PACKAGES}/installed.sha256"
    for name in files or [one for one in os.listdir(HERE) if one.endswith((".mjs", ".json"))]:
        shutil.copy(f"{source}/{name}", PACKAGES)
    if os.path.exists(stamp) and text_of(stamp) == wanted:
        return
    done = subprocess.run(["npm", "ci", "--no-audit", "--no-fund", "--ignore-scripts", "--fetch-retries=1"],
                          cwd=PACKAGES, capture_output=True, text=True)
    if done.returncode != 0:
        output = done.stdout + done.stderr
        if re.search("ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ECONNRESET|ETIMEDOUT|ENETUNREACH|EHOSTUNREACH|ERR_SOCKET|E[45]..",
                     output):
            skip(f"the npm registry does not deliver the packages:\n{output}")
        sys.exit(f"FAILED: npm ci:\n{output}")
    with open(stamp, "w") as file:
        file.write(wanted)


class Program:
    """A process of slewring; its output is in files."""

    def __init__(self, folder, name, *arguments):
        self.out = f"{folder}/{name}.out"
        with open(self.out, "w") as out, open(f"{folder}/{name}.err", "w") as err:
            self.process = subprocess.Popen([SLEWRING, *arguments], stdin=subprocess.DEVNULL, stdout=out, stderr=err,
                                            cwd=folder)

    def address(self):
        """Of the page, when it is printed."""
        def found():
            require(self.process.poll() is None, f"the window ended: {text_of(self.out)}{text_of(self.out[:-3] + 'err')}")
            return re.search(r'"page":"http://([^/]*)/', text_of(self.out))
        return wait_for("the address of the window", found)[1]

    def end(self):
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        try:
            return self.process.wait(DEADLINE)
        except subprocess.TimeoutExpired:
            self.process.kill()
            sys.exit("FAILED: a program does not end at SIGINT")


def start_scene(folder, domain, *more, scene=f"{SOURCES}/scenes/truck_crane.yaml", session=SESSION):
    """The crane with its window, from one command. A machine that is busy keeps up with 4 ms."""
    return Program(folder, "window", "window", scene, "--port", "0", "--json",
                   "--session", session, "--domain", domain, "--step", "4 ms", "--no-record", "--quiet",
                   "--set", "session.give_up_after=60 s", "--set", "session.controller_timeout=60 s", *more)


def run_client(*arguments):
    done = subprocess.run(["node", f"{PACKAGES}/client.mjs", *arguments], capture_output=True, text=True, timeout=280)
    print(done.stdout)
    require(done.returncode == 0, f"the client ended with {done.returncode}:\n{done.stderr}")


def run_page(case, address, *arguments, script="page.mjs"):
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        skip("chromium is needed for the page of the window")
    done = subprocess.run(["node", f"{PACKAGES}/{script}", case, address, SLEWRING, chromium, *arguments],
                          capture_output=True, text=True, timeout=280)
    print(done.stdout)
    require(done.returncode == 0, f"the page: {done.stderr}")


def need_page():
    """The built page, which the window serves of its own accord."""
    install_packages()
    if not os.path.exists(f"{os.path.dirname(SLEWRING)}/../web/index.html"):
        skip("the page is not built; build the target 'page', which needs node, npm and its registry")


def copy_page():
    """The sources of the page, with packages of their own."""
    install_packages(f"{SOURCES}/web", ("package.json", "package-lock.json", "tsconfig.json"))
    shutil.rmtree(f"{PACKAGES}/src", ignore_errors=True)
    shutil.copytree(f"{SOURCES}/web/src", f"{PACKAGES}/src")


def record(folder, *more):
    """Two seconds of the crane; the path of the run."""
    os.makedirs(folder, exist_ok=True)
    subprocess.run([SLEWRING, "run", f"{SOURCES}/scenes/truck_crane.yaml", "--in-process", "--pace", "free", "--duration",
                    "2 s", "--out", f"{folder}/runs", "--quiet", *more], check=True, capture_output=True, cwd=folder)
    return f"{folder}/runs/" + os.listdir(f"{folder}/runs")[0]


def request(address, target="/", method="GET", host=None, **headers):
    connection = http.client.HTTPConnection(address, timeout=DEADLINE)
    connection.putrequest(method, target, skip_host=True, skip_accept_encoding=True)
    connection.putheader("Host", address if host is None else host)
    for name, value in headers.items():
        connection.putheader(name.replace("_", "-"), value)
    connection.endheaders()
    answer = connection.getresponse()
    return answer.status, answer.read().decode()


def send(address, target, method="GET", body=None, **headers):
    """Status, headers and body."""
    connection = http.client.HTTPConnection(address, timeout=DEADLINE)
    connection.request(method, target, body, {name.replace("_", "-"): value for name, value in headers.items()})
    answer = connection.getresponse()
    return answer.status, answer.headers, answer.read()


UPGRADE = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec_WebSocket_Version": "13",
           "Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ=="}


def send_raw(address, data):
    """The answer to these bytes, when the connection is closed; empty: there was none."""
    answer = b""
    host, port = address.rsplit(":", 1)
    with socket.create_connection((host, int(port)), timeout=DEADLINE) as connection:
        try:
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR)
            while part := connection.recv(65536):
                answer += part
        except OSError:  # closed with bytes unread
            pass
    return answer


def open_websocket(address, target="/"):
    host, port = address.rsplit(":", 1)
    connection = socket.create_connection((host, int(port)), timeout=DEADLINE)
    connection.sendall((f"GET {target} HTTP/1.1\r\nHost: {address}\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n"
                        "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                        "Sec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n").encode())
    head = b""
    while b"\r\n\r\n" not in head:
        head += connection.recv(1)
    require(head.startswith(b"HTTP/1.1 101"), head.decode())
    return connection


class Client:
    """A client of the protocol, as far as services need one."""

    def __init__(self, address):
        self.connection = open_websocket(address)
        self.services = {}
        wait_for("the services of the window", self.has_services)

    def has_services(self):
        opcode, data = self.receive()
        if opcode == 1 and (message := json.loads(data))["op"] == "advertiseServices":
            self.services = {one["name"]: one["id"] for one in message["services"]}
        return bool(self.services)

    def take(self, size):
        data = b""
        while len(data) < size:
            part = self.connection.recv(size - len(data))
            require(part, "the window has closed the connection")
            data += part
        return data

    def receive(self):
        """Opcode and data of the next frame (RFC 6455, 5.2); the server does not fragment."""
        first, size = self.take(2)
        if size == 126:
            size = int.from_bytes(self.take(2), "big")
        elif size == 127:
            size = int.from_bytes(self.take(8), "big")
        return first & 15, self.take(size)

    def call(self, name, request):
        payload = (b"\2" + self.services[name].to_bytes(4, "little") + (7).to_bytes(4, "little") +
                   (4).to_bytes(4, "little") + b"json" + json.dumps(request).encode())
        head = b"\x82" + (bytes([128 | len(payload)]) if len(payload) < 126
                          else b"\xfe" + len(payload).to_bytes(2, "big"))
        self.connection.sendall(head + b"\0\0\0\0" + payload)
        while True:
            opcode, data = self.receive()
            if opcode == 2 and data[0] == 3:
                return json.loads(data[13 + int.from_bytes(data[9:13], "little"):])
            if opcode == 1 and (message := json.loads(data))["op"] == "serviceCallFailure":
                sys.exit(f"FAILED: {name}: {message['message']}")


def values_of(recording, start, out):
    """Rows of the recording's values from a time on, by the names in its header; without the nodes' own, of
    which a clock measures some."""
    subprocess.run([SLEWRING, "export", recording, "--csv", "-o", out, "--from", start], check=True, capture_output=True)
    with open(out, newline="") as lines:
        header, *rows = csv.reader(lines)
    measured = re.compile(r"(io|mechanics|hydraulics)\.|.*\.(age|loop_delay|loop_time_ms)\b")
    kept = [i for i, name in enumerate(header) if not measured.match(name)]
    return [[row[i] for i in kept] for row in (header, *rows)]
