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

# One small scene with everything, and every field of it removed, renamed, or made something else.
small = {
    "duration": 0, "frame": 0.02, "integrator": {"method": "implicit", "step": 0.01, "tolerance": 1e-3, "iterations": 50},
    "bodies": [{"name": "bar", "surface": "box", "box": [1, 0.3, 0.3], "cells": [4, 1, 1], "lattice": [6, 2, 2], "density": 900, "support": 1.8, "nearest": 8, "seed": 3,
                "volumes": "density", "position": [0, 0, 1], "velocity": [1, 0, 0], "spin": [0, 1, 0], "rotation": {"axis": [1, 0, 0], "degrees": 30}},
               {"name": "sheet", "surface": "sheet", "box": [1, 1, 0], "cells": [3, 3, 1], "thickness": 0.01, "places": [[0, 0, 0], [0.3, 0, 0], [0, 0.3, 0]]}],
    "effects": [{"effect": "gravity", "acceleration": [0, 0, -1]}, {"effect": "elastic", "model": "stvk", "young": 1e4, "poisson": 0.3}, {"effect": "hourglass", "alpha": 0.5, "young": 10},
                {"effect": "volume", "stiffness": 10}, {"effect": "plasticity", "yield": 0.1, "creep": 1, "most": 2}, {"effect": "viscosity", "viscosity": 2}, {"effect": "damping", "rate": 1},
                {"effect": "ground", "point": [0, 0, 0], "normal": [0, 0, 1], "stiffness": 5, "friction": 0.1, "at": "nodes"}, {"effect": "contact", "stiffness": 100},
                {"effect": "pulling", "nodes": "all", "force": [1, 0, 0], "start": 0, "end": 1, "period": 2, "bodies": ["bar"]},
                {"effect": "pulling", "nodes": {"centre": [0, 0, 0], "radius": 2}, "stiffness": 5, "offset": [0, 0, 1], "ramp": 1, "bodies": ["bar"]},
                {"effect": "pinned", "nodes": {"index": [0, 1]}, "bodies": ["bar"]},
                {"effect": "scripted", "nodes": {"nearest": [1, 0, 0], "count": 2}, "axis": [0, 0, 1], "centre": [0, 0, 0], "rate": 1, "ramp": 1, "until": 2, "bodies": ["bar"]},
                {"effect": "scripted", "nodes": {"box": [[-1, -1, -1], [0.01, 0.01, 1]]}, "velocity": [0, 0, 1], "end": 1, "bodies": ["sheet"]}]}
if not agree(small, "the small scene"):
    failures += 1
    print("the small scene should be valid:", next(validator.iter_errors(small)).message)
valid = 0
for path in places(small):
    for change in (None, "x", -1, 0, [], {}, True):
        # Names and indices that do not exist, and vectors of length 0, are beyond what a schema can say.
        if path[-1] in ("axis", "normal") or "bodies" == path[0] and path[-1] in ("name", "surface", "lattice", "places") or "bodies" in path[1:] or path[-1] == "nodes" or "nodes" in path and change == 0:
            continue
        if path[0] == "bodies" and "box" in path or path[-1] in ("clip", "$schema") or "axis" in path or "normal" in path:
            continue
        if len(path) == 2 and path[0] in ("bodies", "effects") and change is None:
            continue # what refers to it is left hanging
        if "nodes" in path or "index" in path or "places" in path:
            continue
        valid += agree(changed(small, path, change), f"/{'/'.join(map(str, path))} = {change!r}")
for path in places(small):
    if isinstance(path[-1], str) and "bodies" not in path[1:]:
        scene = changed(small, path, None)
        holder = scene
        for key in path[:-1]:
            holder = holder[key]
        holder["unknown"] = 1
        agree(scene, f"/{'/'.join(map(str, path))} renamed")
print(f"{checked} scenes compared, {valid} of the changed ones valid, {failures} disagreements")
sys.exit(1 if failures or checked < 500 or valid < 20 else 0)
