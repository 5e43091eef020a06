"""Builds worlds from scene files, the asset library and the category table."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import replace
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.fit import ObjectFit
from sailenv_ros.assets.material_library import MaterialLibrary
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.assets.robots import RobotStore
from sailenv_ros.assets.surfaces import surface_names
from sailenv_ros.authoring.room_rules.names import FORM, PREFIX
from sailenv_ros.authoring.viewpoints.rule_table import rule_errors
from sailenv_ros.behaviours import (
    behaviour_errors,
    known_behaviour_errors,
    readable_behaviour_errors,
    refusing_behaviour_errors,
)
from sailenv_ros.behaviours.durations import lesson_errors
from sailenv_ros.light.bake.settings import BAKE_VERSION
from sailenv_ros.light.relight.baked_scene_store import BakedSceneStore
from sailenv_ros.scene.entries import checked_lessons, checked_objects, checked_scene
from sailenv_ros.scene.loader import SceneKnowledge, load_scene
from sailenv_ros.scene.scene_catalogue import SceneCatalogue
from sailenv_ros.scene.serialisation import light_entry
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec, SceneSpec
from sailenv_ros.scene.user_scenes import user_scene_folder
from sailenv_ros.simulation.entry_checks import checked_alone, named_entries
from sailenv_ros.simulation.generated_scenes import GeneratedScenes
from sailenv_ros.simulation.light_cache import LightCache
from sailenv_ros.simulation.models.uploaded_models import UploadedModels
from sailenv_ros.simulation.open_packs import OpenPacks
from sailenv_ros.simulation.robot_entries import with_full_paths
from sailenv_ros.simulation.scene_materials import SceneMaterials
from sailenv_ros.simulation.script.scenario import NOTHING_MORE, SceneOverlay
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Asset
from sailenv_ros.types.snapshot import WorldSnapshot
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.build import build_world, make_environment, make_placement
from sailenv_ros.world.opening_pieces import as_placed
from sailenv_ros.world.world import World

__all__ = ["SceneLibrary"]


class SceneLibrary:
    """Every scene that can be built, by name.

    Parameters
    ----------
    scene_paths : sequence of Path
        More folders with scenes, beside the user's and the package's own. Scenes are saved into
        the first of them, or into the user's where there is none.
    allow_modules : bool
        True lets scene files have behaviours of Python modules (``module:name``), whose code runs
        when the scene is built.
    baked_light : bool
        False leaves worlds without baked light, whether there is any or not.
    drafts : bool
        False takes no rough light in the meantime, while a bake is not finished.
    require_light : bool
        True refuses to build rooms whose light is not baked.

    Attributes
    ----------
    own_folder : Path
        Scenes are saved into it.
    baked_scenes, robots : BakedSceneStore, RobotStore
    uploads, materials : UploadedModels, SceneMaterials
    pictures : Pictures
        Those that were sent.
    """

    def __init__(
        self,
        scene_paths: Sequence[Path] = (),
        *,
        allow_modules: bool = False,
        baked_light: bool = True,
        drafts: bool = True,
        require_light: bool = False,
    ) -> None:
        self._allow_modules = allow_modules
        self.own_folder = Path(scene_paths[0]) if scene_paths else user_scene_folder()
        self._catalogue = SceneCatalogue(dict.fromkeys((*scene_paths, user_scene_folder())))
        self._packs, self.robots = OpenPacks(), RobotStore()
        self._assets = AssetLibrary((*self._packs.sources(), self.robots))
        self._light_cache = LightCache(wanted=baked_light, drafts=drafts, required=require_light)
        self.baked_scenes = BakedSceneStore()
        self._generated = GeneratedScenes(self._assets)
        self.uploads = UploadedModels(self._assets)
        self._files: dict[str, Path] = {}
        self.materials = SceneMaterials(self._assets, self.own_folder)
        self.pictures = self.materials.pictures
        self._agents: dict[str, tuple[AgentSpec, ...]] = {}

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names that `build` takes; files that were built from are among them."""
        names = self._catalogue.names
        return (*names, *(name for name in self._files if name not in names))

    @property
    def assets(self) -> AssetLibrary:
        """All assets that its scenes may name."""
        return self._assets

    @property
    def spawnables(self) -> tuple[str, ...]:
        """Names of the assets."""
        return self._assets.names

    @property
    def spawnable_display_names(self) -> tuple[str, ...]:
        """Names of the assets as people write them, in the same order."""
        return tuple(self._assets.display_names.values())

    @cached_property
    def categories(self) -> CategoryTable:
        """The fixed table, and what the packs add to it."""
        return self._packs.categories()

    @property
    def knowledge(self) -> SceneKnowledge:
        """Names that a scene file may refer to; no code of a file is run."""
        return SceneKnowledge(
            assets=self._assets.all_names,
            categories=tuple(category.name for category in self.categories.values()),
            behaviour_errors=readable_behaviour_errors,
            object_errors=ObjectFit(self._assets),
            lesson_errors=lesson_errors,
            camera_errors=rule_errors,
            category_of=self._assets.category_of,
            surfaces=surface_names(),
            skies=tuple(self._packs.skies),
        )

    @property
    def _untrusted_context(self) -> SceneKnowledge:
        """Names that requests may refer to: unlike files, they cannot have code imported."""
        return replace(self.knowledge, behaviour_errors=known_behaviour_errors)

    @property
    def _knowledge_to_build(self) -> SceneKnowledge:
        """Names that a scene to be built may refer to: code of modules where that is allowed."""
        errors = behaviour_errors if self._allow_modules else refusing_behaviour_errors
        return replace(self.knowledge, behaviour_errors=errors)

    def load(self, scene: str | Path) -> SceneSpec:
        """Read a scene by its name or file, every error at once; runs no code that it names.

        Raises
        ------
        UnknownName
            If there is no such scene.
        SceneError
            If its file has errors.
        """
        path = self.path(scene)
        known = self._with_materials(self.knowledge, self.materials.beside(path))
        return load_scene(path, knowledge=known)

    def build(
        self,
        scene: str | Path,
        seed: int = 0,
        epoch: int = 1,
        next_revision: Callable[[], int] | None = None,
        *,
        more: SceneOverlay = NOTHING_MORE,
    ) -> World:
        """Build the world of a scene, with `more` objects and lessons than it has by itself.

        Uses the furniture that is built by now. See `load`, `scene.entries.checked_objects` and
        `world.build.build_world` for errors, `World` for epoch and revisions.
        """
        if not self._packs.are_newest:
            self.refresh()
        path = self.path(scene)
        known = self._with_materials(self._knowledge_to_build, self.materials.beside(path))
        spec = with_full_paths(load_scene(path, knowledge=known), path.parent)
        self.materials.note(spec.name, path)
        if spec.room is not None:
            self._light_cache.prefetch(self.stamp(scene))
        objects = (*spec.objects, *self._added(more.objects, spec))
        spec = spec.model_copy(update={"objects": objects})
        if more.lessons is not None:
            lessons = checked_lessons(more.lessons, spec.objects, known)
            spec = spec.model_copy(update={"lessons": lessons})
        world = build_world(
            spec,
            assets=self._assets,
            categories=self.categories,
            seed=seed,
            epoch=epoch,
            next_revision=next_revision,
            skies=self._packs.skies,
            materials=self.materials.of(spec.name),
            robots={one.name: self.robots.find(one.file) for one in spec.robots},
        )
        try:
            self._load_light(world, str(scene))
        except BaseException:
            world.close()
            raise
        self._agents[spec.name] = tuple(agent.to_agent_spec() for agent in spec.agents)
        if spec.name not in self._catalogue.names:
            self._files[spec.name] = self.path(scene)
        return world

    def snapshot(self, scene: str | Path) -> WorldSnapshot:
        """Return a scene as it begins; errors as of `build`."""
        with closing(self.build(scene)) as world:
            return world.snapshot()

    def refresh(self) -> None:
        """Take up what was built since this was made: furniture, skies and the user's packs."""
        self._packs = OpenPacks()
        self._assets.renew((*self._packs.sources(), self.robots))

    def load_light(self, world: World) -> None:
        """Load the light that was baked since a world was built, if there is any."""
        if not self._light_cache.is_final(world):
            self._load_light(world, world.scene)

    def stamp(self, scene: str | Path) -> str:
        """Return a text that changes with the scene's file and with the packs it may use."""
        path = self.path(scene)
        digest = blake2b(f"{path} {BAKE_VERSION}".encode(), digest_size=16)
        for file in (path, *self._packs.files):
            if file.is_file():
                digest.update(file.read_bytes())
        return digest.hexdigest()

    def canonical_asset(self, name: str) -> str:
        """Return the catalogue name of an asset's catalogue or display name.

        Raises
        ------
        UnknownName
            If there is no such asset.
        """
        return self._assets.canonical(name)

    def asset_fingerprint(self, name: str) -> str:
        """Return what changes whenever an asset does; empty for one that came to this simulator."""
        source = self._assets.source(name)
        if isinstance(source, AssetPack):
            return source.fingerprint(name)
        return "" if name in self.uploads else "of the package itself"

    def peek_asset(self, name: str) -> Asset:
        """Return an asset without keeping one that no world needs; see `AssetLibrary.get`."""
        return self._assets.peek(name)

    def placement(
        self, entry: Mapping[str, Any], pose: Pose, world: World, *, seed: int, start_s: float,
        shut: bool = False,
    ) -> Placement:  # fmt: skip
        """Check an object's description and make of it what a world can spawn.

        Parameters
        ----------
        entry : mapping
            With the keys of an object in a scene file, but for those of its place.
        pose : Pose
        world : World
            Its categories are those that the entry may name.
        seed, start_s
            As of `world.build.make_placement`; see it for errors.
        shut : bool
            True keeps what opens of a piece in its body.
        """
        names = tuple(category.name for category in world.categories.values())
        stock = self.materials.of(world.scene)
        known = replace(self._untrusted_context, categories=names)
        spec = checked_alone(entry, self._with_materials(known, stock)).placed(pose)
        asset = self._assets.get(spec.asset)
        placed = asset if shut else as_placed(spec, asset)
        return make_placement(
            spec, placed, pose, world.categories, seed, start_s=start_s, materials=stock
        )

    def knowledge_of(self, scene: str) -> SceneKnowledge:
        """Return what a scene that was built may name, its pictures among it."""
        return self._with_materials(self.knowledge, self.materials.of(scene))

    def agents_of(self, scene: str) -> tuple[AgentSpec, ...]:
        """Return the agents that a scene that was built brings along."""
        return self._agents.get(scene, ())

    def path(self, scene: str | Path) -> Path:
        """Find a scene's file; see `load`.

        ``generated:kitchen:17`` is made first, if it has not been; see `generation` for errors.
        """
        if str(scene).startswith(PREFIX):
            return self._generated.path(str(scene))
        return self._files.get(str(scene)) or self._catalogue.path(scene, also=FORM)

    def environment(self, spec: EnvironmentSpec) -> Environment:
        """Return the surroundings that an entry describes.

        Raises
        ------
        UnknownName, AssetError
            If there is no such sky, or it cannot be read.
        """
        return make_environment(spec, self._packs.skies)

    def check_lights(self, lights: Iterable[Light]) -> None:
        """Check that a scene file can describe these lights: names, ranges, number.

        Raises
        ------
        InvalidEntry
        """
        entries = [light_entry(light) for light in lights]
        checked_scene({"version": 1, "lights": entries}, self.knowledge, what="light")

    # -- inside ----------------------------------------------------------------------------

    def _with_materials(self, known: SceneKnowledge, stock: MaterialLibrary) -> SceneKnowledge:
        return replace(known, material_fault=stock.fault, picture_fault=stock.picture_fault)

    def _load_light(self, world: World, scene: str) -> None:
        if world.described is not None and world.described.room is not None:
            self._light_cache.apply(world, scene)

    def _added(
        self, entries: Sequence[Mapping[str, Any]], spec: SceneSpec
    ) -> tuple[ObjectSpec, ...]:
        """Check objects that come on top of a scene's; those without a name are given one."""
        named = named_entries(entries, (entry.name for entry in spec.objects), self.canonical_asset)
        own = tuple(category.name for category in spec.categories)
        known = self._with_materials(self._untrusted_context, self.materials.of(spec.name))
        return checked_objects(named, replace(known, categories=(*known.categories, *own)))
