"""Alpha-tested leaves: as dense from afar as nearby, in every view; lit on both sides."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.scene.coverage import cutoff_by_level
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Material
from tests.render.conftest import Render
from tests.support.tiny_scenes import Thing, camera_at, model_of, snapshot_of, wall_mesh


def twigs(count: int = 120) -> NDArray[np.uint8]:
    """A texture of thin leaves that cover an eighth of it."""
    generator = np.random.default_rng(0)
    alpha = np.zeros((512, 512), np.uint8)
    for _ in range(count):
        centre = tuple(int(at) for at in generator.integers(0, 512, 2))
        cv2.ellipse(alpha, centre, (26, 3), float(generator.uniform(0, 180)), 0, 360, 255, -1)
    green = np.full((512, 512, 3), (60, 140, 50), np.uint8)
    return np.dstack([green, alpha])


@pytest.mark.parametrize("distance_m", [1.5, 3.0, 6.0, 12.0])
def test_leaves_cover_the_same_share_from_afar(render: Render, distance_m: float) -> None:
    """Where a texel is a leaf nearby, there are as many pixels of leaves at eight times as far."""
    texture = twigs()
    share = (texture[..., 3] > 127).mean()
    sheet = model_of(
        wall_mesh(2, 2), alpha="mask", base_colour=(1, 1, 1, 1), base_colour_texture=texture
    )
    camera = camera_at(width=400, height=400)
    scene = snapshot_of([Thing(sheet, Pose((distance_m, 0, 0)))])
    views = render(scene, camera, "instance", "depth", "rgb")
    leaves = views["instance"] > 0
    pixels = min((camera.intrinsics.fx * 2.0 / distance_m) ** 2, leaves.size)
    assert leaves.sum() / pixels == pytest.approx(share, rel=0.2)
    np.testing.assert_array_equal(leaves, np.isfinite(views["depth"]))


def test_the_cutoff_falls_only_where_leaves_would_vanish() -> None:
    """With whole textures, even ones and solid ones it is the material's own at every level."""
    solid = np.full((64, 64, 4), 255, np.uint8)
    half = solid.copy()
    half[..., 3] = 128
    for texture, alpha in ((None, "mask"), (twigs(), "opaque"), (solid, "mask"), (half, "mask")):
        material = Material(alpha=alpha, base_colour_texture=texture, alpha_cutoff=0.4)  # type: ignore[arg-type]
        assert cutoff_by_level(material, 512) == (0.0, 0.4)
    slope, least = cutoff_by_level(Material(alpha="mask", base_colour_texture=twigs()), 512)
    assert slope > 0.02
    assert 0.1 < least < 0.4


def test_a_leaf_is_lit_on_the_side_that_is_seen(render: Render) -> None:
    """A lamp at the camera shows both sides of a double-sided sheet alike."""
    lamp = Light(name="lamp", type="point", intensity=10.0, position_m=(0, 0, 0.2))
    leaf = model_of(wall_mesh(4, 4), double_sided=True, base_colour=(0.2, 0.5, 0.2, 1))
    front, back = (
        render(
            snapshot_of([Thing(leaf, Pose.from_rpy_deg((2.0, 0, 0), (0, 0, yaw)))], lights=(lamp,)),
            camera_at(),
            "rgb",
        )["rgb"].astype(int)
        for yaw in (0, 180)
    )
    assert front[36, 48].min() > 40
    assert np.abs(front[36, 48] - back[36, 48]).max() <= 2
