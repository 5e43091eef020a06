"""The native library: found, checked, loaded, and its kernels called with arrays.

With `records` the only module that knows ctypes. A kernel's name and the types of its arguments
come in, a function on arrays and numbers goes out. ctypes releases Python's lock while a kernel
runs.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import os
import threading
from collections.abc import Iterator
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

from sailenv_ros.errors import InvalidRequest, NativeLibraryError, UnknownName
from sailenv_ros.native import compile as native_compile

__all__ = [
    "ABI_VERSION",
    "INSTRUCTION_SETS",
    "Kernel",
    "NativeLibrary",
    "checked",
    "load_library",
    "native_library",
    "raise_for_status",
    "using_instruction_set",
]

ABI_VERSION = 5
"""`SAILENV_ABI_VERSION` of src/abi.h."""

INSTRUCTION_SETS = tuple(native_compile.INSTRUCTION_SETS["x86_64"])
"""Instruction sets, from the one that every processor has to the best."""

LIBRARY_VARIABLE = "SAILENV_NATIVE_LIBRARY"
"""Path of another build of the same sources, e.g. one with sanitizers."""

INSTRUCTION_SET_VARIABLE = "SAILENV_INSTRUCTION_SET"

_TYPES: dict[str, Any] = {"a": ctypes.c_void_p, "i": ctypes.c_int64, "n": ctypes.c_double}
_STATUS = {1: "refused its arguments"}
_NO_MEMORY = 2


class NativeLibrary:
    """The loaded library and the instruction set that is used of it.

    Parameters
    ----------
    path : Path
        The shared library.
    instruction_set : str or None
        One of `INSTRUCTION_SETS`; None takes the environment's ``SAILENV_INSTRUCTION_SET``, else
        the best that both the processor and the library have.

    Raises
    ------
    NativeLibraryError
        If the library is missing, cannot be loaded, or was made of other sources than the code's.
    UnknownName
        If there is no such instruction set here.
    """

    def __init__(self, path: Path, instruction_set: str | None = None) -> None:
        self.path = path
        if not path.is_file():
            raise NativeLibraryError(f"there is no {path}")
        # An installed package has no sources, but for the headers that shaders include.
        if native_compile.has_sources():
            made_of = native_compile.compiled_hash(path)
            if made_of != native_compile.source_hash():
                raise NativeLibraryError(f"{path} was made of other sources")
        try:
            self._library = ctypes.CDLL(str(path))
            version = int(self._library.sailenv_abi_version())
            level = int(self._library.sailenv_instruction_set_level())
        except (OSError, AttributeError) as problem:
            raise NativeLibraryError(str(problem)) from problem
        if version != ABI_VERSION:
            raise NativeLibraryError(f"{path} is of version {version}, not {ABI_VERSION}")
        self.instruction_sets: tuple[str, ...] = tuple(
            name
            for name in INSTRUCTION_SETS[: level + 1]
            if hasattr(self._library, f"sailenv_self_test_{name}")
        )
        """Instruction sets that both the processor and the library have, the best one last."""
        if not self.instruction_sets:
            raise NativeLibraryError(f"{path} was made for processors with other instructions")
        asked = instruction_set or os.environ.get(INSTRUCTION_SET_VARIABLE)
        if asked and asked not in self.instruction_sets:
            raise UnknownName("instruction set of this machine", asked, self.instruction_sets)
        self.instruction_set: str = asked or self.instruction_sets[-1]

    @cached_property
    def digest(self) -> str:
        """Distinguishes libraries, and instruction sets of them, that may round differently."""
        code = hashlib.sha256(self.path.read_bytes()).hexdigest()
        return f"{self.instruction_set} {code}"

    def symbol(self, name: str) -> Any:
        """Return an exported function of the instruction set, its types not declared yet."""
        return getattr(self._library, f"sailenv_{name}_{self.instruction_set}")

    def function(self, name: str, types: str) -> Any:
        """Return the ctypes function of a kernel."""
        function = self.symbol(name)
        function.argtypes = [_TYPES[kind] for kind in types]
        function.restype = ctypes.c_int32
        return function


@lru_cache(maxsize=8)
def load_library(instruction_set: str | None = None) -> NativeLibrary:
    """Load the library that lies beside this module; see `NativeLibrary`."""
    own = Path(__file__).resolve().parent / native_compile.LIBRARY_NAME
    path = Path(os.environ.get(LIBRARY_VARIABLE) or own)
    return NativeLibrary(path, instruction_set)


_chosen = threading.local()


def native_library() -> NativeLibrary:
    """Return the library that kernels are called from; see `NativeLibrary` for errors."""
    return load_library(getattr(_chosen, "instruction_set", None))


@contextlib.contextmanager
def using_instruction_set(name: str) -> Iterator[None]:
    """Let this thread use another instruction set for a while: what tests compare."""
    before = getattr(_chosen, "instruction_set", None)
    load_library(name)
    _chosen.instruction_set = name
    try:
        yield
    finally:
        _chosen.instruction_set = before


class Kernel:
    """One kernel of the library; calling it runs it.

    Parameters
    ----------
    name : str
        As in ``SAILENV_KERNEL(name)``.
    types : str
        A letter for each argument: ``a`` an array (or None, where the kernel accepts a null
        pointer), ``i`` an int64 number, ``n`` a double. Check arrays with `checked` first: their
        memory is handed over as it is.

    Raises
    ------
    NativeLibraryError
        When it is called: if there is no library, or the kernel refuses what it was given.
    """

    def __init__(self, name: str, types: str) -> None:
        self.name = name
        self._types = types
        self._arrays = tuple(number for number, kind in enumerate(types) if kind == "a")
        self._functions: dict[int, Any] = {}

    def __call__(self, *arguments: NDArray[Any] | float | None) -> None:
        """Run the kernel."""
        library = native_library()
        function = self._functions.get(id(library))
        if function is None:
            function = library.function(self.name, self._types)
            self._functions[id(library)] = function
        # The arrays stay alive until the call returns: the caller's frame holds them.
        words: list[Any] = list(arguments)
        for number in self._arrays:
            array = words[number]
            words[number] = None if array is None else array.ctypes.data
        raise_for_status(self.name, function(*words))


def raise_for_status(kernel: str, status: int) -> None:
    """Raise for what a kernel returned, unless all is well.

    Raises
    ------
    MemoryError
        If it found none.
    NativeLibraryError
    """
    if status == _NO_MEMORY:
        raise MemoryError(f"the kernel {kernel} found no memory")
    if status:
        raise NativeLibraryError(
            f"the kernel {kernel} {_STATUS.get(status, f'failed with status {status}')}"
        )


def checked(
    what: str, array: NDArray[Any], dtype: DTypeLike, shape: tuple[int | None, ...]
) -> NDArray[Any]:
    """Refuse an array that a kernel could not read or write as it lies in memory.

    Parameters
    ----------
    what : str
        Its name in the error.
    array : array
        In C order, without gaps.
    dtype : dtype
    shape : tuple of int or None
        None accepts any size.

    Raises
    ------
    InvalidRequest
        If type or shape are others, or the array has gaps.
    """
    expected = np.dtype(dtype)
    fits = array.ndim == len(shape) and all(
        size is None or size == given for size, given in zip(shape, array.shape, strict=True)
    )
    if not fits or array.dtype != expected or not array.flags.c_contiguous:
        sizes = ", ".join("any" if size is None else str(size) for size in shape)
        raise InvalidRequest(
            what,
            f"{array.dtype} {array.shape}, strides {array.strides}",
            f"a dense {expected} array of shape ({sizes})",
        )
    return array
