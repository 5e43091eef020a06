"""From what the geometry pass left of each pixel to the ground-truth views.

The geometry pass leaves the depth along the optical axis and the instance id. Everything else
(category, what lies nearer than near, optical flow, occlusion) follows by arithmetic in kernels.
All renderers share it, so their ground truth has one definition.

Optical flow is the motion field of rigid bodies: the motion from this frame to the previous one
(`rigid_motion`), over the time between them, which is negative.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import (
    bent_lenses,
    depth_shares,
    ray_lengths,
    reach_view,
    tells_depth,
)
from sailenv_ros.frame.motion.deforming_motion import object_points, surface_motions
from sailenv_ros.frame.motion.rigid_motion import (
    OCCLUSION_TOLERANCE,
    DeformedInstance,
    ObservedPoses,
    motion_table,
)
from sailenv_ros.frame.motion.rolling_motion import rolling_table
from sailenv_ros.native.motion_kernels import move_points
from sailenv_ros.native.view_kernels import annotate_pixels
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.types.views import VIEWS, views_of

__all__ = ["POINT_VIEWS", "annotate", "with_depth"]

_NO_CATEGORIES = np.zeros(65536, np.uint8)

_MOTION_OUTPUTS = {"flow": "flow", "flow_valid": "valid", "occlusion": "hidden"}
"""Views of the motion to the previous frame, as `move_points` calls them."""

POINT_VIEWS = frozenset({*_MOTION_OUTPUTS, "object_coords"})
"""Views for which the points of surfaces that deform are looked for."""


def annotate(
    surface: NDArray[np.float32],
    snapshot: WorldSnapshot,
    previous: Observation | None,
    camera: Camera,
    views: frozenset[str],
    threads: int = 1,
    *,
    rows: RowPoses | None = None,
    places: NDArray[np.void] | None = None,
) -> dict[str, NDArray[Any]]:
    """Make the ground-truth views.

    Parameters
    ----------
    surface : (H, W, 2) float32
        Depth along the optical axis [m], ``inf`` where nothing was hit, and the instance id;
        through a lens that bends straight lines the distance along the ray.
    snapshot, previous, camera
        As `RenderBackend.render` takes them. `previous.depth` must be there for ``occlusion``.
    views : frozenset of str
        Which to make; others than ground truth made here are left out. ``depth`` always is.
    threads : int
        The views do not depend on it.
    rows : RowPoses or None
        As `RenderBackend.render` takes them.
    places : (H, W) TRIANGLE_PLACE or None
        As `Drawing.picture` makes them; None looks for the triangles of what deforms.

    Returns
    -------
    views : dict of str to array
        Fresh arrays.
    """
    height, width = surface.shape[:2]
    wanted = (views & frozenset(views_of("annotation"))) | {"depth"}
    # Ids of more than eight bits are looked up afterwards, by the instance.
    wide = "category" in wanted and snapshot.contents.categories.dtype != VIEWS["category"].dtype
    arrays: dict[str, NDArray[Any]] = {}
    lens = camera.intrinsics
    for name in wanted - {"object_coords"} - ({"category"} if wide else frozenset()):
        arrays[name] = np.empty(VIEWS[name].shape(height, width), VIEWS[name].dtype)
    if wanted - {"depth", "category"} or wide:
        arrays.setdefault("instance", np.empty((height, width), np.uint16))
    straight = tells_depth(lens)
    if not straight:
        arrays.setdefault("range", np.empty((height, width), np.float32))
    made = ("depth", "category", "instance", *(() if straight else ("range",)))
    annotate_pixels(
        np.ascontiguousarray(surface),
        _NO_CATEGORIES if wide else snapshot.contents.category_of_instance,
        lens.lens_record,
        {name: arrays[name] for name in made if name in arrays},
        along=None if straight else depth_shares(lens),
        threads=threads,
    )
    if "range" in wanted and lens.is_parallel:
        arrays["range"][:] = arrays["depth"]
    elif "range" in wanted and straight:
        # In double precision, rounded at the end.
        np.multiply(arrays["depth"], ray_lengths(lens), out=arrays["range"], casting="same_kind")
    if "lens_valid" in wanted:
        arrays["lens_valid"][:] = True if straight else ~np.isnan(depth_shares(lens))
    now = _poses_of(Observation(snapshot=snapshot, camera=camera, rows=rows))
    moved = {key: arrays[view] for view, key in _MOTION_OUTPUTS.items() if view in arrays}
    if moved:
        _add_motion(arrays, moved, snapshot, previous, now, threads, places)
    if wide:
        arrays["category"] = snapshot.contents.category_of_instance[arrays["instance"]]
    if "object_coords" in wanted:
        arrays["object_coords"] = object_points(
            *(arrays[reach_view(lens)], arrays["instance"], now), threads=threads, places=places
        )
    return {name: arrays[name] for name in wanted}


def with_depth(previous: Observation, surface: NDArray[np.float32]) -> Observation:
    """Return an earlier observation with the depth view that it was not asked for.

    Parameters
    ----------
    previous : Observation
    surface : (H, W, 2) float32
        As `annotate` takes it, drawn again from the poses of then.
    """
    reach = reach_view(previous.camera.intrinsics)
    truth = annotate(surface, previous.snapshot, None, previous.camera, frozenset({reach}))
    return replace(previous, depth=truth[reach])


def _poses_of(observed: Observation) -> ObservedPoses:
    snapshot = observed.snapshot
    shapes = snapshot.deformations
    scales = (
        {drawn.instance.id: drawn.scale for drawn in snapshot.contents.instances if drawn.deforms}
        if shapes
        else {}
    )
    return ObservedPoses(
        camera=observed.camera,
        ids=snapshot.contents.instance_ids,
        world_from_instance=snapshot.world_from_body,
        histories=snapshot.histories,
        rows=observed.rows,
        surfaces={key: DeformedInstance(shape, scales[key]) for key, shape in shapes.items()},
    )


def _add_motion(
    arrays: dict[str, NDArray[Any]],
    moved: dict[str, NDArray[Any]],
    snapshot: WorldSnapshot,
    previous: Observation | None,
    now: ObservedPoses,
    threads: int,
    places: NDArray[np.void] | None,
) -> None:
    """Fill in the views of the motion to the previous frame; without one nothing has moved."""
    lens = now.camera.intrinsics
    if (
        previous is None
        or previous.snapshot.contents.epoch != snapshot.contents.epoch
        or previous.camera.intrinsics != lens
    ):
        unknown = {"flow": np.nan, "valid": False, "hidden": True}
        for name, array in moved.items():
            array[:] = unknown[name]
        return
    past = _poses_of(previous)
    rolls = now.rows is not None or past.rows is not None
    table = rolling_table(now, past) if rolls else motion_table(now, past)
    duration_s = (previous.snapshot.sim_time_ns - snapshot.sim_time_ns) * 1e-9
    depth = previous.depth if "hidden" in moved else None
    reach = arrays[reach_view(lens)]
    surfaces = surface_motions(
        *(reach, arrays["instance"], now, past, table), threads=threads, places=places
    )
    move_points(
        reach,
        arrays["instance"],
        table.row_of_instance,
        table.motions,
        None,
        lens.lens_record,
        previous.camera.intrinsics.lens_record,
        None if depth is None else np.ascontiguousarray(depth),
        None,
        OCCLUSION_TOLERANCE,
        moved,
        bent=bent_lenses(lens, previous.camera.intrinsics),
        by_rows=table.by_rows,
        surfaces=surfaces,
        duration_s=duration_s if duration_s < 0.0 else -1.0,
        threads=threads,
    )
