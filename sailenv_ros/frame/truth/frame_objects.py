"""`FrameData` → `ObjectTable`, and its objects' keypoints."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.data import FrameData
from sailenv_ros.frame.lens_rays import reach_of, reach_of_points
from sailenv_ros.frame.truth.object_table import (
    CORNER_SIGNS,
    Keypoints,
    ObjectTable,
    corner_keypoints,
)
from sailenv_ros.frame.truth.person_points import person_points
from sailenv_ros.frame.truth.visible_parts import VisibleParts, visible_parts
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.scene_info import InstanceColumns, SceneInfo

__all__ = ["HIDDEN_BEHIND", "keypoints_of", "objects_of"]

HIDDEN_BEHIND = 0.01
"""Share of its depth by which a point lies behind what is seen at its pixel if that hides it."""


def objects_of(frame: FrameData) -> ObjectTable:
    """Make the table of a frame's objects.

    Raises
    ------
    InvalidState
        If the scene of the frame's instant is not known.
    """
    if frame.info is None:
        raise InvalidState("the frame's scene_info was not recorded, so its objects are not known")
    info = frame.info
    known = info.instance_columns
    count = len(known.ids)
    seen = _seen(frame)
    rows = np.searchsorted(known.ids, seen.ids)
    there = rows < count
    there[there] = known.ids[rows[there]] == seen.ids[there]
    rows = rows[there]
    pixels, boxes = np.zeros(count, np.int64), np.full((count, 4), -1, np.int32)
    flow = np.full((count, 2), np.nan)
    pixels[rows], boxes[rows], flow[rows] = (
        seen.pixels[there],
        seen.corners[there],
        seen.flow[there],
    )
    world, linear, angular = _motion(frame, known.ids)
    camera = frame.camera.camera_from_world @ world
    low, high = _boxes(frame, known)
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    own = middle[:, None] + half[:, None] * CORNER_SIGNS
    optical = _moved(camera, own)
    projected = frame.camera.intrinsics.project(optical)
    centres = _moved(camera, middle[:, None])[:, 0]
    unknown = np.full(count, -1, np.int64)
    none = np.full((count, 4), -1, np.int32)
    return ObjectTable(
        ids=known.ids,
        names=known.names,
        categories=known.categories,
        assets=known.assets,
        category_ids=known.category_ids,
        parents=known.parents,
        static=known.static,
        visible_pixels=pixels,
        visible_boxes=boxes,
        flow=flow,
        amodal_pixels=unknown,
        amodal_boxes=none,
        whole_pixels=unknown,
        whole_boxes=none,
        world_from_object=world,
        camera_from_object=camera,
        box_centres=_moved(world, middle[:, None])[:, 0],
        box_sizes=high - low,
        corners=_moved(world, own),
        corner_pixels=projected,
        corners_visible=_is_visible(frame, optical, projected),
        distances=np.linalg.norm(centres, axis=1),
        linear_velocities=linear,
        angular_velocities=angular,
    )


def keypoints_of(frame: FrameData, table: ObjectTable, instance_id: int) -> Keypoints:
    """Return the named points of an object; the corners of its box if its asset names none.

    Parameters
    ----------
    frame : FrameData
    table : ObjectTable
        The table of that frame, by `objects_of`.
    instance_id : int

    Raises
    ------
    InvalidRequest
        If there is no object of that id.
    InvalidState
        If the scene of the frame's instant is not known.
    """
    row = table.row(instance_id)
    info = _info(frame)
    skeletons = {} if frame.states is None else frame.states.skeletons
    own = skeletons.get(instance_id)
    if own is not None and own.point_names:
        return person_points(frame, instance_id, own.point_names, own.points)
    instance = next(one for one in info.instances if one.id == instance_id)
    points = instance.keypoints or corner_keypoints(instance.low_m, instance.high_m)
    places = np.array([point.position_m for point in points])[None]
    optical = _moved(table.camera_from_object[row : row + 1], places)
    pixels = frame.camera.intrinsics.project(optical)
    visible = _is_visible(frame, optical, pixels)[0]
    return Keypoints(
        names=tuple(point.name for point in points),
        world=_moved(table.world_from_object[row : row + 1], places)[0],
        pixels=pixels[0],
        visible=visible,
        hidden_by=_hidden_by(frame, pixels[0], visible),
    )


def _hidden_by(
    frame: FrameData, pixels: NDArray[np.float64], visible: NDArray[np.bool_]
) -> NDArray[np.int64]:
    """Return (K,): ids of what hides points that are not seen; 0 and -1 as `Keypoints` says."""
    lens = frame.camera.intrinsics
    with np.errstate(invalid="ignore"):
        u, v = np.rint(pixels[:, 0]), np.rint(pixels[:, 1])
        inside = (u >= 0) & (u < lens.width) & (v >= 0) & (v < lens.height)
    found = np.full(len(pixels), -1, np.int64)
    if "instance" in frame.views:
        at = v[inside].astype(np.intp), u[inside].astype(np.intp)
        found[inside] = frame["instance"][at]
    found[visible] = 0
    return found


def _boxes(
    frame: FrameData, known: InstanceColumns
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return (N, 3) lowest and highest corners in their own frames, of what deforms as it is."""
    states = frame.states
    if states is None or not states.deformations:
        return known.low_m, known.high_m
    low, high = known.low_m.copy(), known.high_m.copy()
    for id_, shape in states.deformations.items():
        at = int(np.searchsorted(known.ids, id_))
        if at < len(known.ids) and known.ids[at] == id_:
            low[at], high[at] = shape.bounds * states.scales[states.row(id_)]
    return low, high


