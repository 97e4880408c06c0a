#!/usr/bin/env python3
"""The licence stands in the root, and docs/licences.md has a row for every package of the launch scripts.

licence_test.py ROOT
"""
import glob
import os
import re
import sys


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
