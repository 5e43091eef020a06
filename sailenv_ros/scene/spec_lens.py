"""The lens of a camera in scene files and recipes: its keys, and what must hold between them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, TypeAlias

from pydantic import Field

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.lens_models import lens_models
from sailenv_ros.scene.field_types import Number, Text
from sailenv_ros.scene.fields import Rule, SceneModel
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.rules import Faults, few_samples, within_half
from sailenv_ros.types.camera import (
    INTRINSICS_LIMITS,
    MAX_SIZE_PX,
    SENSOR_OF_PARALLEL_RAYS,
    CameraIntrinsics,
)
from sailenv_ros.types.depth_sensor_names import IDEAL
from sailenv_ros.types.validation import is_finite_number

__all__ = ["LensSpec", "intrinsics_key"]

_Size: TypeAlias = Annotated[int, Number.within(INTRINSICS_LIMITS["width"])]
_Offset: TypeAlias = Annotated[float, Number.within(INTRINSICS_LIMITS["cx_offset_px"])]
_Focal: TypeAlias = Annotated[float, Number.within(INTRINSICS_LIMITS["fx_px"])]
_Coefficient: TypeAlias = Annotated[float, Number(least=-1e6, most=1e6)]

_DEFAULTS = CameraIntrinsics()


def intrinsics_key(name: str) -> str:
    """Return the key of an attribute of `CameraIntrinsics` in a file: without its unit."""
    return name.removesuffix("_deg").removesuffix("_px").removesuffix("_m")


_NUMBERS = {
    intrinsics_key(name): (name, limits)
    for name, limits in INTRINSICS_LIMITS.items()
    if name not in ("near_m", "far_m")
}


def _makes_a_lens(entry: Mapping[str, Any]) -> Faults:
    """Refuse what `CameraIntrinsics` does, where each key alone is as it should be."""
    given: dict[str, Any] = {}
    for key, (name, limits) in _NUMBERS.items():
        if key in entry:
            if limits.refused(entry[key]):
                return
            given[name] = entry[key]
    for key, size in (("cx_offset", "width"), ("cy_offset", "height")):
        if abs(entry.get(key, 0.0)) > 0.5 * entry.get(size, getattr(_DEFAULTS, size)):
            return
    model, coefficients = entry.get("distortion_model", "pinhole"), entry.get("distortion", ())
    if not isinstance(model, str) or not isinstance(coefficients, list | tuple):
        return
    if not all(map(is_finite_number, coefficients)):
        return
    given |= {"distortion_model": model, "distortion": tuple(coefficients)}
    try:
        CameraIntrinsics(**given)
    except InvalidRequest as problem:
        key = intrinsics_key(problem.what)
        accepted = problem.accepted.replace("max_angle_deg", intrinsics_key("max_angle_deg"))
        sentence = f"must be {accepted}, got {shown(entry.get(key, problem.got))}"
        if key in entry:
            yield (key,), sentence
        else:
            beside = next(iter(one for one in ("fx", "fy", "distortion_model") if one in entry))
            yield (beside,), f"does not fit: {key} {sentence}"


def _measures_from_one_point(entry: Mapping[str, Any]) -> Faults:
    """Refuse what `require_fitting` does of depth sensors."""
    picture, name = entry.get("picture"), entry.get("distortion_model")
    model = lens_models().get(name) if isinstance(name, str) else None
    sensor = picture.get("depth_sensor", IDEAL) if isinstance(picture, Mapping) else IDEAL
    if model is not None and model.parallel and sensor != IDEAL:
        accepted = f"it must be {SENSOR_OF_PARALLEL_RAYS}, got {shown(sensor)}"
        yield ("picture", "depth_sensor"), f"is refused: {accepted}"


class LensSpec(SceneModel):
    """Base of entries that describe a camera: size and lens of its pictures."""

    rules: ClassVar[tuple[Rule, ...]] = (
        few_samples(MAX_SIZE_PX, {"width": _DEFAULTS.width, "height": _DEFAULTS.height}),
        within_half("cx_offset", "width", _DEFAULTS.width),
        within_half("cy_offset", "height", _DEFAULTS.height),
        _makes_a_lens,
        _measures_from_one_point,
    )

    width: _Size = Field(default=_DEFAULTS.width, description="of its pictures [px]")
    height: _Size = Field(default=_DEFAULTS.height, description="of its pictures [px]")
    vertical_fov: Annotated[float, Number.within(INTRINSICS_LIMITS["vertical_fov_deg"])] = Field(
        default=_DEFAULTS.vertical_fov_deg,
        description="full vertical angle of view, without distortion at most 170 [deg]",
    )
    cx_offset: _Offset = Field(
        default=_DEFAULTS.cx_offset_px,
        description="from the picture's centre to the optical axis, to the right [px]",
    )
    cy_offset: _Offset = Field(
        default=_DEFAULTS.cy_offset_px,
        description="from the picture's centre to the optical axis, down [px]",
    )
    fx: _Focal = Field(
        default=_DEFAULTS.fx_px,
        description="focal length across [px], instead of `vertical_fov`; 0: follows from it; "
        "of `orthographic` [px/m]",
    )
    fy: _Focal = Field(default=_DEFAULTS.fy_px, description="focal length down [px], beside `fx`")
    distortion_model: Annotated[str, Text(r".{0,60}", "the name of a model of lenses")] = Field(
        default=_DEFAULTS.distortion_model, description="one of the [models](cameras.md#models)"
    )
    distortion: tuple[_Coefficient, ...] = Field(
        default=_DEFAULTS.distortion, max_length=12, description="the model's coefficients"
    )
    max_angle: Annotated[float, Number.within(INTRINSICS_LIMITS["max_angle_deg"])] = Field(
        default=_DEFAULTS.max_angle_deg,
        description="where the image circle ends, from the axis [deg]; 0: where the model does",
    )

    def lens(self, **clip_distances: Any) -> CameraIntrinsics:
        """Return the data type: with ``near_m`` and ``far_m``, or the usual ones."""
        numbers: dict[str, Any] = {name: getattr(self, key) for key, (name, _) in _NUMBERS.items()}
        return CameraIntrinsics(
            **numbers,
            distortion_model=self.distortion_model,
            distortion=self.distortion,
            **clip_distances,
        )
