"""Commands about the room: its floor plan, another size, a new one from a seed.

Arguments as JSON has them in, requests to a `Simulation` out. Part of `commands`.
"""

from __future__ import annotations

from sailenv_ros.authoring.room_rules.names import MAX_SEED, PREFIX
from sailenv_ros.authoring.room_rules.rule_files import rules_of
from sailenv_ros.errors import UnknownName
from sailenv_ros.simulation.operations.operations import Operations
from sailenv_ros.simulation.operations.rooms import RoomOperations
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.recorded_commands import take_down
from sailenv_ros.viewer.room_messages import FloorPlanValues, RoomKind, RoomMade, RoomSet
from sailenv_ros.viewer.scene_messages import Vector3
from sailenv_ros.viewer.served_commands import served

__all__ = ["ROOM_COMMANDS"]

ROOM_COMMANDS = CommandTable()


@ROOM_COMMANDS.looks
@served
async def floor_plan(context: CommandContext) -> FloorPlanValues:
    """Return the room and what stands in it, seen from above [m]; the size is null for no room."""
    plan = await context.run(RoomOperations.floor_plan)
    return {
        "size": plan.size_m,
        "openings": [
            {"type": each.type, "wall": each.wall, "at": each.at, "width": each.width}
            for each in plan.openings
        ],
        "objects": [
            {"id": each.id, "name": each.name, "corners": list(each.corners_m)}
            for each in plan.objects
        ],
    }


@ROOM_COMMANDS.changes
@served
async def set_room(context: CommandContext, size: Vector3) -> RoomSet:
    """Resize the room, or make one; tell the objects whose places it has taken."""
    async with context.history.busy:
        epoch = context.info.epoch
        before, after = await context.run(RoomOperations.set_room_size, size)
        words = "making the room" if before.room is None else "resizing the room"
        take_down(context, words, (words,), epoch, before, after)
    return {"replaced": [record.name for record in before.objects]}


@ROOM_COMMANDS.looks
@served
async def room_kinds(context: CommandContext) -> list[RoomKind]:
    """Return the kinds of rooms that can be generated, each with its title."""
    rules = rules_of()
    return [{"kind": kind, "title": rules.kind(kind).title} for kind in sorted(rules.kinds)]


@ROOM_COMMANDS.changes
@served
async def generate_room(context: CommandContext, kind: str, seed: int) -> RoomMade:
    """Begin a generated room; tell the name by which it is begun again."""
    checked_integer("seed", seed, 0, MAX_SEED)
    if kind not in rules_of().kinds:
        raise UnknownName("kind of room", kind, sorted(rules_of().kinds))
    name = f"{PREFIX}{kind}:{seed}"
    await context.run(Operations.change_scene, name)
    return {"scene": name}
