"""Collision response of bodies hit by a ball: their mobility at a point, and the impulse they take.

The engine's numbers of bodies and links in, velocities and impulses out. Used in the step in which
it was struck, before anything else moves it.
"""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient

__all__ = ["LinkMotion", "Strike", "ContactBody", "ContactLink", "links_near"]

Floats: TypeAlias = NDArray[np.float64]
Piece: TypeAlias = tuple[int, int]
"""The engine's number of a body, and that of its link."""

LinkMotion: TypeAlias = tuple[Floats, Floats, Floats]
"""Centre of mass [m], velocity [m/s] and angular velocity [rad/s], world frame."""

NEAR_M = 0.02


class Strike(NamedTuple):
    """Contact of the ball with one body in a step.

    Attributes
    ----------
    impulse_n_s : float
        Along the normal [N s].
    normal : (3,) float64
        Unit vector towards the ball.
    place_m : (3,) float64
        World frame [m].
    depth_m : float
        How deep the two stood in one another when the step began [m].
    """

    impulse_n_s: float
    normal: Floats
    place_m: Floats
    depth_m: float


class ContactBody:
    """A rigid body at a point where it is struck; what is static has no mobility."""

    def __init__(self, client: BulletClient, body: int, place_m: Floats) -> None:
        self._client, self._body = client, body
        linear, angular = client.getBaseVelocity(body)
        self._linear, self._angular = np.asarray(linear), np.asarray(angular)
        position, quat = client.getBasePositionAndOrientation(body)
        self._arm = place_m - np.asarray(position)
        mass_kg, _, inertia, *_ = client.getDynamicsInfo(body, LINK_OF_BASE)
        self._per_mass, self._per_inertia = 0.0, np.zeros((3, 3))
        if mass_kg:
            turn = np.asarray(client.getMatrixFromQuaternion(quat)).reshape(3, 3)
            self._per_mass = 1.0 / mass_kg
            self._per_inertia = turn @ np.diag(1.0 / np.asarray(inertia)) @ turn.T

    @property
    def velocity(self) -> Floats:
        """Of the point [m/s]."""
        return self._linear + np.cross(self._angular, self._arm)

    def mobility(self, normal: Floats) -> float:
        """Return how much faster an impulse along a normal makes the point, along it [1/kg]."""
        spin = self._per_inertia @ np.cross(self._arm, normal)
        return float(self._per_mass + np.cross(spin, self._arm) @ normal)

    def push(self, impulse_n_s: Floats) -> None:
        """Give it an impulse at the point [N s]."""
        if self._per_mass:
            linear = self._linear + self._per_mass * impulse_n_s
            angular = self._angular + self._per_inertia @ np.cross(self._arm, impulse_n_s)
            self._client.resetBaseVelocity(self._body, linear.tolist(), angular.tolist())


class ContactLink:
    """An assembly on joints, at the point where it is hit.

    How easily it gives way is told by how much faster the engine's impulse has made it. It is
    pushed in the next step.

    Parameters
    ----------
    client : BulletClient
    piece : (int, int)
    place_m : (3,) float64
        World frame [m].
    before : LinkMotion or None
        Before the step; None takes it for unmoved by the strike, like a wall.
    impulse_n_s : float
        What the engine gave it [N s].
    """

    def __init__(
        self,
        client: BulletClient,
        piece: Piece,
        place_m: Floats,
        before: LinkMotion | None,
        impulse_n_s: float,
    ) -> None:
        self._client, self._piece, self._place = client, piece, place_m
        self._impulse = impulse_n_s
        self.velocity = _velocity_at(_link_motion(client, piece), place_m)
        self._before = self.velocity if before is None else _velocity_at(before, place_m)

    def mobility(self, normal: Floats) -> float:
        """Return how much faster an impulse along a normal makes the point, along it [1/kg]."""
        return max(0.0, float((self._before - self.velocity) @ normal) / self._impulse)

    def push(self, impulse_n_s: Floats) -> None:
        """Give it an impulse at the point [N s]."""
        body, link = self._piece
        force = (impulse_n_s * STEPS_PER_SECOND).tolist()
        frame = self._client.constants.WORLD_FRAME
        self._client.applyExternalForce(body, link, force, self._place.tolist(), frame)


def links_near(client: BulletClient, body: int, speed_m_s: float) -> dict[Piece, LinkMotion]:
    """Return how what is attached by joints moves that a body may strike in the next step."""
    reach = NEAR_M + speed_m_s / STEPS_PER_SECOND
    low, high = client.getAABB(body, LINK_OF_BASE)
    found = client.getOverlappingObjects([x - reach for x in low], [x + reach for x in high]) or ()
    near = sorted({(other, link) for other, link in found if other != body})
    return {p: _link_motion(client, p) for p in near if p[1] != LINK_OF_BASE}


def _link_motion(client: BulletClient, piece: Piece) -> LinkMotion:
    body, link = piece
    if link == LINK_OF_BASE:
        place, _ = client.getBasePositionAndOrientation(body)
        linear, angular = client.getBaseVelocity(body)
    else:
        state = client.getLinkState(body, link, computeLinkVelocity=1, computeForwardKinematics=1)
        place, linear, angular = state[0], state[6], state[7]
    return np.asarray(place), np.asarray(linear), np.asarray(angular)


def _velocity_at(motion: LinkMotion, place_m: Floats) -> Floats:
    centre, linear, angular = motion
    return linear + np.cross(angular, place_m - centre)
