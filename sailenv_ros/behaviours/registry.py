"""Which behaviours exist, and how one is checked and started.

Names of generators: a behaviour's random numbers depend on the world's seed, the object's name
and the behaviour's place in the object's list, and on nothing else.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from pydantic import ValidationError

from sailenv_ros.behaviours.base import BehaviourKind, RunningBehaviour
from sailenv_ros.behaviours.rotate_rigidbody import rotate_rigidbody
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.kinds import FAULT

__all__ = ["behaviour_faults", "behaviour_kinds", "start_behaviour"]

_KINDS: Mapping[str, BehaviourKind] = MappingProxyType(
    {kind.type: kind for kind in (rotate_rigidbody,)}
)


def behaviour_kinds() -> Mapping[str, BehaviourKind]:
    """Give every known kind by its type; read-only."""
    return _KINDS


def behaviour_faults(
    type_: str, parameters: Mapping[str, Any]
) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Yield what is wrong with a behaviour: the place inside it, and a sentence."""
    if type_ not in _KINDS:
        yield ("type",), str(UnknownName("behaviour", type_, _KINDS))
        return
    try:
        _KINDS[type_].parameters.model_validate(dict(parameters))
    except ValidationError as error:
        for fault in error.errors(include_url=False):
            yield tuple(fault["loc"]), _sentence(type_, fault)


def start_behaviour(
    type_: str,
    parameters: Mapping[str, Any],
    *,
    seed: int,
    object_name: str,
    place: int,
    start_s: float = 0.0,
) -> RunningBehaviour:
    """Check a behaviour's parameters and give it a generator of its own.

    Raises
    ------
    InvalidRequest
        If the type is unknown or a parameter is wrong.
    """
    for path, message in behaviour_faults(type_, parameters):
        field = ".".join(str(part) for part in path)
        raise InvalidRequest(
            f"behaviour {type_!r} of {object_name!r}",
            dict(parameters),
            f"right in every parameter ({field} {message})",
        )
    kind = _KINDS[type_]
    entropy = (seed & 0xFFFFFFFF, zlib.crc32(object_name.encode()), place)
    return RunningBehaviour(
        kind=kind,
        parameters=kind.parameters.model_validate(dict(parameters)),
        rng=np.random.default_rng(np.random.SeedSequence(entropy)),
        start_s=start_s,
    )


def _sentence(type_: str, fault: Any) -> str:
    if fault["type"] == "extra_forbidden":
        known = ", ".join(_KINDS[type_].parameters.model_fields)
        return f"is not a parameter of {type_}; its parameters are: {known}"
    if fault["type"] == FAULT:
        return str(fault["ctx"]["sentence"])
    if fault["type"] == "missing":
        return "is missing"
    return f"{fault['msg'][0].lower()}{fault['msg'][1:]}, got {fault['input']!r}"
