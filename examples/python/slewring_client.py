# SPDX-License-Identifier: Apache-2.0
"""Slewring's client library in Python: slewring_client.h through ctypes, nothing but the standard library.

    with Session("truck_crane", "pid") as session:
        stroke = session.find("Cyl_Lift.stroke")
        lift = session.acquire("Input_Lift")
        while session.step():
            session.write(lift, 20 * (0.86 - session.value(stroke)))

The library is found as libslewring_client.so by the system, or at the path in the variable SLEWRING_CLIENT.
"""

import ctypes
import os

OK, TIMEOUT, REFUSED, LOST, ENDED, BAD_ARGUMENT, FAILED = 0, -1, -2, -3, -4, -5, -6


def _load():
    library = ctypes.CDLL(os.environ.get("SLEWRING_CLIENT", "libslewring_client.so.0"))
    text, number, handle, session = ctypes.c_char_p, ctypes.c_double, ctypes.c_int, ctypes.c_void_p
    signatures = {
        "join": (session, [text, text, ctypes.c_uint, text, text, number]),
        "join_code": (handle, []),
        "leave": (None, [session]),
        "error": (text, [session]),
        "step_size": (number, [session]),
        "find": (handle, [session, text, number]),
        "value": (number, [session, handle]),
        "acquire": (handle, [session, text, number]),
        "take_over": (handle, [session, text, number]),
        "release": (handle, [session, handle]),
        "step": (handle, [session, number]),
        "latest": (handle, [session, number]),
        "present_step": (ctypes.c_longlong, [session]),
        "blocks_missed": (ctypes.c_longlong, [session]),
        "time": (number, [session]),
        "write": (handle, [session, handle, number]),
        "notice": (text, [session]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, "slewring_" + name)
        function.restype, function.argtypes = result, arguments
    return library


class Error(Exception):
    """A sentence, and the code of slewring_client.h."""

    def __init__(self, code, text):
        super().__init__(text)
        self.code = code


class Session:
    def __init__(self, session, controller, domain=0, interface="lo", peers="", timeout=10.0):
        self._c = _load()
        self._session = self._c.slewring_join(
            session.encode(), controller.encode(), domain, interface.encode(), peers.encode(), timeout)
        if not self._session:
            raise Error(self._c.slewring_join_code(), self._c.slewring_error(None).decode())

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.leave()

    def leave(self):
        if self._session:
            self._c.slewring_leave(self._session)
        self._session = None

    def _checked(self, result):
        if result < 0:
            raise Error(result, self._c.slewring_error(self._session).decode())
        return result

    def find(self, variable, timeout=5.0):
        return self._checked(self._c.slewring_find(self._session, variable.encode(), timeout))

    def value(self, variable):
        return self._c.slewring_value(self._session, variable)

    def acquire(self, channel, timeout=5.0):
        return self._checked(self._c.slewring_acquire(self._session, channel.encode(), timeout))

    def take_over(self, channel, timeout=5.0):
        return self._checked(self._c.slewring_take_over(self._session, channel.encode(), timeout))

    def release(self, channel):
        self._checked(self._c.slewring_release(self._session, channel))

    def step(self, timeout=None):
        """Waits for the next block of variables; False when the session has ended.

        Without a time it waits through a pause, and Ctrl-C ends it; with one no block in time is an Error, TIMEOUT.
        """
        result = self._c.slewring_step(self._session, 1.0 if timeout is None else timeout)
        while result == TIMEOUT and timeout is None:
            result = self._c.slewring_step(self._session, 1.0)
        return result != ENDED and self._checked(result) == OK

    @property
    def blocks_missed(self):
        return self._c.slewring_blocks_missed(self._session)

    def write(self, channel, value):
        self._checked(self._c.slewring_write(self._session, channel, value))

    @property
    def present_step(self):
        return self._c.slewring_present_step(self._session)

    @property
    def time(self):
        return self._c.slewring_time(self._session)

    def notice(self):
        text = self._c.slewring_notice(self._session)
        return text.decode() if text else None
