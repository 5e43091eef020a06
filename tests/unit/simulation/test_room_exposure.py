"""The exposure of baked rooms against arithmetic: what is measured, and when it counts."""

from __future__ import annotations

import math
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.light_files import load_baked, store_baked
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.render.picture.auto_exposure import (
    DARKEST,
    HIGHLIGHT,
    MAX_STOPS,
    MIDDLE_GREY,
    WHITE_SHARE,
    metered_exposure,
)
from sailenv_ros.simulation.room_exposure import room_exposure
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from tests.support import baked as by_hand
from tests.support.bake_scenes import COARSE, DARK, hollow, still
from tests.support.lockstep_core import lockstep_core
from tests.support.tiny_scenes import Thing, box_mesh, model_of

ROOM = """
version: 1
title: Cell
lights:
  - {name: lamp, type: point, position: [0, 0, 1.5], intensity: 2}
room: {size: [3, 3, 2.4]}
"""


def grey(level: float, count: int = 1000) -> NDArray[np.float64]:
    return np.full((count, 3), level)


@pytest.mark.parametrize("level", [0.002, 0.18, 2.0])
def test_even_light_becomes_middle_grey(level: float) -> None:
    assert metered_exposure(grey(level)) == pytest.approx(
        math.log2(MIDDLE_GREY) - math.log2(level + DARKEST)
    )


def test_highlights_hold_the_exposure_back() -> None:
    """As many as may be white do not; one more does, whatever its colour."""
    light = grey(0.1)
    free = int(WHITE_SHARE * len(light))
    light[:free] = 50.0
    mean = np.log2(light @ [0.2126, 0.7152, 0.0722] + DARKEST).mean()
    assert metered_exposure(light) == pytest.approx(math.log2(MIDDLE_GREY) - mean)
    assert metered_exposure(light, 0.5) == 0.5
    light[free] = 50.0, 0.0, 0.0
    held = math.log2(HIGHLIGHT / (50.0 + DARKEST))
    assert metered_exposure(light) == pytest.approx(held)
    assert metered_exposure(light, 0.5) == pytest.approx(held)
    assert metered_exposure(light, -6.0) == -6.0


def test_black_and_endless_light_have_limits() -> None:
    assert metered_exposure(grey(0.0)) == MAX_STOPS
    assert metered_exposure(grey(6e4)) == -MAX_STOPS
    assert metered_exposure(np.zeros((0, 3))) == 0.0


def test_a_room_is_metered_in_the_light_that_its_lamps_give() -> None:
    """The surroundings as they are, lamps by colour and intensity; a removed one not at all."""
    lamp = Light(name="lamp", type="point", intensity=4.0, colour=(1.0, 0.5, 0.25))
    room = by_hand.baked({}, [by_hand.layer(lamp)])
    seen = np.tile(np.array([[[0.05] * 3, [0.02] * 3]], np.float16), (100, 1, 1))
    room = replace(room, seen=seen)
    total = 0.05 + 0.02 * 4.0 * (0.2126 + 0.5 * 0.7152 + 0.25 * 0.0722)
    assert room_exposure(room, [lamp]) == pytest.approx(math.log2(0.18 / total), abs=0.01)
    assert room_exposure(room, []) == pytest.approx(math.log2(0.18 / 0.05), abs=0.01)


@pytest.fixture
def cell(cell: Path) -> Path:
    """A room without an exposure of its own, baked coarsely."""
    snapshot = SceneLibrary().snapshot(cell)
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.2, rays=4, pass_rays=4))
    store_baked(replace(baked, fingerprint=fingerprint(snapshot)))
    return cell


def exposure_of(scene: Path, *, baked_light: bool = True) -> float:
    with closing(SceneLibrary(baked_light=baked_light).build(scene)) as world:
        return world.contents.environment.exposure


def test_what_eyes_see_is_kept_with_the_light(cell: Path) -> None:
    """Matt walls of one colour under one lamp: what is seen is lit, and finite."""
    baked = load_baked(fingerprint(SceneLibrary().snapshot(cell)))
    assert baked is not None
    assert baked.seen.shape[1:] == (len(baked.layers), 3)
    assert len(baked.seen) > 1000
    assert np.isfinite(baked.seen).all()
    lit = baked.seen[:, 1].astype(float)
    assert 0.0 < np.median(lit) < baked.layers[1].direct.max()


def test_lamps_may_be_white() -> None:
    """A glowing globe before the eye is no highlight: the room is as bright as what it lights."""
    grey_room = Thing(hollow((4.0, 4.0, 2.5), base_colour=(0.5, 0.5, 0.5, 1.0), roughness=1.0))
    look = {"base_colour": (0.0, 0.0, 0.0, 1.0), "roughness": 1.0, "emission": (50.0,) * 3}
    globe = Thing(model_of(box_mesh(0.7), **look), Pose((0.0, 0.0, 0.4)))
    baked = bake(still([grey_room, globe], environment=DARK), settings=COARSE)
    assert len(baked.seen) > 1000
    assert 1.0 < baked.seen.max() < 25.0


def test_only_baked_rooms_that_name_no_exposure_are_metered(cell: Path) -> None:
    """Or that ask for it; in plain light the scene's own exposure counts."""
    metered = exposure_of(cell)
    assert metered != 0.0
    assert exposure_of(cell, baked_light=False) == 0.0
    cell.write_text(ROOM + "environment: {exposure: 0.5}\n")
    assert exposure_of(cell) == 0.5
    cell.write_text(ROOM + "environment: {exposure: -1.5, meter_exposure: true}\n")
    assert exposure_of(cell) == -1.5
    cell.write_text(ROOM + "environment: {exposure: 12, meter_exposure: true}\n")
    assert metered < exposure_of(cell) < 12
    assert exposure_of(cell, baked_light=False) == 12
    cell.write_text(ROOM.replace("intensity: 2", "intensity: 4"))
    assert exposure_of(cell) == pytest.approx(metered - 1.0, abs=0.02)


def test_an_exposure_that_is_set_stays(cell: Path) -> None:
    """Other changes of the surroundings keep it measured; a saved scene says which it is."""
    metered = exposure_of(cell)
    with closing(lockstep_core(cell)) as core:
        core.set_environment(sky_share=0.5)
        assert core.info.environment.exposure == metered
        assert "exposure: " not in core.scene_text()
        core.set_environment(exposure=1.5)
        assert core.info.environment.exposure == 1.5
        assert "exposure: 1.5" in core.scene_text()
        core.set_environment(exposure=12, meter_exposure=True)
        assert metered < core.info.environment.exposure < 12
