# SPDX-License-Identifier: GPL-3.0-or-later
"""What the tests of Python's module share. The environment says where things are: CINCH_REFERENCE, the library of
reference.cpp; CINCH_PROGRAM, the program cinch; tests that need what is not there skip."""
import os
import pathlib
import sys

import hypothesis
import pytest

hypothesis.settings.register_profile("cinch", database=None, derandomize=True, deadline=None)  # the same on every run
hypothesis.settings.load_profile("cinch")
sys.path.insert(0, str(pathlib.Path(__file__).parent))
source = pathlib.Path(__file__).resolve().parents[2]


def pytest_report_header():
    import cinch
    return f"cinch {cinch.__version__} from {cinch.__file__}"


@pytest.fixture(scope="session")
def data():
    return source / "data"


@pytest.fixture(scope="session")
def exact():
    return pytest.importorskip("cinch.exact")


@pytest.fixture(scope="session")
def program():
    path = os.environ.get("CINCH_PROGRAM")
    if not path or not os.path.exists(path):
        pytest.skip("SKIPPED: the program cinch is not built")
    return path


@pytest.fixture(scope="session")
def tube(data):
    import cinch
    return cinch.read_character(data / "scenes" / "tube.glb")
