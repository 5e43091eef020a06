"""Checks of arguments that several operations share: name and value in, the value to use out."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import MAX_RADIANCE
from sailenv_ros.types.listed_views import Views
from sailenv_ros.types.validation import SEED, Bounds, checked_flag, is_integer, is_number, vector
from sailenv_ros.types.views import checked_views

__all__ = [
    "behaviour",
    "declared_checks",
    "force",
    "number",
    "object_reference",
    "optional",
    "pose",
    "pose_of",
    "radiance",
    "scale",
    "seed",
    "text",
    "texts",
    "track",
    "view_names",
]

T = TypeVar("T")


def optional(check: Callable[[str, Any], T]) -> Callable[[str, Any], T | None]:
    """Return a check that lets None pass."""
    return lambda what, value: None if value is None else check(what, value)


def text(what: str, value: object) -> str:
    """Check a text that can be written to a file and sent over ROS."""
    if not isinstance(value, str) or "\0" in value or _HALF.search(value):
        raise InvalidRequest(what, value, "a text without a NUL or half a character")
    return value


_HALF = re.compile("[\ud800-\udfff]")
"""Half of a character, which JSON can tell and no file has."""


def texts(what: str, value: object) -> tuple[str, ...]:
    """Check a collection of texts, which is not one text."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise InvalidRequest(what, value, "a list of texts")
    return tuple(text(what, item) for item in value)


number = Bounds().number
"""Checks a finite number; truth values are none."""

seed = SEED.integer
"""Checks the seed of a random draw."""


def declared_checks(signature: inspect.Signature) -> dict[str, Callable[[str, Any], Any]]:
    """Return the checks of arguments that their declared types say: switches, optional names."""
    checks: dict[str, Callable[[str, Any], Any]] = {
        "bool": checked_flag,
        "bool | None": optional(checked_flag),
        "str | None": optional(text),
    }
    return {
        parameter.name: checks[parameter.annotation]
        for parameter in signature.parameters.values()
        if parameter.annotation in checks
    }


def pose(what: str, value: object) -> Pose:
    """Check a pose."""
    if not isinstance(value, Pose):
        raise InvalidRequest(what, value, "a sailenv_ros.types.geometry.Pose")
    return value


def pose_of(position: ArrayLike | None, rotation: ArrayLike | None, given: Pose | None) -> Pose:
    """Return the pose that is given, or that of a position [m] and roll, pitch, yaw [deg].

    Raises
    ------
    InvalidRequest
        If both are given.
    """
    if given is None:
        zero = (0.0, 0.0, 0.0)
        return Pose.from_rpy_deg(
            zero if position is None else position, zero if rotation is None else rotation
        )
    if position is not None or rotation is not None:
        raise InvalidRequest("pose", given, "left out where position or rotation is given")
    return given


def scale(what: str, value: Any) -> tuple[float, float, float]:
    """Check one factor, or three along the axes."""
    factors = vector(what, (value, value, value) if is_number(value) else value)
    if not any(factors):
        # In a message it would mean 1.
        raise InvalidRequest(what, factors, "one number, or three, from 0.001 to 1000")
    return factors


def radiance(what: str, value: ArrayLike) -> tuple[float, float, float]:
    """Check a linear colour."""
    return vector(what, value, limit=MAX_RADIANCE)


def force(what: str, value: ArrayLike) -> tuple[float, float, float]:
    """Check a force [N] or a torque [N m]."""
    return vector(what, value, limit=1e6)


def behaviour(what: str, value: object) -> Mapping[str, Any]:
    """Check a behaviour as a scene file describes it: its ``type`` and its parameters."""
    if not isinstance(value, Mapping) or not isinstance(value.get("type"), str):
        raise InvalidRequest(what, value, "a mapping with its type and parameters")
    return value


def view_names(what: str, value: Views) -> tuple[str, ...]:
    """Check names of views, or the name of one."""
    return checked_views(value)


def object_reference(what: str, value: object) -> int | str:
    """Check an instance id, or the name of an object."""
    if isinstance(value, str):
        return text(what, value)
    if not is_integer(value):
        raise InvalidRequest("object", value, "an instance id, or the name of an object")
    return int(value)


def track(what: str, value: object) -> tuple[Pose, ...]:
    """Check waypoints: poses, or pairs of a position [m] and roll, pitch, yaw [deg]."""
    if isinstance(value, str) or not isinstance(value, Iterable):
        raise InvalidRequest(what, value, "a list of sailenv_ros.types.geometry.Pose")
    return tuple(_waypoint(item) for item in value)


def _waypoint(value: Any) -> Pose:
    if isinstance(value, Pose):
        return value
    if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != 2:
        raise InvalidRequest("waypoint", value, "a Pose, or a pair of position and rotation")
    return Pose.from_rpy_deg(value[0], value[1])
