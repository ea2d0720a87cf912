#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""outputs_test.py PROGRAM: what commands leave behind when they are killed at any moment, interrupted, on a full disk,
or told to write over an input.

Killed: an output is what it was before, or whole. Interrupted: the command ends in time with status 130, and no record,
table or page of what was done passes for the whole. A full disk or a refusal: exit status 2 with one line, and
everything as it was."""

import json
import math
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAM = os.path.abspath(sys.argv[1])
MOMENTS = max(1, round(20 * min(1.0, float(os.environ.get("CINCH_TEST_SHARE", "1")))))
OLD = b"what was there before\n"
random.seed(7)


def loaded():
    """How many times slower than alone a command may be while others run."""
    return max(1.0, os.getloadavg()[0] / os.cpu_count())


def run(arguments, cwd, **options):
    return subprocess.run([PROGRAM, *arguments], cwd=cwd, stdin=subprocess.DEVNULL, capture_output=True, text=True,
                          **options)


def files_of(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def is_part(name):
    return name.endswith(".part")


# Commands that write, their inputs aside: arguments, and how to tell that an output of a name is whole. The others are
# the same bytes in every run.
def ends_with(end):
    return lambda data: data.endswith(end)


PAGE, CHART = ends_with(b"</html>\n"), ends_with(b"</svg>\n\n")
BALL = pathlib.Path(tempfile.mkdtemp()) / "ball.obj"
WRITERS = {
    "verify": (["verify", str(BALL), "--nodes", "12", "--frames", "2", "--method", "eq12", "--leaf", "16",
                "--certificate", "c.jsonl.gz", "--vipr", "vipr", "--report", "page.html", "--plot", "chart.svg"],
               {"page.html": PAGE, "chart.svg": CHART}),
    "certificate": (["verify", str(BALL), "--nodes", "24", "--frames", "20", "--certificate", "c.jsonl"], {}),
    "simulate": (["simulate", "twist-180", "--duration", "0.5", "--every", "2", "--frames", "frames", "--meshes",
                  "meshes", "--checkpoint", "state", "--report", "page.html"],
                 {"page.html": PAGE}),
    "text frames": (["simulate", "skin", "--duration", "0.5", "--frames", "frames.jsonl"], {}),
    "view": (["view", str(BALL), "--nodes", "24", "--frames", "3", "--levels", "4", "--methods", "best,eq12",
              "--report", "page.html"], {}),
    "cost": (["cost", str(BALL), "--nodes", "12", "--frames", "1", "--kdops", "6", "--seconds", "0.05",
              "--this-input-only", "--report", "page.html", "--plot", "chart.svg"],
             {"page.html": PAGE, "chart.svg": CHART}),
}


def obj(points, faces):
    return ("".join(f"v {x} {y} {z}\n" for x, y, z in points)
            + "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in faces))


def write_ball(rings=16, around=20):
    """A closed surface of a few hundred triangles."""
    points = [(0, 0, 1), (0, 0, -1)]
    for r in range(1, rings):
        z, radius = math.cos(math.pi * r / rings), math.sin(math.pi * r / rings)
        angles = [2 * math.pi * a / around for a in range(around)]
        points += [(math.cos(angle) * radius, math.sin(angle) * radius, z) for angle in angles]
    at = lambda r, a: 2 + (r - 1) * around + a % around
    faces = [(0, at(1, a), at(1, a + 1)) for a in range(around)]
    faces += [(1, at(rings - 1, a + 1), at(rings - 1, a)) for a in range(around)]
    for r in range(1, rings - 1):
        for a in range(around):
            faces += [(at(r, a), at(r + 1, a), at(r, a + 1)), (at(r, a + 1), at(r + 1, a), at(r + 1, a + 1))]
    BALL.write_text(obj(points, faces))


def with_old_outputs(folder, names):
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(OLD)


def check_outputs(what, folder, whole, checks, old):
    for name, data in files_of(folder).items():
        if is_part(name):
            continue
        assert name in whole, (what, name, "is no output")
        if data == OLD and old:
            continue
        if name in checks:
            assert checks[name](data), (what, name, "is not whole")
        elif name != "state":  # of any moment; it is read below
            assert data == whole[name], (what, name, "is neither what was there nor whole")


def killed(name):
    arguments, checks = WRITERS[name]
    with tempfile.TemporaryDirectory() as temporary:
        reference = pathlib.Path(temporary) / "whole"
        reference.mkdir()
        start = time.monotonic()
        done = run(arguments, reference)
        seconds = time.monotonic() - start
        assert done.returncode == 0, (name, done)
        whole = files_of(reference)
        assert whole and not any(map(is_part, whole)), whole.keys()
        killed_before_end = 0
        for moment in range(MOMENTS):
            folder = pathlib.Path(temporary) / str(moment)
            folder.mkdir()
            old = moment % 2 == 0
            if old:
                with_old_outputs(folder, whole)
            process = subprocess.Popen([PROGRAM, *arguments], cwd=folder, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(random.uniform(0, 1.1 * seconds))
            process.kill()
            killed_before_end += process.wait() != 0
            check_outputs(f"{name}, killed", folder, whole, checks, old)
            state = folder / "state"
            if "--checkpoint" in arguments and state.exists() and state.read_bytes() != OLD:
                resumed = run([*arguments[:-4], "--resume", "state"], folder)
                assert resumed.returncode == 0, resumed
                for file, data in whole.items():
                    if file != "page.html" and not is_part(file) and not (file.startswith("meshes") and old):
                        assert (folder / file).read_bytes() == data, (file, "is not that of an uninterrupted run")
                assert not any(is_part(file) for file in files_of(folder) if file.startswith("frames"))
            shutil.rmtree(folder)
        assert killed_before_end > MOMENTS / 3, (name, killed_before_end)
        print(f"{name}: {killed_before_end} of {MOMENTS} killed within {seconds:.2f} s")


def on_a_full_disk():
    """Every command on a tmpfs that is too small for it, in a mount namespace of its own."""
    script = r"""
