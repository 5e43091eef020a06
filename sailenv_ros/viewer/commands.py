"""What a client may ask for besides frames: a table of names, each with who may and how it is done.

Arguments as JSON has them in, requests to a `Simulation` out. Types are checked here, meaning by
the simulation, whose sentences the page shows.
"""

from __future__ import annotations

import asyncio
import math
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Protocol

from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame import Frame
from sailenv_ros.geometry import Pose
from sailenv_ros.scene_info import SceneInfo
from sailenv_ros.viewer.arguments import Arguments
from sailenv_ros.viewer.debug_agent import DebugAgent
from sailenv_ros.viewer.picking import pixel_of, standing_point, values_at
from sailenv_ros.viewer.told import told_object, told_pose

__all__ = ["COMMANDS", "Command", "Desk"]

MAX_STEPS_AT_ONCE = 2400
"""Ten seconds of simulated time: nobody else is served meanwhile."""

OBJECT_KEYS = ("name", "category", "scale")


class Desk(Protocol):
    """What a command needs of the conversation that it came in."""

    debug_agent: DebugAgent

    @property
    def info(self) -> SceneInfo:
        """The scene as it was announced last."""

    def frame(self, number: object) -> Frame:
        """Give a frame that this client was sent lately; None means the last one."""

    def select(self, instance_id: int) -> None:
        """Have an instance's outline told; 0 for none."""

    async def ask(self, request: str, /, *args: Any, **kwargs: Any) -> Any:
        """Have the simulation do something; wait for its result."""


Run = Callable[[Desk, Arguments], Awaitable[Any]]


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """One command.

    Attributes
    ----------
    run : callable
        Gives what is answered, in plain values for JSON.
    changes : bool
        True if it changes anything: those who only watch may not.
    """

    run: Run
    changes: bool


_commands: dict[str, Command] = {}

COMMANDS: Mapping[str, Command] = MappingProxyType(_commands)
"""Every command by its name."""


def _looks(run: Run) -> Run:
    _commands[run.__name__] = Command(run=run, changes=False)
    return run


def _changes(run: Run) -> Run:
    _commands[run.__name__] = Command(run=run, changes=True)
    return run


# -- looking ---------------------------------------------------------------------------------


@_looks
async def probe(desk: Desk, given: Arguments) -> Any:
    """Tell the values at a pixel of a frame."""
    frame = desk.frame(given.get("frame"))
    return values_at(frame, desk.info, *pixel_of(frame, given.get("u"), given.get("v")))


@_looks
async def get_object(desk: Desk, given: Arguments) -> Any:
    """Tell what and where an object is."""
    return told_object(await desk.ask("get_object", given.integer("object")))


@_looks
async def select(desk: Desk, given: Arguments) -> Any:
    """Have an object's outline told with each frame; 0 for none."""
    desk.select(given.integer("object"))


@_looks
async def scene_text(desk: Desk, given: Arguments) -> Any:
    """Give the present world as the text of a scene file."""
    return await desk.ask("scene_text", title=given.optional_text("title"))


# -- scene and time --------------------------------------------------------------------------


@_changes
async def change_scene(desk: Desk, given: Arguments) -> Any:
    """Begin another scene; of those in the list alone, for a path would be read."""
    name = given.text("scene")
    if name not in desk.info.scenes:
        raise InvalidRequest("scene", name, f"one of: {', '.join(desk.info.scenes)}")
    await desk.ask("change_scene", name)


@_changes
async def reset(desk: Desk, given: Arguments) -> Any:
    """Begin the scene anew."""
    seed = given.get("seed")
    return await desk.ask("reset", None if seed is None else given.integer("seed"))


@_changes
async def pause(desk: Desk, given: Arguments) -> Any:
    """Hold time."""
    await desk.ask("pause")


@_changes
async def resume(desk: Desk, given: Arguments) -> Any:
    """Let time run on."""
    await desk.ask("resume")


@_changes
async def step(desk: Desk, given: Arguments) -> Any:
    """Advance by some steps."""
    count = given.integer("count")
    if count > MAX_STEPS_AT_ONCE:
        raise InvalidRequest("steps", count, f"at most {MAX_STEPS_AT_ONCE} at a time")
    return await desk.ask("step", count) * 1e-9


