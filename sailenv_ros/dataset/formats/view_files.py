"""Views as files of a data set and back: exactly, or as a recipe's compression says."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import numpy as np
import zstandard
from numpy.typing import NDArray

from sailenv_ros.dataset.formats.images import scaled_depth
from sailenv_ros.dataset.formats.tar_files import Content
from sailenv_ros.frame.pictures.codecs import decode_picture, encode_png
from sailenv_ros.types.picture_settings import MAX_SIZE_PX
from sailenv_ros.types.views import VIEWS, view_spec

__all__ = [
    "COMPRESSIONS",
    "ENDINGS",
    "Compression",
    "as_kept",
    "compression_fault",
    "decoded",
    "encoded",
]

Compression: TypeAlias = Literal["zstd", "npz", "float16", "float16_zstd", "png16"]

COMPRESSIONS: Mapping[Compression, str] = MappingProxyType(
    {
        "zstd": "exact: .npy, compressed by Zstandard (.npy.zst)",
        "npz": "exact: NumPy's compressed .npz, smaller and slower",
        "float16": "lossy: real numbers of 16 bits, 3 digits up to 65504, beyond inf (.npy)",
        "float16_zstd": "lossy: float16, compressed by Zstandard (.npy.zst)",
        "png16": "lossy, depth alone: whole millimetres up to 65.535 m (.png), beyond inf",
    }
)
"""Ways to write a view, and what each keeps."""

ENDINGS = ("png", "npy", "npy.zst", "npz")

ZSTD_LEVEL = 1

_HEAD_BYTES = 1024
"""More than the head of an array file takes."""

_EPOCH = (1980, 1, 1, 0, 0, 0)


def compression_fault(view: str, kind: str) -> str:
    """Return why a view cannot be compressed in a way; empty if it can."""
    spec = VIEWS[view]
    if kind == "png16" and spec.png_per_unit is None:
        able = ", ".join(name for name, one in VIEWS.items() if one.png_per_unit is not None)
        return f"{view} cannot be {kind}, which takes {able} alone"
    if kind.startswith("float16") and not np.issubdtype(spec.dtype, np.floating):
        return f"{view} cannot be {kind}, which takes views of real numbers alone"
    return ""


def encoded(
    view: str, values: NDArray[Any], kind: Compression | None = None
) -> tuple[str, Sequence[Content]]:
    """Return the ending and the content of the file of a view.

    Parameters
    ----------
    view : str
    values : array
    kind : str or None
        One of `COMPRESSIONS`; None keeps values exactly, pictures and labels as PNG, real numbers
        as .npy without compression.
    """
    if kind == "png16":
        per_unit = view_spec(view).png_per_unit
        assert per_unit is not None
        return "png", [encode_png(scaled_depth(values, per_unit), "fastest")]
    if kind is None and values.dtype in (np.bool_, np.uint8, np.uint16):
        return "png", [encode_png(values, "fastest")]
    if kind == "npz":
        return "npz", [_npz(view, values)]
    if kind in ("float16", "float16_zstd"):
        with np.errstate(over="ignore"):
            values = values.astype(np.float16)
    values = np.ascontiguousarray(values)
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, np.lib.format.header_data_from_array_1_0(values))
    if kind in ("zstd", "float16_zstd"):
        # One frame that tells its size, in one thread: equal arrays are equal bytes.
        data = header.getvalue() + values.tobytes()
        return "npy.zst", [zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress(data)]
    return "npy", [header.getvalue(), values]


def decoded(view: str, ending: str, data: bytes | memoryview) -> NDArray[Any]:
    """Return the view that `encoded` wrote, in the type that frames have.

    Arrays that are not compressed stay in the memory of `data`.

    Raises
    ------
    ValueError, OSError, KeyError
        If it is something else.
    """
    values: NDArray[Any]
    if ending == "png":
        values = _from_png(view, data)
    elif ending == "npy":
        values = _from_npy(view, data)
    elif ending == "npy.zst":
        try:
            _require_bounded(view, zstandard.frame_content_size(data))
            unpacking = zstandard.ZstdDecompressor()
            values = _from_npy(view, unpacking.decompress(data, max_output_size=_most_bytes(view)))
        except zstandard.ZstdError as problem:
            raise ValueError(f"the view {view} is no whole Zstandard file: {problem}") from None
    else:
        with np.load(io.BytesIO(data), allow_pickle=False) as file:
            _require_bounded(view, file.zip.getinfo(f"{view}.npy").file_size)
            values = file[view]
    if values.dtype == np.float16:
        return values.astype(VIEWS[view].dtype)
    return values


def as_kept(view: str, values: NDArray[Any], kind: Compression | None) -> NDArray[Any]:
    """Return a view as a file of it would be read again."""
    if kind in (None, "zstd", "npz"):
        return values
    ending, contents = encoded(view, values, "float16" if kind == "float16_zstd" else kind)
    return decoded(view, ending, b"".join(bytes(one) for one in contents))


def _most_bytes(view: str) -> int:
    """Return how many bytes an array file of a view has at most, as large as cameras can be."""
    spec = VIEWS[view]
    return math.prod(spec.shape(MAX_SIZE_PX, MAX_SIZE_PX)) * spec.dtype.itemsize + _HEAD_BYTES


def _require_bounded(view: str, size: int) -> None:
    """Refuse what would unpack to more than any picture is, before it takes memory."""
    if size > _most_bytes(view):
        raise ValueError(f"the view {view} unpacks to {size} bytes, more than any picture has")


def _npz(view: str, values: NDArray[Any]) -> bytes:
    """Return what `numpy.savez_compressed` writes, without the present time."""
    import zipfile

    array, file = io.BytesIO(), io.BytesIO()
    np.lib.format.write_array(array, np.ascontiguousarray(values), (1, 0), allow_pickle=False)
    with zipfile.ZipFile(file, "w") as archive:
        entry = zipfile.ZipInfo(f"{view}.npy", _EPOCH)
        archive.writestr(entry, array.getvalue(), zipfile.ZIP_DEFLATED, 6)
    return file.getvalue()


def _from_png(view: str, data: bytes | memoryview) -> NDArray[Any]:
    picture, spec = decode_picture(data), VIEWS[view]
    if spec.png_per_unit is not None:
        # 0 stands for what was not hit, or does not fit.
        distance = picture.astype(spec.dtype) / spec.dtype.type(spec.png_per_unit)
        return np.asarray(np.where(picture == 0, spec.dtype.type(np.inf), distance))
    if spec.dtype == np.bool_:
        return np.asarray(picture > 0)
    return picture


def _from_npy(view: str, data: bytes | memoryview) -> NDArray[Any]:
    # np.load copies piece by piece, which takes as long as all the rest for a small picture.
    begin = 10 + int.from_bytes(data[8:10], "little")
    head = _array_head(bytes(data[:begin]))
    if head is None:
        raise ValueError(f"the view {view} is not an array of version 1.0")
    shape, in_columns, dtype = head
    values = np.frombuffer(data, dtype, offset=begin)
    return values.reshape(shape, order="F" if in_columns else "C")


@lru_cache(maxsize=64)
def _array_head(head: bytes) -> tuple[tuple[int, ...], bool, np.dtype[Any]] | None:
    """Return shape, order and type of an array; most files of a view begin with the same bytes."""
    file = io.BytesIO(head)
    if np.lib.format.read_magic(file) != (1, 0):
        return None
    shape, in_columns, dtype = np.lib.format.read_array_header_1_0(file)
    return shape, in_columns, dtype
