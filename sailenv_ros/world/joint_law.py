"""The law of a joint that nobody drives: friction, soft close, detents.

Position and speed in, the target of a motor with a limited force out. The engine solves that with
all else in a step, so it is stable for the smallest inertia, where a stiff spring would tremble.

A soft close is a damper that acts towards the end alone, and a spring that pulls there. Within a
detent's reach its strength takes the place of friction.
"""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.scene.spec_joints import JointSpec
from sailenv_ros.types.joints import Detents, SoftClose
from sailenv_ros.world.bullet import STEPS_PER_SECOND

__all__ = ["BRAKE", "JointLaw", "Motor", "law_of"]

Motor = tuple[float, float]
"""Velocity that is aimed at [rad/s] or [m/s], and the largest torque [N m] or force [N] for it."""

BRAKE = 1e4
"""Largest torque [N m] or force [N] of a damper."""

ARRIVED = 1e-9
"""Distance from an end or a detent at which a joint is there [rad] or [m]."""

SLOW_SHARE = 0.1
"""Share of a soft close's way, the last one, that is gone with its speed alone."""

AS_FAST = 0.999
"""Share of the speed of a soft close from which a joint that it brakes is held at that speed: by
its weight it would be faster in each second step."""

SETTLING_PER_S = 20.0
"""Rate at which a joint comes to a detent, as far as the strength lets it [1/s]."""

PULL_SHARE = 0.5
"""Share of the strength of a detent that pulls in; a click takes the rest of the energy, or what
is heavy would swing about the detent for long."""

LAST_STEP = 1e-5
"""Distance that the last step to a detent takes, so that it ends there [rad] or [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLaw:
    """The law of one joint.

    Attributes
    ----------
    low, high : float
        Limits [rad] or [m].
    friction : float
        [N m] or [N]
    soft_close : SoftClose or None
    detents : Detents or None
    """

    low: float
    high: float
    friction: float
    soft_close: SoftClose | None = None
    detents: Detents | None = None

    def motor(self, position: float, velocity: float, exerted: float) -> Motor:
        """Return what acts for a step.

        Parameters
        ----------
        position : float
            [rad] or [m]
        velocity : float
            [rad/s] or [m/s]
        exerted : float
            Torque [N m] or force [N] of the motor in the step before.
        """
        closes = self.soft_close
        if closes is not None:
            towards = -1.0 if closes.end == "low" else 1.0
            distance = position - self.low if closes.end == "low" else self.high - position
            if distance <= ARRIVED:
                return 0.0, max(closes.strength, self.friction)
            if distance <= closes.within:
                speed, force = _closing(closes, distance, towards * velocity, towards * exerted)
                return towards * speed, force
        clicks = self.detents
        if clicks is not None:
            away = position - clicks.nearest(position, self.low, self.high)
            if abs(away) <= ARRIVED:
                return 0.0, max(clicks.strength, self.friction)
            if abs(away) <= clicks.reach:
                rate = SETTLING_PER_S if abs(away) > LAST_STEP else STEPS_PER_SECOND
                share = 1.0 if velocity * away > 0.0 else PULL_SHARE
                return -rate * away, share * clicks.strength
        return 0.0, self.friction


def law_of(spec: JointSpec) -> JointLaw | None:
    """Return the law of a joint; None if there is no more than friction."""
    if spec.soft_close is None and spec.detents is None:
        return None
    low, high = spec.bounds
    return JointLaw(
        low=low,
        high=high,
        friction=spec.friction,
        soft_close=None if spec.soft_close is None else spec.soft_close.to_soft_close(),
        detents=None if spec.detents is None else spec.detents.to_detents(),
    )


def _closing(closes: SoftClose, distance: float, speed: float, exerted: float) -> Motor:
    """Return speed towards the end and force, of a joint within reach of a soft close.

    What it is too fast falls with the square of the distance that is left to brake.
    """
    excess = speed - closes.speed
    brakes = exerted < 0.0 and speed >= AS_FAST * closes.speed
    if excess <= 0.0 and not brakes:
        return closes.speed, closes.strength
    before = distance - SLOW_SHARE * closes.within
    after = before - speed / STEPS_PER_SECOND
    left = after / before if after > 0.0 else 0.0
    return closes.speed + max(0.0, excess) * left**2, BRAKE
