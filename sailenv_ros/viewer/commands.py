"""What a client may ask for besides frames: a table of names, each with who may and how it is done.

Arguments as JSON has them in, requests to a `Simulation` out. Types are checked here, meaning by
the simulation, whose sentences the page shows.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.geometry import Pose
from sailenv_ros.viewer.arguments import Arguments
from sailenv_ros.viewer.desk import Command, CommandTable, Desk
from sailenv_ros.viewer.light_commands import LIGHT_COMMANDS
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from sailenv_ros.viewer.told import told_object, told_pose

__all__ = ["COMMANDS"]

MAX_STEPS_AT_ONCE = 2400
"""Ten seconds of simulated time: nobody else is served meanwhile."""

_commands = CommandTable(LIGHT_COMMANDS)

COMMANDS: Mapping[str, Command] = MappingProxyType(_commands)
"""Every command by its name."""

OBJECT_KEYS = ("name", "category", "scale")


# -- looking ---------------------------------------------------------------------------------


@_commands.looks
async def probe(desk: Desk, given: Arguments) -> Any:
    """Tell the values at a pixel of a frame."""
    frame = desk.frame(given.get("frame"))
    return values_at(frame, desk.info, *pixel_of(frame, given.get("u"), given.get("v")))


@_commands.looks
async def get_object(desk: Desk, given: Arguments) -> Any:
    """Tell what and where an object is."""
    return told_object(await desk.ask("get_object", given.integer("object")))


@_commands.looks
async def select(desk: Desk, given: Arguments) -> Any:
    """Have an object's outline told with each frame; 0 for none."""
    desk.select(given.integer("object"))


@_commands.looks
async def scene_text(desk: Desk, given: Arguments) -> Any:
    """Give the present world as the text of a scene file."""
    return await desk.ask("scene_text", title=given.optional_text("title"))


# -- scene and time --------------------------------------------------------------------------


@_commands.changes
async def change_scene(desk: Desk, given: Arguments) -> Any:
    """Begin another scene; of those in the list alone, for a path would be read."""
    name = given.text("scene")
    if name not in desk.info.scenes:
        raise InvalidRequest("scene", name, f"one of: {', '.join(desk.info.scenes)}")
    await desk.ask("change_scene", name)


@_commands.changes
async def reset(desk: Desk, given: Arguments) -> Any:
    """Begin the scene anew."""
    seed = given.get("seed")
    return await desk.ask("reset", None if seed is None else given.integer("seed"))


@_commands.changes
async def pause(desk: Desk, given: Arguments) -> Any:
    """Hold time."""
    await desk.ask("pause")


@_commands.changes
async def resume(desk: Desk, given: Arguments) -> Any:
    """Let time run on."""
    await desk.ask("resume")


@_commands.changes
async def step(desk: Desk, given: Arguments) -> Any:
    """Advance by some steps."""
    count = given.integer("count")
    if count > MAX_STEPS_AT_ONCE:
        raise InvalidRequest("steps", count, f"at most {MAX_STEPS_AT_ONCE} at a time")
    return await desk.ask("step", count) * 1e-9


@_commands.changes
async def set_real_time_factor(desk: Desk, given: Arguments) -> Any:
    """Change how fast time is to run."""
    await desk.ask("set_real_time_factor", given.number("factor"))


@_commands.changes
async def save_scene(desk: Desk, given: Arguments) -> Any:
    """Write the world into the folder of one's own scenes; give the file's path."""
    return await desk.ask(
        "save_scene",
        given.text("name"),
        overwrite=given.flag("overwrite"),
        title=given.optional_text("title"),
        keep_models=True,
    )


# -- walking ---------------------------------------------------------------------------------


@_commands.changes
async def set_controller(desk: Desk, given: Arguments) -> Any:
    """Choose what drives a mover."""
    await desk.ask("set_mover_controller", given.text("mover"), given.text("controller"))


@_commands.changes
async def drive(desk: Desk, given: Arguments) -> Any:
    """Have a mover walk for half a second."""
    await desk.ask(
        "drive_mover",
        given.text("mover"),
        linear_m_s=given.numbers("linear", 3),
        angular_rad_s=given.numbers("angular", 3),
    )


