#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""site_test.py SOURCE SITE: every link of the site leads to a file and a place in it; nothing but links in texts, which
the documents of SOURCE have, leads out; every public name of C, C++ and Python is there, with what it is, and so are
all effects, fields of scenes and of records; the bounds of a character are within two clicks of the start; and all code
is that of tested examples. Then the site is damaged in each of these ways, which must be found."""
import ast
import json
import pathlib
import re
import sys

from pages import Site


def links(site, source):
    """Of the addresses of one site."""
    documents = [path.read_text(encoding="utf-8") for path in source.rglob("*.md") if ".build" not in path.parts]
    cited = {address for text in documents for address in re.findall(r"\((https?://[^)\s]+)\)", text)}
    for name, page in site.pages.items():
        for address, inside in [(a, False) for a in page.resources] + [(a, True) for a, _ in page.links]:
            if address.startswith("data:") or address == "#":
                continue
            target = site.target(name, address)
            if target is None:
                if not (inside and address in cited):
                    yield f"{name}: leads out: {address}"
            elif target[0] not in site.files:
                yield f"{name}: no file: {address}"
            elif target[1] and target[0] in site.pages and target[1] not in site.pages[target[0]].ids:
                yield f"{name}: no place: {address}"
    for name, text in site.styles():
        for address in re.findall(r"url\(\s*[\"']?([^\"')]+)", text) + re.findall(r"@import\s+[\"']([^\"']+)", text):
            target = site.target(name, address)
            if not address.startswith("data:") and (target is None or target[0] not in site.files):
                yield f"{name}: no file: url({address})"
    for name in sorted(site.files):
        wanted = r"^\s*import\b.*from|\.src\s*=\s*[\"'`](?:https?:)?//"
        if name.endswith(".js") and re.search(wanted, site.read(name), re.M):
            yield f"{name}: a script that wants another"


def declared(source):
    """Names of classes and functions of C++, and of functions of C, as headers declare them at the line's begin."""
    classes, functions, of_c = set(), set(), set()
    for header in sorted((source / "toolkit/include/cinch").glob("*.h*")):
        text = header.read_text(encoding="utf-8")
        if header.suffix == ".h":
            of_c.update(re.findall(r"^CINCH_API [^;(]*?\b(cinch_\w+)\(", text, re.M))
        else:
            classes.update(re.findall(r"^(?:class|struct) (\w+)[^;{]*\{", text, re.M))
            functions.update(re.findall(r"^(?!using|static_assert|return)(?:\[\[nodiscard\]\] )?(?:inline |constexpr )*"
                                        r"[\w:]+(?:<[^;()]*>)?[&*]? (\w+)\(", text, re.M))
    return classes, functions, of_c


def names(site, source):
    classes, functions, of_c = declared(source)
    if len(classes) < 30 or len(functions) < 30 or len(of_c) < 40:
        yield f"headers: only {len(classes)} classes, {len(functions)} functions, {len(of_c)} of C were found"

    def listed(start):
        return {text.strip("() ") for name, page in site.pages.items() if name.startswith(f"cpp/{start}")
                for _, text in page.links}

    of_classes = {name.rsplit("::", 1)[-1] for name in listed("annotated")}
    yield from (f"C++: no class {name}" for name in sorted(classes - of_classes))
    of_functions = " ".join(page.text for name, page in site.pages.items() if name.startswith("cpp/namespacemembers"))
    yield from (f"C++: no function {name}" for name in sorted(functions) if f"{name}()" not in of_functions)
    of_headers = " ".join(page.text for name, page in site.pages.items() if name.startswith("cpp/globals_func"))
    yield from (f"C: no function {name}" for name in sorted(of_c) if f"{name}()" not in of_headers)

    known = site.python_names()
    for module, stub in (("cinch", "toolkit/python/cinch/_core.pyi"),
                         ("cinch.exact", "exact/python/cinch/exact/_exact.pyi")):
        wanted = []
        for thing in ast.parse((source / stub).read_text(encoding="utf-8")).body:
            if isinstance(thing, ast.AnnAssign) and not thing.target.id.startswith("_"):
                wanted.append(f"{module}.{thing.target.id}")
            if isinstance(thing, (ast.ClassDef, ast.FunctionDef)) and not thing.name.startswith("_") and not any(
                    getattr(base, "id", "") == "Protocol" for base in getattr(thing, "bases", [])):
                wanted.append(f"{module}.{thing.name}")
                wanted += [f"{module}.{thing.name}.{member.name}" for member in getattr(thing, "body", [])
                           if isinstance(member, ast.FunctionDef)
                           and (not member.name.startswith("_") or member.name == "__call__")
                           and isinstance(thing, ast.ClassDef)]
        for name in wanted:
            page, fragment = known.get(name, ("", ""))
            if page not in site.pages:
                yield f"Python: {name} is not there"
            elif not site.pages[page].said.get(fragment, "").strip():
                yield f"Python: nothing is said of {name}"


