# SPDX-License-Identifier: GPL-3.0-or-later
"""The stubs are those of what is there, and what pip makes can be imported from where it is put."""
import os
import pathlib
import re
import subprocess
import sys
import zipfile

import cinch
import pytest

source = pathlib.Path(__file__).resolve().parents[2]
use = '''
import numpy as np
import cinch

mesh = cinch.read_mesh("a.obj")
surface = cinch.Surface(mesh.vertices, mesh.triangles, np.ones((len(mesh.vertices), 1)))
boxes = cinch.Refitter(cinch.build_bvh(surface), method="best", kdop=14)(np.eye(3, 4)[None])
for frame in cinch.Simulation("beam.json"):
    reveal_type(frame.maps)
cinch.Refitter(cinch.build_bvh(surface), mehtod="best")
cinch.build_bvh(3)
'''


def python(*arguments, **more):
    return subprocess.run([sys.executable, *arguments], capture_output=True, text=True, **more)


def test_stubs_are_accepted_and_find_faults(tmp_path):
    pytest.importorskip("mypy")
    package = pathlib.Path(cinch.__file__).parent
    environment = {**os.environ, "MYPYPATH": str(package.parent)}
    own = python("-m", "mypy", "--strict", "--cache-dir", tmp_path, "-p", "cinch", env=environment, cwd=tmp_path)
    assert own.returncode == 0, own.stdout + own.stderr
    (tmp_path / "use.py").write_text(use)
    of_use = python("-m", "mypy", "--strict", "--cache-dir", tmp_path, "use.py", env=environment, cwd=tmp_path).stdout
    assert re.findall(r"use.py:(\d+): error", of_use) == ["10", "11"] and "tuple[numpy.ndarray" in of_use, of_use


def test_stubs_name_what_is_there():
    """Every public name, and every member of every class, in both directions."""
    import ast
    modules = {"cinch": source / "toolkit/python/cinch/_core.pyi"}
    try:
        import cinch.exact
        modules["cinch.exact"] = source / "exact/python/cinch/exact/_exact.pyi"
    except ImportError:
        pass
    for name, stub in modules.items():
        module = sys.modules[name]
        there = {n for n in module.__all__ if n != "__version__"}
        said, members = set(), {}
        for node in ast.parse(stub.read_text()).body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and not node.name.startswith("_"):
                said.add(node.name)
                if isinstance(node, ast.ClassDef):
                    members[node.name] = {m.name for m in node.body if isinstance(m, ast.FunctionDef)}
            elif isinstance(node, ast.AnnAssign) and not node.target.id.startswith("_"):
                said.add(node.target.id)
        assert there == said - {"Force"}, there ^ said
        for each, of_stub in members.items():
            if each == "Force" or issubclass(getattr(module, each), Exception):
                continue
            own = {m for m, thing in vars(getattr(module, each)).items()
                   if not m.startswith("_") or m in ("__call__", "__len__", "__getitem__", "__iter__", "__next__")}
            assert own == {m for m in of_stub if m not in ("__init__", "__enter__", "__exit__")}, (each, own ^ of_stub)


def test_everything_public_has_a_page():
    import inspect
    for name in cinch.__all__:
        thing = getattr(cinch, name)
        if inspect.isclass(thing) or inspect.isroutine(thing):
            assert thing.__doc__ and thing.__module__ == "cinch", name
            for member, of in vars(thing).items() if inspect.isclass(thing) else ():
                if not member.startswith("_"):
                    assert of.__doc__, f"{name}.{member}"


def test_a_wheel_can_be_made_and_used(tmp_path):
    build = os.environ.get("CINCH_BUILD")
    if not build:
        pytest.skip("SKIPPED: CINCH_BUILD does not say where the module is built")
    made = python("-m", "pip", "wheel", "--no-build-isolation", "--no-deps", "--no-index", "-w", tmp_path,
                  source / "toolkit/python", env={k: v for k, v in os.environ.items() if k != "PYTHONPATH"})
    assert made.returncode == 0, made.stdout + made.stderr
    (wheel,) = tmp_path.glob("cinch-*.whl")
    version = re.search(r"project\(cinch VERSION ([\d.]+)", (source / "CMakeLists.txt").read_text()).group(1)
    assert wheel.name.startswith(f"cinch-{version}-cp") and cinch.__version__ == version
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        archive.extractall(tmp_path / "site")
        metadata = archive.read(f"cinch-{version}.dist-info/METADATA").decode()
    assert {"cinch/__init__.py", "cinch/_core.pyi", "cinch/py.typed", "cinch/exact/__init__.py"} <= set(names)
    for line in (f"Version: {version}", "License: Apache-2.0, and GPL-3.0-or-later for cinch.exact",
                 "Classifier: License :: OSI Approved :: Apache Software License", "License-File: LICENSE"):
        assert line in metadata.splitlines(), metadata
    used = python("-c", "import cinch; print(cinch.__file__, cinch.axes(6).shape)", cwd=tmp_path,
                  env={**os.environ, "PYTHONPATH": str(tmp_path / "site")})
    assert used.stdout.startswith(str(tmp_path)) and "(3, 3)" in used.stdout, used.stdout + used.stderr


def test_what_the_readme_shows_runs(exact, data):
    (code,) = re.findall(r"```python\n(.*?)```", (source / "README.md").read_text(), re.DOTALL)
    assert len(code.splitlines()) <= 14 and '"character.glb"' in code
    used = python("-c", code.replace('"character.glb"', repr(str(data / "scenes" / "tube.glb"))))
    assert used.returncode == 0, used.stderr
    assert "8184" in used.stdout or "1023" in used.stdout, used.stdout


def test_without_the_exact_side_its_absence_has_a_sentence(tmp_path):
    import shutil
    shutil.copytree(pathlib.Path(cinch.__file__).parent, tmp_path / "cinch",
                    ignore=shutil.ignore_patterns("_exact*.so"))
    said = python("-c", "import cinch.exact", env={**os.environ, "PYTHONPATH": str(tmp_path)}, cwd=tmp_path).stderr
    assert "ImportError: cinch.exact is not part of this build; install libcgal-dev" in said, said
