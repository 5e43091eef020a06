"""Feet that stand in recorded motion: when, and where they are kept meanwhile."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Planting", "planted"]

Doubles = NDArray[np.float64]

_LOW, _SLOW = 0.055, 0.45
"""Of a ball that stands: its height over the leg's length, its speed over it [1/s]."""

_LEAST_S = 0.07
"""Shortest time for which a foot stands [s]."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Planting:
    """One foot of a clip.

    Attributes
    ----------
    stands : (F,) bool
    balls : (F, 3) float64
        Where the ball of the foot is to be, on the floor or in the air [m].
    moved : (F, 3) float64
        How far that is from where it was recorded [m].
    """

    stands: NDArray[np.bool_]
    balls: Doubles
    moved: Doubles

    def ankle(
        self, frame: int, after: int, share: float, recorded: Doubles, to_ball: Doubles
    ) -> Doubles:
        """Return where the ankle is to be.

        Parameters
        ----------
        frame, after, share
            Between which frames, and how far.
        recorded : (3,) float64
            Where it would be.
        to_ball : (3,) float64
            From the ankle to the ball of the foot.
        """
        if self.stands[frame] and self.stands[after]:
            return np.asarray(self.balls[frame] - to_ball)
        moved = (1.0 - share) * self.moved[frame] + share * self.moved[after]
        ankle = recorded + moved
        # Not into the floor with the ball.
        ankle[2] += max(0.0, -float(ankle[2] + to_ball[2]))
        return np.asarray(ankle)


def planted(balls: Doubles, frame_s: float, leg_m: float) -> Planting:
    """Find when a foot stands.

    Parameters
    ----------
    balls : (F, 3) float64
        Places of the ball of the foot, as recorded, over the floor [m].
    frame_s : float
        Time of a frame [s].
    leg_m : float
    """
    count = len(balls)
    step = np.linalg.norm(np.diff(balls, axis=0), axis=1) / frame_s
    speed = np.minimum(np.append(step, np.inf), np.insert(step, 0, np.inf))
    slow = speed < _SLOW * leg_m if count > 1 else np.ones(count, np.bool_)
    stands = slow & (balls[:, 2] < _LOW * leg_m)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], stands.astype(np.int8), [0]])))
    moved = np.full((count, 3), np.nan)
    kept = np.zeros(count, np.bool_)
    for begin, end in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if (end - begin) * frame_s < _LEAST_S and count > 1:
            continue
        x, y = balls[begin:end, :2].mean(axis=0).tolist()
        moved[begin:end] = [x, y, 0.0] - balls[begin:end]
        kept[begin:end] = True
    if not kept.any():
        return Planting(stands=kept, balls=balls, moved=np.zeros_like(balls))
    # In the air, gently from where it was kept to where it will be.
    frames, known = np.arange(count), np.flatnonzero(kept)
    for axis in range(3):
        moved[:, axis] = np.interp(frames, known, moved[known, axis])
    return Planting(stands=kept, balls=balls + moved, moved=moved)