import json, os, pathlib, subprocess, sys
program, place, writers, old = sys.argv[1], pathlib.Path(sys.argv[2]), json.loads(sys.argv[3]), sys.argv[4].encode()
for name, (arguments, outputs, sizes) in writers.items():
    for size in sizes:
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(place)], check=True)
        for output in outputs:
            (place / output).write_bytes(old)
        done = subprocess.run([program, *arguments], cwd=place, stdin=subprocess.DEVNULL, capture_output=True,
                              text=True)
        assert done.returncode == 2, (name, size, done)
        assert done.stderr.count("\n") == 1 and "disk is full" in done.stderr, (name, size, done.stderr)
        for output in outputs:
            assert (place / output).read_bytes() == old, (name, size, output)
        left = [path.name for path in place.rglob("*.part") if path.name != "frames.part"]
        assert not left, (name, size, left)
        subprocess.run(["umount", str(place)], check=True)
print("a full disk:", ", ".join(writers))
"""
    writers = {
        "verify": (["verify", "fish", "--nodes", "24", "--frames", "2", "--method", "eq12", "--leaf", "16",
                    "--certificate", "c.jsonl"], ["c.jsonl"], ["16k", "256k"]),
        "page": (["verify", "fish", "--nodes", "24", "--frames", "1", "--leaf", "64", "--report", "page.html"],
                 ["page.html"], ["16k"]),
        "view": (["view", "fish", "--frames", "3", "--levels", "4", "--methods", "eq12", "--report", "page.html"],
                 ["page.html"], ["64k"]),
        "simulate": (["simulate", "twist-180", "--duration", "0.5", "--frames", "frames", "--checkpoint", "state"],
                     ["frames", "state"], ["64k"]),
        "meshes": (["simulate", "twist-180", "--duration", "0.5", "--meshes", "."], ["bar-00000.ply"], ["64k"]),
    }
    with tempfile.TemporaryDirectory() as place:
        isolate = [] if os.geteuid() == 0 else ["-r"]
        if subprocess.run(["unshare", *isolate, "-m", "mount", "-t", "tmpfs", "tmpfs", place],
                          capture_output=True).returncode != 0:
            print("no small disk: mounting one is not allowed here")
            return
        subprocess.run(["unshare", *isolate, "-m", sys.executable, "-c", script, PROGRAM, place, json.dumps(writers),
                        OLD.decode()], check=True)


def over_an_input():
    """Outputs that are inputs, or each other, are refused before anything is computed."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        corners = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
        faces = [(0, 2, 1), (1, 2, 3), (4, 5, 6), (5, 7, 6), (0, 1, 4), (1, 5, 4), (2, 6, 3), (3, 6, 7), (0, 4, 2),
                 (2, 4, 6), (1, 3, 5), (3, 7, 5)]
        (folder / "m.obj").write_text(obj(corners, faces))
        (folder / "w.txt").write_text("8 1\n" + "1 0 1\n" * 8)
        (folder / "t.txt").write_text("1\nclip 1 1\n0 1 0 0 0 0 1 0 0 0 0 1 0\n")
        (folder / "case.json").write_text('{"n":2,"l":[0,0],"h":[1,1],"b":[[1,2]]}')
        places = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
        (folder / "own.json").write_text(json.dumps({
            "duration": 0.05, "bodies": [{"name": "b", "surface": "m.obj", "places": places}],
            "effects": [{"effect": "gravity"}]}))
        (folder / "b-00002.obj").write_text((folder / "m.obj").read_text())
        (folder / "mesh-name.json").write_text((folder / "own.json").read_text().replace("m.obj", "b-00002.obj"))
        os.symlink("m.obj", folder / "link")
        os.link(folder / "m.obj", folder / "hard")
        before = files_of(folder)
        skin = ["verify", "m.obj", "--weights", "w.txt", "--transforms", "t.txt"]
        refused = [["verify", "m.obj", "--nodes", "4", option, name]
                   for option in ("--certificate", "--report", "--plot-data")
                   for name in ("m.obj", "link", "hard", "./m.obj")]
        refused += [[*skin, "--certificate", "w.txt"], [*skin, "--report", "t.txt"],
                    ["tightness", "m.obj", "--nodes", "4", "--report", "m.obj"],
                    ["cost", "m.obj", "--nodes", "4", "--plot-data", "m.obj"],
                    ["scaling", "m.obj", "--report", "m.obj"], ["view", "m.obj", "--report", "m.obj"],
                    ["corners", "case.json", "--report", "case.json"],
                    ["simulate", "own.json", "--frames", "own.json"], ["simulate", "own.json", "--checkpoint", "m.obj"],
                    ["simulate", "own.json", "--report", "own.json"], ["simulate", "own.json", "--frames", "m.obj"],
                    ["simulate", "mesh-name.json", "--meshes", ".", "--mesh-format", "obj"]]
        for arguments in refused:
            done = run(arguments, folder)
            assert done.returncode == 2 and not done.stdout, (arguments, done)
            assert "is an input of this command" in done.stderr and done.stderr.count("\n") == 1, (arguments, done)
        twice = [["verify", "m.obj", "--nodes", "4", "--report", "x.svg", "--plot", "x.svg"],
                 ["verify", "m.obj", "--nodes", "4", "--certificate", "x.svg", "--plot", "./x.svg"],
                 ["simulate", "own.json", "--frames", "x", "--checkpoint", "x"]]
        for arguments in twice:
            done = run(arguments, folder)
            assert done.returncode == 2, (arguments, done)
            assert "is named for two outputs" in done.stderr and done.stderr.count("\n") == 1, (arguments, done)
        assert files_of(folder) == before, "something was written"
        print(f"over an input: {len(refused) + len(twice)} refused")


