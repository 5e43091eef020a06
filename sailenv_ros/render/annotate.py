"""From what the geometry pass left of each pixel to the ground-truth views.

The geometry pass leaves the depth along the optical axis and the instance id. Everything else
(category, what lies nearer than near, optical flow, occlusion) follows by arithmetic in one walk
over the pixels. Both back ends share it, so their ground truth has one definition.

Optical flow is the motion field of rigid bodies. A surface point at X = Z (x, y, 1) in the
camera's optical frame was at X + D X (D = T - 1, homogeneous) in the previous frame's optical
frame, where T = camera_from_world' world_from_body' body_from_world world_from_camera with the
primed factors of then. Its displacement since then, p_t - p_(t-1), is

    f (x dZ - dX) / (Z + dZ),   f (y dZ - dY) / (Z + dZ),   (dX, dY, dZ) = D X

which is exactly 0 where D is, and whose rounding error is relative to the flow itself. Points at
infinity have X = (x, y, 1) without translation.
"""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.frame import VIEWS
from sailenv_ros.geometry import invert
from sailenv_ros.render.bands import Bands, alone
from sailenv_ros.snapshot import Observation, WorldSnapshot

__all__ = ["OCCLUSION_TOLERANCE", "annotate", "motion_table", "warm_up"]

OCCLUSION_TOLERANCE = 0.01
"""Share of its depth by which a point must lie behind all four nearest pixels of the previous
frame to count as hidden there: a slanted surface differs by less within one pixel up to about
80 degrees at common fields of view, and thin gaps smaller than this are not told apart."""

_NO_ROW = 0
_SKY_ROW = 1
_FIRST_BODY_ROW = 2

