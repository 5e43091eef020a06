"""What a client may ask for about joints: the selected one, and to open it; part of `commands`."""

from __future__ import annotations

import math
from typing import Any

from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.joints import JointState
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.recorded_commands import edits_object
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.scene_json import object_to_json

__all__ = ["JOINT_COMMANDS"]

JOINT_COMMANDS = CommandTable()

ENDLESS = {"hinge": math.pi, "slide": 1.0}
"""How far a slider goes to both sides for a joint without limits [rad], [m]."""


@JOINT_COMMANDS.looks
async def get_joint(context: CommandContext, given: Arguments) -> Any:
    """Return the joint of an object; nothing where it has none that moves."""
    number = given.integer("object")
    joints = await context.run(Operations.get_joints)
    return next((_to_json(joint) for joint in joints if joint.id == number), None)


@JOINT_COMMANDS.changes
@edits_object("opening")
async def set_joint(context: CommandContext, given: Arguments) -> Any:
    """Open or close what moves on a joint."""
    number = given.integer("object")
    await context.run(Operations.set_joint_position, number, given.number("position"))
    return object_to_json(await context.run(Operations.get_object, number))


def _to_json(joint: JointState) -> dict[str, Any]:
    reach = ENDLESS[joint.type]
    return {
        "type": joint.type,
        "position": joint.position,
        "low": joint.low if math.isfinite(joint.low) else joint.position - reach,
        "high": joint.high if math.isfinite(joint.high) else joint.position + reach,
    }
