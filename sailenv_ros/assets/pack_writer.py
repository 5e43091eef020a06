"""Writing packs: models and what is said of them become files, all of a pack or nothing."""

from __future__ import annotations

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import yaml

from sailenv_ros.assets.glb import body_bounds, glb_bytes, triangle_count
from sailenv_ros.assets.pack import PACK_FILE, PackContent, PackEntry
from sailenv_ros.model import ConvexShape, ModelPart

__all__ = ["packed", "replaced_folder", "write_content"]


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
    author: str = "",
    licence: str = "",
    source: str = "",
) -> PackEntry:
    """Write one model's file into a folder; give its entry for `pack.yaml`."""
    file = f"{name}.glb"
    write_atomically(folder / file, glb_bytes(parts, hulls))
    low, high = body_bounds(parts)
    x, y, z = (float(v) for v in np.maximum(high - low, 1e-4).round(5))
    return PackEntry(
        name=name,
        display_name=display_name,
        category=category,
        file=file,
        size=(x, y, z),
        mass=mass,
        collision=collision,  # type: ignore[arg-type]
        triangles=triangle_count(parts),
        tags=tuple(tags),
        author=author,
        licence=licence,
        source=source,
    )


def write_content(folder: Path, content: PackContent) -> None:
    """Write `pack.yaml`, all of it or nothing."""
    plain = content.model_dump(mode="json", exclude_defaults=True)
    for entry in plain.get("assets", ()):
        for key in ("size", "tags"):
            if key in entry:
                entry[key] = list(entry[key])
    text = yaml.safe_dump(
        {"version": content.version, **plain}, sort_keys=False, allow_unicode=True, width=120
    )
    write_atomically(folder / PACK_FILE, text.encode())


def write_atomically(path: Path, data: bytes) -> None:
    """Write a file so that a reader sees the old one or the new one, never half of it."""
    handle, scratch = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
        Path(scratch).chmod(0o644)
        Path(scratch).replace(path)
    except BaseException:
        Path(scratch).unlink(missing_ok=True)
        raise


@contextmanager
def replaced_folder(folder: Path) -> Iterator[Path]:
    """Give an empty folder to fill, which takes the place of `folder` if all goes well."""
    folder.parent.mkdir(parents=True, exist_ok=True)
    scratch = Path(tempfile.mkdtemp(dir=folder.parent, prefix=f".{folder.name}-"))
    try:
        yield scratch
        scratch.chmod(0o755)
        old = scratch.with_name(scratch.name + "-old")
        if folder.exists():
            folder.rename(old)
        scratch.rename(folder)
        shutil.rmtree(old, ignore_errors=True)
    finally:
        shutil.rmtree(scratch, ignore_errors=True)
