"""A bed with two pillows as parts of its model."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sailenv_ros.assets.pack import PackContent
from sailenv_ros.assets.pack_writer import packed, write_content
from sailenv_ros.assets.solids import box_mesh
from sailenv_ros.types.model import Asset, AssetPart, Material, Mesh, Model, ModelPart

LEFT, RIGHT = "left pillow", "right pillow"


def shifted_box(size: tuple[float, float, float], centre: tuple[float, float, float]) -> Mesh:
    box = box_mesh(size)
    return Mesh(
        positions=box.positions + np.array(centre, np.float32),
        normals=box.normals,
        uvs=box.uvs,
        triangles=box.triangles,
    )


def divided_bed(parts: tuple[AssetPart, ...] | None = None) -> Asset:
    """Return a bed 2 m long, with two pillows 0.1 m thick at its head."""
    shapes = (
        ("frame", (2.0, 1.6, 0.4), (0.0, 0.0, 0.2)),
        ("cotton", (0.4, 0.6, 0.1), (-0.7, 0.4, 0.45)),
        ("cotton", (0.4, 0.6, 0.1), (-0.7, -0.4, 0.45)),
    )
    meshes = tuple(
        ModelPart(mesh=shifted_box(size, centre), material=Material(name=name))
        for name, size, centre in shapes
    )
    labelled = (
        AssetPart(name=LEFT, category="pillow", meshes=(1,)),
        AssetPart(name=RIGHT, category="pillow", meshes=(2,)),
    )
    return Asset(
        name="test_bed",
        display_name="Test Bed",
        category="bed",
        model=Model(name="test_bed", parts=meshes),
        collision=(),
        mass_kg=30.0,
        parts=labelled if parts is None else parts,
    )


def write_bed_pack(folder: Path) -> None:
    """Write a pack with the bed and nothing else into a folder."""
    asset = divided_bed()
    entry = packed(
        folder,
        asset.name,
        asset.model.parts,
        (),
        display_name=asset.display_name,
        category=asset.category,
        mass=asset.mass_kg,
        collision="box",
        labelled=asset.parts,
    )
    write_content(folder, PackContent(version=1, assets=(entry,)))
