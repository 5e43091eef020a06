"""Operations on joints: doors, drawers, arms."""

from __future__ import annotations

from sailenv_ros.simulation.operations import argument_checks as check
from sailenv_ros.simulation.operations.operation import Caller, operation
from sailenv_ros.simulation.operations.targets import HasWorld
from sailenv_ros.types.joints import JointState
from sailenv_ros.types.validation import Bounds

__all__ = ["JointOperations"]


class JointOperations(Caller):
    """Hinges and slides. A joint is named by the object that moves on it."""

    @operation(
        obj=check.object_reference,
        position=Bounds(least=-1e4, most=1e4).number,
        seconds=Bounds(least=0.0, most=1e4, unit="s").number,
    )
    @staticmethod
    def set_joint_position(
        core: HasWorld, obj: int | str, position: float, seconds: float = 0.0
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
    def get_joints(core: HasWorld) -> tuple[JointState, ...]:
        """Return the states of all joints that move, in the order of the ids of the objects."""
        return core.world.joints()
