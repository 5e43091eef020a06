"""USD: what its meshes, looks and lights become, and what is refused."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sailenv_content.scene_import.gltf_scene import import_gltf
from sailenv_content.scene_import.imported import Names
from sailenv_content.scene_import.importers import import_scene
from sailenv_content.scene_import.usd_meshes import Corners
from sailenv_content.scene_import.usd_scene import import_usd
from sailenv_content.scene_import.usd_tree import GltfTree
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.errors import AssetError, MissingPackage
from sailenv_ros.scene_export import export_scene

STAGE = """#usda 1.0
(
    defaultPrim = "flat"
    metersPerUnit = 0.01
    upAxis = "Y"
)
def Xform "flat" (kind = "assembly")
{
    def Xform "table" (
        kind = "component"
        displayName = "round table"
    )
    {
        custom token[] semantics:labels:category = ["dining table"]
        double3 xformOp:translate = (100, 0, 200)
        uniform token[] xformOpOrder = ["xformOp:translate"]
        def Mesh "top" (prepend apiSchemas = ["MaterialBindingAPI"])
        {
            int[] faceVertexCounts = [4, 3]
            int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 2]
            point3f[] points = [(-50, 70, 50), (50, 70, 50), (50, 70, -50), (-50, 70, -50),
                (80, 70, 0)]
            rel material:binding = </flat/Looks/red>
        }
        def Mesh "foot"
        {
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (10, 0, 0), (0, 70, 0)]
            color3f[] primvars:displayColor = [(0, 0.5, 0)]
        }
        def Mesh "hull"
        {
            uniform token purpose = "guide"
            int[] faceVertexCounts = [3]
            int[] faceVertexIndices = [0, 1, 2]
            point3f[] points = [(0, 0, 0), (999, 0, 0), (0, 999, 0)]
        }
    }
    def Scope "Looks"
    {
        def Material "red"
        {
            token outputs:surface.connect = </flat/Looks/red/s.outputs:surface>
            def Shader "s"
            {
                uniform token info:id = "UsdPreviewSurface"
                color3f inputs:diffuseColor = (0.8, 0.1, 0.1)
                float inputs:roughness = 0.25
                token outputs:surface
            }
        }
    }
    def RectLight "panel"
    {
        float inputs:intensity = 3
        float inputs:width = 2
        float inputs:height = 0.5
        double3 xformOp:translate = (0, 250, 0)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
    def DomeLight "sky"
    {
    }
    def Camera "eye"
    {
        float focalLength = 20
        float verticalAperture = 40
        double3 xformOp:translate = (0, 150, 300)
        uniform token[] xformOpOrder = ["xformOp:translate"]
    }
}
"""


def test_without_the_library_its_command_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "flat.usda").write_text(STAGE)
    monkeypatch.setitem(sys.modules, "pxr", None)
    with pytest.raises(MissingPackage, match=r"sailenv_ros\[import\]"):
        import_usd(tmp_path / "flat.usda", Names("flat"), {})


def test_corners_of_triangles_become_a_mesh_in_its_place(tmp_path: Path) -> None:
    """Equal corners once; a matrix that mirrors turns triangles round."""
    square = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0], [1, 1, 0], [0, 1, 0]], float)
    corners = Corners(positions=square, normals=np.tile((0.0, 0.0, 1.0), (6, 1)), uvs=None)
    tree = GltfTree()
    attributes, indices = tree.corners(corners, np.diag([1.0, 1.0, -2.0, 1.0]))
    primitive = {"attributes": attributes, "indices": indices}
    mesh = tree.append("meshes", {"primitives": [primitive]})
    pose = np.eye(4)
    pose[:3, 3] = (0.0, 1.0, 0.0)
    tree.place({"name": "square", "mesh": mesh}, pose)
    (tmp_path / "square.glb").write_bytes(tree.data())
    scene = import_gltf(tmp_path / "square.glb", Names("x"), {})
    ((entry,), (asset,)) = scene.objects, scene.assets
    # x, y, z of the world are z, x, y of the file; origins are the middles of bases.
    assert entry["position"] == [0.0, 0.5, 1.0]
    (part,) = asset.parts
    assert len(part.mesh.positions) == 4
    a, b, c = (part.mesh.positions[part.mesh.triangles[:, k]] for k in range(3))
    assert (np.cross(b - a, c - a)[:, 0] < 0.0).all()
    np.testing.assert_allclose(part.mesh.normals[:, 0], -1.0)


def imported(path: Path) -> tuple[dict[str, Any], Any]:
    """Import a file; return the scene's entries and the report."""
    out = path.with_name("out.yaml")
    report = import_scene(path, out, path.with_name("pack"), own_models=True)
    found: dict[str, Any] = yaml.safe_load(out.read_text())
    return found, report


