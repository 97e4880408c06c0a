#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Whether every source compiles alone, without precompiled headers and without the others of its unit: it includes what
it uses, and needs no name of a neighbour.

each_alone.py BUILD [FOLDER ...]: BUILD is configured for clang and has its generated headers; a FOLDER limits it to
sources below it. ccache, where it is there, knows the sources that have not changed. Ends with 1 if a source fails, and
prints the compiler's words.
"""
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
CACHED = [os.path.join(ROOT, "cmake", "cached"), shutil.which("ccache")] if shutil.which("ccache") else []
PRECOMPILED = re.compile(r"(-Xclang -include-pch -Xclang \S+|-Xclang -include -Xclang \S+cmake_pch\S*|-Winvalid-pch)")


def sources(build):
    """Sources with the command of the unit that they are compiled in."""
    with open(os.path.join(build, "compile_commands.json"), encoding="utf-8") as file:
        units = json.load(file)
    for unit in units:
        parts = [unit["file"]]
        if "/Unity/unity_" in unit["file"]:
            with open(unit["file"], encoding="utf-8") as file:
                parts = re.findall(r'^#include "(.+)"', file.read(), re.MULTILINE)
        words = shlex.split(PRECOMPILED.sub("", unit["command"]))
        if not any(os.path.basename(word).startswith("clang++") for word in words):  # in C
            continue
        command = [word for i, word in enumerate(words) if not {word, words[i - 1]} & {"-c", "-o"}]
        # a field that only a template reads is unused where nothing instantiates that
        command += ["-Wno-unused-private-field", "-O0", "-g0", "-c"]
        for part in parts:
            if part.endswith(".cpp") and not part.startswith(os.path.abspath(build)):
                yield part, command + [part], unit["directory"]


def compile_alone(source, command, directory):
    with tempfile.NamedTemporaryFile(suffix=".o") as output:
        words = CACHED + command + ["-o", output.name]
        result = subprocess.run(words, cwd=directory, capture_output=True, text=True, check=False)
    if result.returncode != 0:
        print(f"{source} does not compile alone:\n{result.stderr}", flush=True)
    return result.returncode == 0


def main(build, *folders):
    chosen = [one for one in sources(build) if not folders or one[0].startswith(tuple(map(os.path.abspath, folders)))]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        results = list(pool.map(lambda one: compile_alone(*one), chosen))
    print(f"{sum(results)} of {len(results)} sources compile alone")
    return 0 if results and all(results) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
