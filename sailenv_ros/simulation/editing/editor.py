"""Changes of what a world holds, described as a scene file describes it.

Plain mappings with the keys of a scene file in, a changed world out; what cannot be accepted
raises and leaves the world as it was. Knows no thread and no renderer.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.errors import InvalidRequest, InvalidState, UnknownName
from sailenv_ros.scene.entries import checked_scene, free_name, plain_value, read_document
from sailenv_ros.scene.serialisation import MOTION_KEYS, PLACE_KEYS
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec
from sailenv_ros.simulation.editing.material_edits import set_material
from sailenv_ros.simulation.editing.saving import environment_entry
from sailenv_ros.simulation.script.scenario import scenario_additions
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Asset
from sailenv_ros.world.bodies import Body
from sailenv_ros.world.bullet import STEPS_PER_SECOND

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = ["SceneEditor"]

CHANGEABLE = (
    "name",
    "category",
    "scale",
    "static",
    "mass",
    "gravity",
    "friction",
    "restitution",
    "colour",
    "metallic",
    "roughness",
    "materials",
)
"""Keys of an object that `change_object` takes; it is moved by `move_object`."""


class SceneEditor:
    """Changes the world of one simulation; see `operations` for arguments and errors."""

    def __init__(self, core: SimulationCore) -> None:
        self._core = core

    # -- objects ---------------------------------------------------------------------------

    def free_name(self, asset: str) -> str:
        """Return the first of ``chair_01_1``, ``chair_01_2`` … that no object has."""
        world = self._core.world
        there = (drawn.instance.name for drawn in world.contents.instances)
        taken = (*there, *world.waiting.names())
        return free_name(self._core.library.canonical_asset(asset), taken)

    def spawn(self, entry: Mapping[str, Any], pose: Pose) -> int:
        """Add an object with the keys of a scene file at a pose; return its instance id."""
        world = self._core.world
        placement = self._core.library.placement(
            {**entry, **_place(pose)},
            world,
            seed=self._core.seed,
            start_s=self._now_s,
        )
        instance_id = world.spawn(placement)
        self._core.announce()
        return instance_id

    def entry_without_place(self, entry: ObjectSpec) -> dict[str, Any]:
        """Return what a scene file says of an object, but for where it is and how it moves."""
        return _without_place(entry)

    def change_object(self, instance_id: int, changes: Mapping[str, Any]) -> None:
        """Change what an object is; None takes the asset's own."""
        world = self._core.world
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
        if changes.get("materials", ()) is None:
            changes = {**changes, "materials": ()}
        placement = self._core.library.placement(
            {**_without_place(present), **_place_of(body, present), **changes},
            world,
            seed=self._core.seed,
            start_s=0.0,
        )
        assert placement.entry is not None
        changed = {key: getattr(placement.entry, key) for key in changes}
        entry = present.model_copy(update=changed)
        world.replace_body(instance_id, replace(placement, entry=entry))
        self._core.announce()

    def require_untaught(self, instance_id: int) -> None:
        """Refuse to rename or remove an object that lessons name.

        Raises
        ------
        InvalidState
            If they name it.
        """
        world = self._core.world
        name = world.body(instance_id).placement.name
        if world.described is not None and name in world.described.taught:
            raise InvalidState(
                f"object {name!r} comes and goes with the lessons of the scene, which name it; "
                "begin other lessons first"
            )

    def set_material(self, instance_id: int, part: str, changes: Mapping[str, Any]) -> None:
        """Change what an object or a part of the room is made of."""
        set_material(self._core, instance_id, part, changes)

    def add_behaviour(self, instance_id: int, behaviour: Mapping[str, Any]) -> None:
        """Let an object move by one more behaviour: its ``type`` and its parameters."""
        body = self._core.world.body(instance_id)
        parameters = {key: value for key, value in behaviour.items() if key != "type"}
        running = start_behaviour(
            behaviour["type"],
            parameters,
            seed=self._core.seed,
            object_name=body.placement.name,
            place=len(body.behaviours),
            start_s=self._now_s,
        )
        body.attach(running)
        self._core.announce()

    def apply_wrench(self, obj: int | str, parameters: Mapping[str, Any]) -> None:
        """Let a force and a torque act from now on, by the keys of `wrench`.

        Upon an object, by its id or name, or upon the mover of that name.
        """
        body = self._core.world.pushed(obj)
        body.push(
            start_behaviour(
                "wrench",
                parameters,
                seed=self._core.seed,
                object_name=body.placement.name,
                place=0,
                start_s=self._now_s,
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
        self._core.world.categories.named(asset.category)
        name = self._core.library.add_upload(asset, rename=rename)
        self._core.announce()
        return name

    # -- surroundings and scenarios --------------------------------------------------------

    def change_environment(self, changes: Mapping[str, Any]) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file."""
        world, library = self._core.world, self._core.library
        assert world.described is not None
        for key in changes:
            if key not in EnvironmentSpec.model_fields:
                raise UnknownName("key of environment", key, EnvironmentSpec.model_fields)
        entry = {**environment_entry(world), **plain_value(changes)}
        data = {"version": 1, "environment": entry}
        checked = checked_scene(data, library.knowledge, what="environment").environment
        world.set_environment(library.environment(checked))
        world.described = world.described.model_copy(update={"environment": checked})
        self._core.announce()

    def load_scenario(self, scenario: str | Mapping[str, Any]) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; return their instance ids, in order."""
        wanted = read_document(scenario) if isinstance(scenario, str) else scenario
        if isinstance(wanted, str):
            wanted = {"scene": wanted}
        if not isinstance(wanted, Mapping):
            raise InvalidRequest("scenario", wanted, "a mapping with scene, objects, timings")
        names = [wanted[key] for key in ("scene", "scene_name") if key in wanted]
        scene = names[0] if names else self._core.world.scene
        if not isinstance(scene, str) or len(names) > 1:
            raise InvalidRequest("scene", names, "the name of a scene")
        viewer = next((agent.name for agent in self._core.agents.specs), "")
        more = scenario_additions(wanted, viewer=viewer)
        self._core.begin(scene, self._core.seed, as_registered=False, more=more)
        world = self._core.world
        ids = sorted((*world.bodies_by_id, *world.waiting))
        return tuple(ids[len(ids) - len(more.objects) :])

    # -- inside ----------------------------------------------------------------------------

    @property
    def _now_s(self) -> float:
        return self._core.world.step_count / STEPS_PER_SECOND


def _without_place(entry: ObjectSpec) -> dict[str, Any]:
    """Return the keys of an entry, but for where it is and how it moves."""
    return entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS, *MOTION_KEYS})


def _place_of(body: Body, entry: ObjectSpec) -> dict[str, Any]:
    """Return where a body is; of one on a joint, where it is while the joint's position is 0."""
    return _place(body.pose() if entry.joint is None else entry.pose)


def _place(pose: Pose) -> dict[str, Any]:
    return {"position": pose.position_m, "orientation": pose.orientation_xyzw}
