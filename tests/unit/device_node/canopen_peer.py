# SPDX-License-Identifier: Apache-2.0
"""Node 5 on a CAN interface, by the library canopen:  canopen_peer.py INTERFACE

Boots, waits for NMT start, sends TPDO 1 for a while, is silent for a while, and does the same again as a restarted node.
Ends after the second time. The library needs the kernel module can_bcm. Exit code 77: python3 has no canopen.
"""
import sys
import time

try:
    import canopen
except ImportError as error:
    print(f"python3 cannot import canopen: {error}")
    sys.exit(77)

DEADLINE = 240  # s
network = canopen.Network()
network.connect(interface="socketcan", channel=sys.argv[1])
for _ in range(2):
    node = canopen.LocalNode(5, canopen.ObjectDictionary())
    network.add_node(node)
    node.nmt.state = "INITIALISING"
    node.nmt.state = "PRE-OPERATIONAL"
    node.nmt.start_heartbeat(50)
    end = time.monotonic() + DEADLINE
    while node.nmt.state != "OPERATIONAL":
        if time.monotonic() > end:
            sys.exit("FAILED: the node was not started")
        time.sleep(0.01)
    for _ in range(50):
        network.send_message(0x185, (500).to_bytes(2, "little", signed=True) + b"\x01")
        time.sleep(0.05)
    node.nmt.stop_heartbeat()
    del network[5]
    time.sleep(3)
network.disconnect()
