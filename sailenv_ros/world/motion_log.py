"""Accelerations of bodies: how their velocities changed in the last step.

Listened to only for a while after somebody has asked, as contacts are: reading every velocity at
each step would cost as much as the step itself.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import STEPS_PER_SECOND

__all__ = ["Motion", "MotionLog"]

LISTENS_S = 10.0
"""Simulated time after a question for which velocities are kept [s]."""

Vector3 = tuple[float, float, float]
Motion = tuple[Vector3, Vector3]

STILL: Motion = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


class MotionLog:
    """Velocities before the last step."""

    def __init__(self) -> None:
        self._until_step = -1
        self._step = -1
        self._before: dict[int, Motion] = {}

    def before_step(self, step: int, bodies: Iterable[tuple[int, Body]]) -> None:
        """Keep how bodies move before a step, if somebody listens; `step` were done so far."""
        if step < self._until_step:
            self._step = step
            self._before = {id_: _motion(body) for id_, body in bodies}

    def accelerations(self, step: int, bodies: Iterable[tuple[int, Body]]) -> dict[int, Motion]:
        """Return accelerations [m/s²] and [rad/s²] by instance id, world axes.

        Those of the first question, which nobody had listened for, are 0.
        """
        known = self._before if self._step == step - 1 else {}
        self._until_step = step + round(LISTENS_S * STEPS_PER_SECOND)
        found = {}
        for id_, body in bodies:
            now = _motion(body)
            change = np.subtract(now, known.get(id_, now)) * STEPS_PER_SECOND
            (ax, ay, az), (bx, by, bz) = change.tolist()
            found[id_] = (ax, ay, az), (bx, by, bz)
        return found


def _motion(body: Body) -> Motion:
    return STILL if body.placement.static else body.origin_velocity(body.world_from_body())
