#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What docs/machines/forwarder.md states: cylinder forces at rest, load chart, slewing speed, load holding, work cycle.

Usage: forwarder_test.py PROJECT SLEWRING rest|chart|slewing|holding|cycle
The statics are computed here from the pins and masses of the published crane, by plane geometry alone.
"""
import json
import math
import sys
import tempfile

sys.dont_write_bytecode = True
from machine_runs import PROJECT, WHAT, expect, near, output, record  # noqa: E402

K, GRAVITY, BASE = 1.25, 9.81, 1.7
BORE, ROD = K * 0.100, K * 0.056
AREA_A = math.pi / 4 * BORE**2
AREA_B = math.pi / 4 * (BORE**2 - ROD**2)


def at(origin, angle, point):
    """A point of a body in Ground."""
    return (origin[0] + math.cos(angle) * point[0] - math.sin(angle) * point[1],
            origin[1] + math.sin(angle) * point[0] + math.cos(angle) * point[1])


def between(start, end, share):
    return tuple(a + share * (b - a) for a, b in zip(start, end))


def intersection(a, radius_a, b, radius_b):
    """The intersection of two circles on the left of the line from a to b."""
    x, y = b[0] - a[0], b[1] - a[1]
    distance = math.hypot(x, y)
    along = (radius_a**2 - radius_b**2 + distance**2) / (2 * distance)
    across = math.sqrt(radius_a**2 - along**2)
    return (a[0] + (along * x - across * y) / distance, a[1] + (along * y + across * x) / distance)


class Crane:
    """Pins and weights at the angles of lift and fold boom [rad] and the way of each stage [m]."""

    def __init__(self, lift, fold, stage, load):
        k, boom, outer = K, lift, lift + fold
        self.pin = (-k * 0.09, BASE + k * 1.4261)
        foot, lug = (k * 0.17, BASE + k * 0.386113), at(self.pin, boom, (k * 0.3025, -k * 0.105))
        self.fold_pin = at(self.pin, boom, (k * 2.881081, k * 0.021593))
        barrel = at(self.pin, boom, (k * 1.263, k * 0.206702))
        rocker = at(self.pin, boom, (k * 2.69, -k * 0.006593))
        link = at(self.fold_pin, outer, (-k * 0.095, k * 0.240432))
        end = intersection(rocker, k * 0.459198, link, k * 0.475)
        first = at(self.fold_pin, outer, (stage - k * 0.415, k * 0.195))
        second = at(first, outer, (stage + k * 0.1, 0))
        self.tip = at(second, outer, (k * 2.45, k * 0.05))
        rear = at(self.fold_pin, outer, (-0.50, 0.42))
        front = at(first, outer, (2.25 - 0.50 + k * 0.415, 0.42 - k * 0.195))
        self.lift_line, self.fold_line = (foot, lug), (barrel, end)
        lift_parts = self.cylinder(foot, lug, 60, 0.45, 32, 0.45)
        fold_parts = self.cylinder(barrel, end, 75, 0.60, 42, 0.60)
        extend_parts = self.cylinder(rear, front, 40, 1.05, 27, 1.05)
        self.weights = [
            (k**3 * 143.66, at(self.pin, boom, (k * 1.229248, k * 0.055596))),
            (k**3 * 157.871, at(self.fold_pin, outer, (k * 0.659935, k * 0.251085))),
            (k**3 * 11.524, between(rocker, end, 0.257068 / 0.459198)), (k**3 * 7.9, between(end, link, 0.5)),
            (k**3 * 58.63, at(first, outer, (k * 1.15, k * 0.06))), (k**3 * 35, at(second, outer, (k * 1.15, k * 0.06))),
            (270 + load, self.tip)] + lift_parts + fold_parts + extend_parts

    @staticmethod
    def cylinder(start, end, barrel, from_start, rod, from_end):
        length = math.dist(start, end)
        return [(barrel, between(start, end, from_start / length)), (rod, between(end, start, from_end / length))]

    def potential(self):
        return sum(mass * GRAVITY * place[1] for mass, place in self.weights)


def static_force(line, coordinate, lift, fold, stage, load=600):
    """Force of a cylinder by virtual work: dE/dlength, with all other cylinders held but for what turns along."""
    step, poses = 1e-6, []
    for sign in 1, -1:
        angles = {"lift": lift, "fold": fold}
        angles[coordinate] += sign * step
        poses.append(Crane(angles["lift"], angles["fold"], stage, load))
    lengths = [math.dist(*getattr(pose, line)) for pose in poses]
    return (poses[0].potential() - poses[1].potential()) / (lengths[0] - lengths[1]), (lengths[0] - lengths[1]) / (2 * step)


def rest(folder):
    good = True
    for number, (lift, fold, stage) in enumerate(((10, -2, 0), (-5, -30, 1.95), (45, -100, 0.8))):
        _, _, run = record("forwarder_crane", f"{folder}/{number}", "--in-process", "--duration", "0.01", "--set", f"lift_start={lift}deg",
                        "--set", f"fold_start={fold}deg", "--set", f"stage_start={stage}m")
        angles = math.radians(lift), math.radians(fold)
        first = {name: column[0] for name, column in run.items()}
        good &= near("tip's reach:", first["Log.position.x"], Crane(*angles, stage, 600).tip[0], 1e-6, "m")
        for name, line, coordinate in ("Lift", "lift_line", "lift"), ("Fold", "fold_line", "fold"):
            force, _ = static_force(line, coordinate, *angles, stage)
            good &= near(f"{name} cylinder:", first[f"{name}_Cylinder.force"], force, 1e-5, "N")
        pressure = (static_force("lift_line", "lift", *angles, stage)[0] + first["Lift_Cylinder_B.pressure"] * AREA_B) / AREA_A
        good &= near("pressure of the lift cylinder:", first["Lift_Cylinder_A.pressure"] / 1e5, pressure / 1e5, 1e-5, "bar")
    return good


def chart(_):
    """Loads that the lift cylinder's full pressure bears, and the tested forwarder's net force at 4 m."""
    lift, fold = math.radians(15), math.radians(-98)
    pose = json.loads(output("loadchart", f"{PROJECT}/scenes/forwarder_crane.yaml", "--over", "Fold_Pin=-98deg", "--over",
                             "Lift_Pin=15deg", "--set", "start.Slide_1=0m", "--set", "start.Slide_2=0m", "--structure",
                             "Lift_Cylinder=230kN", "--json", "--quiet"))["poses"][0]
    empty, arm = static_force("lift_line", "lift", lift, fold, 0, 0)
    per_kilogram = static_force("lift_line", "lift", lift, fold, 0, 1)[0] - empty
    good = near("load at 230 kN:", pose["Lift_Cylinder structure"], (230e3 - empty) / per_kilogram, 1e-5, "kg")
    # 211 bar absolute on the bottom side; friction and the back pressure of the return line take the rest
    most = (211e5 * AREA_A - empty) / per_kilogram
    good &= expect(f"at 210 bar {pose['Lift_Cylinder']:.1f} kg, without friction and back pressure {most:.1f} kg",
                   0.9 * most < pose["Lift_Cylinder"] < most)
    print(f"gross lifting torque {211e5 * AREA_A * arm / 1e3:.1f} kNm")
    force, reach = pose["Lift_Cylinder"] * GRAVITY / 1e3, pose["reach"]
    good &= expect(f"at {reach:.2f} m {force:.1f} kN, the tested forwarder 16.1 kN at 4 m",
                   abs(force * reach / (16.1 * 4) - 1) < 0.12)
    return good


def slewing(folder):
    """With an empty grapple and slowly rising flow: a load that swings overtakes the valve."""
    _, _, run = record("forwarder_crane", folder, "--in-process", "--duration", "7", "--set", "log_mass=5kg", "--set",
                    "script.inputs={Input_Slew: [[0 s, 0], [4 s, 1]]}")
    area, radius = math.pi / 4 * 0.125**2, 0.12
    rates = [rate for time, rate in zip(run["time"], run["Slew.velocity"]) if 5 <= time <= 7]
    return near("slewing speed:", math.degrees(sum(rates) / len(rates)), math.degrees(45e-3 / 60 / area / radius), 0.03, "deg/s")


def holding(folder):
    """A burst hose between the directional valve and the counterbalance valve, with and without that valve."""
    burst = ("--duration", "4", "--set", "Lift_Bleed_A.nominal_flow=300 l/min")
    _, _, held = record("forwarder_crane", f"{folder}/held", "--in-process", *burst)
    _, _, open_ = record("forwarder_crane", f"{folder}/open", "--in-process", *burst, "--set",
                      "script.parameters=[{at: 0.1 s, set: Lift_Holding_A.setting_pressure, value: 5 bar}]")
    sunk, fallen = (math.degrees(run["Lift_Pin.position"][0] - run["Lift_Pin.position"][-1]) for run in (held, open_))
    good = expect(f"behind the counterbalance valve the boom sinks by {sunk:.4f} deg in 4 s", abs(sunk) < 0.05)
    return good & expect(f"with a valve that does not hold by {fallen:.1f} deg", fallen > 10)


def cycle(folder):
    text, _, run = record("forwarder_crane_loading", folder, "--in-process")
    lamps = [line.split()[2] for line in text.splitlines() if line.startswith("coupling ")]
    good = expect("no lamp is red", len(lamps) == 6 and "red:" not in lamps)
    good &= expect("every iteration converges", "residual was accepted" not in text)
    for joint, degrees in ("Slew", 1), ("Lift_Pin", 1.5), ("Fold_Pin", 1), ("Near_Pin", 3):
        position = run[joint + ".position"]
        good &= expect(f"{joint} returns", abs(position[-1] - position[0]) < math.radians(degrees))
    good &= expect("the crane slews over the bunk", min(run["Slew.position"]) < math.radians(6))
    good &= expect("both stages go alike", all(abs(a - b) < 1e-9 for a, b in zip(run["Slide_1.position"], run["Slide_2.position"])))
    low = min(min(run[name + ".pressure"]) for name in ("Lift_Cylinder_A", "Fold_Cylinder_B", "Turn_A", "Turn_B"))
    good &= expect(f"no load-side volume is below {low / 1e5:.2f} bar", low > 0.3e5)
    good &= expect("the main relief stays closed", max(run["Relief.flow"]) <= 0)
    return good


with tempfile.TemporaryDirectory() as work:
    verdict = {"rest": rest, "chart": chart, "slewing": slewing, "holding": holding, "cycle": cycle}[WHAT](work)
    sys.exit(0 if verdict else 1)
