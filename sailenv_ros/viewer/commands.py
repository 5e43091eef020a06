"""Every command of a page, by its name: the operations, and what only a page asks for.

A page points at pixels, sees outlines, undoes, and adds what it has no numbers for: here is what
makes operations of that. What is an operation already is in `operation_commands`.
"""

from __future__ import annotations

import asyncio
from collections.abc import Mapping
from functools import partial
from itertools import count
from types import MappingProxyType

from sailenv_ros.assets.pictures import MAX_PICTURE_BYTES
from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import LightAttributes, LightType
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.viewer.capture_commands import CAPTURE_COMMANDS
from sailenv_ros.viewer.command_context import Command, CommandContext, CommandTable
from sailenv_ros.viewer.frame_overlay import overlay_of
from sailenv_ros.viewer.messages import (
    JointValues,
    Overlay,
    PixelValues,
    PlacedObject,
    UndoneStep,
)
from sailenv_ros.viewer.operation_commands import OPERATION_COMMANDS, call_operation
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from sailenv_ros.viewer.random_scenes import things_of_any_scene
from sailenv_ros.viewer.recorded_commands import edits_object, edits_surroundings
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.robot_commands import ROBOT_COMMANDS
from sailenv_ros.viewer.room_commands import ROOM_COMMANDS
from sailenv_ros.viewer.scene_json import object_to_json, pose_to_json
from sailenv_ros.viewer.scene_messages import PoseValues, Vector3
from sailenv_ros.viewer.selected_object import joint_of
from sailenv_ros.viewer.served_commands import served

__all__ = ["COMMANDS"]

_commands = CommandTable(
    {**OPERATION_COMMANDS, **ROOM_COMMANDS, **ROBOT_COMMANDS, **CAPTURE_COMMANDS}
)

COMMANDS: Mapping[str, Command] = MappingProxyType(_commands)
"""Every command by its name."""


# -- looking ---------------------------------------------------------------------------------


@_commands.looks
@served
async def probe(context: CommandContext, u: int, v: int, frame: int | None = None) -> PixelValues:
    """Return the values at a pixel of a frame; of the last one if none is named."""
    seen = context.frame(frame)
    return values_at(seen, context.info, *pixel_of(seen, u, v))


@_commands.looks
@served
async def overlay(
    context: CommandContext,
    whole: int = 0,
    boxes: bool = False,
    space: bool = False,
    circle: bool = False,
    people: bool = False,
    track: str = "",
    frame: int | None = None,
) -> Overlay:
    """Return what is drawn over a frame, with the track of a mover if one is named."""
    seen = context.frame(frame)
    movers = {mover.name: mover for mover in context.info.movers}
    if track and track not in movers:
        raise UnknownName("mover", track[:80], movers)
    wanted = partial(
        overlay_of, boxes=boxes, space=space, whole=whole, circle=circle, people=people
    )
    if track:
        mover = movers[track]
        wanted = partial(wanted, track=mover.waypoints, loop=mover.loop)
    # Drawing an object alone waits for the simulation.
    return await asyncio.to_thread(wanted, seen)


@_commands.looks
@served
async def select(context: CommandContext, obj: int) -> None:
    """Have an object's outline told with each frame, and its state at changes; 0 for none."""
    context.select(obj)


@_commands.looks
@served
async def get_joint(context: CommandContext, obj: int) -> JointValues | None:
    """Return the joint of an object; nothing where it has none that moves."""
    return await joint_of(context, obj)


@_commands.changes
@served
async def lens(context: CommandContext, width: int, height: int, fov_deg: float) -> None:
    """Change what the debug agent sees, for all who watch it."""
    wanted = CameraIntrinsics(width=width, height=height, vertical_fov_deg=fov_deg)
    if wanted.width * wanted.height > 1920 * 1080:
        raise InvalidRequest("size of the picture", (wanted.width, wanted.height), "less pixels")
    await asyncio.to_thread(context.debug_agent.set_intrinsics, wanted)


# -- where somebody points, or looks from ----------------------------------------------------


