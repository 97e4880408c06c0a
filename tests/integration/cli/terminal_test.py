#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The status line of a run on terminals of 80, 120 and 200 columns: whole values, no line longer than the terminal,
colours only without NO_COLOR.

terminal_test.py SLEWRING SCENE
"""
import fcntl
import os
import pty
import re
import struct
import sys
import tempfile
import termios

COLOUR = re.compile(r"\x1b\[\d*m")
VALUE = re.compile(r"  [A-Z]\w*(\.\w+)+ -?\d[\d.e+-]*( \S+)?$")


def screen_of(program, scene, columns, **environment):
    """What a run writes on a terminal."""
    with tempfile.TemporaryDirectory() as folder:
        child, terminal = pty.fork()
        if child == 0:
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            os.chdir(folder)
            variables = {k: v for k, v in os.environ.items() if k != "NO_COLOR"}
            os.execve(program, [program, "run", scene, "--in-process", "--duration", "1.5 s"],
                      {**variables, "TERM": "xterm", **environment})
        text = b""
        while True:
            try:
                part = os.read(terminal, 65536)
            except OSError:  # how Linux reports the end
                break
            if not part:
                break
            text += part
        _, status = os.waitpid(child, 0)
        return os.waitstatus_to_exitcode(status), text.decode()


def problems(program, scene):
    values = {}
    for columns in (80, 120, 200):
        code, text = screen_of(program, scene, columns)
        if code != 0:
            yield f"{columns} columns: the run ends with {code}: {text}"
            continue
        lines = [part.split("\x1b[K")[0] for part in text.split("\r")]
        lines = [line for line in lines if "running" in line and " s of 1.5" in line]
        if not lines:
            yield f"{columns} columns: no status line in {text!r}"
        if not any(COLOUR.search(line) for line in lines):
            yield f"{columns} columns: the lamps have no colour: {lines!r}"
        plain = [COLOUR.sub("", line) for line in lines]
        for line in plain:
            if len(line) >= columns:
                yield f"{columns} columns: {len(line)} characters: {line}"
        if plain and not VALUE.search(plain[-1]):
            yield f"{columns} columns: does not end with a whole value: {plain[-1]!r}"
        values[columns] = len(re.findall(r"  [A-Z]\w*\.", plain[-1])) if plain else 0
    if not 1 <= values.get(80, 0) <= values.get(120, 0) <= values.get(200, 0):
        yield f"values shown by width: {values}"

    for environment in ({"NO_COLOR": "1"}, {"TERM": "dumb"}):
        code, text = screen_of(program, scene, 120, **environment)
        if code != 0 or "coupling" not in text:
            yield f"{environment}: code {code}, no lamps in {text!r}"
        if COLOUR.search(text):
            yield f"{environment}: there are colours"


def main():
    found = list(problems(sys.argv[1], sys.argv[2]))
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