def schemas(site, source):
    scene = json.loads((source / "data/scenes/schema.json").read_text(encoding="utf-8"))
    parts = [scene, scene["$defs"]["body"], *scene["$defs"]["effect"]["oneOf"]]
    effects = {one["properties"]["effect"]["const"] for one in parts[2:]}
    said = site.pages["scenes.html"]
    yield from (f"scenes.html: no effect {name}" for name in sorted(effects) if name not in said.ids)
    fields = {name for part in parts for name in part["properties"]}
    yield from (f"scenes.html: no field {name}" for name in sorted(fields) if f" {name} " not in f"{said.text} ")
    record = json.loads((source / "experiments/records/record.schema.json").read_text(encoding="utf-8"))
    said = site.pages["records.html"].text
    yield from (f"records.html: no field {name}" for name in record["properties"] if f" {name} " not in said)


def clicks(site, source):
    start = site.pages["index.html"]
    if "bounds of my character" not in start.text or "How do I" not in start.text:
        yield "index.html: does not say where the bounds of my character are"
    places = {"character-cpp", "character-c", "character-python", "character-command"}
    found = [name for name in site.within("index.html", 2) if "Bounds of my character" in site.pages[name].h1
             and places <= site.pages[name].ids]
    if not found:
        yield "index.html: bounds of my character are not within two clicks"
    direct = {site.target("index.html", address) for address, _ in start.links}
    yield from (f"index.html: no link to {place}" for place in sorted(places)
                if ("character.html", place) not in direct)
    reached = site.within("index.html", 8)
    yield from (f"{name}: nothing leads there" for name in sorted(set(site.pages) - reached)
                if name != "search.html"
                and not re.search(r"cpp/(dir_|.*-members|functions|globals|namespacemembers)", name))


def code(site, source):
    """Of the sources of the pages."""
    tested = "".join((source / "tests" / room / "CMakeLists.txt").read_text() for room in ("examples", "python"))
    for path in sorted((source / "toolkit/pages").glob("*.md")):
        text = site.changed.get(path.name) or path.read_text(encoding="utf-8")
        yield from (f"{path.name}: code that no test runs: ```{language}" for language in
                    re.findall(r"^```(cpp|c|python)$", text, re.M))
        for example in re.findall(r"^```\{literalinclude\} (\S+)", text, re.M):
            name = pathlib.Path(example)
            run = name.name if name.suffix == ".py" else name.stem
            if not example.startswith("project/tests/examples/") or not re.search(rf"\b{re.escape(run)}\b", tested):
                yield f"{path.name}: {example} is not tested"


checks = (links, names, schemas, clicks, code)


def faults(site, source):
    return [fault for check in checks for fault in check(site, source)]


def main(source, folder):
    source = pathlib.Path(source)
    whole = Site(folder)
    found = faults(whole, source)
    assert not found, "\n" + "\n".join(found[:40])

    def damaged(page, old, new, expected, text=None):
        text = text or whole.read(page)
        assert old in text, f"{page} has no {old}"
        said = faults(Site(folder, {page: text.replace(old, new)}), source)
        assert any(expected in fault for fault in said), f"{page}: '{expected}' was not found; only {said[:5]}"

    damaged("character.html", 'id="character-c"', 'id="other"', "no place: character.html#character-c")
    damaged("index.html", 'href="install.html"', 'href="instal.html"', "no file: instal.html")
    damaged("index.html", "</head>", '<script src="https://example.org/a.js"></script></head>', "leads out")
    damaged("index.html", "</article>", '<a href="https://example.org/">more</a></article>', "leads out")
    damaged("index.html", "</head>", "<style>@import url(//example.org/font.css);</style></head>", "url(//example.org")
    damaged("index.html", 'href="character.html', 'href="engine.html', "no link to character-cpp")
    damaged("scenes.html", 'id="damping"', "", "no effect damping")
    damaged("records.html", "frames_done", "", "no field frames_done")
    damaged("cpp/globals_func.html", "cinch_bvh_build()", "", "no function cinch_bvh_build")
    damaged("cinch.Refitter.html", "The number of directions.", "", "nothing is said of cinch.Refitter.kdop")
    damaged("weights.md", "# My own", "```python\nimport cinch\n```\n# My own", "no test runs",
            (source / "toolkit/pages/weights.md").read_text(encoding="utf-8"))
    addresses = [(name, address) for name, page in whole.pages.items() for address, _ in page.links]
    outside = sum(whole.target(*address) is None for address in addresses)
    print(f"{len(whole.pages)} pages, {len(addresses)} links, {outside} of them, in texts, to the web; "
          f"{len(whole.python_names())} names of Python; 11 damages are found")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
