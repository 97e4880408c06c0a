# SPDX-License-Identifier: Apache-2.0
"""Runs of machines for the tests of their pages; the command line is TEST PROJECT SLEWRING WHAT."""
import csv
import pathlib
import subprocess
import sys

PROJECT, SLEWRING, WHAT = sys.argv[1:]


def output(*arguments):
    return subprocess.run([SLEWRING, *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout


def columns(recording):
    """Columns of a recording by name in SI units."""
    header, *rows = csv.reader(output("export", recording, "--csv").splitlines())
    numbers = zip(*[[float(cell or "nan") for cell in row] for row in rows])
    return {name.split(" ")[0]: column for name, column in zip(header, numbers)}


def record(scene, folder, *options):
    """Output of a run, its recording, and its columns by name in SI units; the output is printed."""
    text = output("run", f"{PROJECT}/scenes/{scene}.yaml", "--pace", "free", "--out", folder, *options)
    print(text)
    recording = next(path.parent for path in pathlib.Path(folder).rglob("session.mcap"))
    return text, recording, columns(recording)


def expect(statement, holds):
    print(("ok: " if holds else "FAILED: ") + statement)
    return holds


def near(what, value, by_hand, share, unit=""):
    return expect(f"{what} {value:.6g} {unit}, by hand {by_hand:.6g} {unit} ({100 * (value / by_hand - 1):+.3f} %)",
                  abs(value - by_hand) <= share * abs(by_hand))
