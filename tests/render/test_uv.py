"""The view `uv`: texture coordinates of surfaces, in both renderers."""

from __future__ import annotations

import numpy as np

from sailenv_ros.assets.solids import ground_mesh
from sailenv_ros.types.geometry import Pose
from tests.render.conftest import Render
from tests.support.tiny_scenes import Thing, camera_at, model_of, snapshot_of

TILE_M = 2.0


def test_texture_coordinates_are_those_of_the_mesh(render: Render) -> None:
    """A floor's are its points in metres over the tile's size; where nothing is hit they are 0."""
    floor = model_of(ground_mesh(16.0, metres_per_tile=TILE_M))
    scene = snapshot_of([Thing(floor, Pose((3.0, 0.5, -1.0)))])
    views = render(scene, camera_at(), "uv", "object_coords", "instance")
    seen = views["instance"] > 0
    assert seen.any()
    assert not seen.all()
    expected = views["object_coords"][seen][:, :2] / TILE_M
    np.testing.assert_allclose(views["uv"][seen], expected, atol=2e-5)
    assert np.ptp(views["uv"][seen], axis=0).min() > 1.0
    assert not views["uv"][~seen].any()


def test_other_views_keep_their_bytes(render: Render) -> None:
    """Beside the view and without it."""
    scene = snapshot_of([Thing(model_of(ground_mesh(16.0)), Pose((3.0, 0.5, -1.0)))])
    names = ("rgb", "depth", "instance", "normals", "albedo")
    beside, alone = render(scene, camera_at(), *names, "uv"), render(scene, camera_at(), *names)
    for name in names:
        np.testing.assert_array_equal(beside[name], alone[name], err_msg=name)
