"""Exposure of rooms whose scene leaves it to the light. From baked light to a world's surroundings.

As a photographer who takes pictures of a room chooses one exposure for all of them.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from sailenv_ros.render.picture.auto_exposure import metered_exposure
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.lights import Light
from sailenv_ros.world.world import World

__all__ = ["is_metered", "meter", "room_exposure", "take_light"]


def take_light(world: World, baked: BakedLight) -> None:
    """Give a world its baked light, and the exposure for it where that is measured."""
    world.set_baked(baked)
    meter(world)


def is_metered(world: World) -> bool:
    """Return whether a world's exposure is measured: in baked rooms whose scene wants that."""
    baked, described = world.contents.baked, world.described
    if baked is None or not len(baked.seen) or described is None or described.room is None:
        return False
    return described.environment.is_metered


def meter(world: World) -> None:
    """Measure a world's exposure, where that is wanted."""
    baked = world.contents.baked
    if baked is not None and is_metered(world):
        assert world.described is not None
        wanted = world.described.environment.wanted_exposure
        stops = room_exposure(baked, world.contents.lights, wanted)
        world.set_environment(replace(world.contents.environment, exposure=stops))
        world.set_baked(baked)


def room_exposure(baked: BakedLight, lights: Iterable[Light], wanted: float | None = None) -> float:
    """Return the stops for a room in its baked light, to a hundredth; see `metered_exposure`.

    Parameters
    ----------
    baked : BakedLight
    lights : iterable of Light
        As bright as they are; those that were not baked do not count.
    """
    shining = {light.name: light for light in lights}
    seen = np.zeros((len(baked.seen), 3))
    for layer, radiance in zip(baked.layers, baked.seen.swapaxes(0, 1), strict=True):
        if layer.light is None:
            seen += radiance
        elif light := shining.get(layer.light.name):
            seen += radiance * np.asarray(light.power)
    return round(metered_exposure(seen, wanted), 2)
