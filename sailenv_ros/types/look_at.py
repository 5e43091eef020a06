"""Look-at constraint: the point or the object that an agent or a mover faces.

Crosses `scene/`, `simulation/` and `world/`, which resolves it: see `world.look_at_solver`.
"""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.types.geometry import POSITION_LIMIT_M
from sailenv_ros.types.validation import vector

__all__ = ["LookAt"]


@dataclass(frozen=True, slots=True, kw_only=True)
class LookAt:
    """A point that is faced, wherever it goes.

    Attributes
    ----------
    obj : str
        Name of the object that the point belongs to; empty means that it is one of the world.
    point_m : (3,) tuple of float
        World frame, or the object's own frame with its scale applied [m].

    Raises
    ------
    InvalidRequest
        If a coordinate is not finite or beyond 10 km.
    """

    obj: str = ""
    point_m: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        point = vector("point_m", self.point_m, limit=POSITION_LIMIT_M)
        object.__setattr__(self, "point_m", point)
