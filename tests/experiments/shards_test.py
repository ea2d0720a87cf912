#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""shards_test.py CINCH: runs in shards, runs that are killed again and again, and whole runs print the same bytes."""
import gzip
import json
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "time"))
from made_characters import many_clips, through_zero

cinch = sys.argv[1]


def run(*words, status=0, or_else=None, **more):
    out = subprocess.run([cinch, *map(str, words)], capture_output=True, **more)
    assert out.returncode in (status, or_else), (words, out.returncode, out.stderr.decode())
    return out


def killed_and_resumed(words, folder, kills, seed):
    """Killed at random moments, then run to its end."""
    chance = random.Random(seed)
    begun = time.monotonic()
    run(*words, "--out", folder / "timed")
    length = time.monotonic() - begun
    killed = 0
    while killed < kills:
        process = subprocess.Popen([cinch, *map(str, words), "--out", str(folder / "killed")],
                                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            process.wait(chance.uniform(0.1, 0.3) * length)
        except subprocess.TimeoutExpired:
            process.send_signal(chance.choice([signal.SIGKILL, signal.SIGINT, signal.SIGTERM]))
            process.wait()
            killed += 1
            continue
        break  # it was done before
    assert killed >= 2, "too fast to be killed"
    return run(*words, "--out", folder / "killed").stdout


def compare(name, words, outputs, kills=5, shards=7, status=0, torn=3):
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        whole = {}
        for output in outputs:  # into a folder each: then nothing is said of this machine
            whole[output] = without_times(
                run(*words, *output, "--out", folder / f"whole{len(whole)}", status=status).stdout)
        for i in random.Random(1).sample(range(shards), shards):
            run(*words, "--out", folder / "rows", "--shard", f"{i}/{shards}", or_else=status)
        for output, expected in whole.items():
            merged = without_times(run("merge", folder / "rows", *output, status=status).stdout)
            assert merged == expected, (name, output, "in shards", merged[:2000], expected[:2000])
        # A shard that is gone or torn is named, and what merge says to run makes it whole.
        victim = sorted((folder / "rows").glob("shard-*.jsonl"))[torn]
        victim.write_bytes(victim.read_bytes()[:-9])
        said = run("merge", folder / "rows", status=2).stderr.decode()
        assert f"--array={torn} --export=ALL,CINCH_SHARDS={shards}" in said, said
        run(*words, "--out", folder / "rows", "--shard", "slurm", or_else=status,
            env={"SLURM_ARRAY_TASK_ID": str(torn), "CINCH_SHARDS": str(shards)})
        again = without_times(run("merge", folder / "rows", *outputs[0], status=status).stdout)
        assert again == whole[outputs[0]], (name, "after a torn line")
        if kills:
            resumed = without_times(killed_and_resumed([*words, *outputs[0]], folder, kills, name))
            assert resumed == whole[outputs[0]], (name, "killed")
        print(f"{name}: whole, {shards} shards and {kills} kills give the same {len(whole[outputs[0]])} bytes",
              flush=True)


def records(text):
    """Without what is said of one machine."""
    rows = [json.loads(line) for line in without_times(text).splitlines()]
    return [{key: value for key, value in row.items() if key not in ("command", "cpu", "simd_target", "threads")}
            for row in rows]


def without_times(text):
    """Times are marked as such: "seconds" and "..._ms" in records with what follows from them, how tight a bound became
    in so many ns, and what a table says it took."""
    text = re.sub(rb'("arithmetic":"[^"]* ns",[^{}]*"mean_ratio":)[^,}]*', rb'\g<1>0', text)
    text = re.sub(rb'"(seconds|exponent|cpu_share|load|project_ns|settled|pareto|ns_per_joint|'
                  rb'(\w*_ms|gain|ns_per_bound|ns_per_box|over_default|ratio_to_double)(_low|_high)?)":[^,}]*',
                  rb'"\1":0', text)
    text = re.sub(rb'"total_ms_of_frame":\[[^]]*\]', b'"total_ms_of_frame":[]', text)
    text = re.sub(rb'"measured":"[^"]*","target":("[^"]*"),"reached":\w*,"verdict":"\w*"', rb'"target":\1', text)
    text = re.sub(rb"(?m)^[^\n]* of work, [^\n]*$", b"", text)
    return re.sub(rb"(?m)^[^\n]*, filter hit rate", b"filter hit rate", text)


full = "--full" in sys.argv  # 3 inputs, 6 numbers of nodes, 5 seeds, 3 methods
plan = {"inputs": ["brain-3500", "santa", "fish"] if full else ["santa"], "frames": 1, "leaf": 16,
        "nodes": "8..256" if full else "8..32", "seeds": "0-4" if full else "0-1", "detail": "levels",
        "methods": ["eq12", "limited", "best"]}
cells = 3 * 6 * 5 if full else 3 * 2  # fewer than shards
with tempfile.TemporaryDirectory() as place:
    file = pathlib.Path(place) / "plan.json"
    file.write_text(json.dumps(plan))
    compare("study", ["study", file], [("--json",), ("--csv",), ()], kills=5 if full else 3)
    rows = [json.loads(line) for line in run("study", file, "--json").stdout.splitlines()]
    runs = [row for row in rows if "level" not in row]
    assert len(runs) == 3 * cells and all(row["root_ratio"] >= 1 and row["complete"] for row in runs)
    assert all(row["frames_done"] == row["frames"] == 1 for row in rows)
    piped = run("study", "-", "--json", input=json.dumps(plan).encode()).stdout.splitlines()
    assert [{**json.loads(line), "command": ""} for line in piped] == [{**row, "command": ""} for row in rows]
    run("study", file, "--shard", "0/7", status=2)  # without a folder
    run("study", file, "--out", file / "rows", status=2)
verified = ["verify", "brain-3500" if full else "santa", "--nodes", 40, "--frames", 9, "--leaf", 16, "--kdop", 14]
compare("verify", verified, [("--json",), ()], kills=3)
with tempfile.TemporaryDirectory() as place:  # what cells add up to is what a run without cells says
    cells_say = records(run(*verified, "--json", "--out", place).stdout)
    assert cells_say == records(run(*verified, "--json").stdout)
with tempfile.TemporaryDirectory() as place:  # what different commands say of one thing
    file = pathlib.Path(place) / "plan.json"
    file.write_text(json.dumps({"inputs": ["santa"], "frames": 2, "leaf": 16, "nodes": 40, "seeds": 0,
                                "detail": "levels", "methods": ["eq12", "best"]}))
    tightness = {(row["method"], row["level"]): row for row in records(run(
        *"tightness santa --nodes 40 --frames 2 --leaf 16 --sweep 8 --motion strong --json".split()).stdout)
        if "level" in row and row["n"] == 40}
    studied = [row for row in records(run("study", file, "--json").stdout) if "level" in row]
    assert len(studied) == 20
    for row in studied:
        known = tightness[row["method"], row["level"]]
        for key in ("bvs", "mean_ratio", "max_ratio"):  # sums of other orders
            assert abs(row[key] - known[key]) < 1e-13, (key, row, known)
    proven = run(*"verify santa --nodes 40 --frames 2 --leaf 16 --kdop 6 --json".split())
    levels = [row for row in records(proven.stdout) if "level" in row]
    assert len(levels) == 10
    for row in levels:
        known = tightness["best", row["level"]]
        for key in ("mean_ratio", "max_ratio", "box_loss", "interval_loss"):
            assert abs(row[key] - known[key]) < 1e-13, (key, row, known)
compare("tightness", "tightness santa --nodes 40 --frames 5 --leaf 16 --sweep 8,16 --methods eq12,best".split(),
        [("--json",), ()], kills=3)
compare("fuzz", ["fuzz", "--cases", 12 * 4096 - 5, "--seed", 3], [("--json",), ()], kills=3)
compare("fuzz with violations", ["fuzz", "--cases", 8 * 4096, "--sabotage", "lower-h"], [("--json",), ()], kills=0,
        status=1)
with tempfile.TemporaryDirectory() as place:  # and with what a run without cells finds
    damaged = ["fuzz", "--cases", 3 * 4096, "--sabotage", "lower-h", "--json"]
    assert records(run(*damaged, "--out", place, status=1).stdout) == records(run(*damaged, status=1).stdout)
with tempfile.TemporaryDirectory() as place:
    for more in ([], ["--out", place + "/infinite"], ["--out", place + "/infinite"]):  # the last one from its rows
        box, = records(run("bake", through_zero(place), "--json", "--whole", *more).stdout)
        assert box["min"] == box["max"] == [None] * 3, box
    baked = ["bake", many_clips(place, 9), "--prove", "--level", -1]
    compare("bake", baked, [("--json",), ()], kills=0)
    compare("audit", ["audit", baked[1], "--seconds", 0.01], [("--json",)], kills=0)
    compare("verify of all times", ["verify", baked[1], "--times", "all"], [("--json",), ()], kills=0)
    whole = run(*baked, "--json").stdout
    assert records(whole) == records(run(*baked, "--json", "--out", place + "/rows").stdout)
    assert len({row["clip"] for row in records(whole)}) == 9
    files = [[f"{place}/{run_of}.npz", f"{place}/{run_of}.usda"] for run_of in ("whole", "rows")]
    for (npz, usd), more in zip(files, ([], ["--out", place + "/rows"])):
        run(*baked, *more, "--npz", npz, "--usd", usd)
    for whole, rows in zip(*files):
        assert pathlib.Path(whole).read_bytes() == pathlib.Path(rows).read_bytes()
    for more in (["--certificate", place + "/proof"], ["--shard", "0/3", "--npz", place + "/some.npz"]):
        run(*baked, "--out", place + "/refused", *more, status=2)
    run(*baked, "--out", place + "/rows", "--whole", status=2)  # another plan
    run(*baked, "--sabotage", "half-bump", "--out", place + "/damaged", status=1)
    assert b", 0 violated" not in run("merge", place + "/damaged", status=1).stdout.splitlines()[-1]
with tempfile.TemporaryDirectory() as place:
    scenes = [pathlib.Path(place) / f"two-{i}.json" for i in range(5)]
    box = {"surface": "box", "box": [1, 1, 1], "cells": [4, 4, 4], "nodes": 8, "density": 1000}
    for i, scene in enumerate(scenes):
        bodies = [{"name": "a", **box}, {"name": "b", **box, "position": [0.3, 0.4, 0.5 + 0.1 * i]}]
        scene.write_text(json.dumps({"name": scene.stem, "duration": 0.1, "effects": [{"effect": "gravity"}],
                                     "bodies": bodies}))
    compare("cost", ["cost", "santa", "--seconds", 0.02, "--leaf", 256, "--this-input-only"], [("--json",)], kills=0,
            shards=3, torn=2)
    compare("scaling", ["scaling", "santa", "--seconds", 0.005], [("--json",)], kills=0, torn=2)
    compare("collide", ["collide", *scenes, "--frames", 2, "--backends", "cinch,refit-16"], [("--json",)], kills=0)
with tempfile.TemporaryDirectory() as place:  # a certificate in parts is the certificate, and the checker's verdict
    place = pathlib.Path(place)
    checker = pathlib.Path(__file__).parents[2] / "experiments" / "check_certificate.py"
    proof = [*verified[:-1], 6, "--method", "limited", "--certificate"]
    run(*proof, place / "whole.jsonl.gz")
    for i in (2, 0, 1):
        run(*proof, "parts", "--out", place / "rows", "--shard", f"{i}/3")

    def checked(status):
        out = subprocess.run([sys.executable, checker, place / "rows" / "parts"], capture_output=True, text=True)
        assert out.returncode == status, out
        return out.stdout

    assert "the file ends where the end should follow" in checked(1)
    run("merge", place / "rows")
    assert "accepted: " in checked(0)
    parts = sorted((place / "rows" / "parts").iterdir())
    assert b"".join(gzip.open(part).read() for part in parts) == gzip.open(place / "whole.jsonl.gz").read()
    assert len(parts) == 11
    kept = parts[4].read_bytes()
    parts[4].unlink()
    assert "1-frame-00000003.jsonl.gz: is missing" in run("merge", place / "rows", status=2).stderr.decode()
    checked(1)
    parts[4].write_bytes(kept[:-20])
    checked(1)
    parts[4].write_bytes(kept)
    checked(0)
    run(*proof, "a/b", "--out", place / "rows", status=2)
with tempfile.TemporaryDirectory() as place:  # a refuted bound is refuted in its shard and in the whole
    sabotaged = [*verified, "--sabotage", "lower-h", "--out", pathlib.Path(place) / "rows"]
    statuses = [subprocess.run([cinch, *map(str, sabotaged), "--shard", f"{i}/2"], stdout=subprocess.DEVNULL).returncode
                for i in (0, 1, 0, 1)]  # the second time nothing is left to do: the verdict stays
    assert max(statuses) == 1 and statuses[:2] == statuses[2:], statuses
    assert b" 0 violated" not in run("merge", pathlib.Path(place) / "rows", status=1).stdout
with tempfile.TemporaryDirectory() as place:  # another file under the same name is another plan
    plan_file, mesh = pathlib.Path(place) / "plan.json", pathlib.Path(place) / "mesh.off"
    plan_file.write_text(json.dumps({"inputs": str(mesh), "nodes": 2, "frames": 1, "seeds": "0-1"}))
    for height in (1, 2):
        mesh.write_text(f"OFF 3 1 0\n0 0 0\n1 0 0\n0 1 {height}\n3 0 1 2\n")
        run("study", plan_file, "--out", pathlib.Path(place) / "rows", "--shard", f"{height - 1}/2")
    assert b"another plan" in run("merge", pathlib.Path(place) / "rows", status=2).stderr
with tempfile.TemporaryDirectory() as place:  # Ctrl-C: what is there is printed, and says that it is not all
    file = pathlib.Path(place) / "plan.json"
    file.write_text(json.dumps({"inputs": "santa", "nodes": 8, "frames": 1, "leaf": 64, "seeds": "0-999"}))
    for output in ((), ("--json",)):
        process = subprocess.Popen([cinch, "study", str(file), *output], stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        time.sleep(6)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate()
        assert process.returncode == 130 and b"interrupted after" in err, (process.returncode, err)
        if output:
            assert all(json.loads(line)["complete"] is False for line in out.splitlines()) and out
        else:
            assert b"interrupted after" in out and b"of 1000 cells" in out, out
