"""Bodies that a request has put somewhere a moment ago: they do not count as resting yet.

So light is found again for what stays where it was put, not for each place on the way, and what is
seen depends on the world alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.snapshot import REST_S
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.labelled_pieces import LabelledPiece

__all__ = ["PlacingLog"]

SETTLING_STEPS = round(REST_S * STEPS_PER_SECOND)
"""Steps for which a body that was put somewhere does not count as resting."""


class PlacingLog:
    """The last placing of each body."""

    def __init__(self) -> None:
        self._steps: dict[Body, int] = {}

    def note(self, body: Body, step: int) -> None:
        """Take in that a body was put where it is, after so many steps."""
        recent = {one: then for one, then in self._steps.items() if step - then < SETTLING_STEPS}
        self._steps = {**recent, body: step}

    def settling(self, pieces: Sequence[LabelledPiece], step: int) -> NDArray[np.bool_] | None:
        """Return (N,) bool: what was put where it is within the last half second; None if none."""
        if all(step - then >= SETTLING_STEPS for then in self._steps.values()):
            return None
        then = [self._steps.get(piece.body, step - SETTLING_STEPS) for piece in pieces]
        return np.array([step - one < SETTLING_STEPS for one in then], np.bool_)
