#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The window of a session and of a recording, from outside:

window_test.py SOURCES SLEWRING PACKAGES CASE
PACKAGES: folder in which the packages of the client are installed.
"""
import gzip
import json
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from domains import take_domain  # noqa: E402
from waiting import DEADLINE, require, text_of, wait_for  # noqa: E402
from window_support import (  # noqa: E402
    CASE, Client, HERE, PACKAGES, Program, SESSION, SLEWRING, SOURCES, UPGRADE, copy_page, install_packages,
    need_page, open_websocket, record, request, run_client, run_page, send, send_raw, start_scene, values_of)


def page_live(folder, case="live"):
    need_page()
    domain = take_domain()
    window = start_scene(folder, domain)
    try:
        run_page(case, window.address(), "--session", SESSION, "--domain", domain)
    finally:
        window.end()


def page_edits(folder):
    need_page()
    domain = take_domain()
    shutil.copytree(f"{SOURCES}/scenes/meshes", f"{folder}/meshes")
    scene = shutil.copy(f"{SOURCES}/scenes/truck_crane.yaml", folder)
    with open(scene) as file:
        text = file.read()
    with open(scene, "w") as file:
        file.write("include: side.yaml\n" +
                   re.sub("^  Bag:.*$", "  Bag:\n    points: {top: [0, 0.1 m, 0]}", text, count=1, flags=re.MULTILINE))
    with open(f"{folder}/side.yaml", "w") as file:
        file.write("plots:\n  Hook: {title: Hook, variables: [Truck_Hook.position.y]}\n")
    window = start_scene(folder, domain, scene=scene)
    try:
        run_page("edit", window.address(), scene, "--session", SESSION, "--domain", domain)
    finally:
        window.end()


def tutorial(folder):
    """docs/tutorial/in-the-window.md. SLEWRING_PICTURES: folder that receives its pictures, packed."""
    need_page()
    domain = take_domain()
    for name in os.listdir(f"{SOURCES}/scenes"):
        if name.startswith("truck_crane_beam_hard"):
            shutil.copy(f"{SOURCES}/scenes/{name}", folder)
    shutil.copytree(f"{SOURCES}/scenes/meshes", f"{folder}/meshes")
    scene = shutil.copy(f"{SOURCES}/scenes/truck_crane.yaml", folder)
    pictures = f"{folder}/pictures"
    os.mkdir(pictures)
    window = start_scene(folder, domain, scene=scene, session="truck_crane")
    try:
        run_page("-", window.address(), scene, pictures, "--session", "truck_crane", "--domain", domain,
                 script="tutorial.mjs")
    finally:
        window.end()
    made = [one for one in os.listdir(pictures) if one.endswith(".png")]
    require(len(made) == 7, f"pictures: {made}")
    if kept := os.environ.get("SLEWRING_PICTURES"):
        for name in made:
            subprocess.run(["pngquant", "--force", "--speed", "1", "--output", f"{kept}/{name}", "64", f"{pictures}/{name}"],
                           check=True)


def page_inputs(folder):
    page_live(folder, "inputs")


def page_phone(folder):
    page_live(folder, "phone")


def page_beside(folder):
    need_page()
    paths = [record(f"{folder}/{mass}", "--set", f"Bag.mass={mass} kg") for mass in (500, 900)]
    window = Program(folder, "window", "window", paths[0], "--beside", paths[1], "--port", "0", "--json")
    try:
        run_page("beside", window.address(), *paths)
    finally:
        window.end()


def page_recording(folder):
    need_page()
    path = record(folder)
    window = Program(folder, "window", "window", path, "--port", "0", "--json")
    try:
        run_page("recording", window.address(), path)
    finally:
        window.end()


def bending(folder):
    """The parts of the page that compute, without a browser."""
    copy_page()
    subprocess.run(["node", "node_modules/esbuild/bin/esbuild", "src/view/bending.ts", "--bundle", "--format=esm",
                    "--outfile=bending_parts.mjs", "--log-level=error"], cwd=PACKAGES, check=True)
    shutil.copy(f"{HERE}/bending.mjs", PACKAGES)
    done = subprocess.run(["node", "bending.mjs"], cwd=PACKAGES, capture_output=True, text=True, timeout=DEADLINE)
    print(done.stdout)
    require(done.returncode == 0, f"bending: {done.stderr}")


def types(folder):
    """tsc over the page."""
    copy_page()
    done = subprocess.run(["npm", "run", "check"], cwd=PACKAGES, capture_output=True, text=True)
    require(done.returncode == 0, f"tsc:\n{done.stdout}{done.stderr}")


def live(folder):
    install_packages()
    domain = take_domain()
    window = start_scene(folder, domain)
    try:
        run_client("live", f"ws://{window.address()}/", SLEWRING, "--session", SESSION, "--domain", domain)
        code = window.end()
        require(code in (0, 3, 130), f"the window ended with {code}: {text_of(f'{folder}/window.err')}")
        require("has ended" in text_of(window.out), f"the window does not report the end: {text_of(window.out)}")
    finally:
        window.process.kill()


def recording(folder):
    install_packages()
    path = record(folder)
    window = Program(folder, "window", "window", path, "--port", "0", "--json")
    try:
        run_client("recording", f"ws://{window.address()}/", SLEWRING, path)
        require(window.end() == 130, "the window does not end by SIGINT")
    finally:
        window.process.kill()


def take_over(folder):
    """A session from the middle of a recording has the recorded values to the last bit: numbers are printed so that
    they read back as the same."""
    domain = take_domain()
    subprocess.run([SLEWRING, "run", f"{SOURCES}/scenes/truck_crane.yaml", "--in-process", "--pace", "free", "--duration",
                    "1.8 s", "--step", "4 ms", "--set", "recording.every=1", "--out", f"{folder}/first", "--quiet"],
                   check=True, capture_output=True, cwd=folder)
    first = f"{folder}/first/" + os.listdir(f"{folder}/first")[0]
    window = Program(folder, "window", "window", first, "--port", "0", "--json", "--session", "taken", "--domain", domain)
    try:
        client = Client(window.address())
        answer = client.call("take_over", {"time": 1.2, "input": "script", "duration": 1.8})
        require(answer["accepted"] and answer["session"] == "taken", f"{answer}")
        page = re.match("http://([^/]*)/", answer["page"])[1]
        wait_for("the window of the session", lambda: request(page, "/session.json")[0] == 200)
        again = client.call("take_over", {"time": 1.2})
        wait_for("the end of the session", lambda: re.search("taken: .*/session.mcap", text_of(window.out)))
        require(not again["accepted"] and "nothing was started" in again["reason"], f"{again}")
        window.end()
        second = f"{folder}/runs/" + os.listdir(f"{folder}/runs")[0]
        recorded, taken = (values_of(one, "1.204 s", f"{folder}/{name}.csv") for one, name in ((first, "a"), (second, "b")))
        require(len(recorded) > 140 and len(recorded[0]) > 50, f"too few values: {recorded[:2]}")
        stroke = recorded[0].index("Cyl_Lift.stroke [m]")
        require(recorded[1][stroke] != recorded[-1][stroke], "the script does not move the crane: nothing is compared")
        for of_first, of_second in zip(recorded, taken, strict=True):
            differing = [name for name, a, b in zip(recorded[0], of_first, of_second) if a != b]
            require(not differing, f"at {of_first[0]} s the session has other values of {differing}")
    finally:
        window.process.kill()


def take_over_behind_reset(folder):
    """A session is taken over from what playback shows at a time, in front of a reset and behind it."""
    domain = take_domain()
    session = Program(folder, "session", "run", f"{SOURCES}/scenes/truck_crane.yaml", "--session", "reset", "--step",
                      "4 ms", "--set", "recording.every=1", "--out", f"{folder}/first", "--quiet", "--domain", domain,
                      "--duration", "0")

    def control(*words):
        return subprocess.run([SLEWRING, "control", *words, "--session", "reset", "--domain", domain],
                              capture_output=True, text=True)

    def has_reached(step):
        done = control("save", f"{folder}/{len(os.listdir(folder))}.saved")
        return done.returncode == 0 and int(re.match(r"accepted\((\d+)\)", done.stdout)[1]) > step

    def request_of(word):
        done = control(word)
        require(done.returncode == 0, f"{word}: {done.stdout}{done.stderr}")

    try:
        wait_for("2 s of the session", lambda: has_reached(500))
        request_of("reset")
        wait_for("1 s behind the reset", lambda: has_reached(250))
        request_of("stop")
        session.process.wait(DEADLINE)
    finally:
        session.process.kill()
    first = f"{folder}/first/" + os.listdir(f"{folder}/first")[0]
    shown = subprocess.run([SLEWRING, "export", first, "--csv", "--only", "Cyl_Lift.stroke"], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    rows = [tuple(float(value) for value in line.split(",")) for line in shown if line[:1].isdigit()]
    info = json.loads(subprocess.run([SLEWRING, "info", "--json", "--events", first], check=True, capture_output=True,
                                     text=True).stdout)
    require(abs(info["duration"] - rows[-1][0]) < 0.01 and info["from"] == 0, f"{info['duration']}, {rows[-1]}")
    input_table = subprocess.run([SLEWRING, "export", first, "--input"], capture_output=True, text=True)
    begin = re.search("epoch 1 from ([0-9.]*) s", input_table.stderr)
    require(input_table.returncode == 2 and begin and not input_table.stdout,
            f"a table over a reset: {input_table.stdout}{input_table.stderr}")
    begin = float(begin[1])
    for number, at in enumerate((rows[len(rows) // 4][0], begin + 0.4)):
        expected = next(row for row in rows if row[0] >= at - 1e-9)[1]
        window = Program(folder, "window", "window", first, "--port", "0", "--json", "--session", f"taken{number}",
                         "--domain", domain)
        try:
            client = Client(window.address())
            answer = client.call("take_over", {"time": at})
            require(answer["accepted"], f"at {at} s: {answer}")
            page = re.match("http://([^/]*)/", answer["page"])[1]
            wait_for("the window of the session", lambda: request(page, "/session.json")[0] == 200)
            wait_for("its end", lambda: subprocess.run([SLEWRING, "control", "stop", "--session", f"taken{number}",
                                                        "--domain", domain], capture_output=True).returncode == 0)
            second = wait_for("its recording", lambda: re.search(rf"taken{number}: (\S*)/session.mcap",
                                                                 text_of(window.out)))[1]
            window.end()
        finally:
            window.process.kill()
        taken = subprocess.run([SLEWRING, "export", os.path.join(folder, second), "--csv", "--only", "Cyl_Lift.stroke"], check=True,
                               capture_output=True, text=True).stdout.splitlines()
        got = next(tuple(float(value) for value in line.split(",")) for line in taken if line[:1].isdigit())
        own = at if number == 0 else at - begin
        require(abs(got[0] - own) < 0.0061, f"the session goes on at {got[0]} s, expected {own} s")
        require(abs(got[1] - expected) < 1e-4, f"at {at} s: stroke {got[1]} m, shown {expected} m")


def opens_browser(folder):
    """The page is opened on a desktop, unless that is not wanted."""
    subprocess.run([SLEWRING, "run", f"{SOURCES}/scenes/single_cylinder.yaml", "--in-process", "--pace", "free",
                    "--duration", "0.1 s", "--out", f"{folder}/runs", "--quiet"],
                   check=True, capture_output=True, cwd=folder)
    run = f"{folder}/runs/" + os.listdir(f"{folder}/runs")[0]
    os.makedirs(f"{folder}/bin")
    with open(f"{folder}/bin/xdg-open", "w") as file:
        file.write(f'#!/bin/sh\necho "$1" >> {folder}/opened.new\nmv {folder}/opened.new {folder}/opened\n')
    os.chmod(f"{folder}/bin/xdg-open", 0o755)
    os.environ["PATH"] = f"{folder}/bin:" + os.environ["PATH"]
    os.environ["DISPLAY"] = ":9"
    with open(f"{folder}/token", "w") as file:
        file.write("0123456789abcdef0123\n")

    def printed(*more):
        window = Program(folder, "window", "window", run, "--port", "0", *more)
        try:
            return wait_for("the address", lambda: re.search(r"http://\S*", text_of(window.out)))[0], window
        finally:
            if "--no-browser" in more:
                window.end()

    printed("--no-browser")
    address, window = printed("--token-file", f"{folder}/token")
    try:
        opened = wait_for("the browser", lambda: os.path.exists(f"{folder}/opened") and text_of(f"{folder}/opened"))
    finally:
        window.end()
    # with the token, which is not printed; the first window opened nothing
    require(address.endswith("/?token=...") and opened == address[:-3] + "0123456789abcdef0123\n",
            f"printed {address}, opened {opened}")


def files(folder):
    """Meshes, packed files and the workspace by HTTP."""
    subprocess.run([SLEWRING, "run", f"{SOURCES}/scenes/truck_crane.yaml", "--in-process", "--pace", "free", "--duration",
                    "0.1 s", "--out", f"{folder}/runs", "--quiet"], check=True, capture_output=True, cwd=folder)
    os.makedirs(f"{folder}/web")
    for name, content in (("index.html", b"plain" * 50), ("index.html.gz", gzip.compress(b"plain" * 50))):
        with open(f"{folder}/web/{name}", "wb") as file:
            file.write(content)
    window = Program(folder, "window", "window", f"{folder}/runs/" + os.listdir(f"{folder}/runs")[0], "--port", "0",
                     "--json", "--web", f"{folder}/web")
    try:
        address = window.address()
        graphics = json.loads(send(address, "/session.json")[2])["graphics"]
        require({one["body"] for one in graphics} >= {"Ground", "Truck_Pillar", "Truck_JibBoom", "Bag"}, f"{graphics}")
        total = 0
        for one in graphics:
            status, headers, data = send(address, one["path"])
            require(status == 200 and headers["Content-Type"] == "model/gltf-binary" and data[:4] == b"glTF" and
                    int.from_bytes(data[8:12], "little") == len(data), f"{one}: {status}, {headers}")
            total += len(data)
        print(f"{len(graphics)} meshes, {total} bytes")
        status, headers, data = send(address, "/circuit.svg")
        require(status == 200 and headers["Content-Type"] == "image/svg+xml", f"{status}: {headers}")
        drawn = {one.get("data-element") for one in xml.etree.ElementTree.fromstring(data).iter()}
        require({"MainPump", "L90Lift", "Cyl_Lift", "PRV_MainPump"} <= drawn, f"the diagram has {drawn}")
        status, headers, data = send(address, "/", Accept_Encoding="gzip")
        require(headers["Content-Encoding"] == "gzip" and gzip.decompress(data) == b"plain" * 50, f"{headers}")
        require(send(address, "/", If_None_Match=headers["ETag"], Accept_Encoding="gzip")[0] == 304, "not revalidated")
        status, headers, data = send(address, "/", "HEAD")
        require(headers["Content-Length"] == "250" and data == b"", f"HEAD: {headers}, {data}")
        require(send(address, "/workspace.json")[0] == 404, "a workspace that no page saved")
        require(send(address, "/workspace.json", "PUT", "{}")[0] == 400, "a workspace without a version was saved")
        status, headers, data = send(address, "/workspace.json", "PUT", '{"version": 1}')
        require(status == 201, f"{status}: {data}")
        tag = headers["ETag"]
        require(send(address, "/workspace.json", "PUT", '{"version": 2}', If_Match=tag)[0] == 204, "not replaced")
        require(send(address, "/workspace.json", "PUT", '{"version": 3}', If_Match=tag)[0] == 412, "a state was lost")
        require(send(address, "/workspace.json")[2] == b'{"version": 2}', "another workspace")
        require(os.listdir(f"{folder}/state/slewring/workspaces/").count("truck_crane.json") == 1, "no file")
        require(send(address, "/workspace.json", "PUT", "x" * (2 << 20))[0] == 413, "a giant workspace was read")
        require(send(address, "/session.json", body="x")[0] == 413, "a body was taken")
        for method, target in (("GET", "/scene.json"), ("PUT", "/scene.yaml"), ("POST", "/restart")):
            status, _, data = send(address, target, method, "")
            require(status == 404 and b"slewring window SCENE" in data, f"{target} of a recording: {status}, {data}")
    finally:
        window.end()


def door(folder):
    with open(f"{folder}/token", "w") as file:
        file.write("0123456789abcdef0123\n")
    domain = take_domain()
    window = start_scene(folder, domain, "--token-file", f"{folder}/token")
    try:
        address = window.address()
        query = "?token=0123456789abcdef0123"

        def is_open():
            try:
                return request(address, f"/session.json{query}")[0] == 200
            except OSError:
                return False

        require(is_open(), "the session's description was refused")
        inputs = [one["name"] for one in json.loads(request(address, f"/session.json{query}")[1])["inputs"]]
        require("Input_Lift" in inputs, f"inputs: {inputs}")
        require("page.js" in request(address)[1] or "<script" in request(address)[1], "there is no page")
        foxglove = {**UPGRADE, "Sec_WebSocket_Protocol": "foxglove.sdk.v1"}
        for expected, answer in (
                (403, request(address, host="evil.com")), (403, request(address, Origin="http://evil.com")),
                (404, request(address, "/../../etc/passwd")), (404, request(address, "/%2e%2e/etc/passwd")),
                (404, request(address, "/.git/config")), (404, request(address, "/no_such_file")),
                (405, request(address, method="DELETE")), (414, request(address, "/" + "a" * 4000)),
                (401, request(address, "/session.json")), (401, request(address, "/circuit.svg")), (401, request(address, "/?token=0123", **foxglove)),
                (400, request(address, f"/{query}", **UPGRADE)),
                # the scene of this window: never without the state that is replaced
                (401, request(address, "/scene.json")), (401, request(address, "/scene.yaml", "PUT")),
                (401, request(address, "/restart?token=0123", "POST")),
                (403, request(address, f"/restart{query}", "POST", Origin="http://evil.com")),
                (403, request(address, f"/scene.yaml{query}", "PUT", host="evil.com")),
                (405, request(address, f"/restart{query}")), (405, request(address, f"/other.yaml{query}", "PUT")),
                (404, request(address, f"/scenes/../scene.yaml{query}", "PUT")),
                (428, request(address, f"/scene.yaml{query}", "PUT")),
                (428, request(address, f"/restart{query}", "POST")),
                (400, request(address, f"/scene.json{query}", "POST")),
                (403, request(address, f"/{query}", Origin="null", **foxglove))):
            require(answer[0] == expected, f"expected {expected}, got {answer}")
            require(len(answer[1]) > 10, f"{expected} without a reason")
        # what is no HTTP is answered with a reason
        for data in (b"GET / HTTP/1.1\r\nHost: a\r\nContent-Length: -1\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost: a\r\nContent-Length: 99999999999999999999\r\n\r\n",
                     b"\0\1\2\xff\r\n\r\n", b"GET /\r\n\r\n", b"GET / HTTP/9.9\r\n\r\n",
                     b"GET / HTTP/1.1\r\nHost a\r\n\r\n"):
            answer = send_raw(address, data)
            require(answer.startswith(b"HTTP/1.1 400 ") and b"nothing was changed" in answer, f"{data}: {answer}")
        body = json.dumps({"version": 1})
        require(send(address, f"/workspace.json{query}", "PUT", body, Origin="http://evil.com")[0] == 403,
                "a foreign origin with a body")
        # what is no HTTP, a header without an end, a body that was not wanted
        for data in (b"\0" * 1000, b"GET / HTTP/1.1\r\n" + b"X: " + b"y" * 100_000, b"\x16\x03\x01" * 500,
                     f"POST / HTTP/1.1\r\nHost: {address}\r\nContent-Length: 99999999\r\n\r\nabc".encode()):
            send_raw(address, data)
        require(is_open(), "the door does not answer after damaged requests")
        # frames: without a mask, of a length beyond 2^62, of an unknown kind, of a text that is no UTF-8
        for frame in (b"\x81\x02{}", b"\x82\xff\x7f" + b"\xff" * 7 + b"\0\0\0\0", b"\x8f\x80\0\0\0\0",
                      b"\x81\x82\0\0\0\0\xff\xff"):
            with open_websocket(address, f"/{query}") as connection:
                connection.sendall(frame)
                wait_for("the end of a damaged connection", lambda: connection.recv(65536) == b"")
        # more connections than there is room for
        many = [socket.create_connection(tuple(address.rsplit(":", 1)), timeout=DEADLINE) for _ in range(100)]
        for connection in many:
            connection.close()
        wait_for("an open door after a hundred connections", is_open)
        require(window.process.poll() is None, "the window has ended")
        run = subprocess.run([SLEWRING, "sessions", "--domain", domain, "--json"], capture_output=True, text=True)
        require(SESSION in run.stdout, "the session is gone")
        window.end()
    finally:
        window.process.kill()
    for arguments, text in ((("--listen", "0.0.0.0"), "name a file with --token-file"),
                            (("--listen", "here"), "is no address"),
                            (("--beside", "runs"), "is for the window of a recording"),
                            (("--token-file", "/dev/null"), "no token"),
                            (("--token-file", "nosuch"), "the file cannot be read"),
                            (("--web", "nosuch"), "'nosuch' has no index.html"),
                            (("--allow-origin", "*"), "'*' is no origin as browsers send it"),
                            (("--allow-origin", "https://x.example/"), "is no origin as browsers send it")):
        done = subprocess.run([SLEWRING, "window", "--session", "none", "--domain", domain, *arguments],
                              capture_output=True, text=True, timeout=DEADLINE)
        require(done.returncode == 2 and text in done.stderr, f"{arguments}: {done.returncode}: {done.stderr}")
    # a scene's session is not started without its window
    with socket.create_server(("127.0.0.1", 0)) as taken:
        for arguments, code, text in ((("--listen", "0.0.0.0"), 2, "name a file with --token-file"),
                                      (("--listen", "here"), 2, "is no address"),
                                      (("--token-file", "/dev/null"), 2, "no token"),
                                      (("--token-file", "nosuch"), 2, "the file cannot be read"),
                                      (("--web", "nosuch"), 2, "'nosuch' has no index.html"),
                                      (("--allow-origin", "*"), 2, "'*' is no origin as browsers send it"),
                                      (("--port", str(taken.getsockname()[1])), 7, "Address already in use")):
            done = subprocess.run([SLEWRING, "window", f"{SOURCES}/scenes/truck_crane.yaml", "--domain", domain,
                                   "--duration", "0.1 s", "--out", f"{folder}/none", *arguments],
                                  capture_output=True, text=True, timeout=DEADLINE, cwd=folder)
            require(done.returncode == code and text in done.stderr and "nothing was " in done.stderr,
                    f"{arguments}: {done.returncode}: {done.stdout}{done.stderr}")
            require(not os.path.exists(f"{folder}/none"), f"{arguments}: a session was started")


CASES = {"AForeignClientWatchesAndChangesALiveSession": live, "ARecordingIsSoughtByAForeignClient": recording,
         "TheDoorRefusesHostileRequests": door, "MeshesFilesAndTheWorkspaceComeByHttp": files,
         "ASessionTakesOverFromARecordingWithTheSameBits": take_over,
         "ASessionTakesOverFromWhatIsShownBehindAReset": take_over_behind_reset,
         "ThePageShowsChangesAndDrivesASession": page_live, "ThePageFollowsTheSliderOfARecording": page_recording,
         "ASceneIsEditedSavedAndRestartedInThePage": page_edits,
         "ThePageOperatesAndPlots": page_inputs, "ThePageIsOperatedByTouch": page_phone,
         "TheTutorialIsDoneInThePage": tutorial,
         "TwoRecordingsAreShownBesideEachOther": page_beside, "TheTypesOfThePageHold": types,
         "AMeshBendsWithTheNodesOfItsBody": bending,
         "ADesktopOpensThePageInItsBrowser": opens_browser}
with tempfile.TemporaryDirectory(prefix="slewring_window_") as scratch:
    os.environ["XDG_STATE_HOME"] = f"{scratch}/state"  # workspaces
    CASES[CASE](scratch)
