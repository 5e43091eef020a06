"""Light on sheets whose two thin layers have crossed, beside things that lie on one another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.quality import FINE
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Model
from tests.support.bake_scenes import COARSE, ground, read, still
from tests.support.tiny_scenes import Thing, mesh_of, model_of

WHITE = (1.0, 1.0, 1.0)
BLACK = (0.0, 0.0, 0.0, 1.0)
EVEN = Environment(sky_zenith=WHITE, sky_horizon=WHITE, sky_ground=WHITE)
SUN = Light(name="sun", type="directional", direction=(0.3, 0.0, -1.0))


def ceiling(size: float, height: float, **material: Any) -> Model:
    """A square that faces down."""
    h = 0.5 * size
    corners = [(-h, -h, height), (-h, h, height), (h, h, height), (h, -h, height)]
    uvs = [(0, 0), (0, 1), (1, 1), (1, 0)]
    return model_of(mesh_of(corners, [(0, 0, -1)] * 4, uvs, [(0, 1, 2), (0, 2, 3)]), **material)


@pytest.mark.parametrize("gap_m", [0.0015, 0.003])
def test_layers_that_crossed_are_lit_from_outside(gap_m: float) -> None:
    """The layer that faces up lies below the one that faces down, and is seen through its back."""
    sheet = Model(name="sheet", parts=(*ground(2.0).parts, *ceiling(2.0, gap_m).parts))
    snapshot = still([Thing(sheet, pose=Pose((0.0, 0.0, 1.0)))], environment=EVEN, lights=(SUN,))
    baked = bake(snapshot, settings=COARSE)
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced)
    upper = np.isclose(points[:, 2], 1.0)
    assert np.allclose(bounced[upper], 1.0, atol=0.02)
    _, share = read(baked, 1, snapshot, baked.layers[1].direct)
    assert np.allclose(share[upper], share[upper].max(), rtol=0.01)
    assert share[upper].max() > 0.2


def test_layers_that_crossed_stay_lit_when_they_move() -> None:
    """Relighting looks from where the bake did."""
    sheet = Model(name="sheet", parts=(*ground(2.0).parts, *ceiling(2.0, 0.003).parts))
    snapshot = still([Thing(sheet, pose=Pose((0.0, 0.0, 1.0)))], environment=EVEN, lights=())
    baked = bake(snapshot, settings=COARSE)
    before, after = (Pose((0.0, 0.0, height)).matrix() for height in (1.0, 1.6))
    scene = BakedScene(baked, snapshot.contents, 2)
    moved = relit(scene, [Change(id=1, before=before, after=after)], FINE, threads=2)
    points, bounced = read(moved, 1, snapshot, moved.layers[0].bounced)
    assert np.allclose(bounced[np.isclose(points[:, 2], 1.0)], 1.0, atol=0.02)


def test_a_thing_that_lies_on_another_still_hides_it() -> None:
    """The ground below a plate is dark as before: the plate may be moved away."""
    plate = Thing(ceiling(1.6, 0.0, base_colour=BLACK), pose=Pose((0.0, 0.0, 0.002)))
    snapshot = still([Thing(ground(2.0, base_colour=BLACK)), plate], environment=EVEN, lights=())
    baked = bake(snapshot, settings=COARSE)
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced)
    below = np.abs(points[:, :2]).max(axis=1) < 0.6
    assert below.any()
    assert bounced[below].max() < 0.1
