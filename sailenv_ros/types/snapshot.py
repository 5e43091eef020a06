"""A frozen copy of the world at one instant of simulated time.

Comes from `world/`, goes to `render/`. `SceneContents` is what changes seldom (what exists, what
it looks like, lights); `WorldSnapshot` adds the poses. Both are immutable, so optical flow is a
pure function of two snapshots and the cameras that go with them.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.baked_light import BakedLight, ObjectLight
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.labels import CategoryTable, Instance
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Model
from sailenv_ros.types.outside import Outside
from sailenv_ros.types.row_poses import RowPoses

__all__ = [
    "REST_S",
    "AdaptedExposure",
    "DrawnInstance",
    "Observation",
    "SceneContents",
    "WorldSnapshot",
]

REST_S = 0.5
"""Simulated time for which something must stay where it was put to count as resting [s]."""

STEADY_STEP_M, STEADY_STEP = 1e-3, 1.0 / 512.0
"""Steps of `steady_poses` along and about axes."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class DrawnInstance:
    """One object to draw: its labels, its looks and its scale.

    Attributes
    ----------
    instance : Instance
    model : Model
        Shared between instances; compared by identity.
    scale : (3,) tuple of float
        Applied to the model in its body frame, before the pose.
    lit_by : tuple of str
        Names of the lights whose lamp it is: by these its shade and bulb glow (`Material.glow`).
    stands : bool or None
        True if its light is baked: it never moves, or stands until its joint is moved. None takes
        what the instance says of physics.
    outside : Outside or None
        Of what lies outside a room. It is shown as the sky is: what its materials emit is the
        radiance that they have there, blended with the room as the sky is where that is wanted; it
        takes no light, casts no shadow and gives none.
    deforms : bool
        True if snapshots say where its vertices are: its model is what it is at rest.
    """

    instance: Instance
    model: Model
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    lit_by: tuple[str, ...] = ()
    stands: bool | None = None
    outside: Outside | None = None
    deforms: bool = False

    def lamp_power(self, lights: Iterable[Light]) -> tuple[float, float, float]:
        """Return (3,): radiant intensity of the lights whose lamp it is, summed [W/sr]."""
        if not self.lit_by:
            return (0.0, 0.0, 0.0)
        own = [light.power for light in lights if light.name in self.lit_by]
        red, green, blue = (float(sum(power[channel] for power in own)) for channel in range(3))
        return red, green, blue

    @property
    def is_baked(self) -> bool:
        """True if its light is baked with that of what stands still."""
        return self.instance.static if self.stands is None else self.stands


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneContents:
    """Contents of a scene, apart from poses; compared by identity.

    Attributes
    ----------
    scene : str
        Name of the scene.
    epoch : int
        Grows at each change of scene and each reset: frames of two epochs have no common past.
    revision : int
        Grows at each change of anything here.
    instances : tuple of DrawnInstance
        In the order of the snapshot's rows.
    categories : CategoryTable
    lights : tuple of Light
    environment : Environment
    baked : BakedLight or None
        Light computed beforehand for what stands still; None where there is none.
    """

    scene: str
    epoch: int
    revision: int
    instances: tuple[DrawnInstance, ...]
    categories: CategoryTable
    lights: tuple[Light, ...] = ()
    environment: Environment = field(default_factory=Environment)
    baked: BakedLight | None = None

    @cached_property
    def instance_ids(self) -> NDArray[np.uint16]:
        """(N,) uint16 read-only: instance id of each row."""
        ids = np.array([drawn.instance.id for drawn in self.instances], dtype=np.uint16)
        ids.flags.writeable = False
        return ids

    @cached_property
    def category_of_instance(self) -> NDArray[Any]:
        """(65536,) read-only, of `CategoryTable.dtype`: category id of each instance id, else 0."""
        table = np.zeros(65536, dtype=self.categories.dtype)
        for drawn in self.instances:
            table[drawn.instance.id] = drawn.instance.category_id
        table.flags.writeable = False
        return table


