"""An agent's picture in a scene file; it becomes `PictureSettings`."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, Switch
from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.types.picture_settings import (
    LIMITS,
    PictureSettings,
    ReadOut,
    ToneCurve,
    picture_choices,
)

__all__ = ["PictureSpec"]

_STANDARD = PictureSettings()


def _number(name: str) -> Number:
    return Number.within(LIMITS[name])


class PictureSpec(SceneModel):
    """Settings of an agent's picture, shutter and depth sensor."""

    exposure: Annotated[float, _number("exposure")] = Field(
        default=_STANDARD.exposure,
        description="brightens this agent's picture, besides the environment's exposure [stops]",
    )
    auto_exposure_s: Annotated[float, _number("auto_exposure_s")] = Field(
        default=_STANDARD.auto_exposure_s,
        description="time constant of automatic exposure [s]; 0: off",
    )
    tone_curve: Annotated[ToneCurve, Choice(picture_choices()["tone_curve"])] = Field(
        default=_STANDARD.tone_curve,
        description="filmic rolls highlights off; linear is plain sRGB, cut off at white",
    )
    occlusion_strength: Annotated[float, _number("occlusion_strength")] = Field(
        default=_STANDARD.occlusion_strength,
        description="strength of ambient occlusion; 0: off",
    )
    occlusion_radius: Annotated[float, _number("occlusion_radius_m")] = Field(
        default=_STANDARD.occlusion_radius_m,
        description="from how far away surfaces darken each other [m]",
    )
    smooth_edges: Annotated[bool, Switch()] = Field(
        default=_STANDARD.smooth_edges, description="true if stair-steps are smoothed"
    )
    supersampling: Annotated[int, _number("supersampling")] = Field(
        default=_STANDARD.supersampling,
        description="samples per side of a pixel; 1: its centre alone",
    )
    bloom: Annotated[float, _number("bloom")] = Field(
        default=_STANDARD.bloom, description="share of the light that is spread around; 0: off"
    )
    full_well: Annotated[float, _number("full_well")] = Field(
        default=_STANDARD.full_well,
        description="electrons of a pixel of radiance 1, after exposure; fewer give more noise;"
        " 0: no noise",
    )
    read_noise: Annotated[float, _number("read_noise")] = Field(
        default=_STANDARD.read_noise,
        description="standard deviation that reading a pixel adds [electrons]",
    )
    depth_sensor: Annotated[str, Choice(picture_choices()["depth_sensor"])] = Field(
        default=_STANDARD.depth_sensor,
        description="sensor of the view `measured_depth`; ideal: without errors",
    )
    exposure_time_ms: Annotated[float, _number("exposure_time_ms")] = Field(
        default=_STANDARD.exposure_time_ms, description="exposure of each row [ms]"
    )
    exposure_samples: Annotated[int, _number("exposure_samples")] = Field(
        default=_STANDARD.exposure_samples,
        description="instants whose light is averaged",
    )
    row_time_us: Annotated[float, _number("row_time_us")] = Field(
        default=_STANDARD.row_time_us,
        description="time from row to row [µs]; 0: global shutter",
    )
    read_out: Annotated[ReadOut, Choice(picture_choices()["read_out"])] = Field(
        default=_STANDARD.read_out,
        description="which row is first: down, the top one",
    )
    gain: Annotated[float, _number("gain")] = Field(
        default=_STANDARD.gain, description="amplification [stops]"
    )
    vignetting: Annotated[float, _number("vignetting")] = Field(
        default=_STANDARD.vignetting,
        description="share of the cos⁴ fall-off",
    )
    lateral_colour: Annotated[float, _number("lateral_colour")] = Field(
        default=_STANDARD.lateral_colour,
        description="share by which red is larger, blue smaller",
    )
    dirt: Annotated[float, _number("dirt")] = Field(
        default=_STANDARD.dirt, description="dust and smears on the lens; 0: clean"
    )
    white_balance: Annotated[float, _number("white_balance")] = Field(
        default=_STANDARD.white_balance,
        description="error of the white balance [mired]; above 0: too warm",
    )
    jpeg_quality: Annotated[int, _number("jpeg_quality")] = Field(
        default=_STANDARD.jpeg_quality,
        description="compression; 0: none",
    )

    def to_settings(self) -> PictureSettings:
        """Return the data type that the renderer takes."""
        given = self.model_dump()
        given["occlusion_radius_m"] = given.pop("occlusion_radius")
        return PictureSettings(**given)
