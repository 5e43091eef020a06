"""Each service and action with its handler, and the features that it stands for."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from typing import Any

from simulation_interfaces import srv
from simulation_interfaces.msg import SimulatorFeatures

from sailenv_ros.ros.nodes.simulation_interfaces import (
    catalogue,
    clock,
    entities,
    spawning,
    worlds,
)
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.resources import spawn_formats
from sailenv_ros.version import __version__

__all__ = ["ROWS", "Row", "features_of"]

Handler = Callable[[Desk, Any, Any], Awaitable[None]]

ACTION_FEATURES = ("STEP_SIMULATION_ACTION",)


@dataclass(frozen=True, slots=True)
class Row:
    """One service.

    Attributes
    ----------
    type_name : str
        In `simulation_interfaces.srv`; its name as words is that of the service.
    handler : callable
    features : tuple of str
        Constants of `SimulatorFeatures` that it stands for.
    needs_world : bool
        True if it is refused while no world is loaded.
    """

    type_name: str
    handler: Handler
    features: tuple[str, ...]
    needs_world: bool = True

    @property
    def type(self) -> Any:
        """The service's type."""
        return getattr(srv, self.type_name)


ROWS = (
    Row("SpawnEntity", spawning.spawn_entity, ("SPAWNING", "SPAWNING_RESOURCE_STRING")),
    Row("SpawnEntities", spawning.spawn_entities, ("SPAWNING_ENTITIES",)),
    Row("DeleteEntity", entities.delete_entity, ("DELETING",)),
    Row(
        "GetEntities",
        entities.get_entities,
        ("ENTITY_TAGS", "ENTITY_CATEGORIES", "ENTITY_BOUNDS_BOX", "ENTITY_BOUNDS_CONVEX"),
    ),
    Row("GetEntitiesStates", entities.get_entities_states, ()),
    Row("GetEntityState", entities.get_entity_state, ("ENTITY_STATE_GETTING",)),
    Row("SetEntityState", entities.set_entity_state, ("ENTITY_STATE_SETTING",)),
    Row("GetEntityInfo", entities.get_entity_info, ("ENTITY_INFO_GETTING",)),
    Row("SetEntityInfo", entities.set_entity_info, ("ENTITY_INFO_SETTING",)),
    Row("GetEntityBounds", entities.get_entity_bounds, ("ENTITY_BOUNDS",)),
    Row("GetSpawnables", catalogue.get_spawnables, ("SPAWNABLES",), needs_world=False),
    Row("GetNamedPoses", catalogue.get_named_poses, ("NAMED_POSES",)),
    Row("GetNamedPoseBounds", catalogue.get_named_pose_bounds, ("POSE_BOUNDS",)),
    Row(
        "GetSimulationState",
        clock.get_simulation_state,
        ("SIMULATION_STATE_GETTING",),
        needs_world=False,
    ),
    Row(
        "SetSimulationState",
        clock.set_simulation_state,
        ("SIMULATION_STATE_SETTING", "SIMULATION_STATE_PAUSE"),
        needs_world=False,
    ),
    Row(
        "StepSimulation",
        clock.step_simulation,
        ("STEP_SIMULATION_SINGLE", "STEP_SIMULATION_MULTIPLE"),
    ),
    Row(
        "ResetSimulation",
        clock.reset_simulation,
        ("SIMULATION_RESET", "SIMULATION_RESET_STATE", "SIMULATION_RESET_SPAWNED"),
    ),
    Row("LoadWorld", worlds.load_world, ("WORLD_LOADING",), needs_world=False),
    Row("UnloadWorld", worlds.unload_world, ("WORLD_UNLOADING",), needs_world=False),
    Row("GetCurrentWorld", worlds.get_current_world, ("WORLD_INFO_GETTING",), needs_world=False),
    Row(
        "GetAvailableWorlds",
        worlds.get_available_worlds,
        ("AVAILABLE_WORLDS", "WORLD_TAGS"),
        needs_world=False,
    ),
)
"""All services but `GetSimulatorFeatures`, which tells what follows from this table."""


def features_of() -> SimulatorFeatures:
    """Make the list of features that the services and the action stand for."""
    offered = {name for row in ROWS for name in row.features}.union(ACTION_FEATURES)
    return SimulatorFeatures(
        features=sorted(getattr(SimulatorFeatures, name) for name in offered),
        spawn_formats=spawn_formats(),
        custom_info=(
            f"sailenv_ros {__version__}; spawnables by sailenv://asset/NAME, worlds by "
            "sailenv://scene/NAME; robots by URDF and MJCF files; see docs/simulation_interfaces.md"
        ),
    )
