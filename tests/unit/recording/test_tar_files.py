"""Tar files of data sets: what `tarfile` writes and reads, to the byte."""

from __future__ import annotations

import io
import tarfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.dataset.formats.tar_files import WRITE_BACK_BYTES, TarWriter
from sailenv_ros.dataset.formats.view_files import encoded
from sailenv_ros.errors import RecordingError

NAMES = st.text("abcdefghij0123456789._-", min_size=1, max_size=90)


def by_tarfile(members: list[tuple[str, bytes]]) -> bytes:
    """Return the file as Python's own library writes it, without owner and time."""
    file = io.BytesIO()
    with tarfile.TarFile(fileobj=file, mode="w", format=tarfile.USTAR_FORMAT) as tar:
        for name, data in members:
            member = tarfile.TarInfo(name)
            member.size, member.mtime, member.mode = len(data), 0, 0o644
            tar.addfile(member, io.BytesIO(data))
    return file.getvalue()


@settings(max_examples=60, deadline=None)
@given(members=st.lists(st.tuples(NAMES, st.binary(max_size=2000)), max_size=8))
def test_a_file_has_the_bytes_that_tarfile_writes(members: list[tuple[str, bytes]]) -> None:
    file = io.BytesIO()
    writer = TarWriter(file, Path("set.tar"))
    for name, data in members:
        writer.append(name, [data[: len(data) // 2], np.frombuffer(data[len(data) // 2 :], "u1")])
    writer.finish()
    assert file.getvalue() == by_tarfile(members)


@pytest.mark.parametrize("dtype", [np.float32, np.float64, np.int32])
def test_real_numbers_are_the_npy_files_that_numpy_saves(dtype: type) -> None:
    values = np.arange(24).reshape(2, 3, 4).astype(dtype)[:, ::-1]
    saved = io.BytesIO()
    np.save(saved, np.ascontiguousarray(values), allow_pickle=False)
    ending, contents = encoded("depth", values)
    found = b"".join(one if isinstance(one, bytes) else one.tobytes() for one in contents)
    assert (ending, found) == ("npy", saved.getvalue())


def test_large_files_are_whole(tmp_path: Path) -> None:
    values = np.arange(WRITE_BACK_BYTES // 8 + 5)
    path = tmp_path / "large.tar"
    with path.open("wb") as file:
        writer = TarWriter(file, path)
        for number in range(2):
            writer.append(f"{number}.bin", [values])
        writer.finish()
    with tarfile.open(path) as tar:
        for name in ("0.bin", "1.bin"):
            member = tar.extractfile(name)
            assert member is not None
            assert np.array_equal(np.frombuffer(member.read(), values.dtype), values)


def test_a_full_disk_is_told_with_the_name_of_the_file() -> None:
    refused = pytest.raises(RecordingError, match=r"set\.tar cannot be written: No space left")
    with Path("/dev/full").open("wb", buffering=0) as file, refused:
        TarWriter(file, Path("set.tar")).append("a", [b"1"])
