"""Changes of what a world holds, described as a scene file describes it.

Plain mappings with the keys of a scene file in, a changed world out; what cannot be accepted
raises and leaves the world as it was. Knows no thread and no renderer.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.scene.entries import checked_scene, free_name, plain_value
from sailenv_ros.scene.requested_changes import ObjectChanges
from sailenv_ros.scene.serialisation import MOTION_KEYS, PLACE_KEYS
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec
from sailenv_ros.simulation.editing.material_edits import (
    changed_materials,
    changed_surface,
    set_surface,
)
from sailenv_ros.simulation.editing.saving import environment_entry
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.simulation.robot_entries import robot_placement
from sailenv_ros.simulation.room_exposure import meter
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.opening_pieces import moving_entries

__all__ = ["SceneEditor", "entry_without_place"]

CHANGEABLE = tuple(ObjectChanges.__annotations__)
"""Keys of an object that `change_object` takes; it is moved by `move_object`."""


OF_ROBOTS = ("robot", "collides_with_itself", "spinning_friction")
"""Attributes that links of robots keep, whatever else is changed of them."""


class SceneEditor:
    """Changes the world of one simulation; see `operations` for arguments and errors.

    Attributes
    ----------
    scene : LiveScene
    """

    def __init__(self, scene: LiveScene) -> None:
        self.scene = scene

    # -- objects ---------------------------------------------------------------------------

    def free_name(self, asset: str) -> str:
        """Return the first of ``chair_01_1``, ``chair_01_2`` … that no object has."""
        world = self.scene.world
        there = (drawn.instance.name for drawn in world.contents.instances)
        taken = (*there, *world.waiting.names())
        return free_name(self.scene.library.canonical_asset(asset), taken)

    def spawn(self, entry: Mapping[str, Any], pose: Pose) -> int:
        """Add an object with keys of a scene file, but for its place; return its instance id.

        What opens of a piece that stands still comes with it, as objects of their own.
        """
        world, library = self.scene.world, self.scene.library
        seed, start_s = self.scene.seed, self.scene.now_s
        placement = library.placement(entry, pose, world, seed=seed, start_s=start_s)
        spec = placement.entry
        assert spec is not None
        instance_id = world.spawn(placement)
        try:
            for part in moving_entries((spec,), {spec.name: library.peek_asset(spec.asset)}):
                described = part.model_dump(exclude_unset=True)
                world.spawn(
                    library.placement(described, part.pose, world, seed=seed, start_s=start_s)
                )
        except BaseException:
            world.despawn(instance_id)
            raise
        self.scene.announce()
        return instance_id

    def spawn_robot(self, entry: Mapping[str, Any], pose: Pose) -> str:
        """Add a robot with keys of a scene file, but for its place; return its name."""
        world = self.scene.world
        library, taken = self.scene.library, [robot.name for robot in world.robots]
        placement = robot_placement(entry, pose, taken, library.robots, library.knowledge)
        world.spawn_robot(placement)
        self.scene.announce()
        return placement.spec.name

    def change_object(self, instance_id: int, changes: Mapping[str, Any]) -> None:
        """Change what an object is; None takes the asset's own."""
        world = self.scene.world
        body = world.body(instance_id)
        present = body.placement.entry
        if present is None:
            accepted = "one of the scene's own; parts of the room are described by its file alone"
            raise InvalidRequest("object", body.placement.name, accepted)
        for key in changes:
            if key not in CHANGEABLE:
                raise UnknownName("key of an object that can be changed", key, CHANGEABLE)
        if changes.get("name", present.name) != present.name:
            self.require_untaught(instance_id)
        opened = self.scene.library.peek_asset(present.asset).moving and not (
            body.placement.asset.moving
        )
        if opened and changes.get("scale", present.scale) != present.scale:
            accepted = "that of a piece without parts on joints; spawn this one anew"
            raise InvalidRequest(f"scale of {present.name!r}", changes["scale"], accepted)
        if changes.get("materials", ()) is None:
            changes = {**changes, "materials": ()}
        placement = self.scene.library.placement(
            {**entry_without_place(present), **changes},
            _pose_of(body, present),
            world,
            seed=self.scene.seed,
            start_s=0.0,
            shut=bool(body.placement.asset.moving),
        )
        assert placement.entry is not None
        changed = {key: getattr(placement.entry, key) for key in changes}
        entry = present.model_copy(update=changed)
        kept = {key: getattr(body.placement, key) for key in OF_ROBOTS}
        world.replace_body(instance_id, replace(placement, entry=entry, **kept))
        self.scene.announce()

    def require_untaught(self, instance_id: int) -> None:
        """Refuse to rename or remove an object that lessons name.

        Raises
        ------
        InvalidState
            If they name it.
        """
        world = self.scene.world
        name = world.body(instance_id).placement.name
        if world.described is not None and name in world.described.lesson_objects:
            raise InvalidState(
                f"object {name!r} comes and goes with the lessons of the scene, which name it; "
                "begin other lessons first"
            )

    def set_material(self, instance_id: int, part: str, changes: Mapping[str, Any]) -> None:
        """Change what an object or a part of the room is made of."""
        body = self.scene.world.body(instance_id)
        entry = body.placement.entry
        if entry is None:
            keys = changed_surface(self.scene.world, instance_id, part, changes)
            set_surface(self.scene, instance_id, keys)
        else:
            materials = changed_materials(entry, part, changes)
            self.change_object(instance_id, {"materials": materials})

    def add_behaviour(self, instance_id: int, behaviour: Mapping[str, Any]) -> None:
        """Let an object move by one more behaviour: its ``type`` and its parameters."""
        body = self.scene.world.body(instance_id)
        parameters = {key: value for key, value in behaviour.items() if key != "type"}
        running = start_behaviour(
            behaviour["type"],
            parameters,
            seed=self.scene.seed,
            object_name=body.placement.name,
            place=len(body.behaviours),
            start_s=self.scene.now_s,
        )
        body.attach(running)
        self.scene.announce()

    def apply_wrench(self, obj: int | str, parameters: Mapping[str, Any]) -> None:
        """Let a force and a torque act from now on, by the keys of `wrench`.

        Upon an object, by its id or name, or upon the mover of that name.
        """
        body = self.scene.world.pushed(obj)
        body.push(
            start_behaviour(
                "wrench",
                parameters,
                seed=self.scene.seed,
                object_name=body.placement.name,
                place=0,
                start_s=self.scene.now_s,
            )
        )

    def add_model(self, asset: Asset, *, rename: bool) -> str:
        """Add an imported model to the catalogue; return the name that it is spawned by.

        Parameters
        ----------
        asset : Asset
        rename : bool
            True appends a number where the name is in use; False refuses it then.
        """
        self.scene.world.categories.named(asset.category)
        name = self.scene.library.uploads.add(asset, rename=rename)
        self.scene.announce()
        return name

    # -- surroundings ----------------------------------------------------------------------

    def change_environment(self, changes: Mapping[str, Any]) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file."""
        world, library = self.scene.world, self.scene.library
        assert world.described is not None
        for key in changes:
            if key not in EnvironmentSpec.model_fields:
                raise UnknownName("key of environment", key, EnvironmentSpec.model_fields)
        entry = {**environment_entry(world), **plain_value(changes)}
        if "exposure" in changes and "meter_exposure" not in changes:
            entry.pop("meter_exposure", None)
        data = {"version": 1, "environment": entry}
        checked = checked_scene(data, library.knowledge, what="environment").environment
        world.set_environment(library.environment(checked))
        world.described = world.described.model_copy(update={"environment": checked})
        meter(world)
        self.scene.announce()


def entry_without_place(entry: ObjectSpec) -> dict[str, Any]:
    """Return what a scene file says of an object, but for where it is and how it moves."""
    return entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS, *MOTION_KEYS})


def _pose_of(body: Body, entry: ObjectSpec) -> Pose:
    """Return where a body is; of one on a joint, where it is while the joint's position is 0."""
    return body.pose() if entry.joint is None else entry.pose
