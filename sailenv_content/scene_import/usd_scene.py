"""USD files → scenes: read by Pixar's library in a process of its own, then as glTF is.

So USD is read to the degree that glTF is: meshes with their colours, lights, cameras, categories.
What it says of physics is left out.
"""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path

from sailenv_content.scene_import.gltf_scene import import_gltf
from sailenv_content.scene_import.imported import ImportedScene, Names
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.assets.robots.read_apart import ANSWER, run_reader
from sailenv_ros.extras import need

__all__ = ["import_usd"]


def import_usd(path: Path, names: Names, ours: Mapping[str, PackEntry]) -> ImportedScene:
    """Read a USD file: ``.usd``, ``.usda``, ``.usdc``, ``.usdz``.

    Raises
    ------
    AssetError
        If it is malformed, too large, or names files that are not beside it.
    MissingPackage
        If Pixar's library is not installed.
    """
    need("pxr", "importing USD")
    with tempfile.TemporaryDirectory(prefix="sailenv-import-") as name:
        folder = Path(name)
        run_reader("sailenv_content.scene_import.usd_reader", "USD", path, folder)
        told = json.loads((folder / ANSWER).read_text(encoding="utf-8"))
        scene = import_gltf(folder / "scene.glb", names, ours)
    scene.title = told["title"] or path.stem
    scene.description = f"Imported from the USD file {path.name}."
    scene.notes += told["notes"]
    return scene
