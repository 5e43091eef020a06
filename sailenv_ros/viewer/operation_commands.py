"""Operations that a page may ask for: each is served by its declared signature, from one line.

A message's values have the names of the operation's parameters; those of ``**changes`` are an
object under that name, as in a ROS service. The operation checks them, so the page is told the
sentences that a program is told. Who offers an operation to pages adds its line here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.types.geometry import Pose
from sailenv_ros.viewer.command_context import Command, CommandContext, CommandTable, Run
from sailenv_ros.viewer.messages import ObjectValues
from sailenv_ros.viewer.recorded_commands import edits_object, edits_surroundings
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.scene_json import object_to_json, to_json

__all__ = ["OPERATION_COMMANDS", "call_operation"]

MAX_STEPS_AT_ONCE = 2400
"""Ten seconds of simulated time: nobody else is served meanwhile."""

OBJECT_KEYS = ("name", "category", "scale")
"""Changes of an object that a page may request; its material has a command of its own."""

Guard = Callable[[CommandContext, Arguments], None]
"""Raises where a page may not ask for what a program may."""


async def call_operation(
    context: CommandContext, operation: Operation[..., Any], given: Arguments
) -> Any:
    """Have the simulation do an operation with the values of a message; return its result."""
    args, kwargs = operation.arguments(_decoded(operation, given.values))
    return await context.run(operation, *args, **kwargs)


def _decoded(operation: Operation[..., Any], values: Mapping[str, Any]) -> dict[str, Any]:
    """Turn values into the types that the parameters are declared with, where JSON has no such."""
    decoded = dict(values)
    for parameter in operation.signature.parameters.values():
        decode = _DECODERS.get(str(parameter.annotation).removesuffix(" | None"))
        if decode is not None and decoded.get(parameter.name) is not None:
            decoded[parameter.name] = decode(parameter.name, decoded[parameter.name])
    return decoded


def _pose(what: str, value: object) -> Pose:
    given = Arguments(value, what)
    return Pose.from_rpy_deg(given.get("position"), given.get("rotation"))


_DECODERS: Mapping[str, Callable[[str, Any], Any]] = {"Pose": _pose}
"""By the declared type of a parameter; what is not here is in JSON as in Python."""


# -- the table ---------------------------------------------------------------------------------


def _known_scene(context: CommandContext, given: Arguments) -> None:
    """Refuse scenes that are not in the list, for a path would be read."""
    name, known = given.text("scene"), context.info.scenes
    if name not in known:
        raise UnknownName("scene", name, known)


def _few_steps(context: CommandContext, given: Arguments) -> None:
    count = given.integer("count")
    if count > MAX_STEPS_AT_ONCE:
        raise InvalidRequest("steps", count, f"at most {MAX_STEPS_AT_ONCE} at a time")


def _object_keys(context: CommandContext, given: Arguments) -> None:
    for key in given.mapping("changes"):
        if key not in OBJECT_KEYS:
            raise UnknownName("change of an object", key, OBJECT_KEYS)


_GUARDS: Mapping[str, Guard] = {
    "change_scene": _known_scene,
    "step": _few_steps,
    "change_object": _object_keys,
}
"""By the names of operations of which a page may ask for less than a program."""

_LOOKS: tuple[Operation[..., Any], ...] = (Operations.get_object, Operations.scene_text)

_CHANGES: tuple[Operation[..., Any], ...] = (
    # scene and time
    Operations.change_scene,
    Operations.reset,
    Operations.pause,
    Operations.resume,
    Operations.step,
    Operations.set_real_time_factor,
    Operations.save_scene,
    Operations.start_lessons,
    Operations.stop_lessons,
    # movers and agents
    Operations.set_mover_controller,
    Operations.drive_mover,
    Operations.turn_mover,
    Operations.set_waypoints,
    Operations.set_look_at,
    Operations.set_picture,
)

_OF_OBJECTS: Mapping[str, Operation[..., Any]] = {
    "moving": Operations.move_object,
    "changing": Operations.change_object,
    "deleting": Operations.despawn_object,
    "the behaviour of": Operations.add_behaviour,
    "stopping": Operations.remove_behaviours,
    "opening": Operations.set_joint_position,
    "the material of": Operations.set_material,
}
"""Operations on one object that can be undone, by what the history says of them."""

_OF_SURROUNDINGS: Mapping[str, Operation[..., Any]] = {
    "changing the light": Operations.set_light,
    "deleting the light": Operations.remove_light,
    "changing the surroundings": Operations.set_environment,
}
"""The same for lights and surroundings."""


def _plain(operation: Operation[..., Any]) -> Run:
    guard = _GUARDS.get(operation.name)

    async def run(context: CommandContext, given: Arguments) -> Any:
        if guard is not None:
            guard(context, given)
        return to_json(await call_operation(context, operation, given))

    return run


def _of_object(words: str, operation: Operation[..., Any]) -> Run:
    """Serve an operation on an object that can be undone; the answer is what the object is then."""
    run = _plain(operation)

    @edits_object(words)
    async def tell(context: CommandContext, given: Arguments) -> Any:
        await run(context, given)
        if operation.name == "despawn_object":
            return None
        return object_to_json(await context.run(Operations.get_object, given.get("obj")))

    return tell


OPERATION_COMMANDS = CommandTable(
    {
        **{e.name: Command(run=_plain(e), changes=False, is_operation=True) for e in _LOOKS},
        **{e.name: Command(run=_plain(e), changes=True, is_operation=True) for e in _CHANGES},
        **{
            each.name: Command(
                run=_of_object(words, each),
                changes=True,
                is_operation=True,
                answer=None if each.name == "despawn_object" else ObjectValues,
            )
            for words, each in _OF_OBJECTS.items()
        },
        **{
            each.name: Command(
                run=edits_surroundings(words)(_plain(each)), changes=True, is_operation=True
            )
            for words, each in _OF_SURROUNDINGS.items()
        },
    }
)
"""Commands that are operations, by their names."""
