"""Surface points in their instances' own frames, of a frame that was rendered without that view."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.frame.motion.moments import AnyFrame, moment_of
from sailenv_ros.frame.motion.motion_tables import lens_numbers
from sailenv_ros.native.library import thread_count
from sailenv_ros.native.motion_kernels import transform_points
from sailenv_ros.types.geometry import invert

__all__ = ["object_coordinates"]


def object_coordinates(frame: AnyFrame) -> NDArray[np.float32]:
    """Return the view ``object_coords`` of a frame that has depth and instance ids.

    Returns
    -------
    points : (H, W, 3) float32
        Surface point in its instance's own frame [m]; nan where nothing was hit.

    Raises
    ------
    InvalidRequest
        If the frame lacks one of the views or the states of its instances.
    """
    moment = moment_of(frame)
    states, camera = moment.states, moment.camera
    rows = np.zeros(65536, np.uint16)
    rows[states.ids] = np.arange(1, len(states) + 1)
    transforms = np.zeros((len(states) + 1, 3, 4))
    if len(states):
        transforms[1:] = (invert(states.matrices) @ camera.world_from_camera)[:, :3]
    return transform_points(
        *moment.surfaces("frame"),
        rows,
        transforms,
        lens_numbers(camera),
        threads=thread_count(),
    )
