"""Compiles the native library; needs nothing but Python and a C++ compiler.

The sources beside this file come in, one shared library goes out. Whatever lies in `src/kernels/`
is compiled once for each instruction set, the rest once; the loader (`library.py`) takes the
functions of the best set that the processor has. setup.py runs this file by its path, before
anything is installed, and so does scripts/build-native: it imports nothing of the project.

    python sailenv_ros/native/compile.py [--if-changed] [--own] [--output FILE]
"""

from __future__ import annotations

import argparse
import ctypes
import hashlib
import os
import platform
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Collection, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

__all__ = [
    "INSTRUCTION_SETS",
    "LIBRARY_NAME",
    "SOURCES",
    "CompilerError",
    "compile_library",
    "fits_sources",
    "has_sources",
    "source_hash",
]

SOURCES = Path(__file__).resolve().parent / "src"
LIBRARY_NAME = "libsailenv_native.so"

INSTRUCTION_SETS: dict[str, dict[str, tuple[str, ...]]] = {
    "x86_64": {
        "portable": (),
        "avx2": ("-march=x86-64-v3",),
        "avx512": ("-march=x86-64-v4", "-mprefer-vector-width=512"),
    }
}
"""Flags of each instruction set, by machine, from the one that every processor has to the best.

Other machines have ``portable`` alone. The order is that of the levels in abi.cpp.
"""

FLAGS = (
    "-std=c++17",
    "-O3",
    "-fPIC",
    "-pthread",
    "-fvisibility=hidden",
    # No fused multiply-add that the source does not ask for: the bytes of a frame are the same on
    # every instruction set. For the same reason there is no -ffast-math.
    "-ffp-contract=off",
    # Neither changes a result: nobody reads errno or the floating-point flags.
    "-fno-math-errno",
    "-fno-trapping-math",
    "-Wall",
    "-Wextra",
    "-Wshadow",
    "-Wvla",
    # Vectors are passed by value only to functions that are inlined.
    "-Wno-psabi",
)

STRICT_VARIABLE = "SAILENV_NATIVE_STRICT"
"""Where this environment variable is set, warnings are errors."""


class CompilerError(RuntimeError):
    """The library could not be compiled; the text says what failed."""


def compile_library(
    output: Path,
    *,
    objects: Path | None = None,
    sources: Path = SOURCES,
    sets: Collection[str] | None = None,
    extra_flags: Sequence[str] = (),
    strict: bool = False,
) -> None:
    """Compile all sources into one shared library.

    Parameters
    ----------
    output : Path
        The library. It is replaced when all else has succeeded, so that it is never half written.
    objects : Path or None
        Folder in which object files are kept for the next time; None keeps none.
    sources : Path
        Folder with ``*.cpp`` and ``kernels/*.cpp``.
    sets : collection of str or None
        Instruction sets to compile; None compiles all that this machine's processors may have.
    extra_flags : sequence of str
        For the compiler and the linker, after all others.
    strict : bool
        Treat warnings as errors.

    Raises
    ------
    CompilerError
        If there is no compiler, or it refuses a source.
    """
    compiler = find_compiler()
    flags = (*FLAGS, *(("-Werror",) if strict else ()), *extra_flags)
    output.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="sailenv-native-") as name:
        folder = Path(name)
        kept = objects or folder
        kept.mkdir(parents=True, exist_ok=True)
        jobs: list[tuple[str, Path, tuple[str, ...]]] = []
        flags_of = {
            name: own
            for name, own in instruction_sets(compiler).items()
            if sets is None or name in sets
        }
        for path in sorted(sources.glob("*.cpp")):
            define = (f'-DSAILENV_SOURCE_HASH="{source_hash(sources)}"',)
            jobs.append(("", path, (*flags, *(define if path.stem == "abi" else ()))))
        for isa, isa_flags in flags_of.items():
            for path in sorted((sources / "kernels").glob("*.cpp")):
                jobs.append((isa, path, (*flags, *isa_flags, f"-DSAILENV_ISA={isa}")))
        headers = _hash_of(sorted(sources.rglob("*.h")))
        with ThreadPoolExecutor(max(1, len(os.sched_getaffinity(0)))) as pool:
            made = list(
                pool.map(lambda job: _compile(compiler, job[1], job[2], headers, kept), jobs)
            )
        linked = [path for (isa, _, _), path in zip(jobs, made, strict=True) if not isa]
        for isa in flags_of:
            of_set = [path for job, path in zip(jobs, made, strict=True) if job[0] == isa]
            if of_set:
                linked.append(_closed(compiler, isa, of_set, folder))
        library = folder / LIBRARY_NAME
        exports = folder / "exports.map"
        exports.write_text("{ global: sailenv_*; local: *; };\n")
        sanitized = [flag for flag in extra_flags if flag.startswith("-fsanitize")]
        script = f"-Wl,--version-script={exports}"
        _run(
            [*compiler, "-shared", "-pthread", *sanitized, script, "-o", library, *linked, "-lm"],
            "the linker",
        )
        # Beside its place first: a rename within a folder is one step.
        beside = output.with_name(f".{output.name}.{os.getpid()}")
        shutil.copy2(library, beside)
        beside.replace(output)


def find_compiler() -> list[str]:
    """Find the C++ compiler: the environment's ``CXX``, else g++, c++ or clang++.

    Raises
    ------
    CompilerError
        If there is none.
    """
    asked = shlex.split(os.environ.get("CXX", ""))
    for words in [asked] if asked else [["g++"], ["c++"], ["clang++"]]:
        if shutil.which(words[0]):
            return words
    raise CompilerError(
        f"there is no C++ compiler ({asked[0]})"
        if asked
        else "there is no C++ compiler (g++, c++, clang++)"
    )


