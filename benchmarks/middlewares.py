#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One table of the middlewares: exchange alone, the distributed crane in both paces, heap calls, memory.

benchmarks/middlewares.py BUILD_DIRECTORY [ROUNDS=3] [SECONDS=10]

Needs cyclone_star (SLEWRING_BUILD_BENCHMARKS) and Fast DDS. Rows alternate within a round, so that other load meets all
of them; figures are medians of the rounds. Quote them with the load that is printed below them: on a busy machine only
heap calls and memory mean something.
"""
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time

sys.dont_write_bytecode = True
from paced_crane import finish_session, print_load, scene_path, start_session  # noqa: E402

MIDDLEWARES = {"cyclone": "transport", "fastdds": "fastdds", "fastdds-shm": "fastdds-shm"}  # way of cyclone_star
DOMAIN = "96"


def star(bin_folder):
    """Steps per second by way and window."""
    text = subprocess.run([bin_folder + "/cyclone_star", "20000", "1", "fastdds"], check=True, capture_output=True, text=True)
    return {(way, int(window)): float(rate) for way, window, rate in re.findall(r"^(\S+) +(\d+) +(\d+)$", text.stdout, re.M)}


def resident(process, program):
    """Largest resident memory of the child of that name [MB]; None: not found."""
    for pid in subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True).stdout.split():
        try:
            with open(f"/proc/{pid}/status", encoding="utf-8") as file:
                status = file.read()
        except FileNotFoundError:
            continue
        if status.startswith(f"Name:\t{program}"):
            return int(re.search(r"VmHWM:\s+(\d+)", status)[1]) / 1024
    return None


def crane(bin_folder, middleware, pace, seconds, folder):
    process = start_session(bin_folder, scene_path("truck_crane.yaml"), pace, seconds, folder, DOMAIN, "--input", "none",
                            "--middleware", middleware, "--no-record")
    memory = None
    while process.poll() is None:
        memory = resident(process, "mechanics_node") or memory
        time.sleep(0.2)
    report = finish_session(process)
    steps = report["steps"]
    timing = report["nodes"]["mechanics"]["timing"]
    deadline = report["deadline"]  # none in pace free
    return {"rate": report["steps_per_second"],
            "response": deadline["response"]["p99"] * 1e6 if deadline else float("nan"),
            "heap": timing["carrier_allocations"] / steps, "memory": memory or float("nan")}


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__.split("\n\n")[1])
    bin_folder = os.path.abspath(sys.argv[1]) + "/bin"
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 3
    seconds = int(sys.argv[3]) if len(sys.argv) > 3 else 10
    figures = {middleware: [] for middleware in MIDDLEWARES}
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(rounds):
            rates = star(bin_folder)
            for middleware, way in MIDDLEWARES.items():
                free = crane(bin_folder, middleware, "free", seconds, folder)
                paced = crane(bin_folder, middleware, "real", seconds, folder)
                figures[middleware].append((rates[way, 1], rates[way, 4], free["rate"], paced["response"], free["heap"],
                                            free["memory"]))
    print("| | star, window 1 [1/s] | star, window 4 [1/s] | crane, free [1/s] | crane at 1 kHz: io's response, p99 [us]"
          " | heap calls of a step in the middleware | memory of mechanics [MB] |")
    print("|---|---|---|---|---|---|---|")
    for middleware, rows in figures.items():
        median = [statistics.median(column) for column in zip(*rows)]
        print(f"| {middleware} | " + " | ".join(f"{value:.0f}" if value >= 20 else f"{value:.2f}" for value in median) + " |")
    print_load()


if __name__ == "__main__":
    main()
