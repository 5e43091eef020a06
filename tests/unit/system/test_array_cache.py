"""Arrays that are kept on disk: what is read is what was made, or it is made anew."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of
from numpy.typing import NDArray

from sailenv_ros.errors import AssetError
from sailenv_ros.system import array_cache
from sailenv_ros.system.array_cache import Arrays, array_folder, cached_arrays, damaged_arrays
from sailenv_ros.system.files import file_lock

DTYPES = st.sampled_from(["u1", "<i4", "<u4", "<f2", "<f4", "<f8", "?"])
SHAPES = arrays_of.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5)
ARRAYS = DTYPES.flatmap(lambda dtype: arrays_of.arrays(dtype, SHAPES))


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))


class Maker:
    """Makes the same arrays each time, and counts how often."""

    def __init__(self, **arrays: NDArray[np.generic]) -> None:
        self.arrays, self.calls = arrays, 0

    def __call__(self) -> Arrays:
        self.calls += 1
        return self.arrays


def only_file() -> Path:
    (path,) = array_folder().glob("*.arrays")
    return path


@given(st.dictionaries(st.text(max_size=20), ARRAYS, max_size=4), st.integers())
@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_read_equals_what_was_made(
    arrays: dict[str, NDArray[np.generic]], key: int
) -> None:
    """Names, types, shapes and bytes, of any strides; NaN too."""
    made = {name: array.T for name, array in arrays.items()}
    told = [key, {n: (a.dtype.str, a.shape, a.tobytes()) for n, a in made.items()}]
    for _ in range(2):
        kept = cached_arrays("any", told, lambda: made)
        assert list(kept) == list(made)
        for name, array in made.items():
            assert (kept[name].dtype, kept[name].shape) == (array.dtype, array.shape)
            assert kept[name].tobytes() == array.tobytes()
    assert not any(array.flags.writeable for array in kept.values())


def test_arrays_are_made_once_for_each_key() -> None:
    make = Maker(a=np.arange(3))
    for key, code in (([1, "x"], ""), ([1, "y"], ""), ([1, "x"], "other code"), ([1, "x"], "")):
        cached_arrays("kind", key, make, code=code)
    assert make.calls == 3
    cached_arrays("other kind", [1, "x"], make)
    assert make.calls == 4


def test_arrays_that_were_just_made_are_mapped_like_those_that_are_read() -> None:
    """Else who makes them holds them as memory that cannot be given back."""
    kept = cached_arrays("kind", [], Maker(a=np.arange(5000)))
    assert str(only_file()) in Path("/proc/self/maps").read_text()
    assert not kept["a"].flags.writeable


@pytest.mark.parametrize("place", [0, 25, 40, -1])
def test_a_damaged_file_is_made_anew(place: int, caplog: pytest.LogCaptureFixture) -> None:
    """Of the format's line, the checksum, the description or the arrays."""
    make = Maker(a=np.arange(100.0))
    cached_arrays("kind", [], make)
    path = only_file()
    data = bytearray(path.read_bytes())
    data[place] ^= 0x10
    path.write_bytes(data)
    assert list(damaged_arrays()) == [path]
    kept = cached_arrays("kind", [], make)
    assert make.calls == 2
    assert np.array_equal(kept["a"], np.arange(100.0))
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    assert not damaged_arrays()


@pytest.mark.parametrize("length", [0, 10, 60])
def test_a_file_that_ends_early_is_made_anew(length: int) -> None:
    """As a power failure leaves it."""
    make = Maker(a=np.arange(100.0))
    cached_arrays("kind", [], make)
    os.truncate(only_file(), length)
    assert np.array_equal(cached_arrays("kind", [], make)["a"], np.arange(100.0))
    assert make.calls == 2


def test_where_nothing_can_be_written_arrays_are_made_each_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path / "file"))
    make = Maker(a=np.arange(3))
    for _ in range(2):
        assert np.array_equal(cached_arrays("kind", [], make)["a"], np.arange(3))
    assert make.calls == 2
    assert "cannot be written" in caplog.text


def test_a_writer_that_never_ends_is_not_waited_for(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(array_cache, "LOCK_TIMEOUT_S", 0.05)
    make = Maker(a=np.arange(3))
    with file_lock(array_folder() / ".lock", "the folder"):
        cached_arrays("kind", [], make)
    assert not list(array_folder().glob("*.arrays"))
    assert "another process" in caplog.text


def test_an_error_goes_through_and_nothing_is_kept() -> None:
    def fail() -> Arrays:
        raise AssetError("thing", "it is broken")

    with pytest.raises(AssetError):
        cached_arrays("kind", [], fail)
    assert not array_folder().exists()


def test_the_folder_is_kept_small(monkeypatch: pytest.MonkeyPatch) -> None:
    """What was not used for longest goes, and what a killed writer left."""
    monkeypatch.setattr(array_cache, "TIDY_EACH_BYTES", 0)
    monkeypatch.setattr(array_cache, "MOST_BYTES", 4000)
    left = array_folder() / ".kind-1.arrays.abc.unfinished"
    left.parent.mkdir(parents=True)
    left.write_bytes(b"part")
    make = Maker(a=np.zeros(100))
    for key in range(6):
        cached_arrays("kind", [key], make)
        for age, path in enumerate(
            sorted(array_folder().glob("*.arrays"), key=lambda p: p.stat().st_mtime_ns)
        ):
            os.utime(path, ns=(10**9 * age, 10**9 * age))
    assert not left.exists()
    assert sum(path.stat().st_size for path in array_folder().glob("*.arrays")) <= 4000
    cached_arrays("kind", [5], make)
    assert make.calls == 6
    cached_arrays("kind", [0], make)
    assert make.calls == 7
