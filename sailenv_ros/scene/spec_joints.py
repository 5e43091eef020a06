"""The joint of an object of a scene file: on what it turns or slides."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number, optional
from sailenv_ros.scene.fields import (
    Direction,
    JointCoordinate,
    JointLimits,
    Name,
    Position,
    Rule,
    SceneModel,
)
from sailenv_ros.scene.messages import shown, suggestion
from sailenv_ros.scene.rules import Entry, Faults, at_most_one
from sailenv_ros.types.joints import JOINT_LIMITS, Detents, SoftClose
from sailenv_ros.types.validation import is_finite_number, shown_number

__all__ = ["DetentsSpec", "JointSpec", "SoftCloseSpec", "joints_hold", "on_a_joint"]

_JOINTS = ("hinge", "slide", "fixed", "free")
_FOR_MOVING = (
    *("axis", "limits", "position", "velocity", "damping", "friction", "effort"),
    *("soft_close", "detents"),
)
_PLACED_OTHERWISE = ("on", "wall", "velocity", "angular_velocity")


def _axis_has_length(entry: Mapping[str, Any]) -> Faults:
    axis = entry.get("axis")
    if not isinstance(axis, Sequence) or len(axis) != 3 or not all(map(is_finite_number, axis)):
        return
    if math.hypot(*axis) < 1e-9:
        yield ("axis",), "must be three numbers [x, y, z], not all 0"


def _limits_in_order(entry: Mapping[str, Any]) -> Faults:
    limits, position = entry.get("limits"), entry.get("position")
    if not isinstance(limits, Sequence) or isinstance(limits, str) or len(limits) != 2:
        return
    if not all(map(is_finite_number, limits)):
        return
    low, high = limits
    if low >= high:
        yield ("limits",), f"must be [low, high] with low below high, got {shown(list(limits))}"
    elif is_finite_number(position) and not low <= position <= high:
        yield (
            ("position",),
            f"must be within the limits, from {shown_number(low)} to {shown_number(high)}, "
            f"got {shown_number(position)}",
        )


def _fixed_is_fixed(entry: Mapping[str, Any]) -> Faults:
    if entry.get("type") == "free" and entry.get("parent") is not None:
        yield ("parent",), "cannot be given to what moves freely"
    if entry.get("type") in ("fixed", "free"):
        for key in _FOR_MOVING:
            if entry.get(key) is not None:
                yield (key,), "means something only for a hinge or a slide"


_DEFAULTS = SoftClose(within=1.0, speed=1.0)


def _shuts_at_a_limit(entry: Entry) -> Faults:
    if entry.get("soft_close") is not None and entry.get("limits") is None:
        yield ("soft_close",), "needs limits, at one of which the joint is shut"


def _detents_within_limits(entry: Entry) -> Faults:
    detents, limits = entry.get("detents"), entry.get("limits")
    if not isinstance(detents, Mapping) or not isinstance(limits, Sequence) or len(limits) != 2:
        return
    if not all(map(is_finite_number, limits)):
        return
    (low, high), at = limits, detents.get("at")
    accepted = f"must be within the limits, from {shown_number(low)} to {shown_number(high)}"
    for index, place in enumerate(at if isinstance(at, Sequence) else ()):
        if is_finite_number(place) and not low <= place <= high:
            yield ("detents", "at", index), f"{accepted}, got {shown_number(place)}"
    every = detents.get("every")
    if is_finite_number(every) and every > 0.0 and math.ceil(low / every) * every > high:
        yield ("detents", "every"), f"has no multiple {accepted.removeprefix('must be ')}"


def _detents_are_somewhere(entry: Entry) -> Faults:
    at = entry.get("at")
    if entry.get("every") is None and at is None:
        yield ("every",), "is needed, or at: where a joint has its detents"
    if isinstance(at, Sequence) and len(set(map(repr, at))) < 2 and entry.get("within") is None:
        yield ("within",), "is needed beside a single detent"


def _within_limits(name: str) -> Number:
    return Number.within(JOINT_LIMITS[name])


class SoftCloseSpec(SceneModel):
    """Damper and spring that shut a joint."""

    within: Annotated[float, _within_limits("within")] = Field(
        description="distance from the end at which it acts [rad] or [m]"
    )
    speed: Annotated[float, _within_limits("speed")] = Field(
        description="at the end at most, and with which it shuts by itself [rad/s] or [m/s]"
    )
    strength: Annotated[float, _within_limits("strength")] = Field(
        default=_DEFAULTS.strength,
        description="of its spring, friction included [N m] or [N]",
    )
    end: Annotated[Literal["low", "high"], Choice(("low", "high"))] = Field(
        default=_DEFAULTS.end, description="limit at which it is shut"
    )

    def to_soft_close(self) -> SoftClose:
        """Return the data type that the simulation takes."""
        return SoftClose(within=self.within, speed=self.speed, strength=self.strength, end=self.end)


class DetentsSpec(SceneModel):
    """Positions at which a joint clicks."""

    rules: ClassVar[tuple[Rule, ...]] = (at_most_one("every", "at"), _detents_are_somewhere)

    strength: Annotated[float, _within_limits("strength")] = Field(
        description="that takes it out of one, friction included; half pulls in [N m] or [N]"
    )
    every: Annotated[float, _within_limits("within")] | None = optional(
        "distance between them, from 0 [rad] or [m]"
    )
    at: Annotated[tuple[JointCoordinate, ...], Field(min_length=1)] | None = optional(
        "their places, instead of every [rad] or [m]"
    )
    within: Annotated[float, _within_limits("within")] | None = optional(
        "distance at which they pull [rad] or [m]; default: half of that between two"
    )

    def to_detents(self) -> Detents:
        """Return the data type that the simulation takes."""
        return Detents(
            strength=self.strength, every=self.every, at=self.at or (), within=self.within
        )


class JointSpec(SceneModel):
    """Joint of an object: its parent, its axis and its limits."""

    rules: ClassVar[tuple[Rule, ...]] = (
        *(_axis_has_length, _limits_in_order, _fixed_is_fixed),
        *(_shuts_at_a_limit, _detents_within_limits),
    )

    type: Annotated[Literal["hinge", "slide", "fixed", "free"], Choice(_JOINTS)] = Field(
        description="hinge: turns about the axis (revolute); slide: moves along it (prismatic); "
        "fixed: goes with its parent; free: moves freely, may carry others"
    )
    parent: Name | None = optional(
        "object that carries it, static or on a joint; position and rotation are relative "
        "to it; default: the world"
    )
    axis: Direction = Field(default=(0.0, 0.0, 1.0), description="in the object's own frame")
    origin: Position = Field(
        default=(0.0, 0.0, 0.0),
        description="a point of a hinge's axis in the object's unscaled frame [m]",
    )
    limits: JointLimits | None = optional(
        "least and greatest position [rad] or [m]; default: unlimited"
    )
    position: JointCoordinate | None = optional(
        "at the start [rad] or [m]; default: 0, or the nearest limit"
    )
    velocity: JointCoordinate = Field(default=0.0, description="at the start [rad/s] or [m/s]")
    damping: Annotated[float, Number(least=0.0, most=1e6)] = Field(
        default=0.0, description="against its speed [N m s/rad] or [N s/m]"
    )
    friction: Annotated[float, Number(least=0.0, most=1e6)] = Field(
        default=1.0,
        description="torque [N m] or force [N] below which it does not move",
    )
    effort: Annotated[float, Number(above=0.0, most=1e6)] = Field(
        default=100.0,
        description="largest torque [N m] or force [N] of set_joint_position and behaviours",
    )
    soft_close: SoftCloseSpec | None = optional("shuts it slowly, by itself")
    detents: DetentsSpec | None = optional("where it clicks")

    @property
    def moves(self) -> bool:
        """True if it is a hinge or a slide."""
        return self.type in ("hinge", "slide")

    @property
    def bounds(self) -> tuple[float, float]:
        """Its limits [rad] or [m]; infinite where it has none."""
        if not self.moves:
            return 0.0, 0.0
        return (-math.inf, math.inf) if self.limits is None else self.limits

    @property
    def start(self) -> float:
        """Its position at the start [rad] or [m]."""
        low, high = self.bounds
        return min(max(0.0, low), high) if self.position is None else self.position

    @property
    def unit_axis(self) -> tuple[float, float, float]:
        """The axis with the length 1."""
        length = math.hypot(*self.axis)
        x, y, z = (value / length for value in self.axis)
        return x, y, z


def on_a_joint(entry: Mapping[str, Any]) -> Faults:
    """Refuse what cannot stand beside a joint, and what needs one."""
    if entry.get("joint") is None:
        behaviours = entry.get("behaviours")
        for index, one in enumerate(behaviours if isinstance(behaviours, Sequence) else ()):
            if isinstance(one, Mapping) and one.get("type") == "open_and_close":
                yield ("behaviours", index), "needs an object that has a joint"
        return
    if entry.get("static") is True:
        yield ("static",), "cannot stand beside a joint; use a joint of type fixed"
    for key in _PLACED_OTHERWISE:
        value = entry.get(key)
        if isinstance(value, str) or (isinstance(value, Sequence) and any(value)):
            yield (key,), "cannot be given to an object that has a joint"


def joints_hold(scene: Mapping[str, Any]) -> Faults:
    """Refuse joints to what is missing, to what moves freely, and to themselves (by others too)."""
    objects = scene.get("objects")
    entries = list(objects) if isinstance(objects, list | tuple) else []
    named = {
        entry["name"]: entry
        for entry in entries
        if isinstance(entry, Mapping) and isinstance(entry.get("name"), str)
    }
    parents = {name: _parent_of(entry) for name, entry in named.items()}
    for index, entry in enumerate(entries):
        parent = _parent_of(entry) if isinstance(entry, Mapping) else None
        if parent is None:
            continue
        place = ("objects", index, "joint", "parent")
        if parent not in named:
            known = suggestion(parent, list(named), listing="its objects")
            yield place, f"the scene has no object {parent!r}; {known}"
        elif entry.get("name") in _above(parent, parents):
            yield place, "must not be an object that this one carries"
        elif named[parent].get("static") is not True and named[parent].get("joint") is None:
            yield place, f"must be static or have a joint itself, and {parent!r} moves freely"


def _parent_of(entry: Mapping[str, Any]) -> str | None:
    joint = entry.get("joint")
    parent = joint.get("parent") if isinstance(joint, Mapping) else None
    return parent if isinstance(parent, str) else None


def _above(name: str | None, parents: Mapping[str, str | None]) -> Iterator[str]:
    """Yield an object and all that carry it."""
    seen: set[str] = set()
    while name is not None and name not in seen:
        seen.add(name)
        yield name
        name = parents.get(name)
