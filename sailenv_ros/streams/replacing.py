"""Pieces of furniture that are replaced by others of their kind, in the same place.

A piece has a seed in its asset's name; another seed is another piece. It is scaled, by one factor,
into the box of the one before it, and to its height where something stands on it: nothing on it or
beside it has to move.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Instance

__all__ = ["fitting_scale", "replace_pieces"]

SCALES = 0.75, 1.25
"""By which a piece may be scaled."""

LEAST_SHARE, LEAST_TOP = 0.7, 0.9
"""Shares of the sizes of the piece before it that it has at least; of a top that carries things."""

SLACK = 1.02
"""A piece with things on it may be so many times as wide as the one before it."""

TRIES = 6
"""Seeds that are looked at until one fits."""

MOST_SEED = 99_999

INSIDE_M, ABOVE_M = 0.03, 0.5
"""The middle of what is in a piece, or under it, is so far below its top; of what stands on it, at
most so far above."""


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
        pose = poses[one.id]
        others = _seen_from(pose, np.delete(middles, place, axis=0))
        over = _is_over(one, others)
        below_top = others[:, 2] < one.high_m[2] - INSIDE_M
        if (over & below_top & (others[:, 2] > one.low_m[2] + INSIDE_M)).any():
            continue
        carries = bool((over & ~below_top & (others[:, 2] < one.high_m[2] + ABOVE_M)).any())
        dice = RandomStream("furniture", seed, room, one.name, count)
        _replace(core, one, pose, carries, dice)


def _replace(
    core: SynchronousSimulation, one: Instance, pose: Pose, carries: bool, dice: RandomStream
) -> None:
    for _ in range(TRIES):
        asset = core.library.assets.sibling(one.asset, dice.whole((0, MOST_SEED)))
        if asset is None:
            return
        bounds = core.library.assets.peek(asset).model.bounds().astype(np.float64)
        scale = fitting_scale(bounds, np.array([one.low_m, one.high_m]), carries=carries)
        if scale is not None:
            core.despawn_object(one.id)
            core.spawn_object(
                asset, pose=pose, scale=scale, object_name=one.name, category=one.category
            )
            return


def fitting_scale(
    bounds: NDArray[np.float64], before: NDArray[np.float64], *, carries: bool
) -> float | None:
    """Return the scale of a piece that stands at the origin of another; None if it does not fit.

    Parameters
    ----------
    bounds, before : (2, 3) float64
        Lowest and highest corner of its box, and of that of the piece before it [m].
    carries : bool
        Whether something stands on that, so that the height stays.
    """
    far = np.abs(bounds) > 1e-3
    ratios = np.where(far, before / np.where(far, bounds, 1.0), np.inf)
    scale = float(ratios.min())
    if carries:
        height = float(ratios[1, 2])
        if height > SLACK * scale:
            return None
        scale = height
    shares = scale * np.ptp(bounds, axis=0) / np.ptp(before, axis=0)
    fits = shares.min() >= LEAST_SHARE and (not carries or shares[:2].min() >= LEAST_TOP)
    return scale if fits and SCALES[0] <= scale <= SCALES[1] else None


def _middle(one: Instance, pose: Pose) -> NDArray[np.float64]:
    """Return (3,): the middle of an object's box, world frame [m]."""
    middle = 0.5 * np.add(one.low_m, one.high_m)
    world: NDArray[np.float64] = (pose.matrix() @ [*middle, 1.0])[:3]
    return world


def _seen_from(pose: Pose, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (N, 3) points in the frame of a pose [m]."""
    matrix = pose.matrix()
    own: NDArray[np.float64] = (points - matrix[:3, 3]) @ matrix[:3, :3]
    return own


def _is_over(one: Instance, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return (N,) bool: which points, in an object's frame, are within its outline from above."""
    low, high = np.array(one.low_m[:2]), np.array(one.high_m[:2])
    return np.asarray(((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1))
