"""The light of rooms that a caller chooses: the same words wherever it is asked for."""

from __future__ import annotations

from typing import Literal, TypeAlias, get_args

from sailenv_ros.errors import UnknownName

__all__ = ["LIGHTS", "STEADY_LIGHTS", "LightChoice", "SteadyLight", "checked_light"]

SteadyLight: TypeAlias = Literal["baked", "plain"]
"""``baked``: the finished light of a room, and nothing else; ``plain``: without bounced light,
whatever is baked. What is seen depends on nothing that happens to be on the machine."""

LightChoice: TypeAlias = Literal["newest"] | SteadyLight
"""``newest``: what is baked by now, or is being baked, if anything is; or a `SteadyLight`."""

STEADY_LIGHTS: tuple[SteadyLight, ...] = get_args(SteadyLight)

LIGHTS: tuple[LightChoice, ...] = ("newest", *STEADY_LIGHTS)


def checked_light(value: str, choices: tuple[str, ...] = LIGHTS) -> None:
    """Refuse what is none of the choices.

    Raises
    ------
    UnknownName
        With those that there are.
    """
    if value not in choices:
        raise UnknownName("light", str(value), choices)
