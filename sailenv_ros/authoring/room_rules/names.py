"""Names of generated scenes: ``generated:kitchen:17`` stands for the kitchen of seed 17."""

from __future__ import annotations

import re

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules
from sailenv_ros.errors import InvalidRequest

__all__ = ["FORM", "MAX_SEED", "PREFIX", "asked_for", "drawn_kind", "file_stem", "parsed_name"]

PREFIX = "generated:"
"""Prefix of the names of scenes that are generated on request."""

FORM = f"{PREFIX}KIND:SEED, such as {PREFIX}kitchen:17"
"""Their form, in words."""

MAX_SEED = 2**31 - 1

_NAME = re.compile(r"generated:([a-z][a-z0-9_]{0,62}):([0-9]{1,10})")
_STEM = re.compile(r"generated_([a-z][a-z0-9_]{0,62})_([0-9]{1,10})")


def parsed_name(name: str, rules: Rules) -> tuple[str, int]:
    """Return kind and seed of a name.

    Raises
    ------
    InvalidRequest
        If it is not ``generated:KIND:SEED``.
    UnknownName
        If there is no such kind.
    """
    match = _NAME.fullmatch(name)
    if match is None:
        kinds = ", ".join(sorted(rules.kinds))
        raise InvalidRequest("scene", name, f"generated:KIND:SEED with a KIND of: {kinds}")
    rules.kind(match[1])
    return match[1], int(match[2])


def file_stem(kind: str, seed: int) -> str:
    """Return the name of a generated scene's file without suffix, which the scene then has."""
    return f"generated_{kind}_{seed}"


def asked_for(scene: str) -> str:
    """Return the name by which a scene is asked for: of a generated one, with kind and seed."""
    match = _STEM.fullmatch(scene)
    return scene if match is None else f"{PREFIX}{match[1]}:{match[2]}"


def drawn_kind(seed: int, rules: Rules) -> str:
    """Return the kind of room that a seed stands for where none is asked for."""
    return RandomStream("kind", seed).one(sorted(rules.kinds))
