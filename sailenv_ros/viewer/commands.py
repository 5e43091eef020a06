"""What a client may ask for besides frames: a table of names, each with who may and how it is done.

Arguments as JSON has them in, requests to a `Simulation` out. Types are checked here, meaning by
the simulation, whose sentences the page shows.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, Literal

from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose
from sailenv_ros.operations import Operations
from sailenv_ros.simulation.edit_operations import EditOperations
from sailenv_ros.viewer.chance_commands import CHANCE_COMMANDS
from sailenv_ros.viewer.command_context import Command, CommandContext, CommandTable
from sailenv_ros.viewer.joint_commands import JOINT_COMMANDS
from sailenv_ros.viewer.lesson_commands import LESSON_COMMANDS
from sailenv_ros.viewer.light_commands import LIGHT_COMMANDS
from sailenv_ros.viewer.look_commands import LOOK_COMMANDS
from sailenv_ros.viewer.material_commands import MATERIAL_COMMANDS
from sailenv_ros.viewer.object_overlay import overlay_of
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from sailenv_ros.viewer.recorded_commands import edits_object
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.room_commands import ROOM_COMMANDS
from sailenv_ros.viewer.scene_json import object_to_json, pose_to_json

__all__ = ["COMMANDS"]

MAX_STEPS_AT_ONCE = 2400
"""Ten seconds of simulated time: nobody else is served meanwhile."""

_commands = CommandTable(
    {
        **LIGHT_COMMANDS,
        **ROOM_COMMANDS,
        **MATERIAL_COMMANDS,
        **JOINT_COMMANDS,
        **CHANCE_COMMANDS,
        **LESSON_COMMANDS,
        **LOOK_COMMANDS,
    }
)

COMMANDS: Mapping[str, Command] = MappingProxyType(_commands)
"""Every command by its name."""

CONTROLLERS: tuple[Literal["waypoint"], Literal["rigidbody"]] = ("waypoint", "rigidbody")

OBJECT_KEYS = ("name", "category", "scale")


# -- looking ---------------------------------------------------------------------------------


@_commands.looks
async def probe(context: CommandContext, given: Arguments) -> Any:
    """Return the values at a pixel of a frame."""
    frame = context.frame(given.get("frame"))
    return values_at(frame, context.info, *pixel_of(frame, given.get("u"), given.get("v")))


@_commands.looks
async def objects(context: CommandContext, given: Arguments) -> Any:
    """Return what is drawn over a frame of its objects; see `object_overlay`."""
    frame = context.frame(given.get("frame"))
    # Drawing an object alone waits for the simulation.
    return await asyncio.to_thread(
        overlay_of,
        frame,
        boxes=given.flag("boxes"),
        space=given.flag("space"),
        whole=given.integer("whole"),
    )


@_commands.looks
async def get_object(context: CommandContext, given: Arguments) -> Any:
    """Return what and where an object is."""
    return object_to_json(await context.run(Operations.get_object, given.integer("object")))


@_commands.looks
async def select(context: CommandContext, given: Arguments) -> Any:
    """Have an object's outline told with each frame; 0 for none."""
    context.select(given.integer("object"))


@_commands.looks
async def scene_text(context: CommandContext, given: Arguments) -> Any:
    """Return the present world as the text of a scene file."""
    return await context.run(Operations.scene_text, title=given.optional_text("title"))


# -- scene and time --------------------------------------------------------------------------


@_commands.changes
async def change_scene(context: CommandContext, given: Arguments) -> Any:
    """Begin another scene; of those in the list alone, for a path would be read."""
    name = given.text("scene")
    if name not in context.info.scenes:
        raise InvalidRequest("scene", name, f"one of: {', '.join(context.info.scenes)}")
    await context.run(Operations.change_scene, name)


@_commands.changes
async def reset(context: CommandContext, given: Arguments) -> Any:
    """Begin the scene anew."""
    seed = given.get("seed")
    return await context.run(Operations.reset, None if seed is None else given.integer("seed"))


@_commands.changes
async def pause(context: CommandContext, given: Arguments) -> Any:
    """Hold time."""
    await context.run(Operations.pause)


@_commands.changes
async def resume(context: CommandContext, given: Arguments) -> Any:
    """Let time run on."""
    await context.run(Operations.resume)


@_commands.changes
async def step(context: CommandContext, given: Arguments) -> Any:
    """Advance by some steps."""
    count = given.integer("count")
    if count > MAX_STEPS_AT_ONCE:
        raise InvalidRequest("steps", count, f"at most {MAX_STEPS_AT_ONCE} at a time")
    return await context.run(Operations.step, count) * 1e-9


@_commands.changes
async def set_real_time_factor(context: CommandContext, given: Arguments) -> Any:
    """Change how fast time is to run."""
    await context.run(Operations.set_real_time_factor, given.number("factor"))


@_commands.changes
async def save_scene(context: CommandContext, given: Arguments) -> Any:
    """Write the world into the folder of one's own scenes; return the file's path."""
    return await context.run(
        Operations.save_scene,
        given.text("name"),
        overwrite=given.flag("overwrite"),
        title=given.optional_text("title"),
        keep_models=True,
    )


# -- walking ---------------------------------------------------------------------------------


@_commands.changes
async def set_controller(context: CommandContext, given: Arguments) -> Any:
    """Choose what drives a mover."""
    await context.run(
        Operations.set_mover_controller,
        given.choice("controller", CONTROLLERS),
        given.text("mover"),
    )


