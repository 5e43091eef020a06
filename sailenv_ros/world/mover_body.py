"""A mover that is a rigid body: a ball in the engine, never drawn, that wrenches push.

A `RigidBody` and a place in, poses and bounces out. Pushing, floating and the limit of speed are
those of objects; drag and restitution are done here.

Drag: before each step the velocity is multiplied by exp(-drag Δt), which is exact at every step.
The engine then moves the ball by its new velocity times Δt, so that of free flight the place alone
differs from the integral, by less than a step's way.

Restitution: the engine bounces bodies by the product of their two restitutions, which is 0 at every
wall that has none, and lets slow ones stick. Here the ball's own decides. After a step in which it
was struck, both get the impulse that is missing to Newton's law of impact, v' = -e v along the
normal (Goldsmith, Impact, 1960, chapter 2), and the ball is put where the two touch; momentum is
what it was.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset, Model, SphereShape
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.contact_body import ContactBody, ContactLink, LinkMotion, Strike, links_near
from sailenv_ros.world.placement import Placement

__all__ = ["AT_REST", "BOUNCES_FROM_M_S", "Motion", "MoverBody"]

BOUNCES_FROM_M_S = 0.05
"""Least speed of an impact that bounces [m/s]; gravity gives a resting body 0.04 in a step."""

NO_SPIN_RAD_S = 1e-12
"""Slower is rounding: less than 4e-9 rad in an hour."""

Floats = NDArray[np.float64]
Piece = tuple[int, int]
"""The engine's number of a body, and that of its link."""

Vector3 = tuple[float, float, float]

Motion = tuple[Vector3, Vector3]
"""Velocity [m/s] and angular velocity [rad/s], world frame."""

AT_REST: Motion = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)


