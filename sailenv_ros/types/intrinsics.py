"""The intrinsics of a camera: projection there and back, matrices, other sizes.

Points are in the camera optical frame (x right, y down, z forward) [m]. OpenGL's clip axes appear
in `clip_from_optical` alone. Models other than the pin-hole have their law in `lens_law`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.lens_parameters import LensParameters

__all__ = ["CameraIntrinsics"]

_WIDEST_BORDER = math.tan(math.radians(80.0))

_LEAST_DEPTH_M = 1e-12
"""Nearer to the camera's plane a point's pixel would have no finite number."""


@dataclass(frozen=True, kw_only=True)
class CameraIntrinsics(LensParameters):
    """Intrinsics of a camera, with its clip distances.

    Attributes
    ----------
    width, height : int
        Size of the picture [px], 8 to 4096.
    vertical_fov_deg : float
        Full vertical angle of view [deg], 1 to 170 and for wide models more. It follows from the
        focal length where that is given; 0 where all rays are parallel.
    near_m, far_m : float
        Clip distances along the optical axis [m], 0.001 ≤ near < far ≤ 10000.
    cx_offset_px, cy_offset_px : float
        From the picture's centre to the optical axis, to the right and down [px]; at most half the
        picture. What the picture shows moves with the axis; the focal length stays.
    fx_px, fy_px : float
        Focal lengths [px] across and down ([px/m] of parallel rays); 0, both, if they follow from
        the vertical angle of view.
    max_angle_deg : float
        Angle from the axis at which the image circle ends [deg]; 0 if it ends where the model does.
    distortion_model : str
        A name of `native.lens_models.lens_models`; ``"pinhole"`` has no distortion.
    distortion : tuple of float
        The model's coefficients; empty for the pinhole.

    Raises
    ------
    InvalidRequest
        If one of them is out of its range, or the distortion folds within the picture.
    UnknownName
        If there is no such model.
    """

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
        self.require_pinhole("matrices of OpenGL")
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

    def require_pinhole(self, what: str) -> None:
        """Refuse a lens that distorts, or has an image circle.

        Parameters
        ----------
        what : str
            What knows none, in the plural, e.g. ``"amodal masks"``.

        Raises
        ------
        InvalidRequest
        """
        if not self.is_pinhole:
            accepted = f"'pinhole' without max_angle_deg, since {what} know no other lens"
            raise InvalidRequest("distortion_model", self.distortion_model, accepted)

    def with_vertical_fov(self, vertical_fov_deg: float) -> CameraIntrinsics:
        """Return the lens that shows another vertical angle [deg]; its pixels keep their shape."""
        shown = replace(self, vertical_fov_deg=vertical_fov_deg, fx_px=0.0, fy_px=0.0)
        if not self.fx_px:
            return shown
        return replace(self, fx_px=self.fx * (shown.fy / self.fy), fy_px=shown.fy)

    def resized(self, width: int, height: int) -> CameraIntrinsics:
        """Return the lens of a picture of another size that shows the same from top to bottom."""
        scale, x, y = height / self.height, 0.5 * width, 0.5 * height
        return replace(
            self,
            width=width,
            height=height,
            cx_offset_px=min(max(scale * self.cx_offset_px, -x), x),
            cy_offset_px=min(max(scale * self.cy_offset_px, -y), y),
            fx_px=scale * self.fx_px,
            fy_px=scale * self.fy_px,
        )

    def of_half_pixels(self) -> CameraIntrinsics:
        """Return the lens of samples half a pixel apart; see `Camera.of_half_pixels`."""
        width, height = 2 * self.width + 1, 2 * self.height + 1
        fov_deg = self.vertical_fov_deg
        if self.is_pinhole and not self.fx_px:
            fov_deg = 2.0 * math.degrees(math.atan2(0.5 * height, 2.0 * self.fy))
        has_focal = bool(self.fx_px) or not self.is_pinhole
        return _Samples(
            width=width,
            height=height,
            vertical_fov_deg=fov_deg,
            near_m=self.near_m,
            far_m=self.far_m,
            cx_offset_px=2.0 * self.cx_offset_px,
            cy_offset_px=2.0 * self.cy_offset_px,
            fx_px=2.0 * self.fx if has_focal else 0.0,
            fy_px=2.0 * self.fy if has_focal else 0.0,
            max_angle_deg=self.max_angle_deg,
            distortion_model=self.distortion_model,
            distortion=self.distortion,
        )

    def mirrored(self) -> CameraIntrinsics:
        """Return the lens whose picture is this one's with left and right exchanged."""
        distortion = () if self.is_pinhole else self.law.mirrored_coefficients()
        return replace(self, cx_offset_px=-self.cx_offset_px, distortion=distortion)

    def border(self) -> NDArray[np.float64]:
        """Return (2, 2): x and y of the rays at depth 1 m through the picture's corners.

        Top left and bottom right; half a pixel beyond the centres of the outermost pixels. Through
        a lens that distorts: of the rays at the ends of the axis's row and column, and no farther
        than 80° from the axis.
        """
        right, bottom = self.width - 0.5, self.height - 0.5
        if self.is_pinhole or self.is_parallel:
            return self.rays_through([(-0.5, -0.5), (right, bottom)])[:, :2]
        ends = [(-0.5, self.cy), (self.cx, -0.5), (right, self.cy), (self.cx, bottom)]
        rays = self.rays_through(ends)
        found = np.array([[rays[0, 0], rays[1, 1]], [rays[2, 0], rays[3, 1]]])
        widest = np.array([[-_WIDEST_BORDER], [_WIDEST_BORDER]])
        return np.where(np.abs(found) < _WIDEST_BORDER, found, widest)

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Project points of the optical frame into the picture.

        Parameters
        ----------
        points : (..., 3) array-like
            Points in the optical frame [m].

        Returns
        -------
        pixels : (..., 2) float64
            Columns and rows (u, v) [px]; ``nan`` for points that the lens does not see, be they
            behind the camera, in its plane or beyond the image circle.
        """
        p = np.asarray(points, dtype=np.float64)
        if not self.is_pinhole:
            return self.law.project(p) * (self.fx, self.fy) + (self.cx, self.cy)
        z = np.where(p[..., 2] > _LEAST_DEPTH_M, p[..., 2], np.nan)
        u = self.fx * p[..., 0] / z + self.cx
        v = self.fy * p[..., 1] / z + self.cy
        return np.stack([u, v], axis=-1)

    def places_of_rays(
        self, x: NDArray[np.floating[Any]], y: NDArray[np.floating[Any]]
    ) -> tuple[NDArray[np.floating[Any]], NDArray[np.floating[Any]]]:
        """Return the columns and rows [px] of rays (x, y, 1), in their own precision."""
        if self.is_pinhole:
            return x * self.fx + self.cx, y * self.fy + self.cy
        pixels = self.project(np.stack([x, y, np.ones_like(x)], axis=-1)).astype(x.dtype)
        return pixels[..., 0], pixels[..., 1]

    def rays(self, rows: slice = slice(None), columns: slice = slice(None)) -> NDArray[np.float64]:
        """Return the point at depth 1 m that each pixel's centre sees.

        Parameters
        ----------
        rows, columns : slice
            The part of the picture, all of it unless given.

        Returns
        -------
        rays : (rows, columns, 3) float64
            In the optical frame; ``nan`` where a pixel sees nothing, or nothing in front of the
            camera. A new array.
        """
        u, v = np.arange(self.width)[columns], np.arange(self.height)[rows]
        if not self.is_pinhole:
            places = np.stack(np.meshgrid(u, v), axis=-1).astype(np.float64)
            return self._at_depth_one(self._pixel_rays[rows, columns].copy(), places)
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
            As `rays`.
        """
        p = np.asarray(pixels, dtype=np.float64)
        if not self.is_pinhole:
            return self._at_depth_one(self.unit_rays_through(p), p)
        result = np.ones((*p.shape[:-1], 3))
        result[..., 0] = (p[..., 0] - self.cx) / self.fx
        result[..., 1] = (p[..., 1] - self.cy) / self.fy
        return result

    def unit_rays_through(self, pixels: ArrayLike) -> NDArray[np.float64]:
        """Return the direction in which each place of the picture sees, also beyond 90°.

        Parameters
        ----------
        pixels : (..., 2) array-like
            As `rays_through` takes them.

        Returns
        -------
        rays : (..., 3) float64
            Unit vectors in the optical frame; ``nan`` where no ray leads. A new array.
        """
        return self.law.unproject(self.in_plane(np.asarray(pixels, np.float64)))

    def unit_rays(self) -> NDArray[np.float64]:
        """Return (H, W, 3): the direction in which each pixel's centre sees; a new array."""
        return self._pixel_rays.copy()

    def valid_pixels(self) -> NDArray[np.bool_]:
        """Return (H, W): True where a pixel's centre sees something; a new array."""
        if self.is_pinhole:
            return np.ones((self.height, self.width), np.bool_)
        return np.isfinite(self._pixel_rays[..., 2])

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
            Points in the optical frame [m]; ``nan`` where the depth is not finite, or a pixel sees
            nothing in front of the camera. A new array.
        """
        finite = np.where(np.isfinite(depth), depth, np.nan).astype(np.float64)
        return self._at_depth(self.rays(), finite)

    def points_at(self, pixels: ArrayLike, depth: ArrayLike) -> NDArray[np.float64]:
        """Return the points (..., 3) [m] that places (..., 2) see at depths (...) [m]."""
        return self._at_depth(self.rays_through(pixels), np.asarray(depth, np.float64))

    def sight_lines(self, pixels: ArrayLike) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return where the rays to places of the picture begin, and where they go.

        Parameters
        ----------
        pixels : (..., 2) array-like
            As `rays_through` takes them.

        Returns
        -------
        origins, directions : (..., 3) float64
            In the optical frame [m]; after t directions the depth is t. ``nan`` as in `rays`.
        """
        ends = self.rays_through(pixels)
        origins = np.zeros_like(ends)
        if self.is_parallel:
            origins[..., :2] = ends[..., :2]
        return origins, ends - origins

    def _at_depth(
        self, ends: NDArray[np.float64], depth: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        points = ends * depth[..., None]
        if self.is_parallel:
            points[..., :2] = np.where(np.isnan(points[..., :2]), np.nan, ends[..., :2])
        return points

    @cached_property
    def _pixel_rays(self) -> NDArray[np.float64]:
        """(H, W, 3) float64 read-only: see `unit_rays`."""
        u, v = np.arange(self.width), np.arange(self.height)
        rays = self.unit_rays_through(np.stack(np.meshgrid(u, v), axis=-1))
        rays.flags.writeable = False
        return rays

    def _at_depth_one(
        self, rays: NDArray[np.float64], pixels: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        if self.is_parallel:
            rays[..., :2] = self.in_plane(pixels)
            return rays
        rays[~(rays[..., 2] > 0.0)] = np.nan
        rays /= rays[..., 2:]
        return rays


@dataclass(frozen=True, kw_only=True)
class _Samples(CameraIntrinsics):
    """Of samples: they may be more, and see further, than the pixels of a picture may."""

    def __post_init__(self) -> None:
        pass