@_commands.changes
async def turn(desk: Desk, given: Arguments) -> Any:
    """Turn a mover at once."""
    await desk.ask(
        "turn_mover",
        given.text("mover"),
        pitch_rad=math.radians(given.number("pitch_deg")),
        yaw_rad=math.radians(given.number("yaw_deg")),
    )


@_commands.changes
async def lens(desk: Desk, given: Arguments) -> Any:
    """Change what the debug agent sees, for all who watch it."""
    wanted = CameraIntrinsics(
        width=given.integer("width"),
        height=given.integer("height"),
        vertical_fov_deg=given.number("fov_deg"),
    )
    if wanted.width * wanted.height > 1920 * 1080:
        raise InvalidRequest("size of the picture", (wanted.width, wanted.height), "less pixels")
    await asyncio.to_thread(desk.debug_agent.set_intrinsics, wanted)


@_commands.changes
async def add_waypoint(desk: Desk, given: Arguments) -> Any:
    """Let a mover's track lead on to where the mover is now."""
    mover = given.text("mover")
    here = await desk.ask("mover_pose", mover)
    await desk.ask("set_waypoints", [here], mover=mover, append=True)
    return told_pose(here)


@_commands.changes
async def set_waypoints(desk: Desk, given: Arguments) -> Any:
    """Give a mover another track."""
    poses = [Arguments(entry, "waypoint") for entry in given.entries("waypoints")]
    await desk.ask(
        "set_waypoints",
        [_pose(pose) for pose in poses],
        mover=given.text("mover"),
        total_time_s=given.number("total_time_s"),
        loop=given.flag("loop"),
    )


# -- objects ---------------------------------------------------------------------------------


@_commands.changes
async def spawn(desk: Desk, given: Arguments) -> Any:
    """Put an object where a pixel is seen, its front towards the camera; tell what it is."""
    frame = desk.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    yaw_deg = frame.camera.pose.rpy_deg[2] + 180.0
    asset = given.text("asset")
    number = await desk.ask(
        "spawn_object", asset, pose=Pose.from_rpy_deg(point, (0.0, 0.0, yaw_deg))
    )
    return await _set_down(desk, number, point)


@_commands.changes
async def place(desk: Desk, given: Arguments) -> Any:
    """Move an object to where a pixel is seen."""
    frame = desk.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    return await _set_down(desk, given.integer("object"), point)


@_commands.changes
async def move(desk: Desk, given: Arguments) -> Any:
    """Move an object."""
    pose = _pose(given)
    number = given.integer("object")
    await desk.ask("move_object", number, pose, teleport=True)
    return told_object(await desk.ask("get_object", number))


@_commands.changes
async def change(desk: Desk, given: Arguments) -> Any:
    """Change an object's name, category or scale."""
    number, changes = given.integer("object"), given.mapping("changes")
    for key in changes:
        if key not in OBJECT_KEYS:
            raise InvalidRequest("change of an object", key, f"one of: {', '.join(OBJECT_KEYS)}")
    await desk.ask("change_object", number, **changes)
    return told_object(await desk.ask("get_object", number))


@_commands.changes
async def despawn(desk: Desk, given: Arguments) -> Any:
    """Take an object out of the scene."""
    await desk.ask("despawn_object", given.integer("object"))


@_commands.changes
async def attach(desk: Desk, given: Arguments) -> Any:
    """Let an object move of itself in one more way."""
    number = given.integer("object")
    await desk.ask("attach_behaviour", number, given.text("behaviour"), given.mapping("parameters"))
    return told_object(await desk.ask("get_object", number))


@_commands.changes
async def detach(desk: Desk, given: Arguments) -> Any:
    """End everything that makes an object move of itself."""
    number = given.integer("object")
    await desk.ask("detach_behaviours", number)
    return told_object(await desk.ask("get_object", number))


def _pose(given: Arguments) -> Pose:
    return Pose.from_rpy_deg(given.numbers("position", 3), given.numbers("rpy_deg", 3))


async def _set_down(desk: Desk, number: int, point: tuple[float, float, float]) -> Any:
    """Move an object so that it stands on a point, whatever its origin is."""
    state = await desk.ask("get_object", number)
    x, y, z = point
    pose = Pose((x, y, z - state.bottom_m), state.pose.orientation_xyzw)
    await desk.ask("move_object", number, pose, teleport=True)
    return told_object(await desk.ask("get_object", number))
