"""Light that glTF files say surfaces emit: strengths, pictures, and what is written."""

from __future__ import annotations

import dataclasses
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.assets.glb import glb_bytes, read_glb
from sailenv_ros.assets.model_files import read_parts
from sailenv_ros.types.model import Material, Mesh, ModelPart
from tests.support.tiny_scenes import box_mesh, mesh_of

STRENGTH = "KHR_materials_emissive_strength"


def _described(data: bytes) -> dict[str, Any]:
    (length,) = struct.unpack_from("<I", data, 12)
    tree: dict[str, Any] = json.loads(data[20 : 20 + length])
    return tree


def _with_description(data: bytes, tree: dict[str, Any]) -> bytes:
    (length,) = struct.unpack_from("<I", data, 12)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<5I", 0x46546C67, 2, 20 + len(text) + len(rest), len(text), 0x4E4F534A)
    return head + text + rest


def _glb(**material: Any) -> bytes:
    part = ModelPart(mesh=box_mesh(1.0), material=Material(name="lamp", **material))
    return glb_bytes([part], ())


@pytest.mark.parametrize("emission", [(0.5, 0.25, 0.0), (8.0, 4.0, 1.0)])
def test_what_is_written_is_valid_and_is_read_again(
    tmp_path: Path, emission: tuple[float, float, float]
) -> None:
    """Factors of glTF end at 1; what is brighter has a strength besides."""
    data = _glb(emission=emission)
    tree = _described(data)
    assert max(tree["materials"][0]["emissiveFactor"]) <= 1.0
    assert (STRENGTH in tree.get("extensionsUsed", ())) == (max(emission) > 1.0)
    (tmp_path / "a.glb").write_bytes(data)
    (part,), _ = read_glb(tmp_path / "a.glb")
    np.testing.assert_allclose(part.material.emission, emission, rtol=1e-6)


@pytest.mark.parametrize("strength", ["bright", -1.0, 1e300, None, {}])
def test_a_strength_that_is_none_is_left_alone(tmp_path: Path, strength: object) -> None:
    """The file is read all the same, with its factors."""
    tree = _described(data := _glb(emission=(0.5, 0.25, 0.0)))
    tree["materials"][0]["extensions"] = {STRENGTH: {"emissiveStrength": strength}}
    (tmp_path / "a.glb").write_bytes(_with_description(data, tree))
    (part,) = read_parts(tmp_path / "a.glb")
    np.testing.assert_allclose(part.material.emission, (0.5, 0.25, 0.0), rtol=1e-6)


def _strip() -> Mesh:
    """Two squares beside each other, on the left and the right half of a picture."""
    positions = [(0.0, x, z) for x in (0, 1, 1, 2) for z in (0, 1)]
    uvs = [(u, v) for u in (0.02, 0.48, 0.52, 0.98) for v in (0.02, 0.98)]
    triangles = [(0, 2, 1), (1, 2, 3), (4, 6, 5), (5, 6, 7)]
    return mesh_of(positions, [(1.0, 0.0, 0.0)] * 8, uvs, triangles)


def test_triangles_glow_where_the_picture_of_emission_is_bright(tmp_path: Path) -> None:
    """The right half shows the picture of its glow, the left half its colour."""
    colours = np.full((32, 64, 4), 255, np.uint8)
    colours[..., :3] = (200, 40, 40)
    light = np.zeros((32, 64, 4), np.uint8)
    light[:, 32:, 1], light[..., 3] = 255, 255
    lit = Material(name="sign", emission=(0.0, 0.5, 0.0), base_colour_texture=colours)
    shown = dataclasses.replace(lit, name="light", base_colour_texture=light)
    parts = [ModelPart(mesh=_strip(), material=one) for one in (lit, shown)]
    data = glb_bytes(parts, ())
    tree = _described(data)
    names = [material["name"] for material in tree["materials"]]
    sign, other = (tree["materials"][names.index(name)] for name in ("sign", "light"))
    sign["emissiveTexture"] = other["pbrMetallicRoughness"]["baseColorTexture"]
    sign["extensions"] = {STRENGTH: {"emissiveStrength": 6.0}}
    (tmp_path / "a.glb").write_bytes(_with_description(data, tree))
    found = [p for p in read_parts(tmp_path / "a.glb") if p.material.name == "sign"]
    dark, bright = sorted(found, key=lambda part: max(part.material.emission))
    assert max(dark.material.emission) == 0.0
    np.testing.assert_allclose(bright.material.emission, (0.0, 3.0, 0.0), rtol=1e-6)
    for part, low, high, colour in ((dark, 0, 1, (200, 40, 40)), (bright, 1, 2, (0, 255, 0))):
        corners = part.mesh.positions[part.mesh.triangles]
        assert corners[..., 1].min() == pytest.approx(low)
        assert corners[..., 1].max() == pytest.approx(high)
        assert part.material.base_colour_texture is not None
        shown_at = part.material.base_colour_texture[16, 16 + 32 * low, :3].astype(int)
        assert np.abs(shown_at - colour).max() < 12  # of JPEG
