"""Operations that make movers rigid bodies, and tell how they move."""

from __future__ import annotations

from typing import Any

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasWorld
from sailenv_ros.types.rigid_body import RigidBody

__all__ = ["BodyOperations"]

Vector3 = tuple[float, float, float]


def _rigid_body(what: str, value: Any) -> RigidBody:
    if not isinstance(value, RigidBody):
        accepted = "a sailenv_ros.types.rigid_body.RigidBody, or None for a mover that is none"
        raise InvalidRequest(what, value, accepted)
    return value


class BodyOperations(Caller):
    """Movers that forces move: pushed by `apply_wrench`, told of by `contacts`."""

    @operation(body=check.optional(_rigid_body), mover=check.text)
    @staticmethod
    def set_mover_body(core: HasWorld, body: RigidBody | None, mover: str = "") -> None:
        """Make a mover a rigid body, which forces and collisions move; with None, none any more.

        It stays where it is, and what follows it keeps doing so. One that is a body already keeps
        its velocity and the wrenches that act upon it.

        Parameters
        ----------
        body : RigidBody or None
        mover : str
            Not one that waypoints drive. Empty means the scene's first.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such mover, or waypoints drive it; nothing is changed then.

        Notes
        -----
        A set pose stops it; `drive_mover` and the controller ``waypoint`` are refused while it is a
        body. `set_mover_look_at` turns what sees from it, not the ball.

        >>> agent.set_mover_body(RigidBody(mass_kg=0.5, drag_per_s=0.2))  # doctest: +SKIP
        >>> agent.apply_wrench("mover", force_n=(2, 0, 0), duration_s=0.1)  # doctest: +SKIP
        """
        if core.world.set_mover_body(mover, body):
            core.announce()

    @operation(mover=check.text)
    @staticmethod
    def get_mover_velocity(core: HasWorld, mover: str = "") -> tuple[Vector3, Vector3]:
        """Return the velocity [m/s] and the angular velocity [rad/s] of a mover that is a body.

        Both are in the world's axes.

        Raises
        ------
        UnknownName, InvalidState
            If there is no such mover, or it is not a body.
        """
        return core.world.mover(mover).require_body().motion
