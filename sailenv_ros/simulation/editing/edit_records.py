"""Records of objects and surroundings by which an editor undoes a change.

Objects and lights are known by their names, which last; an object that comes back has another id.
Knows no operation; those of a history of changes are in `operations.edits`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sailenv_ros.errors import InvalidEntry, UnknownName
from sailenv_ros.scene.spec import EnvironmentSpec
from sailenv_ros.simulation.editing.editor import SceneEditor, entry_without_place
from sailenv_ros.simulation.editing.material_edits import set_surface, surface_keys
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.support import overlap_m, standing_place
from sailenv_ros.world.world import World

__all__ = [
    "ObjectRecord",
    "SurroundingsRecord",
    "bring_back",
    "change_back",
    "record_of",
    "restore_surroundings",
    "set_down",
    "surroundings_of",
]

PUSHED_M = 0.004
"""Deeper within another's hull, physics would push an object away rather than settle it [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ObjectRecord:
    """An object as it was at an instant.

    Attributes
    ----------
    name : str
    entry : mapping or None
        What a scene file would say of it, but for its place and its behaviours; None for a part
        of the room, which the scene's own file describes.
    pose : Pose
    behaviours : tuple of mapping
        Each with its ``type`` and all its parameters.
    surface : mapping or None
        What a scene file says of the look of a part of the room; None if it can say nothing.
    joint_position : float or None
        Of its joint [rad] or [m]; None where it has none that moves. `pose` is where the object is
        while that is 0, as in a scene file.
    """

    name: str
    entry: Mapping[str, Any] | None
    pose: Pose
    behaviours: tuple[Mapping[str, Any], ...]
    surface: Mapping[str, Any] | None = None
    joint_position: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SurroundingsRecord:
    """Lights and surroundings as they were at an instant.

    Attributes
    ----------
    lights : tuple of Light
    environment : Environment
    described : EnvironmentSpec
        What a scene file would say of the environment.
    """

    lights: tuple[Light, ...]
    environment: Environment
    described: EnvironmentSpec


def record_of(world: World, number: int) -> ObjectRecord:
    """Take down the object of an instance id as it is now."""
    state, spec = world.object_state(number), world.body(number).placement.entry
    entry, pose = None, state.pose
    joint = world.joint(number)
    body = world.body(number)
    if isinstance(body, JointedBody):
        pose = body.joint.parent_from_rest
    if spec is not None:
        entry = {
            **entry_without_place(spec),
            "name": state.name,
            "category": state.category,
            "scale": state.scale,
            "static": state.static,
        }
    return ObjectRecord(
        name=state.name,
        entry=entry,
        pose=pose,
        behaviours=state.behaviours,
        surface=surface_keys(world, number) if spec is None else None,
        joint_position=None if joint is None else joint.position,
    )


def change_back(editor: SceneEditor, present: ObjectRecord, wanted: ObjectRecord) -> int:
    """Make of an object that is there what a record says; return its instance id.

    Raises
    ------
    UnknownName, NameTaken, InvalidEntry
        If others have changed it so that it cannot be done; nothing is done then.
    """
    world = editor.scene.world
    number = world.find(present.name)
    if wanted.entry is not None and present.entry is not None:
        keys = {*wanted.entry, *present.entry} - {"asset"}
        changes = {
            key: wanted.entry.get(key)
            for key in keys
            if wanted.entry.get(key) != present.entry.get(key)
        }
        if changes:
            editor.change_object(number, changes)
    if wanted.surface is not None and wanted.surface != present.surface:
        set_surface(editor.scene, number, wanted.surface)
    if wanted.behaviours != present.behaviours:
        world.body(number).detach()
        for behaviour in wanted.behaviours:
            editor.add_behaviour(number, behaviour)
        editor.scene.announce()
    if wanted.joint_position is not None and wanted.joint_position != present.joint_position:
        world.set_joint(number, wanted.joint_position)
    if wanted.pose != present.pose:
        world.put_body(number, wanted.pose, teleport=True)
    return number


def bring_back(editor: SceneEditor, wanted: ObjectRecord) -> int:
    """Spawn what a record says; return its instance id, and see `change_back` for errors."""
    if wanted.entry is None:
        why = [(repr(wanted.name), "is a part of the room: begin the scene anew to have it back")]
        raise InvalidEntry("object", wanted.name, why)
    entry = {**wanted.entry, "behaviours": wanted.behaviours}
    known = editor.scene.library.knowledge.assets
    if entry["asset"] not in known:
        raise UnknownName("asset", entry["asset"], known)
    number = editor.spawn(entry, wanted.pose)
    if wanted.joint_position is not None:
        editor.scene.world.set_joint(number, wanted.joint_position)
    return number


def set_down(editor: SceneEditor, number: int, pose: Pose) -> bool:
    """Stand an object on what is drawn there; tell if it is held there."""
    world = editor.scene.world
    x, y, _ = pose.position_m
    height, carrier = standing_place(world, number, pose)
    world.put_body(number, Pose((x, y, height), pose.orientation_xyzw), teleport=True)
    body = world.body(number)
    held = (
        not body.placement.static
        and body.placement.entry is not None
        and not body.behaviours
        and carrier is not None
        and overlap_m(world, body, carrier) > PUSHED_M
    )
    if held:
        editor.change_object(number, {"static": True})
    return held


def surroundings_of(world: World) -> SurroundingsRecord:
    """Take down lights and surroundings as they are now."""
    contents, described = world.contents, world.described
    assert described is not None
    return SurroundingsRecord(
        lights=contents.lights,
        environment=contents.environment,
        described=described.environment,
    )


def restore_surroundings(
    scene: LiveScene, present: SurroundingsRecord, wanted: SurroundingsRecord
) -> None:
    """Put back what differs between two records, and nothing else."""
    world = scene.world
    before = {light.name: light for light in present.lights}
    after = {light.name: light for light in wanted.lights}
    changed = {name for name in {*before, *after} if before.get(name) != after.get(name)}
    kept = [after.get(light.name, light) if light.name in changed else light
            for light in world.contents.lights
            if light.name not in changed or light.name in after]  # fmt: skip
    there = {light.name for light in kept}
    lights = [*kept, *(after[name] for name in sorted(changed & after.keys() - there))]
    if changed:
        scene.library.check_lights(tuple(lights))
        world.set_lights(lights)
    if present.environment != wanted.environment:
        assert world.described is not None
        world.set_environment(wanted.environment)
        update = {"environment": wanted.described}
        world.described = world.described.model_copy(update=update)
    scene.announce()