_NOTHING: NDArray[Any] = np.zeros((0, 0), dtype=np.float32)


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
        bodies = snapshot.world_from_body[now_rows]
        past_bodies = past.world_from_body[past_rows]
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
    bands: Bands = alone,
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
    bands : Bands
        Runs the walk.

    Returns
    -------
    views : dict of str to array
        Fresh arrays.
    """
    height, width = surface.shape[:2]
    wanted = (views & {"category", "instance", "flow", "flow_valid", "occlusion"}) | {"depth"}
    arrays: dict[str, NDArray[Any]] = {}
    for name in wanted:
        spec = VIEWS[name]
        arrays[name] = np.empty(spec.shape(height, width), spec.dtype)
    rows, motions = motion_table(snapshot, previous, camera)
    dt_s = 1.0
    past_depth = _NOTHING
    if previous is not None:
        dt_s = (snapshot.sim_time_ns - previous.snapshot.sim_time_ns) * 1e-9
        if "occlusion" in wanted and previous.depth is not None:
            past_depth = previous.depth
    intrinsics = camera.intrinsics
    same_lens = previous is None or previous.camera.intrinsics == intrinsics
    if not same_lens:
        rows = np.zeros_like(rows)
    given = (
        surface,
        snapshot.contents.category_of_instance,
        rows,
        motions,
        _lens(intrinsics),
        dt_s if dt_s > 0.0 else 1.0,
        past_depth,
        arrays["depth"],
        *(arrays.get(name, _EMPTY[name]) for name in _OPTIONAL),
    )
    bands(lambda first, last: _walk(first, last, *given), height)
    return arrays


def warm_up() -> None:
    """Compile the kernel now (or load it from numba's cache), not at the first frame."""
    _walk(
        0,
        1,
        np.zeros((1, 1, 2), np.float32),
        np.zeros(1, np.uint8),
        np.zeros(1, np.uint16),
        np.zeros((1, 3, 4)),
        _lens(CameraIntrinsics(width=8, height=8)),
        1.0,
        _NOTHING,
        np.zeros((1, 1), np.float32),
        *(_EMPTY[name] for name in _OPTIONAL),
    )


_OPTIONAL = ("category", "instance", "flow", "flow_valid", "occlusion")
"""What the walk makes if it is wanted, in its order."""

_EMPTY: dict[str, NDArray[Any]] = {
    name: np.zeros((0,) * (2 if spec.channels == 1 else 3), spec.dtype)
    for name, spec in VIEWS.items()
}


def _lens(intrinsics: CameraIntrinsics) -> NDArray[np.float64]:
    return np.array(
        [intrinsics.fx, intrinsics.cx, intrinsics.cy, intrinsics.near_m, intrinsics.far_m]
    )


@numba.njit(cache=True, nogil=True)
def _walk(  # type: ignore[no-untyped-def]  # compiled; the caller above says what each is
    first,
    last,
    surface,
    category_of_instance,
    row_of_instance,
    motions,
    lens,
    dt_s,
    past_depth,
    depth,
    category,
    instance,
    flow,
    flow_valid,
    occlusion,
):
    focal, cx, cy, near, far = lens
    scale = focal / dt_s
    with_category, with_instance = category.size > 0, instance.size > 0
    with_flow, with_valid, with_occlusion = flow.size > 0, flow_valid.size > 0, occlusion.size > 0
    with_motion = with_flow or with_valid or with_occlusion
    for v in range(first, last):
        y = (v - cy) / focal
        for u in range(surface.shape[1]):
            z_seen = np.float64(surface[v, u, 0])
            beyond = z_seen > far
            z = np.inf if beyond else z_seen
            id_ = 0 if beyond else int(surface[v, u, 1])
            too_near = z < near
            depth[v, u] = np.nan if too_near else z
            if with_category:
                category[v, u] = category_of_instance[id_]
            if with_instance:
                instance[v, u] = id_
            if not with_motion:
                continue
            row = row_of_instance[id_]
            x = (u - cx) / focal
            at_infinity = z == np.inf
            reach = 1.0 if at_infinity else z
            shift = 0.0 if at_infinity else 1.0
            m = motions[row]
            dx = reach * (m[0, 0] * x + m[0, 1] * y + m[0, 2]) + shift * m[0, 3]
            dy = reach * (m[1, 0] * x + m[1, 1] * y + m[1, 2]) + shift * m[1, 3]
            dz = reach * (m[2, 0] * x + m[2, 1] * y + m[2, 2]) + shift * m[2, 3]
            z_past = reach + dz
            valid = row != 0 and z_past > 0.0 and not too_near
            if valid:
                fu = (x * dz - dx) / z_past
                fv = (y * dz - dy) / z_past
            else:
                fu = np.nan
                fv = np.nan
            if with_flow:
                flow[v, u, 0] = scale * fu
                flow[v, u, 1] = scale * fv
            if with_valid:
                flow_valid[v, u] = valid
            if with_occlusion:
                hidden = True
                if valid:
                    u_past, v_past = u - focal * fu, v - focal * fv
                    hidden = _hidden(past_depth, u_past, v_past, np.inf if at_infinity else z_past)
                occlusion[v, u] = hidden


@numba.njit(cache=True, nogil=True)
def _hidden(past_depth, u, v, z):  # type: ignore[no-untyped-def]  # compiled
    """Tell whether a point at (u, v), depth z of the previous frame was not visible there."""
    rows, columns = past_depth.shape
    if not (-0.5 <= u <= columns - 0.5 and -0.5 <= v <= rows - 0.5):
        return True
    # Within rounding of a pixel's centre that pixel alone decides, so a still picture agrees
    # with itself; between centres any of the four around may have seen the point.
    u_low, v_low = int(np.floor(u + 1e-3)), int(np.floor(v + 1e-3))
    u_high, v_high = int(np.ceil(u - 1e-3)), int(np.ceil(v - 1e-3))
    for vi in (v_low, v_high):
        for ui in (u_low, u_high):
            seen = past_depth[min(max(vi, 0), rows - 1), min(max(ui, 0), columns - 1)]
            if seen == z or seen > z * (1.0 - OCCLUSION_TOLERANCE):
                return False
    return True
