"""Builds the native library with sanitizers, and drives every kernel with hostile input.

    scripts/sanitize [--all-sets]

No kernel may touch foreign memory, or do what C++ leaves undefined. A kernel that is made to write
one number too far must be found, or the sanitizers would say nothing. Two minutes of compiling:
GitHub runs it for each pull request, and `scripts/test` drives the library as it is shipped.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Collection
from pathlib import Path

from sailenv_ros.native import compile as native_compile
from sailenv_ros.native.library import INSTRUCTION_SET_VARIABLE, LIBRARY_VARIABLE, load_library
from tests.packaging.project import ROOT

SOURCES = ROOT / "sailenv_ros" / "native" / "src"
"""An installed package has none."""

SANITIZERS = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")
FLAGS = (*SANITIZERS, "-O1", "-g1", "-fno-omit-frame-pointer")


def main() -> int:
    """Return 0 if nothing was found but what was put there."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--all-sets", action="store_true", help="all instruction sets, not the widest one alone"
    )
    known = load_library().instruction_sets
    sets = known if parser.parse_args().all_sets else known[-1:]
    with tempfile.TemporaryDirectory(prefix="sailenv-sanitized-") as name:
        folder = Path(name)
        done = _driven(folder, SOURCES, sets)
        if done.returncode != 0:
            print(done.stdout + done.stderr)
            return 1
        print(f"no sanitizer complains of {', '.join(sets)}", flush=True)
        done = _driven(folder, _with_a_fault(folder / "src"), sets)
    for words in ("heap-buffer-overflow", "self_test.cpp"):
        if done.returncode == 0 or words not in done.stderr:
            print(f"a kernel that writes too far was not found: {words} is not told\n{done.stderr}")
            return 1
    print("a kernel that writes one number too far is found")
    return 0


def _with_a_fault(sources: Path) -> Path:
    """Return a folder whose sources have one kernel that writes too far, and no other."""
    (sources / "kernels").mkdir(parents=True)
    for path in SOURCES.glob("*.*"):
        (sources / path.name).write_bytes(path.read_bytes())
    text = (SOURCES / "kernels" / "self_test.cpp").read_text()
    wrong = text.replace("counts[row]++", "counts[row + 1]++")
    assert wrong != text
    (sources / "kernels" / "self_test.cpp").write_text(wrong)
    return sources


def _driven(folder: Path, sources: Path, sets: Collection[str]) -> subprocess.CompletedProcess[str]:
    """Run the drivers against a build with sanitizers."""
    output = folder / native_compile.LIBRARY_NAME
    native_compile.compile_library(
        output,
        objects=folder / "objects",  # the second build compiles what differs alone
        sources=sources,
        sets=sets,
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
        [sys.executable, "-m", "tests.unit.native.hostile_input", *sets],
        env=environment,
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=1800,
        check=False,
    )


if __name__ == "__main__":
    raise SystemExit(main())
