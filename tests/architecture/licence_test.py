#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The licence stands in the root, every source file names it in its first line, and docs/licences.md has a row for
every package of the launch scripts.

licence_test.py ROOT
"""
import glob
import os
import re
import sys

LINE = "SPDX-License-Identifier: Apache-2.0"
# comments by the name of a file; begin and end
SLASHES, HASH, ARROW = ("// ", ""), ("# ", ""), ("<!-- ", " -->")
COMMENTS = {
    ".cpp": SLASHES, ".h": SLASHES, ".hpp": SLASHES, ".c": SLASHES, ".h.in": SLASHES, ".idl": SLASHES, ".lcm": SLASHES,
    ".js": SLASHES, ".mjs": SLASHES, ".ts": SLASHES, ".css": ("/* ", " */"), ".html": ARROW, ".xml": ARROW,
    ".py": HASH, ".sh": HASH, ".bash": HASH, ".fish": HASH, ".cmake": HASH, ".map": HASH, ".supp": HASH,
    ".pc.in": HASH, ".service.in": HASH, "CMakeLists.txt": HASH,
}
FOLDERS = ("benchmarks", "cli", "cmake", "examples", "idl", "launch_scripts", "libs", "scenes", "tests", "web", ".ci")
# written by a program, or kept inputs of one
GENERATED = ("examples/lcm/crane.lcm", "tests/fuzz/corpus/", "web/node_modules/", "web/dist/")


def comment_of(name, path):
    for ending, comment in COMMENTS.items():
        if name.endswith(ending):
            return comment
    if "." in name:
        return None
    with open(path, "rb") as file:  # a script without an ending
        return HASH if file.read(9).startswith((b"#!", b"#compdef")) else None


def sources(root):
    """Path, begin and end of its comments, of every source file."""
    nodes = sorted(name for name in os.listdir(root) if name.endswith("_node"))
    paths = [os.path.join(root, "CMakeLists.txt")]
    for top in (*FOLDERS, *nodes):
        for folder, _, names in os.walk(os.path.join(root, top)):
            paths += [os.path.join(folder, name) for name in sorted(names)]
    for path in paths:
        if os.path.relpath(path, root).startswith(GENERATED):
            continue
        comment = comment_of(os.path.basename(path), path)
        if comment:
            yield path, *comment


def place_of(lines):
    """Where the line stands: first, behind what has to be first itself."""
    return 1 if lines and lines[0].startswith(("#!", "#compdef", "<?xml", "<!doctype", "<!DOCTYPE")) else 0


def without_line(root):
    count = 0
    for path, begin, end in sources(root):
        count += 1
        with open(path, encoding="utf-8") as file:
            lines = file.readlines()
        at = place_of(lines)
        if at >= len(lines) or lines[at] != f"{begin}{LINE}{end}\n":
            yield f"{os.path.relpath(path, root)}:{at + 1}: expected '{begin}{LINE}{end}'"
    if count < 1000:
        yield f"only {count} source files were found"


def packages(root):
    """Debian packages of launch_scripts/packages-*.txt."""
    for path in sorted(glob.glob(os.path.join(root, "launch_scripts", "packages-*.txt"))):
        with open(path, encoding="utf-8") as file:
            for line in file:
                if line.strip() and not line.startswith("#"):
                    yield line.split()[0]


def problems(root):
    with open(os.path.join(root, "LICENSE"), encoding="utf-8") as file:
        text = file.read()
    if not re.search(r"Apache License\s+Version 2\.0, January 2004", text) or "END OF TERMS AND CONDITIONS" not in text:
        yield "LICENSE: is not the whole text of the Apache License 2.0"

    yield from without_line(root)

    with open(os.path.join(root, "docs", "licences.md"), encoding="utf-8") as file:
        rows = [line for line in file if line.startswith("|")]
    named = set(re.findall(r"`([^`]+)`", "".join(line.split("|")[1] for line in rows)))
    found = list(packages(root))
    if len(found) < 30:
        yield f"launch_scripts: only {len(found)} packages were found"
    for package in found:
        if package not in named:
            yield f"docs/licences.md: no row for the package {package}"


def main():
    found = list(problems(sys.argv[1]))
    print("\n".join(found))
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
