"""The native library is found, checked and loaded; its threads do every row once."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, NativeLibraryError, UnknownName
from sailenv_ros.native import compile as native_compile
from sailenv_ros.native import library
from sailenv_ros.native.library import NativeLibrary, checked, load_library
from sailenv_ros.native.self_test import run_self_test

END_TIMEOUT_S = 60.0


@pytest.mark.parametrize("threads", [1, 2, 3, 16])
@pytest.mark.parametrize(("rows", "tile_rows"), [(0, 4), (1, 4), (7, 1), (481, 16), (5000, 1)])
def test_each_row_is_worked_on_once(threads: int, rows: int, tile_rows: int) -> None:
    """By one of the threads that were asked for, whatever the sizes of the tiles."""
    counts, slots = run_self_test(rows, tile_rows=tile_rows, threads=threads)
    assert (counts == 1).all()
    assert ((slots >= 0) & (slots < threads)).all()


def test_many_callers_share_the_threads() -> None:
    """Calls from several threads at once do not disturb each other."""
    with ThreadPoolExecutor(8) as pool:
        calls = [pool.submit(run_self_test, 300, tile_rows=2, threads=4) for _ in range(400)]
        assert all((call.result()[0] == 1).all() for call in calls)


def test_a_forked_child_makes_its_own_threads() -> None:
    """A child works and ends although the parent's threads are not its own."""
    code = """
import os, sys
from sailenv_ros.native.self_test import run_self_test
assert (run_self_test(500, tile_rows=1, threads=3)[0] == 1).all()
child = os.fork()
ok = (run_self_test(500, tile_rows=1, threads=3)[0] == 1).all()
if child == 0:
    os._exit(0 if ok else 3)
_, status = os.waitpid(child, 0)
sys.exit(os.waitstatus_to_exitcode(status) if ok else 4)
"""
    done = subprocess.run([sys.executable, "-c", code], timeout=END_TIMEOUT_S, check=False)
    assert done.returncode == 0


def test_kernels_refuse_what_they_cannot_do() -> None:
    """A kernel's status becomes an error with a sentence."""
    with pytest.raises(NativeLibraryError, match="self_test refused its arguments"):
        run_self_test(-1, tile_rows=4, threads=1)


def test_every_instruction_set_can_be_chosen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The best one is taken unless the environment names another."""
    found = load_library(None)
    assert found.instruction_sets[0] == "portable"
    path = found.path
    for name in found.instruction_sets:
        monkeypatch.setenv(library.INSTRUCTION_SET_VARIABLE, name)
        assert NativeLibrary(path).instruction_set == name
        with library.using_instruction_set(name):
            assert library.native_library().instruction_set == name
            assert (run_self_test(9, tile_rows=2, threads=2)[0] == 1).all()
    monkeypatch.setenv(library.INSTRUCTION_SET_VARIABLE, "mmx")
    with pytest.raises(UnknownName, match="portable"):
        NativeLibrary(path)
    monkeypatch.delenv(library.INSTRUCTION_SET_VARIABLE)
    assert NativeLibrary(path).instruction_set == found.instruction_sets[-1]


def test_a_library_that_does_not_fit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Missing, no library at all, of another version, of other sources: each in words."""
    # An installed package has no sources, so these are the repository's.
    sources = Path(__file__).parents[3] / "sailenv_ros" / "native" / "src"
    hash_of_sources = native_compile.source_hash(sources)
    monkeypatch.setattr(native_compile, "SOURCES", sources)
    monkeypatch.setattr(native_compile, "source_hash", lambda: hash_of_sources)
    missing = tmp_path / "missing.so"
    with pytest.raises(NativeLibraryError, match=r"there is no .*missing\.so; scripts"):
        NativeLibrary(missing)
    broken = tmp_path / "broken.so"
    broken.write_bytes(b"no library")
    with pytest.raises(NativeLibraryError, match="made of other sources"):
        NativeLibrary(broken)
    broken.write_text(f"sailenv-native-sources:{native_compile.source_hash()}")
    with pytest.raises(NativeLibraryError, match=r"broken\.so"):
        NativeLibrary(broken)
    monkeypatch.setattr(library, "ABI_VERSION", library.ABI_VERSION + 1)
    with pytest.raises(NativeLibraryError, match="of version"):
        NativeLibrary(load_library(None).path)


