"""Cameras of a recipe: where they stand, where they look, how they go."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeAlias

from pydantic import Field

from sailenv_ros.authoring.viewpoints.rule_table import camera_rules, checked_rule
from sailenv_ros.errors import InvalidEntry
from sailenv_ros.scene.field_types import Choice, Number, Text, Vector, optional
from sailenv_ros.scene.fields import Fraction, Name, Position, Rule
from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.placing import Aimed, Turned
from sailenv_ros.scene.randomise.selectors import WhichObjects
from sailenv_ros.scene.rules import at_most_one
from sailenv_ros.scene.spec_lens import LensSpec
from sailenv_ros.scene.spec_picture import PictureSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.validation import is_finite_number

__all__ = [
    "AgentCamera",
    "AnyCamera",
    "CameraModel",
    "FixedCamera",
    "MountedCamera",
    "OrbitCamera",
    "Range",
    "RuleCamera",
    "WalkCamera",
    "carriers_stand",
    "ordered",
]

Range: TypeAlias = tuple[float, float]

_Metres: TypeAlias = Annotated[float, Number(least=0.0, most=1e3, unit="m")]
_Degrees: TypeAlias = Annotated[float, Number(least=-90.0, most=90.0, unit="deg")]
_Turn: TypeAlias = Annotated[float, Number(least=-720.0, most=720.0, unit="deg/s")]
_Speed: TypeAlias = Annotated[float, Number(least=0.0, most=20.0, unit="m/s")]
_ENDS = Vector(2, "two numbers [lowest, highest], or one for both", one_for_all=True)


def ordered(*keys: str) -> Rule:
    """Make the rule that ranges begin with their lower end."""

    def rule(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
        for key in keys:
            ends = entry.get(key)
            if not isinstance(ends, list | tuple) or len(ends) != len(("lowest", "highest")):
                continue
            if all(map(is_finite_number, ends)) and ends[0] > ends[1]:
                yield (key,), f"must begin with the lower end, got {list(ends)}"

    return rule


class CameraModel(LensSpec):
    """Base of all cameras of a data set, which see each clip at the same time."""

    name: Annotated[
        str,
        Text(
            r"[a-z][a-z0-9_]{0,50}",
            "a lower-case letter, then lower-case letters, digits or underscores, at most 51",
        ),
    ] = Field(default="camera", description="unique among the cameras of the recipe")
    picture: PictureSpec = Field(
        default_factory=PictureSpec, description="exposure, tone curve, noise of its pictures"
    )

    @property
    def intrinsics(self) -> CameraIntrinsics:
        """Of its pictures."""
        return self.lens()


class AgentCamera(CameraModel):
    """Moves as an agent of the scene does, by its mover."""

    type: Literal["agent"] = Field(description="as an agent of the scene moves")
    agent: Name | None = optional(
        "which; if left out the scene's first, or its first mover where it has none"
    )


class FixedCamera(CameraModel, Aimed):
    """Stands where the recipe says."""

    rules: ClassVar[tuple[Rule, ...]] = (*CameraModel.rules, *Aimed.rules)

    type: Literal["fixed"] = Field(description="at one place")
    position: Position = Field(description="where it stands [m]")


def _settings_fit(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Return which settings the rule does not have, or not so."""
    rule, settings = entry.get("rule"), entry.get("settings", {})
    if rule not in camera_rules() or not isinstance(settings, Mapping):
        return
    try:
        checked_rule(str(rule), settings)
    except InvalidEntry as problem:
        for name, why in problem.diagnostics:
            yield ("settings", *name.split(".")), why


