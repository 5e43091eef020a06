"""A look-at constraint in a world: who is faced, where that is now, and how one is turned to it.

A pure function of the world as it stands: who asks twice in a step, or never, changes nothing.
"""

from __future__ import annotations

from sailenv_ros.errors import UnknownName
from sailenv_ros.types.geometry import Pose, facing
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.world.body_table import BodyTable

__all__ = ["LookAtSolver"]

Vector3 = tuple[float, float, float]


class LookAtSolver:
    """One constraint. An object is followed by its id: it may be renamed, go and come again.

    Parameters
    ----------
    bodies : BodyTable
    look_at : LookAt
        Its object is there, or waits to enter.

    Raises
    ------
    UnknownName
        If there is no such object.
    """

    def __init__(self, bodies: BodyTable, look_at: LookAt) -> None:
        self._bodies = bodies
        self._look_at = look_at
        self._id = 0
        if look_at.obj:
            waiting = bodies.waiting.names()
            self._id = bodies.id_of_name(look_at.obj) or waiting.get(look_at.obj, 0)
            if not self._id:
                names = [body.placement.name for body in bodies]
                raise UnknownName("object", look_at.obj, [*names, *waiting])

    @property
    def target_m(self) -> Vector3:
        """The point that is faced now, world frame [m]; of an object that is gone, the last."""
        point = self._look_at.point_m
        if not self._id:
            return point
        world_from_body = self._bodies.last_world_from_body(self._id)
        x, y, z = (float(row[:3] @ point + row[3]) for row in world_from_body[:3])
        return x, y, z

    def turned(self, pose: Pose) -> Pose:
        """Return a pose turned to what is faced, without a roll; see `geometry.facing`."""
        return facing(pose, self.target_m)

    def described(self) -> LookAt:
        """Return what a scene file says of it now: of an object that is gone, where it was.

        The engine is not asked, so that it may be closed.
        """
        name = self._bodies.name_of(self._id) if self._id else ""
        if not self._id or name:
            return LookAt(obj=name, point_m=self._look_at.point_m)
        return LookAt(point_m=self.target_m)
