"""The scene formats that can be imported, and the steps common to all, from file to file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TypeAlias

from sailenv_content.scene_import.gltf_scene import import_gltf
from sailenv_content.scene_import.imported import ImportedScene, Names
from sailenv_content.scene_import.robot_scene import import_robot_scene
from sailenv_content.scene_import.sweet_home import import_sweet_home
from sailenv_content.scene_import.usd_scene import import_usd
from sailenv_content.scene_import.writing import write_scene
from sailenv_ros.assets.folders import standard_pack_folder
from sailenv_ros.assets.importing import check_file
from sailenv_ros.assets.pack import PACK_FILE, AssetPack, PackEntry
from sailenv_ros.errors import AssetError, InvalidRequest
from sailenv_ros.scene.scene_catalogue import SUFFIXES

__all__ = ["IMPORTED_SUFFIXES", "ImportReport", "import_scene"]

Importer: TypeAlias = Callable[[Path, Names, Mapping[str, PackEntry]], ImportedScene]

_IMPORTERS: Mapping[str, Importer] = MappingProxyType(
    {
        ".sh3d": import_sweet_home,
        ".glb": import_gltf,
        ".gltf": import_gltf,
        ".usd": import_usd,
        ".usda": import_usd,
        ".usdc": import_usd,
        ".usdz": import_usd,
        ".urdf": import_robot_scene,
        ".xml": import_robot_scene,
        ".mjcf": import_robot_scene,
    }
)

IMPORTED_SUFFIXES = tuple(_IMPORTERS)


@dataclass(frozen=True, slots=True, kw_only=True)
class ImportReport:
    """Summary of an import.

    Attributes
    ----------
    file, pack_folder : Path
        Of the scene, and of the pack with its models.
    objects, models, ours, lights : int
        Placed objects; models in the pack; objects that are of our own pack; lights.
    notes : tuple of str
        What was left out or changed.
    """

    file: Path
    pack_folder: Path
    objects: int
    models: int
    ours: int
    lights: int
    notes: tuple[str, ...]


def import_scene(
    path: Path, file: Path, pack_folder: Path, *, overwrite: bool = False, own_models: bool = False
) -> ImportReport:
    """Import a scene of another program.

    Parameters
    ----------
    path : Path
        What is imported; its suffix says of which kind it is.
    file : Path
        Of the scene that is written.
    pack_folder : Path
        Of the pack that is written; to be among `assets.folders.pack_folders` for the scene to be
        loaded.
    overwrite : bool
        True replaces both.
    own_models : bool
        True takes no models of the standard pack.

    Raises
    ------
    InvalidRequest
        If the kind is not known, or a name cannot be used.
    AssetError
        If the file is malformed, too large or malicious.
    StorageError
        If something cannot be written. In every case nothing is left behind.
    """
    kind = path.suffix.lower()
    if kind not in _IMPORTERS:
        raise InvalidRequest("kind of file", path.name, f"one of: {', '.join(_IMPORTERS)}")
    if file.suffix not in SUFFIXES:
        raise InvalidRequest("name of the scene file", file.name, f"one that ends in {SUFFIXES[0]}")
    check_file(path)
    ours: Mapping[str, PackEntry] = {}
    if not own_models and (standard_pack_folder() / PACK_FILE).is_file():
        ours = AssetPack(standard_pack_folder()).entries
    scene = _IMPORTERS[kind](path, Names(file.stem), ours)
    if not scene.objects:
        raise AssetError(path.name, "it holds nothing that a scene could show")
    write_scene(scene, file, pack_folder, overwrite=overwrite)
    return ImportReport(
        file=file,
        pack_folder=pack_folder,
        objects=len(scene.objects),
        models=len(scene.assets),
        ours=sum(entry["asset"] in ours for entry in scene.objects),
        lights=len(scene.lights),
        notes=tuple(scene.notes),
    )
