"""Hardware of what opens: hinges and slides, and what they do by themselves.

Soft closes as of kitchens, catches that keep doors shut, clicks of knobs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from sailenv_ros.types.joints import Detents, SoftClose

__all__ = [
    "DOOR_CLOSE",
    "DRAWER_CLOSE",
    "FLAP_CLOSE",
    "KNOB_CLICKS",
    "LID_CLOSE",
    "MAGNET",
    "SEAL",
    "SPRING_CLOSE",
    "Joint",
    "catch",
    "clicks",
]

Vector3 = tuple[float, float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint:
    """On what a part moves; see `MovingPart`."""

    type: Literal["hinge", "slide"]
    axis: Vector3
    origin_m: Vector3
    limits: tuple[float, float]
    friction: float
    effort: float
    damping: float
    soft_close: SoftClose | None = None
    detents: Detents | None = None


def catch(strength: float, *, at_deg: float = 0.0, within_deg: float = 4.0) -> Detents:
    """Return a catch of a hinge at one angle, with a torque [N m]."""
    within = math.radians(within_deg)
    return Detents(strength=strength, at=(math.radians(at_deg),), within=within)


def clicks(strength: float, every_deg: float) -> Detents:
    """Return the clicks of a knob, with a torque [N m]."""
    return Detents(strength=strength, every=math.radians(every_deg))


DRAWER_CLOSE = SoftClose(within=0.06, speed=0.06, strength=4.0)
DOOR_CLOSE = SoftClose(within=math.radians(25.0), speed=0.4, strength=1.0)
FLAP_CLOSE = SoftClose(within=math.radians(20.0), speed=0.3, strength=2.0)
LID_CLOSE = SoftClose(within=math.radians(75.0), speed=0.5, strength=0.2)
SPRING_CLOSE = SoftClose(within=math.radians(45.0), speed=0.5, strength=0.5)

MAGNET = catch(1.5)
"""Of a cupboard's door: 4 N at its edge."""

SEAL = catch(5.0)
"""Of a door with a magnetic seal or a latch: fridges, ovens, washing machines."""

KNOB_CLICKS = clicks(0.08, 30.0)
