"""Cameras: intrinsics, a place, settings of pictures.

Points are in the camera optical frame (x right, y down, z forward) [m].
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.depth_sensor_names import IDEAL
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose, invert
from sailenv_ros.types.intrinsics import CameraIntrinsics
from sailenv_ros.types.lens_settings import INTRINSICS_LIMITS, MIN_SIZE_PX
from sailenv_ros.types.picture_settings import MAX_SIZE_PX, PictureSettings
from sailenv_ros.types.rebuilding import RebuiltByFields

__all__ = [
    "INTRINSICS_LIMITS",
    "MAX_SIZE_PX",
    "MIN_SIZE_PX",
    "SENSOR_OF_PARALLEL_RAYS",
    "Camera",
    "CameraIntrinsics",
    "require_fitting",
]


SENSOR_OF_PARALLEL_RAYS = (
    f"{IDEAL!r} where rays are parallel, since depth sensors look from one point"
)
"""Their depth sensors that are accepted, in words."""


def require_fitting(intrinsics: CameraIntrinsics, picture: PictureSettings) -> None:
    """Refuse settings that the pictures of a lens cannot have.

    Raises
    ------
    InvalidRequest
        If there would be too many samples, if their focal length would be too long, or if a depth
        sensor would have parallel rays.
    """
    picture.require_drawable(intrinsics.width, intrinsics.height)
    for name in ("fx_px", "fy_px"):
        focal, longest = getattr(intrinsics, name), INTRINSICS_LIMITS[name].most
        if picture.supersampling * focal > longest:
            accepted = f"at most {int(longest // focal)} for {name} = {focal:g}"
            raise InvalidRequest("supersampling", picture.supersampling, accepted)
    if intrinsics.is_parallel and picture.depth_sensor != IDEAL:
        raise InvalidRequest("depth_sensor", picture.depth_sensor, SENSOR_OF_PARALLEL_RAYS)


_PLAIN_PICTURE = PictureSettings()
"""Made and checked once, as most cameras have it."""


@dataclass(frozen=True, kw_only=True)
class Camera(RebuiltByFields):
    """A camera that stands somewhere.

    Attributes
    ----------
    intrinsics : CameraIntrinsics
    pose : Pose
        Pose of the camera's body (x forward, y left, z up) in the world frame.
    picture : PictureSettings
        Concerns the ``rgb`` view alone.
    name : str
        Whose camera it is: two cameras have different noise.

    Raises
    ------
    InvalidRequest
        See `require_fitting`.
    """

    intrinsics: CameraIntrinsics = field(default_factory=CameraIntrinsics)
    pose: Pose = field(default_factory=Pose)
    picture: PictureSettings = _PLAIN_PICTURE
    name: str = ""

    def __post_init__(self) -> None:
        require_fitting(self.intrinsics, self.picture)

    def of_samples(self) -> Camera:
        """Return the camera whose pixels are the samples of this one's picture."""
        times, lens = self.picture.supersampling, self.intrinsics
        return replace(
            self,
            intrinsics=lens.resized(times * lens.width, times * lens.height),
            picture=replace(self.picture, supersampling=1, smooth_edges=False),
        )

    def of_half_pixels(self) -> Camera:
        """Return the camera whose pixels are samples of this one's picture half a pixel apart.

        Sample k lies at pixel (k - 1) / 2, so W pixels have 2 W + 1 samples.
        """
        return replace(self, intrinsics=self.intrinsics.of_half_pixels())

    @cached_property
    def world_from_camera(self) -> NDArray[np.float64]:
        """(4, 4) float64 read-only: world coordinates of points of the optical frame."""
        matrix: NDArray[np.float64] = self.pose.matrix() @ BODY_FROM_OPTICAL
        matrix.flags.writeable = False
        return matrix

    @cached_property
    def camera_from_world(self) -> NDArray[np.float64]:
        """(4, 4) float64 read-only: the inverse of `world_from_camera`."""
        matrix = invert(self.world_from_camera)
        matrix.flags.writeable = False
        return matrix
