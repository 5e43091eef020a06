"""A user's own model becomes an asset of the right size, or is refused and leaves nothing."""

from __future__ import annotations

import tempfile
import zipfile
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.assets import AssetLibrary, importing
from sailenv_ros.assets.glb import glb_bytes, read_glb
from sailenv_ros.assets.importing import import_asset
from sailenv_ros.assets.own_pack import add_to_own_pack
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.errors import AssetError, InvalidRequest, NameTaken
from sailenv_ros.types.model import Asset, ConvexShape

TABLE_OBJ = """mtllib table.mtl
v -1 0 -2\nv 1 0 -2\nv 1 0 2\nv -1 0 2\nv -1 3 -2\nv 1 3 -2\nv 1 3 2\nv -1 3 2
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl oak
f 4/1 3/2 2/3 1/4
f 5/1 6/2 7/3 8/4
f 1/1 2/2 6/3 5/4
f 2/1 3/2 7/3 6/4
f 3/1 4/2 8/3 7/4
f 4/1 1/2 5/3 8/4
"""


@pytest.fixture(autouse=True)
def own_places(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep the user's own packs and temporary files out of it."""
    (tmp_path / "scratch").mkdir()
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "scratch"))


@pytest.fixture
def table_obj(tmp_path: Path) -> Path:
    (tmp_path / "table.obj").write_text(TABLE_OBJ)
    (tmp_path / "table.mtl").write_text("newmtl oak\nKd 1 1 1\nmap_Kd oak.png\n")
    Image.new("RGB", (4, 4), (120, 80, 40)).save(tmp_path / "oak.png")
    return tmp_path / "table.obj"


@pytest.fixture
def table_zip(tmp_path: Path, table_obj: Path) -> Path:
    with zipfile.ZipFile(tmp_path / "table.zip", "w") as archive:
        for name in ("table.obj", "table.mtl", "oak.png"):
            archive.write(tmp_path / name, f"table/{name}")
    return tmp_path / "table.zip"


def test_an_obj_stands_on_its_base_in_our_axes(table_obj: Path) -> None:
    """File (x right, y up, z front) becomes body (x front, y left, z up), base at the origin."""
    asset = import_asset(table_obj, name="table", category="desk", height_m=0.75)
    np.testing.assert_allclose(
        asset.model.bounds(), [[-0.5, -0.25, 0.0], [0.5, 0.25, 0.75]], atol=1e-6
    )
    (part,) = asset.model.parts
    assert part.material.base_colour_texture is not None
    assert part.material.base_colour_texture[0, 0].tolist() == [120, 80, 40, 255]
    (hull,) = asset.collision
    assert isinstance(hull, ConvexShape)
    np.testing.assert_allclose(hull.points.max(axis=0), [0.5, 0.25, 0.75], atol=1e-4)


def test_a_zip_gives_the_same_as_its_files(table_obj: Path, table_zip: Path) -> None:
    """An archive with OBJ, MTL and picture is as good as the three files."""
    loose = import_asset(table_obj, name="table", category="desk", height_m=1.0)
    packed = import_asset(table_zip, name="table", category="desk", height_m=1.0)
    np.testing.assert_array_equal(
        loose.model.parts[0].mesh.positions, packed.model.parts[0].mesh.positions
    )


def test_a_glb_keeps_its_size_without_a_height(tmp_path: Path) -> None:
    """glTF is in metres: a cube of 1 m stays one."""
    cube = Primitives().load("cube")
    (tmp_path / "cube.glb").write_bytes(glb_bytes(cube.model.parts, ()))
    asset = import_asset(tmp_path / "cube.glb", name="my_cube", category="box", convex=False)
    np.testing.assert_allclose(asset.model.bounds(), [[-0.5, -0.5, 0], [0.5, 0.5, 1]], atol=1e-6)


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.glb", b"glTF\x02\x00\x00\x00junk"),
        ("a.glb", b""),
        ("a.obj", b"v 1 2\nf 1 2 3\n"),
        ("a.obj", b"# nothing\n"),
        ("a.obj", b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        ("a.gltf", b'{"asset": {"version": "2.0"}, "buffers": [{"uri": "/etc/passwd"}]}'),
        ("a.stl", b"solid\n"),
        ("a.zip", b"PK\x05\x06" + bytes(18)),
        ("a.zip", b"no zip at all"),
    ],
)
def test_malformed_files_are_refused_and_leave_nothing(
    tmp_path: Path, name: str, content: bytes
) -> None:
    """The error is ours and names the file; no temporary folder stays."""
    (tmp_path / name).write_bytes(content)
    with pytest.raises(AssetError):
        import_asset(tmp_path / name, name="a", category="box")
    assert list((tmp_path / "scratch").iterdir()) == []


