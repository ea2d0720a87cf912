#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""symbols_test.py NM LIBRARY HEADERS: what the shared library exports are the functions of its headers, with their
version, and nothing else; and the bits of methods stand in the order of C++'s table."""
import pathlib
import re
import subprocess
import sys

nm, library, headers = sys.argv[1:]
text = "".join(header.read_text() for header in pathlib.Path(headers, "cinch").glob("*.h"))
declared = set(re.findall(r"CINCH_API [^;]*?\b(cinch_\w+)\(", text))
lines = subprocess.run([nm, "-D", "--defined-only", library], check=True, capture_output=True, text=True).stdout
exported = dict(line.split()[:0:-1] for line in lines.splitlines())
version = {name.split("@")[0] for name, kind in exported.items() if kind == "A"}  # GNU's nm names it plain, LLVM's not
assert len(version) == 1 and re.fullmatch(r"CINCH_\d+\.\d+", next(iter(version))), version
named = {f"{name}@@{next(iter(version))}" for name in declared}
found = {name for name, kind in exported.items() if kind != "A"}
assert found == named, f"not exported: {named - found}; exported, and not declared: {found - named}"
assert all(exported[name] == "T" for name in found)

table = pathlib.Path(headers, "cinch", "bounds.hpp").read_text()
names = re.findall(r'MethodInfo\{Method::(\w+), "\1",', table)
bits = [(name, int(value)) for name, value in re.findall(r"CINCH_METHOD_(\w+) = (\d+)", text)]
assert len(names) >= 11 and bits == [(name.upper(), 1 << i) for i, name in enumerate(names)], (names, bits)
print(f"{len(found)} functions are exported, all of {next(iter(version))}; {len(bits)} methods")
