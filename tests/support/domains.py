# SPDX-License-Identifier: Apache-2.0
"""DDS domains of tests in Python."""
import fcntl
import os
import sys
import tempfile


def take_domain():
    """The number, as text, of a DDS domain that no other test on this host uses (tests/support/test_domain.h)."""
    for i in range(99):
        number = 1 + (os.getpid() + i) % 99
        path = f"{tempfile.gettempdir()}/slewring-test-domain-{number}"
        file = os.open(path, os.O_RDONLY | os.O_CREAT, 0o666)
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return str(number)
        except OSError:
            os.close(file)
    sys.exit("FAILED: all test domains are in use")