INTERRUPTED = [["verify", "santa", "--nodes", "40"], ["verify", "santa", "--nodes", "40", "--frames", "40"],
               ["verify", "fishes", "--frames", "2"], ["verify", "santa-ring-1", "--update", "lazy"],
               ["tightness", "fish", "--nodes", "40", "--frames", "30"], ["cost", "fish"],
               ["cost", "--simulation", "twist-180"], ["scaling"], ["collide", "santa-ring-1"], ["stability"],
               ["fuzz", "--cases", "1000000"], ["simulate", "santa-ring-2", "--energies"], ["view", "santa-ring-1"]]


def interrupted():
    worst = {}
    for arguments in INTERRUPTED:
        name = " ".join(arguments)
        for moment in range(max(1, MOMENTS // 5)):
            json_too = moment % 2 == 0 or arguments[0] == "view"
            process = subprocess.Popen([PROGRAM, *arguments, *(["--json"] if json_too else [])],
                                       stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            time.sleep(random.uniform(0.05, 4))
            sent = time.monotonic()
            process.send_signal(signal.SIGINT)
            out, err = process.communicate()
            seconds = time.monotonic() - sent
            out, err = out.decode(), err.decode()
            worst[name] = max(worst.get(name, 0), seconds)
            assert seconds < 2 * loaded(), (name, seconds)
            if process.returncode == 0 or process.returncode == -signal.SIGINT and not out + err:
                continue  # it had come to its end, or not to its beginning
            assert process.returncode == 130 and err.startswith("cinch: stopping …\n"), (name, process.returncode, err)
            if not json_too:
                says = "interrupted" if arguments[0] == "fuzz" else "interrupted after"
                assert not out or says in out, (name, out)
                continue
            records = [json.loads(line) for line in out.splitlines()]
            for record in records:
                assert type(record["complete"]) is bool, record
                assert type(record["frames_done"]) is int and type(record["frames"]) is int, record
                assert not record["complete"] or record["frames_done"] == record["frames"], record
                assert record["frames_done"] <= record["frames"], record
                assert record.get("mean_ratio", 1) is not None and record.get("bvs", 1) > 0, (name, record)
            assert not records or not all(record["complete"] for record in records), (name, "passes for the whole")
        print(f"{name}: interrupted, ends within {worst[name]:.2f} s")


def at_once():
    """The second Ctrl-C does not wait for results; what was beside its place goes too."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        with_old_outputs(folder, ["c.jsonl", "page.html"])
        before = files_of(folder)
        for first in (signal.SIGINT, signal.SIGTERM):
            process = subprocess.Popen([PROGRAM, "verify", "brain", "--frames", "50", "--certificate", "c.jsonl",
                                        "--report", "page.html"],
                                       cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            while len(files_of(folder)) == len(before):
                time.sleep(0.01)
            time.sleep(3)
            process.send_signal(first)
            time.sleep(0.05)
            process.send_signal(first)
            sent = time.monotonic()
            process.communicate()
            seconds = time.monotonic() - sent
            assert seconds < 0.2 * loaded(), seconds
            assert process.returncode == 128 + first, process.returncode
            after = files_of(folder)
            assert after.keys() == before.keys() and after["c.jsonl"] == OLD, after.keys()
            page = after["page.html"]
            assert page == OLD or PAGE(page) and b"interrupted after" in page  # the results may have come first
        # SIGTERM once: as Ctrl-C, with a status of its own.
        process = subprocess.Popen([PROGRAM, "verify", "brain-3500", "--nodes", "60", "--frames", "2000",
                                    "--certificate", "c.jsonl"],
                                   cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        time.sleep(2)
        process.terminate()
        out, err = process.communicate()
        assert process.returncode == 143, (process.returncode, out, err)
        assert "interrupted after" in out and "c.jsonl is not written" in err, (out, err)
        assert files_of(folder) == after
        # A reader that goes away.
        process = subprocess.Popen([PROGRAM, "verify", "brain-3500", "--nodes", "60", "--json",
                                    "--report", "page.html"],
                                   cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        process.stdout.close()
        assert process.stderr.read() == b"" and process.wait() in (141, -signal.SIGPIPE, 0)
        assert not any(map(is_part, files_of(folder)))
        print("a second one ends at once")


def statuses():
    """1 is for verdicts; all else that fails is 2, in one line that says what to do."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        unsolved = {"duration": 1, "integrator": {"method": "implicit", "iterations": 1, "tolerance": 1e-12},
                    "effects": [{"effect": "elastic", "young": 1e7}],
                    "bodies": [{"name": "bar", "surface": "box", "box": [1, 0.3, 0.3], "cells": [8, 2, 2],
                                "lattice": [6, 2, 2], "spin": [0, 9, 0]}]}
        (folder / "unsolved.json").write_text(json.dumps(unsolved))
        two = dict(unsolved, bodies=[dict(unsolved["bodies"][0], name=name) for name in ("bar", "other")])
        (folder / "two.json").write_text(json.dumps(two))
        (folder / "file").write_text("")
        for arguments in (["verify", "unsolved.json"], ["tightness", "unsolved.json"], ["cost", "unsolved.json"],
                          ["view", "unsolved.json", "--json"], ["collide", "two.json"], ["scaling", "unsolved.json"]):
            done = run(arguments, folder)
            assert done.returncode == 2 and done.stderr.count("\n") == 1, (arguments, done)
            for word in ("body 'bar' at 0 s", "no minimum within 1 Newton iterations", "step", "cinch simulate"):
                assert word in done.stderr, (arguments, word, done.stderr)
        assert run(["simulate", "unsolved.json"], folder).returncode == 1  # its own verdict
        assert run(["verify", "fish", "--nodes", "24", "--frames", "1", "--sabotage", "lower-h"],
                   folder).returncode == 1
        for arguments in (["verify", "fish", "--nodes", "24", "--method", "eq12", "--vipr", "file/below"],
                          ["reproduce", "--quick", "--out", "file/below"],
                          ["simulate", "skin", "--meshes", "file/below"]):
            done = run(arguments, folder)
            assert done.returncode == 2 and done.stderr.count("\n") == 1 and "file" in done.stderr, (arguments, done)
        usage = run(["verify", "--frames", "0"], folder)
        assert usage.returncode == 2 and "cinch verify --help" in usage.stderr and usage.stderr.count("\n") == 1, usage
        print("statuses")


if __name__ == "__main__":
    chosen = sys.argv[2:]
    write_ball()
    for part in (statuses, over_an_input, on_a_full_disk, at_once, interrupted):
        if not chosen or part.__name__ in chosen:
            part()
    for name in WRITERS:
        if not chosen or name in chosen:
            killed(name)
    shutil.rmtree(BALL.parent)
