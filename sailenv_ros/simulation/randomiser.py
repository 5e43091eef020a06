"""Carries out what a scene draws at random: when it begins, and before each frame.

Values that were drawn come in, the world and the agents are changed by what editors use too. What
was drawn is kept as a record, from which the same can be made again.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from sailenv_ros.assets.arranging import arranged
from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.geometry import Pose, look_at
from sailenv_ros.lights import light_named
from sailenv_ros.scene.entries import checked_scene, plain_value
from sailenv_ros.scene.randomise.random_values import sampled
from sailenv_ros.scene.randomise.thing import RandomTargets, Thing, Values
from sailenv_ros.scene.serialisation import PLACE_KEYS
from sailenv_ros.scene.spec import ObjectSpec, SceneSpec
from sailenv_ros.simulation.material_edits import set_material
from sailenv_ros.simulation.rule_places import agent_specs, placed_by_rules

if TYPE_CHECKING:
    from sailenv_ros.simulation.core import SimulationCore

__all__ = ["Chance", "Randomiser"]

_PICTURE = ("exposure", "full_well")
_RECORD = ("seed", "index", "step", "epoch", "frame")


@dataclass(frozen=True, slots=True, kw_only=True)
class Chance:
    """Inputs of randomisation, besides the scene and the seed.

    Attributes
    ----------
    index : int
        Which of the seed's epochs.
    things : tuple of Thing or None
        Instead of what the scene's file draws.
    record : mapping or None
        What was drawn for a frame and is to be made again.
    """

    index: int = 0
    things: tuple[Thing, ...] | None = None
    record: Mapping[str, Any] | None = None


class Randomiser:
    """Randomisation of one simulation: draws values and applies them to the world.

    Attributes
    ----------
    chance : Chance
        Of the present epoch.
    """

    def __init__(self, core: SimulationCore) -> None:
        self._core = core
        self.chance = Chance()
        self._things: tuple[Thing, ...] = ()
        self._epoch: Values = {}
        self._frame: Values = {}
        self._drawn_at: int | None = None

    def begin(self, chance: Chance) -> None:
        """Draw what is drawn for an epoch, and change the world that has just been built."""
        self.chance = chance
        described = self._core.world.described
        of_scene = () if described is None else described.randomise
        self._things = of_scene if chance.things is None else chance.things
        self._frame, self._drawn_at = {}, None
        if chance.record is not None:
            self._epoch = dict(chance.record.get("epoch", {}))
        else:
            self._epoch = self._sampled("epoch", 0)
        with self._core.announced_once():
            self._change_objects(self._epoch)
            self._change_looks(self._epoch)
        # A rule looks at the scene as it was drawn.
        self._epoch = placed_by_rules(self._epoch, self._core)

    def place_cameras(self) -> None:
        """Put the agents where the epoch has drawn them; those that come later stay."""
        self._change_cameras(self._epoch)

    def before_frame(self) -> None:
        """Draw what is drawn for each instant that is rendered, once."""
        step = self._core.world.step_count
        if self._drawn_at == step or not self._is_drawn_for_frames:
            return
        record = self.chance.record
        self._frame = (
            dict(record.get("frame", {})) if record is not None else self._sampled("frame", step)
        )
        with self._core.announced_once():
            self._change_looks(self._frame)
            self._frame = placed_by_rules(self._frame, self._core)
            self._change_cameras(self._frame)
        self._drawn_at = step

    @property
    def record(self) -> Mapping[str, Any] | None:
        """Record of the values drawn for the present frame; None if nothing was drawn."""
        if not self._epoch and not self._frame:
            return None
        return {
            "seed": self._core.seed,
            "index": self.chance.index,
            "step": self._core.world.step_count,
            "epoch": self._epoch,
            "frame": self._frame,
        }

    def next_chance(
        self, index: int | None, things: object, record: object, *, seeded: bool
    ) -> Chance:
        """Return what `randomise` asks for; see there.

        Raises
        ------
        InvalidRequest, InvalidEntry, InvalidState
            If it cannot be drawn.
        """
        if record is not None:
            return Chance(
                index=int(_record(record)["index"]),
                things=self.chance.things,
                record=_record(record),
            )
        chosen = self.chance.things if things is None else self._checked(things)
        described = self._core.world.described
        if not (chosen or (described is not None and described.randomise)):
            raise InvalidState(
                "the scene has nothing under randomise; say what is to be drawn by things"
            )
        if index is None:
            index = 0 if seeded else self.chance.index + 1
        return Chance(index=index, things=chosen)

    def chance_of_reset(self, *, seeded: bool) -> Chance:
        """Return what a reset draws: the same again, or the first epoch of a seed that is given."""
        return Chance(things=self.chance.things) if seeded else self.chance

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
            seed=self._core.seed,
            index=self.chance.index,
            every=every,
            step=step,
        )

    def _targets(self) -> RandomTargets:
        core, described = self._core, self._core.world.described
        objects = () if described is None else tuple(entry.name for entry in described.objects)
        lights = () if described is None else described.lights
        surfaces = [b.placement.name for b in core.world.bodies if b.placement.entry is None]
        return RandomTargets(
            objects=objects,
            surfaces=tuple(surfaces),
            agents=tuple(agent_specs(core)),
            lights={light.name: light.to_light().position_m for light in lights},
        )

    def _checked(self, things: object) -> tuple[Thing, ...]:
        described = self._core.world.described
        assert described is not None
        data = described.model_dump(mode="json", exclude_unset=True, exclude={"name"})
        data["randomise"] = plain_value(things)
        known = self._core.library.knowledge_of(self._core.world.scene)
        return checked_scene(data, known, what="things").randomise

    # -- what is changed -------------------------------------------------------------------

    def _change_objects(self, values: Values) -> None:
        drawn: Mapping[str, Mapping[str, Any]] = values.get("objects", {})
        world = self._core.world
        if drawn:
            assert world.described is not None
            self._arrange(world.described, drawn)
        for entry in values.get("added", ()):
            place = {key: value for key, value in entry.items() if key != "orientation"}
            pose = Pose(tuple(entry["position"]), tuple(entry["orientation"]))
            del place["position"]
            self._core.editor.spawn(place, pose)

    def _arrange(self, spec: SceneSpec, drawn: Mapping[str, Mapping[str, Any]]) -> None:
        """Bring objects to where a file would put them that says what was drawn."""
        core, world, library = self._core, self._core.world, self._core.library
        absent = {name for name, keys in drawn.items() if keys.get("there") is False}
        entries: list[ObjectSpec] = []
        for entry in _carriers_first(spec.objects):
            if entry.name in absent or entry.on in absent:
                absent.add(entry.name)
                continue
            entries.append(_with_drawn(entry, drawn.get(entry.name, {})))
        stock = {entry.name: library.peek_asset(entry.asset) for entry in entries}
        poses = {name: pose.matrix() for name, pose in arranged(entries, stock, spec.room).items()}
        for entry in entries:
            keys = drawn.get(entry.name, {})
            if "offset" in keys or "turn" in keys:
                _carry(poses, entries, entry.name, keys)
        begun = {entry.name: entry for entry in spec.objects}
        waiting = dict(world.waiting.names())
        for name in absent:
            world.despawn(waiting.pop(name, 0) or world.find(name))
        for entry in entries:
            pose = Pose.from_matrix(poses[entry.name])
            if entry.name in waiting:
                self._arrange_waiting(waiting[entry.name], entry, begun[entry.name], pose)
                continue
            number = world.find(entry.name)
            if entry.asset != begun[entry.name].asset:
                world.despawn(number)
                keys = entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS})
                place = {"position": pose.position_m, "orientation": pose.orientation_xyzw}
                world.spawn(
                    library.placement({**keys, **place}, world, seed=core.seed, start_s=0.0)
                )
                continue
            if entry.scale != begun[entry.name].scale:
                core.editor.change_object(number, {"scale": entry.scale})
            if not np.allclose(pose.matrix(), world.body(number).entry_pose.matrix(), atol=1e-12):
                world.put_body(number, pose, teleport=True)

    def _arrange_waiting(
        self, number: int, entry: ObjectSpec, begun: ObjectSpec, pose: Pose
    ) -> None:
        """Let an object that waits enter as it was drawn."""
        core, world = self._core, self._core.world
        placement = world.waiting[number]
        if entry.asset != begun.asset or entry.scale != begun.scale:
            keys = entry.model_dump(exclude_unset=True, exclude={*PLACE_KEYS, "appear", "leave"})
            place = {"position": pose.position_m, "orientation": pose.orientation_xyzw}
            drawn = core.library.placement(
                {**keys, **place, "scale": entry.scale}, world, seed=core.seed, start_s=0.0
            )
            placement = replace(drawn, entry=entry)
        elif np.allclose(pose.matrix(), placement.pose.matrix(), atol=1e-12):
            return
        world.wait_as(number, replace(placement, pose=pose))

    def dress(self, number: int) -> None:
        """Apply the looks that were drawn for an object that has just entered."""
        name = self._core.world.body(number).placement.name
        for values in (self._epoch, self._frame):
            for part, keys in values.get("materials", {}).get(name, {}).items():
                if keys:
                    set_material(self._core, number, part, keys)

    def _change_looks(self, values: Values) -> None:
        core, world = self._core, self._core.world
        names = {body.placement.name: number for number, body in world.numbered_bodies}
        for name, parts in values.get("materials", {}).items():
            for part, keys in parts.items():
                if name in names and keys:
                    set_material(core, names[name], part, keys)
        drawn: Mapping[str, Mapping[str, Any]] = values.get("lights", {})
        if drawn:
            lights = list(world.contents.lights)
            for name, keys in drawn.items():
                if any(light.name == name for light in lights):
                    before = light_named(name, lights)
                    after = replace(before, **{k: _tuple(v) for k, v in keys.items()})
                    lights[lights.index(before)] = after
            world.set_lights(lights)
            core.announce()
        if values.get("environment"):
            core.editor.change_environment(values["environment"])

    def _change_cameras(self, values: Values) -> None:
        core = self._core
        present = {record.spec.name: record for record in core.agents}
        for name, keys in values.get("agents", {}).items():
            if name not in present:
                continue
            spec = present[name].spec
            if "position" in keys:
                core.agents.put(name, _camera_pose(keys), core.world, teleport=True)
            if "vertical_fov" in keys:
                lens = replace(spec.intrinsics, vertical_fov_deg=keys["vertical_fov"])
                core.agents.set_intrinsics(name, lens)
            picture = {key: keys[key] for key in _PICTURE if key in keys}
            if picture:
                core.agents.set_picture(name, spec.picture.changed(picture))
            core.announce()


def _with_drawn(entry: ObjectSpec, keys: Mapping[str, Any]) -> ObjectSpec:
    update: dict[str, Any] = {"asset": keys["asset"]} if "asset" in keys else {}
    if "scale" in keys:
        update["scale"] = (float(keys["scale"]),) * 3
    return entry.model_copy(update=update) if update else entry


def _carriers_first(entries: Sequence[ObjectSpec]) -> list[ObjectSpec]:
    """Return the entries so that none comes before what carries it."""
    by_name = {entry.name: entry for entry in entries}

    def depth(entry: ObjectSpec) -> int:
        above = 0
        while entry.on is not None and entry.on in by_name and above < len(by_name):
            entry, above = by_name[entry.on], above + 1
        return above

    return sorted(entries, key=depth)


def _carry(
    poses: dict[str, Any], entries: Sequence[ObjectSpec], name: str, keys: Mapping[str, Any]
) -> None:
    """Shift and turn an object about its origin, and what stands on it."""
    origin = poses[name][:3, 3].copy()
    motion = Pose.from_rpy_deg((0.0, 0.0, 0.0), (0.0, 0.0, float(keys.get("turn", 0.0)))).matrix()
    motion[:3, 3] = origin - motion[:3, :3] @ origin + np.asarray(keys.get("offset", (0, 0, 0)))
    moving = {name}
    for entry in entries:  # carriers come first
        if entry.on in moving:
            moving.add(entry.name)
    for one in moving:
        poses[one] = motion @ poses[one]


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
        except ValueError:
            raise InvalidRequest("record", given, accepted) from None
    if not isinstance(record, Mapping) or set(record) != set(_RECORD):
        raise InvalidRequest("record", given, accepted)
    numbers = [record[key] for key in ("seed", "index", "step")]
    if any(isinstance(n, bool) or not isinstance(n, int) or not 0 <= n < 2**63 for n in numbers):
        raise InvalidRequest("record", given, accepted)
    if not all(isinstance(record[key], Mapping) for key in ("epoch", "frame")):
        raise InvalidRequest("record", given, accepted)
    plain: Mapping[str, Any] = plain_value(record)
    return plain
