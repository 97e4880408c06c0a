#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What docs/machines/wheel-loader.md states: speed, tractive force, charge pressure and flushing flow by closed forms.

Usage: wheel_loader_test.py PROJECT SLEWRING travel|pushing|distributed
The closed forms are computed here from the numbers of the scene; of the run they take the state of the machine alone.
"""
import math
import sys
import tempfile

sys.dont_write_bytecode = True
from machine_runs import WHAT, expect, near, record  # noqa: E402

BAR, LITRE_PER_MINUTE, RPM = 1e5, 1e-3 / 60, math.pi / 30
PUMP, MOTOR, CHARGE = (cubic * 1e-6 / (2 * math.pi) for cubic in (56, 107, 11.6))  # m3/rad
RATIO, RADIUS, WEIGHT, ROLLING = 48.6, 0.588, 6400 * 9.81, 0.025
LEAK = 1 * LITRE_PER_MINUTE / (400 * BAR)  # of every leak: port to port and port to case, pump and motor
TANK = 1 * BAR


def lamps(text):
    return [line.split()[2] for line in text.splitlines() if line.startswith("coupling ")]


def travel_speed(now):
    """Displacement ratio times engine speed, less leakage; the tyres' slip is left out [m/s]."""
    forth = math.copysign(1, now["Pump.swash"])
    high, low = sorted((now["Vol_A.pressure"], now["Vol_B.pressure"]), reverse=True)
    leaks = forth * (2 * LEAK * (high - low) + 2 * LEAK * (high - TANK))
    shaft = (now["Pump.swash"] * PUMP * now["Engine.speed"] - leaks) / (now["Motor.setting"] * MOTOR)
    return shaft / RATIO * RADIUS


def charge_flows(engine_speed, high):
    """Charge pressure [Pa] and flushing flow [m3/s] at rest, by bisection; the low side takes what the circuit leaks."""
    def root(drop):
        return math.sqrt(max(drop, 0))

    def flushing(low):
        # edge fully open in series with the flushing relief
        lower, upper = TANK, low
        for _ in range(60):
            p = 0.5 * (lower + upper)
            edge = 8 * LITRE_PER_MINUTE / math.sqrt(3.5 * BAR) * root(low - p)
            opening = min(max((p - TANK - 20 * BAR) / (2 * BAR), 0), 1)
            relief = opening * 30 * LITRE_PER_MINUTE / math.sqrt(10 * BAR) * root(p - TANK)
            lower, upper = (p, upper) if edge > relief else (lower, p)
        return edge

    def low_side(charge):
        lower, upper = TANK, charge
        for _ in range(60):
            p = 0.5 * (lower + upper)
            lift = min(max((charge - p - 0.2 * BAR) / (0.5 * BAR), 0), 1)
            fed = lift * 80 * LITRE_PER_MINUTE / math.sqrt(5 * BAR) * root(charge - p)
            # what leaves the circuit: both cases, flushing
            taken = 2 * LEAK * (high + p - 2 * TANK) + flushing(p)
            lower, upper = (p, upper) if fed > taken else (lower, p)
        return p, taken

    supply = CHARGE * 0.95 * engine_speed
    lower, upper = TANK, 40 * BAR
    for _ in range(60):
        charge = 0.5 * (lower + upper)
        low, taken = low_side(charge)
        opening = min(max((charge - TANK - 24 * BAR) / (3 * BAR), 0), 1)
        relief = opening * 60 * LITRE_PER_MINUTE / math.sqrt(10 * BAR) * root(charge - TANK)
        lower, upper = (charge, upper) if supply > taken + relief else (lower, charge)
    return charge, flushing(low)


