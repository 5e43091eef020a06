"""Flat mirrors: what they show, where, and what ground truth says of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.render.scene.flat_mirrors import FlatMirrors
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.picture import linear
from tests.support.tiny_scenes import Thing, box_mesh, camera_at, model_of, snapshot_of

pytestmark = pytest.mark.gl

BLACK = Environment(
    background="colour", background_colour=(0, 0, 0), ambient=(0, 0, 0), sky_share=0.0
)
TINT = (0.9, 0.8, 0.7)
MIRROR = Thing(
    model_of(box_mesh((0.02, 3.0, 2.0)), base_colour=(*TINT, 1.0), metallic=1.0, roughness=0.02),
    Pose((3.01, 0.0, 0.0)),
)
LAMP = model_of(box_mesh(0.4), base_colour=(0.0, 0.0, 0.0, 1.0), emission=(0.3, 0.2, 0.1))
BEHIND_THE_EYE = Pose((-1.0, 0.6, 0.2))
PLAIN = PictureSettings(occlusion_strength=0.0, smooth_edges=False)


def camera(**picture: object) -> Camera:
    """At the origin, looking at the mirror."""
    settings = replace(PLAIN, **picture)  # type: ignore[arg-type]
    return replace(camera_at(width=160, height=120), picture=settings)


def scene(*things: Thing) -> WorldSnapshot:
    """Things before a mirror, in the dark."""
    return snapshot_of([MIRROR, *things], lights=(), environment=BLACK)


def place_of(point: tuple[float, float, float]) -> tuple[int, int]:
    """Row and column where the mirror at x = 3 shows a point."""
    x, y, z = point
    lens = camera().intrinsics
    ahead = 6.0 - x
    return round(lens.cy - lens.fy * z / ahead), round(lens.cx - lens.fx * y / ahead)


@pytest.mark.parametrize("supersampling", [1, 2])
def test_a_mirror_shows_what_stands_behind_the_eye(render: Render, supersampling: int) -> None:
    """Where optics says, left on the left, its radiance times the mirror's colour."""
    thing = Thing(LAMP, BEHIND_THE_EYE)
    rgb = render(scene(thing), camera(supersampling=supersampling), "rgb")["rgb"]
    seen = linear(rgb)
    # Of the lamp the face towards the mirror is seen, 0.2 m before its middle.
    row, column = place_of((-0.8, 0.6, 0.2))
    grazing = (1.0 - 6.8 / np.sqrt(6.8**2 + 0.6**2 + 0.2**2)) ** 5
    share = np.array(TINT) + (1.0 - np.array(TINT)) * grazing
    np.testing.assert_allclose(seen[row, column], share * (0.3, 0.2, 0.1), rtol=0.06)
    other = place_of((-0.8, -0.6, 0.2))
    assert seen[other].max() < 2e-3
    lit = np.argwhere(seen[..., 0] > 0.1)
    middle = lit.mean(axis=0)
    assert np.abs(middle - (row, column)).max() < 1.0


def test_ground_truth_is_that_of_the_mirror(render: Render) -> None:
    """Label, depth, normal and flow belong to its surface, whatever it shows."""
    before, after = scene(Thing(LAMP, BEHIND_THE_EYE)), scene(Thing(LAMP, Pose((-1.0, -0.6, 0.2))))
    after = replace(after, sim_time_ns=50_000_000, contents=before.contents)
    views = render(
        after, camera(), "rgb", "depth", "instance", "normals", "flow", past=(before, camera())
    )
    row, column = place_of((-0.8, -0.6, 0.2))
    assert views["instance"][row, column] == 1
    assert views["depth"][row, column] == pytest.approx(3.0, rel=1e-5)
    np.testing.assert_allclose(views["normals"][row, column], (0, 0, -1), atol=1e-5)
    assert (views["flow"][row, column] == 0.0).all()
    assert linear(views["rgb"])[row, column, 0] > 0.2


def test_what_is_behind_the_mirror_is_not_shown(render: Render) -> None:
    """Between the mirrored eye and the plane things may stand."""
    wall = Thing(LAMP, Pose((3.5, 0.0, 0.0)), scale=(1.0, 10.0, 10.0))
    rgb = render(scene(wall), camera(), "rgb")["rgb"]
    assert rgb[30:90, 40:120].max() <= 2


def test_a_mirror_far_beside_or_turned_away_is_passed_over() -> None:
    """Only what a camera may see is drawn again."""
    mirrors = FlatMirrors()
    [seen] = mirrors.seen(scene(), camera())
    assert seen.instance_id == 1
    for pose in (Pose((-3.0, 0.0, 0.0)), Pose((3.0, 40.0, 0.0))):
        there = snapshot_of([Thing(MIRROR.model, pose)], lights=(), environment=BLACK)
        assert mirrors.seen(there, camera()) == []


@pytest.mark.parametrize(
    "thing",
    [
        Thing(model_of(box_mesh((0.02, 3.0, 2.0)), metallic=1.0, roughness=0.3)),
        Thing(model_of(box_mesh((0.02, 3.0, 2.0)), metallic=0.0, roughness=0.02)),
        Thing(model_of(box_mesh((0.4, 3.0, 2.0)), metallic=1.0, roughness=0.02)),
        Thing(model_of(box_mesh((0.001, 0.05, 0.2)), metallic=1.0, roughness=0.02)),
    ],
    ids=["brushed", "lacquer", "thick", "small"],
)
def test_other_surfaces_are_no_flat_mirrors(thing: Thing) -> None:
    """They mirror the room as before."""
    there = replace(thing, pose=Pose((1.0, 0.0, 0.0)))
    assert FlatMirrors().seen(snapshot_of([there], environment=BLACK), camera()) == []
