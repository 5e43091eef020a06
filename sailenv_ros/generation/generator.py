"""Rooms from a seed: shape, openings, furniture, things, light, the camera's way, checks, a file.

A kind of room and a number in; a scene file's text and its `SceneSpec` out. What fails a check is
taken out, or the room is drawn again, so what comes out has passed them all.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from sailenv_ros.assets.arranging import arranged
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.errors import InvalidState
from sailenv_ros.generation.checks import Fault, faults, unseen
from sailenv_ros.generation.furnishing import Furnisher
from sailenv_ros.generation.items import Item, Namer
from sailenv_ros.generation.lighting import environment_entry, light_entries
from sailenv_ros.generation.names import MAX_SEED
from sailenv_ros.generation.plan import RoomPlan
from sailenv_ros.generation.randomness import Dice
from sailenv_ros.generation.room_agents import agent_entries, best_first, standing
from sailenv_ros.generation.route import mover_entry
from sailenv_ros.generation.rule_files import Rules, rules_of
from sailenv_ros.generation.rule_models import KindFile
from sailenv_ros.generation.scene_text import scene_text
from sailenv_ros.generation.shells import Shell, shell_of
from sailenv_ros.generation.stock import Stock
from sailenv_ros.generation.things import lay_things
from sailenv_ros.labels import CategoryTable
from sailenv_ros.scene.room_rules import room_part_names
from sailenv_ros.scene.spec import EnvironmentSpec, SceneSpec
from sailenv_ros.validation import checked_integer
from sailenv_ros.world.build import build_world
from sailenv_ros.world.world import World

__all__ = ["GeneratedScene", "Generator", "generate_scene"]

MAX_ATTEMPTS = 40
MAX_ROUNDS = 8
"""How often what is at fault is taken out before the room is drawn again."""

RUG_GAP_M = 0.001


@dataclass(frozen=True, slots=True, kw_only=True)
class GeneratedScene:
    """A room from a seed.

    Attributes
    ----------
    kind : str
    seed : int
    spec : SceneSpec
        Equal to what `text` is read as.
    text : str
        A scene file.
    attempts : int
        How many rooms were drawn for it.
    taken_out : tuple of Fault
        Objects that failed a check and were left out.
    """

    kind: str
    seed: int
    spec: SceneSpec
    text: str
    attempts: int
    taken_out: tuple[Fault, ...] = ()


def generate_scene(
    kind: str, seed: int, *, assets: AssetLibrary | None = None, rules: Rules | None = None
) -> GeneratedScene:
    """Make a room; see `Generator`."""
    return Generator(assets=assets, rules=rules).generate(kind, seed)


class Generator:
    """Makes rooms; keeps what it has loaded.

    Parameters
    ----------
    assets : AssetLibrary or None
        None takes all that is installed on this machine.
    rules : Rules or None
        None takes the package's own.
    """

    def __init__(self, *, assets: AssetLibrary | None = None, rules: Rules | None = None) -> None:
        library = AssetLibrary(installed_sources(installed_packs())) if assets is None else assets
        self._stock = Stock(library)
        self._rules = rules_of() if rules is None else rules
        self._categories = CategoryTable([*load_categories().values()])

    @property
    def rules(self) -> Rules:
        """What rooms are made by."""
        return self._rules

    def generate(self, kind: str, seed: int) -> GeneratedScene:
        """Make a room.

        Parameters
        ----------
        kind : str
            A kind of room; see `rule_files.room_kinds`.
        seed : int
            From 0 to 2³¹ - 1. The same kind and seed make the same bytes, as long as rules and
            objects are the same.

        Raises
        ------
        UnknownName
            If there is no such kind.
        InvalidRequest
            If the seed is out of its range.
        AssetError
            If an object that it takes has not been built.
        InvalidState
            If the rules leave no room that passes the checks.
        """
        file = self._rules.kind(kind)
        seed = checked_integer("seed", seed, 0, MAX_SEED)
        for attempt in range(MAX_ATTEMPTS):
            draft = self._drafted(kind, file, seed, attempt)
            if draft is None:
                continue
            made = self._checked(draft)
            if made is not None:
                return made
        raise InvalidState(
            f"{MAX_ATTEMPTS} rooms of kind {kind!r} with the seed {seed} have failed the checks; "
            "the rules leave too little space"
        )

    # -- inside ----------------------------------------------------------------------------

    def _drafted(self, kind: str, file: KindFile, seed: int, attempt: int) -> _Draft | None:
        """Draw a room and furnish it; None if something that is needed has no place."""

        def dice(purpose: str) -> Dice:
            return Dice(kind, seed, attempt, purpose)

        shell = shell_of(kind, self._rules, dice("shell"))
        plan = RoomPlan(areas=shell.areas, doors=shell.doors, walls=shell.walls)
        plan.stand(shell.leaves, shell.clear)
        namer = Namer(room_part_names(shell.entry))
        skirting = shell.entry.get("skirting")
        furniture: list[Item] = []
        for area in shell.areas:
            furnisher = Furnisher(
                area=area,
                plan=plan,
                rules=self._rules,
                stock=self._stock,
                dice=dice(f"furniture of {area.name}"),
                namer=namer,
                skirting_m=0.015 if skirting is not False else 0.0,
            )
            if not plan.connects(()):
                return None
            if not furnisher.furnish(self._rules.kind(area.kind).furniture):
                return None
            furniture += furnisher.items
        self._lift_from_rugs(furniture)
        laid = lay_things(furniture, self._rules, self._stock, dice("things"), namer)
        return _Draft(
            kind=kind, file=file, seed=seed, attempt=attempt, shell=shell, plan=plan,
            items=_beside_their_carriers(furniture, laid),
        )  # fmt: skip

    def _lift_from_rugs(self, items: Sequence[Item]) -> None:
        """Put what stands free on a rug upon it."""
        rugs = [item for item in items if item.is_flat]
        for item in items:
            if item.is_flat or "position" not in item.entry or item.block.low > 0.1:
                continue
            under = [rug for rug in rugs if _lies_under(rug, item)]
            if under:
                top = max(float(self._stock.bounds(r.asset, r.scale)[1, 2]) for r in under)
                x, y, _ = item.entry["position"]
                item.entry["position"] = [x, y, round(top + RUG_GAP_M, 4)]

    def _checked(self, draft: _Draft) -> GeneratedScene | None:
        """Take out what fails a check; None if that is something the room needs."""
        taken_out: list[Fault] = []
        for _ in range(MAX_ROUNDS):
            data = self._described(draft)
            world = self._built(draft.spec_of(data))
            try:
                found = list(faults(world))
                if not found:
                    found = list(unseen(world, draft.eyes()))
                if not found:
                    _with_cameras(data, world, draft)
            finally:
                world.close()
            if not found:
                spec = draft.spec_of(data)
                text = scene_text(spec, draft.kind, draft.seed, draft.items)
                return GeneratedScene(
                    kind=draft.kind, seed=draft.seed, spec=spec, text=text,
                    attempts=draft.attempt + 1, taken_out=tuple(taken_out),
                )  # fmt: skip
            for fault in found:
                if draft.settle(fault):
                    continue
                if not draft.take_out(fault.names):
                    return None
                taken_out.append(fault)
        return None

    def _described(self, draft: _Draft) -> dict[str, Any]:
        """Return a draft as a scene file has it, without agents."""

        def dice(purpose: str) -> Dice:
            return Dice(draft.kind, draft.seed, draft.attempt, purpose)

        rule = self._rules.light[dice("time of the day").one(draft.file.light)]
        objects = [item.described() for item in draft.items]
        data: dict[str, Any] = {
            "version": 1,
            "title": f"{draft.file.title} {draft.seed}",
            "environment": environment_entry(rule, dice("environment")),
            "lights": [],
            "room": draft.shell.entry,
            "objects": objects,
        }
        standing = SceneSpec.model_validate({**data})
        stock = {entry.name: self._stock.asset(entry.asset) for entry in standing.objects}
        poses = arranged(standing.objects, stock, standing.room)
        heights = {name: pose.position_m[2] for name, pose in poses.items()}
        lamps = light_entries(rule, draft.shell.windows, draft.items, heights, dice("lights"))
        data["lights"] = list(lamps)
        mover = mover_entry(draft.plan, draft.items, dice("way"), draft.file.speed)
        data["mover"] = mover
        draft.waypoints = [tuple(w["position"]) for w in mover["waypoints"]]
        return data

    def _built(self, spec: SceneSpec) -> World:
        # No check looks at the sky, which takes time to read.
        plain = spec.model_copy(update={"environment": EnvironmentSpec()})
        return build_world(
            plain,
            assets=self._stock.assets,
            categories=self._categories,
            seed=0,
            epoch=1,
            next_revision=itertools.count(1).__next__,
        )


@dataclass(slots=True, kw_only=True)
class _Draft:
    """A room that has not passed the checks yet."""

    kind: str
    file: KindFile
    seed: int
    attempt: int
    shell: Shell
    plan: RoomPlan
    items: list[Item]
    waypoints: Sequence[tuple[float, ...]] = ()

    def spec_of(self, data: dict[str, Any]) -> SceneSpec:
        """Return what a scene file says, checked."""
        return SceneSpec.model_validate({"name": f"{self.kind}_{self.seed}", **data})

    def settle(self, fault: Fault) -> bool:
        """Let a thing lie where it came to rest, once; say if it may."""
        item = next((i for i in self.items if i.name in fault.names), None)
        if item is None or fault.rests_at is None or item.name in self._settled:
            return False
        self._settled.add(item.name)
        kept = {key: item.entry[key] for key in ("scale",) if key in item.entry}
        position = [round(value, 4) for value in fault.rests_at.position_m]
        rotation = [round(value, 2) for value in fault.rests_at.rpy_deg]
        item.entry = {"position": position, "rotation": rotation, **kept}
        return True

    def take_out(self, names: Sequence[str]) -> bool:
        """Take out the least of some objects with what lies on it; say if that can be done."""
        present = [item for item in self.items if item.name in names]
        if not present:
            # Taken out already, with what carried it, or a part of the room alone.
            known = any(name in names for name in self._gone)
            return known
        loose = [item for item in present if not item.needed]
        if not loose:
            return False
        # Things go before furniture, the last placed first.
        victim = max(loose, key=lambda item: (item.rule is None, self.items.index(item)))
        gone = {victim.name}
        while True:
            more = {i.name for i in self.items if i.entry.get("on") in gone} - gone
            if not more:
                break
            gone |= more
        self.items = [item for item in self.items if item.name not in gone]
        self._gone |= gone
        return True

    _gone: set[str] = field(default_factory=set)
    _settled: set[str] = field(default_factory=set)

    def eyes(self) -> list[tuple[float, float, float]]:
        """Return the places from which objects have to be seen: those that the camera comes by."""
        corners = [(x, y, 1.5) for x, y, *_ in self.waypoints]
        between = [
            ((a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0, 1.5)
            for a, b in zip(corners, [*corners[1:], *corners[:1]], strict=True)
            if math.dist(a, b) > 1.0
        ]
        return [*corners, *between]


def _with_cameras(data: dict[str, Any], world: World, draft: _Draft) -> None:
    """Add agents to a scene, and begin the camera's way where its view is best."""
    with standing(world) as scene:
        mover = data["mover"]
        mover["waypoints"] = best_first(scene, mover["waypoints"])
        rooms = len(draft.shell.areas)
        data["agents"] = agent_entries(scene, max(2, rooms), draft.seed)


def _lies_under(rug: Item, item: Item) -> bool:
    flat = [
        type(b)(x=b.x, y=b.y, half_x=b.half_x, half_y=b.half_y, yaw_rad=b.yaw_rad)
        for b in (rug.block, item.block)
    ]
    return flat[0].meets(flat[1])


def _beside_their_carriers(furniture: Sequence[Item], laid: Iterable[Item]) -> list[Item]:
    """Return all objects, things right after what carries them."""
    on: dict[str, list[Item]] = {}
    for thing in laid:
        on.setdefault(thing.entry["on"], []).append(thing)
    return [each for item in furniture for each in (item, *on.get(item.name, ()))]