def travel(folder):
    text, _, run = record("wheel_loader", folder, "--in-process")
    def at(time):
        """Means over the half second before: the machine sways on its oil."""
        rows = [i for i, t in enumerate(run["time"]) if time - 0.5 < t <= time]
        return {name: sum(column[i] for i in rows) / len(rows) for name, column in run.items()}

    good = expect("the lamp is green", lamps(text) == ["green:"])
    for name, time in ("working range", 3.49), ("fast", 9), ("back", 21.9):
        now = at(time)
        good &= near(f"speed, {name}:", now["Chassis.velocity.x"], travel_speed(now), 0.01, "m/s")
    now = at(9)
    charge, flushed = charge_flows(now["Engine.speed"], now["Vol_A.pressure"])
    good &= near("charge pressure:", now["Vol_Charge.pressure"] / BAR, charge / BAR, 0.01, "bar")
    good &= near("flushing flow:", now["Flushing.flow_2"] / LITRE_PER_MINUTE, flushed / LITRE_PER_MINUTE, 0.03, "l/min")
    # governor: w = w_s (1 + droop (1 - u))
    governed = 2300 * (1 + 0.05 * (1 - now["Engine.fuel"]))
    good &= near("engine:", now["Engine.speed"] / RPM, governed, 1e-3, "rpm")
    low = [min(a, b) for a, b in zip(run["Vol_A.pressure"], run["Vol_B.pressure"])]
    good &= expect(f"the low side keeps {min(low) / BAR:.1f} bar at least", min(low) > 10 * BAR)
    good &= expect("no volume cavitates", "cavitated" not in text)
    good &= expect("braking turns the engine", min(run["Pump.power"]) < -1e3 and max(run["Engine.speed"]) > 2420 * RPM)
    good &= expect("the machine goes forth and back", max(run["Chassis.velocity.x"]) > 5 and
                   min(run["Chassis.velocity.x"]) < -0.7)
    good &= expect("and the brake holds it", abs(run["Chassis.velocity.x"][-1]) < 1e-3)
    return good


def pushing(folder):
    text, _, run = record("wheel_loader_pushing", folder, "--in-process")
    now = {name: column[-1] for name, column in run.items()}
    high, low = now["Vol_A.pressure"], now["Vol_B.pressure"]
    good = expect("the lamp is green", lamps(text) == ["green:"])
    # all oil of the pump that does not leak passes the relief valve; its opening is its flow over that of the drop
    passed = now["Pump.swash"] * PUMP * now["Engine.speed"] - 2 * LEAK * (high - low) - 2 * LEAK * (high - TANK)
    passed -= MOTOR * now["Motor.speed"]
    drop = 400 * BAR
    for _ in range(50):
        opening = passed / (150 * LITRE_PER_MINUTE * math.sqrt(drop / (10 * BAR)))
        drop = 400 * BAR + opening * 7 * BAR
    good &= near("pressure at the relief valve:", (high - low) / BAR, drop / BAR, 0.002, "bar")
    torque = drop * MOTOR * 0.95 - 6
    ideal = drop * MOTOR * RATIO / RADIUS
    # the wheels creep by the slip that the force needs; below the slip speed of 0.1 m/s they roll more easily
    rolled = now["Motor.speed"] / RATIO * RADIUS
    force = torque * RATIO / RADIUS - ROLLING * WEIGHT * rolled / math.hypot(rolled, 0.1)
    good &= near("force on the wall:", now["Wall.force"] / 1e3, force / 1e3, 0.002, "kN")
    print(f"dp Vg/(2 pi) i/r = {ideal / 1e3:.2f} kN without losses")
    good &= expect("the engine keeps running", now["Engine.speed"] > 2300 * RPM)
    return good


def distributed(folder):
    """In one process and in processes of their own the recorded variables are the same but for those of timing."""
    runs = []
    for name, options in ("one", ("--in-process",)), ("many", ()):
        runs.append(record("wheel_loader", f"{folder}/{name}", "--duration", "2", *options)[2])
    timing = ("cpu_time", "release_jitter", "wait", "allocations", "step_time", "step_time_max", "response")
    names = [name for name in runs[0] if name in runs[1] and name.rpartition(".")[2] not in timing]
    different = [name for name in names if not all(
        a == b or (math.isnan(a) and math.isnan(b)) for a, b in zip(runs[0][name], runs[1][name]))]
    print(f"{len(names)} variables, {len(runs[0]['time'])} instants; different: {different}")
    return expect("the same bits", len(names) > 150 and not different)


with tempfile.TemporaryDirectory() as work:
    sys.exit(0 if {"travel": travel, "pushing": pushing, "distributed": distributed}[WHAT](work) else 1)
