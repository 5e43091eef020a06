"""Views that somebody standing in a room might have, chosen by a seed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.snapshot import DrawnInstance, WorldSnapshot

__all__ = ["plausible_views", "room_at_rest"]

EYES_M = (1.1, 1.75)
"""Height of eyes above the floor."""

NEAREST_M = 0.35
"""Nothing that is seen is nearer."""

LARGEST_SHARE = 0.7
"""No object but the room covers more of the picture."""


def room_at_rest(name: str, *, baked_light: bool = True) -> WorldSnapshot:
    """Return a scene of the package as it begins, with light as far as it was baked, or without."""
    return SceneLibrary(baked_light=baked_light).snapshot(name)


def plausible_views(
    snapshot: WorldSnapshot,
    renderer: RenderBackend,
    seed: int | str,
    *,
    width: int,
    height: int,
    vertical_fov_deg: float = 58.0,
) -> Iterator[Camera]:
    """Choose cameras in a room: upright, at the height of eyes, each turned to an object."""
    contents = snapshot.contents
    boxes = np.array(
        [
            _box(drawn, pose)
            for drawn, pose in zip(contents.instances, snapshot.world_from_body, strict=True)
        ]
    )
    middles = boxes.mean(axis=1)
    floor = [drawn.instance.category == "floor" for drawn in contents.instances]
    low, high = boxes[floor][:, 0].min(axis=0) + 0.35, boxes[floor][:, 1].max(axis=0) - 0.35
    rng = np.random.default_rng([*str(seed).encode()])
    small = CameraIntrinsics(width=48, height=36, vertical_fov_deg=vertical_fov_deg)
    lens = CameraIntrinsics(width=width, height=height, vertical_fov_deg=vertical_fov_deg)
    while True:
        eye = np.array([*rng.uniform(low[:2], high[:2]), rng.uniform(*EYES_M)])
        target = middles[rng.integers(len(middles))] + rng.normal(0.0, 0.15, 3)
        if np.linalg.norm((target - eye)[:2]) < 0.6:
            continue
        pose = look_at(eye, target)
        camera = Camera(intrinsics=small, pose=pose)
        seen = renderer.render(RenderRequest(snapshot, camera, ("depth", "instance"))).views
        _, counts = np.unique(seen["instance"], return_counts=True)
        if seen["depth"].min() < NEAREST_M or counts.max() > LARGEST_SHARE * seen["depth"].size:
            continue
        yield Camera(intrinsics=lens, pose=pose)


def _box(drawn: DrawnInstance, pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (2, 3): lowest and highest corner [m]."""
    bounds = drawn.model.bounds() * np.asarray(drawn.scale)
    corners = np.array(
        [[bounds[i, 0], bounds[j, 1], bounds[k, 2]] for i, j, k in np.ndindex(2, 2, 2)]
    )
    world = corners @ pose[:3, :3].T + pose[:3, 3]
    return np.stack([world.min(axis=0), world.max(axis=0)])
