"""The requests that change what a scene holds: objects, lights, surroundings, models.

Part of `SimulationCore`; each method does all of it or raises and leaves everything as it was.
Values of clients in, ids and nouns out. Knows no thread, no renderer, no agent.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any, Literal, TypeAlias

from numpy.typing import ArrayLike

from sailenv_ros.errors import InvalidRequest, NameTaken, UnknownName
from sailenv_ros.geometry import Pose
from sailenv_ros.lights import Light, LightType, light_named
from sailenv_ros.model import Asset
from sailenv_ros.objects import ObjectState
from sailenv_ros.scene.describing import MOTION_KEYS, PLACE_KEYS, light_entry
from sailenv_ros.scene.entries import checked_scene, free_name, plain_value
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.saving import environment_entry
from sailenv_ros.simulation.scenario import scenario_entries
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.world import World

__all__ = ["Entries", "WorldRequests"]

Entries: TypeAlias = Sequence[Mapping[str, Any]]
"""Objects as a scene file describes them, besides those of the scene."""

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
)
"""Keys of an object that `change_object` takes; it is moved by `move_object`."""

_LIGHT_FIELDS = tuple(field.name for field in fields(Light) if field.name != "name")


class WorldRequests:
    """What clients may ask of the present world; `SimulationCore` has the world."""

    _agents: AgentTable
    _library: SceneLibrary
    _world: World
    _seed: int

    # -- objects ---------------------------------------------------------------------------

    def spawn_object(
        self,
        asset: str,
        *,
        name: str | None = None,
        pose: Pose,
        scale: ArrayLike = (1.0, 1.0, 1.0),
        static: bool = False,
        category: str | None = None,
        behaviours: Sequence[Mapping[str, Any]] = (),
        mass_kg: float | None = None,
    ) -> int:
        """Put one more object into the scene; give its instance id, the value of its pixels."""
        _require_pose(pose)
        world = self._world
        catalogue_name = self._library.canonical_asset(asset)
        taken = (drawn.instance.name for drawn in world.contents.instances)
        entry: dict[str, Any] = {
            "name": free_name(catalogue_name, taken) if name is None else name,
            "asset": asset,
            "position": pose.position_m,
            "orientation": pose.orientation_xyzw,
            "scale": scale,
            "static": static,
            "behaviours": behaviours,
        }
        given = {"category": category, "mass": mass_kg}
        entry.update({key: value for key, value in given.items() if value is not None})
        placement = self._library.placement(
            entry, world, seed=self._seed, start_s=world.step_count / STEPS_PER_SECOND
        )
        instance_id = world.spawn(placement)
        self._announce()
        return instance_id

    def despawn_object(self, obj: int | str) -> None:
        """Take an object, named by id or name, out of the scene; its id is not used again."""
        self._world.despawn(self._world.find(obj))
        self._discard_frames()
        self._announce()

    def move_object(self, obj: int | str, pose: Pose, *, teleport: bool = False) -> None:
        """Move an object and stop it; that is motion, which flow shows, unless it teleports."""
        _require_pose(pose)
        self._world.put_body(self._world.find(obj), pose, teleport=bool(teleport))

    def change_object(self, obj: int | str, /, **changes: Any) -> None:
        """Change what an object is, by the keys of a scene file; None takes the asset's own."""
        world = self._world
        instance_id = world.find(obj)
        body = world.body(instance_id)
        told = body.placement.entry
        if told is None:
            accepted = "one of the scene's own; parts of the room are described by its file alone"
            raise InvalidRequest("object", body.placement.name, accepted)
        for key in changes:
            if key not in CHANGEABLE:
                raise UnknownName("key of an object that can be changed", key, CHANGEABLE)
        placement = self._library.placement(
            {**_without_place(told), **_place(body.pose()), **changes},
            world,
            seed=self._seed,
            start_s=0.0,
        )
        assert placement.entry is not None
        changed = {key: getattr(placement.entry, key) for key in changes}
        entry = told.model_copy(update=changed)
        world.replace_body(instance_id, replace(placement, entry=entry))
        self._announce()

    def get_object(self, obj: int | str) -> ObjectState:
        """Say what and where an object is."""
        return self._world.object_state(self._world.find(obj))

    def spawnable_display_names(self) -> tuple[str, ...]:
        """Give the names of what can be spawned as people write them, e.g. ``Chair 01``."""
        return self._library.spawnable_display_names

    def add_model(self, asset: Asset, *, rename: bool) -> str:
        """Put an imported model into the catalogue; give the name that it is spawned by.

        Parameters
        ----------
        rename : bool
            True appends a number where the name is in use; False refuses it then.
        """
        self._world.categories.named(asset.category)
        name = self._library.add_upload(asset, rename=rename)
        self._announce()
        return name

    # -- lights and surroundings -----------------------------------------------------------

    def lights(self) -> tuple[Light, ...]:
        """Give the lights as they are now."""
        return self._world.contents.lights

    def set_light(self, name: str, **changes: Any) -> Light:
        """Change attributes of a light, by their names in `Light`; give the light as it is then."""
        lights = self.lights()
        present = light_named(name, lights)
        for key in changes:
            if key not in _LIGHT_FIELDS:
                raise UnknownName("attribute of a light", key, _LIGHT_FIELDS)
        changed = replace(present, **changes)
        if changes:
            self._world.set_lights([changed if light.name == name else light for light in lights])
            self._announce()
        return changed

    def add_light(self, name: str, type_: LightType, /, **attributes: Any) -> Light:
        """Put one more light into the scene, by attributes of `Light`; give it."""
        lights = self.lights()
        for key in attributes:
            if key not in _LIGHT_FIELDS or key == "type":
                raise UnknownName("attribute of a light", key, _LIGHT_FIELDS)
        if any(light.name == name for light in lights):
            raise NameTaken("light", name)
        added = Light(name=name, type=type_, **attributes)
        entries = [light_entry(light) for light in (*lights, added)]
        # A file must be able to say it: name, range and number of lights.
        checked_scene({"version": 1, "lights": entries}, self._library.knowledge, what="light")
        self._world.set_lights((*lights, added))
        self._announce()
        return added

    def remove_light(self, name: str) -> None:
        """Take a light out of the scene."""
        removed = light_named(name, self.lights())
        self._world.set_lights([light for light in self.lights() if light is not removed])
        self._announce()

    def set_ambient_light(self, colour: ArrayLike) -> None:
        """Set the light that arrives from everywhere (linear radiance)."""
        environment: Any = self._world.contents.environment
        self._world.set_environment(replace(environment, ambient=colour))
        self._announce()

    def set_background(
        self, kind: Literal["sky", "colour"], colour: ArrayLike | None = None
    ) -> None:
        """Show the sky or a linear colour where nothing is hit; no colour keeps the last one."""
        environment: Any = self._world.contents.environment
        chosen = environment.background_colour if colour is None else colour
        changed = replace(environment, background=kind, background_colour=chosen)
        self._world.set_environment(changed)
        self._announce()

    def set_environment(self, /, **changes: Any) -> None:
        """Change the surroundings, by the keys of `environment` in a scene file."""
        world = self._world
        assert world.described is not None
        for key in changes:
            if key not in EnvironmentSpec.model_fields:
                raise UnknownName("key of environment", key, EnvironmentSpec.model_fields)
        entry = {**environment_entry(world), **plain_value(changes)}
        data = {"version": 1, "environment": entry}
        checked = checked_scene(data, self._library.knowledge, what="environment").environment
        world.set_environment(self._library.environment(checked))
        world.described = world.described.model_copy(update={"environment": checked})
        self._announce()

    # -- scenarios -------------------------------------------------------------------------

    def load_scenario(self, scenario: str | Mapping[str, Any]) -> tuple[int, ...]:
        """Begin a scene with more objects than its own; give their instance ids, in order."""
        wanted: Mapping[str, Any] = {"scene": scenario} if isinstance(scenario, str) else scenario
        if not isinstance(wanted, Mapping):
            raise InvalidRequest("scenario", wanted, "a mapping with scene, objects, timings")
        names = [wanted[key] for key in ("scene", "scene_name") if key in wanted]
        scene = names[0] if names else self._world.scene
        if not isinstance(scene, str) or len(names) > 1:
            raise InvalidRequest("scene", names, "the name of a scene")
        viewer = next((agent.name for agent in self._agents.specs), "")
        more = scenario_entries(wanted, viewer=viewer)
        self._begin(scene, self._seed, as_registered=False, more=more)
        ids = [drawn.instance.id for drawn in self._world.contents.instances]
        return tuple(ids[len(ids) - len(more) :])

    # -- of the simulation -----------------------------------------------------------------

    def _announce(self) -> None:
        raise NotImplementedError

    def _discard_frames(self) -> None:
        raise NotImplementedError

    def _begin(self, scene: str, seed: int, *, as_registered: bool, more: Entries = ()) -> None:
        raise NotImplementedError


def _require_pose(pose: object) -> None:
    if not isinstance(pose, Pose):
        raise InvalidRequest("pose", pose, "a sailenv_ros.geometry.Pose")


def _without_place(entry: ObjectSpec) -> dict[str, Any]:
    """Give the keys of an entry, but for where it is and how it moves."""
    return entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS, *MOTION_KEYS})


def _place(pose: Pose) -> dict[str, Any]:
    return {"position": pose.position_m, "orientation": pose.orientation_xyzw}