@_commands.changes
@edits_object("adding")
@served
async def spawn(
    context: CommandContext, asset: str, u: int, v: int, frame: int | None = None
) -> PlacedObject:
    """Put an object where a pixel is seen, its front towards the camera; tell what it is."""
    seen = context.frame(frame)
    point = standing_point(seen, *pixel_of(seen, u, v))
    yaw_deg = seen.camera.pose.rpy_deg[2] + 180.0
    number = await context.run(
        Operations.spawn_object,
        asset,
        pose=Pose.from_rpy_deg(point, (0.0, 0.0, yaw_deg)),
        remove_dynamics=False,
    )
    return await _set_down(context, number, point)


@_commands.changes
@edits_object("placing")
@served
async def place(
    context: CommandContext, obj: int, u: int, v: int, frame: int | None = None
) -> PlacedObject:
    """Move an object to where a pixel is seen."""
    seen = context.frame(frame)
    point = standing_point(seen, *pixel_of(seen, u, v))
    return await _set_down(context, obj, point)


@_commands.changes
@edits_surroundings("adding the light")
@served
async def add_light(
    context: CommandContext,
    light_type: LightType,
    light_name: str | None = None,
    attributes: LightAttributes | None = None,
) -> str:
    """Add a light where the watched camera is, shining where it looks; tell its name.

    Without a name it gets its type and a number: here, since here lights are added in turn.
    """
    camera = context.frame(None).camera.pose
    place = {
        "position_m": camera.position_m,
        "direction": tuple(float(x) for x in camera.matrix()[:3, 0]),
    }
    name = _free_name(light_type, context.info) if light_name is None else light_name
    values = {
        "light_name": name,
        "light_type": light_type,
        "attributes": {**place, **(attributes or {})},
    }
    await call_operation(context, Operations.add_light, Arguments(values, "message"))
    return name


@_commands.changes
@served
async def add_waypoint(context: CommandContext, mover: str) -> PoseValues:
    """Let a mover's track lead on to where the mover is now."""
    here = await context.run(Operations.get_mover_pose, mover)
    await context.run(Operations.set_waypoints, [here], mover=mover, append=True)
    return pose_to_json(here)


# -- what is sent in pieces, drawn by chance, undone -----------------------------------------


@_commands.changes
@served
async def send_picture(
    context: CommandContext, data: bytes, first: bool = False, last: bool = False
) -> str | None:
    """Take a piece of a picture file; after the last one, return the name of the picture."""
    pieces = context.picture_pieces
    if first:
        pieces.clear()
    if len(pieces) + len(data) > MAX_PICTURE_BYTES:
        pieces.clear()
        accepted = f"at most {MAX_PICTURE_BYTES // 1_000_000} MB"
        raise InvalidRequest("size of the picture", len(data), accepted)
    pieces += data
    if not last:
        return None
    whole = bytes(pieces)
    pieces.clear()
    return await context.run(Operations.upload_picture, whole)


@_commands.changes
@served
async def randomise(context: CommandContext) -> int:
    """Draw the next epoch, by what the scene draws or by what suits any scene; tell its index."""
    try:
        record = await context.run(Operations.randomise)
    except InvalidState:
        things = things_of_any_scene(context.info)
        record = await context.run(Operations.randomise, index=0, things=things)
    return int(record["index"])


@_commands.changes
@served
async def undo(context: CommandContext) -> UndoneStep:
    """Undo the last change of an object, the room or the light; tell which, and its id."""
    what, number = await context.history.undo(context)
    return {"what": what, "id": number}


@_commands.changes
@served
async def redo(context: CommandContext) -> UndoneStep:
    """Do again what was undone last; tell as `undo` does."""
    what, number = await context.history.redo(context)
    return {"what": what, "id": number}


def _free_name(light_type: LightType, info: SceneInfo) -> str:
    taken = {light.name for light in info.lights}
    return next(name for n in count(1) if (name := f"{light_type} {n}") not in taken)


async def _set_down(context: CommandContext, number: int, point: Vector3) -> PlacedObject:
    """Stand an object on what is seen at a point, whatever its origin is."""
    state = await context.run(Operations.get_object, number)
    x, y, z = point
    pose = Pose((x, y, z - state.bottom_m), state.pose.orientation_xyzw)
    held = await context.run(EditOperations.set_down, number, pose)
    return {**object_to_json(await context.run(Operations.get_object, number)), "held": held}
