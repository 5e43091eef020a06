"""The numbers of a camera's intrinsics: size, focal lengths, axis, lens, clip distances.

Integer pixel coordinates are pixel centres: (0, 0) is the centre of the top-left pixel, so
cx = (W - 1) / 2 and cy = (H - 1) / 2 unless the optical axis is off the picture's centre.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.lens import LENS
from sailenv_ros.types.lens_law import PINHOLE, LensLaw, checked_coefficients, law_of_lens
from sailenv_ros.types.lens_settings import INTRINSICS_LIMITS, PINHOLE_FOV
from sailenv_ros.types.rebuilding import RebuiltByFields
from sailenv_ros.types.validation import check_bounds, is_finite_number

__all__ = ["LensParameters"]


@dataclass(frozen=True, kw_only=True)
class LensParameters(RebuiltByFields):
    """Numbers of `CameraIntrinsics`, checked, and what follows from them alone."""

    width: int = 640
    height: int = 480
    vertical_fov_deg: float = 60.0
    near_m: float = 0.05
    far_m: float = 100.0
    cx_offset_px: float = 0.0
    cy_offset_px: float = 0.0
    fx_px: float = 0.0
    fy_px: float = 0.0
    max_angle_deg: float = 0.0
    distortion_model: str = PINHOLE
    distortion: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        is_plain = isinstance(self.distortion, tuple) and not self.distortion
        if self.distortion_model != PINHOLE or not is_plain:
            values = checked_coefficients(self.distortion_model, self.distortion)
            object.__setattr__(self, "distortion", values)
        has_focal = is_finite_number(self.fx_px) and self.fx_px > 0.0
        if has_focal:
            # Whatever was given: what is shown follows from the focal length, see below.
            object.__setattr__(self, "vertical_fov_deg", 60.0)
        elif self.distortion_model == PINHOLE:
            PINHOLE_FOV.number("vertical_fov_deg", self.vertical_fov_deg)
        check_bounds(self, INTRINSICS_LIMITS)
        for name, size in (("cx_offset_px", self.width), ("cy_offset_px", self.height)):
            offset = getattr(self, name)
            if abs(offset) > 0.5 * size:
                raise InvalidRequest(name, offset, f"within half the picture, {0.5 * size:g} [px]")
        if self.near_m >= self.far_m:
            raise InvalidRequest("near_m", self.near_m, f"less than far_m = {self.far_m:g} [m]")
        if has_focal != (self.fy_px > 0.0):
            missing = "fy_px" if has_focal else "fx_px"
            accepted = "above 0 [px] where the other focal length is; or both 0"
            raise InvalidRequest(missing, getattr(self, missing), accepted)
        if not self.is_pinhole:
            right, bottom = self.width - 1, self.height - 1
            corners = [(0, 0), (right, 0), (0, bottom), (right, bottom)]
            self.law.require_unfolded(self.in_plane(np.array(corners, np.float64)))
        if has_focal:
            object.__setattr__(self, "vertical_fov_deg", self._shown_deg())

    @property
    def is_pinhole(self) -> bool:
        """True if straight lines stay straight and each pixel sees something."""
        return self.distortion_model == PINHOLE and self.max_angle_deg == 0.0

    @property
    def is_parallel(self) -> bool:
        """True if all rays lead along the axis, from places in the camera's plane."""
        return not self.is_pinhole and self.law.model.parallel

    @cached_property
    def law(self) -> LensLaw:
        """From rays to places of the normalised plane: (u - cx) / fx, (v - cy) / fy."""
        return law_of_lens(self.distortion_model, self.distortion, self.max_angle_deg)

    @property
    def fx(self) -> float:
        """Focal length across [px]; that down unless it was given."""
        return self.fx_px or self.fy

    @property
    def fy(self) -> float:
        """Focal length down [px]: the given one, else that of the vertical field of view φ.

        (H / 2) / tan(φ / 2); with distortion the tangent's place has the model's law.
        """
        if self.fy_px:
            return self.fy_px
        return 0.5 * self.height / (self.half_height if self.is_pinhole else self._plane_height)

    @property
    def half_height(self) -> float:
        """Half of what the picture shows from top to bottom at depth 1 m [m].

        Through a lens that distorts: as if all was as large as near the axis.
        """
        if self.is_pinhole and not self.fy_px:
            return math.tan(0.5 * math.radians(self.vertical_fov_deg))
        return 0.5 * self.height / (self.fy * (1.0 if self.is_pinhole else self.law.slope()))

    @cached_property
    def _plane_height(self) -> float:
        return self.law.height_of_fov(self.vertical_fov_deg)

    def _shown_deg(self) -> float:
        """Return the vertical angle of view that follows from the focal length [deg]."""
        if self.is_pinhole:
            return math.degrees(2.0 * math.atan(self.half_height))
        return self.law.fov_of_height(0.5 * self.height / self.fy)

    @property
    def cx(self) -> float:
        """Column of the optical axis [px]: (W - 1) / 2 unless it is off the centre."""
        return 0.5 * (self.width - 1) + self.cx_offset_px

    @property
    def cy(self) -> float:
        """Row of the optical axis [px]: (H - 1) / 2 unless it is off the centre."""
        return 0.5 * (self.height - 1) + self.cy_offset_px

    @property
    def K(self) -> NDArray[np.float64]:
        """(3, 3) intrinsic matrix; a new array."""
        return np.array([[self.fx, 0.0, self.cx], [0.0, self.fy, self.cy], [0.0, 0.0, 1.0]])

    @property
    def D(self) -> NDArray[np.float64]:
        """(N,) coefficients of the distortion, in the model's order; a new array."""
        return np.array(self.distortion, np.float64)

    @property
    def R(self) -> NDArray[np.float64]:
        """(3, 3) rotation of the rectified picture's axes: none; a new array."""
        return np.eye(3)

    @property
    def P(self) -> NDArray[np.float64]:
        """(3, 4) projection into the rectified picture, [K | 0]; a new array."""
        return np.hstack([self.K, np.zeros((3, 1))])

    @cached_property
    def lens_record(self) -> NDArray[np.void]:
        """(1,) `native.lens.LENS`, read-only: the lens as kernels take it."""
        numbers = (self.fx, self.fy, self.cx, self.cy, self.near_m, self.far_m)
        record = np.array([numbers], LENS)
        record.flags.writeable = False
        return record

    def in_plane(self, pixels: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the places (..., 2) in the normalised plane of pixels (..., 2)."""
        return (pixels - (self.cx, self.cy)) / (self.fx, self.fy)

    def numbers(self) -> dict[str, float]:
        """Return the numbers that are not as they would be without them, by name.

        In the order of `INTRINSICS_LIMITS`, with sizes, clip distances and the field of view; with
        focal lengths instead of it where these are given.
        """
        optional = ("cx_offset_px", "cy_offset_px", "fx_px", "fy_px", "max_angle_deg")
        left_out = {name for name in optional if getattr(self, name) == 0.0}
        if not {"cx_offset_px", "cy_offset_px"} <= left_out:
            left_out -= {"cx_offset_px", "cy_offset_px"}
        if self.fx_px:
            left_out.add("vertical_fov_deg")
        return {name: getattr(self, name) for name in INTRINSICS_LIMITS if name not in left_out}

    def arguments(self) -> dict[str, Any]:
        """Return plain values by name: ``CameraIntrinsics(**arguments)`` is equal to this."""
        if self.distortion_model == PINHOLE:
            return {**self.numbers()}
        model = {"distortion_model": self.distortion_model, "distortion": [*self.distortion]}
        return {**self.numbers(), **model}
