# SPDX-License-Identifier: GPL-3.0-or-later
"""corpus_test.py CINCH ROOT [SHARED]: the list of public files is whole, and those that are there have the counts that
it says and can be studied."""
import json, pathlib, re, subprocess, sys, tempfile

program, root, shared = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3] if len(sys.argv) > 3 else ""
script = root / "experiments" / "corpus"


def run(*words, status=0):
    out = subprocess.run([str(w) for w in words], capture_output=True, text=True)
    assert out.returncode == status, (words, out.returncode, out.stderr)
    return out


corpus = json.loads((root / "data" / "corpus.json").read_text())["files"]
assert len({e["file"] for e in corpus}) == len({e["sha256"] for e in corpus}) == len(corpus) >= 8
for entry in corpus:
    assert re.fullmatch("[0-9a-f]{64}", entry["sha256"]) and re.fullmatch("[0-9a-f]{40}", entry["commit"]), entry
    assert all(entry[field] for field in ("file", "kind", "origin", "path", "licence", "vertices", "triangles")), entry
    assert (entry["kind"] == "character") == ("clips" in entry), entry
    assert not list(root.glob("data/**/" + entry["file"])), entry["file"] + " is not ours to ship"
with tempfile.TemporaryDirectory() as empty:
    assert "none of the files is there" in run(script, empty, status=1).stderr
    assert "no such folder" in run(script, empty + "/none", status=2).stderr
    run(script, status=2)
if not (shared and pathlib.Path(shared).is_dir()):
    print("the reference meshes are not there: skipped")
    sys.exit()
made = run(script, shared)
plan = json.loads(made.stdout)
print(made.stderr, end="")
for name in plan["inputs"]:
    entry = next(e for e in corpus if e["bytes"] == pathlib.Path(name).stat().st_size)
    said = run(program, "verify", name, "--frames", "1", "--leaf", "1000000").stdout.replace(",", "")
    assert f"{entry['vertices']} vertices {entry['triangles']} triangles" in said, (entry, said[:300])
    if "clips" in entry:
        assert f"\n{entry['simulation_nodes']} simulation nodes" in said, (entry, said[:300])
characters = run(script, "--characters", shared).stdout.split()
assert characters == [n for n in plan["inputs"] if n.endswith(".glb")], characters
small = {**plan, "inputs": characters[1:3], "methods": ["best"], "kdops": [6], "frames": 1}
with tempfile.TemporaryDirectory() as place:
    file = pathlib.Path(place) / "plan.json"
    file.write_text(json.dumps(small))
    rows = [json.loads(line) for line in run(program, "study", file, "--json").stdout.splitlines()]
    assert {row["input"] for row in rows} == set(small["inputs"])
    assert all(row["mean_ratio"] >= 1 for row in rows if row.get("mean_ratio"))
