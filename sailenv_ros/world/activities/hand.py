"""An activity of a hand: it goes somewhere, stays there for a time, and comes back."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours.person import Activity
from sailenv_ros.postures.blending import JointTurns
from sailenv_ros.postures.footsteps import Moment, moment_of, standing_feet
from sailenv_ros.postures.grasping import Grip, Side
from sailenv_ros.postures.reaching import on_its_feet, reaching_posture
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.walking import walking_posture
from sailenv_ros.world.activities.base import Actor, Place, SpotActivity

__all__ = ["GRIP_S", "REACH_S", "HandActivity", "reaching_hand"]

Doubles = NDArray[np.float64]

REACH_S = 1.2
"""Time of the hand's way there, and of the way back [s]."""

GRIP_S = 0.2
"""Time in which the hand closes or opens [s]."""


class HandActivity(SpotActivity):
    """An activity of one hand.

    Parameters
    ----------
    actor : Actor
    stays_s : float
        Time between the way there and the way back [s].
    """

    def __init__(self, actor: Actor, stays_s: float) -> None:
        self._actor, self._stays_s = actor, stays_s
        self._done_s = 0.0

    @property
    def word(self) -> Activity:
        """Word for it now."""
        return "reaching"

    def end(self) -> None:
        """Nothing: it does not take long."""

    @property
    def _goes_on(self) -> bool:
        return self._done_s < 2.0 * REACH_S + self._stays_s

    @property
    def _share_of_time(self) -> float:
        """Share of the time of the way there: from 0 to 1, and back."""
        back = self._done_s - REACH_S - self._stays_s
        share = self._done_s / REACH_S if back < 0.0 else 1.0 - back / REACH_S
        return float(np.clip(share, 0.0, 1.0))

    def _closed(self, begins_s: float) -> float:
        """Return by which share fingers have closed that begin to at a time."""
        return float(np.clip((self._done_s - begins_s) / GRIP_S, 0.0, 1.0))

    def _between(self, begin: Posture, reaches: Posture, share: float, moment: Moment) -> Posture:
        """Return the posture at a share of the way from one posture to another."""
        rig = self._actor.rig
        one, two = (JointTurns.of(rig, each) for each in (begin, reaches))
        return on_its_feet(rig, one.towards(two, share).posture(rig), moment)


def reaching_hand(
    actor: Actor,
    grip: Grip,
    feet: Place,
    yaw: float,
    places: Doubles,
    hands: Sequence[Side] | None = None,
) -> Side | None:
    """Return the hand that gets to all places from where somebody stands; None if none does.

    Parameters
    ----------
    actor : Actor
    grip : Grip
    feet : (2,) tuple of float
        Where it stands [m].
    yaw : float
        Which way it looks there [rad].
    places : (N, 3) float64
        In the world [m].
    hands : sequence of {'L', 'R'} or None
        Those that are tried, in turn; None for both, the nearer one before.
    """
    c, s = float(np.cos(yaw)), float(np.sin(yaw))
    x, y = places[:, 0] - feet[0], places[:, 1] - feet[1]
    goals = np.column_stack([c * x + s * y, c * y - s * x, places[:, 2] - actor.floor_m])
    goals /= actor.scale
    moment = moment_of(standing_feet(0.0, 0.0, 0.0, actor.figure.stride))
    stands = walking_posture(actor.rig, moment, 0.0)
    for side in actor.hands(goals[0]) if hands is None else hands:
        held = grip.by(side)
        if all(
            reaching_posture(actor.rig, stands, moment, goal, held) is not None for goal in goals
        ):
            return side
    return None