class RuleCamera(CameraModel):
    """Stands where a rule for cameras puts it, another place in each clip."""

    rules: ClassVar[tuple[Rule, ...]] = (*CameraModel.rules, ordered("turn"), _settings_fit)

    type: Literal["rule"] = Field(description="where a rule puts it, such as free_view")
    rule: Annotated[str, Choice(tuple(camera_rules()))] = Field(
        description="free_view: anywhere in free space; room_view: across the room; object_view: "
        "an object fills a share of the picture; coverage: all objects are seen"
    )
    settings: dict[str, Any] = Field(
        default_factory=dict, description="of the rule, those that differ from its own"
    )
    turn: Annotated[tuple[_Turn, _Turn], _ENDS] = Field(
        default=(0.0, 0.0), description="range of its turning about the vertical [deg/s]"
    )


class WalkCamera(CameraModel):
    """Walks through free space on shortest paths from one random place to the next."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *CameraModel.rules,
        ordered("eye_height", "pitch", "speed"),
    )

    type: Literal["walk"] = Field(description="along paths through free space")
    eye_height: Annotated[tuple[_Metres, _Metres], _ENDS] = Field(
        default=(0.8, 1.8), description="range of its height above the floor [m]"
    )
    pitch: Annotated[tuple[_Degrees, _Degrees], _ENDS] = Field(
        default=(-10.0, 35.0), description="range of its angle below the horizon [deg]"
    )
    clearance: _Metres = Field(
        default=0.25, description="nothing stands nearer to it, at any height [m]"
    )
    speed: Annotated[tuple[_Speed, _Speed], _ENDS] = Field(
        default=(0.4, 1.0), description="range of speeds [m/s]"
    )
    filled: Fraction = Field(
        default=0.0,
        description="least share of the picture that objects take all the way, not walls, floor "
        "and ceiling; the best of 24 walks where none has it",
    )


class OrbitCamera(CameraModel):
    """Looks at an object, or at a point, from around it."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *CameraModel.rules,
        at_most_one("object", "point"),
        ordered("distance", "elevation", "turn"),
    )

    type: Literal["orbit"] = Field(description="around an object or a point")
    object: WhichObjects | None = optional(
        "an object's name, a pattern or a category, or several; one of these each time"
    )
    point: Position | None = optional("instead of an object [m]")
    distance: Annotated[tuple[_Metres, _Metres], _ENDS] = Field(
        default=(0.8, 2.5), description="range of distances from its middle [m]"
    )
    elevation: Annotated[tuple[_Degrees, _Degrees], _ENDS] = Field(
        default=(10.0, 50.0), description="range of angles above the horizon [deg]"
    )
    turn: Annotated[tuple[_Turn, _Turn], _ENDS] = Field(
        default=(0.0, 0.0), description="range of its way around [deg/s]"
    )


class MountedCamera(CameraModel, Turned):
    """Is carried by another camera of the recipe: with it, it is a rig."""

    rules: ClassVar[tuple[Rule, ...]] = (*CameraModel.rules, *Turned.rules)

    type: Literal["mounted"] = Field(description="on another camera of the recipe, as in a rig")
    on: Name = Field(description="the camera that carries it")
    position: Position = Field(
        default=(0.0, 0.0, 0.0), description="in the frame of that camera's body [m]"
    )

    @property
    def extrinsics(self) -> Pose:
        """Its pose in the frame of the body of the camera that carries it."""
        return self.pose_at(self.position)


def carriers_stand(recipe: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Refuse a camera that is mounted on one that is not there, or is mounted itself."""
    listed = recipe.get("cameras")
    entries = listed if isinstance(listed, list | tuple) else ()
    cameras = [one for one in entries if isinstance(one, Mapping)]
    free = [str(one.get("name", "camera")) for one in cameras if one.get("type") != "mounted"]
    for index, one in enumerate(entries):
        carrier = one.get("on") if isinstance(one, Mapping) else None
        if isinstance(carrier, str) and one.get("type") == "mounted" and carrier not in free:
            near = suggestion(carrier, free, listing="there are")
            yield ("cameras", index, "on"), f"must be a camera that is not mounted itself; {near}"


AnyCamera: TypeAlias = Annotated[
    AgentCamera | FixedCamera | RuleCamera | WalkCamera | OrbitCamera | MountedCamera,
    Field(discriminator="type"),
]
