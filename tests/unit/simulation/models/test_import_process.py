"""Imports run apart: with limits, and whatever becomes of them is a sentence."""

from __future__ import annotations

import json
import tempfile
import threading
import time
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.errors import AssetError, InvalidRequest
from sailenv_ros.simulation.models.asset_file import read_asset, write_asset
from sailenv_ros.simulation.models.import_process import (
    ImportLimits,
    import_file_apart,
    import_upload_apart,
)
from sailenv_ros.simulation.models.uploads import asset_from_upload
from sailenv_ros.types.model import Asset
from tests.support.upload_files import box_zip


@pytest.fixture
def scratch(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of temporary files of the test's own."""
    folder = tmp_path / "scratch"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    return folder


def many_triangles(side: int = 700) -> bytes:
    """Return a zip of few megabytes with half a million triangles or more."""
    x, y = np.meshgrid(np.arange(side), np.arange(side))
    z = (x * 7 + y * 3) % 11
    lines = [f"v {a} {b} {c}" for a, b, c in zip(x.flat, z.flat, y.flat, strict=True)]
    first = np.arange(side * side).reshape(side, side)[:-1, :-1].ravel() + 1
    for a in first:
        lines.append(f"f {a} {a + 1} {a + side}")
        lines.append(f"f {a + 1} {a + side + 1} {a + side}")
    return box_zip("\n".join(lines))


def test_what_comes_from_the_process_is_what_would_come_here(scratch: Path) -> None:
    """Every number of the asset; nothing is left on the disk."""
    here = asset_from_upload(box_zip(), name="", filename="my box.zip", category="box")
    there = import_upload_apart(box_zip(), name="", filename="my box.zip", category="box")
    assert_same(here, there)
    assert not list(scratch.iterdir())


def assert_same(one: Asset, other: Asset) -> None:
    for name in ("name", "display_name", "category", "mass_kg", "centre_of_mass_m"):
        assert getattr(one, name) == getattr(other, name)
    for part, same in zip(one.model.parts, other.model.parts, strict=True):
        for name in ("positions", "normals", "uvs", "triangles"):
            np.testing.assert_array_equal(getattr(part.mesh, name), getattr(same.mesh, name))
        for name, value in vars(part.material).items():
            np.testing.assert_array_equal(getattr(same.material, name), value)
    for shape, same_shape in zip(one.collision, other.collision, strict=True):
        np.testing.assert_array_equal(shape.points, same_shape.points)  # type: ignore[union-attr]


def test_refusals_are_the_importers_own(scratch: Path, tmp_path: Path) -> None:
    """They come back as the errors that they are."""
    with pytest.raises(AssetError, match="no zip archive"):
        import_upload_apart(b"nonsense", name="", filename="a.zip")
    with pytest.raises(InvalidRequest, match=r"filename must be one that ends in \.zip or \.glb"):
        import_upload_apart(b"nonsense", name="", filename="a.txt")
    with pytest.raises(AssetError, match="no such file"):
        import_file_apart(tmp_path / "none.glb", name="a", category="box")
    assert not list(scratch.iterdir())


def test_an_import_that_takes_too_long_is_ended(scratch: Path) -> None:
    """After its time, not after its work; others go on meanwhile."""
    beats: list[float] = []
    stop = threading.Event()

    def beat() -> None:
        while not stop.wait(0.01):
            beats.append(time.monotonic())

    thread = threading.Thread(target=beat)
    data = many_triangles()
    thread.start()
    try:
        with pytest.raises(AssetError, match="longer than 2 s, the limit"):
            import_upload_apart(data, name="", filename="a.zip", limits=ImportLimits(time_s=2.0))
    finally:
        stop.set()
        thread.join()
    assert len(beats) > 20  # Python's lock was free
    assert not list(scratch.iterdir())


def test_an_import_that_needs_too_much_memory_is_ended(scratch: Path) -> None:
    """In words, whether Python or native code ran out of it."""
    limits = ImportLimits(memory_bytes=250 * 2**20)
    with pytest.raises(AssetError, match=r"memory|too large|cannot be"):
        import_upload_apart(many_triangles(300), name="", filename="a.zip", limits=limits)
    assert not list(scratch.iterdir())


def test_files_that_an_import_writes_are_limited(scratch: Path) -> None:
    """A bomb fills no disk."""
    limits = ImportLimits(file_bytes=1000)
    with pytest.raises(AssetError, match=r"cannot be|no zip archive"):
        import_upload_apart(many_triangles(50), name="", filename="a.zip", limits=limits)
    assert not list(scratch.iterdir())


@cache
def box_file() -> bytes:
    """Return the bytes of an asset's file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "asset"
        asset = asset_from_upload(box_zip(), name="a", filename="a.zip")
        write_asset(path, asset)
        assert_same(asset, read_asset(path))
        return path.read_bytes()


def test_a_description_of_another_kind_is_refused(tmp_path: Path) -> None:
    """Found by fuzzing: a text where a table should be."""
    path = tmp_path / "asset"
    line, _, rest = box_file().partition(b"\n")
    told = json.loads(line)
    told["parts"][0]["textures"] = "none"
    path.write_bytes(json.dumps(told).encode() + b"\n" + rest)
    with pytest.raises(AssetError):
        read_asset(path)


@settings(max_examples=100)
@given(place=st.floats(0.0, 1.0, exclude_max=True), change=st.integers(1, 255), cut=st.booleans())
def test_a_file_that_is_no_asset_is_refused(
    tmp_path_factory: pytest.TempPathFactory, place: float, change: int, cut: bool
) -> None:
    """What a process that was taken over may write is an asset or an error, never code."""
    folder = tmp_path_factory.mktemp("asset")
    data = bytearray(box_file())
    at = int(place * min(len(data), 1500))
    data[at] ^= change
    (folder / "asset").write_bytes(data[: at if cut else None])
    try:
        asset = read_asset(folder / "asset")
    except AssetError:
        return
    assert not cut
    assert asset.model.triangle_count