@_changes
async def set_real_time_factor(desk: Desk, given: Arguments) -> Any:
    """Change how fast time is to run."""
    await desk.ask("set_real_time_factor", given.number("factor"))


@_changes
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


@_changes
async def set_controller(desk: Desk, given: Arguments) -> Any:
    """Choose what drives a mover."""
    await desk.ask("set_mover_controller", given.text("mover"), given.text("controller"))


@_changes
async def drive(desk: Desk, given: Arguments) -> Any:
    """Have a mover walk for half a second."""
    await desk.ask(
        "drive_mover",
        given.text("mover"),
        linear_m_s=given.numbers("linear", 3),
        angular_rad_s=given.numbers("angular", 3),
    )


@_changes
async def turn(desk: Desk, given: Arguments) -> Any:
    """Turn a mover at once."""
    await desk.ask(
        "turn_mover",
        given.text("mover"),
        pitch_rad=math.radians(given.number("pitch_deg")),
        yaw_rad=math.radians(given.number("yaw_deg")),
    )


@_changes
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


@_changes
async def add_waypoint(desk: Desk, given: Arguments) -> Any:
    """Let a mover's track lead on to where the mover is now."""
    mover = given.text("mover")
    here = await desk.ask("mover_pose", mover)
    await desk.ask("set_waypoints", [here], mover=mover, append=True)
    return told_pose(here)


@_changes
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


@_changes
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


@_changes
async def place(desk: Desk, given: Arguments) -> Any:
    """Move an object to where a pixel is seen."""
    frame = desk.frame(given.get("frame"))
    point = standing_point(frame, *pixel_of(frame, given.get("u"), given.get("v")))
    return await _set_down(desk, given.integer("object"), point)


@_changes
async def move(desk: Desk, given: Arguments) -> Any:
    """Move an object."""
    pose = _pose(given)
    number = given.integer("object")
    await desk.ask("move_object", number, pose, teleport=True)
    return told_object(await desk.ask("get_object", number))


@_changes
async def change(desk: Desk, given: Arguments) -> Any:
    """Change an object's name, category or scale."""
    number, changes = given.integer("object"), given.mapping("changes")
    for key in changes:
        if key not in OBJECT_KEYS:
            raise InvalidRequest("change of an object", key, f"one of: {', '.join(OBJECT_KEYS)}")
    await desk.ask("change_object", number, **changes)
    return told_object(await desk.ask("get_object", number))


@_changes
async def despawn(desk: Desk, given: Arguments) -> Any:
    """Take an object out of the scene."""
    await desk.ask("despawn_object", given.integer("object"))


@_changes
async def attach(desk: Desk, given: Arguments) -> Any:
    """Let an object move of itself in one more way."""
    number = given.integer("object")
    await desk.ask("attach_behaviour", number, given.text("behaviour"), given.mapping("parameters"))
    return told_object(await desk.ask("get_object", number))


@_changes
async def detach(desk: Desk, given: Arguments) -> Any:
    """End everything that makes an object move of itself."""
    number = given.integer("object")
    await desk.ask("detach_behaviours", number)
    return told_object(await desk.ask("get_object", number))


# -- lights and sky --------------------------------------------------------------------------


@_changes
async def set_light(desk: Desk, given: Arguments) -> Any:
    """Change attributes of a light."""
    changes = given.mapping("changes")
    if "name" in changes:
        raise InvalidRequest("change of a light", "name", "another attribute")
    await desk.ask("set_light", given.text("light"), **changes)


@_changes
async def set_environment(desk: Desk, given: Arguments) -> Any:
    """Change the surroundings, by the keys of a scene file."""
    await desk.ask("set_environment", **given.mapping("changes"))


def _pose(given: Arguments) -> Pose:
    return Pose.from_rpy_deg(given.numbers("position", 3), given.numbers("rpy_deg", 3))


async def _set_down(desk: Desk, number: int, point: tuple[float, float, float]) -> Any:
    """Move an object so that it stands on a point, whatever its origin is."""
    state = await desk.ask("get_object", number)
    x, y, z = point
    pose = Pose((x, y, z - state.bottom_m), state.pose.orientation_xyzw)
    await desk.ask("move_object", number, pose, teleport=True)
    return told_object(await desk.ask("get_object", number))