def instruction_sets(compiler: Sequence[str]) -> dict[str, tuple[str, ...]]:
    """Return the flags of each instruction set that is compiled for the compiler's machine.

    That may be another than this one: ``CXX=aarch64-linux-gnu-g++`` compiles for ARM.
    """
    return _sets_of(_told(compiler, "-dumpmachine").partition("-")[0])


def own_instruction_set(library: Path) -> str:
    """Return the best instruction set of this processor.

    Parameters
    ----------
    library : Path
        Tells it, where it was made of the present sources; else abi.cpp is compiled to tell it.

    Raises
    ------
    CompilerError
        If there is no compiler, or it compiles for another machine.
    """
    with tempfile.TemporaryDirectory(prefix="sailenv-native-") as name:
        teller = library
        if compiled_hash(library) != source_hash():
            teller = Path(name) / LIBRARY_NAME
            flags = (*FLAGS, '-DSAILENV_SOURCE_HASH=""', "-shared")
            _run([*find_compiler(), *flags, SOURCES / "abi.cpp", "-o", teller], "the compiler")
        try:
            level = int(ctypes.CDLL(str(teller)).sailenv_instruction_set_level())
        except OSError as problem:
            raise CompilerError(f"the compiler is not for this machine: {problem}") from problem
    return list(_sets_of(platform.machine()))[level]


def has_sources() -> bool:
    """Return whether the sources lie here: an installed package has the library alone."""
    return (SOURCES / "abi.cpp").is_file()


def source_hash(sources: Path = SOURCES) -> str:
    """Return a hash of all sources: a library knows those that it was made of."""
    return _hash_of(sorted(path for path in sources.rglob("*") if path.suffix in (".cpp", ".h")))


def compiled_hash(library: Path) -> str:
    """Return the hash of the sources that a library was made of; "" if it tells none."""
    try:
        found = re.search(rb"sailenv-native-sources:([0-9a-f]{32})", library.read_bytes())
    except OSError:
        return ""
    return found[1].decode() if found else ""


def fits_sources(library: Path, sets: Collection[str] | None = None) -> bool:
    """Return whether a library was made of the present sources and has these instruction sets.

    Parameters
    ----------
    library : Path
        It need not exist.
    sets : collection of str or None
        None asks for all that processors of this machine's kind may have.
    """
    if compiled_hash(library) != source_hash():
        return False
    had = re.findall(rb"\0sailenv_self_test_(\w+)\0", library.read_bytes())
    wanted = _sets_of(platform.machine()) if sets is None else sets
    return {name.encode() for name in wanted} <= set(had)


def _sets_of(machine: str) -> dict[str, tuple[str, ...]]:
    return INSTRUCTION_SETS.get(machine, {"portable": ()})


def _told(compiler: Sequence[str], option: str) -> str:
    """Return the line that the compiler prints."""
    return _run([*compiler, option], "the compiler").strip()


def _closed(compiler: Sequence[str], isa: str, objects: Sequence[Path], folder: Path) -> Path:
    """Join the objects of one instruction set and hide all their functions but the kernels.

    The linker keeps one copy of each inline function of the standard library. Without this the
    copy with AVX-512 instructions could be the one that a processor without them runs.
    """
    joined, closed = folder / f"{isa}.joined.o", folder / f"{isa}.o"
    ld, objcopy = (_told(compiler, f"-print-prog-name={name}") for name in ("ld", "objcopy"))
    _run([ld, "-r", "--force-group-allocation", "-o", joined, *objects], "the linker")
    keep = f"--keep-global-symbol=sailenv_*_{isa}"
    _run([objcopy, "--wildcard", keep, joined, closed], "objcopy")
    return closed


def _compile(
    compiler: Sequence[str], source: Path, flags: Sequence[str], headers: str, folder: Path
) -> Path:
    """Compile one source, unless the folder has its object already."""
    key = hashlib.sha256()
    for text in (" ".join([*compiler, *flags]), headers, source.name):
        key.update(text.encode() + b"\0")
    key.update(source.read_bytes())
    target = folder / f"{source.stem}-{key.hexdigest()[:24]}.o"
    if target.exists():
        return target
    beside = target.with_suffix(f".{os.getpid()}.o")
    _run([*compiler, *flags, "-c", source, "-o", beside], f"the compiler, for {source.name},")
    beside.replace(target)
    return target


def _run(command: Iterable[str | Path], what: str) -> str:
    """Run a program and return what it printed."""
    words = [str(word) for word in command]
    try:
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    except OSError as problem:
        raise CompilerError(f"{what} could not be started: {problem}") from problem
    if done.returncode != 0:
        raise CompilerError(f"{what} failed: {shlex.join(words)}\n{done.stdout}")
    return done.stdout


def _hash_of(paths: Iterable[Path]) -> str:
    digest = hashlib.sha256()
    for path in paths:
        digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:32]


def main() -> int:
    """Compile the library in its place beside the sources."""
    parser = argparse.ArgumentParser(description="compile the native library in its place")
    parser.add_argument(
        "--if-changed", action="store_true", help="do nothing where it fits the sources"
    )
    parser.add_argument(
        "--own", action="store_true", help="for this machine's processor alone: a third of the time"
    )
    parser.add_argument(
        "--output", type=Path, default=SOURCES.parent / LIBRARY_NAME, help="beside the sources"
    )
    arguments = parser.parse_args()
    output = arguments.output
    objects = SOURCES.parents[2] / "build" / "native"
    try:
        sets = {own_instruction_set(output)} if arguments.own else None
        if not (arguments.if_changed and fits_sources(output, sets)):
            compile_library(output, objects=objects, sets=sets, strict=True)
    except CompilerError as problem:
        sys.stderr.write(f"the native library was not compiled: {problem}\n")
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
