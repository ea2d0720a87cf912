# SPDX-License-Identifier: Apache-2.0
"""Markdown of the schemas of scenes and of records, and of the list of words; where headers' names have their pages."""
import json
import re
import xml.etree.ElementTree as Tree

names = {"vector": "vector", "cells": "cells", "nodes": "simulation nodes", "bodies": "bodies", "body": "body",
         "effect": "effect"}


def number(value):
    return f"{value:g}" if isinstance(value, float) else str(value)


def limits(schema):
    parts = []
    for key, sign in (("minimum", "≥"), ("exclusiveMinimum", ">"), ("maximum", "≤"), ("exclusiveMaximum", "<")):
        if key in schema:
            parts.append(f"{sign}\N{NO-BREAK SPACE}{number(schema[key])}")
    return " and ".join(parts)


def kind(schema):
    """What a value may be, in one line."""
    if "$ref" in schema:
        name = schema["$ref"].rsplit("/", 1)[1]
        return f"[{names[name]}](#{names[name].replace(' ', '-')})"
    if "const" in schema:
        return f"`{json.dumps(schema['const'])}`"
    if "enum" in schema:
        return ", ".join(f"`{json.dumps(value)}`" for value in schema["enum"])
    for choice in ("oneOf", "anyOf"):
        if choice in schema:
            return "; or ".join(kind(one) for one in schema[choice])
    types = schema.get("type", "anything")
    types = [types] if isinstance(types, str) else types
    if types == ["object"]:
        return "{" + ", ".join(f"`{name}`: {kind(part)}" for name, part in schema.get("properties", {}).items()) + "}"
    if types == ["array"]:
        least, most = schema.get("minItems", 0), schema.get("maxItems")
        many = "" if not least and most is None else f"{least} " if least == most else \
            f"{least} or more " if most is None else f"{least} to {most} "
        items = schema.get("items")
        return f"list of {many}{several(kind(items)) if items else 'values'}"
    said = " or ".join("nothing" if t == "null" else t for t in types)
    return f"{said} {limits(schema)}".strip()


def meaning(schema):
    said = schema.get("description", "")
    said, _, default = said.removesuffix("]").partition(" [") if said.endswith("]") else (said, "", "")
    said = said and said[0].upper() + said[1:] + "."
    return f"{said} Default: {default.rstrip('.')}." if default else said


def several(text):
    """'[body](#body)' -> '[bodies](#body)'; what is of one word alone."""
    return re.sub(r"^(\[?)(number|integer|string|vector|effect|body)\b",
                  lambda m: m[1] + ("bodies" if m[2] == "body" else m[2] + "s"), text)


def cell(text):
    return text.replace("|", "\\|").replace("\n", " ")


def fields(schema, leave_out=()):
    required = schema.get("required", [])
    rows = ["| field | value | meaning |", "|---|---|---|"]
    for name, part in schema["properties"].items():
        if name not in leave_out:
            what = meaning(part) + (" *Required.*" if name in required else "")
            rows.append(f"| `{name}` | {cell(kind(part))} | {cell(what.strip())} |")
    return "\n".join(rows) if len(rows) > 2 else ""


def scenes(project):
    """The reference of scene files, of data/scenes/schema.json, which a test holds against the reader."""
    schema = json.loads((project / "data/scenes/schema.json").read_text(encoding="utf-8"))
    parts = schema["$defs"]
    text = [f"{schema['description']}", "## Scene", fields(schema, ["integrator"])]
    text += ["## Integrators", "The `integrator` of a scene; without one, the first."]
    for one in schema["properties"]["integrator"]["oneOf"]:
        text += [f"### {one['properties']['method']['const']}", fields(one)]
    text += ["## Body", fields(parts["body"]),
             "What goes with what (a sheet needs a `thickness`) is in `data/scenes/schema.json`."]
    text += ["### Vector", f"A {kind(parts['vector'])}.", "### Cells", f"A {kind(parts['cells'])}.",
             "### Bodies", f"A {kind(parts['bodies'])}. {meaning(parts['bodies'])}",
             "### Simulation nodes", meaning(parts["nodes"])]
    text += ["\n".join(f"- {kind(one)}" for one in parts["nodes"]["oneOf"])]
    text += ["## Effect", "One of these. Each has the field `effect`, its name; examples are run by the tests."]
    last = None
    for one in parts["effect"]["oneOf"]:
        name = one["properties"]["effect"]["const"]
        if name != last:
            text.append(f"### {name}")
        last = name
        text += [one["description"][0].upper() + one["description"][1:] + ":", fields(one, ["effect"])]
        text += [f"```json\n{json.dumps(example)}\n```" for example in one.get("examples", [])]
    return "\n\n".join(part for part in text if part)


def records(project):
    """The fields of --json, of experiments/records/record.schema.json, which `cinch schema` prints."""
    schema = json.loads((project / "experiments/records/record.schema.json").read_text(encoding="utf-8"))
    return fields(schema)


def words(project):
    """The glossary: of `*Word*, *word*: meaning.` in the section of toolkit/README.md."""
    text = (project / "toolkit/README.md").read_text(encoding="utf-8").partition("## Words\n")[2].partition("\n#")[0]
    text = " ".join(text.split())
    starts = [m.start() for m in re.finditer(r"(?:\*[^*]+\*(?:, )?)+(?: [\w']+)?:", text)]
    made = []
    for start, end in zip(starts, starts[1:] + [len(text)]):
        head, _, rest = text[start:end].partition(":")
        rest = rest.strip(" ;")
        terms = [(t[0].lower() if t[1:2].islower() else t[0]) + t[1:] for t in re.findall(r"\*([^*]+)\*", head)]
        sign = head.rpartition("*")[2].strip()  # b_j of 'extremum b_j'
        made.append("\n".join(terms) + "\n: " + (f"{sign}, {rest}" if sign else rest[0].upper() + rest[1:])
                    + ("" if rest.endswith(".") else "."))
    return made and "```{glossary}\n" + "\n\n".join(g.replace("\n: ", "\n  ") for g in made) + "\n```"


def headers(tags):
    """Qualified name -> address within the site, from Doxygen's tags; the first of overloads."""
    found = {}
    for compound in Tree.parse(tags).getroot().iter("compound"):
        page, name = compound.findtext("filename"), compound.findtext("name")
        if compound.get("kind") == "file":
            page += "" if page.endswith(".html") else ".html"
            found.setdefault(name, f"cpp/{page}")
        elif compound.get("kind") in ("class", "struct", "namespace"):
            found[name] = f"cpp/{page}"
        outer = "" if compound.get("kind") == "file" else name + "::"
        for member in compound.iter("member"):
            if member.findtext("anchorfile"):
                found.setdefault(outer + member.findtext("name"),
                                 f"cpp/{member.findtext('anchorfile')}#{member.findtext('anchor')}")
    return found
