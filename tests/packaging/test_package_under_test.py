"""The tests run against what they are meant to run against."""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.packaging.project import ROOT

PREFIX = Path(os.environ.get("SAILENV_INSTALLED_PREFIX") or ROOT)


@pytest.mark.parametrize("name", ["sailenv_ros", "sailenv_msgs_py"])
def test_imports_come_from_the_install_under_test(name: str) -> None:
    """Under scripts/test that is the installed wheel, otherwise the source folder."""
    folder = Path(importlib.import_module(name).__file__ or "").parent
    assert folder.is_relative_to(PREFIX)
    assert (folder == ROOT / name) == (PREFIX == ROOT)


def test_programs_that_are_started_import_the_same() -> None:
    """A child process without further care finds the package under test too."""
    code = "import sailenv_ros; print(sailenv_ros.__file__)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == importlib.import_module("sailenv_ros").__file__
