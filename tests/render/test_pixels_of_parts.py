"""Parts of a model in both renderers: the same pixels are theirs."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.model import AssetPart
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World
from tests.support.divided_bed import divided_bed
from tests.support.tiny_scenes import CATEGORIES

Render = Callable[..., dict[str, NDArray[Any]]]


def bed_world() -> World:
    parts = (
        AssetPart(name="left pillow", category="kind 7", meshes=(1,)),
        AssetPart(name="right pillow", category="kind 7", meshes=(2,)),
    )
    return World(
        scene="sleep",
        epoch=1,
        placements=[
            Placement(
                name="bed",
                asset=divided_bed(parts),
                category_id=CATEGORIES.named("kind 5").id,
                pose=Pose(position_m=(0.3, -0.2, 0.1)),
                scale=(1.0, 0.9, 1.2),
                static=True,
            )
        ],
        movers=[Mover(name="mover", start=Pose(), track=None, controller="waypoint")],
        categories=CATEGORIES,
    )


def test_each_pixel_is_of_the_piece_that_its_ray_meets(render: Render) -> None:
    world = bed_world()
    try:
        snapshot, states = world.snapshot(), world.states()
    finally:
        world.close()
    lens = CameraIntrinsics(width=160, height=120, vertical_fov_deg=50.0)
    camera = Camera(intrinsics=lens, pose=look_at((2.0, 1.8, 2.2), (0.0, 0.0, 0.4)))
    views = render(snapshot, camera, "rgb", "instance", "category", "depth")
    rows, columns = np.mgrid[0 : lens.height, 0 : lens.width]
    rays = np.stack(
        [(columns - lens.cx) / lens.fx, (rows - lens.cy) / lens.fy, np.ones(rows.shape)], axis=-1
    ).reshape(-1, 3)
    pose = camera.world_from_camera
    origins = np.broadcast_to(pose[:3, 3], rays.shape)
    hits = SceneGeometry.of_contents(snapshot.contents).cast(states, origins, rays @ pose[:3, :3].T)
    wanted = hits.instance.reshape(rows.shape)
    smooth = ndimage.maximum_filter(wanted, 3) == ndimage.minimum_filter(wanted, 3)
    assert {1, 2, 3} <= set(np.unique(wanted[smooth]))
    np.testing.assert_array_equal(views["instance"][smooth], wanted[smooth])
    table = CategoryTable(CATEGORIES.values())
    pillow = table.named("kind 7").id
    np.testing.assert_array_equal(views["category"] == pillow, views["instance"] >= 2)
