"""Finished light, for what must not depend on how far a bake is. From `World` to `World`."""

from __future__ import annotations

from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.light_files import light_folder, load_baked, store_baked
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.simulation.room_exposure import take_light
from sailenv_ros.system.files import file_lock
from sailenv_ros.world.world import World

__all__ = ["bake_missing"]

BAKE_TIMEOUT_S = 3600.0
"""Time limit of waiting for another process that bakes the same room [s]."""


def bake_missing(world: World) -> None:
    """Load the finished light of a room's world; bake it if it is not there.

    Raises
    ------
    MissingPackage
        If it cannot be baked here.
    StorageError
        If it cannot be kept.
    DeadlineExceeded
        If another process baked it for more than an hour.
    """
    if world.contents.baked is not None or world.described is None:
        return
    if world.described.room is None:
        return
    snapshot = world.snapshot()
    name = fingerprint(snapshot)
    # Another process may be baking it: then its light is waited for.
    lock = light_folder() / f".baking-{name[0]}.lock"
    with file_lock(lock, "baked light", timeout_s=BAKE_TIMEOUT_S):
        baked = load_baked(name)
        if baked is None:
            baked = bake(snapshot)
            store_baked(baked)
    take_light(world, baked)
