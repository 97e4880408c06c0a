#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""precompiled_test.py COMPILE_COMMANDS   every source has the compiler options of its precompiled header.

g++ 12 takes the header's options in the place of the source's, or crashes, when they differ.
"""
import json
import shlex
import sys


def options(entry):
    """Options that change the code, in their order; of several -O the last."""
    words = shlex.split(entry["command"])
    level = [word for word in words if word.startswith("-O")][-1:]
    return level + [word for word in words if word.startswith(("-f", "-m", "-std="))]


def header_of(entry):
    words = shlex.split(entry["command"])
    for word, value in zip(words, words[1:]):
        if word == "-include" and value.endswith("cmake_pch.hxx"):
            return value
    return None


entries = json.load(open(sys.argv[1]))
headers = {entry["file"][: -len(".cxx")]: options(entry) for entry in entries if entry["file"].endswith("cmake_pch.hxx.cxx")}
users = [entry for entry in entries if header_of(entry) in headers and entry["file"] != header_of(entry) + ".cxx"]
if not headers or len(users) < 100:
    sys.exit(f"only {len(users)} sources with one of {len(headers)} precompiled headers were found")
wrong = [entry for entry in users if options(entry) != headers[header_of(entry)]]
for entry in wrong:
    print(f"{entry['file']}: compiled with {' '.join(options(entry))},\n  its precompiled header with "
          f"{' '.join(headers[header_of(entry)])}; declare the source by slewring_compile_apart")
sys.exit(1 if wrong else 0)
