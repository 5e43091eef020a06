"""Poses and velocities of all instances of a scene at one instant.

Made by `world/`; every `Frame` carries it, messages and recordings keep it. What motion between
two frames, and everything else about objects in space, is computed from.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.rebuilding import RebuiltByFields
from sailenv_ros.types.skeleton import Skeleton

__all__ = ["InstanceStates", "rotation_matrices"]

_NO_NUMBERS = ("deformations", "skeletons")


@dataclass(frozen=True, eq=False, kw_only=True)
class InstanceStates(RebuiltByFields):
    """Poses and velocities of all instances, static and moving, at one instant.

    Arrays are read-only. An instance's own frame is that of its asset's mesh, its scale applied,
    so that distances in it are metres.

    Attributes
    ----------
    ids : (N,) uint16
        Instance ids, ascending.
    positions : (N, 3) float64
        Origin of each instance's own frame in the world [m].
    orientations : (N, 4) float64
        Unit quaternions x, y, z, w of the rotation world-from-instance.
    linear_velocities : (N, 3) float64
        Of the origin, world axes [m/s]; 0 for what is static.
    angular_velocities : (N, 3) float64
        World axes [rad/s]; 0 for what is static.
    scales : (N, 3) float64
        Of the asset's mesh along its own axes; 1 unless given.
    histories : (N,) int64
        A number that changes when an instance's past is cut off (it was spawned, asked to
        teleport, or got another scale). Between two instants with different numbers it has no
        motion. All 0 unless given.
    deformations : mapping of int to Deformation
        Vertices of the instances that deform, by their ids. Messages and files leave them out.
    skeletons : mapping of int to Skeleton
        Of people and animals, by their ids.

    Raises
    ------
    InvalidRequest
        If shapes do not fit each other, a number is not finite, ids do not ascend, or a
        quaternion is not of unit length within 1e-3.
    """

    ids: NDArray[np.uint16]
    positions: NDArray[np.float64]
    orientations: NDArray[np.float64]
    linear_velocities: NDArray[np.float64]
    angular_velocities: NDArray[np.float64]
    scales: NDArray[np.float64] = None  # type: ignore[assignment]  # an array once constructed
    histories: NDArray[np.int64] = None  # type: ignore[assignment]  # the same
    deformations: Mapping[int, Deformation] = field(default_factory=dict)
    skeletons: Mapping[int, Skeleton] = field(default_factory=dict)

    def __post_init__(self) -> None:
        ids = _frozen("ids", self.ids, np.uint16, (None,))
        count = len(ids)
        if np.any(ids[1:] <= ids[:-1]) or (count and ids[0] == 0):
            raise InvalidRequest("ids of instances", ids, "ascending, from 1")
        histories = np.zeros(count, np.int64) if self.histories is None else self.histories
        columns = {
            "positions": (self.positions, 3),
            "orientations": (self.orientations, 4),
            "linear_velocities": (self.linear_velocities, 3),
            "angular_velocities": (self.angular_velocities, 3),
            "scales": (np.ones((count, 3)) if self.scales is None else self.scales, 3),
        }
        object.__setattr__(self, "ids", ids)
        object.__setattr__(self, "histories", _frozen("histories", histories, np.int64, (count,)))
        for name, (values, width) in columns.items():
            array = _frozen(name, values, np.float64, (count, width))
            if not np.isfinite(array).all():
                raise InvalidRequest(f"{name} of instances", array, "finite numbers")
            object.__setattr__(self, name, array)
        if not set(self.skeletons) <= set(ids.tolist()):
            raise InvalidRequest("skeletons", sorted(self.skeletons), "those of instances")
        norms = np.linalg.norm(self.orientations, axis=1)
        if np.any(np.abs(norms - 1.0) > 1e-3):
            raise InvalidRequest("orientations of instances", norms, "unit quaternions x, y, z, w")

    def __len__(self) -> int:
        return len(self.ids)

    def __eq__(self, other: object) -> bool:
        """Return whether all numbers are the same."""
        if not isinstance(other, InstanceStates):
            return NotImplemented
        names = [entry.name for entry in fields(self) if entry.name not in _NO_NUMBERS]
        return self.deformations == other.deformations and all(
            np.array_equal(getattr(self, name), getattr(other, name)) for name in names
        )

    __hash__ = None  # type: ignore[assignment]  # arrays have none

    @cached_property
    def matrices(self) -> NDArray[np.float64]:
        """(N, 4, 4) float64 read-only: world_from_instance, rigid."""
        result = np.zeros((len(self), 4, 4))
        result[:, :3, :3] = rotation_matrices(self.orientations)
        result[:, :3, 3] = self.positions
        result[:, 3, 3] = 1.0
        result.flags.writeable = False
        return result

    @cached_property
    def row_of_id(self) -> NDArray[np.int32]:
        """(65536,) int32 read-only: row of each instance id, -1 where there is none."""
        rows = np.full(65536, -1, np.int32)
        rows[self.ids] = np.arange(len(self), dtype=np.int32)
        rows.flags.writeable = False
        return rows

    def row(self, instance_id: int) -> int:
        """Return the row of one instance.

        Raises
        ------
        InvalidRequest
            If no instance had that id at this instant.
        """
        row = int(np.searchsorted(self.ids, instance_id)) if 0 <= instance_id <= 65535 else -1
        if not 0 <= row < len(self) or self.ids[row] != instance_id:
            accepted = "the id of an instance that there was at this instant"
            raise InvalidRequest("instance id", instance_id, accepted)
        return row


def rotation_matrices(quats_xyzw: ArrayLike) -> NDArray[np.float64]:
    """Return (N, 3, 3) float64 rotation matrices of (N, 4) unit quaternions x, y, z, w.

    The same operations as `Pose.matrix`, so the same bits for the same quaternion.
    """
    x, y, z, w = np.asarray(quats_xyzw, np.float64).reshape(-1, 4).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows, np.float64), -1, 0)


def _frozen(
    name: str, values: ArrayLike, dtype: type, shape: tuple[int | None, ...]
) -> NDArray[Any]:
    """Return a read-only array of that type and shape; an own one if it was writable."""
    array: NDArray[Any] = np.ascontiguousarray(values, dtype)
    if array.ndim != len(shape) or any(
        wanted is not None and size != wanted
        for size, wanted in zip(array.shape, shape, strict=True)
    ):
        accepted = f"an array of shape {tuple('N' if size is None else size for size in shape)}"
        raise InvalidRequest(f"{name} of instances", f"shape {array.shape}", accepted)
    if array.flags.writeable:
        array = array.copy()
        array.flags.writeable = False
    return array
