#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""reproduce_test.py PROGRAM FOLDER: a quick run that is stopped and killed continues, gives a page whose figures all
lead to a line, and survives damage."""

import html.parser
import json
import pathlib
import shutil
import signal
import subprocess
import sys
import time


class Page(html.parser.HTMLParser):
    """Ids, links into the page, charts and text."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links, self.charts, self.text, self.remote = [], [], 0, [], []
        self.verdicts, self.shown = [], None  # (of it, what it rests on, in what words)
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        values = dict(attributes)
        if "id" in values:
            self.ids.append(values["id"])
        if tag == "a" and values.get("href", "").startswith("#"):
            self.links.append((values["href"][1:], "f" == values.get("class")))
        elif tag in ("a", "link", "img", "script", "iframe") and (values.get("href") or values.get("src")):
            self.remote.append(values)
        self.charts += tag == "figure"

        if "data-verdict" in values:
            self.shown = values

    def handle_data(self, data):
        self.text.append(data)
        if self.shown:
            self.verdicts.append((self.shown["data-verdict"], self.shown["data-on"].split(), data))
            self.shown = None


def check_verdicts(page):
    """No claim and table say different things of one statement, and each says what follows from its statements."""
    words = {"holds": ("Same.", "Confirmed."), "fails": ("Differs.", "Not confirmed."),
             "inconclusive": ("Inconclusive: the rounds are too far apart.",) * 2, "unknown": ("Not measured.",) * 2}
    said, in_tables, in_claims = {}, set(), set()
    for verdict, on, text in page.verdicts:
        statements = dict(one.rsplit(":", 1) for one in on)
        worst_first = ("fails", "inconclusive", "holds")
        follows = next((worst for worst in worst_first if worst in statements.values()), "unknown")
        assert verdict == follows and text in words[verdict], (verdict, on, text)
        (in_tables if text in ("Same.", "Differs.") else in_claims).update(statements)
        for name, is_so in statements.items():
            assert said.setdefault(name, is_so) == is_so, (name, said[name], is_so)
    assert len(said) >= 25 and len(in_tables & in_claims) >= 8, (len(said), in_tables & in_claims)


def check_schema(program, folder):
    """Every record of every command is what `cinch schema` says."""
    try:
        import jsonschema
    except ImportError:
        print("records are not compared with the schema: python3-jsonschema is not there")
        return

    def output(*words, status=0):
        done = subprocess.run([program, *words, "--json"], capture_output=True, text=True)
        assert done.returncode == status, (words, done.stderr)
        return done.stdout

    schema = json.loads(subprocess.run([program, "schema"], capture_output=True, check=True).stdout)
    jsonschema.Draft202012Validator.check_schema(schema)
    valid = jsonschema.Draft202012Validator(schema)
    texts = [file.read_text() for file in folder.glob("*.jsonl")]
    texts += [output(*words.split()) for words in (
        "simulate beam --duration 0.02 --energies --explain", "stability --case inverted", "fuzz --cases 500",
        "scaling fish-8000 --seconds 0.01", "verify santa --nodes 20 --frames 1 --leaf 64 --volume --stats",
        "tightness santa fish-8000 --nodes 12 --frames 1 --leaf 512 --motion mild",
        "corners 010_generic_n7", "cost --simulation twist-180 --duration 0.01 --seconds 0.05")]
    texts.append(output("fuzz", "--cases", "500", "--sabotage", "lower-h", status=1))
    texts.append(output("verify", "santa", "--nodes", "20", "--frames", "1", "--leaf", "64", "--sabotage",
                        "lower-h", status=1))
    for detail in ("frames", "bvs"):
        plan = json.dumps({"inputs": "santa", "nodes": 12, "frames": 1, "leaf": 512, "detail": detail})
        texts.append(subprocess.run([program, "study", "-", "--json"], input=plan, capture_output=True, text=True,
                                    check=True).stdout)
    count = 0
    for text in texts:
        for line in text.splitlines():
            problem = next(valid.iter_errors(json.loads(line)), None)
            assert problem is None, (problem.message[:300], line[:300])
            count += 1
    assert count > 500, count


