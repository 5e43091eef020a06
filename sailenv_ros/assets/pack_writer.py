"""Writing packs: models and what is said of them become files, all of a pack or nothing."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import yaml

from sailenv_ros.assets.glb import DRAWN, body_bounds, glb_bytes, triangle_count
from sailenv_ros.assets.pack import PACK_FILE, PackContent, PackEntry, PackPart
from sailenv_ros.system.files import write_file
from sailenv_ros.types.model import AssetPart, ConvexShape, ModelPart

__all__ = ["packed", "write_content"]


def packed(
    folder: Path,
    name: str,
    parts: Sequence[ModelPart],
    hulls: Sequence[ConvexShape],
    *,
    display_name: str,
    category: str,
    mass: float,
    collision: str,
    tags: Sequence[str] = (),
    labelled: Sequence[AssetPart] = (),
    author: str = "",
    licence: str = "",
    source: str = "",
    unique_file: bool = False,
) -> PackEntry:
    """Write one model's file into a folder; return its entry for `pack.yaml`.

    Parameters
    ----------
    labelled : sequence of AssetPart
        What of it is labelled apart.
    unique_file : bool
        True puts the checksum into the file's name, so that the file of an entry of before stays
        as it is until `pack.yaml` names the new one.

    Raises
    ------
    OSError
        If the file cannot be written.
    """
    data = glb_bytes(parts, hulls)
    checksum = hashlib.sha256(data).hexdigest()
    file = f"{name}.{checksum[:16]}.glb" if unique_file else f"{name}.glb"
    write_file(folder / file, data)
    low, high = body_bounds(parts)
    x, y, z = (float(v) for v in np.maximum(high - low, 1e-4).round(5))
    return PackEntry(
        name=name,
        display_name=display_name,
        category=category,
        file=file,
        sha256=checksum,
        size=(x, y, z),
        mass=mass,
        collision=collision,  # type: ignore[arg-type]
        triangles=triangle_count(parts),
        tags=tuple(tags),
        parts={
            part.name: PackPart(
                category=part.category, meshes=tuple(f"{DRAWN}{place}" for place in part.meshes)
            )
            for part in labelled
        },
        glow={part.material.name: part.material.glow for part in parts if any(part.material.glow)},
        author=author,
        licence=licence,
        source=source,
    )


def write_content(folder: Path, content: PackContent) -> None:
    """Write `pack.yaml`, all of it or nothing."""
    plain = content.model_dump(mode="json", exclude_defaults=True)
    if content.missing:
        plain["missing"] = list(content.missing)
    for entry in plain.get("assets", ()):
        for key in ("size", "tags"):
            if key in entry:
                entry[key] = list(entry[key])
    text = yaml.safe_dump(
        {"version": content.version, **plain}, sort_keys=False, allow_unicode=True, width=120
    )
    write_file(folder / PACK_FILE, text.encode())
