# SPDX-License-Identifier: GPL-3.0-or-later
"""The published schema and the program's reader agree: on the shipped scenes, and on what is made wrong in them.

usage: schema_test.py PROGRAM SCENES"""
import copy, json, pathlib, subprocess, sys, tempfile
import jsonschema

program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
schema = json.loads((folder / "schema.json").read_text())
jsonschema.Draft202012Validator.check_schema(schema)
validator = jsonschema.Draft202012Validator(schema)
work = pathlib.Path(tempfile.mkdtemp())
failures = checked = 0


def reader_accepts(scene):
    file = work / "scene.json"
    file.write_text(json.dumps(scene))
    return subprocess.run([program, "simulate", file, "--duration", "0"], capture_output=True).returncode == 0


def agree(scene, what):
    global failures, checked
    checked += 1
    by_schema, by_reader = validator.is_valid(scene), reader_accepts(scene)
    if by_schema != by_reader:
        failures += 1
        print(f"{what}: the schema says {by_schema}, the program {by_reader}")
    return by_schema


def places(value, path=()):
    if path:
        yield path
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ():
        yield from places(inner, path + (key,))


def changed(scene, path, change):
    scene = copy.deepcopy(scene)
    holder = scene
    for key in path[:-1]:
        holder = holder[key]
    if change is None:
        del holder[path[-1]]
    else:
        holder[path[-1]] = change
    return scene


for file in sorted(folder.glob("*.json")):
    if file.name != "schema.json":
        scene = json.loads(file.read_text())
        if not validator.is_valid(scene):
            failures += 1
            print(f"{file.name}: {next(validator.iter_errors(scene)).message}")

printed = subprocess.run([program, "simulate", "--schema"], capture_output=True, check=True).stdout
if printed != (folder / "schema.json").read_bytes():
    failures += 1
    print("'simulate --schema' prints another schema than the shipped one")

# A small scene, and every field of it removed, renamed, or made something else; and so with every effect, as its
# example in the schema has it.
small = {
    "duration": 0, "frame": 0.02,
    "integrator": {"method": "implicit", "step": 0.01, "tolerance": 1e-3, "iterations": 50},
    "bodies": [{"name": "bar", "surface": "box", "box": [1, 0.3, 0.3], "cells": [4, 1, 1], "lattice": [6, 2, 2],
                "density": 900, "support": 1.8, "nearest": 8, "seed": 3, "volumes": "density",
                "position": [0, 0, 1], "velocity": [1, 0, 0], "spin": [0, 1, 0],
                "rotation": {"axis": [1, 0, 0], "degrees": 30}},
               {"name": "sheet", "surface": "sheet", "box": [1, 1, 0], "cells": [3, 3, 1], "thickness": 0.01,
                "places": [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0]]}],
    "effects": []}
examples = [example for form in schema["$defs"]["effect"]["oneOf"] for example in form["examples"]]
if len(examples) < 17:
    failures += 1
    print(f"only {len(examples)} examples of effects")


# Names and indices that do not exist, and vectors of length 0, are beyond what a schema can say, and so is a body that
# is no character.
def is_beyond(path):
    of_body = path[0] == "bodies" and (path[-1] in ("name", "surface", "lattice", "places") or "box" in path
                                       or path[-1] == "clip")
    return (of_body or "bodies" in path[1:] or path[-1] in ("clip", "$schema")
            or any(name in path for name in ("nodes", "axis", "normal", "places")))


valid = 0
for effects in [[]] + [[example] for example in examples if not example.get("clip")]:
    scene = dict(small, effects=effects)
    if not agree(scene, f"the small scene with {effects}"):
        failures += 1
        print(f"the small scene with {effects} should be valid:", next(validator.iter_errors(scene)).message)
    for path in places(scene):
        if effects and path[0] != "effects":
            continue
        for change in (None, "x", -1, 0, [], {}, True):
            # Whether 'young' may be left out depends on the other effects.
            needed = change is None and path[-1] == "young" and effects[0]["effect"] == "hourglass"
            if not is_beyond(path) and not needed:
                valid += agree(changed(scene, path, change), f"{effects}, /{'/'.join(map(str, path))} = {change!r}")
        if isinstance(path[-1], str) and "bodies" not in path[1:]:
            renamed = changed(scene, path, None)
            holder = renamed
            for key in path[:-1]:
                holder = holder[key]
            holder["unknown"] = 1
            agree(renamed, f"{effects}, /{'/'.join(map(str, path))} renamed")
print(f"{checked} scenes compared, {valid} of the changed ones valid, {failures} disagreements")
sys.exit(1 if failures or checked < 500 or valid < 20 else 0)
