"""Where worlds come from: scene files, the asset library and the category table, joined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property
from pathlib import Path

from sailenv_ros.agents import AgentSpec
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.fit import ObjectFit
from sailenv_ros.assets.library import AssetLibrary
from sailenv_ros.assets.sources import installed_packs, installed_sources
from sailenv_ros.assets.surfaces import surface_names
from sailenv_ros.behaviours import behaviour_faults
from sailenv_ros.labels import CategoryTable
from sailenv_ros.scene.catalogue import SceneCatalogue
from sailenv_ros.scene.loader import SceneKnowledge, load_scene
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.world.build import build_world
from sailenv_ros.world.world import World

__all__ = ["DEFAULT_SCENE", "SceneLibrary"]

DEFAULT_SCENE = "optical"


class SceneLibrary:
    """Every scene that can be built, by name.

    Parameters
    ----------
    scene_paths : sequence of Path
        More folders with scenes, beside the package's own.
    """

    def __init__(self, scene_paths: Sequence[Path] = ()) -> None:
        self._catalogue = SceneCatalogue(scene_paths)
        self._packs = installed_packs()
        self._assets = AssetLibrary(installed_sources(self._packs))
        self._files: dict[str, Path] = {}
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

    @cached_property
    def categories(self) -> CategoryTable:
        """The fixed table, and what the packs add to it."""
        added = [entry.to_category() for pack in self._packs for entry in pack.content.categories]
        return CategoryTable([*load_categories().values(), *added])

    @cached_property
    def knowledge(self) -> SceneKnowledge:
        """What a scene file's names may refer to."""
        return SceneKnowledge(
            assets=self._assets.all_names,
            categories=tuple(category.name for category in self.categories.values()),
            behaviour_faults=behaviour_faults,
            object_faults=ObjectFit(self._assets),
            surfaces=surface_names(),
        )

    def load(self, scene: str | Path) -> SceneSpec:
        """Read a scene by its name or file; every fault at once.

        Raises
        ------
        UnknownName
            If there is no such scene.
        SceneError
            If its file has faults.
        """
        path = self._files.get(str(scene)) or self._catalogue.path(scene)
        return load_scene(path, knowledge=self.knowledge)

    def build(
        self, scene: str | Path, seed: int, epoch: int, next_revision: Callable[[], int]
    ) -> World:
        """Build the world of a scene; see `load` and `world.build.build_world` for errors."""
        spec = self.load(scene)
        world = build_world(
            spec,
            assets=self._assets,
            categories=self.categories,
            seed=seed,
            epoch=epoch,
            next_revision=next_revision,
        )
        self._agents[spec.name] = tuple(agent.to_agent_spec() for agent in spec.agents)
        if spec.name not in self._catalogue.names:
            self._files[spec.name] = self._catalogue.path(scene)
        return world

    def agents_of(self, scene: str) -> tuple[AgentSpec, ...]:
        """Give the agents that a scene that was built brings along."""
        return self._agents.get(scene, ())
