#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""readme_test.py SOURCE: the code that README.md shows is that of the example, and every path that the documents name
is there."""
import pathlib
import re
import sys

source = pathlib.Path(sys.argv[1])
readme = (source / "README.md").read_text()
example = (source / "tests/examples/character_bounds.cpp").read_text()
code = example[example.index("#include"):]
assert f"```cpp\n{code}```" in readme, "README.md: the first example is not tests/examples/character_bounds.cpp"

missing = []
for document in ("README.md", "toolkit/README.md", ".github/CONTRIBUTING.md", "data/scenes/README.md"):
    text = (source / document).read_text()
    here = (source / document).parent
    rooms = "toolkit|exact|experiments|tests|data|bounds|hierarchy|collide|include|simulate"
    for path in re.findall(rf"`((?:\.\./)*(?:{rooms})/[\w./-]*\w)`", text):
        if "NAME" not in path and not any((base / path).exists() for base in (source, here)):
            missing.append(f"{document}: {path}")
assert not missing, "\n".join(missing)
print("README.md shows the example; all paths are there")
