"""Furniture of a Sweet Home 3D file: pieces → objects of our pack, or models of the file's own."""

from __future__ import annotations

import dataclasses
import hashlib
import re
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.categories_by_name import category_of_name
from sailenv_content.scene_import.home_types import HomePiece, Paint
from sailenv_content.scene_import.imported import Entry, ImportedAsset, ImportedScene, Names
from sailenv_content.scene_import.scene_parts import asset_of_parts
from sailenv_content.scene_import.wavefront_colours import material_file, with_glass
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart, read_parts
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.assets.recipe import standard_recipe
from sailenv_ros.errors import AssetError
from sailenv_ros.types.colour import hex_from_linear
from sailenv_ros.types.model import Material

__all__ = ["HomeFurniture"]

Doubles = NDArray[np.float64]

EQUAL = 0.02
"""Sizes that differ by no more are those of the catalogue."""

MOST_OBJ_BYTES = 100 * 2**20


class HomeFurniture:
    """Places pieces.

    Parameters
    ----------
    folder : Path
        Of the unpacked archive.
    names : Names
    ours : mapping of str to PackEntry
        The standard pack.
    scene : ImportedScene
        Takes the objects and their models.
    material : callable
        ``material(paint, otherwise)`` returns a painted material.
    """

    def __init__(
        self,
        folder: Path,
        names: Names,
        ours: Mapping[str, PackEntry],
        scene: ImportedScene,
        material: Callable[[Paint, Material], Material],
    ) -> None:
        self._folder = folder
        self._names = names
        self._ours = ours
        self._scene = scene
        self._material = material
        self._made: dict[tuple[object, ...], ImportedAsset | None] = {}
        recipe = standard_recipe()
        self._by_source = {
            _plain(entry.source): (name, entry.turn)
            for name, entry in recipe.assets.items()
            if name in ours and not entry.source.startswith("made/")
        }

    def add(self, piece: HomePiece) -> None:
        """Place a piece; what cannot be read becomes a note of the scene."""
        entry = self._of_ours(piece) or self._of_own(piece)
        if entry is not None:
            self._scene.add_object(entry)

    def _of_ours(self, piece: HomePiece) -> Entry | None:
        """Return the entry of a piece that the standard pack has; None if it has not."""
        found = self._by_source.get(_plain(piece.catalogue.replace("#", "/")))
        changed = piece.materials or piece.paint.image or piece.mirrored
        if found is None or changed or any(piece.tilt_deg):
            return None
        name, turn = found
        entry = self._ours[name]
        depth, width, height = piece.size_m
        if round(turn / 90.0) % 2:
            depth, width = width, depth
        scale = np.array([depth, width, height]) / np.asarray(entry.size)
        if np.abs(scale - 1.0).max() <= EQUAL:
            scale = np.ones(3)
        round_shape = entry.collision in ("cylinder", "sphere")
        if (round_shape and np.ptp(scale) > 1e-9) or scale.min() < 0.01 or scale.max() > 100.0:
            return None
        result = self._entry(piece, name, piece.yaw_deg - turn)
        if (scale != 1.0).any():
            result["scale"] = [round(float(s), 4) for s in scale]
        if piece.paint.colour is not None:
            result["colour"] = hex_from_linear(piece.paint.colour)
        return result

    def _of_own(self, piece: HomePiece) -> Entry | None:
        asset = self._asset(piece)
        if asset is None:
            return None
        return self._entry(piece, asset.name, piece.yaw_deg)

    def _entry(self, piece: HomePiece, asset: str, yaw_deg: float) -> Entry:
        roll, pitch = piece.tilt_deg
        yaw = float(np.round((yaw_deg + 180.0) % 360.0 - 180.0, 3)) + 0.0
        entry: Entry = {
            "name": self._names.of_object(piece.name),
            "asset": asset,
            "position": [round(v, 4) + 0.0 for v in piece.position],
        }
        if roll or pitch or yaw:
            entry["rotation"] = [round(roll, 3) + 0.0, round(pitch, 3) + 0.0, yaw]
        entry["static"] = True
        return entry

    def _asset(self, piece: HomePiece) -> ImportedAsset | None:
        """Return the file's own model, sized and painted; the same for equal pieces."""
        key = (
            *(piece.model, piece.size_m, piece.turn.tobytes(), piece.mirrored),
            *(piece.paint, tuple(piece.materials.items())),
        )
        if key not in self._made:
            try:
                self._made[key] = self._new_asset(piece)
            except AssetError as problem:
                self._made[key] = None
                self._scene.notes.append(f"{piece.name!r} was left out: {problem.why}")
            if self._made[key] is not None:
                self._scene.assets.append(self._made[key])  # type: ignore[arg-type]  # just asked
        return self._made[key]

    def _new_asset(self, piece: HomePiece) -> ImportedAsset:
        parts = read_parts(self._model_file(piece))
        sized = _sized([self._painted(part, piece) for part in parts], piece)
        default = "window" if piece.kind == "opening" else "unlabelled"
        category = category_of_name(piece.name, default)
        if piece.kind == "opening" and category not in ("door", "window"):
            category = "door" if piece.position[2] < 0.2 else "window"
        display = f"{self._scene.title[:40]} {piece.name[:40]}"
        name = self._names.of_asset(piece.name)
        return asset_of_parts(
            name,
            sized,
            display_name=f"{display} {name.rpartition('_')[2]}",
            category=category,
            collides=category != "curtain",
            author=piece.creator,
            licence=piece.licence,
            source=f"{self._scene.description} {piece.catalogue}".strip(),
        )

    def _painted(self, part: RawPart, piece: HomePiece) -> RawPart:
        paint = piece.materials.get(part.material.name, piece.paint)
        return dataclasses.replace(part, material=self._material(paint, part.material))

    def _model_file(self, piece: HomePiece) -> Path:
        """Return the path of a piece's model, as a file that says what it is.

        Raises
        ------
        AssetError
            If it is not there, or of a format that is not read.
        """
        path = (self._folder / piece.model).resolve()
        if not piece.model or not path.is_relative_to(self._folder) or not path.is_file():
            raise AssetError(piece.name, f"the file has no model {piece.model!r}")
        if path.suffix.lower() in (".glb", ".gltf"):
            return path
        head = path.read_bytes()[:4096]
        is_obj = re.search(rb"(?m)^(v|o|g|mtllib|#)\s", head) is not None
        if path.suffix.lower() not in ("", ".obj") or not is_obj:
            kind = path.suffix or "unknown"
            raise AssetError(piece.name, f"models of the format {kind} are not read, OBJ files are")
        return self._with_materials(path, piece)

    def _with_materials(self, path: Path, piece: HomePiece) -> Path:
        """Return a copy of an OBJ file with the materials that every reader is to know.

        Those are Wavefront's own, and glass for what the program takes for window panes.
        """
        data = path.read_bytes()
        if len(data) > MOST_OBJ_BYTES:
            raise AssetError(piece.name, f"its model is larger than {MOST_OBJ_BYTES // 2**20} MB")
        mark = hashlib.sha256(data).hexdigest()[:16]
        materials = path.with_name(f"known-{mark}.mtl")
        library = re.search(rb"(?m)^mtllib[ \t]+(\S[^\r\n]*)", data)
        text = material_file()
        if library is not None:
            own = path.with_name(Path(library[1].decode("latin-1").strip()).name)
            text += own.read_text(encoding="latin-1") if own.is_file() else ""
        materials.write_text(text, encoding="latin-1")
        data = re.sub(rb"(?m)^mtllib[^\r\n]*", b"", data)
        copy = path.with_name(f"model-{mark}.obj")
        copy.write_bytes(b"mtllib " + materials.name.encode() + b"\n" + with_glass(data))
        return copy


