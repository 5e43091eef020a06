"""Baked light in the user's cache: what was stored comes back, what is broken does not."""

from __future__ import annotations

import errno
import logging
import os
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import StorageError
from sailenv_ros.light.bake import light_files as files
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.lights import Light
from tests.support.bake_scenes import COARSE, ground, still
from tests.support.tiny_scenes import Thing


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of the test's own."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    return tmp_path / "light"


@pytest.fixture(scope="module")
def baked() -> BakedLight:
    """Something to store."""
    lights = (Light(name="sun", type="directional"), Light(name="lamp", type="point"))
    model = ground(1.0)
    return bake(still([Thing(model), Thing(model)], lights=lights), settings=COARSE)


def test_what_is_stored_comes_back(baked: BakedLight) -> None:
    """Every number, read-only, and one unwrapping for all instances of a model."""
    dimmed = [replace(layer, clear=1.0 - place / 7.0) for place, layer in enumerate(baked.layers)]
    baked = replace(baked, layers=tuple(dimmed))
    files.store_baked(baked)
    loaded = files.load_baked(baked.fingerprint)
    assert loaded is not None
    assert loaded.fingerprint == baked.fingerprint
    assert asdict(loaded.probes) == asdict(baked.probes)
    assert list(loaded.charts) == list(baked.charts)
    assert loaded.charts[1].unwrapping is loaded.charts[2].unwrapping
    for number, chart in baked.charts.items():
        same = loaded.charts[number]
        assert (same.offset, same.scale) == (chart.offset, chart.scale)
        np.testing.assert_array_equal(same.world_from_body, chart.world_from_body)
        for name in ("vertices", "triangles", "uvs"):
            for one, other in zip(
                getattr(same.unwrapping, name), getattr(chart.unwrapping, name), strict=True
            ):
                np.testing.assert_array_equal(one, other)
    for layer, same_layer in zip(baked.layers, loaded.layers, strict=True):
        assert (same_layer.light, same_layer.clear) == (layer.light, layer.clear)
        for name in ("direct", "bounced", "probe_direct", "probe_bounced", "visibility"):
            np.testing.assert_array_equal(getattr(same_layer, name), getattr(layer, name))
        assert not same_layer.bounced.flags.writeable
        assert (same_layer.edges is None) == (layer.edges is None)
        if layer.edges is not None:
            assert same_layer.edges is not None
            np.testing.assert_array_equal(same_layer.edges.index, layer.edges.index)
            np.testing.assert_array_equal(same_layer.edges.blocks, layer.edges.blocks)


def test_nothing_there_is_none_without_a_word(caplog: pytest.LogCaptureFixture) -> None:
    """A scene that was never baked is no error."""
    assert files.load_baked("0" * 32) is None
    assert not caplog.records


@pytest.mark.parametrize("damage", ["empty", "cut", "text", "other"])
def test_a_broken_file_is_as_good_as_none(
    baked: BakedLight, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    """One warning, and it can be stored again."""
    path = files.store_baked(baked)
    whole = path.read_bytes()
    name = baked.fingerprint
    if damage == "other":
        name = "1" * 32
        files.baked_file(name).write_bytes(whole)
    else:
        path.write_bytes({"empty": b"", "cut": whole[: len(whole) // 2], "text": b"light"}[damage])
    with caplog.at_level(logging.WARNING):
        assert files.load_baked(name) is None
    assert [record.levelname for record in caplog.records] == ["WARNING"]
    files.store_baked(baked)
    assert files.load_baked(baked.fingerprint) is not None


def test_a_failed_write_leaves_nothing(
    baked: BakedLight, cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither half a file nor a temporary one."""

    def full(*args: object, **kwargs: object) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", full)
    cache.mkdir()
    with pytest.raises(StorageError, match="the disk is full"):
        files.store_baked(baked)
    assert [path.name for path in cache.iterdir()] == [".lock"]


def test_a_flipped_bit_anywhere_is_found(
    baked: BakedLight, caplog: pytest.LogCaptureFixture
) -> None:
    """No bit of the file can change unseen, and none makes anything but one warning."""
    path = files.store_baked(baked)
    files.remember("a" * 32, baked.fingerprint)
    assert not files.damaged_light()
    whole = bytearray(path.read_bytes())
    for place in range(0, len(whole), len(whole) // 97):
        caplog.clear()
        whole[place] ^= 0x10
        path.write_bytes(whole)
        whole[place] ^= 0x10
        assert files.load_baked(baked.fingerprint) is None
        assert [record.levelname for record in caplog.records] == ["WARNING"]
        assert list(files.damaged_light()) == [path]
        assert not files.is_baked("a" * 32)
    path.write_bytes(whole)
    assert files.load_baked(baked.fingerprint) is not None
    assert files.is_baked("a" * 32)


def test_edges_that_are_not_there_are_refused(
    baked: BakedLight, caplog: pytest.LogCaptureFixture
) -> None:
    """An index may name no block beyond the last: kernels read what it says."""
    sun = baked.layers[1]
    assert sun.edges is not None
    wrong = np.full_like(sun.edges.index, len(sun.edges.blocks))
    layers = (baked.layers[0], replace(sun, edges=replace(sun.edges, index=wrong)))
    files.store_baked(replace(baked, layers=(*layers, *baked.layers[2:])))
    assert files.load_baked(baked.fingerprint) is None
    assert "edges of shadows" in caplog.text


@pytest.mark.parametrize(("most_bytes", "kept"), [(25, 2), (30, 3), (5, 1), (1000, 6)])
def test_old_files_are_thrown_away(tmp_path: Path, most_bytes: int, kept: int) -> None:
    """Those that were not used for longest, and never the last one; drafts count by themselves."""
    for age in range(6):
        for suffix in ("light", "draft"):
            path = tmp_path / f"{age}.{suffix}"
            path.write_bytes(bytes(10))
            os.utime(path, ns=(10**9 * (100 - age), 10**9 * (100 - age)))
    files.forget_oldest(tmp_path, most_bytes)
    left = sorted(path.name for path in tmp_path.iterdir())
    assert left == sorted(f"{age}.{suffix}" for age in range(kept) for suffix in ("light", "draft"))


def test_a_scene_is_known_while_its_light_is_there(baked: BakedLight) -> None:
    """A note without its file, or with nonsense in it, is none."""
    stamp = "a" * 32
    assert not files.is_baked(stamp)
    path = files.store_baked(baked)
    files.remember(stamp, baked.fingerprint)
    assert files.is_baked(stamp)
    path.unlink()
    assert not files.is_baked(stamp)
    path.with_name(f"{stamp}.known").write_text("../../etc/passwd")
    assert not files.is_baked(stamp)
