"""Registry of the behaviours; checks and starts them.

Names of generators: a behaviour's random numbers depend on the world's seed, the object's name
and the behaviour's place in the object's list, and on nothing else.
"""

from __future__ import annotations

import importlib
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

import numpy as np
from pydantic import ValidationError

from sailenv_ros.behaviours.base import BehaviourKind, RunningBehaviour
from sailenv_ros.behaviours.fetch import fetch
from sailenv_ros.behaviours.joint_motion import open_and_close
from sailenv_ros.behaviours.lie import lie
from sailenv_ros.behaviours.open_by_hand import open_by_hand
from sailenv_ros.behaviours.play_clip import play_clip
from sailenv_ros.behaviours.poltergeist import poltergeist
from sailenv_ros.behaviours.rotate_rigidbody import rotate_rigidbody
from sailenv_ros.behaviours.sit import sit
from sailenv_ros.behaviours.uniform_movement import uniform_movement_random_bounce
from sailenv_ros.behaviours.visit import visit
from sailenv_ros.behaviours.walk_around import walk_around
from sailenv_ros.behaviours.wander_plane import wander_plane
from sailenv_ros.behaviours.waypoints import catmull_waypoints, linear_waypoints
from sailenv_ros.behaviours.wrench import wrench
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.field_types import FIELD_ERROR

__all__ = [
    "behaviour_errors",
    "behaviour_kinds",
    "known_behaviour_errors",
    "readable_behaviour_errors",
    "refusing_behaviour_errors",
    "start_behaviour",
]

_KINDS: Mapping[str, BehaviourKind] = MappingProxyType(
    {
        kind.type: kind
        for kind in (
            rotate_rigidbody,
            poltergeist,
            wander_plane,
            uniform_movement_random_bounce,
            linear_waypoints,
            catmull_waypoints,
            wrench,
            open_and_close,
            walk_around,
            sit,
            lie,
            fetch,
            open_by_hand,
            play_clip,
            visit,
        )
    }
)

_users: dict[str, BehaviourKind] = {}
"""Kinds from users' modules by ``module:name``, once a scene file has named them."""


def behaviour_kinds() -> Mapping[str, BehaviourKind]:
    """Return every known kind by its type; read-only."""
    return _KINDS


def behaviour_errors(
    type_: str, parameters: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a behaviour: the place inside it, and a sentence.

    A type ``module:name`` is imported, which runs code: for files whose user allows it, not for
    what comes over a network.
    """
    if ":" in type_ and type_ not in _users:
        problem = _load_users(type_)
        if problem:
            yield ("type",), problem
            return
    yield from known_behaviour_errors(type_, parameters)


def refusing_behaviour_errors(
    type_: str, parameters: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a behaviour; one of a module whose code was not run is a fault."""
    if ":" in type_ and type_ not in _users:
        module = type_.partition(":")[0]
        yield (
            ("type",),
            f"{type_!r} would run the code of the Python module {module!r}; if you trust it, allow "
            "that: --allow-modules (sailenv), allow_modules:=true (sim_node), allow_modules=True "
            "(Simulation)",
        )
        return
    yield from known_behaviour_errors(type_, parameters)


def readable_behaviour_errors(
    type_: str, parameters: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a behaviour; one of a module whose code was not run is unchecked."""
    if ":" not in type_ or type_ in _users:
        yield from known_behaviour_errors(type_, parameters)


def known_behaviour_errors(
    type_: str, parameters: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a behaviour, as `behaviour_errors`, but import nothing."""
    kind = _kind(type_)
    if kind is None:
        yield ("type",), str(UnknownName("behaviour", type_, {**_KINDS, **_users}))
        return
    try:
        kind.parameters.model_validate(dict(parameters))
    except ValidationError as error:
        for details in error.errors(include_url=False):
            yield tuple(details["loc"]), _sentence(kind, details)


def start_behaviour(
    type_: str,
    parameters: Mapping[str, Any],
    *,
    seed: int,
    object_name: str,
    place: int,
    start_s: float = 0.0,
) -> RunningBehaviour:
    """Check a behaviour's parameters and return its own generator.

    Raises
    ------
    InvalidRequest
        If the type is unknown or a parameter is wrong.
    """
    for path, message in known_behaviour_errors(type_, parameters):
        field = ".".join(str(part) for part in path)
        raise InvalidRequest(
            f"behaviour {type_!r} of {object_name!r}",
            dict(parameters),
            f"right in every parameter ({field} {message})",
        )
    kind = _kind(type_)
    assert kind is not None
    checked = kind.parameters.model_validate(dict(parameters))
    used_seed = seed if checked.seed is None else checked.seed
    # Both halves of the seed, so that seeds that agree in one still differ.
    entropy = [used_seed & 0xFFFFFFFF, zlib.crc32(object_name.encode()), place]
    if used_seed >> 32:
        entropy.append(used_seed >> 32)
    return RunningBehaviour(
        kind=kind,
        parameters=checked,
        rng=np.random.default_rng(np.random.SeedSequence(entropy)),
        start_s=start_s,
    )


def _kind(type_: str) -> BehaviourKind | None:
    return _KINDS.get(type_) or _users.get(type_)


def _load_users(type_: str) -> str:
    """Import a user's behaviour; return a sentence of what is wrong, empty if nothing is."""
    module_name, _, name = type_.partition(":")
    try:
        module = importlib.import_module(module_name)
    except Exception as problem:  # whatever a user's module raises while it is imported
        return f"{type_!r}: module {module_name!r} cannot be imported: {problem}"
    kind = getattr(module, name, None)
    if not isinstance(kind, BehaviourKind):
        kinds = [key for key, value in vars(module).items() if isinstance(value, BehaviourKind)]
        return (
            f"{type_!r}: {module_name!r} has no behaviour {name!r}; "
            f"it has: {', '.join(kinds) or 'none'}"
        )
    # Under the name that scene files and answers have for it.
    _users[type_] = replace(kind, type=type_)
    return ""


def _sentence(kind: BehaviourKind, details: Any) -> str:
    if details["type"] == "extra_forbidden":
        known = ", ".join(kind.parameters.model_fields)
        return f"is not a parameter of {kind.type}; its parameters are: {known}"
    if details["type"] == FIELD_ERROR:
        return str(details["ctx"]["sentence"])
    if details["type"] == "missing":
        return "is missing"
    return f"{details['msg'][0].lower()}{details['msg'][1:]}, got {details['input']!r}"
