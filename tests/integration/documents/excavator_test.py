#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What docs/machines/excavator.md states: digging forces by lever arms, and the end of the cycle.

Usage: excavator_test.py PROJECT SLEWRING digging|cycle|chart|levers
The lever arms are computed here from the pins of the scene, by plane geometry alone.
"""
import json
import math
import sys
import tempfile

sys.dont_write_bytecode = True
from machine_runs import PROJECT, WHAT, expect, output, record  # noqa: E402

STICK, TEETH, BOOM = 2.92, 1.47, 5.70  # lengths between the pins [m]
FOOT = (0.05, 1.75)


def polar(length, angle):
    return (length * math.cos(angle), length * math.sin(angle))


def plus(a, b):
    return (a[0] + b[0], a[1] + b[1])


def arm(pin, start, end):
    """Distance of a pin from the line of a force."""
    x, y = end[0] - start[0], end[1] - start[1]
    return abs((start[0] - pin[0]) * y - (start[1] - pin[1]) * x) / math.hypot(x, y)


def intersection(a, radius_a, b, radius_b):
    """The intersection of two circles on the left of the line from a to b."""
    x, y = b[0] - a[0], b[1] - a[1]
    distance = math.hypot(x, y)
    along = (radius_a**2 - radius_b**2 + distance**2) / (2 * distance)
    across = math.sqrt(radius_a**2 - along**2)
    return (a[0] + (along * x - across * y) / distance, a[1] + (along * y + across * x) / distance)


def lever_of_bucket_cylinder(bucket):
    """Arms about the pins of rocker and bucket, stick's axes."""
    pin, rocker, barrel = (STICK, 0.0), (STICK - 0.46, 0.02), (0.30, 0.65)
    link = plus(pin, polar(0.50, bucket + math.radians(112)))
    end = intersection(rocker, 0.64, link, 0.60)
    return arm(rocker, barrel, end) / arm(rocker, end, link) * arm(pin, end, link)


def lever_of_stick_cylinder(stick):
    return arm((BOOM, 0.0), (3.05, 0.90), plus((BOOM, 0.0), polar(0.84, stick + math.radians(160))))


def pins(boom, stick, bucket):
    """Boom's tip, bucket's pin and teeth, axes of Ground."""
    tip = plus(FOOT, polar(BOOM, boom))
    pin = plus(tip, polar(STICK, boom + stick))
    return tip, pin, plus(pin, polar(TEETH, boom + stick + bucket))


def digging(folder):
    tip, pin, teeth = pins(*map(math.radians, (10, -71.3, -26)))
    good = True
    for stick_digs, name, rod in (0, "Bucket_Cylinder", 0.085), (1, "Stick_Cylinder", 0.100):
        _, _, run = record("excavator_20t_digging", f"{folder}/{stick_digs}", "--in-process", "--set", f"stick_digs={stick_digs}")
        last = {key: values[-1] for key, values in run.items()}
        angles = [last[joint + ".position"] for joint in ("Boom_Foot", "Stick_Pin", "Bucket_Pin")]
        # the spring from the teeth to its point in Ground, 3 m behind the teeth as they stood at the start
        x, y = teeth[0] - (pin, tip)[stick_digs][0], teeth[1] - (pin, tip)[stick_digs][1]
        radius = math.hypot(x, y)
        anchor = (teeth[0] - 3 * y / radius, teeth[1] + 3 * x / radius)
        now = pins(*angles)
        lever = lever_of_stick_cylinder(angles[1]) if stick_digs else lever_of_bucket_cylinder(angles[2])
        by_hand = last[name + ".force"] * lever / arm(now[1 - stick_digs], anchor, now[2])
        bore = 0.140 if stick_digs else 0.120
        area_a, area_b = math.pi / 4 * bore**2, math.pi / 4 * (bore**2 - rod**2)
        of_pressures = last[name + ".pressure_a"] * area_a - last[name + ".pressure_b"] * area_b
        of_pressures *= by_hand / last[name + ".force"]
        force = -last["Teeth.force"]
        print(f"{name}: {force:.0f} N at the teeth, by hand {by_hand:.0f} N, without friction {of_pressures:.0f} N")
        good &= expect("the teeth have the force of the lever arms", abs(force / by_hand - 1) < 1e-4)
        good &= expect("friction takes up to 3 %", 0 < of_pressures - force < 0.03 * force)
        good &= expect("the cylinder has the working pressure", abs(last[name + ".pressure_a"] / 350e5 - 1) < 0.01)
    return good


