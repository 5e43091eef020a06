"""Carries out what a scene draws at random: when it begins, and before each frame.

Values that were drawn come in, the world and the agents are changed by what editors use too. What
was drawn is kept as a record, from which the same can be made again.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from sailenv_ros.authoring.viewpoints import ViewScene
from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.scene.entries import checked_scene, plain_value
from sailenv_ros.scene.randomise.random_values import sampled
from sailenv_ros.scene.randomise.randomisation import Randomisation, RandomTargets, Values
from sailenv_ros.simulation.editing.editor import SceneEditor
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.simulation.script.drawn_objects import add_drawn, arrange_drawn, move_drawn
from sailenv_ros.simulation.script.own_values import OwnCameraValues, scene_values
from sailenv_ros.simulation.script.rule_places import placed_by_rules
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import light_named
from sailenv_ros.types.validation import SEED

__all__ = ["RandomisationRequest", "Randomiser"]

_PICTURE = ("exposure", "full_well")
_RECORD = ("seed", "index", "step", "epoch", "frame")


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomisationRequest:
    """Inputs of randomisation, besides the scene and the seed.

    Attributes
    ----------
    index : int
        Which of the seed's epochs.
    things : tuple of Randomisation or None
        Instead of what the scene's file draws.
    record : mapping or None
        What was drawn for a frame and is to be made again.
    """

    index: int = 0
    things: tuple[Randomisation, ...] | None = None
    record: Mapping[str, Any] | None = None


class Randomiser:
    """Randomisation of one simulation: draws values and applies them to the world.

    Parameters
    ----------
    scene : LiveScene
    editor : SceneEditor
        Of that scene.
    view_scene : callable
        Returns the scene as it stands now, as a lens sees it.

    Attributes
    ----------
    chance : RandomisationRequest
        Of the present epoch.
    """

    def __init__(
        self,
        scene: LiveScene,
        editor: SceneEditor,
        view_scene: Callable[[CameraIntrinsics], ViewScene],
    ) -> None:
        self._scene = scene
        self._editor = editor
        self._view_scene = view_scene
        self.chance = RandomisationRequest()
        self._things: tuple[Randomisation, ...] = ()
        self._epoch: Values = {}
        self._frame: Values = {}
        self._drawn_at: int | None = None
        self._own: Mapping[str, Mapping[str, Any]] = {}
        self._categories: Mapping[str, str] = {}
        self._own_cameras = OwnCameraValues()

    def begin(self, chance: RandomisationRequest) -> None:
        """Draw what is drawn for an epoch, and change the world that has just been built."""
        self.chance = chance
        described = self._scene.world.described
        of_scene = () if described is None else described.randomise
        self._things = of_scene if chance.things is None else chance.things
        self._frame, self._drawn_at = {}, None
        # Later the world has what was drawn instead.
        self._own = {} if described is None else scene_values(described)
        self._categories = self._categories_now()
        if chance.record is not None:
            self._epoch = dict(chance.record.get("epoch", {}))
        else:
            self._epoch = self._sampled("epoch", 0)
        with self._scene.announce.once():
            self._epoch = self._change_objects(self._epoch)
            self._change_looks(self._epoch)
        # A rule looks at the scene as it was drawn.
        self._epoch = self._placed(self._epoch)

    def place_cameras(self) -> None:
        """Put the agents where the epoch has drawn them; those that come later stay."""
        self._change_cameras(self._epoch)

    def before_frame(self) -> None:
        """Draw what is drawn for each instant that is rendered, once."""
        step = self._scene.world.step_count
        if self._drawn_at == step or not self._is_drawn_for_frames:
            return
        record = self.chance.record
        self._frame = (
            dict(record.get("frame", {})) if record is not None else self._sampled("frame", step)
        )
        with self._scene.announce.once():
            self._change_looks(self._frame)
            self._frame = self._placed(self._frame)
            self._change_cameras(self._frame)
        self._drawn_at = step

    @property
    def record(self) -> Mapping[str, Any] | None:
        """Record of the values drawn for the present frame; None if nothing was drawn."""
        if not self._epoch and not self._frame:
            return None
        return {
            "seed": self._scene.seed,
            "index": self.chance.index,
            "step": self._scene.world.step_count,
            "epoch": self._epoch,
            "frame": self._frame,
        }

    def next_chance(
        self, index: int | None, things: object, record: object, *, seeded: bool
    ) -> RandomisationRequest:
        """Return what `randomise` asks for; see there.

        Raises
        ------
        InvalidRequest, InvalidEntry, InvalidState
            If it cannot be drawn.
        """
        if record is not None:
            return RandomisationRequest(
                index=int(_record(record)["index"]),
                things=self.chance.things,
                record=_record(record),
            )
        chosen = self.chance.things if things is None else self._checked(things)
        described = self._scene.world.described
        if not (chosen or (described is not None and described.randomise)):
            raise InvalidState(
                "the scene has nothing under randomise; say what is to be drawn by things"
            )
        if index is None:
            index = 0 if seeded else self.chance.index + 1
        return RandomisationRequest(index=index, things=chosen)

    def chance_of_reset(self, *, seeded: bool) -> RandomisationRequest:
        """Return what a reset draws: the same again, or the first epoch of a seed that is given."""
        return RandomisationRequest(things=self.chance.things) if seeded else self.chance

    # -- inside ----------------------------------------------------------------------------

    @property
    def _is_drawn_for_frames(self) -> bool:
        record = self.chance.record
        if record is not None:
            return bool(record.get("frame"))
        return any(thing.every == "frame" for thing in self._things)

    def _sampled(self, every: Any, step: int) -> Values:
        if not self._things:
            return {}
        return sampled(
            self._things,
            self._targets(),
            seed=self._scene.seed,
            index=self.chance.index,
            every=every,
            step=step,
        )

    def _placed(self, values: Values) -> Values:
        return placed_by_rules(values, self._scene.agent_specs, self._view_scene)

    def _targets(self) -> RandomTargets:
        scene, described = self._scene, self._scene.world.described
        objects = () if described is None else tuple(entry.name for entry in described.objects)
        lights = () if described is None else described.lights
        own_of_agents = {one.spec.name: self._own_cameras.of(one.spec) for one in scene.agents}
        parts = (b.placement for b in scene.world.bodies if b.placement.entry is None)
        surfaces = [placement.name for placement in parts if placement.outside is None]
        return RandomTargets(
            objects=objects,
            surfaces=tuple(surfaces),
            agents=tuple(scene.agent_specs),
            lights={light.name: light.to_light().position_m for light in lights},
            categories=self._categories,
            own={**self._own, "agents": own_of_agents},
        )

    def _categories_now(self) -> Mapping[str, str]:
        """Return the category of each object, those that wait among them, and part of the room."""
        scene, described = self._scene, self._scene.world.described
        entries = () if described is None else described.objects
        placements = [body.placement for body in scene.world.bodies]
        table = scene.world.categories
        found = {one.name: table[one.category_id].name for one in placements}
        for entry in entries:
            if entry.name not in found:
                found[entry.name] = entry.category or scene.library.peek_asset(entry.asset).category
        return found

    def _checked(self, things: object) -> tuple[Randomisation, ...]:
        described = self._scene.world.described
        assert described is not None
        data = described.model_dump(mode="json", exclude_unset=True, exclude={"name"})
        data["randomise"] = plain_value(things)
        known = self._scene.library.knowledge_of(self._scene.world.scene)
        return checked_scene(data, known, what="things").randomise

    # -- what is changed -------------------------------------------------------------------

    def _change_objects(self, values: Values) -> Values:
        """Bring objects to what was drawn; return it with the places that were found."""
        drawn: Mapping[str, Mapping[str, Any]] = values.get("objects", {})
        world = self._scene.world
        if drawn:
            assert world.described is not None
            arrange_drawn(self._editor, world.described, drawn)
        values = add_drawn(self._editor, values, self._view_scene(CameraIntrinsics()).free_space)
        for name, behaviours in values.get("behaviours", {}).items():
            if any(body.placement.name == name for body in world.bodies):
                move_drawn(self._editor, world.find(name), behaviours)
        return values

    def apply_drawn(self, number: int) -> None:
        """Apply looks and behaviours that were drawn for an object that has just entered."""
        name = self._scene.world.body(number).placement.name
        move_drawn(self._editor, number, self._epoch.get("behaviours", {}).get(name, ()))
        for values in (self._epoch, self._frame):
            for part, keys in values.get("materials", {}).get(name, {}).items():
                if keys:
                    self._editor.set_material(number, part, keys)

    def _change_looks(self, values: Values) -> None:
        world = self._scene.world
        names = {body.placement.name: number for number, body in world.numbered_bodies}
        for name, parts in values.get("materials", {}).items():
            for part, keys in parts.items():
                if name in names and keys:
                    self._editor.set_material(names[name], part, keys)
        drawn: Mapping[str, Mapping[str, Any]] = values.get("lights", {})
        if drawn:
            lights = list(world.contents.lights)
            for name, keys in drawn.items():
                if any(light.name == name for light in lights):
                    before = light_named(name, lights)
                    after = replace(before, **{k: _tuple(v) for k, v in keys.items()})
                    lights[lights.index(before)] = after
            world.set_lights(lights)
            self._scene.announce()
        if values.get("environment"):
            self._editor.change_environment(values["environment"])

    def _change_cameras(self, values: Values) -> None:
        agents = self._scene.agents
        present = {record.spec.name: record for record in agents}
        for name, keys in values.get("agents", {}).items():
            if name not in present:
                continue
            spec = present[name].spec
            if "position" in keys:
                agents.put(name, _camera_pose(keys), self._scene.world, teleport=True)
            if "vertical_fov" in keys:
                lens = spec.intrinsics.with_vertical_fov(keys["vertical_fov"])
                agents.set_intrinsics(name, lens)
            picture = {key: keys[key] for key in _PICTURE if key in keys}
            if picture:
                agents.set_picture(name, spec.picture.changed(picture))
            self._own_cameras.keep(spec, agents[name].spec)
            self._scene.announce()


def _camera_pose(keys: Mapping[str, Any]) -> Pose:
    position = tuple(float(x) for x in keys["position"])
    if "look_at" in keys:
        return look_at(position, keys["look_at"])
    return Pose.from_rpy_deg(position, keys.get("rotation", (0.0, 0.0, 0.0)))


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _record(given: object) -> Mapping[str, Any]:
    """Read a record: a mapping, or its JSON text."""
    accepted = "what a frame's `randomised` tells: a mapping with seed, index, step, epoch, frame"
    record = given
    if isinstance(given, str):
        try:
            record = json.loads(given)
        except (ValueError, RecursionError):
            raise InvalidRequest("record", given, accepted) from None
    if not isinstance(record, Mapping) or set(record) != set(_RECORD):
        raise InvalidRequest("record", given, accepted)
    numbers = [record[key] for key in ("seed", "index", "step")]
    if any(map(SEED.refused, numbers)):
        raise InvalidRequest("record", given, accepted)
    if not all(isinstance(record[key], Mapping) for key in ("epoch", "frame")):
        raise InvalidRequest("record", given, accepted)
    plain: Mapping[str, Any] = plain_value(record)
    return plain
