#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The legs of a motion platform under the driver of a live crane, against computations of this file alone:

platform_test.py SOURCES SLEWRING

1. the specific force and the rates of each packet are those of the recorded motion of the body;
2. the pose follows from them by the washout, integrated by Runge-Kutta, with ramp and soft limits;
3. the legs follow from the pose by inverse kinematics;
4. a turn tilts the seat nose down; at rest again the platform is back at neutral.
"""
import json
import math
import os
import socket
import struct
import subprocess
import sys
import tempfile
import threading

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from domains import take_domain  # noqa: E402
from waiting import DEADLINE, require, text_of, wait_for  # noqa: E402

SOURCES, SLEWRING = sys.argv[1:3]
SCENE = f"{SOURCES}/scenes/truck_crane_platform.yaml"
LAYOUT = struct.Struct("<I6fB13d")
STANDARD_GRAVITY, GRAVITY = 9.80665, 9.81
PARKED, RISING, RAMPING_IN, ACTIVE, FROZEN, WASHING_BACK, LOWERING = range(7)
POINT = (-6.0, 1.0, 0.0)  # in axes of the pillar: far out, so that the turn is felt
STEP, RAMP = 0.005, 0.5
FORCE_SCALE, RATE_SCALE, RETURN = 2.0, 0.5, 1.0
SETTINGS = {"Seat.point": list(POINT), "Seat.force_scale": [FORCE_SCALE] * 3, "Seat.rate_scale": [RATE_SCALE] * 3,
            "Seat.return_frequency": [RETURN] * 3, "Seat.rise_time": 0.5, "Seat.ramp_time": RAMP,
            # a machine under load may stop a process for a while
            "Seat.freeze_after": 10, "session.give_up_after": 60, "session.duration": 16}
INPUT = "time,Input_Slew,Input_Lift\n0,0,0\n2,0,0\n2,-1,0\n9,-1,0\n9,0,0\n"  # a turn from 2 s to 9 s


class Packet:
    def __init__(self, data):
        values = LAYOUT.unpack(data)
        self.count, self.legs, self.phase = values[0], values[1:7], values[7]
        self.position, self.angles = values[8:11], values[11:14]
        self.force, self.rate, self.time = values[14:17], values[17:20], values[20]


def record(link, packets, has_ended):
    while not has_ended.is_set():
        try:
            packets.append(Packet(link.recv(LAYOUT.size + 1)))
        except socket.timeout:
            pass


# ---- geometry ---------------------------------------------------------------------------------------------------

def turned(vector, axis, angle):
    """About axis 0, 1 or 2."""
    a, b = (axis + 1) % 3, (axis + 2) % 3
    result = list(vector)
    result[a] = math.cos(angle) * vector[a] - math.sin(angle) * vector[b]
    result[b] = math.sin(angle) * vector[a] + math.cos(angle) * vector[b]
    return result


def legs_of(seat, packet):
    lengths = []
    for base, joint in zip(seat["base_joints"], seat["platform_joints"]):
        p = joint
        for axis in range(3):
            p = turned(p, axis, packet.angles[axis])
        p = [p[i] + packet.position[i] + (seat["neutral_height"] if i == 2 else 0) for i in range(3)]
        lengths.append(math.dist(p, base))
    return lengths


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def rotated(q, v):
    """v + 2 w (u x v) + 2 u x (u x v) for q = (w, u)."""
    t = [2 * x for x in cross(q[1:], v)]
    return [v[i] + q[0] * t[i] + cross(q[1:], t)[i] for i in range(3)]


def in_seat(q, v):
    x, y, z = rotated([q[0]] + [-u for u in q[1:]], v)
    return [-x, z, y]  # forward -x, left z, up y of the pillar


# ---- washout ----------------------------------------------------------------------------------------------------

def runge_kutta(state, slope, h, steps=10):
    h /= steps
    for _ in range(steps):
        k1 = slope(state)
        k2 = slope([s + h / 2 * k for s, k in zip(state, k1)])
        k3 = slope([s + h / 2 * k for s, k in zip(state, k2)])
        k4 = slope([s + h * k for s, k in zip(state, k3)])
        state = [s + h / 6 * (a + 2 * b + 2 * c + d) for s, a, b, c, d in zip(state, k1, k2, k3, k4)]
    return state


def within(value, most):
    return max(-most, min(most, value))


def soft(q, limit):
    linear = 0.8 * limit
    if abs(q) <= linear:
        return q
    return math.copysign(linear + (limit - linear) * math.tanh((abs(q) - linear) / (limit - linear)), q)


class Washout:
    """With the defaults of the card but for SETTINGS."""
    frequency, tilt_frequency, tilt_rate = (2.5, 2.5, 3.5), 5.0, math.radians(3)

    def __init__(self):
        self.moved = [[0.0] * 3 for _ in range(3)]   # a high pass of third order: y, y', y''
        self.turned = [[0.0] * 2 for _ in range(3)]  # of second order
        self.low = [[0.0] * 2 for _ in range(2)]
        self.tilt = [0.0, 0.0]

    def step(self, force, rate):
        position, angles, u = [], [], []
        for i in range(3):
            w, b = self.frequency[i], RETURN
            u.append(within(FORCE_SCALE * (force[i] - (STANDARD_GRAVITY if i == 2 else 0)), 5))
            self.moved[i] = runge_kutta(self.moved[i], lambda y: [
                y[1], y[2], u[i] - (2 * w + b) * y[2] - (w * w + 2 * w * b) * y[1] - w * w * b * y[0]], STEP)
            position.append(self.moved[i][1])
            r = within(RATE_SCALE * rate[i], 1)
            self.turned[i] = runge_kutta(self.turned[i], lambda y: [y[1], r - 2 * y[1] - y[0]], STEP)
            angles.append(self.turned[i][1])
        w = self.tilt_frequency
        for i in range(2):
            self.low[i] = runge_kutta(self.low[i], lambda y: [y[1], w * w * u[i] - 2 * w * y[1] - w * w * y[0]], STEP)
        most = math.sin(math.radians(15))
        pitch = -math.asin(within(self.low[0][0] / STANDARD_GRAVITY, most))
        roll = math.asin(within(self.low[1][0] / (STANDARD_GRAVITY * math.cos(pitch)), most))
        for i, wanted in enumerate((roll, pitch)):
            self.tilt[i] += within(wanted - self.tilt[i], self.tilt_rate * STEP)
            angles[i] += self.tilt[i]
        return position, angles


def poses_of(packets):
    """For packets from the first of phase ramping in to the last of phase active."""
    washout, steps = Washout(), 0
    for packet in packets:
        position, angles = washout.step(packet.force, packet.rate)
        steps += 1
        share = min(1.0, steps * STEP / RAMP) if packet.phase == RAMPING_IN else 1.0
        gain = share * share * (3 - 2 * share)
        yield ([soft(gain * q, limit) for q, limit in zip(position, (0.15, 0.15, 0.1))],
               [soft(gain * q, math.radians(15)) for q in angles])


# ---- the session ------------------------------------------------------------------------------------------------

def exported(recording):
    """Rows of the body's motion by time in ms: velocity, orientation, angular velocity."""
    names = [f"Truck_Pillar.{part}" for part in ("velocity.x", "velocity.y", "velocity.z", "orientation.w", "orientation.x",
                                                 "orientation.y", "orientation.z", "angular_velocity.x",
                                                 "angular_velocity.y", "angular_velocity.z")]
    done = subprocess.run([SLEWRING, "export", recording, *names, "--csv"], capture_output=True, text=True, timeout=DEADLINE)
    require(done.returncode == 0, f"export: {done.stdout}{done.stderr}")
    rows = {}
    for line in done.stdout.strip().split("\n"):
        if line[:1].isdigit():
            time, *values = (float(word) for word in line.split(","))
            rows[round(time * 1000)] = values
    return rows