class MoverBody(Body):
    """The ball of one mover.

    Parameters
    ----------
    client : BulletClient
    name : str
        The mover's.
    rigid : RigidBody
    pose : Pose
    motion : (linear, angular) tuple of (3,) tuples of float
        At first, world frame [m/s], [rad/s].

    Attributes
    ----------
    rigid : RigidBody
    """

    def __init__(
        self,
        client: BulletClient,
        name: str,
        rigid: RigidBody,
        pose: Pose,
        motion: Motion,
    ) -> None:
        ball = Asset(
            name="mover",
            display_name="Mover",
            category="unlabelled",
            model=Model(name="mover", parts=()),
            collision=(SphereShape(radius_m=rigid.radius_m),),
        )
        self.rigid = rigid
        linear, angular = motion
        super().__init__(
            client,
            Placement(
                name=name,
                asset=ball,
                category_id=0,
                pose=pose,
                mass_kg=rigid.mass_kg,
                gravity=rigid.gravity,
                friction=rigid.friction,
                linear_velocity=linear,
                angular_velocity=angular,
            ),
        )
        decays = rigid.drag_per_s, rigid.angular_drag_per_s
        self._decay, self._angular_decay = (math.exp(-rate / STEPS_PER_SECOND) for rate in decays)
        self._before: Floats = np.asarray(linear)
        self._flies = False
        self._links: dict[Piece, LinkMotion] = {}

    def before_step(self) -> None:
        """Slow it down for the step that comes."""
        linear, angular = self.velocity()
        if (self._decay != 1.0 and linear.any()) or (self._angular_decay != 1.0 and angular.any()):
            linear, angular = linear * self._decay, angular * self._angular_decay
            self._client.resetBaseVelocity(self._id, linear.tolist(), angular.tolist())
        self._before = linear
        self._links = links_near(self._client, self._id, float(np.linalg.norm(linear)))

    def after_step(
        self, restitution: Mapping[Piece, float], done: Collection[Piece]
    ) -> dict[Piece, float]:
        """Bounce off what the step made it strike.

        Parameters
        ----------
        restitution : mapping of (int, int) to float
            Of others that have one, too; the greater counts.
        done : collection of (int, int)
            Those that have bounced off it already.

        Returns
        -------
        gains : dict of (int, int) to float
            By what the impulses of what it struck were multiplied, where it bounced.
        """
        struck = self._strikes()
        if not struck:
            # What touches something may come to rest and sleep, as objects do; what flies does
            # not, however slow it is.
            self._set_activation("ACTIVATION_STATE_DISABLE_SLEEPING")
            self._flies = True
            return {}
        if self._flies:
            self._set_activation("ACTIVATION_STATE_ENABLE_SLEEPING")
            self._flies = False
        now, _ = self.velocity()
        given = np.sum([s.impulse_n_s * s.normal for s in struck.values()], axis=0) / self.mass_kg
        forced = now - given - self._before
        gains = {}
        for other, strike in struck.items():
            if other in done:
                continue
            share = max(restitution.get(other, 0.0), self.rigid.restitution)
            more = self._bounce(other, strike, share, float(forced @ strike.normal))
            if more:
                gains[other] = 1.0 + more / strike.impulse_n_s
        return gains

    def turned_from(self, before: Pose) -> Pose:
        """Return where it is; what does not spin is turned as it was, to the bit.

        The engine rounds orientations in every step, and strikes leave spins of 1e-60 rad/s.
        """
        here = self.pose()
        if max(map(abs, self.motion[1])) > NO_SPIN_RAD_S:
            return here
        return Pose(here.position_m, before.orientation_xyzw)

    @property
    def motion(self) -> Motion:
        """Velocity [m/s] and angular velocity [rad/s], world frame."""
        (vx, vy, vz), (wx, wy, wz) = self._client.getBaseVelocity(self._id)
        return (vx, vy, vz), (wx, wy, wz)

    def take_wrenches(self, other: MoverBody) -> None:
        """Let what pushes another body push this one instead."""
        self._wrenches = other._wrenches

    def turn(self, pose: Pose) -> None:
        """Turn it, and leave its motion as it is."""
        position, _ = self._client.getBasePositionAndOrientation(self._id)
        motion = self.motion
        self._client.resetBasePositionAndOrientation(self._id, position, pose.orientation_xyzw)
        self._client.resetBaseVelocity(self._id, *motion)

    def _strikes(self) -> dict[Piece, Strike]:
        """Return what pressed against it in the last step, by what did."""
        points: dict[Piece, list[tuple[Floats, Floats]]] = {}
        depths: dict[Piece, float] = {}
        for point in self._client.getContactPoints(bodyA=self._id):
            if point[9] > 0.0:
                impulse = np.asarray(point[7]) * point[9] / STEPS_PER_SECOND
                other = point[2], point[4]
                points.setdefault(other, []).append((impulse, np.asarray(point[6])))
                depths[other] = max(depths.get(other, 0.0), -point[8])
        found = {}
        for other, parts in points.items():
            impulse = np.sum([part for part, _ in parts], axis=0)
            size = float(np.linalg.norm(impulse))
            if size > 0.0:
                weights = [float(np.linalg.norm(part)) for part, _ in parts]
                place = np.average([at for _, at in parts], axis=0, weights=weights)
                found[other] = Strike(size, impulse / size, place, depths[other])
        return found

    def _bounce(self, other: Piece, strike: Strike, restitution: float, forced_m_s: float) -> float:
        """Give both the impulse that is missing to a bounce, or too much; return it [N s].

        `forced_m_s` is how much faster, along the normal, forces have made the ball in the step: a
        ball that lies somewhere is pressed there, and strikes nothing.
        """
        n, at = strike.normal, strike.place_m
        pressed = max(0.0, -forced_m_s)
        body, link = other
        if link != LINK_OF_BASE or self._client.getNumJoints(body):
            before = self._links.get(other)
            struck: ContactBody | ContactLink = ContactLink(
                self._client, other, at, before, strike.impulse_n_s
            )
        else:
            struck = ContactBody(self._client, body, at)
        mobility = 1.0 / self.mass_kg + struck.mobility(n)
        out = float((self.velocity()[0] - struck.velocity) @ n)
        into = strike.impulse_n_s * mobility - out
        more = (restitution * into - out) / mobility
        if into - pressed < BOUNCES_FROM_M_S:
            return 0.0
        struck.push(-more * n)
        linear, angular = self.velocity()
        # The engine would push out what is left of the depth by giving both more speed.
        deep = strike.depth_m - out / STEPS_PER_SECOND
        if deep > 0.0:
            place, quat = self._client.getBasePositionAndOrientation(self._id)
            out_of_it = (np.asarray(place) + deep * n).tolist()
            self._client.resetBasePositionAndOrientation(self._id, out_of_it, quat)
        faster = (linear + more / self.mass_kg * n).tolist()
        self._client.resetBaseVelocity(self._id, faster, angular.tolist())
        return more

    def _set_activation(self, state: str) -> None:
        value = getattr(self._client.constants, state)
        self._client.changeDynamics(self._id, LINK_OF_BASE, activationState=value)