@dataclass(frozen=True, eq=False, kw_only=True)
class WorldSnapshot:
    """Poses of everything at one instant.

    Attributes
    ----------
    sim_time_ns : int
        Simulated time since the last reset [ns].
    step : int
        Physics steps since the last reset.
    contents : SceneContents
    world_from_body : (N, 4, 4) float64
        Read-only; rows in the order of ``contents.instances``. Rigid; scale is in the contents.
    histories : (N,) int64
        Read-only; a number that changes when an object's past is cut off (it was spawned or
        asked to teleport). Flow exists between two snapshots only for equal numbers.
    velocities : (N, 2, 3) float64 or None
        Read-only; of the origin of each body frame [m/s], and angular [rad/s], in world axes. None
        if nothing moves.
    settling : (N,) bool or None
        Read-only; what a request has put where it is within the last `REST_S`. None if nothing.
    deformations : mapping of int to Deformation
        Of the instances that deform, by their ids; the same object while a shape is unchanged.
    object_light : mapping of int to ObjectLight
        Light on what can move, by instance id, where it is known better than by probes; of the
        layers of the contents' baked light. The same mapping while nothing of it is changed.
    """

    sim_time_ns: int
    step: int
    contents: SceneContents
    world_from_body: NDArray[np.float64]
    histories: NDArray[np.int64]
    velocities: NDArray[np.float64] | None = None
    settling: NDArray[np.bool_] | None = None
    deformations: Mapping[int, Deformation] = field(default_factory=dict)
    object_light: Mapping[int, ObjectLight] = field(default_factory=dict)

    def __post_init__(self) -> None:
        count = len(self.contents.instances)
        arrays: dict[str, NDArray[Any]] = {
            "poses": self.world_from_body,
            "histories": self.histories,
        }
        if self.velocities is not None:
            arrays["velocities"] = self.velocities
        if self.settling is not None:
            arrays["settling"] = self.settling
        shapes = {"poses": (count, 4, 4), "histories": (count,), "velocities": (count, 2, 3)}
        shapes["settling"] = (count,)
        for name, array in arrays.items():
            if array.shape != shapes[name]:
                raise ValueError(
                    f"{name} of {count} instances must have the shape {shapes[name]}, "
                    f"got {array.shape}"
                )
            array.flags.writeable = False

    def of_rows(self, rows: NDArray[np.bool_ | np.integer[Any]]) -> WorldSnapshot:
        """Return the snapshot of some instances alone: a mask (N,), or places of rows."""
        places = np.arange(len(self.world_from_body))[rows]
        instances = tuple(self.contents.instances[place] for place in places)
        return replace(
            self,
            contents=replace(self.contents, instances=instances),
            world_from_body=self.world_from_body[places],
            histories=self.histories[places],
            velocities=None if self.velocities is None else self.velocities[places],
            settling=None if self.settling is None else self.settling[places],
        )

    @property
    def moving(self) -> NDArray[np.bool_]:
        """(N,) bool: what moves at this instant, or has not settled yet."""
        moving = np.zeros(len(self.world_from_body), np.bool_)
        if self.velocities is not None:
            moving |= self.velocities.any(axis=(1, 2))
        return moving if self.settling is None else moving | self.settling


def steady_poses(poses: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return poses (N, 4, 4) in steps that cannot be seen: what comes to rest creeps for seconds.

    Rounded, rather than kept until they are too far off: no picture depends on those before it.
    """
    steady = np.round(poses / STEADY_STEP) * STEADY_STEP
    steady[:, :3, 3] = np.round(poses[:, :3, 3] / STEADY_STEP_M) * STEADY_STEP_M
    return steady + 0.0  # no zero has a sign


class AdaptedExposure(NamedTuple):
    """Automatic exposure of a camera at one instant.

    Attributes
    ----------
    stops : float
        Stops that the picture is brightened by, besides the scene's and the camera's own.
    sim_time_ns : int
        When that was [ns].
    """

    stops: float
    sim_time_ns: int


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Observation:
    """Observation of one camera: one to draw, or the past that flow and occlusion refer to.

    Attributes
    ----------
    snapshot : WorldSnapshot
    camera : Camera
    depth : (H, W) float32 or None
        The depth view of then, or ``range`` through a lens other than a pin-hole; needed for the
        occlusion view alone.
    rows : RowPoses or None
        Where a shutter rolls and something moves, the poses of each row; snapshot and camera are
        those of the instant in the middle.
    adapted : AdaptedExposure or None
        Of its last picture, if its exposure is automatic.
    """

    snapshot: WorldSnapshot
    camera: Camera
    depth: NDArray[np.float32] | None = None
    rows: RowPoses | None = None
    adapted: AdaptedExposure | None = None
