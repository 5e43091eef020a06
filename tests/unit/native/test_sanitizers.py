"""Hostile input makes no kernel touch foreign memory, or do what C++ leaves undefined."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from sailenv_ros.native import compile as native_compile
from sailenv_ros.native.library import INSTRUCTION_SET_VARIABLE, LIBRARY_VARIABLE, load_library
from tests.packaging.project import ROOT

SOURCES = ROOT / "sailenv_ros" / "native" / "src"
"""An installed package has none."""

pytestmark = [pytest.mark.slow, pytest.mark.timeout(600)]

_ALL = load_library().instruction_sets
SETS = _ALL if os.environ.get("SAILENV_SANITIZE") == "all" else _ALL[-1:]
"""The widest set, or with SAILENV_SANITIZE=all, as in the weekly run, all that this machine has."""

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
FLAGS = (*SANITIZERS, "-O1", "-g1", "-fno-omit-frame-pointer")


@pytest.fixture(scope="module")
def objects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of object files, so that the second build compiles what differs alone."""
    return tmp_path_factory.mktemp("objects")


def test_no_sanitizer_complains(tmp_path: Path, objects: Path) -> None:
    """Of addresses and of undefined behaviour."""
    done = _driven(tmp_path, SOURCES, objects)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_sanitizers_would_complain(tmp_path: Path, objects: Path) -> None:
    """A kernel that writes one number too far is found: the test above can fail."""
    sources = tmp_path / "src"
    (sources / "kernels").mkdir(parents=True)
    for path in SOURCES.glob("*.*"):
        (sources / path.name).write_bytes(path.read_bytes())
    text = (SOURCES / "kernels" / "self_test.cpp").read_text()
    wrong = text.replace("counts[row]++", "counts[row + 1]++")
    assert wrong != text
    (sources / "kernels" / "self_test.cpp").write_text(wrong)
    done = _driven(tmp_path, sources, objects)
    assert done.returncode != 0
    assert "heap-buffer-overflow" in done.stderr
    assert "self_test.cpp" in done.stderr


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


def _driven(folder: Path, sources: Path, objects: Path) -> subprocess.CompletedProcess[str]:
    """Run the drivers against a build with sanitizers."""
    output = folder / native_compile.LIBRARY_NAME
    native_compile.compile_library(
        output,
        objects=objects,
        sources=sources,
        sets=SETS,
        extra_flags=FLAGS,
        strict=True,
    )
    # The library must pass for one of the present sources, or it would not be loaded.
    made_of = native_compile.compiled_hash(output)
    output.write_bytes(
        output.read_bytes().replace(made_of.encode(), native_compile.source_hash().encode())
    )
    runtime = subprocess.run(
        [*native_compile.find_compiler(), "-print-file-name=libasan.so"],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    environment = {key: value for key, value in os.environ.items() if key != "LD_PRELOAD"}
    environment |= {
        # Python itself is not built with the sanitizer, and keeps memory until it ends.
        "LD_PRELOAD": runtime,
        "ASAN_OPTIONS": "detect_leaks=0",
        # Small arrays too get memory whose ends are watched.
        "PYTHONMALLOC": "malloc",
        "PYTHONPATH": os.pathsep.join([*filter(None, [os.environ.get("PYTHONPATH")]), str(ROOT)]),
        LIBRARY_VARIABLE: str(output),
    }
    environment.pop(INSTRUCTION_SET_VARIABLE, None)
    return subprocess.run(
        [sys.executable, "-m", "tests.unit.native.hostile_input", *SETS],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=550,
        check=False,
    )
