"""Scenes that a recipe names: files read and checked once, generated ones made when asked for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import zip_longest
from pathlib import Path
from typing import Any

from sailenv_ros.authoring.room_rules.names import PREFIX
from sailenv_ros.authoring.room_rules.rule_files import room_kinds
from sailenv_ros.dataset.scene_names import SceneNames
from sailenv_ros.errors import SceneDiagnostic, SceneError
from sailenv_ros.scene.scene_catalogue import SUFFIXES
from sailenv_ros.scene.scene_diagnostics import Diagnostic
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.validation import is_integer

__all__ = ["RecipeScenes", "SceneFile"]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class SceneFile:
    """A scene that a recipe names, as it was read.

    Attributes
    ----------
    path : Path
    content : bytes
    spec : SceneSpec
    is_beside : bool
        True for a file of the recipe's own, which travels with the job.
    """

    path: Path
    content: bytes
    spec: SceneSpec
    is_beside: bool


class RecipeScenes:
    """The scenes of one recipe.

    Parameters
    ----------
    folder : Path
        Of the recipe.

    Attributes
    ----------
    library : SceneLibrary
    files : mapping of str to SceneFile
        Scenes without errors, by the names that the recipe has for them.
    problems : list of SceneDiagnostic
        What is wrong in the scenes' own files.
    all_read : bool
        False if a scene is not there or has errors.
    """

    def __init__(self, folder: Path) -> None:
        self.library = SceneLibrary()
        self.files: dict[str, SceneFile] = {}
        self.problems: list[SceneDiagnostic] = []
        self.all_read = True
        self._folder = folder
        self._names = lru_cache(maxsize=None)(self._names_in)

    def read(self, data: Mapping[str, Any]) -> Iterator[Diagnostic]:
        """Read the scenes of a recipe's plain data; yield which there are not."""
        for index, entry in enumerate(_scene_entries(data)):
            name = entry.get("scene")
            if not isinstance(name, str) or name in self.files:
                continue
            beside = self._folder / name
            try:
                is_beside = beside.suffix in SUFFIXES
                path = self.library.path(beside if is_beside else name)
                spec, content = self.library.load(path), path.read_bytes()
            except SceneError as problem:
                self.all_read = False
                self.problems += problem.diagnostics
            except (ValueError, OSError) as problem:
                self.all_read = False
                yield Diagnostic(("scenes", index, "scene"), str(problem))
            else:
                self.files[name] = SceneFile(
                    path=path, content=content, spec=spec, is_beside=is_beside
                )

    def names(self, data: Mapping[str, Any]) -> Iterator[tuple[str, SceneNames]]:
        """Yield what may be chosen in each scene: files first, then generated ones in turn.

        A generated scene is made when its turn comes; the work needs it later, too.
        """
        for name, file in self.files.items():
            yield name, self._names(str(file.path))
        kinds = []
        for entry in _scene_entries(data):
            kind, seeds = entry.get("generate"), entry.get("seeds", (0, 0))
            ends = [seeds, seeds] if is_integer(seeds) else seeds
            is_range = isinstance(ends, list | tuple) and len(ends) == len(("first", "last"))
            if kind in room_kinds() and is_range and all(map(is_integer, ends)):
                kinds.append([f"{kind}:{seed}" for seed in range(ends[0], ends[1] + 1)])
        for turn in zip_longest(*kinds):
            for name in dict.fromkeys(one for one in turn if one is not None):
                yield name.replace(":", " "), self._names(f"{PREFIX}{name}")

    def _names_in(self, scene: str) -> SceneNames:
        return SceneNames.of(self.library.load(scene), self.library)


def _scene_entries(data: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the entries of `scenes`; one that is no mapping as an empty one."""
    listed = data.get("scenes")
    for entry in listed if isinstance(listed, list | tuple) else ():
        yield entry if isinstance(entry, Mapping) else {}