def main():
    program, folder = sys.argv[1], pathlib.Path(sys.argv[2])
    shutil.rmtree(folder, ignore_errors=True)
    command = [program, "reproduce", "--quick", "--out", str(folder)]

    # Ctrl-C in the first experiment: a page that says what is missing, and nothing that is not whole.
    run = subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
    while run.poll() is None and not (folder / "scaling.part").exists():
        time.sleep(0.02)
    run.send_signal(signal.SIGINT)
    _, err = run.communicate()
    assert run.returncode == 130 and "the same command continues" in err, (run.returncode, err)
    assert sorted(file.name for file in folder.iterdir() if file.name != ".lock") == ["report.html"]
    assert "Not run yet:" in (folder / "report.html").read_text()

    # Killed outright while the second experiment runs.
    run = subprocess.Popen(command, stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
    while run.poll() is None and not ((folder / "scaling.jsonl").exists() and list(folder.glob("*.part"))):
        time.sleep(0.02)
    run.send_signal(signal.SIGKILL)
    run.wait()
    stored = sorted(file.name for file in folder.glob("*.jsonl"))
    assert stored == ["scaling.jsonl"], stored
    before = (folder / "scaling.jsonl").read_bytes()

    start = time.monotonic()
    done = subprocess.run(command, capture_output=True, text=True)
    seconds = time.monotonic() - start
    assert done.returncode == 0, (done.returncode, done.stderr)
    assert "scaling: stored" in done.stderr and " left" in done.stderr, done.stderr
    assert (folder / "scaling.jsonl").read_bytes() == before, "what was finished was measured again"
    assert not list(folder.glob("*.part")) and not list(folder.glob("*.cells"))
    assert done.stdout.strip() == str(folder / "report.html"), done.stdout

    text = (folder / "report.html").read_text()
    assert len(text) < 25e6
    page = Page(text)
    assert len(page.ids) == len(set(page.ids)), "an id is there twice"
    ids, lines = set(page.ids), {}
    for file in folder.glob("*.jsonl"):
        for number, line in enumerate(file.read_text().splitlines(), 1):
            lines[f"{file.stem}.{number}"] = json.loads(line)
    figures = [target for target, is_figure in page.links if is_figure]
    assert len(figures) > 300, len(figures)
    for target in figures:
        assert target in ids and target in lines, f"#{target} leads to no line"
        for field in ("command", "seed", "commit", "cpu"):
            assert field in lines[target], (target, field)
    for target, _ in page.links:
        assert target in ids, f"#{target} leads nowhere"
    assert not page.remote, page.remote
    for part in ("claims", "table-1", "fig-5", "table-4", "cost", "proof", "provenance", "lines"):
        assert part in ids, f"the page has no part '{part}'"
    assert page.charts >= 8, page.charts
    check_verdicts(page)
    words = "".join(page.text)
    assert "Left out:" not in words and "A check failed:" not in words

    check_schema(program, folder)

    # Once more: nothing is left to run. Then damage.
    again = subprocess.run(command, capture_output=True, text=True)
    assert again.returncode == 0 and again.stderr.count(": stored") == len(list(folder.glob("*.jsonl"))), again.stderr
    # Shards of it are parts of the same: each finds its own experiments, merge misses what none has.
    shares = [subprocess.run([*command, "--shard", f"{i}/5"], capture_output=True, text=True) for i in range(5)]
    assert all(share.returncode == 0 for share in shares), [share.stderr for share in shares]
    found = [line for share in shares for line in share.stderr.splitlines()]
    assert sorted(found) == sorted(again.stderr.splitlines()), found
    merged = subprocess.run([program, "merge", str(folder)], capture_output=True, text=True)
    assert merged.returncode == 0 and merged.stdout.strip() == str(folder / "report.html"), merged
    (folder / "fishes.jsonl").rename(folder / "fishes.away")
    merged = subprocess.run([program, "merge", str(folder)], capture_output=True, text=True)
    assert merged.returncode == 2 and "lacks fishes; 'cinch reproduce --quick --out" in merged.stderr, merged
    (folder / "fishes.away").rename(folder / "fishes.jsonl")
    damaged = folder / "cost.jsonl"
    damaged.write_bytes(damaged.read_bytes()[:-200])
    report = subprocess.run([program, "report", str(folder)], capture_output=True, text=True)
    assert report.returncode == 2 and "cost.jsonl:" in report.stderr, (report.returncode, report.stderr)
    page = Page((folder / "report.html").read_text())
    assert "cost" not in page.ids and "table-4" in page.ids
    repaired = subprocess.run(command, capture_output=True, text=True)
    assert repaired.returncode == 0 and "1/1 cost" in repaired.stderr, repaired.stderr
    print(f"{len(figures)} figures, {page.charts} charts; {seconds:.0f} s after the kill")


if __name__ == "__main__":
    main()
