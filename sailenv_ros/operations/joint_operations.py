"""Operations on joints: doors, drawers, arms."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sailenv_ros.joints import JointState
from sailenv_ros.operations import argument_checks as check
from sailenv_ros.operations.operation import Caller, operation
from sailenv_ros.validation import checked_number

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = ["JointOperations"]


def _position(what: str, value: Any) -> float:
    return checked_number(what, value, -1e4, 1e4)


def _seconds(what: str, value: Any) -> float:
    return checked_number(what, value, 0.0, 1e4, unit="s")


class JointOperations(Caller):
    """Hinges and slides. A joint is named by the object that moves on it."""

    @operation(obj=check.object_reference, position=_position, seconds=_seconds)
    @staticmethod
    def set_joint_position(
        core: SimulationCore, obj: int | str, position: float, seconds: float = 0.0
    ) -> None:
        """Open or close what moves on a joint.

        Parameters
        ----------
        obj : int or str
            The object that moves, on a hinge or a slide.
        position : float
            Of its joint, within the limits: [rad] of a hinge, [m] of a slide.
        seconds : float
            Simulated time that it takes, 0 to 10000 [s]; 0: at once, which flow shows as motion.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such object, it has no joint that moves, or the position is beyond its
            limits; nothing is changed then.

        Notes
        -----
        Over a time it is moved with the least jerk, by no more than the joint's effort: what is in
        the way is pushed, or holds it up. Another call takes the place of the one before.

        >>> agent.set_joint_position("door 1 leaf", 1.2, seconds=2.0)  # doctest: +SKIP
        """
        core.world.set_joint(core.world.find(obj), position, seconds)

    @operation()
    @staticmethod
    def get_joints(core: SimulationCore) -> tuple[JointState, ...]:
        """Return the states of all joints that move, in the order of the ids of the objects."""
        return core.world.joints()
