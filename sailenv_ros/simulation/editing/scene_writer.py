"""The present world as a scene file: its text, and the file in the user's own folder.

A world and its agents in, YAML text or a path out. Writes whole files or none.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from pathlib import Path
from typing import Any

from sailenv_ros.assets.pictures import PICTURE_FOLDER
from sailenv_ros.errors import InvalidEntry, InvalidRequest
from sailenv_ros.scene.dumper import dump_scene
from sailenv_ros.scene.entries import checked_scene
from sailenv_ros.scene.loader import MAX_BYTES
from sailenv_ros.scene.user_scenes import checked_scene_name, write_scene
from sailenv_ros.simulation.editing.saving import (
    described_world,
    unserialisable_changes,
    uploaded_models,
)
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.system.files import make_folder, write_file

__all__ = ["SceneWriter"]


class SceneWriter:
    """Writes the world of one simulation; `operations.saving_operations` tells of the errors."""

    def __init__(self, scene: LiveScene) -> None:
        self._scene = scene

    def text(self, name: str, title: str | None, cameras: Collection[str]) -> str:
        """Return the YAML text of the present world under a scene's name."""
        world, what = self._scene.world, f"scene {name!r}"
        data: dict[str, Any] = described_world(world, self._scene.agents, cameras=cameras)
        if title:
            data["title"] = title
        lost = list(unserialisable_changes(world))
        if lost:
            raise InvalidEntry(what, name, lost)
        text = dump_scene(
            checked_scene(data, self._scene.library.knowledge_of(world.scene), what=what)
        )
        if len(text.encode()) > MAX_BYTES:
            raise InvalidRequest("size of the scene", len(text), f"at most {MAX_BYTES} bytes")
        return text

    def save(
        self,
        name: str,
        *,
        overwrite: bool,
        title: str | None,
        cameras: Collection[str],
        keep_models: bool,
    ) -> Path:
        """Write the present world into the folder of the user's own scenes."""
        library = self._scene.library
        path = self._own_path(name)
        text = self.text(name, title, cameras)
        models = uploaded_models(self._scene.world, library.uploads.is_unkept)
        if models and not keep_models:
            named = ", ".join(repr(model) for model in models)
            accepted = "true, so that uploaded models are put into your own pack: no scene file "
            raise InvalidRequest(
                "keep_models", keep_models, f"{accepted}can name {named} otherwise"
            )
        if path.exists() and not overwrite:
            accepted = "one that no file has yet, unless it shall be overwritten"
            raise InvalidRequest("scene name", name, accepted)
        pictures = self._pictures(path.parent)
        for model in models:
            library.uploads.keep(model)
        for file, content in pictures.items():
            make_folder(file.parent)
            write_file(file, content)
        write_scene(path.parent, name, text, overwrite=overwrite)
        return path

    def _pictures(self, folder: Path) -> dict[Path, bytes]:
        """Return the files of pictures that must lie beside the scene and do not yet."""
        world, library = self._scene.world, self._scene.library
        data = described_world(world, self._scene.agents)
        missing: dict[Path, bytes] = {}
        for name in sorted(set(_picture_names(data))):
            content = library.materials.picture_content(name, world.scene)
            places = (folder / name, folder / PICTURE_FOLDER / name)
            present = next((file.read_bytes() for file in places if file.is_file()), None)
            if present is None:
                missing[places[1]] = content
            elif present != content:
                accepted = f"one that no other picture in {folder} has"
                raise InvalidRequest("name of the picture", name, accepted)
        return missing

    def _own_path(self, name: str) -> Path:
        """Return the file of a scene of the user's own; no other scene may have its name."""
        library = self._scene.library
        path = library.own_folder.absolute() / f"{checked_scene_name(name)}.yaml"
        if name in library.scene_names:
            other = library.path(name).absolute()
            if other != path:
                accepted = f"another than that of the scene {other}, which would be hidden"
                raise InvalidRequest("scene name", name, accepted)
        return path


def _picture_names(data: Any) -> Iterator[str]:
    """Yield the names of the pictures that materials show, however deep they lie."""
    if isinstance(data, Mapping):
        if isinstance(data.get("picture"), str):
            yield data["picture"]
        data = list(data.values())
    if isinstance(data, list):
        for part in data:
            yield from _picture_names(part)
