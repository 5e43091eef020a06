"""Values at a pixel of a frame, exactly as its arrays hold them, and the visible surface point.

A `Frame` and a pixel in; plain values for JSON, or world coordinates, out.
"""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.types.views import VIEWS
from sailenv_ros.viewer.messages import PixelValues

__all__ = ["pixel_of", "standing_point", "values_at"]

FAR_M = 6.0
"""Greatest distance at which an object is placed [m]; farther, or nowhere, becomes this
distance."""

OFF_WALL_M = 0.3
"""Room that is left before a wall [m]."""

OFF_FLOOR_M = 0.005

Vector = NDArray[np.float64]


def pixel_of(frame: Frame, u: object, v: object) -> tuple[int, int]:
    """Check a pixel's column and row.

    Raises
    ------
    InvalidRequest
        If it is none of the frame's.
    """
    width, height = frame.camera.intrinsics.width, frame.camera.intrinsics.height
    return checked_integer("column", u, 0, width - 1), checked_integer("row", v, 0, height - 1)


def values_at(frame: Frame, info: SceneInfo, u: int, v: int) -> PixelValues:
    """Return the values at a pixel, as the arrays have them.

    Parameters
    ----------
    frame : Frame
        Views that it has not are left out.
    info : SceneInfo
        For names.
    u, v : int
        Column and row [px].

    Returns
    -------
    values : PixelValues
        By the views' names: integers as they are; real numbers, None where one of them is not
        finite, and the text ``"near"`` for a depth nearer than the near plane. Beside
        ``category_id`` and ``instance_id`` these two are the names, empty for none.
    """
    result: dict[str, Any] = {"u": u, "v": v, "sequence": frame.sequence}
    for view, array in frame.views.items():
        value = array[v, u].tolist()
        display = VIEWS[view].display
        if display == "category":
            known = info.categories.get(value)
            result |= {f"{view}_id": value, view: known.name if known else ""}
        elif display == "instance":
            names = (instance.name for instance in info.instances if instance.id == value)
            result |= {f"{view}_id": value, view: next(names, "")}
        elif display == "depth" and math.isnan(value) and _is_seen(frame, u, v):
            result[view] = "near"
        else:
            result[view] = value if np.isfinite(value).all() else None
    return cast(PixelValues, result)  # named by the views


def standing_point(frame: Frame, u: int, v: int) -> tuple[float, float, float]:
    """Return the place in the world [m] where something can stand that is wanted at a pixel.

    On what is seen there; a bit before it where that is upright; at a distance ahead where nothing
    near is seen.

    Raises
    ------
    InvalidRequest
        If the lens sees nothing in front of the camera there.
    """
    camera = frame.camera
    if not np.isfinite(_optical(frame, u, v, 1.0)).all():
        raise InvalidRequest("pixel", (u, v), "one where the lens sees what is in front of it")
    depth = frame["depth"]
    at = float(depth[v, u])
    if not math.isfinite(at) or at > FAR_M:
        ahead = _optical(frame, u, v, FAR_M / 2.0)
        return _triple(camera.world_from_camera @ np.append(ahead, 1.0))
    point = camera.world_from_camera @ np.append(_optical(frame, u, v, at), 1.0)
    normal = camera.world_from_camera[:3, :3] @ _normal(frame, u, v)
    if abs(normal[2]) > 0.7:
        return _triple(point + np.array([0.0, 0.0, OFF_FLOOR_M, 0.0]))
    point[:3] += OFF_WALL_M * normal
    return _triple(point)


def _is_seen(frame: Frame, u: int, v: int) -> bool:
    return bool(np.isfinite(frame.camera.intrinsics.unit_rays_through((u, v))).all())


def _optical(frame: Frame, u: int, v: int, depth: float) -> Vector:
    return frame.camera.intrinsics.points_at((u, v), depth)


def _normal(frame: Frame, u: int, v: int) -> Vector:
    """Estimate the surface's normal from neighbours in the depth view; towards the camera."""
    depth = frame["depth"]
    rows, columns = depth.shape
    reach = 3
    left, right = max(0, u - reach), min(columns - 1, u + reach)
    top, bottom = max(0, v - reach), min(rows - 1, v + reach)
    across = _optical(frame, right, v, depth[v, right]) - _optical(frame, left, v, depth[v, left])
    down = _optical(frame, u, bottom, depth[bottom, u]) - _optical(frame, u, top, depth[top, u])
    normal = np.cross(down, across)
    length = float(np.linalg.norm(normal))
    if not math.isfinite(length) or length < 1e-12:
        return np.array([0.0, 0.0, -1.0])
    ray = _optical(frame, u, v, 1.0)
    return normal / (length if normal @ ray < 0.0 else -length)


def _triple(point: Vector) -> tuple[float, float, float]:
    return float(point[0]), float(point[1]), float(point[2])