@_commands.changes
async def drive(context: CommandContext, given: Arguments) -> Any:
    """Have a mover walk for half a second."""
    await context.run(
        Operations.drive_mover,
        given.numbers("linear", 3),
        given.numbers("angular", 3),
        given.text("mover"),
    )


@_commands.changes
async def turn(context: CommandContext, given: Arguments) -> Any:
    """Turn a mover at once."""
    await context.run(
        Operations.turn_mover,
        math.radians(given.number("pitch_deg")),
        math.radians(given.number("yaw_deg")),
        given.text("mover"),
    )


@_commands.changes
async def lens(context: CommandContext, given: Arguments) -> Any:
    """Change what the debug agent sees, for all who watch it."""
    wanted = CameraIntrinsics(
        width=given.integer("width"),
        height=given.integer("height"),
        vertical_fov_deg=given.number("fov_deg"),
    )
    if wanted.width * wanted.height > 1920 * 1080:
        raise InvalidRequest("size of the picture", (wanted.width, wanted.height), "less pixels")
    await asyncio.to_thread(context.debug_agent.set_intrinsics, wanted)


@_commands.changes
async def add_waypoint(context: CommandContext, given: Arguments) -> Any:
    """Let a mover's track lead on to where the mover is now."""
    mover = given.text("mover")
    here = await context.run(Operations.get_mover_pose, mover)
    await context.run(Operations.set_waypoints, [here], mover=mover, append=True)
    return pose_to_json(here)


@_commands.changes
async def set_waypoints(context: CommandContext, given: Arguments) -> Any:
    """Replace a mover's track."""
    poses = [Arguments(entry, "waypoint") for entry in given.entries("waypoints")]
    await context.run(
        Operations.set_waypoints,
        [_pose(pose) for pose in poses],
        mover=given.text("mover"),
        total_time_s=given.number("total_time_s"),
        loop=given.flag("loop"),
    )


# -- objects ---------------------------------------------------------------------------------


@_commands.changes
@edits_object("adding")
async def spawn(context: CommandContext, given: Arguments) -> Any:
    """Put an object where a pixel is seen, its front towards the camera; tell what it is."""
    frame = context.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    yaw_deg = frame.camera.pose.rpy_deg[2] + 180.0
    asset = given.text("asset")
    number = await context.run(
        Operations.spawn_object,
        asset,
        pose=Pose.from_rpy_deg(point, (0.0, 0.0, yaw_deg)),
        remove_dynamics=False,
    )
    return await _set_down(context, number, point)


@_commands.changes
@edits_object("placing")
async def place(context: CommandContext, given: Arguments) -> Any:
    """Move an object to where a pixel is seen."""
    frame = context.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    return await _set_down(context, given.integer("object"), point)


@_commands.changes
@edits_object("moving")
async def move(context: CommandContext, given: Arguments) -> Any:
    """Move an object."""
    pose = _pose(given)
    number = given.integer("object")
    await context.run(Operations.move_object, number, pose=pose, teleport=True)
    return object_to_json(await context.run(Operations.get_object, number))


@_commands.changes
@edits_object("changing")
async def change(context: CommandContext, given: Arguments) -> Any:
    """Change an object's name, category or scale."""
    number, changes = given.integer("object"), given.mapping("changes")
    for key in changes:
        if key not in OBJECT_KEYS:
            raise InvalidRequest("change of an object", key, f"one of: {', '.join(OBJECT_KEYS)}")
    await context.run(Operations.change_object, number, **changes)
    return object_to_json(await context.run(Operations.get_object, number))


@_commands.changes
@edits_object("deleting")
async def despawn(context: CommandContext, given: Arguments) -> Any:
    """Take an object out of the scene."""
    await context.run(Operations.despawn_object, given.integer("object"))


@_commands.changes
@edits_object("the behaviour of")
async def attach(context: CommandContext, given: Arguments) -> Any:
    """Let an object move of itself in one more way."""
    number = given.integer("object")
    await context.run(
        Operations.add_behaviour,
        number,
        {**given.mapping("parameters"), "type": given.text("behaviour")},
    )
    return object_to_json(await context.run(Operations.get_object, number))


@_commands.changes
@edits_object("stopping")
async def detach(context: CommandContext, given: Arguments) -> Any:
    """End everything that makes an object move of itself."""
    number = given.integer("object")
    await context.run(Operations.remove_behaviours, number)
    return object_to_json(await context.run(Operations.get_object, number))


# -- history ---------------------------------------------------------------------------------


@_commands.changes
async def undo(context: CommandContext, given: Arguments) -> Any:
    """Undo the last change of an object, the room or the light; tell which, and its id."""
    what, number = await context.history.undo(context)
    return {"what": what, "id": number}


@_commands.changes
async def redo(context: CommandContext, given: Arguments) -> Any:
    """Do again what was undone last; tell as `undo` does."""
    what, number = await context.history.redo(context)
    return {"what": what, "id": number}


def _pose(given: Arguments) -> Pose:
    return Pose.from_rpy_deg(given.numbers("position", 3), given.numbers("rpy_deg", 3))


async def _set_down(context: CommandContext, number: int, point: tuple[float, float, float]) -> Any:
    """Stand an object on what is seen at a point, whatever its origin is."""
    state = await context.run(Operations.get_object, number)
    x, y, z = point
    pose = Pose((x, y, z - state.bottom_m), state.pose.orientation_xyzw)
    held = await context.run(EditOperations.set_down, number, pose)
    return {**object_to_json(await context.run(Operations.get_object, number)), "held": held}
