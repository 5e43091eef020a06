"""Commands about robots: one is put into the scene, and goes as a whole. Part of `commands`."""

from __future__ import annotations

from typing import Any

from sailenv_ros.assets.robots import is_of_package
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.types.geometry import Pose
from sailenv_ros.viewer.command_context import Command, CommandContext, CommandTable, Run
from sailenv_ros.viewer.operation_commands import OPERATION_COMMANDS
from sailenv_ros.viewer.picking import pixel_of, standing_point
from sailenv_ros.viewer.recorded_commands import take_down
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.served_commands import served

__all__ = ["ROBOT_COMMANDS"]

ROBOT_COMMANDS = CommandTable()


@ROBOT_COMMANDS.changes
@served
async def add_robot(
    context: CommandContext, file: str, u: int, v: int, frame: int | None = None, mount: str = ""
) -> int:
    """Put a robot of a package's file where a pixel is seen; tell the id of its first link.

    Other paths would let a page read what is on the simulator's computer.
    """
    if not is_of_package(file):
        accepted = "PACKAGE:path of an installed Python package, as pybullet_data:r2d2.urdf"
        raise InvalidRequest("file of a robot", file, accepted)
    seen = context.frame(frame)
    point = standing_point(seen, *pixel_of(seen, u, v))
    pose = Pose.from_rpy_deg(point, (0.0, 0.0, seen.camera.pose.rpy_deg[2] + 180.0))
    async with context.history.busy:
        epoch = context.info.epoch
        name = await context.run(Operations.spawn_robot, file, pose=pose, mount=mount)
        after = await context.run(EditOperations.robot_record, name)
        take_down(context, f"adding {name}", ("adding", name), epoch, None, after)
        links = (await context.run(Operations.get_robot, name)).links
    return next(iter(links.values()))


def _of_robots(run: Run) -> Run:
    """Have the command that deletes an object delete a whole robot, if it is a link of one."""

    async def delete(context: CommandContext, given: Arguments) -> Any:
        name = await context.run(EditOperations.robot_of_object, given.get("obj"))
        if not name:
            return await run(context, given)
        async with context.history.busy:
            epoch = context.info.epoch
            before = await context.run(EditOperations.robot_record, name)
            await context.run(Operations.despawn_robot, name)
            take_down(context, f"deleting {name}", ("deleting", name), epoch, before, None)
        return None

    return delete


_delete = OPERATION_COMMANDS["despawn_object"]
ROBOT_COMMANDS["despawn_object"] = Command(
    run=_of_robots(_delete.run), changes=True, is_operation=True, answer=_delete.answer
)
