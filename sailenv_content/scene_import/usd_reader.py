"""The child process that reads USD files with Pixar's library; see `usd_scene`.

    python -m sailenv_content.scene_import.usd_reader FILE FOLDER MEMORY_BYTES

A reader of others in C++ works on an untrusted file here, with no more memory than it is given.
Writes ``scene.glb`` and ``scene.json`` into the folder, or ``refused.txt`` with a sentence. Only
layers and pictures beside the file, or in its package, are opened.
"""

from __future__ import annotations

import json
import math
import os
import resource
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sailenv_content.scene_import.usd_looks import Looks
from sailenv_content.scene_import.usd_meshes import corners_of, faces_by_material
from sailenv_content.scene_import.usd_tree import GltfTree

__all__ = ["main"]

MOST_TRIANGLES = 5_000_000
MOST_PRIMS = 200_000
MOST_LAYERS = 200

OBJECT_KINDS = ("component", "subcomponent")
"""Kinds of prims that are objects; of others each mesh is one."""

_FILE_FROM_Z_UP = np.array(
    [[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)


def main(arguments: list[str]) -> int:
    """Read a file; 0 if there is an answer."""
    path, folder, memory = Path(arguments[0]), Path(arguments[1]), int(arguments[2])
    resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    # No plug-ins but the library's own.
    os.environ.pop("PXR_PLUGINPATH_NAME", None)
    try:
        data, told = _converted(path)
    except Exception as problem:  # whatever the library has to say
        (folder / "refused.txt").write_text(" ".join(str(problem).split())[:300], encoding="utf-8")
        return 0
    (folder / "scene.glb").write_bytes(data)
    (folder / "scene.json").write_text(json.dumps(told), encoding="utf-8")
    return 0


def _converted(path: Path) -> tuple[bytes, dict[str, Any]]:
    from pxr import Usd, UsdGeom

    _check_layers(path)
    stage = Usd.Stage.Open(str(path))
    if not stage:
        raise ValueError("it is no USD file")
    unit = float(UsdGeom.GetStageMetersPerUnit(stage))
    up = _FILE_FROM_Z_UP if UsdGeom.GetStageUpAxis(stage) == "Z" else np.eye(4)
    reader = _StageReader(path, np.diag([unit, unit, unit, 1.0]) @ up)
    for number, prim in enumerate(Usd.PrimRange.Stage(stage, Usd.TraverseInstanceProxies())):
        if number >= MOST_PRIMS:
            raise ValueError(f"it has more than {MOST_PRIMS} prims")
        reader.read(prim)
    root = stage.GetDefaultPrim()
    return reader.data(), {"title": root.GetName() if root else "", "notes": reader.notes}


def _check_layers(path: Path) -> None:
    """Refuse a file that is composed of others that are not beside it, before they are opened."""
    from pxr import Sdf

    home = path.parent
    waiting, seen = [str(path)], {str(path)}
    while waiting:
        layer = Sdf.Layer.FindOrOpen(waiting.pop())
        if layer is None:
            continue
        for named in layer.GetCompositionAssetDependencies():
            found = Sdf.ComputeAssetPathRelativeToLayer(layer, named)
            plain = found.partition("[")[0]
            if not (home / plain).resolve().is_relative_to(home):
                raise ValueError(f"it names {named[:80]!r}, which is not beside it")
            if found not in seen:
                if len(seen) >= MOST_LAYERS:
                    raise ValueError(f"it is composed of more than {MOST_LAYERS} layers")
                seen.add(found)
                waiting.append(found)


class _StageReader:
    def __init__(self, path: Path, file_from_stage: NDArray[np.float64]) -> None:
        self._tree = GltfTree()
        self._looks = Looks(path, self._tree)
        self._file_from_stage = file_from_stage
        self._objects: dict[str, tuple[Any, list[dict[str, Any]]]] = {}
        self._triangles = 0
        self._domes = 0
        self.notes: list[str] = self._looks.notes

    def read(self, prim: Any) -> None:
        """Take up a prim that is drawn, lights or looks."""
        from pxr import UsdGeom, UsdLux

        if prim.IsA(UsdGeom.Imageable):
            imageable = UsdGeom.Imageable(prim)
            shown = imageable.ComputeVisibility() != "invisible"
            if not shown or imageable.ComputePurpose() in ("guide", "proxy"):
                return
        if prim.IsA(UsdGeom.Mesh):
            self._add_mesh(prim)
        elif prim.IsA(UsdGeom.Camera):
            self._add_camera(prim)
        elif prim.IsA(UsdLux.DomeLight):
            self._domes += 1
        elif prim.HasAPI(UsdLux.LightAPI):
            self._add_light(prim)

    def data(self) -> bytes:
        """Return the whole as a binary glTF file."""
        for owner, primitives in self._objects.values():
            extras = {"category": _category(owner)}
            mesh = self._tree.append("meshes", {"primitives": primitives})
            node = {"name": _shown(owner), "mesh": mesh, "extras": extras}
            self._tree.place(node, self._pose(owner))
        if self._domes:
            self.notes.append("light from all around, of domes, was left out")
        return self._tree.data()

    def _pose(self, prim: Any) -> NDArray[np.float64]:
        """Return (4, 4) file_from_prim."""
        return self._file_from_stage @ _matrix(prim)

    def _add_mesh(self, prim: Any) -> None:
        owner = next(_owners(prim), prim)
        key = str(owner.GetPath())
        _, primitives = self._objects.setdefault(key, (owner, []))
        inner = np.linalg.inv(_matrix(owner)) @ _matrix(prim)
        for material, faces in faces_by_material(prim):
            corners = corners_of(prim, faces)
            self._triangles += len(corners.positions) // 3
            if self._triangles > MOST_TRIANGLES:
                raise ValueError(f"it has more than {MOST_TRIANGLES} triangles")
            if not len(corners.positions):
                continue
            attributes, indices = self._tree.corners(corners, inner)
            primitive = {"attributes": attributes, "indices": indices}
            primitives.append({**primitive, "material": self._looks.of(material, prim)})

    def _add_camera(self, prim: Any) -> None:
        from pxr import UsdGeom

        camera = UsdGeom.Camera(prim).GetCamera()
        focal, height = float(camera.focalLength), float(camera.verticalAperture)
        entry: dict[str, Any] = {"type": "perspective", "perspective": {"znear": 0.05}}
        entry["perspective"]["yfov"] = 2.0 * math.atan2(0.5 * height, max(focal, 1e-3))
        node = {"name": _shown(prim), "camera": self._tree.append("cameras", entry)}
        self._tree.place(node, self._pose(prim))

    def _add_light(self, prim: Any) -> None:
        from pxr import UsdLux

        light = self._looks.light(prim, UsdLux)
        if light is not None:
            self._tree.place_light({"name": _shown(prim)}, light, self._pose(prim))


def _matrix(prim: Any) -> NDArray[np.float64]:
    """Return (4, 4) stage_from_prim; the library's vectors are rows."""
    from pxr import Usd, UsdGeom

    found = UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.EarliestTime())
    return np.array(found, np.float64).T


def _owners(prim: Any) -> Iterator[Any]:
    """Yield the prims above one, from below, that are objects."""
    from pxr import Usd

    while prim and not prim.IsPseudoRoot():
        if Usd.ModelAPI(prim).GetKind() in OBJECT_KINDS:
            yield prim
        prim = prim.GetParent()


def _category(prim: Any) -> str:
    attribute = prim.GetAttribute("semantics:labels:category")
    labels = attribute.Get() if attribute else None
    return str(labels[0]) if labels else ""


def _shown(prim: Any) -> str:
    return str(prim.GetDisplayName() or prim.GetName())


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
