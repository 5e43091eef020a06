"""An `ImportedScene` → a pack and a scene file, both or none."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sailenv_content.scene_import.imported import ImportedScene
from sailenv_ros.assets.pack import PackContent
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.errors import AssetError, InvalidRequest
from sailenv_ros.scene.dumper import dump_scene
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.system.files import replaced_folder, storage_errors, write_file

__all__ = ["scene_text", "write_scene"]

SCHEMA_LINE = "# yaml-language-server: $schema=scene.schema.json\n"


def write_scene(
    scene: ImportedScene, file: Path, pack_folder: Path, *, overwrite: bool = False
) -> None:
    """Write a pack and a scene file.

    Parameters
    ----------
    scene : ImportedScene
    file : Path
        Of the scene; must not exist, unless `overwrite` is set.
    pack_folder : Path
        The same; an empty scene has none.

    Raises
    ------
    InvalidRequest
        If one of them exists; nothing is written then.
    AssetError
        If the scene cannot be a scene file.
    StorageError
        If they cannot be written; nothing is left behind.
    """
    for what, path in (("scene file", file), ("pack folder", pack_folder)):
        if path.exists() and not overwrite:
            raise InvalidRequest(what, str(path), "one that does not exist, or to be overwritten")
    text = scene_text(scene)
    had_pack = pack_folder.exists()
    if scene.assets:
        with (
            storage_errors("the imported models", pack_folder),
            replaced_folder(pack_folder) as draft,
        ):
            _write_pack(scene, draft)
    try:
        with storage_errors("the imported scene", file):
            write_file(file, text.encode("utf-8"), overwrite=overwrite)
    except BaseException:
        if scene.assets and not had_pack:
            shutil.rmtree(pack_folder, ignore_errors=True)
        raise


def scene_text(scene: ImportedScene) -> str:
    """Return the text of the scene file.

    Raises
    ------
    AssetError
        If an entry breaks the format, e.g. a colour of a light.
    """
    data: dict[str, Any] = {"version": 1, "title": scene.title[:80] or "Imported scene"}
    optional: Mapping[str, Any] = {
        "description": scene.description,
        "environment": scene.environment,
        "lights": scene.lights,
        "objects": scene.objects,
        "mover": scene.mover,
        "agents": scene.agents,
    }
    data.update({key: value for key, value in optional.items() if value})
    try:
        spec = SceneSpec.model_validate(data)
    except ValidationError as problem:
        first = problem.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        raise AssetError(scene.title, f"it cannot be a scene: {place} {first['msg']}") from None
    return SCHEMA_LINE + dump_scene(spec)


def _write_pack(scene: ImportedScene, folder: Path) -> None:
    entries = []
    for asset in scene.assets:
        try:
            entry = packed(
                folder,
                asset.name,
                asset.parts,
                asset.hulls,
                display_name=asset.display_name,
                category=asset.category,
                mass=asset.mass_kg,
                collision="hulls" if asset.hulls else "none",
                author=asset.author,
                licence=asset.licence,
                source=asset.source,
            )
        except ValidationError as problem:
            why = problem.errors()[0]
            raise AssetError(asset.name, f"{why['loc']}: {why['msg']}") from None
        entries.append(entry)
    content = PackContent(version=1, title=scene.title[:300], assets=tuple(entries))
    write_content(folder, content)
