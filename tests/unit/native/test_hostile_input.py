"""Hostile input makes no kernel fall, and threads do not race; scripts/sanitize looks deeper."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sailenv_ros.native import compile as native_compile
from sailenv_ros.native.library import load_library
from tests.packaging.project import ROOT

SOURCES = ROOT / "sailenv_ros" / "native" / "src"
"""An installed package has none."""

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]


def test_no_kernel_falls() -> None:
    """By any driver; the allocator looks after the ends of what it gives, and fills it."""
    done = subprocess.run(
        [sys.executable, "-m", "tests.unit.native.hostile_input", load_library().instruction_set],
        env=os.environ
        | {
            "PYTHONMALLOC": "malloc",
            "MALLOC_PERTURB_": "165",
            "GLIBC_TUNABLES": "glibc.malloc.check=3",
            "PYTHONPATH": os.pathsep.join(
                [*filter(None, [os.environ.get("PYTHONPATH")]), str(ROOT)]
            ),
        },
        capture_output=True,
        text=True,
        timeout=550,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_threads_of_the_pool_do_not_race(tmp_path: Path) -> None:
    """By ThreadSanitizer, which sees accesses without a lock even where nothing went wrong."""
    program = tmp_path / "many_callers"
    sources = [Path(__file__).with_name("many_callers.cpp"), SOURCES / "threads.cpp"]
    flags = ("-std=c++17", "-O1", "-g1", "-fsanitize=thread", "-pthread", f"-I{SOURCES}")
    compiler = native_compile.find_compiler()
    subprocess.run([*compiler, *flags, *map(str, sources), "-o", str(program)], check=True)
    done = subprocess.run([str(program)], capture_output=True, text=True, timeout=300, check=False)
    if "unexpected memory mapping" in done.stderr:
        # Older versions of the sanitizer cannot begin where addresses are very random.
        done = subprocess.run(
            ["setarch", "-R", str(program)],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
    assert done.returncode == 0, done.stderr[:6000]
