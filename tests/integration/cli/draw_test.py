#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`slewring draw` as a user starts it:  draw_test.py SLEWRING SCENES [all]

The pictures of some scenes, or of all, are well-formed and name every element; bad input is refused.
"""
import json
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../support"))
from waiting import require  # noqa: E402

SLEWRING, SCENES = sys.argv[1:3]
SOME = ("truck_crane", "excavator_20t", "single_cylinder_counterbalance", "engine_two_pumps", "joints/universal",
        "forces/rope", "contact/shapes")


def run(*words):
    done = subprocess.run([SLEWRING, *words], capture_output=True, text=True, timeout=120, check=False)
    return done.returncode, done.stdout, done.stderr


def ids(path):
    """Elements and volumes that a picture names."""
    tree = xml.etree.ElementTree.parse(path)
    return {one.get(name) for one in tree.iter() for name in ("data-element", "data-volume")} - {None}


def scenes():
    for folder, _, names in os.walk(SCENES):
        if os.path.basename(folder) == "beams":  # input of `flex`, no scenes
            continue
        for name in sorted(names):
            if name.endswith(".yaml"):
                yield os.path.relpath(f"{folder}/{name}", SCENES)[:-5]


def draws(folder, scene, view="side"):
    path = f"{folder}/{scene.replace('/', '_')}.svg"
    code, out, err = run("draw", f"{SCENES}/{scene}.yaml", "--view", view, "-o", path)
    require(code == 0 and out == path + "\n", f"{scene}: {code}: {err}")
    code, out, err = run("describe", f"{SCENES}/{scene}.yaml", "--json")
    require(code == 0, f"{scene}: {err}")
    drawn = ids(path)
    described = json.loads(out)
    wanted = {one["name"] for one in described["mechanics"]["mass_properties"]}
    wanted |= {one.split()[0] for one in described["ports"]}  # "Cyl_Tip drives Force_Tip"
    require(wanted <= drawn, f"{scene}: not drawn are {wanted - drawn}")
    return drawn


def refuses(folder):
    crane = f"{SCENES}/truck_crane.yaml"
    for words, text in (((crane, "-o", f"{folder}/crane.png"),
                         "ends neither in .svg nor in .html; nothing was written"),
                        ((crane, "-o", f"{folder}/crane"), "ends neither in .svg nor in .html"),
                        ((crane,), "--output"),
                        ((f"{folder}/none.yaml", "-o", f"{folder}/a.svg"), "none.yaml"),
                        ((crane, "--view", "below", "-o", f"{folder}/a.svg"), "below"),
                        ((f"{SCENES}/slider_crank.yaml", "--part", "circuit", "-o", f"{folder}/a.svg"),
                         "the scene has no hydraulic components; the circuit is left out; nothing was written")):
        code, _, err = run("draw", *words)
        require(code == 2 and text in err, f"{words}: {code}: {err}")
    require(not [name for name in os.listdir(folder) if name.startswith(("a.", "crane"))],
            "a refused picture was written")
    # what the scene does not have is left out, and stated
    code, out, err = run("draw", f"{SCENES}/slider_crank.yaml", "-o", f"{folder}/b.svg", "--json")
    require(code == 0 and "no hydraulic components; the circuit is left out" in err, f"{code}: {err}")
    require(json.loads(out)["left_out"] == ["the scene has no hydraulic components; the circuit is left out"], out)
    code, out, err = run("draw", f"{SCENES}/flow_sharing.yaml", "-o", f"{folder}/c.svg")
    require(code == 0 and "no bodies; the mechanism is left out" in err, f"{code}: {err}")


with tempfile.TemporaryDirectory(prefix="slewring_draw_") as scratch:
    for name in list(scenes()) if sys.argv[3:] == ["all"] else SOME:
        draws(scratch, name)
    crane = draws(scratch, "truck_crane", "top")
    require({"Truck_JibBoom", "Pillar_LiftBoom", "Cyl_Lift", "L90Lift", "Vol_MainPump", "Hose_Jib_A"} <= crane,
            f"{crane}")
    code, out, err = run("draw", f"{SCENES}/truck_crane.yaml", "--view", "front", "-o", f"{scratch}/page.html")
    with open(f"{scratch}/page.html", encoding="utf-8") as page:
        text = page.read()
    require(code == 0 and text.count("<svg") == 2 and "http" not in text.replace("http://www.w3.org/2000/svg", ""),
            f"a page of one file: {code}: {err}")
    require("prefers-color-scheme:dark" in text, "no colours for a dark ground")
    refuses(scratch)
