"""Where one looks, how attentively, and how gladly; it changes smoothly."""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ["AHEAD", "Look"]

_TURN_S, _HEED_S, _GLAD_S = 0.16, 0.22, 0.45
"""Times in which a head has turned, and attention and joy have changed, by 63 % [s]."""

_LOOSE = 0.02
"""Attention below which it does not matter where the head has been."""


class Look(NamedTuple):
    """Where one looks.

    Attributes
    ----------
    left_deg, down_deg : float
        From straight ahead [deg].
    heed : float
        How far one looks there, and not wherever one looks at ease, 0 to 1.
    gladness : float
        Of an animal that sees somebody, 0 to 1: its tail tells it.
    """

    left_deg: float = 0.0
    down_deg: float = 0.0
    heed: float = 0.0
    gladness: float = 0.0

    def towards(self, wanted: Look, step_s: float) -> Look:
        """Return the look a moment later of one who begins to look elsewhere.

        Each number nears the wanted one exponentially.

        Parameters
        ----------
        wanted : Look
            Without heed, its angles do not count.
        step_s : float
            How much later [s].
        """
        turn, heed, glad = (1.0 - math.exp(-step_s / time) for time in (_TURN_S, _HEED_S, _GLAD_S))
        left, down = self.left_deg, self.down_deg
        if wanted.heed:
            if self.heed < _LOOSE:
                turn = 1.0
            left += turn * (wanted.left_deg - left)
            down += turn * (wanted.down_deg - down)
        return Look(
            left,
            down,
            self.heed + heed * (wanted.heed - self.heed),
            self.gladness + glad * (wanted.gladness - self.gladness),
        )

    def within(
        self, most_deg: tuple[float, float], ease_deg: tuple[float, float] = (0.0, 0.0)
    ) -> tuple[float, float]:
        """Return where a head points that turns so far at most, to the left and down [deg].

        Parameters
        ----------
        most_deg : (2,) tuple of float
            To either side, up or down.
        ease_deg : (2,) tuple of float
            Where it points at ease.
        """
        left, down = (
            self.heed * min(max(angle, -most), most) + (1.0 - self.heed) * ease
            for angle, most, ease in zip(self[:2], most_deg, ease_deg, strict=True)
        )
        return left, down


AHEAD = Look()
"""Of one who looks at nothing."""
