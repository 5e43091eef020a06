"""Settings of an agent's sensors: shutter, exposure, tone curve, effects, depth sensor.

Travels in `Camera` to the renderer. The shutter says at which instants rows are exposed. All else
concerns the picture and the measured depth alone: no ground truth depends on it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal, get_args

from typing_extensions import TypedDict

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.depth_sensor_names import IDEAL, depth_sensor_names
from sailenv_ros.types.validation import Bounds, check_bounds, checked_flag

__all__ = [
    "LIMITS",
    "MAX_SIZE_PX",
    "NAMES",
    "PictureChanges",
    "PictureSettings",
    "ReadOut",
    "ToneCurve",
    "picture_choices",
]

MAX_SIZE_PX = 4096
"""Most pixels, or samples, along a side of a picture."""

ToneCurve = Literal["filmic", "linear"]
ReadOut = Literal["down", "up"]

LIMITS: Mapping[str, Bounds] = {
    "exposure": Bounds(least=-16.0, most=16.0, unit="stops"),
    "auto_exposure_s": Bounds(least=0.0, most=60.0, unit="s"),
    "occlusion_strength": Bounds(least=0.0, most=1.0),
    "occlusion_radius_m": Bounds(least=0.01, most=5.0, unit="m"),
    "supersampling": Bounds(least=1, most=4, whole=True),
    "bloom": Bounds(least=0.0, most=1.0),
    "full_well": Bounds(least=0.0, most=1e7, unit="electrons"),
    "read_noise": Bounds(least=0.0, most=1e4, unit="electrons"),
    "exposure_time_ms": Bounds(least=0.0, most=100.0, unit="ms"),
    "exposure_samples": Bounds(least=1, most=64, whole=True),
    "row_time_us": Bounds(least=0.0, most=1000.0, unit="µs"),
    "gain": Bounds(least=0.0, most=8.0, unit="stops"),
    "vignetting": Bounds(least=0.0, most=1.0),
    "lateral_colour": Bounds(least=-0.01, most=0.01),
    "dirt": Bounds(least=0.0, most=1.0),
    "white_balance": Bounds(least=-100.0, most=100.0, unit="mired"),
    "jpeg_quality": Bounds(least=0, most=100, whole=True),
}
"""Bounds of each number."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureSettings:
    """Settings that change the picture and the measured depth; those of the shutter, instants too.

    Attributes
    ----------
    exposure : float
        Stops that the picture is brightened by, on top of the scene's, -16 to 16.
    auto_exposure_s : float
        Time constant with which the exposure follows the light of the picture [s], 0 to 60;
        `exposure` is then on top of it. 0 turns that off.
    tone_curve : {'filmic', 'linear'}
        ``filmic`` rolls highlights off as film does; ``linear`` is plain sRGB, cut off at white.
    occlusion_strength : float
        How much corners and contacts darken the light from around, 0 (off) to 1. Surfaces whose
        light was baked have that darkness already; among each other they are left alone.
    occlusion_radius_m : float
        From how far away surfaces darken each other [m], 0.01 to 5.
    smooth_edges : bool
        True if a pixel's light is that of all surfaces that it covers, not of what its centre
        sees alone; a picture of several samples a pixel needs it not.
    supersampling : int
        The picture is drawn this many times as wide and as high, 1 to 4, and each pixel is the
        mean of the light of its samples.
    bloom : float
        Share of the light that is spread around bright places, 0 (off) to 1.
    full_well : float
        Electrons that a pixel of radiance 1 (after exposure) collects: the fewer, the more noise.
        0 turns noise off.
    read_noise : float
        Standard deviation that reading a pixel adds [electrons]; counts where `full_well` is not 0.
    depth_sensor : str
        The sensor of the view ``measured_depth``: ``ideal``, or the name of a file in
        `config/sensors`.
    exposure_time_ms : float
        How long each row is exposed [ms], 0 to 100: what moves then is blurred. Ground truth is of
        the middle.
    exposure_samples : int
        Instants of the exposure whose light is averaged, 1 to 64; 1: the middle alone.
    row_time_us : float
        Time from a row to the next one [µs], 0 to 1000; above 0 the shutter rolls, and each row of
        each view belongs to its own instant.
    read_out : {'down', 'up'}
        Whether the first row is exposed first, or the last one.
    gain : float
        Stops that the electrons are amplified by, with their noise, 0 to 8.
    vignetting : float
        How far light falls off with the angle θ from the axis as cos⁴ θ, 0 (off) to 1.
    lateral_colour : float
        By which share the red picture is larger than the green one, and the blue one smaller, -0.01
        to 0.01. Ground truth is of the green one.
    dirt : float
        How much of the light dust and smears on the lens hold back, 0 (clean) to 1.
    white_balance : float
        By which the camera takes the light for bluer than it is, -100 to 100 [mired]: above 0 the
        picture is too warm, below 0 too cold.
    jpeg_quality : int
        Quality of the JPEG file that the picture has been in, 1 to 100; 0: none.

    Raises
    ------
    InvalidRequest, UnknownName
        If one of them is out of its range.
    """

    exposure: float = 0.0
    auto_exposure_s: float = 0.0
    tone_curve: ToneCurve = "filmic"
    occlusion_strength: float = 0.6
    occlusion_radius_m: float = 0.25
    smooth_edges: bool = True
    supersampling: int = 1
    bloom: float = 0.0
    full_well: float = 0.0
    read_noise: float = 0.0
    depth_sensor: str = IDEAL
    exposure_time_ms: float = 0.0
    exposure_samples: int = 8
    row_time_us: float = 0.0
    read_out: ReadOut = "down"
    gain: float = 0.0
    vignetting: float = 0.0
    lateral_colour: float = 0.0
    dirt: float = 0.0
    white_balance: float = 0.0
    jpeg_quality: int = 0

    def __post_init__(self) -> None:
        for name, choices in picture_choices().items():
            if getattr(self, name) not in choices:
                raise UnknownName(name, str(getattr(self, name)), choices)
        checked_flag("smooth_edges", self.smooth_edges)
        check_bounds(self, LIMITS)

    @property
    def rolls(self) -> bool:
        """Whether rows are exposed one after the other."""
        return self.row_time_us > 0.0

    def span_ns(self, height: int) -> float:
        """Return the time from the first row's exposure to the end of the last one's [ns]."""
        return (height - 1) * self.row_time_us * 1e3 + self.exposure_time_ms * 1e6

    def delay_ns(self, height: int) -> int:
        """Return the time from a frame's instant to when it is complete [ns], rounded up."""
        return math.ceil(0.5 * self.span_ns(height))

    @staticmethod
    def checked(what: str, settings: object) -> PictureSettings:
        """Refuse what is no object of this class; `what` is the name that the error tells."""
        if not isinstance(settings, PictureSettings):
            raise InvalidRequest(what, settings, "an object of PictureSettings")
        return settings

    def changed(self, changes: Mapping[str, Any]) -> PictureSettings:
        """Return these settings with some of them changed, by their names.

        Raises
        ------
        InvalidRequest, UnknownName
            If there is no such setting, or a value is out of its range.
        """
        for name in changes:
            if name not in NAMES:
                raise UnknownName("setting of a picture", str(name), NAMES)
        return replace(self, **changes)

    def require_drawable(self, width: int, height: int) -> None:
        """Refuse a picture of so many pixels with more than `MAX_SIZE_PX` samples along a side.

        Raises
        ------
        InvalidRequest
            Naming what would be accepted for a picture of that size.
        """
        most = max(MAX_SIZE_PX // max(width, height), 1)
        if self.supersampling > most:
            size = f"{width} x {height} px (no side has over {MAX_SIZE_PX} samples)"
            raise InvalidRequest("supersampling", self.supersampling, f"at most {most} for {size}")


def picture_choices() -> dict[str, tuple[str, ...]]:
    """Return what is accepted for each setting that is a name."""
    return {
        "tone_curve": get_args(ToneCurve),
        "depth_sensor": depth_sensor_names(),
        "read_out": get_args(ReadOut),
    }


class PictureChanges(TypedDict, total=False):
    """Some settings, by their names in `PictureSettings`."""

    exposure: float
    auto_exposure_s: float
    tone_curve: ToneCurve
    occlusion_strength: float
    occlusion_radius_m: float
    smooth_edges: bool
    supersampling: int
    bloom: float
    full_well: float
    read_noise: float
    depth_sensor: str
    exposure_time_ms: float
    exposure_samples: int
    row_time_us: float
    read_out: ReadOut
    gain: float
    vignetting: float
    lateral_colour: float
    dirt: float
    white_balance: float
    jpeg_quality: int


NAMES: tuple[str, ...] = tuple(setting.name for setting in fields(PictureSettings))
"""Names of all settings, in their order."""
