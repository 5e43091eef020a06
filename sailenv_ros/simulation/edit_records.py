"""Records of objects and surroundings by which an editor undoes a change.

Objects and lights are known by their names, which last; an object that comes back has another id.
These operations belong to whoever keeps a history of changes, here the web viewer; a program has
the operations that make the changes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sailenv_ros.errors import InvalidEntry, UnknownName
from sailenv_ros.geometry import Pose
from sailenv_ros.lights import Environment, Light
from sailenv_ros.operations import argument_checks as check
from sailenv_ros.operations.operation import Caller, operation
from sailenv_ros.scene.spec import EnvironmentSpec
from sailenv_ros.simulation.material_edits import set_surface, surface_keys
from sailenv_ros.world.jointed_bodies import JointedBody
from sailenv_ros.world.support import overlap_m, standing_place

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = [
    "EditOperations",
    "ObjectRecord",
    "SurroundingsRecord",
    "bring_back",
    "record_of",
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


def record_of(core: SimulationCore, number: int) -> ObjectRecord:
    """Take down the object of an instance id as it is now."""
    state, spec = core.world.object_state(number), core.world.body(number).placement.entry
    entry, pose = None, state.pose
    joint = core.world.joint(number)
    body = core.world.body(number)
    if isinstance(body, JointedBody):
        pose = body.joint.parent_from_rest
    if spec is not None:
        entry = {
            **core.editor.entry_without_place(spec),
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
        surface=surface_keys(core, number) if spec is None else None,
        joint_position=None if joint is None else joint.position,
    )


class EditOperations(Caller):
    """Operations of a history of changes."""

    @operation(obj=check.object_reference)
    @staticmethod
    def object_record(core: SimulationCore, obj: int | str) -> ObjectRecord:
        """Take down an object as it is now."""
        return record_of(core, core.world.find(obj))

    @operation()
    @staticmethod
    def restore_object(
        core: SimulationCore, present: ObjectRecord | None, wanted: ObjectRecord | None
    ) -> int:
        """Make of an object what a record says; return its instance id, 0 for none.

        Parameters
        ----------
        present : ObjectRecord or None
            As it was after the change that is undone; None if it was taken out.
        wanted : ObjectRecord or None
            None takes it out.

        Raises
        ------
        UnknownName, NameTaken, InvalidEntry
            If others have changed it so that it cannot be done; nothing is done then.
        """
        if present is None:
            return 0 if wanted is None else bring_back(core, wanted)
        number = core.world.find(present.name)
        if wanted is None:
            core.world.despawn(number)
            core.announce()
            return 0
        if wanted.entry is not None and present.entry is not None:
            keys = {*wanted.entry, *present.entry} - {"asset"}
            changes = {
                key: wanted.entry.get(key)
                for key in keys
                if wanted.entry.get(key) != present.entry.get(key)
            }
            if changes:
                core.editor.change_object(number, changes)
        if wanted.surface is not None and wanted.surface != present.surface:
            set_surface(core, number, wanted.surface)
        if wanted.behaviours != present.behaviours:
            core.world.body(number).detach()
            for behaviour in wanted.behaviours:
                core.editor.add_behaviour(number, behaviour)
            core.announce()
        if wanted.joint_position is not None and wanted.joint_position != present.joint_position:
            core.world.set_joint(number, wanted.joint_position)
        if wanted.pose != present.pose:
            core.world.put_body(number, wanted.pose, teleport=True)
        return number

    @operation(obj=check.object_reference, pose=check.pose)
    @staticmethod
    def set_down(core: SimulationCore, obj: int | str, pose: Pose) -> bool:
        """Stand an object on what is drawn there; tell if it is held there.

        Parameters
        ----------
        obj : int or str
        pose : Pose
            Where its lowest point is on or just below what shall carry it.

        Returns
        -------
        held : bool
            True if it was made static: hulls are coarser than what is drawn, and physics would
            have pushed it out of that of its carrier, a shelf for example.
        """
        number = core.world.find(obj)
        x, y, _ = pose.position_m
        height, carrier = standing_place(core.world, number, pose)
        core.world.put_body(number, Pose((x, y, height), pose.orientation_xyzw), teleport=True)
        body = core.world.body(number)
        held = (
            not body.placement.static
            and body.placement.entry is not None
            and not body.behaviours
            and carrier is not None
            and overlap_m(core.world, body, carrier) > PUSHED_M
        )
        if held:
            core.editor.change_object(number, {"static": True})
        return held

    @operation()
    @staticmethod
    def surroundings_record(core: SimulationCore) -> SurroundingsRecord:
        """Take down lights and surroundings as they are now."""
        contents, described = core.world.contents, core.world.described
        assert described is not None
        return SurroundingsRecord(
            lights=contents.lights,
            environment=contents.environment,
            described=described.environment,
        )

    @operation()
    @staticmethod
    def restore_surroundings(
        core: SimulationCore, present: SurroundingsRecord, wanted: SurroundingsRecord
    ) -> None:
        """Put back what differs between two records, and nothing else."""
        world = core.world
        before = {light.name: light for light in present.lights}
        after = {light.name: light for light in wanted.lights}
        changed = {name for name in {*before, *after} if before.get(name) != after.get(name)}
        kept = [after.get(light.name, light) if light.name in changed else light
                for light in world.contents.lights
                if light.name not in changed or light.name in after]  # fmt: skip
        there = {light.name for light in kept}
        lights = [*kept, *(after[name] for name in sorted(changed & after.keys() - there))]
        if changed:
            core.library.check_lights(tuple(lights))
            world.set_lights(lights)
        if present.environment != wanted.environment:
            assert world.described is not None
            world.set_environment(wanted.environment)
            update = {"environment": wanted.described}
            world.described = world.described.model_copy(update=update)
        core.announce()


def bring_back(core: SimulationCore, wanted: ObjectRecord) -> int:
    """Spawn what a record says; return its instance id, and see `restore_object` for errors."""
    if wanted.entry is None:
        why = [(repr(wanted.name), "is a part of the room: begin the scene anew to have it back")]
        raise InvalidEntry("object", wanted.name, why)
    entry = {**wanted.entry, "behaviours": wanted.behaviours}
    if entry["asset"] not in core.library.spawnables:
        raise UnknownName("asset", entry["asset"], core.library.spawnables)
    number = core.editor.spawn(entry, wanted.pose)
    if wanted.joint_position is not None:
        core.world.set_joint(number, wanted.joint_position)
    return number
