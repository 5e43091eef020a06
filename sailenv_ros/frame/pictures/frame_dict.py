"""One frame as the SAILenv client's dict: `main`, `category`, `object`, `flow`, `depth` and more.

A frame in, a plain dict of the caller's own arrays out. Knows no ROS.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.data import FrameData
from sailenv_ros.native.view_kernels import convert_views
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.labels import instance_colours
from sailenv_ros.types.views import VIEWS

__all__ = ["frame_dict"]

_NAMES = {"rgb": "main", "instance": "object"}
"""Names of views in the SAILenv client, where they differ from ours."""

_INSTANCE_BGRX: NDArray[np.uint32] = np.ascontiguousarray(
    cv2.cvtColor(instance_colours()[None], cv2.COLOR_RGB2BGRA)[0]
).view(np.uint32)[:, 0]


def frame_dict(frame: FrameData, *, copy: bool) -> dict[str, Any]:
    """Return a frame as a dict; see `Frame.to_dict`.

    Parameters
    ----------
    frame : FrameData
    copy : bool
        False writes into the frame's arrays and passes them on.

    Returns
    -------
    frame : dict
        Of the views that there are: ``main`` (H, W, 3) uint8 BGR; ``depth`` (H, W, 1) uint8, nearer
        is lighter, and ``depth_m`` (H, W) float32 [m]; ``category`` (H, W) uint8; ``instance``
        (H, W) uint16 and ``object`` (H, W, 3) uint8 BGR, one colour per instance; ``flow``
        (H, W, 2) float32 [px/s], 0 where ``flow_valid`` (H, W) bool is False; others by their
        names. Besides ``instances`` (the objects of this instant by their ids, `Frame.instances`),
        ``sizes`` (bytes of each view as received), ``deltaTime`` and ``dt`` [s],
        ``stamp_ns``, ``sequence``, ``scene``, ``render_s`` (wall time that rendering took),
        ``K`` (3, 3), the optical frame's ``world_from_camera`` (4, 4), and what
        `sailenv_ros.frame.motion` needs: ``camera``, ``states``, ``epoch``. ``lesson`` is the
        `LessonState`, None if the scene has no lessons. ``exposure`` has the picture's stops,
        ``row_poses`` a rolling shutter's `RowPoses` or None.
    """
    entries: dict[str, Any] = {}
    sizes: dict[str, int] = {}
    camera = frame.camera
    # Of a picture the channels change places, which makes another array anyway.
    views = {
        view: frame.views[view] if view == "rgb" else _own(frame.views[view], copy=copy)
        for view in VIEWS
        if view in frame.views
    }
    converted = _converted(views, camera.intrinsics.near_m, frame.depth_range_m)
    for view, values in views.items():
        sizes[_NAMES.get(view, view)] = values.nbytes
        entries.update(_entries(view, values, converted))
    entries.update(
        instances=frame.instances,
        sizes=sizes,
        deltaTime=frame.dt_ns * 1e-9,
        dt=frame.dt_ns * 1e-9,
        stamp_ns=frame.stamp_ns,
        sequence=frame.sequence,
        scene=frame.scene,
        render_s=frame.timings_s.get("render", 0.0),
        K=camera.intrinsics.K,
        world_from_camera=camera.world_from_camera.copy(),
        camera=camera,
        states=frame.states,
        epoch=frame.epoch,
        lesson=frame.lesson,
        exposure=frame.exposure,
        row_poses=frame.row_poses,
    )
    return entries


def _own(values: NDArray[Any], *, copy: bool) -> NDArray[Any]:
    """Return an array that may be written to."""
    if copy:
        return values.copy()
    values.flags.writeable = True
    return values


def _entries(
    view: str, values: NDArray[Any], converted: Mapping[str, NDArray[Any]]
) -> dict[str, NDArray[Any]]:
    """Return the dict's entries that come of a view."""
    if view == "rgb":
        return {"main": np.asarray(cv2.cvtColor(values, cv2.COLOR_RGB2BGR), np.uint8)}
    if view == "depth":
        return {"depth": converted["grey"][..., None], "depth_m": values}
    if view == "instance":
        return {"object": converted["object"], "instance": values}
    if view == "flow":
        return {"flow": converted["flow"], "flow_valid": converted["flow_valid"]}
    return {view: values}


def _converted(
    views: Mapping[str, NDArray[Any]], near_m: float, range_m: float
) -> dict[str, NDArray[Any]]:
    """Convert what the dict does not hold as it is sent; invalid flow becomes 0 in its place."""
    given = {
        view: np.ascontiguousarray(values)
        for view, values in views.items()
        if view in ("depth", "instance", "flow")
    }
    arrays = {view: values for view, values in given.items() if view == "flow"}
    return arrays | convert_views(
        given, near_m=near_m, range_m=range_m, colours=_INSTANCE_BGRX, threads=thread_count()
    )
