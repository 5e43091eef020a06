"""Share of the way by share of the time: motion that begins and ends at rest."""

from __future__ import annotations

__all__ = ["smooth_step", "smoother_step"]


def smooth_step(share: float) -> float:
    """Return the share of the way, whose speed is 0 at both ends; 3 s² - 2 s³."""
    return share * share * (3.0 - 2.0 * share)


def smoother_step(share: float) -> float:
    """Return the share of the way, whose acceleration is 0 there, too; 10 s³ - 15 s⁴ + 6 s⁵."""
    return share * share * share * (share * (6.0 * share - 15.0) + 10.0)
