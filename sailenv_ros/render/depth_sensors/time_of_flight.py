"""Sensors that time modulated light.

Noise is that of the photons that come back: the standard deviation of the distance is noise ×
distance / √(reflectance × cosine) (Lange and Seitz 2001). A pixel that several surfaces share
measures a mean of them, each with the weight of its light: flying pixels between near and far.
Where they are farther apart than `mixing` allows, the sensor's own check drops the pixel.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.render.depth_sensors.sensor_fields import Metres, ascending
from sailenv_ros.render.depth_sensors.surfaces import Noise, Numbers, Surfaces
from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import Rule, SceneModel

__all__ = ["TimeOfFlight"]

_BLUR = np.array([0.25, 0.5, 0.25], np.float32)
"""Share of the light that a pixel takes of its row or column, and of their neighbours."""

_LEAST_LIGHT = np.float32(1e-4)


class MixingModel(SceneModel):
    """Mean depths of pixels at outlines."""

    rules: ClassVar[tuple[Rule, ...]] = (ascending("least", "most"),)

    least: Metres = Field(description="nearer surfaces count as one [m]")
    most: Metres = Field(description="pixels of surfaces farther apart are dropped [m]")


class TimeOfFlight(SceneModel):
    """Parameters of a time-of-flight sensor."""

    type: Literal["time_of_flight"] = Field(description="`time_of_flight`: modulated light")
    noise: Annotated[float, Number(least=0.0, most=1.0)] = Field(
        description="standard deviation over distance, on white that faces the sensor"
    )
    depth_step: Annotated[float, Number(above=0.0, most=1.0, unit="m")] = Field(
        description="least difference of two depths [m]"
    )
    mixing: MixingModel = Field(description="flying pixels")

    def measure(self, surfaces: Surfaces, returned: Numbers, noise: Noise) -> Numbers:
        """Return the measured depth; see `Method.measure`."""
        returned = np.maximum(returned, _LEAST_LIGHT)
        depth = self._mixed(surfaces, returned)
        spread = depth * (np.float32(self.noise) / np.sqrt(returned))
        step = np.float32(self.depth_step)
        steps = np.rint((depth + spread * noise.normal(depth.shape)) / step)
        measured: Numbers = steps * step
        return measured

    def _mixed(self, surfaces: Surfaces, returned: Numbers) -> Numbers:
        """Return the depth of each pixel's light, ``nan`` where it is dropped."""
        depth = surfaces.depth
        there = np.isfinite(depth)
        nothing = np.float32(0.0)
        known: Numbers = np.where(there, depth, nothing)
        light: Numbers = np.where(
            there, returned / np.maximum(known * known, _LEAST_LIGHT), nothing
        )
        total, weighted = _blurred(light), _blurred(light * known)
        low, high = _extremes(depth, there)
        least = np.float32(self.mixing.least)
        apart = (high - low > least) & (_bend(known) > least)
        mean = weighted / np.maximum(total, np.float32(1e-20))
        result: Numbers = np.where(apart, mean, depth)
        result[apart & (high - low > np.float32(self.mixing.most))] = np.nan
        return result


def _padded(values: Numbers) -> Numbers:
    return np.pad(values, 1, mode="edge")


def _blurred(values: Numbers) -> Numbers:
    padded = _padded(values)
    rows = _BLUR[0] * (padded[:-2] + padded[2:]) + _BLUR[1] * padded[1:-1]
    blurred: Numbers = _BLUR[0] * (rows[:, :-2] + rows[:, 2:]) + _BLUR[1] * rows[:, 1:-1]
    return blurred


def _extremes(depth: Numbers, there: NDArray[np.bool_]) -> tuple[Numbers, Numbers]:
    """Return the least and the greatest depth of three by three pixels."""
    results = []
    for extreme, nothing in ((np.minimum, np.inf), (np.maximum, -np.inf)):
        padded = _padded(np.where(there, depth, np.float32(nothing)))
        rows = extreme(extreme(padded[:-2], padded[2:]), padded[1:-1])
        results.append(extreme(extreme(rows[:, :-2], rows[:, 2:]), rows[:, 1:-1]))
    return results[0], results[1]


def _bend(depth: Numbers) -> Numbers:
    """Return how far a pixel is off the line between its neighbours: nothing on slanted planes."""
    padded = _padded(depth)
    twice = 2 * depth
    across = np.abs(padded[1:-1, :-2] + padded[1:-1, 2:] - twice)
    down = np.abs(padded[:-2, 1:-1] + padded[2:, 1:-1] - twice)
    bend: Numbers = np.maximum(across, down)
    return bend
