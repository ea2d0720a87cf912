#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""write_sources.py PROJECT OUT SITE: what Sphinx makes the site of. The pages beside this script, in which a line

    @section FILE "Heading"      is that section of a Markdown file of the project,
    @opening FILE "Heading"      what stands before its first heading,
    @code FILE "Heading" N       its N-th block of code,
    @intro FILE                  its first paragraph, and
    @scenes, @records, @words    are the tables that reference.py makes of the schemas and of the list of words;

and a page per class of Python's modules. Nothing is said twice: what stands elsewhere is taken from there. OUT/project
is the project itself, for `literalinclude`. What there is in SITE is removed, but for the headers' pages, SITE/cpp."""
import ast
import pathlib
import re
import shutil
import sys

import reference

# Where a document of the project is on the site; links to any other file of it are its name alone.
pages = {"README.md": "index.md", "toolkit/README.md": "headers.md", "data/scenes/README.md": "scenes.md",
         "exact/proof/README.md": "proven.md", "exact/proof/checker/README.md": "proven.md",
         "tests/examples/character_bounds.cpp": "character.md", "tests/examples/c_bounds.c": "character.md",
         "tests/examples/load_bounds.cpp": "engine.md"}
sections = {"a-proof-that-others-can-check": "proof.md"}
constants = {"kdops": "Every k for which there are k-DOPs; their axes are `axes` of k."}
modules = {"cinch": "toolkit/python/cinch/_core.pyi", "cinch.exact": "exact/python/cinch/exact/_exact.pyi"}


tags = None  # of the headers' pages


def link_within(document, project):
    """Of a match of [text](target) or ![text](target) in that document: what stands for it on the site."""
    def one(match):
        image, text, target = match.groups()
        if "://" in target:
            return match.group(0)
        if target.startswith("#"):
            return f"[{text}]({sections[target[1:]]})" if target[1:] in sections else text
        path = (project / document).parent.joinpath(target).resolve().relative_to(project).as_posix()
        if image:
            return f"![{text}](project/{path})"
        if path.endswith(".png"):
            return f"{text} (`{path}`)"
        return f"[{text}]({pages[path]})" if path in pages else text
    return one


def section(project, document, heading):
    """Its text without the heading, links made fit, headings in it one level up to come below the page's own."""
    lines = (project / document).read_text(encoding="utf-8").splitlines()
    fenced, found, level = False, None, 0
    for number, line in enumerate(lines):
        if line.startswith("```"):
            fenced = not fenced
        if fenced or not line.startswith("#"):
            continue
        marks, _, title = line.partition(" ")
        if found is not None and len(marks) <= level:
            lines = lines[found:number]
            break
        if found is None and title == heading:
            found, level = number + 1, len(marks)
    else:
        if found is None:
            sys.exit(f"{document}: no section '{heading}'")
        lines = lines[found:]
    return linked(project, document, "\n".join(lines).strip())


def linked(project, document, text):
    parts = re.split(r"(^```.*?^```$)", text, flags=re.M | re.S)  # code stays as it is
    parts[::2] = [re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", link_within(document, project), p) for p in parts[::2]]
    if document == "toolkit/README.md":  # names of headers and of what they declare
        known = reference.headers(tags)
        parts[::2] = [re.sub(r"`([A-Z]\w+(?:::\w+)?|\w+_\w+|\w+\.hp*)`", lambda m: next(
            (f"{{api}}`{m[1]} <{name}>`" for name in ("cinch::" + m[1], m[1]) if name in known), m[0]), p)
            for p in parts[::2]]
    return "".join(parts)


def intro(project, document):
    text = (project / document).read_text(encoding="utf-8")
    return linked(project, document, next(p for p in text.split("\n\n") if not p.startswith(("#", "<!--"))))


def filled(project, text):
    def one(match):
        kind, document, heading, number = match.group(1, 2, 3, 4)
        if kind == "section":
            return section(project, document, heading)
        if kind == "opening":
            return section(project, document, heading).partition("\n## ")[0]
        if kind == "intro":
            return intro(project, document)
        if kind == "code":
            blocks = re.findall(r"^```.*?^```$", section(project, document, heading), re.M | re.S)
            return blocks[int(number) - 1]
        return {"scenes": reference.scenes, "records": reference.records, "words": reference.words}[kind](project)
    kinds = "section|opening|code|intro|scenes|records|words"
    return re.sub(rf'^@({kinds})(?: (\S+))?(?: "([^"]+)")?(?: (\d+))?$', one, text, flags=re.M)


def stubs(project, module):
    """Classes and functions of a module, as its stub has them in order."""
    body = ast.parse((project / modules[module]).read_text(encoding="utf-8")).body
    public = [thing for thing in body if not getattr(thing, "name", "_").startswith("_")]
    classes = [t.name for t in public if isinstance(t, ast.ClassDef)
               and not any(getattr(base, "id", "") == "Protocol" for base in t.bases)]
    functions = list(dict.fromkeys(t.name for t in public if isinstance(t, ast.FunctionDef)))
    return classes, functions


def python_pages(project):
    """Name of a source -> its text: a page per module with its functions, and one per class."""
    made = {}
    for module in modules:
        classes, functions = stubs(project, module)
        title = f"The module {module}"
        text = [title, "=" * len(title), "", f".. automodule:: {module}", "   :no-members:", "   :no-special-members:"]
        text += [""]
        for kind, names in (("Classes", classes), ("Functions", functions)):
            text += [kind, "-" * len(kind), "", f".. currentmodule:: {module}", "", ".. autosummary::", ""]
            text += [f"   {name}" for name in names] + [""]
        text += [f".. autofunction:: {name}\n" for name in functions]
        for name in [t.target.id for t in ast.parse((project / modules[module]).read_text()).body
                     if isinstance(t, ast.AnnAssign) and not t.target.id.startswith("_")]:
            text += [f".. py:data:: {name}\n\n   {constants[name]}\n"]
        text += [".. toctree::", "   :hidden:", ""] + [f"   {module}.{name}" for name in classes]
        made[f"{module}.rst"] = "\n".join(text) + "\n"
        for name in classes:
            kind = "autoexception" if name in ("InputError", "CheckFailed") else "autoclass"
            made[f"{module}.{name}.rst"] = f"{name}\n{'=' * len(name)}\n\n.. {kind}:: {module}.{name}\n"
    return made


def remove_but(folder, kept):
    for old in folder.iterdir():
        if old.name not in kept:
            shutil.rmtree(old) if old.is_dir() and not old.is_symlink() else old.unlink()


def main(project, out, site):
    global tags
    project, out, site = pathlib.Path(project).resolve(), pathlib.Path(out), pathlib.Path(site)
    tags = out / "cpp.tag"
    remove_but(out, [tags.name])
    remove_but(site, ["cpp"])
    for name, text in python_pages(project).items():
        (out / name).write_text(text, encoding="utf-8")
    for page in pathlib.Path(__file__).resolve().parent.glob("*.md"):
        (out / page.name).write_text(filled(project, page.read_text(encoding="utf-8")), encoding="utf-8")
    (out / "project").symlink_to(project)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
