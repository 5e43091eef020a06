"""Pieces of furniture that are replaced by others of their kind, in the same place.

A piece has a seed in its asset's name; another seed is another piece. It is scaled to the box of
the one before it, so that nothing that stands on it, or beside it, has to move.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Instance

__all__ = ["replace_pieces"]

STRETCH = 0.75, 1.35
"""How much a piece may be scaled along each axis."""

TRIES = 6
"""Seeds that are looked at until one fits."""

MOST_SEED = 99_999

INSIDE_M = 0.03
"""So far within a piece's box is the middle of what is inside it, or under it."""


def replace_pieces(
    core: SynchronousSimulation, objects: Sequence[Instance], lives: float, seed: int, room: str
) -> None:
    """Replace the furniture of a room as far as it is old.

    Parameters
    ----------
    core : SynchronousSimulation
    objects : sequence of Instance
        All objects of the room. Of these, pieces from a seed may go that stand still, have no
        joints, and have nothing inside.
    lives : float
        See `StreamState.furniture_lives`.
    seed : int
        Of the stream.
    room : str
    """
    jointed = {joint.parent for joint in core.get_joints()}
    poses = {one.id: core.get_object(one.name).pose for one in objects}
    middles = np.array([_middle(one, poses[one.id]) for one in objects]).reshape(-1, 3)
    for place, one in enumerate(objects):
        phase = RandomStream("furniture", seed, room, one.name).between((0.0, 1.0))
        count = int(lives + phase)
        if not count or not one.static or one.name in jointed:
            continue
        if not _has_inside(one, poses[one.id], np.delete(middles, place, axis=0)):
            dice = RandomStream("furniture", seed, room, one.name, count)
            _replace(core, one, poses[one.id], dice)


def _replace(core: SynchronousSimulation, one: Instance, pose: Pose, dice: RandomStream) -> None:
    wanted = np.subtract(one.high_m, one.low_m)
    for _ in range(TRIES):
        asset = core.library.assets.sibling(one.asset, dice.whole((0, MOST_SEED)))
        if asset is None:
            return
        low, high = core.library.assets.peek(asset).model.bounds().astype(np.float64)
        scale = wanted / np.maximum(high - low, 1e-6)
        if (scale < STRETCH[0]).any() or (scale > STRETCH[1]).any():
            continue
        x, y, z = (np.asarray(one.low_m) - scale * low).tolist()
        core.despawn_object(one.id)
        core.spawn_object(
            asset,
            pose=pose.carried(Pose((x, y, z))),
            scale=scale,
            object_name=one.name,
            category=one.category,
        )
        return


def _middle(one: Instance, pose: Pose) -> NDArray[np.float64]:
    """Return (3,): the middle of an object's box, world frame [m]."""
    middle = 0.5 * np.add(one.low_m, one.high_m)
    world: NDArray[np.float64] = (pose.matrix() @ [*middle, 1.0])[:3]
    return world


def _has_inside(one: Instance, pose: Pose, middles: NDArray[np.float64]) -> bool:
    """Return whether one of (N, 3) points is well within an object's box, or under its top."""
    matrix = pose.matrix()
    own = (middles - matrix[:3, 3]) @ matrix[:3, :3]
    low, high = np.array(one.low_m) + INSIDE_M, np.array(one.high_m) - INSIDE_M
    return bool(((own > low) & (own < high)).all(axis=1).any())
