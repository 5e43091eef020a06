"""How the bodies of a world stood and moved at its start, and what has been added since."""

from __future__ import annotations

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.body_table import BodyTable
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.placement import Placement

__all__ = ["FirstStates"]


class FirstStates:
    """Takes note of bodies as they stand when this is made.

    Parameters
    ----------
    bodies : BodyTable
    """

    def __init__(self, bodies: BodyTable) -> None:
        self._bodies = bodies
        self._poses = {id_: body.pose() for id_, body in bodies.items()}
        self._last = max((*self._poses, *bodies.waiting), default=0)

    def added(self) -> tuple[int, ...]:
        """Return the ids of the objects that were spawned since; parts of the room are none."""
        return tuple(
            id_
            for id_, body in self._bodies.items()
            if id_ > self._last and body.placement.entry is not None
        )

    def moved(self) -> tuple[tuple[int, Pose, Placement], ...]:
        """Return where the free bodies of the start were, which are still there, by their ids."""
        return tuple(
            (id_, self._poses[id_], body.placement)
            for id_, body in self._bodies.items()
            if id_ in self._poses and not isinstance(body, JointedBody)
        )

    def turned(self) -> tuple[tuple[int, float], ...]:
        """Return the positions at which joints that move began, by the ids of their objects."""
        return tuple(
            (id_, body.joint.spec.start)
            for id_, body in self._bodies.items()
            if id_ in self._poses and isinstance(body, JointedBody) and body.joint.spec.moves
            if not body.placement.robot
        )
