"""Job of a worker, which it may get over a network: `Job`, made from a recipe's file."""

from __future__ import annotations

import hashlib
import importlib.metadata
import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sailenv_ros.assets.pack import PACK_FILE
from sailenv_ros.assets.sources import installed_packs
from sailenv_ros.dataset.identity import WorkIdentity
from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.recipe_checks import recipe_errors
from sailenv_ros.dataset.recipe_scenes import RecipeScenes
from sailenv_ros.errors import RecordingError, SceneError
from sailenv_ros.light.bake.settings import BAKE_VERSION
from sailenv_ros.scene.documents import load_document
from sailenv_ros.scene.scene_diagnostics import Diagnostic, model_diagnostics
from sailenv_ros.simulation.generated_scenes import generation_state
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.version import __version__

__all__ = ["JOB_FILE", "Job", "RecipeError", "load_job", "load_recipe"]


JOB_FILE = "job.json"
"""Settings that decide on every byte of a data set; written first."""


class RecipeError(SceneError):
    """A recipe of a data set with errors: all of them, in the order of the file."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Job:
    """A recipe and what it names.

    Attributes
    ----------
    recipe : DatasetRecipe
    recipe_text : str
        As it was written.
    scene_texts : mapping of str to str
        Of the scenes that it names by files, by these names.
    scene_hashes : mapping of str to str
        SHA-256 of all the scenes' files, by their names.
    packs : mapping of str to str
        SHA-256 of the content lists of the installed packs, by the folders' names.
    generation : str
        Changes with the rules of generated scenes; empty where there are none.
    """

    recipe: DatasetRecipe
    recipe_text: str
    scene_texts: Mapping[str, str]
    scene_hashes: Mapping[str, str]
    packs: Mapping[str, str]
    generation: str

    @property
    def head(self) -> dict[str, Any]:
        """Everything that decides on the bytes of the data set, as JSON holds it."""
        has_zstd = any("zstd" in one.kind for one in self.recipe.compression)
        return {
            "recipe": self.recipe.model_dump(mode="json", exclude_defaults=True),
            "sailenv_ros": __version__,
            "bake": BAKE_VERSION,
            "scenes": dict(self.scene_hashes),
            "packs": dict(self.packs),
            "generation": self.generation,
            "numpy": importlib.metadata.version("numpy"),
            "opencv": importlib.metadata.version("opencv-python-headless"),
            **({"zstandard": importlib.metadata.version("zstandard")} if has_zstd else {}),
        }

    @property
    def identity(self) -> WorkIdentity:
        """By which a data set that was interrupted is continued."""
        return WorkIdentity(file=JOB_FILE, settings=self.head, document=self.to_json(), key="head")

    @property
    def fingerprint(self) -> str:
        """SHA-256 of `head`."""
        return hashlib.sha256(json.dumps(self.head, sort_keys=True).encode()).hexdigest()

    def to_json(self) -> bytes:
        """Return the text of the data set's file that tells all of it."""
        value = {
            "fingerprint": self.fingerprint,
            "head": self.head,
            "recipe": self.recipe_text,
            "scene_texts": dict(self.scene_texts),
        }
        return (json.dumps(value, indent=1, sort_keys=True) + "\n").encode()

    @classmethod
    def from_json(cls, data: bytes, path: str) -> Job:
        """Return the job that `to_json` told, with the scenes and furniture of its own machine.

        Raises
        ------
        RecordingError
            If it is something else.
        """
        try:
            value = json.loads(data)
            head = value["head"]
            return cls(
                recipe=DatasetRecipe.model_validate(head["recipe"]),
                recipe_text=str(value["recipe"]),
                scene_texts=dict(value["scene_texts"]),
                scene_hashes=dict(head["scenes"]),
                packs=dict(head["packs"]),
                generation=str(head["generation"]),
            )
        except (ValueError, KeyError, TypeError) as problem:
            raise RecordingError(f"{path} is no job of a data set: {problem}") from None

    def check_machine(self) -> None:
        """Refuse a machine on which something else would come out.

        Raises
        ------
        RecordingError
            If the furniture or a scene differ from those where the job was made.
        """
        if dict(self.packs) != _packs():
            raise RecordingError("this machine has other furniture than the job was made with")
        if self.generation and self.generation != generation_state():
            raise RecordingError("this machine has other rules for generated scenes")
        own = {name for name in self.scene_hashes if name not in self.scene_texts}
        library = SceneLibrary()
        for name in sorted(own):
            if _hash(library.path(name).read_bytes()) != self.scene_hashes[name]:
                raise RecordingError(f"this machine has another scene {name}")


def load_recipe(path: Path) -> DatasetRecipe:
    """Read and check a recipe, and every scene that it names.

    Raises
    ------
    RecipeError
        All errors, in the order of the file.
    """
    return load_job(path).recipe


def job_of(recipe: str | Path | Job) -> Job:
    """Return the job of a recipe's file; errors as of `load_job`."""
    return recipe if isinstance(recipe, Job) else load_job(Path(recipe))


def load_job(path: Path) -> Job:
    """Read and check a recipe and what it names; makes nothing but generated scenes.

    Raises
    ------
    RecipeError
        All errors, in the order of the file: of values, names, choices of objects and packages
        that are not installed; those of its scenes' files after them.
    """
    scenes = RecipeScenes(path.parent)

    def find_errors(data: dict[str, Any], error: ValidationError | None) -> Iterator[Diagnostic]:
        yield from model_diagnostics(DatasetRecipe, data, error)
        yield from recipe_errors(data, path, scenes)

    try:
        recipe = load_document(
            path, DatasetRecipe, "a recipe", find_errors=find_errors, error=RecipeError
        )
    except RecipeError as problem:
        raise RecipeError([*problem.diagnostics, *scenes.problems]) from None
    if scenes.problems:
        raise RecipeError(scenes.problems)
    hashes = {name: _hash(file.content) for name, file in scenes.files.items()}
    texts = {
        name: file.content.decode("utf-8-sig")
        for name, file in scenes.files.items()
        if file.is_beside
    }
    return Job(
        recipe=recipe,
        recipe_text=path.read_text(encoding="utf-8-sig"),
        scene_texts=texts,
        scene_hashes=dict(sorted(hashes.items())),
        packs=_packs(),
        generation=generation_state() if any(one.generate for one in recipe.scenes) else "",
    )


def _packs() -> dict[str, str]:
    return {
        pack.folder.name: _hash((pack.folder / PACK_FILE).read_bytes())
        for pack in installed_packs()
    }


def _hash(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()
