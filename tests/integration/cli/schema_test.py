#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Every shipped scene and flexible body is valid by the schema that the program prints; broken ones are not.

schema_test.py SLEWRING SCENES
"""
import copy
import glob
import json
import os
import subprocess
import sys

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"SKIPPED: {missing} (python3-jsonschema, python3-yaml)")
    sys.exit(0)


def validator(*options):
    text = subprocess.run([sys.argv[1], "schema", *options], check=True, capture_output=True, text=True).stdout
    schema = json.loads(text)
    kind = jsonschema.validators.validator_for(schema)
    kind.check_schema(schema)
    return kind(schema)


def problems_of(by, document):
    return [f"{'.'.join(map(str, one.path))}: {one.message[:200]}" for one in by.iter_errors(document)]


class Loader(yaml.SafeLoader):
    """Numbers as scenes have them: 1e-3 is one."""


def read(path):
    with open(path) as file:
        return yaml.load(file, Loader)


scenes, bodies = validator(), validator("--flexible")
failed = count = 0
for path in sorted(glob.glob(f"{sys.argv[2]}/**/*.yaml", recursive=True)):
    is_body = os.path.basename(os.path.dirname(path)) == "beams"
    found = problems_of(bodies if is_body else scenes, read(path))
    count += 1
    if found:
        failed += 1
        print(f"{path}:\n  " + "\n  ".join(found))
# what the schema must not accept
crane = read(f"{sys.argv[2]}/single_cylinder.yaml")
overlay = {"include": "crane.yaml", "bodies": {"Boom": {"mass": "1 kg"}}, "components": {"Pump": {"type": "pump"}}}
broken = []
for change in (lambda s: s["bodies"].update(Loose={"mass": "1 kg"}),
               lambda s: s["bodies"].update(Ground={"points": {}, "mass": "1 kg"}),
               lambda s: s["bodies"].update(Loose={"mass": "1 kg", "inertia": [1, 1, 1], "wieght": 1}),
               lambda s: s.update(recordings={})):
    one = copy.deepcopy(crane)
    change(one)
    broken.append(one)
for part in ({"wieght": "1 kg"}, {"mass": [1, 2]}, 3):
    one = copy.deepcopy(overlay)
    one["bodies"]["Boom"] = part
    broken.append(one)
for one in broken:
    if not problems_of(scenes, one):
        failed += 1
        print(f"accepted: {json.dumps(one)[:300]}")
if problems_of(scenes, overlay) or problems_of(scenes, {**crane, "bodies": {**crane["bodies"], "Ground": {"points": {"post": [0, "2 m", 0]}}}}):
    failed += 1
    print("an overlay or a point of Ground is refused")
if count < 60:
    failed += 1
    print(f"only {count} files were found")
sys.exit(1 if failed else 0)
