"""Mapped files: the bytes, also after their pages were given back and the name is another's."""

from __future__ import annotations

import gc
import os
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.system.mapped_file import give_back_pages, mapped_file


def test_bytes_stay_when_pages_go_and_the_name_gets_another_file(tmp_path: Path) -> None:
    """Nor does an array of it keep a descriptor."""
    path, other = tmp_path / "some.arrays", tmp_path / "other"
    values = np.random.default_rng(0).integers(0, 256, 300_000, np.uint8)
    path.write_bytes(values.tobytes())
    other.write_bytes(b"other")
    open_before = len(os.listdir("/proc/self/fd"))
    part = mapped_file(path)[5:].view(np.uint8)
    gc.collect()
    os.replace(other, path)
    give_back_pages()
    np.testing.assert_array_equal(part, values[5:])
    assert len(os.listdir("/proc/self/fd")) == open_before
    with pytest.raises(ValueError, match="read-only"):
        part[0] = 1


def test_pages_that_were_given_back_take_no_memory(tmp_path: Path) -> None:
    path = tmp_path / "large.arrays"
    path.write_bytes(bytes(64 << 20))
    array = mapped_file(path)
    assert not array.any()
    full = _resident_bytes()
    give_back_pages()
    assert full - _resident_bytes() > 60 << 20


def test_mappings_end_with_their_arrays(tmp_path: Path) -> None:
    path = tmp_path / "named.arrays"
    path.write_bytes(bytes(5000))
    array = mapped_file(path)
    assert str(path) in Path("/proc/self/maps").read_text()
    del array
    gc.collect()
    assert str(path) not in Path("/proc/self/maps").read_text()


def test_empty_and_missing_files(tmp_path: Path) -> None:
    (tmp_path / "empty").touch()
    assert mapped_file(tmp_path / "empty").shape == (0,)
    with pytest.raises(FileNotFoundError):
        mapped_file(tmp_path / "none")
    with pytest.raises(IsADirectoryError):
        mapped_file(tmp_path)


def _resident_bytes() -> int:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")
