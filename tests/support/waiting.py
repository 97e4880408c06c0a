# SPDX-License-Identifier: Apache-2.0
"""What the tests in Python share: requirements, and waits with a deadline."""
import sys
import time

DEADLINE = 120  # s, of each wait


def require(condition, text):
    if not condition:
        sys.exit(f"FAILED: {text}")


def skip(reason):
    print(f"SKIPPED: {reason}")
    sys.exit(0)


def wait_for(what, condition, deadline=DEADLINE):
    end = time.monotonic() + deadline
    while time.monotonic() < end:
        result = condition()
        if result:
            return result
        time.sleep(0.05)
    sys.exit(f"FAILED: {what} did not happen within {deadline} s")


def text_of(path):
    with open(path, encoding="utf-8") as file:
        return file.read()
