"""An asset pack: a folder with `pack.yaml` and one binary glTF file for each object.

A folder in, `Asset`s out; a source of the `AssetLibrary`. Writing lies in `pack_writer`.
"""

from __future__ import annotations

import fnmatch
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from sailenv_ros.assets.checksums import file_checksum
from sailenv_ros.assets.folders import own_pack_folder, standard_pack_folder
from sailenv_ros.assets.model_cache import read_once
from sailenv_ros.errors import AssetError
from sailenv_ros.scene.spec import CategorySpec
from sailenv_ros.system.yaml_text import from_yaml
from sailenv_ros.types.model import (
    Asset,
    AssetPart,
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    Model,
    ModelPart,
    SphereShape,
)

__all__ = ["BUILD_COMMAND", "PACK_FILE", "AssetPack", "PackContent", "PackEntry", "PackPart"]

PACK_FILE = "pack.yaml"
WILDCARDS = frozenset("*?[")

BUILD_COMMAND = "sailenv assets build"

AssetName = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,62}$")]
Text = Annotated[str, Field(max_length=300)]
Checksum = Annotated[str, Field(pattern=r"^[0-9a-f]{64}$")]
FilePath = Annotated[str, Field(pattern=r"^[^/\x00-\x1f][^\x00-\x1f]{0,299}$")]
PartName = Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9 _.-]{0,39}$")]
Pattern = Annotated[str, Field(min_length=1, max_length=100)]
KeypointName = Annotated[str, Field(pattern=r"^[^\x00-\x1f]{1,63}$")]
Coordinate = Annotated[float, Field(ge=-100.0, le=100.0)]
Amount = Annotated[float, Field(ge=0.0, le=1e3)]
Metres = Annotated[float, Field(gt=0.0, le=100.0)]


