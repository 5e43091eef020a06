"""Shades glow by the light that is in them, in both renderers; what they are stays as it is."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from tests.render.conftest import Render
from tests.support.picture import linear
from tests.support.tiny_scenes import Thing, box_mesh, camera_at, model_of, snapshot_of

DARK = Environment(
    ambient=(0, 0, 0), sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0)
)
SHADE = model_of(box_mesh((0.1, 20, 20)), base_colour=(0.2, 0.3, 0.4, 1.0), glow=(4.0, 2.0, 1.0))
# So far away that it lights nothing.
LAMP = Light(name="lamp", type="point", position_m=(-90.0, 0.0, 0.0), range_m=1.0)


@pytest.mark.parametrize(
    ("intensity", "colour", "expected"),
    [
        (0.25, (1.0, 1.0, 1.0), (1.0, 0.5, 0.25)),
        (0.5, (0.5, 0.5, 1.0), (1.0, 0.5, 0.5)),
        (0.0, (1.0, 1.0, 1.0), (0.0, 0.0, 0.0)),
    ],
)
def test_a_shade_shines_as_its_light_does(
    render: Render,
    intensity: float,
    colour: tuple[float, float, float],
    expected: tuple[float, float, float],
) -> None:
    """Radiance is glow times colour times intensity; a light that is off leaves nothing."""
    light = Light(
        name="lamp", type="point", intensity=intensity, colour=colour,
        position_m=LAMP.position_m, range_m=1.0,
    )  # fmt: skip
    thing = Thing(SHADE, Pose((3.0, 0, 0)), lit_by=("lamp",))
    scene = snapshot_of([thing], lights=(light,), environment=DARK)
    radiance = linear(render(scene, camera_at(), "rgb")["rgb"]).mean(axis=(0, 1))
    np.testing.assert_allclose(radiance, expected, rtol=0.06, atol=0.004)


def test_a_light_that_is_not_its_own_leaves_a_shade_dark(render: Render) -> None:
    """Only lights whose lamp it is count, and all else of the lamp's views stays the same."""
    scenes = [
        snapshot_of(
            [Thing(SHADE, Pose((3.0, 0, 0)), lit_by=names)], lights=(LAMP,), environment=DARK
        )
        for names in ((), ("lamp",))
    ]
    views = ("rgb", "depth", "instance", "albedo", "normals")
    dark, lit = (render(scene, camera_at(), *views) for scene in scenes)
    assert dark["rgb"].max() == 0
    assert lit["rgb"].min() > 100
    for view in views[1:]:
        np.testing.assert_array_equal(dark[view], lit[view])
