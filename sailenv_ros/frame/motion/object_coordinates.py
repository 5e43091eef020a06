"""Surface points in their instances' own frames, of a frame that was rendered without that view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.motion.deforming_motion import object_points
from sailenv_ros.frame.motion.frame_state import AnyFrame, frame_state_of
from sailenv_ros.system.threads import thread_count

__all__ = ["object_coordinates"]


def object_coordinates(frame: AnyFrame) -> NDArray[np.float32]:
    """Return the view ``object_coords`` of a frame that has depth and instance ids.

    Returns
    -------
    points : (H, W, 3) float32
        Surface point in its instance's own frame [m], of what deforms at rest; nan where nothing
        was hit.

    Raises
    ------
    InvalidRequest
        If the frame lacks one of the views or the states of its instances.
    """
    moment = frame_state_of(frame)
    depth, instance = moment.surfaces("frame")
    return object_points(depth, instance, moment.observed_poses(), threads=thread_count())
