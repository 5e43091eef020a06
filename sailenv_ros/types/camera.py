"""The pin-hole camera: sizes, field of view, matrices, projection.

Integer pixel coordinates are pixel centres: (0, 0) is the centre of the top-left pixel, so
cx = (W - 1) / 2 and cy = (H - 1) / 2 unless the optical axis is off the picture's centre. Points
are in the camera optical frame (x right, y down, z forward) [m]. OpenGL's clip axes appear in
`clip_from_optical` alone.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.lens import LENS
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose, invert
from sailenv_ros.types.picture_settings import MAX_SIZE_PX, PictureSettings
from sailenv_ros.types.rebuilding import RebuiltByFields
from sailenv_ros.types.validation import Bounds, check_bounds

__all__ = [
    "INTRINSICS_LIMITS",
    "MAX_SIZE_PX",
    "MIN_SIZE_PX",
    "Camera",
    "CameraIntrinsics",
]

MIN_SIZE_PX = 8

_SIZE = Bounds(least=MIN_SIZE_PX, most=MAX_SIZE_PX, unit="px", whole=True)
_CLIP = Bounds(least=1e-3, most=1e4, unit="m")
_OFFSET = Bounds(least=-MAX_SIZE_PX / 2, most=MAX_SIZE_PX / 2, unit="px")

INTRINSICS_LIMITS: Mapping[str, Bounds] = {
    "width": _SIZE,
    "height": _SIZE,
    "vertical_fov_deg": Bounds(least=1.0, most=170.0, unit="deg"),
    "near_m": _CLIP,
    "far_m": _CLIP,
    "cx_offset_px": _OFFSET,
    "cy_offset_px": _OFFSET,
}
"""Bounds of each number of `CameraIntrinsics`."""


@dataclass(frozen=True, kw_only=True)
class CameraIntrinsics(RebuiltByFields):
    """Intrinsics of a pinhole camera, with its clip distances.

    Attributes
    ----------
    width, height : int
        Size of the picture [px], 8 to 4096.
    vertical_fov_deg : float
        Full vertical angle of view [deg], 1 to 170.
    near_m, far_m : float
        Clip distances along the optical axis [m], 0.001 ≤ near < far ≤ 10000.
    cx_offset_px, cy_offset_px : float
        From the picture's centre to the optical axis, to the right and down [px]; at most half the
        picture. What the picture shows moves with the axis; the focal length stays.

    Raises
    ------
    InvalidRequest
        If one of them is out of its range.
    """

    width: int = 640
    height: int = 480
    vertical_fov_deg: float = 60.0
    near_m: float = 0.05
    far_m: float = 100.0
    cx_offset_px: float = 0.0
    cy_offset_px: float = 0.0

    def __post_init__(self) -> None:
        check_bounds(self, INTRINSICS_LIMITS)
        for name, size in (("cx_offset_px", self.width), ("cy_offset_px", self.height)):
            offset = getattr(self, name)
            if abs(offset) > 0.5 * size:
                raise InvalidRequest(name, offset, f"within half the picture, {0.5 * size:g} [px]")
        if self.near_m >= self.far_m:
            raise InvalidRequest("near_m", self.near_m, f"less than far_m = {self.far_m:g} [m]")

    @property
    def fx(self) -> float:
        """Focal length [px]; pixels are square, so fx = fy."""
        return self.fy

    @property
    def fy(self) -> float:
        """Focal length [px]: (H / 2) / tan(vertical field of view / 2)."""
        return 0.5 * self.height / self.half_height

    @property
    def half_height(self) -> float:
        """Half of what the picture shows from top to bottom at depth 1 m [m]."""
        return math.tan(0.5 * math.radians(self.vertical_fov_deg))

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

    @cached_property
    def lens_record(self) -> NDArray[np.void]:
        """(1,) `native.lens.LENS`, read-only: the lens as kernels take it."""
        numbers = (self.fx, self.fy, self.cx, self.cy, self.near_m, self.far_m)
        record = np.array([numbers], LENS)
        record.flags.writeable = False
        return record

    def lens_of_window(self, rows: slice, columns: slice) -> NDArray[np.void]:
        """Return (1,) `native.lens.LENS`: the lens of a part of the picture.

        Parameters
        ----------
        rows, columns : slice
            The part, which need not lie in the picture. Its first pixel is (0, 0).
        """
        record = self.lens_record.copy()
        record["cx"] -= columns.start
        record["cy"] -= rows.start
        return record

    def clip_from_optical(self) -> NDArray[np.float64]:
        """Return the (4, 4) OpenGL projection of points in the optical frame.

        Clip w is the depth z; window row 0 of OpenGL is the picture's bottom row.
        """
        near, far = self.near_m, self.far_m
        result = np.zeros((4, 4))
        result[0, 0] = 2.0 * self.fx / self.width
        result[1, 1] = -2.0 * self.fy / self.height
        result[0, 2] = 2.0 * (self.cx + 0.5) / self.width - 1.0
        result[1, 2] = 1.0 - 2.0 * (self.cy + 0.5) / self.height
        result[2, 2] = (far + near) / (far - near)
        result[2, 3] = -2.0 * far * near / (far - near)
        result[3, 2] = 1.0
        return result

    def numbers(self) -> dict[str, float]:
        """Return the attributes by name: ``CameraIntrinsics(**numbers)`` is equal to this.

        In the order of `INTRINSICS_LIMITS`; where the axis is in the centre, without the offsets.
        """
        is_centred = self.cx_offset_px == self.cy_offset_px == 0.0
        left_out = ("cx_offset_px", "cy_offset_px") if is_centred else ()
        return {name: getattr(self, name) for name in INTRINSICS_LIMITS if name not in left_out}

    def resized(self, width: int, height: int) -> CameraIntrinsics:
        """Return the lens of a picture of another size that shows the same from top to bottom."""
        scale, x, y = height / self.height, 0.5 * width, 0.5 * height
        return replace(
            self,
            width=width,
            height=height,
            cx_offset_px=min(max(scale * self.cx_offset_px, -x), x),
            cy_offset_px=min(max(scale * self.cy_offset_px, -y), y),
        )

    def mirrored(self) -> CameraIntrinsics:
        """Return the lens whose picture is this one's with left and right exchanged."""
        return replace(self, cx_offset_px=-self.cx_offset_px)

    def border(self) -> NDArray[np.float64]:
        """Return (2, 2): x and y of the rays at depth 1 m through the picture's corners.

        Top left and bottom right; half a pixel beyond the centres of the outermost pixels.
        """
        corners = [(-0.5, -0.5), (self.width - 0.5, self.height - 0.5)]
        return self.rays_through(corners)[:, :2]

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Project points of the optical frame into the picture.

        Parameters
        ----------
        points : (..., 3) array-like
            Points in the optical frame [m].

        Returns
        -------
        pixels : (..., 2) float64
            Columns and rows (u, v) [px]; ``nan`` for points that are not in front of the camera.
        """
        p = np.asarray(points, dtype=np.float64)
        z = np.where(p[..., 2] > 0.0, p[..., 2], np.nan)
        u = self.fx * p[..., 0] / z + self.cx
        v = self.fy * p[..., 1] / z + self.cy
        return np.stack([u, v], axis=-1)

    def places_of_rays(
        self, x: NDArray[np.floating[Any]], y: NDArray[np.floating[Any]]
    ) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
        """Return the columns and rows [px] of rays (x, y, 1), in their own precision."""
        return x * self.fx + self.cx, y * self.fy + self.cy

    def rays(self, rows: slice = slice(None), columns: slice = slice(None)) -> NDArray[np.float64]:
        """Return the point at depth 1 m that each pixel's centre sees.

        Parameters
        ----------
        rows, columns : slice
            The part of the picture, all of it unless given.

        Returns
        -------
        rays : (rows, columns, 3) float64
            In the optical frame; a new array.
        """
        u, v = np.arange(self.width)[columns], np.arange(self.height)[rows]
        result = np.ones((len(v), len(u), 3))
        result[..., 0] = (u - self.cx) / self.fx
        result[..., 1] = ((v - self.cy) / self.fy)[:, None]
        return result

    def rays_through(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Return the point at depth 1 m that is seen at places of the picture.

        Parameters
        ----------
        pixels : (..., 2) array-like
            Columns and rows (u, v), also between pixels and beside the picture [px].

        Returns
        -------
        rays : (..., 3) float64
            In the optical frame; a new array.
        """
        p = np.asarray(pixels, dtype=np.float64)
        result = np.ones((*p.shape[:-1], 3))
        result[..., 0] = (p[..., 0] - self.cx) / self.fx
        result[..., 1] = (p[..., 1] - self.cy) / self.fy
        return result

    def unproject(self, depth: NDArray[np.float32]) -> NDArray[np.float64]:
        """Turn a depth picture into points.

        Parameters
        ----------
        depth : (H, W) float32
            Depth along the optical axis [m]; ``inf`` where nothing was hit, ``nan`` where the
            surface was nearer than the near plane.

        Returns
        -------
        points : (H, W, 3) float64
            Points in the optical frame [m]; ``nan`` where the depth is not finite. A new array.
        """
        finite = np.where(np.isfinite(depth), depth, np.nan).astype(np.float64)
        return self.rays() * finite[..., None]


@dataclass(frozen=True, kw_only=True)
class _Samples(CameraIntrinsics):
    """Of samples: they may be more, and see further, than the pixels of a picture may."""

    def __post_init__(self) -> None:
        pass


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
        If the picture would have to be drawn larger than `MAX_SIZE_PX`.
    """

    intrinsics: CameraIntrinsics = field(default_factory=CameraIntrinsics)
    pose: Pose = field(default_factory=Pose)
    picture: PictureSettings = field(default_factory=PictureSettings)
    name: str = ""

    def __post_init__(self) -> None:
        self.picture.require_drawable(self.intrinsics.width, self.intrinsics.height)

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
        lens = self.intrinsics
        width, height = 2 * lens.width + 1, 2 * lens.height + 1
        samples = _Samples(
            width=width,
            height=height,
            vertical_fov_deg=2.0 * math.degrees(math.atan2(0.5 * height, 2.0 * lens.fy)),
            near_m=lens.near_m,
            far_m=lens.far_m,
            cx_offset_px=2.0 * lens.cx_offset_px,
            cy_offset_px=2.0 * lens.cy_offset_px,
        )
        return replace(self, intrinsics=samples)

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
