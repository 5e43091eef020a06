"""A tree of joints put into the engine: links in, PyBullet's number of the body out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.body_creation import ROLLING_FRICTION
from sailenv_ros.world.bullet import LINK_OF_BASE, STEPS_PER_SECOND, BulletClient
from sailenv_ros.world.collision import HullFiles, build_collision
from sailenv_ros.world.joint_links import JointLink, at_origin

__all__ = ["build_tree", "set_dynamics"]

UNLIMITED = (1.0, -1.0)
"""The engine takes limits in the wrong order for none."""

LIMIT_FORCE = 1e7


def build_tree(files: HullFiles, links: Sequence[JointLink], world_from_rest: Pose) -> int:
    """Put links into the engine as one body; return its number there.

    Parameters
    ----------
    files : HullFiles
    links : sequence of JointLink
        Parents before what they carry. The first one carries all, if it is free.
    world_from_rest : Pose
        Of the first one while its joint's position is 0.

    Raises
    ------
    InvalidRequest
        If an object's collision shape cannot have its scale; nothing is in the engine then.
    """
    client = files.client
    kinds, first = client.constants, links[0]
    is_free = first.joint.spec.type == "free"
    joint_types = {
        "hinge": kinds.JOINT_REVOLUTE,
        "slide": kinds.JOINT_PRISMATIC,
        "fixed": kinds.JOINT_FIXED,
        "free": kinds.JOINT_FIXED,
    }
    shapes = [
        build_collision(
            files,
            link.placement.asset.collision,
            scale=link.placement.scale,
            # The frame of a link is at its joint's origin.
            centre_of_mass_m=link.joint.spec.origin,
            name=link.placement.name,
        )
        for link in links
    ]
    frees = 1 if is_free else 0
    hung = links[frees:]
    offsets = [_offset(links, link) for link in hung]
    carrier: dict[str, Any] = {"baseMass": 0.0, "baseCollisionShapeIndex": -1}
    at = at_origin(world_from_rest, first.joint)
    if is_free:
        at = world_from_rest
        carrier = {
            "baseMass": first.mass_kg,
            "baseCollisionShapeIndex": shapes[0],
            "baseInertialFramePosition": first.centre_m,
            "baseInertialFrameOrientation": first.axes_xyzw,
        }
    count = len(hung)
    itself = any(link.placement.collides_with_itself for link in links)
    body = client.createMultiBody(
        **carrier,
        basePosition=at.position_m,
        baseOrientation=at.orientation_xyzw,
        linkMasses=[link.mass_kg for link in hung],
        linkCollisionShapeIndices=shapes[frees:],
        linkVisualShapeIndices=[-1] * count,
        linkPositions=[offset.position_m for offset in offsets],
        linkOrientations=[offset.orientation_xyzw for offset in offsets],
        linkInertialFramePositions=[
            [c - o for c, o in zip(link.centre_m, link.joint.spec.origin, strict=True)]
            for link in hung
        ],
        linkInertialFrameOrientations=[link.axes_xyzw for link in hung],
        linkParentIndices=[link.parent + 1 - frees for link in hung],
        linkJointTypes=[joint_types[link.joint.spec.type] for link in hung],
        linkJointAxis=[link.joint.spec.unit_axis for link in hung],
        flags=kinds.URDF_USE_SELF_COLLISION if itself else 0,
    )
    return int(body)


def set_dynamics(client: BulletClient, body: int, engine_link: int, link: JointLink) -> None:
    """Give a link its friction, damping, inertia and limits."""
    spec, placement = link.joint.spec, link.placement
    rolling = ROLLING_FRICTION if placement.friction else 0.0
    inertia = placement.asset.inertia
    if inertia is not None:
        moments = inertia.moments_kg_m2
        client.changeDynamics(body, engine_link, localInertiaDiagonal=moments)
    client.changeDynamics(
        body,
        engine_link,
        lateralFriction=placement.friction,
        restitution=placement.restitution,
        linearDamping=0.0,
        angularDamping=0.0,
        rollingFriction=rolling,
        spinningFriction=placement.spinning_friction or rolling,
        jointDamping=_stable_damping(client, body, engine_link, link),
    )
    low, high = UNLIMITED if spec.limits is None else spec.limits
    if spec.moves:
        client.changeDynamics(
            body,
            engine_link,
            jointLowerLimit=low,
            jointUpperLimit=high,
            jointLimitForce=LIMIT_FORCE,
        )
    client.changeDynamics(
        body,
        LINK_OF_BASE,
        linearDamping=0.0,
        angularDamping=0.0,
        activationState=client.constants.ACTIVATION_STATE_ENABLE_SLEEPING,
    )


def _stable_damping(client: BulletClient, body: int, engine_link: int, link: JointLink) -> float:
    """Return a joint's damping, as far as the engine's step can bear it.

    It applies damping explicitly: more than the link's own inertia in half a step would make its
    joint tremble ever faster.
    """
    spec = link.joint.spec
    if not spec.moves:
        return spec.damping
    own = link.mass_kg
    if spec.type == "hinge":
        moments = np.asarray(client.getDynamicsInfo(body, engine_link)[2])
        axis = np.asarray(spec.unit_axis)
        turn = Pose(orientation_xyzw=link.axes_xyzw).matrix()[:3, :3]
        arm = np.cross(axis, np.subtract(link.centre_m, spec.origin))
        own = float((turn.T @ axis) ** 2 @ moments) + link.mass_kg * float(arm @ arm)
    return min(spec.damping, 0.5 * own * STEPS_PER_SECOND)


def _offset(links: Sequence[JointLink], link: JointLink) -> Pose:
    """Return where a link's frame is in that of its parent, at the joint's position 0."""
    if link.parent < 0:
        return Pose()
    carrier = links[link.parent].joint.spec
    ox, oy, oz = (0.0, 0.0, 0.0) if carrier.type == "free" else carrier.origin
    here = at_origin(link.joint.parent_from_rest, link.joint)
    x, y, z = here.position_m
    return Pose((x - ox, y - oy, z - oz), here.orientation_xyzw)
