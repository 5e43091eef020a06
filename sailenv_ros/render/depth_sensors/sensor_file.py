"""Depth sensors by their names: a file in `config/sensors` each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from sailenv_ros.render.depth_sensors.sensor_fields import Metres, ascending
from sailenv_ros.render.depth_sensors.surfaces import Noise, Numbers, Surfaces, ramp
from sailenv_ros.render.depth_sensors.time_of_flight import TimeOfFlight
from sailenv_ros.render.depth_sensors.triangulation import Triangulation
from sailenv_ros.scene.documents import load_document
from sailenv_ros.scene.field_types import Number, Vector
from sailenv_ros.scene.fields import Rule, SceneModel
from sailenv_ros.types.depth_sensor_names import depth_sensor_file

__all__ = ["DepthSensor", "Method", "depth_sensor", "read_depth_sensor"]

_Light = Annotated[float, Number(above=0.0, most=10.0)]
_Degrees = Annotated[float, Number(least=0.0, most=90.0, unit="deg")]

AnyMethod: TypeAlias = Annotated[Triangulation | TimeOfFlight, Field(discriminator="type")]
"""A further kind is a module and its name here."""


class Method(Protocol):
    """Contract of a kind of sensor."""

    def measure(self, surfaces: Surfaces, returned: Numbers, noise: Noise) -> Numbers:
        """Measure depth wherever there is any light.

        Parameters
        ----------
        surfaces : Surfaces
        returned : (H, W) float32
            See `Surfaces.returned`.
        noise : Noise

        Returns
        -------
        depth : (H, W) float32
            Along the optical axis [m]; ``nan`` where nothing was measured. A new array.
        """


def _range_ascends(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    span = entry.get("range")
    if isinstance(span, list | tuple) and len(span) == 2 and not span[0] < span[1]:
        yield ("range",), f"must be [nearest, farthest], got [{span[0]}, {span[1]}]"


class SignalModel(SceneModel):
    """How much light must come back; 1 is a white surface that faces the sensor 1 m away."""

    rules: ClassVar[tuple[Rule, ...]] = (ascending("lost_below", "sure_above"),)

    lost_below: _Light = Field(description="with less light nothing is measured")
    sure_above: _Light = Field(description="with more light nothing is lost")
    matt_above: Annotated[float, Number(above=0.0, most=1.0)] = Field(
        description="roughness from which on a surface returns all of its diffuse light"
    )


class GrazingModel(SceneModel):
    """Loss of measurements on surfaces that are seen at a grazing angle."""

    rules: ClassVar[tuple[Rule, ...]] = (ascending("sure_below", "lost_above"),)

    sure_below: _Degrees = Field(description="angle of incidence up to which nothing is lost [deg]")
    lost_above: _Degrees = Field(description="angle from which on all is lost [deg]")


class DepthSensor(SceneModel):
    """Parameters of a depth sensor."""

    rules: ClassVar[tuple[Rule, ...]] = (_range_ascends,)

    title: str = Field(description="maker, name and mode")
    source: str = Field(description="publications that the parameters are from")
    range: Annotated[tuple[Metres, Metres], Vector(2, "[nearest, farthest] in metres")] = Field(
        description="depth that is measured [m]"
    )
    signal: SignalModel = Field(description="how much light must come back")
    grazing: GrazingModel = Field(description="loss at grazing angles")
    method: AnyMethod = Field(description="how it measures, and with what noise")

    def measure(self, surfaces: Surfaces, seed: int) -> Numbers:
        """Measure depth.

        Parameters
        ----------
        surfaces : Surfaces
        seed : int
            The same seed gives the same measurement.

        Returns
        -------
        depth : (H, W) float32
            Along the optical axis [m]; ``nan`` where nothing was measured. A new array.
        """
        noise = Noise(seed & (2**64 - 1))
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            returned = surfaces.returned(self.signal.matt_above)
            measured = self.method.measure(surfaces, returned, noise)
            nearest, farthest = self.range
            there = (measured >= np.float32(nearest)) & (measured <= np.float32(farthest))
            measured[~there | self._is_lost(surfaces, returned, noise)] = np.nan
        return measured

    def _is_lost(self, surfaces: Surfaces, returned: Numbers, noise: Noise) -> NDArray[np.bool_]:
        """Tell where too little light comes back, or at too flat an angle.

        Light falls with the square of the distance; between the two limits the share of pixels that
        are lost grows linearly.
        """
        distance = surfaces.depth * surfaces.ray_lengths
        light: Numbers = returned / np.square(distance)
        kept = ramp(light, self.signal.lost_below, self.signal.sure_above)
        flat, steep = (
            math.cos(math.radians(angle))
            for angle in (self.grazing.lost_above, self.grazing.sure_below)
        )
        kept *= ramp(surfaces.cosine, flat, steep)
        return ~(noise.uniform(kept.shape) < kept)


@lru_cache(maxsize=32)
def depth_sensor(name: str) -> DepthSensor:
    """Return a sensor by its name, read once.

    Raises
    ------
    UnknownName
        If there is none of that name.
    SceneError
        All errors of its file.
    """
    return read_depth_sensor(depth_sensor_file(name))


def read_depth_sensor(path: Path) -> DepthSensor:
    """Read and check the file of a sensor.

    Raises
    ------
    SceneError
        All errors, with file, line and column.
    """
    return load_document(path, DepthSensor, "the file of a depth sensor")
