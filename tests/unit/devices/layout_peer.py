#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Peer of the byte layouts, by ctypes and struct: the layout of byte_layout_test.cpp written a second time.

layout_peer.py ORDER PACKING unpack HEX     prints size, offsets, then the raw values; exit code 1 for a wrong checksum
layout_peer.py ORDER PACKING pack VALUE...  prints a packet as hex
layout_peer.py struct ORDER HEX             the packet with packing 1 by the module struct
layout_peer.py sums HEX                     checksums of bytes: sum8 xor8 crc16_ccitt crc32
"""
import binascii
import ctypes
import struct
import sys
import zlib
from functools import reduce

FIELDS = [
    ("is_on", ctypes.c_uint8), ("count", ctypes.c_uint16), ("level", ctypes.c_int8), ("total", ctypes.c_uint32),
    ("lift", ctypes.c_float), ("far", ctypes.c_int64), ("small", ctypes.c_int16), ("pressure", ctypes.c_double),
    ("lamps", ctypes.c_uint16), ("check", ctypes.c_uint32),
]


def struct_of(order, packing):
    base = ctypes.LittleEndianStructure if order == "little" else ctypes.BigEndianStructure
    return type("Packet", (base,), {"_pack_": packing, "_fields_": FIELDS})


def check_of(kind, packet):
    begin = kind.check.offset
    return zlib.crc32(packet[:begin] + packet[begin + 4:])


def main(arguments):
    if arguments[0] == "sums":
        data = bytes.fromhex(arguments[1])
        print(sum(data) % 256, reduce(lambda a, b: a ^ b, data, 0), binascii.crc_hqx(data, 0xFFFF), zlib.crc32(data))
        return 0
    if arguments[0] == "struct":
        order = "<" if arguments[1] == "little" else ">"
        print(*struct.unpack(order + "BHbIfqhdHI", bytes.fromhex(arguments[2])))
        return 0
    kind = struct_of(arguments[0], int(arguments[1]))
    if arguments[2] == "unpack":
        packet = bytes.fromhex(arguments[3])
        if len(packet) != ctypes.sizeof(kind):
            return 2
        values = kind.from_buffer_copy(packet)
        print(ctypes.sizeof(kind), *[getattr(kind, name).offset for name, _ in FIELDS])
        print(*[repr(getattr(values, name)) for name, _ in FIELDS])
        return 0 if values.check == check_of(kind, packet) else 1
    values = kind()
    for (name, of), text in zip(FIELDS, arguments[3:]):
        setattr(values, name, float(text) if of in (ctypes.c_float, ctypes.c_double) else int(text))
    values.check = check_of(kind, bytes(values))
    print(bytes(values).hex())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
