#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What a session in one process costs beside its physics: CPU time for a simulated millisecond of the crane.

In turn, in every round: both sides coupled without messages and a session of nodes with its start (crane_step), and
the whole program, `slewring run --in-process --no-record`, as the difference of a run of 6 s and one of 0.1 s, so that
its start does not count. The table shows the least of all rounds and the median of each round's ratio to the coupled
physics of the same round.

    benchmarks/session_share.py build/bench [ROUNDS]
"""
import json
import resource
import statistics
import subprocess
import sys

SCENES = {"rigid": "scenes/truck_crane.yaml", "two_modes": "scenes/truck_crane_flexible.yaml"}
SHORT, LONG = 0.1, 6.0  # s


def crane_step(folder, boom):
    """us per simulated ms: coupled, session"""
    out = subprocess.run([f"{folder}/bin/crane_step", f"--benchmark_filter=(Coupled|Session)/{boom}",
                          "--benchmark_min_time=0.3", "--benchmark_format=json"],
                         capture_output=True, text=True, check=True).stdout
    times = {b["name"].split("/")[0]: b["per_simulated_ms"] * 1e6 for b in json.loads(out)["benchmarks"]}
    return times["BM_Coupled"], times["BM_Session"]


def cpu_time(folder, boom, duration):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([f"{folder}/bin/slewring", "run", SCENES[boom], "--in-process", "--no-record", "--pace", "free",
                    "--quiet", "--json", "--duration", f"{duration} s"], capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    folder, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10
    print("| crane | coupled | session | over coupled | program | over coupled |\n|---|---|---|---|---|---|")
    for boom in SCENES:
        rows = []
        for _ in range(rounds):
            coupled, session = crane_step(folder, boom)
            program = (cpu_time(folder, boom, LONG) - cpu_time(folder, boom, SHORT)) / (LONG - SHORT) * 1e3
            rows.append((coupled, session, program))
        least = [min(row[i] for row in rows) for i in range(3)]
        over = [statistics.median(row[i] / row[0] for row in rows) for i in range(3)]
        print(f"| {boom} | {least[0]:.2f} us | {least[1]:.2f} us | {over[1]:.2f} | {least[2]:.2f} us | {over[2]:.2f} |")


if __name__ == "__main__":
    main()
