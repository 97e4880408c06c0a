#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What docs/machines/excavator.md states: forces by lever arms, the open centre, ends of the cycles, levelling.

Usage: excavator_test.py PROJECT SLEWRING digging|cycle|chart|levers|rest|open_centre|monolith|levelling|levelling_long
The lever arms are computed here from the pins of the scene, by plane geometry alone.
"""
import json
import math
import os
import pathlib
import re
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
from machine_runs import PROJECT, SLEWRING, WHAT, columns, expect, near, output, record  # noqa: E402

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "support"))
from domains import take_domain  # noqa: E402

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


def at(origin, angle, point):
    """A point of a body in Ground."""
    return (origin[0] + math.cos(angle) * point[0] - math.sin(angle) * point[1],
            origin[1] + math.sin(angle) * point[0] + math.cos(angle) * point[1])


def boom_line(boom):
    """Pins of a boom cylinder."""
    return plus(FOOT, polar(0.82, math.radians(-56))), plus(FOOT, polar(2.35, boom + math.radians(27)))


def weights(boom, stick, bucket, load):
    """Masses and the heights of their centres for the three angles [rad]."""
    tip, pin, _ = pins(boom, stick, bucket)
    arm_angle, along = boom + stick, boom + stick + bucket
    rocker, link = at(tip, arm_angle, (STICK - 0.46, 0.02)), at(pin, along, polar(0.50, math.radians(112)))
    end = intersection(rocker, 0.64, link, 0.60)
    points = [(1700, at(FOOT, boom, (0.46 * BOOM, 0.62))), (700, at(tip, arm_angle, (1.05, 0.08))),
              (847, at(pin, along, (0.62, 0.25))), (load, at(pin, along, (0.70, 0.15))),
              (60, plus(rocker, ((end[0] - rocker[0]) / 2, (end[1] - rocker[1]) / 2))),
              (80, ((end[0] + link[0]) / 2, (end[1] + link[1]) / 2))]
    lines = [(boom_line(boom), 0.8, 125, 85), (boom_line(boom), 0.8, 125, 85),
             ((at(FOOT, boom, (3.05, 0.90)), at(tip, arm_angle, polar(0.84, math.radians(160)))), 0.9, 190, 135),
             ((at(tip, arm_angle, (0.30, 0.65)), end), 0.7, 115, 75)]
    for (start, stop), place, barrel, rod in lines:
        share = place / math.dist(start, stop)
        points += [(barrel, tuple(a + share * (b - a) for a, b in zip(start, stop))),
                   (rod, tuple(b + share * (a - b) for a, b in zip(start, stop)))]
    return sum(mass * 9.81 * place[1] for mass, place in points)


def rest(folder):
    """Pressures that hold the boom by virtual work, and the flow at which orifice and negative control agree."""
    area_a, area_b = math.pi / 4 * 0.120**2, math.pi / 4 * (0.120**2 - 0.085**2)
    good, step, run = True, 1e-6, {}
    for number, angles in enumerate(((-18, -100, -30), (20, -60, -90), (35, -120, -5))):
        _, _, run = record("excavator_20t_open_centre", f"{folder}/{number}", "--in-process", "--duration", "0.01 s",
                           *(f"--set={name}_start={angle} deg" for name, angle in zip(("boom", "stick", "bucket"), angles)))
        boom, stick, bucket = map(math.radians, angles)
        above, below = (weights(boom + sign * step, stick, bucket, 1856) for sign in (1, -1))
        lengths = [math.dist(*boom_line(boom + sign * step)) for sign in (1, -1)]
        force = (above - below) / (lengths[0] - lengths[1]) / 2
        good &= near(f"boom cylinder at {angles} deg:", run["Left_Cylinder.force"][0], force, 1e-5, "N")
        pressure = (force + run["Lift_B.pressure"][0] * area_b) / area_a
        good &= near("its pressure:", run["Lift_A.pressure"][0] / 1e5, pressure / 1e5, 1e-5, "bar")
    _, _, run = record("excavator_20t_open_centre", f"{folder}/idle", "--in-process", "--duration", "2 s", "--set",
                       "script.inputs={Input_Brake: [[0 s, 0]]}")
    full, K = 137e-6 / (2 * math.pi) * run["Engine.speed"][-1] * 0.95, 31e-3 / 60 / math.sqrt(32e5)
    low, high = 0.0, 35e5
    for _ in range(60):
        p = (low + high) / 2
        leak = 0.5e-3 / 60 * (run["Vol_P.pressure"][-1] - 1e5) / 100e5
        low, high = (p, high) if full * (35e5 - p) / 25e5 - leak > K * math.sqrt(p) else (low, p)
    good &= near("control pressure at rest:", (run["Vol_Control.pressure"][-1] - 1e5) / 1e5, low / 1e5, 1e-3, "bar")
    good &= near("flow at rest:", run["Pump_1.flow"][-1] * 6e4, K * math.sqrt(low) * 6e4, 1e-3, "l/min")
    return good


def work(run, *powers):
    """Integral of the sum of columns over the time by trapezoids [J]."""
    total = [sum(values) for values in zip(*(run[power] for power in powers))]
    return sum((b - a) * (p + q) / 2 for a, b, p, q in zip(run["time"], run["time"][1:], total, total[1:]))


def open_centre(folder):
    _, _, sensed = record("excavator_20t", f"{folder}/ls", "--in-process")
    text, _, run = record("excavator_20t_open_centre", f"{folder}/open", "--in-process")
    lamps = [line.split()[2] for line in text.splitlines() if line.startswith("coupling ")]
    good = expect("all lamps are green", lamps == ["green:"] * 5)
    # between the motions of each joint
    for joint, degrees, instants in (("Ring", 1, (8.3, 12.8)), ("Boom_Foot", 0.3, (5.5, 14.8)), ("Stick_Pin", 0.3, (9.3, 14.8)),
                                     ("Bucket_Pin", 0.3, (3, 9.6, 14.8))):
        rows = [min(range(len(run["time"])), key=lambda i: abs(run["time"][i] - t)) for t in instants]
        apart = math.degrees(max(abs(run[joint + ".position"][i] - sensed[joint + ".position"][i]) for i in rows))
        good &= expect(f"{joint} differs from load sensing by {apart:.2f} deg", apart < degrees)
    good &= expect("the main reliefs stay closed", max(run["Relief.flow"] + run["Relief_2.flow"]) <= 0)
    good &= expect("no volume cavitates", "cavitated" not in text)
    good &= expect("the engine does not stall", max(run["Engine.is_stalled"]) == 0)
    shaft, engine = work(run, "Pump_1.power", "Pump_2.power"), work(run, "Engine.power")
    good &= expect(f"the pumps' shafts take {shaft / 1e3:.1f} kJ, the engine gives {engine / 1e3:.1f} kJ",
                   abs(shaft / engine - 1) < 1e-3)
    share = shaft / work(sensed, "Pump.power")
    return good & expect(f"{share:.4f} of the work with load sensing, stated 0.875", abs(share - 0.875) < 0.005)


def monolith(folder):
    """Largest differences from the undivided system, as shares of the ranges."""
    _, _, run = record("excavator_20t_open_centre", f"{folder}/split", "--in-process")
    _, _, whole = record("excavator_20t_open_centre", f"{folder}/whole", "--monolithic")
    good = expect("both have the same samples", run["time"] == whole["time"])
    for share, *names in ((3.7e-3, "Left_Cylinder.force", "Bucket_Cylinder.force"), (1.05e-2, "Stick_Cylinder.force"),
                          (5e-4, "Slew_Motor.torque"), (8e-4, "Vol_P.pressure", "Vol_P2.pressure"), (8e-5, "Ring.position"),
                          (5.2e-5, "Left_Cylinder.stroke", "Stick_Cylinder.stroke", "Bucket_Cylinder.stroke")):
        for name in names:
            apart = max(abs(a - b) for a, b in zip(run[name], whole[name])) / (max(whole[name]) - min(whole[name]))
            good &= expect(f"{name} differs by {apart:.2e}, stated at most {share:g}", 0 < apart < share)
    return good


def level(folder, seconds, *options):
    """A session in lockstep with the controller: its output and its columns."""
    library = pathlib.Path(SLEWRING).resolve().parents[1] / "lib/libslewring_client.so"
    environment = dict(os.environ, SLEWRING_DOMAIN=take_domain(), SLEWRING_CLIENT=str(library))
    session = subprocess.Popen([SLEWRING, "run", f"{PROJECT}/scenes/excavator_20t_levelling.yaml", "--pace", "free", "--quiet",
                                "--duration", str(seconds), "--set", "session.give_up_after=60", "--out", folder],
                               env=environment)
    try:
        controller = subprocess.run([sys.executable, f"{PROJECT}/examples/python/levelling_controller.py", "--domain",
                                     environment["SLEWRING_DOMAIN"], *options], env=environment, stdout=subprocess.PIPE,
                                    text=True, check=True)
        if session.wait(120) != 0:
            sys.exit("FAILED: the session")
    finally:
        if session.poll() is None:
            session.terminate()
    print(controller.stdout)
    errors = {name: float(rms) for name, rms in re.findall(r"(\w+): ([\d.]+) \w+ rms", controller.stdout)}
    return errors, columns(next(path.parent for path in pathlib.Path(folder).rglob("session.mcap")))


def levelling(folder):
    errors, run = level(f"{folder}/on", 5, "--travel", "0.5")
    good = expect(f"height within {errors['height']} mm rms", errors["height"] < 7)
    good &= expect(f"angle within {errors['angle']} deg rms", errors["angle"] < 0.2)
    return good & expect("every value is ten steps old",
                         all(delay == 10 for delay in run["Input_Lift.loop_delay"][3:-1]))


def levelling_long(folder):
    free, _ = level(f"{folder}/off", 13, "--off")
    errors, run = level(f"{folder}/on", 13)
    _, again = level(f"{folder}/again", 13)
    good = expect(f"height: {errors['height']} mm rms, {free['height']} mm without the controller; stated 6.2 and 591",
                  abs(errors["height"] - 6.2) < 0.1 and abs(free["height"] - 591) < 1)
    good &= expect(f"angle: {errors['angle']} deg rms, stated 0.29", abs(errors["angle"] - 0.29) < 0.01)
    # without the times of the nodes
    physics = [name for name in run if not name.endswith(".loop_time_ms") and not name.startswith(("mechanics.", "hydraulics."))]
    other = [name for name in physics if repr(run[name]) != repr(again[name])]
    return good & expect(f"{len(physics)} columns have the same bits in a second run, but for {other}", not other)


kChecks = {"digging": digging, "cycle": cycle, "chart": chart, "levers": levers, "rest": rest, "open_centre": open_centre,
           "monolith": monolith, "levelling": levelling, "levelling_long": levelling_long}
with tempfile.TemporaryDirectory() as temporary:
    sys.exit(0 if kChecks[WHAT](temporary) else 1)