def felt(before, now, dt):
    def velocity(row):
        arm = rotated(row[3:7], POINT)
        return [a + b for a, b in zip(row[0:3], cross(row[7:10], arm))]

    force = [(b - a) / dt for a, b in zip(velocity(before), velocity(now))]
    force[1] += GRAVITY
    return in_seat(now[3:7], force), in_seat(now[3:7], now[7:10])


def run(folder, domain, port):
    arguments = [SLEWRING, "run", SCENE, "--domain", domain, "--out", f"{folder}/runs", "--quiet", "--json",
                 "--input", f"{folder}/turn.csv", "--set", f"Seat.send=127.0.0.1:{port}"]
    with open(f"{folder}/turn.csv", "w", encoding="utf-8") as file:
        file.write(INPUT)
    for path, value in SETTINGS.items():
        arguments += ["--set", f"{path}={json.dumps(value)}"]
    with open(f"{folder}/run.err", "w") as err:
        done = subprocess.run(arguments, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=err, text=True, cwd=folder,
                              timeout=3 * DEADLINE)
    require(done.returncode == 0, f"the run ended with {done.returncode}:\n{text_of(f'{folder}/run.err')}")
    return json.loads(done.stdout)


def close(a, b, tolerance, what):
    for i, (x, y) in enumerate(zip(a, b)):
        require(abs(x - y) <= tolerance, f"{what}, component {i}: {x} instead of {y}")


