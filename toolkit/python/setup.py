# SPDX-License-Identifier: Apache-2.0
"""Builds the module cinch by CMake, from the source tree that this folder is a part of.

Everything that is made on the way stays in .build/python there, so that a second build takes what the first one made;
and from ccache, where that is there, whatever any other build of this tree made.
CINCH_BUILD=FOLDER takes the module from a build folder in which it is built already (cmake -DCINCH_PYTHON=ON);
CINCH_EXACT=OFF leaves cinch.exact out, CINCH_CMAKE_ARGS are further arguments of CMake's.
"""
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

here = pathlib.Path(__file__).resolve().parent
source = here.parent.parent
if not (source / "CMakeLists.txt").exists():
    sys.exit("cinch's module for Python is built from its whole source tree: pip install ./toolkit/python there")
version = re.search(r"project\(cinch VERSION ([\d.]+)", (source / "CMakeLists.txt").read_text()).group(1)
room = source / ".build" / "python"
(room / "metadata").mkdir(parents=True, exist_ok=True)


def configured(folder):
    """Configures the build, with whatever of the optional parts there are libraries for."""
    given = shlex.split(os.environ.get("CINCH_CMAKE_ARGS", ""))
    command = ["cmake", "-S", source, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_UNITY_BUILD=ON",
               "-DCINCH_TESTS=OFF", "-DCINCH_EXPERIMENTS=OFF", "-DCINCH_PYTHON=ON",
               f"-DCINCH_PYTHON_EXECUTABLE={sys.executable}"]
    if shutil.which("ninja"):
        command += ["-G", "Ninja"]
    exact = os.environ.get("CINCH_EXACT", "ON")
    for parts in dict.fromkeys([(exact, "ON"), ("OFF", "ON"), (exact, "OFF"), ("OFF", "OFF")]):
        tried = subprocess.run([*command, f"-DCINCH_EXACT={parts[0]}", f"-DCINCH_COMPRESSION={parts[1]}", *given],
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if tried.returncode == 0:
            print(f"cinch.exact: {parts[0]}, compressed glTF: {parts[1]}")
            return
        print(tried.stdout, f"cinch: without {' '.join(parts)} (exact, compression); the next choice", sep="\n")
    sys.exit("cinch: CMake cannot configure the build; see above")


class CMakeBuild(build_ext):
    """Runs CMake once, and copies what it made."""

    def run(self):
        made = os.environ.get("CINCH_BUILD")
        if not made:
            made = room
            for old in (room / "python" / "cinch").glob("exact/_exact*"):  # of a build with other parts
                old.unlink()
            configured(made)
            jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count() or 1))
            subprocess.run(["cmake", "--build", made, "--target", "cinch_python", "--parallel", jobs], check=True)
        package = pathlib.Path(made).resolve() / "python" / "cinch"
        modules = list(package.glob("_core*.so"))
        if len(modules) != 1:
            sys.exit(f"cinch: there is no module in {package}")
        to = here / "cinch" if self.inplace else pathlib.Path(self.build_lib) / "cinch"
        (to / "exact").mkdir(parents=True, exist_ok=True)
        for old in [*to.glob("_core*.so"), *to.glob("exact/_exact*")]:
            old.unlink()
        for module in modules + list(package.glob("exact/_exact*")):
            shutil.copy2(module, to / module.relative_to(package))

    def get_outputs(self):
        return [str(path) for path in (pathlib.Path(self.build_lib) / "cinch").rglob("_*.so")]


setup(
    version=version,
    ext_modules=[Extension("cinch._core", sources=[])],
    cmdclass={"build_ext": CMakeBuild},
    options={"build": {"build_base": str(room / "setuptools")}, "egg_info": {"egg_base": str(room / "metadata")}},
)
