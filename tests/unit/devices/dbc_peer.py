#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Peers of the DBC reader and the signals.

dbc_peer.py FILE                 by a regular expression and whole numbers of Python
dbc_peer.py FILE --cantools      by the package cantools; exit code 77 where it is missing
Reads lines "ID HEX" of frames (ID as in the file) and prints for each the signals that it has, "name=value ...", sorted.
"""
import re
import struct
import sys

SIGNAL = re.compile(
    r"^ SG_ (\w+) (M|m\d+)? ?: (\d+)\|(\d+)@([01])([+-]) \(([^,]+),([^)]+)\) \[([^|]+)\|([^]]+)\]", re.MULTILINE)
# what the file has in sections that are not parsed here
FLOATS = {"Single": "f", "Double": "d"}
MORE_CHOICES = {"Wide": {2, 5, 6, 7, 8, 9}}


def raw_of(frame, start, length, is_intel, is_signed, kind):
    if is_intel:
        word = int.from_bytes(frame, "little") >> start
    else:
        first = start // 8 * 8 + 7 - start % 8  # counted from the frame's first bit
        word = int.from_bytes(frame, "big") >> (8 * len(frame) - first - length)
    word &= 2**length - 1
    if kind:
        return struct.unpack(">" + kind, word.to_bytes(length // 8, "big"))[0]
    return word - 2**length if is_signed and word >= 2 ** (length - 1) else word


def own_messages(text):
    messages = {}
    for part in re.split(r"^BO_ (?=\d+ \w+ ?: \d)", text, flags=re.MULTILINE)[1:]:
        messages[int(part.split()[0])] = SIGNAL.findall(part)
    return messages


def own_values(signals, frame):
    raws = {}
    for name, choice, start, length, order, sign, *_ in signals:
        raws[name] = raw_of(frame, int(start), int(length), order == "1", sign == "-", FLOATS.get(name))
    selector = next((raws[s[0]] for s in signals if s[1] == "M"), None)
    values = {}
    for name, choice, *_, factor, offset, lowest, highest in signals:
        if choice not in ("", "M") and selector not in MORE_CHOICES.get(name, {int(choice[1:])}):
            continue
        values[name] = float(factor) * raws[name] + float(offset)
    return values


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        text = file.read()
    if sys.argv[2:] == ["--cantools"]:
        try:
            import cantools
        except ImportError:
            return 77
        database = cantools.database.load_string(text, "dbc")
        values_of = lambda number, frame: database.decode_message(
            number & 0x1FFFFFFF, frame, decode_choices=False, allow_truncated=False)
    else:
        messages = own_messages(text)
        values_of = lambda number, frame: own_values(messages[number], frame)
    for line in sys.stdin:
        number, frame = line.split()
        try:
            values = values_of(int(number), bytes.fromhex(frame))
        except Exception as fault:  # cantools refuses a choice that no signal has
            if "multiplex" not in str(fault).lower():
                raise
            print("unknown-choice")
            continue
        print(*[f"{name}={float(value)!r}" for name, value in sorted(values.items())])
    return 0


if __name__ == "__main__":
    sys.exit(main())
