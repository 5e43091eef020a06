"""Materials by name, pictures of users, and how they lie on a mesh."""

from __future__ import annotations

import io
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.box_mapping import box_mapped
from sailenv_ros.assets.material_library import MaterialLibrary
from sailenv_ros.assets.model_materials import finished
from sailenv_ros.assets.pictures import MAX_PICTURE_BYTES, Pictures, checked_picture
from sailenv_ros.errors import AssetError, InvalidRequest, InvalidState, UnknownName
from sailenv_ros.scene.spec_materials import LookSpec, MaterialSpec
from sailenv_ros.types.model import Material


def picture(width: int = 8, height: int = 4, kind: str = "PNG", colour: int = 200) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (width, height), (colour, 10, 20)).save(file, kind)
    return file.getvalue()


def stock(folder: Path | None = None, pictures: Pictures | None = None) -> MaterialLibrary:
    return MaterialLibrary(AssetLibrary(), pictures, () if folder is None else (folder,))


class TestPictures:
    @pytest.mark.parametrize(("kind", "ending"), [("PNG", ".png"), ("JPEG", ".jpg")])
    def test_name_is_that_of_the_content(self, kind: str, ending: str) -> None:
        first, second = Pictures(), Pictures()
        assert first.add(picture(kind=kind)) == second.add(picture(kind=kind))
        assert first.add(picture(kind=kind)).endswith(ending)
        assert first.add(picture(kind=kind, colour=90)) != first.add(picture(kind=kind))

    def test_file_is_found_beside_and_in_pictures(self, tmp_path: Path) -> None:
        (tmp_path / "pictures").mkdir()
        (tmp_path / "pictures" / "brick.png").write_bytes(picture(16, 8))
        found = Pictures().texture("brick.png", [tmp_path])
        assert found.shape == (8, 16, 4)
        assert found[0, 0].tolist() == [200, 10, 20, 255]
        assert not found.flags.writeable

    @pytest.mark.parametrize("name", ["../secret.png", "/etc/passwd", "a\\b.png", "..", ""])
    def test_name_leads_out_of_no_folder(self, tmp_path: Path, name: str) -> None:
        (tmp_path / "secret.png").write_bytes(picture())
        inner = tmp_path / "inner"
        inner.mkdir()
        with pytest.raises(AssetError):
            Pictures().texture(name, [inner])

    def test_large_picture_is_made_smaller(self) -> None:
        pictures = Pictures()
        name = pictures.add(picture(2048, 1024, "JPEG"))
        assert pictures.texture(name, []).shape == (512, 1024, 4)

    @pytest.mark.parametrize(
        "data",
        [
            b"",
            b"GIF89a" + bytes(100),
            b"\x89PNG\r\n\x1a\n" + bytes(50),
            b"<svg xmlns='http://www.w3.org/2000/svg'/>",
            bytes(MAX_PICTURE_BYTES + 1),
            "a text",
            None,
        ],
    )
    def test_what_is_no_picture_is_refused(self, data: object) -> None:
        with pytest.raises(InvalidRequest):
            Pictures().add(data)

    def test_bomb_is_refused_by_its_head(self) -> None:
        head = struct.pack(">IIBBBBB", 100_000, 100_000, 8, 2, 0, 0, 0)
        chunk = b"IHDR" + head
        crc = struct.pack(">I", zlib.crc32(chunk))
        bomb = b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk + crc + bytes(200)
        with pytest.raises(InvalidRequest):
            checked_picture(bomb)

    def test_cut_off_picture_is_refused(self) -> None:
        whole = picture(300, 300, "JPEG")
        with pytest.raises(InvalidRequest, match="whole"):
            Pictures().add(whole[: len(whole) // 2])

    def test_number_that_may_be_sent_is_limited(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr("sailenv_ros.assets.pictures.MAX_SENT", 2)
        pictures = Pictures()
        kept = [pictures.add(picture(colour=colour)) for colour in (1, 2)]
        with pytest.raises(InvalidState):
            pictures.add(picture(colour=3))
        assert pictures.add(picture(colour=1)) == kept[0]


class TestMaterialStock:
    def test_surface_has_its_own_size(self) -> None:
        finish = stock().finish(LookSpec(material="oak_planks", turn=90))
        assert finish.tile_m is not None
        assert finish.turn_deg == 90.0
        assert finish.material.base_colour_texture is not None

    def test_tile_colour_and_finish(self) -> None:
        look = LookSpec.model_validate(
            {"material": "plaster", "tile": 2, "roughness": 0.1, "metallic": 1, "tint": [1, 0.5, 0]}
        )
        finish = stock().finish(look)
        assert finish.tile_m == (2.0, 2.0)
        assert finish.material.base_colour == (1.0, 0.5, 0.0, 1.0)
        assert (finish.material.roughness, finish.material.metallic) == (0.1, 1.0)
        assert finish.material.metallic_roughness_texture is None
        assert finish.material.normal_texture is not None

    def test_material_of_a_model(self) -> None:
        assets = AssetLibrary()
        cube = assets.get("cube").model.parts[0].material
        finish = MaterialLibrary(assets).finish(LookSpec(material=f"cube/{cube.name}"))
        assert finish.material is cube
        assert "there is no material of cube" in stock().fault("cube/nothing")
        assert "there is no asset" in stock().fault("nothing/at_all")
        assert not stock().fault(f"cube/{cube.name}")

    def test_picture_is_multiplied_by_its_colour(self, tmp_path: Path) -> None:
        (tmp_path / "one.png").write_bytes(picture())
        look = LookSpec.model_validate({"picture": "one.png", "colour": [0.5, 0.25, 1.0]})
        finish = stock(tmp_path).finish(look)
        assert finish.material.base_colour[:3] == (0.5, 0.25, 1.0)
        assert finish.tile_m == (1.0, 1.0)

    def test_unknown_material(self) -> None:
        with pytest.raises(UnknownName):
            stock().finish(LookSpec(material="marzipan"))


class TestBoxMapping:
    def test_texture_has_its_real_size_from_every_side(self) -> None:
        mesh = AssetLibrary().get("cube").model.parts[0].mesh
        scale = (2.0, 1.0, 0.5)
        mapped = box_mapped(mesh, (0.5, 0.5), turn_deg=30.0, scale=scale)
        corners = (mapped.positions * np.array(scale))[mapped.triangles].astype(float)
        places = mapped.uvs[mapped.triangles] * 0.5
        for one, two in ((0, 1), (1, 2), (2, 0)):
            real = np.linalg.norm(corners[:, one] - corners[:, two], axis=1)
            laid = np.linalg.norm(places[:, one] - places[:, two], axis=1)
            np.testing.assert_allclose(laid, real, atol=1e-5)

    def test_triangles_keep_their_order_and_place(self) -> None:
        mesh = AssetLibrary().get("sphere").model.parts[0].mesh
        mapped = box_mapped(mesh, (1.0, 1.0), turn_deg=0.0, scale=(1.0, 1.0, 1.0))
        np.testing.assert_array_equal(
            mapped.positions[mapped.triangles], mesh.positions[mesh.triangles]
        )
        assert box_mapped(mesh, (1.0, 1.0), turn_deg=0.0, scale=(1.0, 1.0, 1.0)) is mapped

    def test_text_reads_from_the_left_on_every_side(self) -> None:
        mesh = AssetLibrary().get("cube").model.parts[0].mesh
        mapped = box_mapped(mesh, (1.0, 1.0), turn_deg=0.0, scale=(1.0, 1.0, 1.0))
        a, b, c = (mapped.uvs[mapped.triangles[:, corner]] for corner in range(3))
        # Counter-clockwise from outside stays counter-clockwise in the picture.
        turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
        assert (turn > 0.0).all()


class TestFinishing:
    def test_equal_materials_give_the_same_object(self) -> None:
        model = AssetLibrary().get("cube").model
        specs = [MaterialSpec(material="carpet")]
        one = finished(model, specs, stock(), (1.0, 1.0, 1.0))
        assert finished(model, specs, stock(), (1.0, 1.0, 1.0)) is one
        assert finished(model, [], stock(), (1.0, 1.0, 1.0)) is model
        assert one is not model

    def test_unknown_part(self) -> None:
        model = AssetLibrary().get("cube").model
        with pytest.raises(UnknownName):
            finished(model, [MaterialSpec(part="lid")], stock(), (1.0, 1.0, 1.0))


def test_emission_takes_the_place_of_a_lamps_glow() -> None:
    """What is given a light of its own no longer follows the lamp's; None leaves both."""
    shade = Material(name="shade", glow=(5.0, 5.0, 4.0))
    given = stock().finish(LookSpec(emission=(0.3, 0.2, 0.1)), shade).material
    assert (given.emission, given.glow) == ((0.3, 0.2, 0.1), (0.0, 0.0, 0.0))
    kept = stock().finish(LookSpec(roughness=0.2), shade).material
    assert (kept.emission, kept.glow) == ((0.0, 0.0, 0.0), (5.0, 5.0, 4.0))
