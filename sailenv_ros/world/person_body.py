"""A person or an animal: a body that moves its limbs by itself, and that nothing pushes.

Its pose, and where its feet stand, follow from the way that it goes; its posture from that and
time. In the engine it is capsules along its bones, which push others aside.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.behaviours import STEP_S, RunningBehaviour
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.postures.reaching import grip_place
from sailenv_ros.postures.skeleton import JointFrames, joint_frames, skin_matrices
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.skeleton import Skeleton
from sailenv_ros.world.bodies import Body, FrustumPlanes, Vector3
from sailenv_ros.world.bullet import LINK_OF_BASE, BulletClient
from sailenv_ros.world.carrying import carry
from sailenv_ros.world.labelled_pieces import LabelledPiece
from sailenv_ros.world.limbs import Limbs
from sailenv_ros.world.placement import Placement
from sailenv_ros.world.skin import skin_over
from sailenv_ros.world.walker import Walker

__all__ = ["PersonBody", "deformations_of", "skeletons_of"]

Doubles = NDArray[np.float64]

_LIMB_STEPS = 8
"""Steps of physics after which the capsules of limbs follow."""


class PersonBody(Body):
    """A body with a skeleton; parameters as `Body`.

    Attributes
    ----------
    walker : Walker
        What it does.
    frames : (J, 3, 3) and (J, 3) float64, or None
        `joint_frames` when `deformation` was asked for last.
    """

    def __init__(self, client: BulletClient, placement: Placement) -> None:
        assert placement.asset.rig is not None
        sx, sy, sz = placement.scale
        if not sx == sy == sz:
            raise InvalidRequest(
                f"scale of {placement.name!r}", placement.scale, "the same along all axes"
            )
        self._rig: Rig = placement.asset.rig
        self._scale = float(sx)
        self.walker = Walker(placement.name, placement.asset, self._scale, placement.pose)
        self.walker.pass_through = self._pass_through
        super().__init__(client, replace(placement, static=False))
        self._limbs = Limbs(client, self._rig) if self._scale == 1.0 else None
        self.frames: JointFrames | None = None
        self._posed: tuple[bytes, Deformation] | None = None
        self._steps = 0
        self._place_limbs()

    # -- what Body asks for -----------------------------------------------------------------

    @property
    def acts(self) -> bool:
        """True: it breathes and walks by itself."""
        return True

    @property
    def collides(self) -> bool:
        """True: its limbs do."""
        return True

    @property
    def limb_ids(self) -> list[int]:
        """The engine's numbers of its capsules."""
        return [] if self._limbs is None else self._limbs.ids

    def world_from_body(self) -> Doubles:
        """Return the (4, 4) pose now; not to be written to."""
        return self.walker.matrix

    def pose(self) -> Pose:
        """Return the pose of the body frame now."""
        return Pose.from_matrix(self.walker.matrix)

    def placed_pose(self) -> Pose:
        """Return where it would stand on the floor if it did nothing."""
        return self.walker.standing_pose

    def put(self, pose: Pose) -> None:
        """Set the pose; it stands there."""
        self.arranged = False
        self.walker.stand_at(pose)
        self._place_limbs()

    def wake(self) -> None:
        """Nothing: it is never asleep."""

    def velocity(self) -> tuple[Doubles, Doubles]:
        """Return the velocity of the body frame's origin [m/s] and the angular one [rad/s]."""
        linear = (self.walker.matrix[:3, 3] - self.walker.matrix_before[:3, 3]) / STEP_S
        before = np.arctan2(self.walker.matrix_before[1, 0], self.walker.matrix_before[0, 0])
        now = np.arctan2(self.walker.matrix[1, 0], self.walker.matrix[0, 0])
        turn = (now - before + np.pi) % (2.0 * np.pi) - np.pi
        return linear, np.array([0.0, 0.0, turn / STEP_S])

    def origin_velocity(self, world_from_body: Doubles) -> tuple[Vector3, Vector3]:
        """Return the same, whatever the pose."""
        (vx, vy, vz), (wx, wy, wz) = (part.tolist() for part in self.velocity())
        return (vx, vy, vz), (wx, wy, wz)

    def orientation_of_matrix(self) -> tuple[float, float, float, float]:
        """Return the quaternion x, y, z, w of the pose."""
        return self.pose().orientation_xyzw

    def rebuilt(self, placement: Placement) -> Body:
        """Make the person that another placement says, in the same place."""
        new = PersonBody(self._client, replace(placement, pose=self.placed_pose()))
        new._behaviours, new.walker.crowd = self._behaviours, self.walker.crowd
        new.entry_pose = self.entry_pose
        new.behaviours_unchanged = self.behaviours_unchanged
        return new

    def push(self, wrench: RunningBehaviour) -> None:
        """Refuse: nothing pushes what moves by itself.

        Raises
        ------
        InvalidRequest
        """
        accepted = "one that physics moves: people and animals move by themselves"
        raise InvalidRequest("object", self.placement.name, accepted)

    def behave(
        self, running: RunningBehaviour, time_s: float, frustum_planes: FrustumPlanes
    ) -> None:
        """Ask a behaviour, which tells the person what to do."""
        state = replace(self._state(running, frustum_planes), person=self.walker)
        running.act(time_s, state)

    def remove(self) -> None:
        """Take the body out of the engine."""
        self.walker.leave()
        if self.walker.crowd is not None:
            self.walker.crowd.people.pop(self.placement.name, None)
        if self._limbs is not None:
            self._limbs.remove()
        super().remove()

    def _build(self) -> int:
        # Limbs stand for it; this alone is what its number stands for.
        body = self._client.createMultiBody(
            baseMass=0.0,
            baseCollisionShapeIndex=-1,
            basePosition=self.placement.pose.position_m,
            useMaximalCoordinates=1,
        )
        return int(body)

    def touching_ids(self) -> frozenset[int]:
        """Return the engine's numbers of what touches its limbs."""
        found: set[int] = set()
        for limb in self.limb_ids:
            low, high = self._client.getAABB(limb, LINK_OF_BASE)
            near = self._client.getOverlappingObjects(low, high)
            found.update(body for body, _ in near or ())
        return frozenset(found)

    def deformation(self) -> Deformation:
        """Return where its skin is now; the same object until it moves."""
        self.frames = joint_frames(self._rig, self.walker.posture)
        matrices = skin_matrices(self._rig, *self.frames)
        key = matrices.tobytes()
        if self._posed is None or self._posed[0] != key:
            self._posed = key, skin_over(self.placement.asset.model, self._rig, matrices)
        return self._posed[1]

    def skeleton(self, frames: JointFrames | None = None) -> Skeleton:
        """Return where its joints and keypoints are now; by the frames if they are given."""
        rig = self._rig
        turns, places = frames or joint_frames(rig, self.walker.posture)
        points = np.array([
            places[point.joint]
            + turns[point.joint] @ (np.asarray(point.position_m) - rig.heads[point.joint])
            for point in rig.points
        ]).reshape(-1, 3)  # fmt: skip
        matrix = self.walker.matrix
        world_from_joint = np.empty((len(places), 3, 4))
        world_from_joint[:, :, :3] = matrix[:3, :3] @ turns
        world_from_joint[:, :, 3] = self._scale * places @ matrix[:3, :3].T + matrix[:3, 3]
        return Skeleton(
            joint_names=rig.names,
            parents=rig.parents,
            world_from_joint=world_from_joint,
            point_names=tuple(point.name for point in rig.points),
            points=self._scale * points @ matrix[:3, :3].T + matrix[:3, 3],
        )

    def advance(self, time_s: float) -> None:
        """Do what is to be done in the step that begins at a simulated time [s]."""
        self.walker.advance(time_s)
        self._carry()
        self._steps += 1
        if self._steps % _LIMB_STEPS == 0:
            self._place_limbs()

    def _place_limbs(self) -> None:
        if self._limbs is not None:
            _, places = joint_frames(self._rig, self.walker.posture)
            self._limbs.place(self.walker.matrix, places)

    def _carry(self) -> None:
        """Move what is in the hand to where it is at the end of the step."""
        held, crowd = self.walker.held, self.walker.crowd
        if held is None:
            return
        body = None if crowd is None else crowd.body(held.name)
        if body is None:
            self.walker.held = None
            return
        turns, places = joint_frames(self._rig, self.walker.posture)
        matrix = self.walker.matrix
        middle = self._scale * grip_place(self._rig, turns, places, held.grip)
        turn = matrix[:3, :3] @ held.turn
        origin = matrix[:3, :3] @ middle + matrix[:3, 3] - turn @ held.middle
        carry(self._client, body, turn, origin)

    def _pass_through(self, name: str, passes: bool) -> None:
        crowd = self.walker.crowd
        body = None if crowd is None else crowd.body(name)
        if body is not None and self._limbs is not None:
            self._limbs.pass_through(body.bullet_id, body.link, passes=passes)


def deformations_of(
    bodies: Mapping[int, Body], pieces: Iterable[LabelledPiece]
) -> dict[int, Deformation]:
    """Return the vertices of the pieces that deform, by their ids."""
    shapes = {
        id_: body.deformation() for id_, body in bodies.items() if isinstance(body, PersonBody)
    }
    if not shapes:
        return {}
    return {
        piece.id: shapes[piece.body_id].only(piece.meshes)
        for piece in pieces
        if piece.body_id in shapes
    }


def skeletons_of(bodies: Mapping[int, Body]) -> dict[int, Skeleton]:
    """Return the skeletons of people and animals, by their ids, as `deformations_of` found them."""
    return {
        id_: body.skeleton(body.frames)
        for id_, body in bodies.items()
        if isinstance(body, PersonBody)
    }
