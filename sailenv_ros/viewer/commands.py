"""Every command of a page, by its name: the operations, and what only a page asks for.

A page points at pixels, sees outlines, undoes, and adds what it has no numbers for: here is what
makes operations of that. What is an operation already is in `operation_commands`.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from sailenv_ros.assets.pictures import MAX_PICTURE_BYTES
from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.joints import JointState
from sailenv_ros.viewer.command_context import Command, CommandContext, CommandTable
from sailenv_ros.viewer.object_overlay import overlay_of
from sailenv_ros.viewer.operation_commands import OPERATION_COMMANDS, call_operation
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from sailenv_ros.viewer.random_scenes import things_of_any_scene
from sailenv_ros.viewer.recorded_commands import edits_object, edits_surroundings
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.room_commands import ROOM_COMMANDS
from sailenv_ros.viewer.scene_json import object_to_json, pose_to_json

__all__ = ["COMMANDS"]

_commands = CommandTable({**OPERATION_COMMANDS, **ROOM_COMMANDS})

COMMANDS: Mapping[str, Command] = MappingProxyType(_commands)
"""Every command by its name."""

ENDLESS = {"hinge": math.pi, "slide": 1.0}
"""Range of a slider to both sides for a joint without limits [rad], [m]."""


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
async def select(context: CommandContext, given: Arguments) -> Any:
    """Have an object's outline told with each frame; 0 for none."""
    context.select(given.integer("obj"))


@_commands.looks
async def get_joint(context: CommandContext, given: Arguments) -> Any:
    """Return the joint of an object; nothing where it has none that moves."""
    number = given.integer("obj")
    joints = await context.run(Operations.get_joints)
    return next((_joint_to_json(joint) for joint in joints if joint.id == number), None)


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


# -- where somebody points, or looks from ----------------------------------------------------


@_commands.changes
@edits_object("adding")
async def spawn(context: CommandContext, given: Arguments) -> Any:
    """Put an object where a pixel is seen, its front towards the camera; tell what it is."""
    frame = context.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    yaw_deg = frame.camera.pose.rpy_deg[2] + 180.0
    number = await context.run(
        Operations.spawn_object,
        given.text("asset"),
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
    return await _set_down(context, given.integer("obj"), point)


@_commands.changes
@edits_surroundings("adding the light")
async def add_light(context: CommandContext, given: Arguments) -> Any:
    """Add a light where the watched camera is, shining where it looks."""
    camera = context.frame(None).camera.pose
    place = {
        "position_m": camera.position_m,
        "direction": tuple(float(x) for x in camera.matrix()[:3, 0]),
    }
    attributes = {**place, **given.mapping("attributes")}
    values = Arguments({**given.values, "attributes": attributes}, "message")
    await call_operation(context, Operations.add_light, values)


@_commands.changes
async def add_waypoint(context: CommandContext, given: Arguments) -> Any:
    """Let a mover's track lead on to where the mover is now."""
    mover = given.text("mover")
    here = await context.run(Operations.get_mover_pose, mover)
    await context.run(Operations.set_waypoints, [here], mover=mover, append=True)
    return pose_to_json(here)


# -- what is sent in pieces, drawn by chance, undone -----------------------------------------


@_commands.changes
async def send_picture(context: CommandContext, given: Arguments) -> Any:
    """Take a piece of a picture file; after the last one, return the name of the picture."""
    pieces = context.picture_pieces
    if given.flag("first"):
        pieces.clear()
    piece = given.data("data")
    if len(pieces) + len(piece) > MAX_PICTURE_BYTES:
        pieces.clear()
        accepted = f"at most {MAX_PICTURE_BYTES // 1_000_000} MB"
        raise InvalidRequest("size of the picture", len(piece), accepted)
    pieces += piece
    if not given.flag("last"):
        return None
    whole = bytes(pieces)
    pieces.clear()
    return await context.run(Operations.upload_picture, whole)


@_commands.changes
async def randomise(context: CommandContext, given: Arguments) -> Any:
    """Draw the next epoch, by what the scene draws or by what suits any scene; tell its index."""
    try:
        record = await context.run(Operations.randomise)
    except InvalidState:
        things = things_of_any_scene(context.info)
        record = await context.run(Operations.randomise, index=0, things=things)
    return record["index"]


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


async def _set_down(context: CommandContext, number: int, point: tuple[float, float, float]) -> Any:
    """Stand an object on what is seen at a point, whatever its origin is."""
    state = await context.run(Operations.get_object, number)
    x, y, z = point
    pose = Pose((x, y, z - state.bottom_m), state.pose.orientation_xyzw)
    held = await context.run(EditOperations.set_down, number, pose)
    return {**object_to_json(await context.run(Operations.get_object, number)), "held": held}


def _joint_to_json(joint: JointState) -> dict[str, Any]:
    reach = ENDLESS[joint.type]
    return {
        "type": joint.type,
        "position": joint.position,
        "low": joint.low if math.isfinite(joint.low) else joint.position - reach,
        "high": joint.high if math.isfinite(joint.high) else joint.position + reach,
    }