def test_objects_lights_and_cameras_are_read(tmp_path: Path) -> None:
    (tmp_path / "flat.usda").write_text(STAGE)
    scene, report = imported(tmp_path / "flat.usda")
    (table,) = scene["objects"]
    assert table["name"] == "round table"
    # The file's x and z are the world's y and x; the hull, which guides, is left out.
    np.testing.assert_allclose(table["position"], (2.0, 1.15, 0.0), atol=1e-4)
    assert report.notes == ("light from all around, of domes, was left out",)
    (panel,) = scene["lights"]
    assert (panel["type"], panel["intensity"]) == ("spot", pytest.approx(3.0))
    np.testing.assert_allclose(panel["position"], (0.0, 0.0, 2.5), atol=1e-6)
    (eye,) = scene["agents"]
    assert eye["vertical_fov"] == pytest.approx(90.0)
    np.testing.assert_allclose(eye["position"], (3.0, 0.0, 1.5), atol=1e-6)
    (entry,) = AssetPack(report.pack_folder).entries.values()
    assert entry.category == "dining table"


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        (STAGE.replace("[4, 3]", "[4, 9]"), "do not fit its corners"),
        (STAGE.replace("1, 4, 2]", "1, 9, 2]"), "not there"),
        (STAGE.replace('upAxis = "Y"', 'upAxis = "Y"\n    subLayers = [@../../etc/x.usda@]'),
         "not beside it"),
        ("no stage", "USD cannot read it"),
    ],
)  # fmt: skip
def test_broken_and_hostile_files_are_refused(broken: str, sentence: str, tmp_path: Path) -> None:
    (tmp_path / "bad.usda").write_text(broken)
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(AssetError, match=sentence) as caught:
        imported(tmp_path / "bad.usda")
    assert "\n" not in str(caught.value)
    assert sorted(tmp_path.rglob("*")) == before


def test_our_own_packages_are_read_back(tmp_path: Path) -> None:
    report = export_scene("object_view", tmp_path / "view.usdz")
    scene, read = imported(tmp_path / "view.usdz")
    assert len(scene["objects"]) == report.objects
    assert read.models > 1


@pytest.mark.parametrize("suffix", [".usdz", ".glb"])
def test_what_lies_outside_windows_is_left_out(suffix: str, tmp_path: Path) -> None:
    """It is larger than things may be, so that no room with windows could be read back."""
    room = tmp_path / "room.yaml"
    room.write_text(
        "version: 1\n"
        "room: {size: [3, 3, 2.5], outside: street,\n"
        "       openings: [{type: window, wall: north, at: 0}]}\n"
        "objects: [{name: block, asset: cube, position: [0, 0, 0.5], static: true}]\n"
    )
    export_scene(room, tmp_path / f"file{suffix}")
    scene, read = imported(tmp_path / f"file{suffix}")
    names = {entry["name"] for entry in scene["objects"]}
    assert {"block", "floor"} <= names
    assert "outside" not in names
    assert any("windows, was left out" in note for note in read.notes)
