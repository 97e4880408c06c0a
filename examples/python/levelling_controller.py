#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Levelling with an excavator: the operator, here a script, moves the stick; this program holds the bucket's teeth on
a level line by the boom, and the bucket's angle by the bucket.

    slewring run scenes/excavator_20t_levelling.yaml --pace free &
    levelling_controller.py

a, b, c: angles of boom, stick, bucket; s = a + b + c the bucket's angle, y the height of the teeth. With s' = 0
    y' = L cos(a) a' + M cos(a + b) (a' + b')                          L, M lengths of boom and stick
so that y' = k (y_0 - y), s' = k_s (s_0 - s) give the rates of boom and bucket, and the rates the levers. The boom swings
on its oil; what its pressure p has beyond its mean of the last second, times a conductance G, is taken from its rate.
"""

import argparse
import math
import sys

import slewring_client

BOOM, STICK, TEETH = 5.70, 2.92, 1.47  # lengths between the pins [m], scenes/excavator_20t.yaml
FOOT_X, FOOT_Y = 0.05, 1.75  # the boom's foot [m]
OVERLAP = 0.10  # the metering edges open from this stick value on
# rates at full lever, with the margin over the open metering edge and mean lever arms [rad/s]
LIFTING, LOWERING = 0.30, 0.45
CURLING, OPENING = -0.65, 1.3
MEAN = 1.0  # time of the mean pressure [s]
REST = 0.002  # slower rates are left out: the spools stay centred [rad/s]


def lever(rate, forwards, backwards):
    """Stick value that gives a rate; forwards and backwards are the rates at the values 1 and -1."""
    if abs(rate) < REST:
        return 0.0
    full = forwards if rate * forwards > 0 else -backwards
    return math.copysign(OVERLAP + (1 - OVERLAP) * min(1.0, abs(rate / full)), rate * forwards)


class Levelling:
    """Levers of boom and bucket that hold the height of the teeth and the angle of the bucket."""

    def __init__(self, angles, pressure, options):
        self.height, self.angle = self.teeth(angles)[1], sum(angles)
        self.pressure, self.sum = pressure, 0.0
        self.gain, self.sum_gain, self.angle_gain, self.damping = (
            options.gain, options.sum_gain, options.angle_gain, options.damping)

    @staticmethod
    def teeth(angles):
        a, b, c = angles
        return (FOOT_X + BOOM * math.cos(a) + STICK * math.cos(a + b) + TEETH * math.cos(a + b + c),
                FOOT_Y + BOOM * math.sin(a) + STICK * math.sin(a + b) + TEETH * math.sin(a + b + c))

    def levers(self, angles, rates, pressure, interval):
        a, b, c = angles
        error = self.height - self.teeth(angles)[1]
        self.sum += self.sum_gain * error * interval
        self.pressure += (pressure - self.pressure) * interval / MEAN
        along_stick = STICK * math.cos(a + b)
        boom_rate = (self.gain * error + self.sum - along_stick * rates[1]) / (BOOM * math.cos(a) + along_stick)
        boom_rate -= self.damping * (pressure - self.pressure)
        bucket_rate = self.angle_gain * (self.angle - (a + b + c)) - rates[0] - rates[1]
        return lever(boom_rate, LIFTING, -LOWERING), lever(bucket_rate, CURLING, OPENING)


def main():
    parser = argparse.ArgumentParser(description="Holds height and angle of an excavator's bucket in a running session.")
    parser.add_argument("--session", default="excavator_20t_levelling")
    parser.add_argument("--domain", type=int, default=0)
    parser.add_argument("--gain", type=float, default=4, help="1/s, of the height")
    parser.add_argument("--sum-gain", type=float, default=3, help="1/s2, of the height's integral")
    parser.add_argument("--damping", type=float, default=1e-8, help="rad/s/Pa, of the boom's pressure")
    parser.add_argument("--angle-gain", type=float, default=3, help="1/s, of the bucket's angle")
    parser.add_argument("--travel", type=float, default=4, help="m, way of the teeth over which errors are counted")
    parser.add_argument("--off", action="store_true", help="leaves both levers at rest")
    o = parser.parse_args()

    joints = ("Boom_Foot", "Stick_Pin", "Bucket_Pin")
    with slewring_client.Session(o.session, "levelling_controller", o.domain) as session:
        positions = [session.find(joint + ".position") for joint in joints]
        velocities = [session.find(joint + ".velocity") for joint in joints]
        pressure = session.find("Lift_A.pressure")
        lift, curl = session.acquire("Input_Lift"), session.acquire("Input_Curl")
        levelling, begin, last, travel, heights, angles = None, 0.0, 0.0, 0.0, [], []
        while session.step():
            place = [session.value(variable) for variable in positions]
            if levelling is None:
                levelling, last = Levelling(place, session.value(pressure), o), session.time
                begin = levelling.teeth(place)[0]
            levers = levelling.levers(place, [session.value(variable) for variable in velocities],
                                      session.value(pressure), session.time - last)
            last = session.time
            for channel, value in zip((lift, curl), levers):
                session.write(channel, 0.0 if o.off else value)
            x, y = levelling.teeth(place)
            if travel < o.travel:
                travel = max(travel, begin - x)
                heights.append(y - levelling.height)
                angles.append(sum(place) - levelling.angle)
        if not heights or session.blocks_missed:
            sys.exit(f"levelling_controller: {session.blocks_missed} blocks were missed")
    print(f"the teeth moved by {travel:.2f} m")
    for what, errors, scale, unit in ("height", heights, 1e3, "mm"), ("angle", angles, math.degrees(1), "deg"):
        rms = math.sqrt(sum(error**2 for error in errors) / len(errors))
        print(f"{what}: {scale * rms:.2f} {unit} rms, {scale * min(errors):.2f} to {scale * max(errors):.2f} {unit}")
    return 0 if travel >= o.travel else 1


if __name__ == "__main__":
    try:
        sys.exit(main())
    except slewring_client.Error as error:
        sys.exit(f"levelling_controller: {error}")