def test_an_archive_with_two_models_is_refused(tmp_path: Path, table_obj: Path) -> None:
    """Which one was meant cannot be known."""
    with zipfile.ZipFile(tmp_path / "two.zip", "w") as archive:
        archive.write(table_obj, "a.obj")
        archive.write(table_obj, "b.obj")
    with pytest.raises(AssetError, match=r"one model file, and it holds: a\.obj, b\.obj"):
        import_asset(tmp_path / "two.zip", name="a", category="box")
    assert list((tmp_path / "scratch").iterdir()) == []


def test_files_outside_the_archive_are_not_read(tmp_path: Path) -> None:
    """A material's picture may not come from elsewhere on the machine."""
    Image.new("RGB", (2, 2), (1, 2, 3)).save(tmp_path / "secret.png")
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("a.obj", TABLE_OBJ.replace("table.mtl", "a.mtl"))
        archive.writestr("a.mtl", f"newmtl oak\nmap_Kd {tmp_path}/secret.png\n")
    asset = import_asset(tmp_path / "a.zip", name="a", category="box", height_m=1.0)
    assert asset.model.parts[0].material.base_colour_texture is None


def test_large_files_are_refused(
    tmp_path: Path, table_obj: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The limits are checked before the file is read."""
    monkeypatch.setattr(importing, "MAX_ARCHIVE_BYTES", 100)
    with pytest.raises(AssetError, match="larger than"):
        import_asset(table_obj, name="a", category="box")


@pytest.mark.parametrize("name", ["", "A", "1a", "a b", "../a", "a" * 64])
def test_names_that_are_no_catalogue_names_are_refused(table_obj: Path, name: str) -> None:
    """Names become file names."""
    with pytest.raises(InvalidRequest, match="asset name"):
        import_asset(table_obj, name=name, category="box")


def test_own_assets_are_there_afterwards_and_can_be_replaced(table_obj: Path) -> None:
    """What was added is found by its name; adding it again takes its place."""
    asset = import_asset(table_obj, name="my_table", category="desk", height_m=0.75)
    add_to_own_pack(asset, author="Ann", licence="CC0-1.0")
    entry = add_to_own_pack(asset, author="Ann", licence="CC0-1.0")
    found = AssetLibrary(installed_sources()).get("My Table")
    assert (found.name, found.category, entry.author) == ("my_table", "desk", "Ann")
    np.testing.assert_allclose(found.model.bounds(), asset.model.bounds(), atol=1e-6)
    assert len(found.collision) == len(asset.collision)


def test_a_name_of_another_pack_is_refused(table_obj: Path) -> None:
    """Nobody's furniture is replaced by accident, and nothing is written."""
    asset = import_asset(table_obj, name="chair_01", category="chair", height_m=1.0)
    with pytest.raises(NameTaken):
        add_to_own_pack(asset)
    with pytest.raises(NameTaken):
        add_to_own_pack(import_asset(table_obj, name="cube", category="cube", height_m=1.0))
    assert "My Table" not in AssetLibrary(installed_sources()).all_names


def test_an_asset_survives_the_file(tmp_path: Path) -> None:
    """Parts, materials and collision pieces of a model come back from its file."""
    for name in ("cube", "sphere", "cone"):
        asset: Asset = Primitives().load(name)
        hulls = [ConvexShape(points=asset.model.parts[0].mesh.positions.astype(np.float64))]
        data = glb_bytes(asset.model.parts, hulls)
        assert data == glb_bytes(asset.model.parts, hulls)
        (tmp_path / "a.glb").write_bytes(data)
        parts, back = read_glb(tmp_path / "a.glb")
        for part, original in zip(parts, asset.model.parts, strict=True):
            np.testing.assert_allclose(part.mesh.positions, original.mesh.positions, atol=1e-7)
            np.testing.assert_allclose(part.mesh.normals, original.mesh.normals, atol=1e-6)
            np.testing.assert_array_equal(part.mesh.triangles, original.mesh.triangles)
            np.testing.assert_allclose(part.mesh.uvs, original.mesh.uvs, atol=1e-6)
            assert part.material.roughness == original.material.roughness
        bounds = [back[0].points.min(axis=0), back[0].points.max(axis=0)]
        np.testing.assert_allclose(bounds, asset.model.bounds(), atol=1e-6)