def _info(frame: FrameData) -> SceneInfo:
    assert frame.info is not None
    return frame.info


def _seen(frame: FrameData) -> VisibleParts:
    if "instance" not in frame.views:
        return visible_parts(np.zeros((1, 1), np.uint16))
    return visible_parts(frame["instance"], frame.views.get("flow"))


def _motion(
    frame: FrameData, ids: NDArray[np.uint16]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Return world_from_object, linear and angular velocity of each; NaN where not known."""
    count, states = len(ids), frame.states
    if states is not None and np.array_equal(states.ids, ids):
        return states.matrices, states.linear_velocities, states.angular_velocities
    world = np.full((count, 4, 4), np.nan)
    linear, angular = np.full((count, 3), np.nan), np.full((count, 3), np.nan)
    if states is not None:
        from_rows = states.row_of_id[ids]
        known = from_rows >= 0
        world[known] = states.matrices[from_rows[known]]
        linear[known] = states.linear_velocities[from_rows[known]]
        angular[known] = states.angular_velocities[from_rows[known]]
    return world, linear, angular


def _moved(transforms: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (N, K, 3) points, each moved by the (N, 4, 4) transform of its row."""
    moved: NDArray[np.float64] = (
        points @ transforms[:, :3, :3].transpose(0, 2, 1) + transforms[:, None, :3, 3]
    )
    return moved


def _is_visible(
    frame: FrameData, optical: NDArray[np.float64], pixels: NDArray[np.float64]
) -> NDArray[np.bool_]:
    """Return which points of the optical frame lie in the picture with nothing before them."""
    lens: CameraIntrinsics = frame.camera.intrinsics
    depths = reach_of_points(optical, lens)
    with np.errstate(invalid="ignore"):
        u, v = np.rint(pixels[..., 0]), np.rint(pixels[..., 1])
        inside = (u >= 0) & (u < lens.width) & (v >= 0) & (v < lens.height)
        inside &= (depths >= lens.near_m) & (depths <= lens.far_m)
    view = reach_of(frame.views, lens)
    if view is None:
        return np.zeros(depths.shape, bool)
    columns, rows = np.where(inside, u, 0).astype(np.intp), np.where(inside, v, 0).astype(np.intp)
    with np.errstate(invalid="ignore"):
        open_to_view = view[rows, columns] >= depths * (1.0 - HIDDEN_BEHIND)
    return inside & open_to_view
