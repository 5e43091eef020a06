"""Scene as clients see it: names, tables, agents; sent again at every change.

Made by `simulation.py` from the world's `SceneContents`; goes to messages, sockets, windows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import CategoryTable, Instance
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.rebuilding import RebuiltByFields
from sailenv_ros.types.rigid_body import RigidBody
from sailenv_ros.types.validation import Bounds

__all__ = [
    "REAL_TIME_FACTOR",
    "InstanceColumns",
    "MoverInfo",
    "SceneInfo",
    "SceneObject",
    "TimeMode",
]

TimeMode = Literal["realtime", "lockstep"]

REAL_TIME_FACTOR = Bounds(least=0.1, most=10.0)
"""Simulated seconds per wall second that can be aimed at."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoverInfo:
    """One mover.

    Attributes
    ----------
    name : str
    controller : {'waypoint', 'rigidbody'}
        What drives it: the scene's waypoints, or commands and set poses.
    waypoints : tuple of Pose
        Its track, run through at equal times.
    total_time_s : float
        Time to run through all of them once [s].
    loop : bool
        True if the last waypoint leads on to the first.
    body : RigidBody or None
        None unless forces move it.
    look_at : LookAt or None
        What it faces now.
    """

    name: str
    controller: Literal["waypoint", "rigidbody"]
    waypoints: tuple[Pose, ...] = ()
    total_time_s: float = 30.0
    loop: bool = True
    body: RigidBody | None = None
    look_at: LookAt | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneObject:
    """One object of the scene.

    Attributes
    ----------
    name : str
        Its name in the scene, unique there.
    category_id : int
    category : str
    static : bool
        True if physics never moves it.
    moving : bool
        True if a behaviour moves it.
    """

    name: str
    category_id: int
    category: str
    static: bool
    moving: bool


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class InstanceColumns:
    """The objects of a scene as columns, in the order of their ids; arrays are read-only.

    Attributes
    ----------
    ids, category_ids, parents : (N,) uint16
    names, categories, assets : (N,) tuple of str
    static : (N,) bool
    low_m, high_m : (N, 3) float64
        See `Instance`.
    """

    ids: NDArray[np.uint16]
    category_ids: NDArray[np.uint16]
    parents: NDArray[np.uint16]
    names: tuple[str, ...]
    categories: tuple[str, ...]
    assets: tuple[str, ...]
    static: NDArray[np.bool_]
    low_m: NDArray[np.float64]
    high_m: NDArray[np.float64]


@dataclass(frozen=True, eq=False, kw_only=True)
class SceneInfo(RebuiltByFields):
    """The scene as clients see it.

    Attributes
    ----------
    scene : str
        Name of the present scene.
    scenes : tuple of str
        Names that `change_scene` accepts.
    epoch : int
        Grows at each change of scene and each reset.
    revision : int
        Grows at each change; a frame carries that of the scene_info that was true when it was made.
    sim_time_ns : int
        When this was made [ns].
    mode : {'realtime', 'lockstep'}
    paused : bool
    real_time_factor : float
        Simulated seconds per wall second that are aimed at.
    seed : int
    categories : CategoryTable
    instances : tuple of Instance
    moving : frozenset of int
        Ids of the instances that a behaviour moves.
    spawnables : tuple of str
        Catalogue names that may be spawned.
    lights : tuple of Light
    environment : Environment
    agents : tuple of AgentSpec
    movers : tuple of MoverInfo
    renderer : str
        One line: back end, device, driver.
    """

    scene: str
    scenes: tuple[str, ...]
    epoch: int
    revision: int
    sim_time_ns: int
    mode: TimeMode
    paused: bool
    real_time_factor: float
    seed: int
    categories: CategoryTable
    instances: tuple[Instance, ...]
    moving: frozenset[int] = frozenset()
    spawnables: tuple[str, ...] = ()
    lights: tuple[Light, ...] = ()
    environment: Environment = field(default_factory=Environment)
    agents: tuple[AgentSpec, ...] = ()
    movers: tuple[MoverInfo, ...] = ()
    renderer: str = ""

    @cached_property
    def objects(self) -> Mapping[int, SceneObject]:
        """The objects by their ids, the values of the instance view; not to be written to."""
        return {
            instance.id: SceneObject(
                name=instance.name,
                category_id=instance.category_id,
                category=instance.category,
                static=instance.static,
                moving=instance.id in self.moving,
            )
            for instance in self.instances
        }

    @cached_property
    def instance_columns(self) -> InstanceColumns:
        """The objects as columns."""
        ordered = sorted(self.instances, key=lambda instance: instance.id)
        arrays: dict[str, Any] = {
            "ids": np.array([one.id for one in ordered], np.uint16),
            "category_ids": np.array([one.category_id for one in ordered], np.uint16),
            "parents": np.array([one.parent for one in ordered], np.uint16),
            "static": np.array([one.static for one in ordered], np.bool_),
            "low_m": np.array([one.low_m for one in ordered], np.float64).reshape(-1, 3),
            "high_m": np.array([one.high_m for one in ordered], np.float64).reshape(-1, 3),
        }
        for values in arrays.values():
            values.flags.writeable = False
        return InstanceColumns(
            names=tuple(one.name for one in ordered),
            categories=tuple(one.category for one in ordered),
            assets=tuple(one.asset for one in ordered),
            **arrays,
        )
