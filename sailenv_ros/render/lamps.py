"""Which lamps are drawn in real time: the same for every back end."""

from __future__ import annotations

from collections.abc import Iterable

from sailenv_ros.lights import Light
from sailenv_ros.render.lightmap_compositing import strength

__all__ = ["MAX_LIGHTS", "strongest_lamps"]

MAX_LIGHTS = 16
"""Lights that are taken into account, the strongest first."""


def strongest_lamps(lamps: Iterable[Light]) -> list[Light]:
    """Return the lamps that shine, the strongest first, at most `MAX_LIGHTS`."""
    shining = [light for light in lamps if light.intensity > 0.0]
    return sorted(shining, key=strength, reverse=True)[:MAX_LIGHTS]