def cycle(folder):
    text, _, run = record("excavator_20t", folder, "--in-process")
    lamps = [line.split()[2] for line in text.splitlines() if line.startswith("coupling ")]
    good = expect("all lamps are green", lamps == ["green:"] * 5)
    for joint in "Ring", "Boom_Foot", "Stick_Pin", "Bucket_Pin":
        position = run[joint + ".position"]
        good &= expect(f"{joint} returns", abs(position[-1] - position[0]) < math.radians(1))
    good &= expect("the structure slews by 90 deg", abs(max(run["Ring.position"]) - math.radians(90)) < math.radians(2))
    good &= expect("and stands at the end", abs(run["Ring.velocity"][-1]) < math.radians(0.2))
    bucket = run["Bucket_Pin.position"]
    good &= expect("the bucket curls and opens", min(bucket) < math.radians(-90) and max(bucket) > 0)
    good &= expect("the main relief stays closed", max(run["Vol_P.pressure"]) < 350e5 and max(run["Relief.flow"]) <= 0)
    good &= expect("no volume cavitates", "cavitated" not in text)
    good &= expect("the engine does not stall", max(run["Engine.is_stalled"]) == 0)
    return good


def loads(*options):
    """Load of each limit [kg] at the start of the cycle, by name."""
    chart = json.loads(output("loadchart", f"{PROJECT}/scenes/excavator_20t.yaml", "--over", "Boom_Foot=-18deg,-17deg",
                              "--json", "--quiet", *options))
    return chart["poses"][0]


def chart(_):
    """Changes of the loads: other masses than the load drop out of them, so that lever arms alone remain."""
    boom, stick, bucket = map(math.radians, (-18, -100, -30))
    tip, pin, teeth = pins(boom, stick, bucket)
    along = boom + stick + bucket
    load = plus(pin, (0.70 * math.cos(along) - 0.15 * math.sin(along), 0.70 * math.sin(along) + 0.15 * math.cos(along)))
    foot = plus(FOOT, (0.82 * math.cos(math.radians(56)), -0.82 * math.sin(math.radians(56))))
    boom_lever = 2 * arm(FOOT, foot, plus(FOOT, polar(2.35, boom + math.radians(27))))
    low, high = (loads("--structure", f"Left_Cylinder={force}kN", "--structure", f"Stick_Cylinder={force}kN",
                       "--tipping-line", f"{place} 0 -1, {place} 0 1") for force, place in ((400, 1.5), (500, 2)))
    good = expect("the reach is that of the pins", abs(low["reach"] - load[0]) < 1e-6)
    for name, lever, distance in (("Left_Cylinder structure", boom_lever, load[0] - FOOT[0]),
                                  ("Stick_Cylinder structure", lever_of_stick_cylinder(stick), tip[0] - load[0])):
        by_hand = 100e3 * lever / (9.81 * abs(distance))
        good &= expect(f"{name}: {high[name] - low[name]:.2f} kg, by hand {by_hand:.2f} kg",
                       abs((high[name] - low[name]) / by_hand - 1) < 1e-4)
    # m (R - x) = M x - S: the slope is the mass of the machine without the load
    mass = ((high["tipping"] * (load[0] - 2)) - (low["tipping"] * (load[0] - 1.5))) / 0.5
    of_scene = 7500 + 9800 + 1700 + 700 + 847 + 60 + 80 + 190 + 135 + 115 + 75 + 2 * (125 + 85)
    good &= expect(f"mass {mass:.3f} kg, by hand {of_scene} kg", abs(mass - of_scene) < 1e-3)
    return good


def levers(folder):
    full = ", ".join(f"Input_{name}: [[0 s, 0], [1 s, 0], [1.5 s, {stick}]]" for name, stick in
                     (("Lift", 1), ("Crowd", -1), ("Curl", -1), ("Slew", 1)))
    good = True
    for limit in 0, 560:
        _, _, run = record("excavator_20t", f"{folder}/{limit}", "--in-process", "--duration", "4", "--set", f"Pump.maximum_torque={limit}Nm",
                        "--set", f"script.inputs={{{full}, Input_Brake: [[0 s, 0], [0.5 s, 1]]}}")
        stalls = max(run["Engine.is_stalled"]) > 0
        good &= expect(f"with a limit of {limit} Nm the engine {'stalls' if stalls else 'keeps running'}", stalls == (limit == 0))
        last = run["Pump.torque"][-100:]  # a second; the swash lags behind pressures that swing
        torque = sum(last) / len(last)
        good &= expect(f"the torque is {torque:.1f} Nm in the last second", limit == 0 or abs(torque - limit) < 0.03 * limit)
    return good


with tempfile.TemporaryDirectory() as work:
    sys.exit(0 if {"digging": digging, "cycle": cycle, "chart": chart, "levers": levers}[WHAT](work) else 1)
