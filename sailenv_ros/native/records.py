"""Kernels that take one structure: filled by name, its layout compared with the library's.

The fields of a kernel and their types come in, a function on arrays and numbers goes out. What the
library says of its structure (src/kernels/record.h) must agree in name, order, kind, place and size
of each field: a structure that differs in C++ and Python is an error at the first call.
"""

from __future__ import annotations

import ctypes
import itertools
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.native.library import NativeLibrary, native_library, raise_for_status

__all__ = ["Fields", "RecordKernel"]

FieldType = Literal["array", "integer", "number"]
Fields = tuple[FieldType, str]

_TYPES: dict[str, Any] = {
    "array": ctypes.c_void_p,
    "integer": ctypes.c_int64,
    "number": ctypes.c_double,
}
_KINDS = {"array": "p", "integer": "i", "number": "f"}


class _FieldLayout(ctypes.Structure):
    """`sailenv::FieldLayout` of record.h."""

    _fields_ = (
        ("name", ctypes.c_char_p),
        ("kind", ctypes.c_int64),
        ("offset", ctypes.c_int64),
        ("size", ctypes.c_int64),
    )


class RecordKernel:
    """One kernel whose arguments are a number of threads and a structure; calling it runs it.

    Parameters
    ----------
    name : str
        As in ``SAILENV_KERNEL(name)`` and ``SAILENV_RECORD(..., name, ...)``.
    *fields : tuple of str
        Of the structure, in its order: a type, and the names of the fields of it that follow each
        other, with spaces between. An 'array' is a pointer, an 'integer' an int64 number, a
        'number' a double.
    """

    def __init__(self, name: str, *fields: Fields) -> None:
        self.name = name
        self._fields = {field: kind for kind, names in fields for field in names.split()}
        self._structure: Any = type(
            f"{name}_record",
            (ctypes.Structure,),
            {"_fields_": [(field, _TYPES[kind]) for field, kind in self._fields.items()]},
        )
        self._functions: dict[int, Any] = {}

    def __call__(self, threads: int, **values: NDArray[Any] | float | None) -> None:
        """Run the kernel.

        Parameters
        ----------
        threads : int
        **values
            Every field of the structure. Check arrays with `library.checked` first: their memory
            is handed over as it is. None is a null pointer.

        Raises
        ------
        NativeLibraryError
            If there is no library, its structure is another one, or the kernel refuses what it was
            given.
        """
        if values.keys() != self._fields.keys():
            raise TypeError(f"{self.name} takes {', '.join(self._fields)}")
        library = native_library()
        function = self._functions.get(id(library))
        if function is None:
            function = self._functions[id(library)] = self._load(library)
        # The arrays stay alive until the call returns: `values` holds them.
        record = self._structure()
        for name, value in values.items():
            given = value.ctypes.data if isinstance(value, np.ndarray) else value
            setattr(record, name, given)
        raise_for_status(self.name, function(threads, ctypes.byref(record)))

    def layout(self) -> list[tuple[str, str, int, int]]:
        """Return name, kind, offset and size of each field; the last one is the size of all."""
        fields = [
            (name, _KINDS[kind], getattr(self._structure, name).offset, ctypes.sizeof(_TYPES[kind]))
            for name, kind in self._fields.items()
        ]
        return [*fields, ("", "", 0, ctypes.sizeof(self._structure))]

    def _load(self, library: NativeLibrary) -> Any:
        """Return the kernel's function, its structure compared."""
        told = library.symbol(f"{self.name}_layout")
        told.argtypes, told.restype = [], ctypes.POINTER(_FieldLayout)
        rows = told()
        found = []
        for number in itertools.count():
            row = rows[number]
            kind = chr(row.kind) if row.kind else ""
            found.append(((row.name or b"").decode(), kind, row.offset, row.size))
            if not row.name:
                break
        if found != self.layout():
            raise NativeLibraryError(
                f"{library.path} has {found} as arguments of {self.name}, not {self.layout()}"
            )
        function = library.symbol(self.name)
        function.argtypes = [ctypes.c_int64, ctypes.c_void_p]
        function.restype = ctypes.c_int32
        return function
