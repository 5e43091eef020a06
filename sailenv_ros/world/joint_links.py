"""Links of a tree of joints, and the targets of their motors."""

from __future__ import annotations

from dataclasses import dataclass

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.robots import DriveMode
from sailenv_ros.world.kinematics import composed
from sailenv_ros.world.placement import JointPlacement, Placement

__all__ = ["STANDING", "JointDrive", "JointLink", "at_origin"]

Vector3 = tuple[float, float, float]

STANDING: tuple[Vector3, Vector3] = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class JointDrive:
    """Target of a joint's motor.

    Attributes
    ----------
    mode : {'position', 'velocity', 'effort', 'off'}
    target : float
        [rad] or [m], [rad/s] or [m/s], [N m] or [N].
    gain : float
        Of a position: speed for each unit of the error [1/s].
    effort : float
        The largest [N m] or [N].
    speed : float
        The largest, of a position [rad/s] or [m/s].
    """

    mode: DriveMode
    target: float
    gain: float
    effort: float
    speed: float


@dataclass(frozen=True, slots=True, kw_only=True)
class JointLink:
    """One object of a tree.

    Attributes
    ----------
    placement : Placement
        With a joint.
    parent : int
        Place in the tree of the link that carries it; -1: the anchor.
    mass_kg : float
    centre_m : (3,) tuple of float
        Centre of mass in the object's frame, scale included.
    position, velocity : float
        Of the joint at the start.
    motion : (2,) tuple of (3,) tuple of float
        Velocity of the centre of mass [m/s] and angular velocity [rad/s] of what moves freely.
    """

    placement: Placement
    parent: int
    mass_kg: float
    centre_m: tuple[float, float, float]
    position: float
    velocity: float
    motion: tuple[Vector3, Vector3] = STANDING

    @property
    def joint(self) -> JointPlacement:
        """The joint on which it moves."""
        assert self.placement.joint is not None
        return self.placement.joint

    @property
    def axes_xyzw(self) -> tuple[float, float, float, float]:
        """Orientation of its principal axes in its object's frame."""
        inertia = self.placement.asset.inertia
        return (0.0, 0.0, 0.0, 1.0) if inertia is None else inertia.axes_xyzw


def at_origin(pose: Pose, joint: JointPlacement) -> Pose:
    """Return the frame of a link: that of its object, at the joint's origin."""
    return composed(pose, Pose(joint.spec.origin))
