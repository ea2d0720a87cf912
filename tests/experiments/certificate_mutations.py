# SPDX-License-Identifier: GPL-3.0-or-later
"""What is done to certificates; certificate_mutations_of_*.py fill in:

MUTATIONS: name -> (change of a certificate's records, part of the reason to reject it).
HARMLESS: name -> a change of nothing.

Names with "sealed" carry hashes and counts that fit, so that what is wrong must be found itself; names with "of best"
change the certificate of method best, the others that of limited. A change returns records, texts of lines or bytes."""
import json

from certificate_forge import of, sealed

MUTATIONS, HARMLESS = {}, {}


def text_of(records, **style):
    return "".join(json.dumps(r, **style) + "\n" for r in records).encode()


def mutation(name, reason):
    def add(change):
        MUTATIONS[name] = change, reason
        return change
    return add


def harmless(change):
    HARMLESS[change.__name__.replace("_", " ")] = change
    return change


def field(key, path, value, reason, seal=False, name=None, which=3):
    """Sets a field of the record number `which` of those with the key; value may be a function of what stood there."""
    def change(records):
        place = of(records, key) if key != "certificate" else [0]
        target = records[place[min(which, len(place) - 1)]]
        for step in path[:-1]:
            target = target[step]
        target[path[-1]] = value(target[path[-1]]) if callable(value) else value
        return sealed(records) if seal else records
    default = f"{key}: {'.'.join(map(str, path))} = {str(value)[:30]}" + (", sealed" if seal else "")
    MUTATIONS[name or default] = change, reason


def leaves(records):
    return [records[i] for i in of(records, "triangles") if "bv" in records[i]]


def inner(records):
    return [records[i] for i in of(records, "children")]


def lower(by):
    return lambda x: (float.fromhex(x) - by).hex()
