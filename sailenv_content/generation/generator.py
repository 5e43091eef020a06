"""Rooms from a seed: shape, openings, furniture, things, light, the camera's way, checks, a file.

A kind of room and a number in; a scene file's text and its `SceneSpec` out. What fails a check is
taken out, or the room is drawn again, so what comes out has passed them all.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

from sailenv_content.generation.asset_index import AssetIndex
from sailenv_content.generation.checks import Fault, faults, look_backend, unseen
from sailenv_content.generation.draft import Draft
from sailenv_content.generation.furnishing import Furnisher
from sailenv_content.generation.items import Item, Namer
from sailenv_content.generation.lighting import environment_entry, light_entries, times_of
from sailenv_content.generation.pieces import PieceChooser
from sailenv_content.generation.plan import RoomPlan
from sailenv_content.generation.room_agents import StandingWorld, agent_entries, best_first
from sailenv_content.generation.route import mover_entry
from sailenv_content.generation.rugs import stand_on_rugs
from sailenv_content.generation.scene_text import scene_text
from sailenv_content.generation.shells import shell_of
from sailenv_content.generation.things import lay_things
from sailenv_content.generation.window_dressing import WindowDresser
from sailenv_ros.assets.arranging import arranged
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.authoring.room_rules.names import MAX_SEED
from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.authoring.room_rules.rule_files import Rules, rules_of
from sailenv_ros.authoring.room_rules.rule_models import KindFile
from sailenv_ros.errors import InvalidState
from sailenv_ros.render.contract import RenderBackend
from sailenv_ros.scene.room_rules import WALLS, room_part_names
from sailenv_ros.scene.spec import EnvironmentSpec, SceneSpec
from sailenv_ros.scene.spec_outside import OutsideSpec
from sailenv_ros.scene.spec_room import RoomSpec, SurfaceSpec, WallMaterialsSpec
from sailenv_ros.types.validation import checked_integer
from sailenv_ros.world.build import build_world
from sailenv_ros.world.world import World

__all__ = ["GeneratedScene", "Generator", "generate_scene"]

MAX_ATTEMPTS = 40
MAX_ROUNDS = 8
"""Greatest number of times that faulty objects are removed before the room is drawn again."""


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
        self._stock = AssetIndex(library)
        self._rules = rules_of() if rules is None else rules
        self._categories = load_categories()

    @property
    def rules(self) -> Rules:
        """The rules by which rooms are made."""
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
        with closing(look_backend()) as backend:
            for attempt in range(MAX_ATTEMPTS):
                draft = self._drafted(kind, file, seed, attempt)
                if draft is None:
                    continue
                made = self._checked(draft, backend)
                if made is not None:
                    return made
        raise InvalidState(
            f"{MAX_ATTEMPTS} rooms of kind {kind!r} with the seed {seed} have failed the checks; "
            "the rules leave too little space"
        )

    # -- inside ----------------------------------------------------------------------------

    def _drafted(self, kind: str, file: KindFile, seed: int, attempt: int) -> Draft | None:
        """Draw a room and furnish it; None if something that is needed has no place."""

        def dice(purpose: str) -> RandomStream:
            return RandomStream(kind, seed, attempt, purpose)

        shell = shell_of(kind, self._rules, dice("shell"))
        outside = dice("outside")
        shell.entry["outside"] = {
            "kind": outside.one(file.outside),
            "seed": outside.whole((0, 999)),
        }
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
            dresser = WindowDresser(
                area=area,
                plan=plan,
                rules=self._rules,
                stock=self._stock,
                dice=(window_dice := dice(f"windows of {area.name}")),
                pieces=PieceChooser(window_dice, furnisher.pieces.style),
                namer=namer,
            )
            furnisher.items += dresser.items()
            if not plan.connects(()):
                return None
            if not furnisher.furnish(self._rules.kind(area.kind).furniture):
                return None
            furniture += furnisher.items
        stand_on_rugs(furniture, self._stock)
        laid = lay_things(furniture, self._rules, self._stock, dice("things"), namer)
        return Draft(
            kind=kind, file=file, seed=seed, attempt=attempt, shell=shell, plan=plan,
            items=_beside_their_carriers(furniture, laid), stock=self._stock,
        )  # fmt: skip

    def _checked(self, draft: Draft, backend: RenderBackend) -> GeneratedScene | None:
        """Take out what fails a check; None if that is something the room needs."""
        taken_out: list[Fault] = []
        for _ in range(MAX_ROUNDS):
            data = self._described(draft)
            world = self._built(draft.spec_of(data))
            try:
                found = [*faults(world), *unseen(world, draft.eyes(), backend)]
                if not found:
                    _with_cameras(data, StandingWorld(world, backend), draft)
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

    def _described(self, draft: Draft) -> dict[str, Any]:
        """Return a draft as a scene file has it, without agents."""

        def dice(purpose: str) -> RandomStream:
            return RandomStream(draft.kind, draft.seed, draft.attempt, purpose)

        times = times_of(draft.file.light, self._rules.light, draft.items, draft.shell.areas)
        rule = self._rules.light[dice("time of the day").one(times)]
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
        lamps = light_entries(
            rule, draft.shell.windows, draft.items, heights, draft.shell.areas, dice("lights")
        )
        data["lights"] = list(lamps)
        mover = mover_entry(draft.plan, draft.items, dice("way"), draft.file.speed)
        data["mover"] = mover
        draft.waypoints = [tuple(w["position"]) for w in mover["waypoints"]]
        return data

    def _built(self, spec: SceneSpec) -> World:
        # No check looks at the sky or at materials, which take time to make.
        plain = spec.model_copy(
            update={"environment": EnvironmentSpec(), "room": _without_looks(spec.room)}
        )
        return build_world(
            plain,
            assets=self._stock.assets,
            categories=self._categories,
            seed=0,
            epoch=1,
            next_revision=itertools.count(1).__next__,
        )


def _with_cameras(data: dict[str, Any], scene: StandingWorld, draft: Draft) -> None:
    """Add agents to a scene, and begin the camera's way where its view is best."""
    mover = data["mover"]
    mover["waypoints"] = best_first(scene, mover["waypoints"])
    data["agents"] = agent_entries(scene, max(2, len(draft.shell.areas)), draft.seed)


def _without_looks(room: RoomSpec | None) -> RoomSpec | None:
    """Return a room of the same shape that is all of one material."""
    if room is None:
        return None
    one = SurfaceSpec()
    bare: dict[str, None] = dict.fromkeys(WALLS)
    return room.model_copy(
        update={
            "walls": one,
            "wall_materials": WallMaterialsSpec(),
            "floor": one,
            "ceiling": None if room.ceiling is None else one,
            "outside": OutsideSpec(),
            "partitions": tuple(each.model_copy(update=bare) for each in room.partitions),
            "floors": tuple(each.model_copy(update={"surface": one}) for each in room.floors),
        }
    )


def _beside_their_carriers(furniture: Sequence[Item], laid: Iterable[Item]) -> list[Item]:
    """Return all objects, things right after what carries them."""
    on: dict[str, list[Item]] = {}
    for thing in laid:
        on.setdefault(thing.entry["on"], []).append(thing)
    return [each for item in furniture for each in (item, *on.get(item.name, ()))]
