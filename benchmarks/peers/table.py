#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs ours beside every peer and prints the tables of benchmarks/results.md.

    benchmarks/peers/table.py BUILD [ROUNDS]

BUILD is a build with SLEWRING_BUILD_BENCHMARKS and SLEWRING_BUILD_PEERS. The programs take turns for ROUNDS (3), so that
all of them meet the same moods of the machine; medians of the rounds are shown. A peer's column is its time and, in
brackets, ours over it, where ours was measured in turn with this peer.
"""
import os
import pathlib
import statistics
import subprocess
import sys

PEERS = ["mujoco", "simbody", "dart", "bullet"]


def run(build, rounds):
    figures = {}
    for _ in range(rounds):
        for peer in PEERS:
            done = subprocess.run([build / "bin" / f"peer_cost_{peer}"], stdout=subprocess.PIPE, text=True)
            if done.returncode != 0:
                sys.exit(f"peer_cost_{peer} ended with {done.returncode}: not the same mechanism, or no such program")
            for line in done.stdout.splitlines():
                name, quantity, mechanism, ours, theirs, remark = line.split("\t")
                entry = figures.setdefault(quantity, {}).setdefault(mechanism, {}).setdefault(name, ([], [], remark))
                entry[0].append(float(ours))
                entry[1].append(float(theirs))
    return figures


def print_table(quantity, rows):
    names = list(dict.fromkeys(name for row in rows.values() for name in row))
    print(f"| {quantity} [ns] | ours | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 2) + "|")
    for mechanism, row in rows.items():
        ours = statistics.median(x for entry in row.values() for x in entry[0])
        cells = []
        for name in names:
            if name not in row:
                cells.append("")
                continue
            own, theirs = (statistics.median(x) for x in row[name][:2])
            cells.append(f"{theirs:.0f} ({own / theirs:.3f})")
        print(f"| {mechanism} | {ours:.0f} | " + " | ".join(cells) + " |")
    print()


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    before = os.getloadavg()[0]
    figures = run(pathlib.Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else 3)
    for quantity, rows in figures.items():
        print_table(quantity, rows)
    for quantity, rows in figures.items():
        for mechanism, row in rows.items():
            print(f"{quantity}, {mechanism}: " + ", ".join(f"{name} {entry[2]}" for name, entry in row.items()))
    print(f"load of the machine: {before:.1f} before, {os.getloadavg()[0]:.1f} after")


main()
