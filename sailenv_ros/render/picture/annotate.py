"""From what the geometry pass left of each pixel to the ground-truth views.

The geometry pass leaves the depth along the optical axis and the instance id. Everything else
(category, what lies nearer than near, optical flow, occlusion) follows by arithmetic in one kernel
(`annotate_pixels`). All back ends share it, so their ground truth has one definition.

Optical flow is the motion field of rigid bodies. A surface point at X = Z (x, y, 1) in the
camera's optical frame was at X + D X (D = T - 1, homogeneous) in the previous frame's optical
frame, where T = camera_from_world' world_from_body' body_from_world world_from_camera with the
primed factors of then. Its displacement since then, p_t - p_(t-1), is

    f (x dZ - dX) / (Z + dZ),   f (y dZ - dY) / (Z + dZ),   (dX, dY, dZ) = D X

which is exactly 0 where D is, and whose rounding error is relative to the flow itself. Points at
infinity have X = (x, y, 1) without translation.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.native.annotation import annotate_pixels
from sailenv_ros.native.motion_kernels import transform_points
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import invert
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS, views_of

__all__ = ["OCCLUSION_TOLERANCE", "annotate", "motion_table"]

OCCLUSION_TOLERANCE = 0.01
"""Share of its depth by which a point must lie behind all four nearest pixels of the previous
frame to count as hidden there: a slanted surface differs by less within one pixel up to about
80 degrees at common fields of view, and thin gaps smaller than this are not told apart."""

_NO_CATEGORIES = np.zeros(65536, np.uint8)

_NO_ROW = 0
_SKY_ROW = 1
_FIRST_BODY_ROW = 2


def motion_table(
    snapshot: WorldSnapshot, previous: Observation | None, camera: Camera
) -> tuple[NDArray[np.uint16], NDArray[np.float64]]:
    """Compute D for every instance that has a past.

    Returns
    -------
    row_of_instance : (65536,) uint16
        Row in `motions` of each instance id: 0 for what has no past; id 0 is the sky's.
    motions : (R, 3, 4) float64
        D of the docstring above; exactly 0 where neither camera nor body has moved a bit.
    """
    row_of_instance = np.zeros(65536, dtype=np.uint16)
    if previous is None or previous.snapshot.contents.epoch != snapshot.contents.epoch:
        return row_of_instance, np.zeros((1, 3, 4))
    past = previous.snapshot
    known = {id_: row for row, id_ in enumerate(past.contents.instance_ids.tolist())}
    now_rows: list[int] = []
    past_rows: list[int] = []
    for row, id_ in enumerate(snapshot.contents.instance_ids.tolist()):
        past_row = known.get(id_)
        if past_row is not None and past.histories[past_row] == snapshot.histories[row]:
            row_of_instance[id_] = _FIRST_BODY_ROW + len(now_rows)
            now_rows.append(row)
            past_rows.append(past_row)
    row_of_instance[0] = _SKY_ROW
    motions = np.zeros((_FIRST_BODY_ROW + len(now_rows), 3, 4))
    camera_still = np.array_equal(previous.camera.camera_from_world, camera.camera_from_world)
    if not camera_still:
        turn = previous.camera.camera_from_world[:3, :3] @ camera.world_from_camera[:3, :3]
        motions[_SKY_ROW, :, :3] = turn - np.eye(3)
    if now_rows:
        bodies, past_bodies = snapshot.world_from_body, past.world_from_body
        if not len(bodies) == len(past_bodies) == len(now_rows) or now_rows != past_rows:
            bodies, past_bodies = bodies[now_rows], past_bodies[past_rows]
        chain = previous.camera.camera_from_world @ past_bodies @ invert(bodies)
        motion = (chain @ camera.world_from_camera)[:, :3] - np.eye(4)[:3]
        if camera_still:
            # Rounding must not make a still world move.
            still = (bodies == past_bodies).all(axis=(1, 2))
            motion[still] = 0.0
        motions[_FIRST_BODY_ROW:] = motion
    return row_of_instance, motions


def annotate(
    surface: NDArray[np.float32],
    snapshot: WorldSnapshot,
    previous: Observation | None,
    camera: Camera,
    views: frozenset[str],
    threads: int = 1,
) -> dict[str, NDArray[Any]]:
    """Make the ground-truth views.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id.
    snapshot, previous, camera
        As `RenderBackend.render` takes them. `previous.depth` must be there for ``occlusion``.
    views : frozenset of str
        Which to make; others than ground truth made here are left out. ``depth`` always is.
    threads : int
        The views do not depend on it.

    Returns
    -------
    views : dict of str to array
        Fresh arrays.
    """
    height, width = surface.shape[:2]
    wanted = (views & frozenset(views_of("annotation"))) | {"depth"}
    # Ids of more than eight bits are looked up afterwards, by the instance.
    wide = "category" in wanted and snapshot.contents.categories.dtype != VIEWS["category"].dtype
    made = (wanted - {"category"}) | {"instance"} if wide else wanted
    arrays: dict[str, NDArray[Any]] = {}
    for name in made:
        spec = VIEWS[name]
        arrays[name] = np.empty(spec.shape(height, width), spec.dtype)
    moves = any(VIEWS[name].needs_past for name in wanted)
    rows, motions = motion_table(snapshot, previous if moves else None, camera)
    dt_s = 1.0
    past_depth: NDArray[np.float32] | None = None
    if previous is not None:
        dt_s = (snapshot.sim_time_ns - previous.snapshot.sim_time_ns) * 1e-9
        if "occlusion" in wanted and previous.depth is not None:
            past_depth = np.ascontiguousarray(previous.depth)
    places = arrays.pop("object_coords", None)
    if places is not None:
        arrays.setdefault("instance", np.empty((height, width), np.uint16))
    intrinsics = camera.intrinsics
    if previous is not None and previous.camera.intrinsics != intrinsics:
        rows = np.zeros_like(rows)
    annotate_pixels(
        np.ascontiguousarray(surface),
        _NO_CATEGORIES if wide else snapshot.contents.category_of_instance,
        rows,
        motions,
        _lens(intrinsics),
        dt_s if dt_s > 0.0 else 1.0,
        OCCLUSION_TOLERANCE,
        past_depth,
        arrays,
        threads=threads,
    )
    if wide:
        arrays["category"] = snapshot.contents.category_of_instance[arrays["instance"]]
    if places is not None:
        arrays["object_coords"] = _object_coords(arrays, snapshot, camera, threads)
    return {name: arrays[name] for name in wanted}


def _object_coords(
    arrays: Mapping[str, NDArray[Any]], snapshot: WorldSnapshot, camera: Camera, threads: int
) -> NDArray[np.float32]:
    """Return each pixel's surface point in its instance's own frame."""
    ids = snapshot.contents.instance_ids
    rows = np.zeros(65536, np.uint16)
    rows[ids] = np.arange(1, len(ids) + 1)
    transforms = np.zeros((len(ids) + 1, 3, 4))
    if len(ids):
        transforms[1:] = (invert(snapshot.world_from_body) @ camera.world_from_camera)[:, :3]
    return transform_points(
        *(arrays["depth"], arrays["instance"], rows, transforms),
        _lens(camera.intrinsics),
        threads=threads,
    )


def _lens(intrinsics: CameraIntrinsics) -> NDArray[np.float64]:
    return np.array(
        [intrinsics.fx, intrinsics.cx, intrinsics.cy, intrinsics.near_m, intrinsics.far_m]
    )
