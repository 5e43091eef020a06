"""Sensors that compare two views: structured light (projector and camera) and active stereo.

Depth is focal length × baseline over disparity. The disparity comes in steps; its noise makes one
of the depth that grows with the square of the distance and, at grazing angles, with the angle θ:

    σ(z, θ) = constant + quadratic (z - around)² + grazing / √z · (θ / (π/2 - θ))²   [m]

(Nguyen, Izadi and Lovell 2012). The steps are a part of that noise, not added to it. At outlines a
pixel measures a neighbour, `lateral_noise` pixels away: constant + grazing · θ / (π/2 - θ). A
surface that the second view does not see is a hole: the shadow beside near things.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.render.depth_sensors.surfaces import Noise, Numbers, Surfaces, table_of_cosine
from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import SceneModel

__all__ = ["Triangulation"]

_SAME_SURFACE = 0.02
"""Share of the depth by which a neighbour may be off the pixel's plane and still belong to it."""

_Noise = Annotated[float, Number(least=0.0, most=1.0)]
_Pixels = Annotated[float, Number(least=0.0, most=16.0, unit="px")]


class AxialNoise(SceneModel):
    """Standard deviation of the depth."""

    constant: _Noise = Field(description="[m]")
    quadratic: _Noise = Field(description="[1/m]")
    around: Annotated[float, Number(least=0.0, most=100.0, unit="m")] = Field(description="[m]")
    grazing: _Noise = Field(description="[m^1.5]")


class LateralNoise(SceneModel):
    """Standard deviation of the place in the picture that a pixel measures."""

    constant: _Pixels = Field(description="[px]")
    grazing: _Pixels = Field(description="[px]")


class Triangulation(SceneModel):
    """Parameters of a sensor that triangulates."""

    type: Literal["triangulation"] = Field(
        description="`triangulation`: structured light and active stereo"
    )
    baseline: Annotated[float, Number(least=-1.0, most=1.0, unit="m")] = Field(
        description="from the camera to the projector or second camera, to the right [m]"
    )
    focal_length: Annotated[float, Number(above=0.0, most=1e4, unit="px")] = Field(
        description="of the sensor's own picture, which its disparities count in [px]"
    )
    disparity_step: Annotated[float, Number(above=0.0, most=1.0, unit="px")] = Field(
        description="least difference of two disparities [px]"
    )
    axial_noise: AxialNoise = Field(description="noise along the axis")
    lateral_noise: LateralNoise = Field(description="noise across it, at outlines")
    correlation: Annotated[int, Number(least=1, most=15, whole=True)] = Field(
        description="side of the window that is matched: its pixels share their noise [px]"
    )

    def measure(self, surfaces: Surfaces, _returned: Numbers, noise: Noise) -> Numbers:
        """Return the measured depth; see `Method.measure`."""
        depth = self._at_outlines(surfaces, noise)
        height, width = depth.shape
        squared: Numbers = np.square(depth)
        # Depth of a step, and the noise that is left for what comes before it.
        step: Numbers = squared * np.float32(self.disparity_step / self._scale)
        spread = self.axial_sigma(depth, surfaces.cosine)
        rest = np.sqrt(np.maximum(spread * spread - step * step * np.float32(1 / 12), 0))
        noisy = depth + rest * noise.correlated(height, width, self.correlation)
        steps = np.rint(np.float32(self._scale / self.disparity_step) / noisy)
        measured: Numbers = np.divide(np.float32(self._scale / self.disparity_step), steps)
        measured[~(steps > 0) | self._in_shadow(surfaces)] = np.nan
        return measured

    def axial_sigma(self, depth: Numbers, cosine: Numbers) -> Numbers:
        """Return the standard deviation of the depth [m]; see the formula above."""
        axial = self.axial_noise
        beyond: Numbers = np.square(depth - np.float32(axial.around))
        sigma: Numbers = beyond * np.float32(axial.quadratic) + np.float32(axial.constant)
        if axial.grazing:
            grazing = table_of_cosine(cosine, _grazing_squared)
            sigma += np.float32(axial.grazing) * grazing / np.sqrt(depth)
        return sigma

    @property
    def _scale(self) -> float:
        """Disparity × depth [px m]."""
        return self.focal_length * abs(self.baseline)

    def _at_outlines(self, surfaces: Surfaces, noise: Noise) -> Numbers:
        """Return the depth that is looked at: at outlines perhaps a neighbour's."""
        depth, rays = surfaces.depth, surfaces.rays
        height, width = depth.shape
        lateral = self.lateral_noise
        reach = np.float32(lateral.constant) + np.float32(lateral.grazing) * table_of_cosine(
            surfaces.cosine, _grazing
        )
        rows, columns = np.indices((height, width), np.int32, sparse=True)
        row = rows + np.rint(reach * noise.normal(depth.shape)).astype(np.int32)
        column = columns + np.rint(reach * noise.normal(depth.shape)).astype(np.int32)
        place = np.clip(row, 0, height - 1) * width + np.clip(column, 0, width - 1)
        other = depth.ravel()[place]
        # The neighbour's depth, if it lay on the plane of this pixel.
        normals = surfaces.normals
        x, y = rays[..., 0].ravel()[place], rays[..., 1].ravel()[place]
        facing = normals[..., 0] * x + normals[..., 1] * y + normals[..., 2]
        on_plane = depth * surfaces.heights / facing
        same = np.abs(other - on_plane) <= np.float32(_SAME_SURFACE) * depth
        return np.where(same, depth, other)

    def _shift(self, surfaces: Surfaces) -> Numbers:
        """Return (H, W): how many columns farther to the left the second view sees a point."""
        lens, depth = surfaces.lens, surfaces.depth
        shift: Numbers
        if lens.is_pinhole:
            shift = np.float32(lens.fx * self.baseline) / depth
        else:
            points = surfaces.rays * depth[..., None] - np.array([self.baseline, 0.0, 0.0])
            shift = (np.arange(lens.width) - lens.project(points)[..., 0]).astype(np.float32)
        return shift

    def _in_shadow(self, surfaces: Surfaces) -> NDArray[np.bool_]:
        """Tell what the projector or the second camera does not see.

        Each pixel's point goes to its column in the second view, where the nearest one counts.
        """
        depth = surfaces.depth
        height, width = depth.shape
        shift = self._shift(surfaces)
        shift = np.where(np.isfinite(shift), shift, 0)
        at = np.arange(width, dtype=np.float32) - shift
        # Both columns that a point lies between: neighbours of one surface leave no gap.
        left = np.floor(at).astype(np.int32)
        outside = (at < 0) | (at > width - 1)
        row = np.arange(height, dtype=np.int32)[:, None] * width
        nearness = np.abs(shift).ravel()
        nearest = np.zeros(height * width, np.float32)
        for column in (left, left + 1):
            np.maximum.at(nearest, (row + np.clip(column, 0, width - 1)).ravel(), nearness)
        seen = nearest[(row + np.clip(np.rint(at).astype(np.int32), 0, width - 1)).ravel()]
        # A surface that slants away is at most two pixels of disparity nearer within a column.
        hidden: NDArray[np.bool_] = seen.reshape(depth.shape) > np.abs(shift) + np.float32(2.0)
        lost: NDArray[np.bool_] = outside | hidden
        return lost


def _grazing(angle: float) -> float:
    return angle / (0.5 * math.pi - angle)


def _grazing_squared(angle: float) -> float:
    return _grazing(angle) ** 2
