"""The motion from one frame to another: flow, scene flow, and what is not seen any more.

Two frames of one scene in, whatever their order, gap and cameras; arrays of the first one's pixels
out. Arithmetic on depth, ids and poses: no picture is rendered.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.lens_rays import bent_lenses
from sailenv_ros.frame.motion.deforming_motion import surface_motions
from sailenv_ros.frame.motion.frame_state import AnyFrame, frame_state_of, require_common_past
from sailenv_ros.frame.motion.rigid_motion import OCCLUSION_TOLERANCE, motion_table
from sailenv_ros.native.motion_kernels import MOTION_OUTPUTS, move_points
from sailenv_ros.system.threads import thread_count

__all__ = ["Motion", "motion"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Motion:
    """Motion of the visible surface points of one frame to another frame.

    All arrays are of the first frame's pixels, and the caller's own. Of each pixel whose motion is
    known exactly one is true: `visible`, `occluded`, `out_of_view`.

    Attributes
    ----------
    flow : (H, W, 2) float32
        From the pixel to the point's place in the other frame's picture [px], u right, v down.
        Exactly 0 where neither point nor camera has moved; nan where it does not exist.
    scene_flow : (H, W, 3) float32
        Displacement of the surface point in the world, in the axes of the first frame's optical
        frame [m]. Exactly 0 where the point has not moved, whatever the camera does; nan where
        there is no surface, or its motion is not known.
    valid : (H, W) bool
        Where `flow` exists: the surface is known (its depth is not nan), its instance is there in
        both frames with one history (it was not spawned, despawned or teleported in between), and
        the point is in front of the other camera. The background has flow by the camera's turn;
        where the other's rays are parallel only if the camera rests.
    occluded : (H, W) bool
        The point is within the other frame's picture, which shows another surface there.
    out_of_view : (H, W) bool
        The point is not within the other frame's picture: beside it, behind its camera, or beyond
        its far plane.
    duration_s : float
        Simulated time from the first frame to the other [s]; negative for backward motion.
    """

    flow: NDArray[np.float32]
    scene_flow: NDArray[np.float32]
    valid: NDArray[np.bool_]
    occluded: NDArray[np.bool_]
    out_of_view: NDArray[np.bool_]
    duration_s: float

    @property
    def visible(self) -> NDArray[np.bool_]:
        """(H, W) bool: where the other frame shows the same surface point; a new array."""
        return self.valid & ~self.occluded & ~self.out_of_view


def motion(begin: AnyFrame, end: AnyFrame) -> Motion:
    """Return the motion from one frame to another.

    Parameters
    ----------
    begin, end : Frame or dict
        Of one epoch of one scene, in any order of time, of the same camera or of two; live or
        recorded, also as `Agent.get_frame` gives them. Both need the views ``depth`` and
        ``instance``; through a lens that sees to the side ``range``, too.

    Returns
    -------
    motion : Motion
        Of the pixels of `begin`. ``motion(end, begin)`` is the other direction.

    Raises
    ------
    InvalidRequest
        If a frame lacks one of the views or the states of its instances (version 0.2.0 did not
        record them), or they are of different scenes or epochs.

    Notes
    -----
    A point counts as occluded if none of the four pixels around its place in the other picture is
    of its instance and not nearer than the point by more than 1 % of its depth.
    """
    first, last = frame_state_of(begin, "first frame"), frame_state_of(end, "other frame")
    require_common_past(first, last)
    begin_poses, end_poses = first.observed_poses(), last.observed_poses()
    table = motion_table(begin_poses, end_poses)
    depth, instance = first.surfaces("first frame")
    to_depth, to_instance = last.surfaces("other frame")
    names = ("flow", "scene_flow", "valid", "occluded", "out_of_view")
    found = {
        name: np.empty((*depth.shape, *channels), dtype)
        for name, (dtype, channels) in MOTION_OUTPUTS.items()
        if name in names
    }
    move_points(
        depth,
        instance,
        table.row_of_instance,
        table.motions,
        table.displacements,
        first.camera.intrinsics.lens_record,
        last.camera.intrinsics.lens_record,
        to_depth,
        to_instance,
        OCCLUSION_TOLERANCE,
        found,
        bent=bent_lenses(first.camera.intrinsics, last.camera.intrinsics),
        surfaces=surface_motions(
            depth, instance, begin_poses, end_poses, table, threads=thread_count()
        ),
        threads=thread_count(),
    )
    return Motion(duration_s=(last.stamp_ns - first.stamp_ns) * 1e-9, **found)
