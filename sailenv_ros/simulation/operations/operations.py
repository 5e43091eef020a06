"""All groups of operations as one class, and all operations by their names."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from sailenv_ros.simulation.operations.agent_operations import AgentOperations
from sailenv_ros.simulation.operations.body_operations import BodyOperations
from sailenv_ros.simulation.operations.chance_operations import ChanceOperations
from sailenv_ros.simulation.operations.clock_operations import ClockOperations
from sailenv_ros.simulation.operations.environment import EnvironmentOperations
from sailenv_ros.simulation.operations.frame_pictures import FramePictures
from sailenv_ros.simulation.operations.joint_operations import JointOperations
from sailenv_ros.simulation.operations.lesson_operations import LessonOperations
from sailenv_ros.simulation.operations.light_operations import LightOperations
from sailenv_ros.simulation.operations.look_operations import LookOperations
from sailenv_ros.simulation.operations.material_operations import MaterialOperations
from sailenv_ros.simulation.operations.models import ModelOperations
from sailenv_ros.simulation.operations.movers import MoverOperations
from sailenv_ros.simulation.operations.object_operations import ObjectOperations
from sailenv_ros.simulation.operations.operation import Operation
from sailenv_ros.simulation.operations.rig_operations import RigOperations
from sailenv_ros.simulation.operations.robot_operations import RobotOperations
from sailenv_ros.simulation.operations.sailenv_names import SailenvNames
from sailenv_ros.simulation.operations.saving_operations import SavingOperations
from sailenv_ros.simulation.operations.space_operations import SpaceOperations
from sailenv_ros.simulation.operations.viewpoint_operations import ViewpointOperations

__all__ = ["ALL_OPERATIONS", "Operations", "WorldOperations"]


class WorldOperations(
    AgentOperations,
    RigOperations,
    LookOperations,
    ObjectOperations,
    JointOperations,
    RobotOperations,
    MaterialOperations,
    LightOperations,
    EnvironmentOperations,
    MoverOperations,
    BodyOperations,
    SpaceOperations,
    ViewpointOperations,
    SavingOperations,
    ClockOperations,
    ChanceOperations,
    LessonOperations,
):
    """Every operation on the world and its agents."""


class Operations(SailenvNames, WorldOperations, ModelOperations, FramePictures):
    """Every operation; what `Simulation` and `Agent` have in common, see `docs/operations.md`."""


def _declared() -> dict[str, Operation[..., Any]]:
    members = {name: getattr(Operations, name) for name in dir(Operations)}
    return {name: member for name, member in members.items() if isinstance(member, Operation)}


ALL_OPERATIONS: Mapping[str, Operation[..., Any]] = MappingProxyType(_declared())
"""Every operation by its name."""
