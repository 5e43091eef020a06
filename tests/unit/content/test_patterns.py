"""Fine structures of surfaces: they tile without a seam, and wood has the grain of wood."""

from __future__ import annotations

import gc
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_content.standard import patterns
from sailenv_content.standard.patterns import PATTERNS, PatternTextures, pattern_maps

GRAIN = PATTERNS["grain"]


def tile(name: str) -> NDArray[np.float64]:
    """Return the brightness of a tile, 0 to 1."""
    return pattern_maps(PATTERNS[name])["base_colour_texture"][..., 0] / 255.0


@pytest.mark.parametrize("name", PATTERNS)
def test_a_tile_goes_on_at_its_edges(name: str) -> None:
    bright = tile(name)
    for axis in (0, 1):
        inside = np.abs(np.diff(bright, axis=axis)).mean()
        seam = np.abs(bright.take(0, axis) - bright.take(-1, axis)).mean()
        assert seam < 2.0 * inside + 0.01


def test_wood_has_little_contrast() -> None:
    bright = tile("grain")
    assert 0.03 < bright.std() / bright.mean() < 0.06
    assert bright.min() > 0.65 * bright.max()


def test_grain_runs_along_u() -> None:
    across, along = (np.abs(np.diff(tile("grain"), axis=axis)).mean() for axis in (0, 1))
    assert across > 5.0 * along


def test_growth_lines_are_as_near_as_in_wood() -> None:
    """Most of what changes across the fibres does so in 2 to 20 mm."""
    bright = tile("grain")
    mm = 1000.0 * GRAIN.tile_m / len(bright)
    assert mm < 1.2
    power = (np.abs(np.fft.rfft(bright - bright.mean(), axis=0)) ** 2).mean(axis=1)
    waves_mm = 1000.0 * GRAIN.tile_m / np.arange(1, len(power))
    share = power[1:] / power[1:].sum()
    assert share[(waves_mm > 2.0) & (waves_mm < 20.0)].sum() > 0.5
    assert share[(waves_mm > 20.0) & (waves_mm < 100.0)].sum() < 0.25  # the stripes of zebrano


def test_flat_sawn_arches_are_there_too() -> None:
    """In some places, a few in a hundred, lines cross the fibres."""
    up, right = np.gradient(tile("grain"))
    steep = np.hypot(up, right) > np.percentile(np.hypot(up, right), 50.0)
    crossing = (np.abs(right) > 0.5 * np.abs(up)) & steep
    assert 0.005 < crossing[steep].mean() < 0.1


def test_tiles_are_made_once_for_all_processes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What another process finds on disk has the same bytes, and nobody draws it again."""
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))
    before = patterns._maps.__wrapped__("terry")
    monkeypatch.setattr(patterns, "_drawn", None)
    after = patterns._maps.__wrapped__("terry")
    assert before.keys() == after.keys()
    for name, texture in before.items():
        np.testing.assert_array_equal(after[name], texture)
        assert not after[name].flags.writeable


def test_no_other_array_has_the_name_of_a_texture_that_one_of_two_threads_made() -> None:
    """A mesh on disk had a texture for positions: its identity had been that of such a texture."""
    second = patterns._maps.__wrapped__("weave")
    del second
    gc.collect()
    others = [np.zeros((4, 3)) for _ in range(2000)]
    textures = PatternTextures()
    assert not [name for name in map(textures.name_of, others) if name is not None]
    known = pattern_maps(PATTERNS["weave"])["base_colour_texture"]
    assert textures.name_of(known) == "weave/base_colour_texture"
    assert textures.named("weave/base_colour_texture") is known
