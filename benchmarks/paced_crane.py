# SPDX-License-Identifier: Apache-2.0
"""What the benchmarks in Python share: a session of a scene as processes, its report, the load of the machine."""
import json
import os
import subprocess


def scene_path(name):
    return os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "scenes", name))


def start_session(bin_folder, scene, pace, seconds, folder, domain, *more, stderr=subprocess.DEVNULL):
    """The process of `slewring run`; finish_session() takes its report."""
    command = [bin_folder + "/slewring", "run", scene, "--pace", pace, "--duration", f"{seconds} s", "--session",
               f"bench{os.getpid()}", "--domain", domain, "--quiet", "--json", *more]
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=stderr, text=True, cwd=folder)


def finish_session(process):
    return json.loads(process.communicate()[0])


def print_load():
    with open("/proc/loadavg", encoding="utf-8") as file:
        print(f"load: {file.read().strip()}")