class _PackModel(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class PackPart(_PackModel):
    """Meshes of a model that are an object of their own in labels, with the body as its parent.

    Attributes
    ----------
    category : str
    meshes, materials : tuple of str
        Names, or patterns with ``*`` and ``?``: a mesh belongs to the part if its name, its node's
        or its material's fits one.
    """

    category: Annotated[str, Field(min_length=1, max_length=63)]
    meshes: Annotated[tuple[Pattern, ...], Field(max_length=256)] = ()
    materials: Annotated[tuple[Pattern, ...], Field(max_length=256)] = ()

    @model_validator(mode="after")
    def _names_something(self) -> PackPart:
        if not self.meshes and not self.materials:
            raise ValueError("a part needs meshes or materials")
        return self


class PackEntry(_PackModel):
    """One object as `pack.yaml` describes it.

    Attributes
    ----------
    name, display_name, category : str
    keypoints : mapping of str to (3,) tuple of float
        Named points in the body frame [m]: ``{left front foot: [0.2, 0.2, 0.0]}``.
    parts : mapping of str to PackPart
        What of it is labelled apart: ``{left pillow: {category: pillow, meshes: [pillow_l*]}}``.
    glow : mapping of str to (3,) tuple of float
        Linear radiance that a material emits for each W/sr of a lamp's light [1/m²], by its name:
        ``{shade: [5.0, 5.0, 4.0]}``; see `Material.glow`.
    file : str
        Of the model, in the pack's folder.
    sha256 : str
        Checksum of the file in hexadecimal digits; empty in packs written by hand.
    size : (3,) tuple of float
        Along the body's x, y, z [m].
    mass : float
        [kg].
    collision : str
        ``box``, ``cylinder``, ``sphere`` around its size; ``hulls``: convex pieces in the file;
        ``none``.
    """

    name: AssetName
    display_name: Annotated[str, Field(pattern=r"^[^\x00-\x1f]{1,100}$")]
    category: Annotated[str, Field(min_length=1, max_length=63)]
    file: Annotated[str, Field(pattern=r"^[A-Za-z0-9_][A-Za-z0-9_.-]{0,99}\.glb$")]
    sha256: Checksum | Literal[""] = ""
    size: tuple[Metres, Metres, Metres]
    mass: Annotated[float, Field(gt=0.0, le=1e6)]
    collision: Literal["box", "cylinder", "sphere", "hulls", "none"] = "hulls"
    triangles: Annotated[int, Field(ge=1)]
    tags: tuple[Text, ...] = ()
    keypoints: dict[KeypointName, tuple[Coordinate, Coordinate, Coordinate]] = Field(
        default_factory=dict, max_length=256
    )
    parts: dict[PartName, PackPart] = Field(default_factory=dict, max_length=256)
    glow: dict[Text, tuple[Amount, Amount, Amount]] = Field(default_factory=dict, max_length=256)
    author: Text = ""
    licence: Text = ""
    source: Text = ""


class PackContent(_PackModel):
    """The whole of `pack.yaml`.

    Attributes
    ----------
    files : mapping of str to str
        SHA-256 of the pack's other files (skies, licence texts), by their paths in the folder.
    missing : tuple of str
        Names of assets that belong to it and have not been made yet.
    """

    version: Literal[1]
    title: Text = ""
    fingerprint: Text = ""
    categories: tuple[CategorySpec, ...] = ()
    assets: tuple[PackEntry, ...] = ()
    files: dict[FilePath, Checksum] = Field(default_factory=dict)
    missing: tuple[AssetName, ...] = ()


class AssetPack:
    """The assets of one folder.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    AssetError
        If there is no `pack.yaml`, or it breaks the format.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.content = _read(folder / PACK_FILE)
        self._entries = {entry.name: entry for entry in self.content.assets}
        if len(self._entries) != len(self.content.assets):
            raise AssetError(str(folder / PACK_FILE), "two of its assets have the same name")

    @cached_property
    def display_names(self) -> Mapping[str, str]:
        """Display name of each catalogue name."""
        return MappingProxyType({name: e.display_name for name, e in self._entries.items()})

    @property
    def entries(self) -> Mapping[str, PackEntry]:
        """The entries of `pack.yaml`, by catalogue name."""
        return MappingProxyType(self._entries)

    def fingerprint(self, name: str) -> str:
        """Return a text that changes whenever an asset does: the pack's own, else of its file."""
        if self.content.fingerprint:
            return f"{self.content.fingerprint} {name}"
        entry = self._entries[name]
        try:
            file = (self.folder / entry.file).stat()
        except OSError:
            return f"{self.folder} {entry!r}"
        return f"{self.folder} {entry!r} {file.st_size} {file.st_mtime_ns}"

    def load(self, name: str) -> Asset:
        """Read one asset's file.

        Raises
        ------
        AssetError
            If it is not there or cannot be used.
        """
        entry = self._entries[name]
        path = self.folder / entry.file
        problem = self._problem(entry.file, entry.sha256)
        if problem:
            raise AssetError(name, f"its file {path} {problem}; {self._remedy(name)}")
        parts, hulls = read_once(path, entry.sha256)
        parts = _glowing(entry, parts)
        if entry.collision == "hulls" and not hulls:
            raise AssetError(name, f"{path} holds no collision pieces")
        model = Model(name=name, parts=parts)
        low, high = model.bounds()
        x, y, z = ((low + high) / 2.0).tolist()
        return Asset(
            name=name,
            display_name=entry.display_name,
            category=entry.category,
            model=model,
            collision=_shapes(entry, (x, y, z), hulls),
            mass_kg=entry.mass,
            centre_of_mass_m=(x, y, z),
            tags=entry.tags,
            keypoints=tuple(entry.keypoints.items()),
            parts=_labelled(entry, parts),
        )

    def check_file(self, path: Path) -> None:
        """Check one of the pack's other files, e.g. a sky, before it is used.

        Raises
        ------
        AssetError
            If it is missing or is not what was written.
        """
        relative = str(path.relative_to(self.folder))
        problem = self._problem(relative, self.content.files.get(relative, ""))
        if problem:
            raise AssetError(path.name, f"its file {path} {problem}; {self._remedy(path.stem)}")

    def problems(self) -> Mapping[str, str]:
        """Check every file of the pack.

        Returns
        -------
        problems : mapping of str to str
            What is wrong, in words, by the file's path in the folder; files without a checksum
            need only be there.
        """
        listed = {entry.file: entry.sha256 for entry in self._entries.values()}
        listed.update(self.content.files)
        found = {file: self._problem(file, checksum) for file, checksum in listed.items()}
        return MappingProxyType({file: problem for file, problem in found.items() if problem})

    def _problem(self, file: str, checksum: str) -> str:
        """Return what is wrong with a file; empty if nothing is."""
        path = self.folder / file
        try:
            if not path.is_file():
                return "is missing"
            if checksum and file_checksum(path) != checksum:
                return "is damaged (its checksum is wrong)"
        except OSError as problem:
            return f"cannot be read ({problem.strerror})"
        return ""

    def _remedy(self, name: str) -> str:
        if self.folder == standard_pack_folder():
            return f"make it anew with: {BUILD_COMMAND}"
        if self.folder == own_pack_folder():
            return f"add it anew with: sailenv assets add FILE --name {name} --category CATEGORY"
        return "install the pack anew"


def _glowing(entry: PackEntry, meshes: tuple[ModelPart, ...]) -> tuple[ModelPart, ...]:
    """Return the meshes with what their materials glow by the light of a lamp."""
    if not entry.glow:
        return meshes
    materials = {
        id(mesh.material): replace(
            mesh.material, glow=entry.glow.get(mesh.material.name, mesh.material.glow)
        )
        for mesh in meshes
    }
    return tuple(replace(mesh, material=materials[id(mesh.material)]) for mesh in meshes)


def _labelled(entry: PackEntry, meshes: Sequence[ModelPart]) -> tuple[AssetPart, ...]:
    """Find the meshes of each part."""
    if not entry.parts:
        return ()
    by_mesh, by_material = defaultdict[str, set[int]](set), defaultdict[str, set[int]](set)
    for place, mesh in enumerate(meshes):
        by_material[mesh.material.name].add(place)
        for name in mesh.names:
            by_mesh[name].add(place)
    made = []
    for name, part in entry.parts.items():
        taken = _fitting(by_mesh, part.meshes) | _fitting(by_material, part.materials)
        if not taken:
            raise AssetError(entry.name, f"no mesh of {entry.file} is of its part {name!r}")
        made.append(AssetPart(name=name, category=part.category, meshes=tuple(sorted(taken))))
    return tuple(made)


def _fitting(places: Mapping[str, set[int]], patterns: Sequence[str]) -> set[int]:
    """Return the places whose names fit a pattern, nearly all of which are whole names."""
    found: set[int] = set()
    for pattern in patterns:
        found |= places.get(pattern, set())
        if not WILDCARDS.isdisjoint(pattern):
            for name in (one for one in places if fnmatch.fnmatchcase(one, pattern)):
                found |= places[name]
    return found


def _read(path: Path) -> PackContent:
    try:
        state = path.stat()
        return _parsed(path, (state.st_ino, state.st_mtime_ns, state.st_size))
    except (OSError, UnicodeDecodeError, yaml.YAMLError, ValidationError) as problem:
        raise AssetError(str(path), " ".join(str(problem).split())) from None


@lru_cache(maxsize=32)
def _parsed(path: Path, state: tuple[int, int, int]) -> PackContent:
    """Read a file once until it is changed: that of the furniture takes 0.1 s to parse."""
    return PackContent.model_validate(from_yaml(path.read_text(encoding="utf-8")))


def _shapes(
    entry: PackEntry, middle: tuple[float, float, float], hulls: tuple[ConvexShape, ...]
) -> tuple[CollisionShape, ...]:
    x, y, z = entry.size
    if entry.collision == "box":
        return (BoxShape(half_extents_m=(x / 2.0, y / 2.0, z / 2.0), centre_m=middle),)
    if entry.collision == "cylinder":
        return (CylinderShape(radius_m=max(x, y) / 2.0, height_m=z, centre_m=middle),)
    if entry.collision == "sphere":
        return (SphereShape(radius_m=max(entry.size) / 2.0, centre_m=middle),)
    return hulls if entry.collision == "hulls" else ()
