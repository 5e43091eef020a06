"""Meaning of instance ids: bodies and the labelled parts of bodies."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import PART_MARK
from sailenv_ros.types.model import AssetPart
from sailenv_ros.types.skeleton import Skeleton
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.types.validation import is_integer
from sailenv_ros.world.bodies import Body

__all__ = ["LabelledPiece", "find_piece", "pieces_of", "states_of", "velocities_of"]


@dataclass(frozen=True, eq=False, slots=True)
class LabelledPiece:
    """Meaning of one instance id: a body without its parts, or one part of it.

    Attributes
    ----------
    id : int
    body_id : int
        Of the body; the same as `id` unless this is a part.
    body : Body
    part : AssetPart or None
        None for the body.
    """

    id: int
    body_id: int
    body: Body
    part: AssetPart | None

    @property
    def name(self) -> str:
        """Its name in the scene."""
        name = self.body.placement.name
        return name if self.part is None else f"{name}{PART_MARK}{self.part.name}"

    @property
    def meshes(self) -> tuple[int, ...]:
        """Places of its meshes in the parts of the body's model."""
        return self.body.placement.asset.meshes_of(self.part)


def pieces_of(
    bodies: Mapping[int, Body], parts: Mapping[int, Sequence[int]]
) -> tuple[LabelledPiece, ...]:
    """Return bodies and their parts, whose ids `parts` has by body, in the order of their ids."""
    made = [
        LabelledPiece(id_, body_id, body, part)
        for body_id, body in bodies.items()
        for id_, part in (
            (body_id, None),
            *zip(parts[body_id], body.placement.asset.parts, strict=True),
        )
    ]
    return tuple(sorted(made, key=lambda piece: piece.id))


def find_piece(pieces: Sequence[LabelledPiece], obj: object) -> LabelledPiece:
    """Find what is named by its id, also as a text, or by its name.

    Raises
    ------
    UnknownName, InvalidRequest
        If there is no such object now.
    """
    if is_integer(obj):
        for piece in pieces:
            if piece.id == obj:
                return piece
        raise InvalidRequest("instance id", obj, "the id of an object in the scene")
    if not isinstance(obj, str):
        raise InvalidRequest("object", obj, "an instance id, or the name of an object")
    named = {piece.name: piece for piece in pieces}
    if obj in named:
        return named[obj]
    if obj.isdecimal():  # scripts of the SAILenv client hold ids as texts
        for piece in pieces:
            if piece.id == int(obj):
                return piece
    raise UnknownName("object", obj, named)


def velocities_of(
    pieces: Sequence[LabelledPiece], world_from_body: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (N, 2, 3) velocities of pieces, linear and angular, at poses that were just read."""
    found = [
        piece.body.origin_velocity(matrix)
        for piece, matrix in zip(pieces, world_from_body, strict=True)
    ]
    return np.array(found, np.float64).reshape(-1, 2, 3)


def states_of(
    pieces: Sequence[LabelledPiece],
    snapshot: WorldSnapshot,
    skeletons: Mapping[int, Skeleton],
) -> InstanceStates:
    """Return where pieces are and how they move.

    Parameters
    ----------
    pieces : sequence of LabelledPiece
    snapshot : WorldSnapshot
        With a row for each, that was just made.
    skeletons : mapping of int to Skeleton
        As of `InstanceStates`.
    """
    velocities = snapshot.velocities
    if velocities is None:
        velocities = np.zeros((len(pieces), 2, 3))
    quats = [piece.body.orientation_of_matrix() for piece in pieces]
    scales = [piece.body.placement.scale for piece in pieces]
    return InstanceStates(
        ids=np.array([piece.id for piece in pieces], np.uint16),
        positions=snapshot.world_from_body[:, :3, 3],
        orientations=np.array(quats, np.float64).reshape(-1, 4),
        linear_velocities=velocities[:, 0],
        angular_velocities=velocities[:, 1],
        scales=np.array(scales, np.float64).reshape(-1, 3),
        histories=snapshot.histories,
        deformations=snapshot.deformations,
        skeletons=skeletons,
    )