def _plain(source: str) -> str:
    """Return what the ids of the program and of our recipe have in common."""
    library, _, model = source.partition("/")
    return f"{re.sub('[^a-z0-9]', '', library.lower())}/{model}"


def _sized(parts: Sequence[RawPart], piece: HomePiece) -> list[RawPart]:
    """Return parts turned, mirrored and stretched to a piece's size, upon their base's middle."""
    swap = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    turn = swap @ piece.turn @ swap.T
    points = np.concatenate([p.mesh.positions[np.unique(p.mesh.triangles)] for p in parts]) @ turn.T
    low, high = points.min(axis=0), points.max(axis=0)
    size = np.where(high - low > 1e-9, high - low, 1.0)
    scale = np.diag(np.asarray(piece.size_m) / size)
    if piece.mirrored:
        scale = scale @ np.diag([1.0, -1.0, 1.0])
    whole = scale @ turn
    base = scale @ np.array([*(low[:2] + high[:2]) / 2.0, low[2]])
    flipped = float(np.linalg.det(whole)) < 0.0
    result = []
    for part in parts:
        mesh = part.mesh
        normals = mesh.normals
        if normals is not None:
            with np.errstate(all="ignore"):
                try:
                    normals = normals @ np.linalg.inv(whole)
                except np.linalg.LinAlgError:
                    normals = None
        moved = RawMesh(
            positions=mesh.positions @ whole.T - base,
            uvs=mesh.uvs,
            triangles=mesh.triangles[:, ::-1] if flipped else mesh.triangles,
            normals=normals,
        )
        result.append(dataclasses.replace(part, mesh=moved))
    return result