def main(folder):
    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4_000_000)
    link.bind(("127.0.0.1", 0))
    link.settimeout(0.2)
    packets, has_ended = [], threading.Event()
    listener = threading.Thread(target=record, args=(link, packets, has_ended))
    listener.start()
    try:
        result = run(folder, take_domain(), link.getsockname()[1])
    finally:
        has_ended.set()
        listener.join()
    summary = result["devices"]["Seat"]["summary"]["packets"]
    require(summary["sent"] == len(packets) and summary["unsent"] == 0, f"{len(packets)} received: {summary}")
    require([p.count for p in packets] == list(range(packets[0].count, packets[0].count + len(packets))), "gaps in the sequence")
    order = [p.phase for i, p in enumerate(packets) if i == 0 or p.phase != packets[i - 1].phase]
    require(order == [PARKED, RISING, RAMPING_IN, ACTIVE, WASHING_BACK, LOWERING, PARKED], f"phases {order}")
    check_forces(packets, exported(result["recording"]))
    moving = [p for p in packets if p.phase in (RAMPING_IN, ACTIVE)]
    for packet, (position, angles) in zip(moving, poses_of(moving)):
        close(packet.position, position, 1e-9, f"position at {packet.time}")
        close(packet.angles, angles, 1e-9, f"angles at {packet.time}")
    seat = geometry()
    for packet in packets:
        close(packet.legs, legs_of(seat, packet), 1e-6, f"legs at {packet.time}")  # float32
    check_turn_and_rest(moving)
    print(f"{len(packets)} packets, {len(moving)} in motion, largest tilt {max(abs(p.angles[1]) for p in moving):.4f} rad")


def check_forces(packets, rows):
    samples = [p for i, p in enumerate(packets) if p.time > 0 and p.time != packets[i - 1].time]
    require(len(samples) > 1000, f"{len(samples)} samples")
    for before, packet in zip(samples, samples[1:]):
        force, rate = felt(rows[round(before.time * 1000)], rows[round(packet.time * 1000)], packet.time - before.time)
        close(packet.force, force, 1e-8, f"force at {packet.time}")
        close(packet.rate, rate, 1e-12, f"rate at {packet.time}")


def check_turn_and_rest(moving):
    """A turn is felt towards its axis, nose down; at rest again the platform is back at neutral. The ring's speed is not
    steady: the tilt of a steady turn is held against its closed form in the unit tests of the washout."""
    require(max(p.angles[1] for p in moving) > 0.01, "the turn did not tilt the platform")
    end = moving[-1]
    close(end.position, (0, 0, 0), 2e-3, "position at the end")
    close(end.angles, (0, 0, 0), 3e-3, "angles at the end")
    require(max(abs(p.position[0]) for p in moving) > 5e-3, "the begin of the turn did not move the platform")


def geometry():
    """Of the scene's text, in metres."""
    seat, key = {"base_joints": [], "platform_joints": []}, None
    for line in text_of(SCENE).split("\n"):
        words = line.strip().split(":")
        if words[0] in seat and words[1:] == [""]:
            key = words[0]
        elif key and line.strip().startswith("- ["):
            numbers = line.strip()[3:-1].split(",")
            seat[key].append([float(number.replace("mm", "")) / 1000 for number in numbers])
        elif words[0] == "neutral_height":
            seat["neutral_height"], key = float(words[1].replace("mm", "")) / 1000, None
    require(len(seat["base_joints"]) == 6 and len(seat["platform_joints"]) == 6, f"{seat}")
    return seat


with tempfile.TemporaryDirectory(prefix="slewring_platform_") as scratch:
    main(scratch)
print("passed")
