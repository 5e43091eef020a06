"""Views `metallic_roughness` and `measured_depth`, in both renderers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.types.depth_sensor_names import depth_sensor_names
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    checker,
    model_of,
    snapshot_of,
    wall_mesh,
)

WALL = wall_mesh(60.0, 60.0)
AHEAD = Pose((2.0, 0.0, 0.0))
OTHERS = ("rgb", "depth", "instance", "normals", "albedo", "uv")


def room() -> WorldSnapshot:
    """Return a box before a wall that ends within the picture."""
    wall = model_of(wall_mesh(3.0, 2.0), base_colour=(0.6, 0.6, 0.6, 1.0), roughness=0.9)
    box = model_of(box_mesh(0.6), base_colour_texture=checker(3), roughness=0.8)
    return snapshot_of([Thing(wall, AHEAD), Thing(box, Pose((1.4, 0.2, 0.0)))])


@pytest.mark.parametrize(("metallic", "roughness"), [(0.0, 0.9), (1.0, 0.25), (0.5, 0.045)])
def test_a_plain_material_s_factors_are_exact(
    render: Render, metallic: float, roughness: float
) -> None:
    """To single precision, wherever the surface is; 0 beside it."""
    wall = model_of(wall_mesh(1.0, 1.0), metallic=metallic, roughness=roughness)
    views = render(snapshot_of([Thing(wall, AHEAD)]), camera_at(), "metallic_roughness", "instance")
    seen = views["instance"] > 0
    assert seen.any()
    assert not seen.all()
    np.testing.assert_allclose(
        views["metallic_roughness"][seen], [[metallic, roughness]] * seen.sum(), rtol=1e-6
    )
    assert not views["metallic_roughness"][~seen].any()


def test_a_map_multiplies_them(render: Render) -> None:
    """Blue is metalness, green roughness, as in glTF."""
    texture = np.full((128, 128, 4), 255, np.uint8)
    texture[:, :, 1], texture[:, :, 2] = 128, 51
    wall = model_of(WALL, metallic=0.5, roughness=0.9, metallic_roughness_texture=texture)
    views = render(snapshot_of([Thing(wall, AHEAD)]), camera_at(), "metallic_roughness")
    expected = [0.5 * 51 / 255, 0.9 * 128 / 255]
    np.testing.assert_allclose(
        views["metallic_roughness"], np.broadcast_to(expected, (72, 96, 2)), atol=2e-3
    )


def test_other_views_keep_their_bytes(render: Render) -> None:
    """Beside the two and without them."""
    beside = render(room(), camera_at(), *OTHERS, "metallic_roughness", "measured_depth")
    alone = render(room(), camera_at(), *OTHERS)
    for name in OTHERS:
        np.testing.assert_array_equal(beside[name], alone[name], err_msg=name)


def test_the_ideal_sensor_measures_the_depth(render: Render) -> None:
    """And nothing where nothing is."""
    views = render(room(), camera_at(), "depth", "measured_depth")
    there = np.isfinite(views["depth"])
    assert not there.all()
    np.testing.assert_array_equal(views["measured_depth"][there], views["depth"][there])
    assert np.isnan(views["measured_depth"][~there]).all()


def test_each_sensor_measures_the_same_again_at_the_same_instant(render: Render) -> None:
    """Other instants and other cameras have other noise; the depth is met to a few centimetres."""
    now, later = room(), replace(room(), sim_time_ns=50_000_000)
    for name in depth_sensor_names()[1:]:
        camera = replace(camera_at(), picture=PictureSettings(depth_sensor=name), name="left")
        first, again, after, other = (
            render(snapshot, seen_by, "depth", "measured_depth")
            for snapshot, seen_by in (
                (now, camera),
                (now, camera),
                (later, camera),
                (now, replace(camera, name="right")),
            )
        )
        np.testing.assert_array_equal(first["measured_depth"], again["measured_depth"])
        for different in (after, other):
            assert not np.array_equal(
                first["measured_depth"], different["measured_depth"], equal_nan=True
            )
        measured = np.isfinite(first["measured_depth"])
        assert measured.sum() > 0.3 * np.isfinite(first["depth"]).sum()
        error = first["measured_depth"][measured] - first["depth"][measured]
        assert np.median(np.abs(error)) < 0.02