def test_a_library_may_have_one_instruction_set(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Made for one processor it works there, is known as incomplete, and is refused elsewhere."""
    everything = Path(__file__).parents[3] / "sailenv_ros" / "native" / "src"
    sources = tmp_path / "src"
    (sources / "kernels").mkdir(parents=True)
    for path in [*everything.glob("*.*"), everything / "kernels" / "self_test.cpp"]:
        shutil.copy(path, sources / path.relative_to(everything))
    best = load_library(None).instruction_sets[-1]
    monkeypatch.setattr(native_compile, "SOURCES", sources)
    hash_of_sources = native_compile.source_hash(sources)
    monkeypatch.setattr(native_compile, "source_hash", lambda _=sources: hash_of_sources)
    output = tmp_path / "library.so"
    assert not native_compile.fits_sources(output)
    own = native_compile.own_instruction_set(output)
    assert own == best
    native_compile.compile_library(output, sources=sources, sets={own})
    assert native_compile.own_instruction_set(output) == own
    assert native_compile.fits_sources(output, {own})
    assert native_compile.fits_sources(output) == (own == "portable")
    assert NativeLibrary(output).instruction_sets == (own,)
    native_compile.compile_library(output, sources=sources)
    assert native_compile.fits_sources(output)
    monkeypatch.setattr(library, "INSTRUCTION_SETS", ())
    with pytest.raises(NativeLibraryError, match="processors with other instructions"):
        NativeLibrary(output)


def test_arrays_are_checked_before_their_memory_is_used() -> None:
    """Type, shape and gaps."""
    array = np.zeros((4, 6), np.float32)
    assert checked("depth", array, np.float32, (4, None)) is array
    for wrong in (array.astype(np.float64), array[:, ::2], array[0], array.T):
        with pytest.raises(InvalidRequest, match=r"depth must be a dense float32 array"):
            checked("depth", wrong, np.float32, (4, 6))


def test_a_compiler_that_fails_leaves_the_library_as_it_was(tmp_path: Path) -> None:
    """The error shows what the compiler said."""
    sources = tmp_path / "src"
    (sources / "kernels").mkdir(parents=True)
    (sources / "abi.cpp").write_text("int main( { }")
    output = tmp_path / "library.so"
    output.write_text("as it was")
    with pytest.raises(native_compile.CompilerError, match=r"abi\.cpp"):
        native_compile.compile_library(output, sources=sources)
    assert output.read_text() == "as it was"


def test_without_a_compiler_the_error_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Which one was looked for stands in the sentence."""
    monkeypatch.setenv("CXX", "there-is-no-such-compiler")
    with pytest.raises(native_compile.CompilerError, match="there-is-no-such-compiler"):
        native_compile.compile_library(tmp_path / "library.so")


def test_without_a_library_the_error_names_the_remedy(tmp_path: Path) -> None:
    """One sentence, from whatever is asked first; importing alone asks for nothing."""
    code = """
import numpy as np
from sailenv_ros.render.selection import make_backend
from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.frame.truth.visible_parts import visible_parts
for ask in (
    lambda: make_backend("native", None),
    lambda: visible_parts(np.zeros((9, 9), np.uint16)),
):
    try:
        ask()
    except NativeLibraryError as problem:
        print(problem)
"""
    missing = tmp_path / "missing.so"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, library.LIBRARY_VARIABLE: str(missing)},
        timeout=END_TIMEOUT_S,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    said = f"the native library cannot be used: there is no {missing}; scripts/build-native makes"
    assert [line[: len(said)] for line in done.stdout.splitlines()] == [said] * 2
