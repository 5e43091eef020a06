"""Capsules of a skeleton in the physics engine: what others bump into where limbs are drawn."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.rig import Rig
from sailenv_ros.world.actuation import wake
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient

__all__ = ["Limbs"]

Doubles = NDArray[np.float64]

_BONES = {
    2: (
        ("root", "spine02", 0.085),
        ("spine02", "neck01", 0.085),
        ("head", "head", 0.062),
        *(
            (f"{first}.{side}", f"{second}.{side}", share)
            for side in "LR"
            for first, second, share in (
                ("upperarm01", "lowerarm01", 0.026),
                ("lowerarm01", "wrist", 0.022),
                ("wrist", "finger3-1", 0.022),
                ("upperleg01", "lowerleg01", 0.044),
                ("lowerleg01", "foot", 0.030),
                ("foot", "toe1-1", 0.022),
            )
        ),
    ),
    4: (
        ("root", "spine02", 0.115),
        ("spine02", "neck01", 0.115),
        ("neck01", "head", 0.085),
        ("head", "nose", 0.06),
        ("tail01", "tail04", 0.03),
        ("tail04", "tail07", 0.03),
        *(
            (f"{first}.{side}", f"{second}.{side}", share)
            for side in "LR"
            for first, second, share in (
                ("upperarm", "forearm", 0.055),
                ("forearm", "wrist", 0.036),
                ("wrist", "forepaw", 0.032),
                ("thigh", "shank", 0.07),
                ("shank", "hock", 0.042),
                ("hock", "hindpaw", 0.032),
            )
        ),
    ),
}
"""By the number of legs: from a joint to another one, and the radius as a share of the height of
the head's joint."""


class Limbs:
    """The capsules of one person or animal; moved, and never pushed.

    Parameters
    ----------
    client : BulletClient
    rig : Rig
    """

    def __init__(self, client: BulletClient, rig: Rig) -> None:
        self._client = client
        height = float(rig.head("head")[2])
        bones = _BONES[rig.legs]
        self._joints = [(rig.joint_of[a], rig.joint_of[b]) for a, b, _ in bones]
        self.ids: list[int] = []
        self._lift = np.array([0.0, 0.0, 0.045 * height])
        for (first, second), (_, _, share) in zip(self._joints, bones, strict=True):
            radius = share * height
            length = float(np.linalg.norm(rig.heads[second] - rig.heads[first]))
            shape = client.createCollisionShape(
                client.constants.GEOM_CAPSULE, radius=radius, height=max(length, 0.02)
            )
            body = client.createMultiBody(
                baseMass=0.0, baseCollisionShapeIndex=shape, useMaximalCoordinates=1
            )
            self.ids.append(int(body))

    def place(self, world_from_body: Doubles, places: Doubles) -> None:
        """Put the capsules along the joints, (J, 3) in the frame of the body [m]."""
        world = places @ world_from_body[:3, :3].T + world_from_body[:3, 3]
        for body, (first, second) in zip(self.ids, self._joints, strict=True):
            begin, end = world[first], world[second]
            if first == second:
                begin = end = begin + world_from_body[:3, :3] @ self._lift
            middle = 0.5 * (begin + end)
            self._client.resetBasePositionAndOrientation(
                body, middle.tolist(), _upright_to(end - begin)
            )
        self._wake_touched()

    def _wake_touched(self) -> None:
        """Wake what sleeps where a limb is now: the engine does not."""
        client = self._client
        found: set[int] = set()
        for body in self.ids:
            found.update(
                other for other, _ in client.getOverlappingObjects(*client.getAABB(body)) or ()
            )
        for other in sorted(found.difference(self.ids)):
            if client.getDynamicsInfo(other, LINK_OF_BASE)[0]:
                wake(client, other)

    def pass_through(self, other: int, link: int, *, passes: bool) -> None:
        """Let the limbs pass through a link of a body of the engine, or not."""
        for body in self.ids:
            self._client.setCollisionFilterPair(body, other, LINK_OF_BASE, link, int(not passes))

    def remove(self) -> None:
        """Take them out of the engine."""
        for body in self.ids:
            self._client.removeBody(body)


def _upright_to(direction: Doubles) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w that turns the z axis along a direction."""
    length = float(np.linalg.norm(direction))
    if length < 1e-9:
        return 0.0, 0.0, 0.0, 1.0
    x, y, z = (direction / length).tolist()
    if z < -0.999999:
        return 1.0, 0.0, 0.0, 0.0
    w = 1.0 + z
    norm = float(np.sqrt(x * x + y * y + w * w))
    return -y / norm, x / norm, 0.0, w / norm
