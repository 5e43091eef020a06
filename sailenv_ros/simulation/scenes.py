"""Builds worlds from scene files, the asset library and the category table."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from hashlib import blake2b
from pathlib import Path
from typing import Any

from sailenv_ros.agents import AgentSpec
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.fit import ObjectFit
from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.material_stock import MaterialStock
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.pack import PACK_FILE, AssetPack
from sailenv_ros.assets.pictures import Pictures
from sailenv_ros.assets.skies import sky_files
from sailenv_ros.assets.sources import BUILD_COMMAND, installed_packs, installed_sources
from sailenv_ros.assets.surfaces import surface_names
from sailenv_ros.bake.settings import BAKE_VERSION
from sailenv_ros.behaviours import (
    behaviour_errors,
    known_behaviour_errors,
    readable_behaviour_errors,
    refusing_behaviour_errors,
)
from sailenv_ros.behaviours.durations import lesson_errors
from sailenv_ros.errors import InvalidState
from sailenv_ros.generation import PREFIX as GENERATED
from sailenv_ros.labels import CategoryTable
from sailenv_ros.lights import Environment, Light
from sailenv_ros.model import Asset, Model
from sailenv_ros.scene.entries import (
    checked_lessons,
    checked_object,
    checked_objects,
    checked_scene,
    free_name,
)
from sailenv_ros.scene.loader import SceneKnowledge, load_scene
from sailenv_ros.scene.scene_catalogue import SceneCatalogue
from sailenv_ros.scene.serialisation import light_entry
from sailenv_ros.scene.spec import EnvironmentSpec, ObjectSpec, SceneSpec
from sailenv_ros.scene.user_scenes import user_scene_folder
from sailenv_ros.simulation.generated_scenes import GeneratedScenes
from sailenv_ros.simulation.light_cache import LightCache
from sailenv_ros.simulation.scenario import NOTHING_MORE, Additions
from sailenv_ros.viewpoints.rule_table import rule_errors
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.build import build_world, make_environment, make_placement
from sailenv_ros.world.world import World

__all__ = ["DEFAULT_SCENE", "SCENE_WITHOUT_FURNITURE", "SceneLibrary", "default_scene"]

MAX_UPLOADS = 256
"""Models that users may add, so that they cannot fill the memory without end."""

DEFAULT_SCENE = "room_01"
SCENE_WITHOUT_FURNITURE = "optical"

_log = logging.getLogger(__name__)


def default_scene() -> str:
    """Return the scene to begin with if none is asked for.

    `DEFAULT_SCENE`, or one without furniture where that has not been built, with a warning.
    """
    if any(pack.folder == standard_pack_folder() for pack in installed_packs()):
        return DEFAULT_SCENE
    _log.warning(
        "beginning with the scene %s, because %s needs the furniture; fetch it with: %s",
        SCENE_WITHOUT_FURNITURE,
        DEFAULT_SCENE,
        BUILD_COMMAND,
    )
    return SCENE_WITHOUT_FURNITURE


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
        self._own_folder = Path(scene_paths[0]) if scene_paths else user_scene_folder()
        self._catalogue = SceneCatalogue(dict.fromkeys((*scene_paths, user_scene_folder())))
        self._open_packs()
        self._assets = AssetLibrary(installed_sources(self._packs))
        self._light_cache = LightCache(wanted=baked_light, drafts=drafts, required=require_light)
        self._generated = GeneratedScenes(self._assets)
        self._uploads = 0
        self._uploaded: set[str] = set()
        self._unkept: set[str] = set()
        self._files: dict[str, Path] = {}
        self._scene_folders: dict[str, Path] = {}
        self.pictures = Pictures()
        self._agents: dict[str, tuple[AgentSpec, ...]] = {}

    @property
    def scene_names(self) -> tuple[str, ...]:
        """Names that `build` takes; files that were built from are among them."""
        names = self._catalogue.names
        return (*names, *(name for name in self._files if name not in names))

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
        added = [entry.to_category() for pack in self._packs for entry in pack.content.categories]
        return CategoryTable([*load_categories().values(), *added])

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
            surfaces=surface_names(),
            skies=tuple(self._skies),
        )

    @property
    def _knowledge_of_strangers(self) -> SceneKnowledge:
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
        known = self._with_materials(self.knowledge, self._stock_beside(path))
        return load_scene(path, knowledge=known)

    def build(
        self,
        scene: str | Path,
        seed: int,
        epoch: int,
        next_revision: Callable[[], int],
        *,
        more: Additions = NOTHING_MORE,
    ) -> World:
        """Build the world of a scene, with `more` objects and lessons than it has by itself.

        Uses the furniture that is built by now. See `load`, `scene.entries.checked_objects` and
        `world.build.build_world` for errors.
        """
        if _standard_pack_version() != self._pack_version:
            self.refresh()
        path = self.path(scene)
        known = self._with_materials(self._knowledge_to_build, self._stock_beside(path))
        spec = load_scene(path, knowledge=known)
        self._scene_folders[spec.name] = path.absolute().parent
        spec = spec.model_copy(
            update={"objects": (*spec.objects, *self._described(more.objects, spec))}
        )
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
            skies=self._skies,
            materials=self.materials_of(spec.name),
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

    def refresh(self) -> None:
        """Take up what was built since this was made: furniture, skies and the user's packs."""
        self._open_packs()
        self._assets.renew(installed_sources(self._packs))

    def load_light(self, world: World) -> None:
        """Load the light that was baked since a world was built, if there is any."""
        if not self._light_cache.is_final(world):
            self._load_light(world, world.scene)

    def stamp(self, scene: str | Path) -> str:
        """Return a text that changes with the scene's file and with the packs it may use.

        Raises
        ------
        UnknownName
            If there is no such scene.
        """
        digest = blake2b(digest_size=16)
        path = self.path(scene)
        digest.update(f"{path} {BAKE_VERSION}".encode())
        files = [path, *(pack.folder / PACK_FILE for pack in self._packs)]
        for file in files:
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
        return "" if name in self._uploaded else "of the package itself"

    def peek_asset(self, name: str) -> Asset:
        """Return an asset without keeping one that no world needs; see `AssetLibrary.get`."""
        return self._assets.peek(name)

    def drawn_model(self, asset: str) -> Model:
        """Return what is drawn of an instance; see `AssetLibrary.drawn_model`."""
        return self._assets.drawn_model(asset)

    def add_upload(self, asset: Asset, *, rename: bool) -> str:
        """Add a user's asset to the catalogue; return its name there.

        Parameters
        ----------
        rename : bool
            True appends a number to a name that is in use.

        Raises
        ------
        NameTaken
            If the name is in use and is to be kept.
        InvalidRequest
            If there are `MAX_UPLOADS` already.
        """
        if self._uploads >= MAX_UPLOADS:
            raise InvalidState(
                f"{MAX_UPLOADS} models have been uploaded, which is the most in a simulator's life"
            )
        taken = {*self._assets.all_names}
        names = ((asset.name, asset.display_name), *_numbered(asset)) if rename else ()
        for name, display_name in names:
            if not taken & {name, display_name}:
                asset = replace(asset, name=name, display_name=display_name)
                break
        self._assets.add(asset)
        self._uploads += 1
        self._uploaded.add(asset.name)
        self._unkept.add(asset.name)
        return asset.name

    def placement(
        self, entry: Mapping[str, Any], world: World, *, seed: int, start_s: float
    ) -> Placement:
        """Check an object's description and make of it what a world can spawn.

        Parameters
        ----------
        entry : mapping
            With the keys of an object in a scene file.
        world : World
            Its categories are those that the entry may name.
        seed : int
            Of its behaviours' generators.
        start_s : float
            Simulated time at which they start [s].

        Raises
        ------
        UnknownName, InvalidEntry, AssetError, InvalidRequest
            If it cannot be placed.
        """
        names = tuple(category.name for category in world.categories.values())
        stock = self.materials_of(world.scene)
        known = replace(self._knowledge_of_strangers, categories=names)
        spec = _checked_alone(entry, self._with_materials(known, stock))
        return make_placement(
            spec,
            self._assets.get(spec.asset),
            spec.pose,
            world.categories,
            seed,
            start_s=start_s,
            materials=stock,
        )

    def knowledge_of(self, scene: str) -> SceneKnowledge:
        """Return what a scene that was built may name, its pictures among it."""
        return self._with_materials(self.knowledge, self.materials_of(scene))

    def materials_of(self, scene: str) -> MaterialStock:
        """Return where the materials of a scene that was built come from."""
        return MaterialStock(self._assets, self.pictures, self._picture_folders(scene))

    def picture_content(self, picture: str, scene: str) -> bytes:
        """Return the bytes of a picture that a scene shows.

        Raises
        ------
        AssetError
            If it is there no more.
        """
        return self.pictures.content(picture, self._picture_folders(scene))

    def agents_of(self, scene: str) -> tuple[AgentSpec, ...]:
        """Return the agents that a scene that was built brings along."""
        return self._agents.get(scene, ())

    @property
    def own_folder(self) -> Path:
        """The folder that scenes are saved into."""
        return self._own_folder

    def is_uploaded(self, asset: str) -> bool:
        """Return whether an asset's model lies in no pack, so that a scene file cannot name it."""
        return asset in self._unkept

    def keep_model(self, asset: str) -> None:
        """Put an uploaded model into the user's own pack, so that scene files can name it.

        Raises
        ------
        NameTaken, AssetError
            If the pack cannot take it.
        """
        add_to_own_pack(self._assets.get(asset), source="uploaded to a running simulator")
        self._unkept.discard(asset)

    def path(self, scene: str | Path) -> Path:
        """Find a scene's file; see `load`.

        A name such as ``generated:kitchen:17`` is made first, if it has not been; see `generation`
        for errors.
        """
        if str(scene).startswith(GENERATED):
            return self._generated.path(str(scene))
        return self._files.get(str(scene)) or self._catalogue.path(scene)

    def environment(self, spec: EnvironmentSpec) -> Environment:
        """Return the surroundings that an entry describes.

        Raises
        ------
        UnknownName, AssetError
            If there is no such sky, or it cannot be read.
        """
        return make_environment(spec, self._skies)

    def check_lights(self, lights: Iterable[Light]) -> None:
        """Check that a scene file can describe these lights: names, ranges, number.

        Raises
        ------
        InvalidEntry
        """
        entries = [light_entry(light) for light in lights]
        checked_scene({"version": 1, "lights": entries}, self.knowledge, what="light")

    # -- inside ----------------------------------------------------------------------------

    def _open_packs(self) -> None:
        self._pack_version = _standard_pack_version()
        self._packs = installed_packs()
        self._skies = sky_files(pack.folder for pack in self._packs)

    def _picture_folders(self, scene: str) -> tuple[Path, ...]:
        """Return where pictures of a scene that was built lie: beside it, or beside saved ones."""
        beside = self._scene_folders.get(scene)
        return tuple(dict.fromkeys((beside or self._own_folder, self._own_folder)))

    def _stock_beside(self, path: Path) -> MaterialStock:
        return MaterialStock(
            self._assets, self.pictures, (path.absolute().parent, self._own_folder)
        )

    def _with_materials(self, known: SceneKnowledge, stock: MaterialStock) -> SceneKnowledge:
        return replace(known, material_fault=stock.fault, picture_fault=stock.picture_fault)

    def _load_light(self, world: World, scene: str) -> None:
        if world.described is not None and world.described.room is not None:
            self._light_cache.apply(world, scene)

    def _described(
        self, more: Sequence[Mapping[str, Any]], spec: SceneSpec
    ) -> tuple[ObjectSpec, ...]:
        """Check objects that come on top of a scene's; those without a name are given one."""
        taken = {entry.name for entry in spec.objects}
        named: list[Mapping[str, Any]] = []
        for entry in more:
            if isinstance(entry, Mapping) and entry.get("name") is None:
                asset = self.canonical_asset(str(entry.get("asset")))
                entry = {**entry, "name": free_name(asset, taken)}
            if isinstance(entry, Mapping):
                taken.add(str(entry["name"]))
            named.append(entry)
        own = tuple(category.name for category in spec.categories)
        known = self._with_materials(self._knowledge_of_strangers, self.materials_of(spec.name))
        return checked_objects(named, replace(known, categories=(*known.categories, *own)))


def _checked_alone(entry: Mapping[str, Any], known: SceneKnowledge) -> ObjectSpec:
    """Check an object beside which there are others: what its joint is on, the world knows."""
    joint = entry.get("joint") if isinstance(entry, Mapping) else None
    parent = joint.get("parent") if isinstance(joint, Mapping) else None
    if not isinstance(parent, str) or parent == entry.get("name"):
        return checked_object(entry, known)
    stands_in = {"name": parent, "asset": entry.get("asset"), "static": True}
    return checked_objects([entry, stands_in], known)[0]


def _standard_pack_version() -> tuple[int, int]:
    """Return what changes when the standard pack is built; zeros where there is none."""
    try:
        status = (standard_pack_folder() / PACK_FILE).stat()
    except OSError:
        return 0, 0
    return status.st_mtime_ns, status.st_ino


def _numbered(asset: Asset) -> Iterator[tuple[str, str]]:
    """Yield the asset's names with 2, 3, … at their end; more than there can be uploads."""
    for number in range(2, MAX_UPLOADS + 2):
        yield f"{asset.name}_{number}", f"{asset.display_name} {number}"
