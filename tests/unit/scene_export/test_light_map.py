"""Baked light in a file: what a texel and its intensity tell is what the layers add up to.

In USD it has the colour of its surface, too: UsdPreviewSurface cannot multiply them.
"""

from __future__ import annotations

import dataclasses
import io
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene_export import export_scene
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.gathering import exported_world
from sailenv_ros.scene_export.glb import write_glb
from sailenv_ros.scene_export.lit_picture import lit_picture
from sailenv_ros.scene_export.usd import write_usda
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.model import Material
from sailenv_ros.viewer.export_files import exported_file
from tests.support.baked import GRID, SIZE, chart, layer
from tests.unit.scene_export.test_glb import Glb
from tests.unit.scene_export.usda import Prim, read_usda

SCENE = """
version: 1
settled: false
lights:
  - {name: lamp, type: point, position: [0, 0, 3], colour: [1, 0.5, 0.25], intensity: 8}
objects:
  - {name: block, asset: cube, position: [0, 0, 0.5], static: true}
  - {name: twin, asset: cube, position: [2, 0, 0.5], static: true}
  - {name: ball, asset: sphere, position: [0, 2, 1]}
"""
DIRECT = np.linspace(0.0, 0.5, SIZE)[None, :]
AROUND = 0.25


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("lit") / "lit.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def lit(path: Path) -> Iterator[ExportedScene]:
    with closing(SceneLibrary(baked_light=False).build(path)) as world:
        (lamp,) = world.contents.lights
        drawn = {one.instance.name: one for one in world.contents.instances}
        block, twin = (drawn[name] for name in ("block", "twin"))
        poses = [world.body(one.instance.id).pose() for one in (block, twin)]
        first = chart(block.model, poses[0])
        charts = {
            block.instance.id: first,
            twin.instance.id: dataclasses.replace(first, world_from_body=poses[1].matrix()),
        }
        world.set_baked(
            BakedLight(
                fingerprint="made by hand",
                charts=charts,
                layers=(layer(None, bounced=AROUND), layer(lamp, direct=DIRECT)),
                probes=GRID,
            )
        )
        yield exported_world(world, light="baked")


def test_texels_are_the_sum_of_layers(lit: ExportedScene) -> None:
    light = lit.light_map
    assert light is not None
    told = linear_from_srgb(light.texture[..., :3] / 255.0) * light.white
    power = 8.0 * np.array([1.0, 0.5, 0.25])
    expected = AROUND + DIRECT[..., None].astype(np.float16) * power
    expected = np.broadcast_to(expected.clip(max=light.white), told.shape)
    # A step of 8 bits is 1/255 of sRGB.
    np.testing.assert_allclose(told, expected, atol=0.012 * light.white)


def test_vertices_find_their_light(lit: ExportedScene) -> None:
    glb = Glb(write_glb(lit, "").data)
    assert glb.tree["extensionsUsed"] == ["MOZ_lightmap"]
    assert not any("extensions" in node for node in glb.tree["nodes"])
    meshes = [glb.tree["meshes"][glb.nodes[name]["mesh"]] for name in ("block", "twin", "ball")]
    block, twin, ball = (mesh["primitives"][0] for mesh in meshes)
    assert block["attributes"]["POSITION"] == twin["attributes"]["POSITION"]
    uvs = lit.by_name["block"].pieces[0].parts[0].mesh.uvs
    places = glb.array(block["attributes"]["TEXCOORD_1"])
    np.testing.assert_allclose(places, 4 / SIZE + uvs * (SIZE - 8) / SIZE, atol=1e-6)
    assert "TEXCOORD_1" not in ball["attributes"]
    found = glb.tree["materials"][block["material"]]["extensions"]["MOZ_lightmap"]
    assert lit.light_map is not None
    assert (found["texCoord"], found["intensity"]) == (1, lit.light_map.white)
    image = glb.tree["images"][glb.tree["textures"][found["index"]]["source"]]
    view = glb.tree["bufferViews"][image["bufferView"]]
    data = glb.binary[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]
    with Image.open(io.BytesIO(data)) as picture:
        np.testing.assert_array_equal(np.asarray(picture), lit.light_map.texture)
    assert "extensions" not in glb.tree["materials"][ball["material"]]


def with_material(scene: ExportedScene, name: str, material: Material) -> ExportedScene:
    """Return a scene in which one body is of another material."""
    body = scene.by_name[name]
    (piece,) = body.pieces
    parts = tuple(dataclasses.replace(part, material=material) for part in piece.parts)
    made = dataclasses.replace(piece, parts=parts)
    bodies = [
        dataclasses.replace(one, pieces=(made,)) if one is body else one for one in scene.bodies
    ]
    return dataclasses.replace(scene, bodies=tuple(bodies))


def test_a_picture_of_lit_surfaces_is_light_times_colour(lit: ExportedScene) -> None:
    """The left half of the texture is red, its right half green; rows of its top are half grey."""
    assert lit.light_map is not None
    texture = np.zeros((16, 16, 4), np.uint8)
    texture[:, :8, 0] = texture[:, 8:, 1] = 255
    texture[:4] = 188
    material = Material(base_colour=(1.0, 0.5, 1.0, 1.0), base_colour_texture=texture)
    painted = with_material(with_material(lit, "block", material), "twin", material)
    found = linear_from_srgb(lit_picture(painted)[..., :3] / 255.0)
    assert found.shape == (4 * SIZE, 4 * SIZE, 3)  # four times as fine
    arrives = linear_from_srgb(lit.light_map.texture[0, :, :3] / 255.0)
    near, far = SIZE // 4 + 2, SIZE // 2 + 6  # columns of texels
    light = [arrives[near : near + 2].mean(axis=0), arrives[far : far + 2].mean(axis=0)]
    # v grows upwards in textures, with rows in light maps.
    top, bottom, steps = 3 * SIZE, SIZE // 2 + 6, slice(4 * near + 2, 4 * near + 6)
    np.testing.assert_allclose(found[bottom, steps].mean(axis=0), light[0] * (1, 0, 0), atol=0.01)
    steps = slice(4 * far + 2, 4 * far + 6)
    np.testing.assert_allclose(found[bottom, steps].mean(axis=0), light[1] * (0, 0.5, 0), atol=0.01)
    grey = linear_from_srgb(188 / 255.0)
    expected = grey * light[1] * (1.0, 0.5, 1.0)
    np.testing.assert_allclose(found[top, steps].mean(axis=0), expected, atol=0.01)


@pytest.mark.parametrize(
    ("material", "shines"),
    [
        (Material(base_colour=(1.0, 1.0, 1.0, 1.0)), True),
        (Material(base_colour=(1.0, 1.0, 1.0, 1.0), metallic=1.0), False),
        (Material(base_colour=(1.0, 1.0, 1.0, 1.0), emission=(1.0, 1.0, 1.0)), False),
        (Material(base_colour=(1.0, 1.0, 1.0, 0.3), alpha="blend"), False),
    ],
    ids=["matt", "metal", "emits", "glass"],
)
def test_metal_glass_and_what_emits_take_no_light(
    lit: ExportedScene, material: Material, shines: bool
) -> None:
    scene = with_material(with_material(lit, "block", material), "twin", material)
    assert (lit_picture(scene)[..., :3].max() > 0) == shines


def test_usd_shines_by_that_picture(lit: ExportedScene) -> None:
    written = write_usda(lit, "lit_usda")
    prims = read_usda(written.data)[1]
    meshes = {name: _mesh(prims, name) for name in ("block", "twin", "ball")}
    assert lit.light_map is not None
    for name in ("block", "twin"):
        uvs = lit.by_name[name].pieces[0].parts[0].mesh.uvs
        places = meshes[name].numbers("primvars:st1").reshape(-1, 2)
        # v grows upwards.
        expected = np.array([0.0, 1.0]) + (4 / SIZE + uvs * (SIZE - 8) / SIZE) * (1.0, -1.0)
        np.testing.assert_allclose(places, expected, atol=1e-6)
    (path,) = meshes["block"].targets("material:binding")
    surface, light = prims[f"{path}/surface"], prims[f"{path}/light"]
    assert surface.numbers("inputs:diffuseColor").tolist() == [0.0, 0.0, 0.0]
    assert surface.targets("inputs:emissiveColor.connect") == [f"{path}/light.outputs:rgb"]
    assert light.numbers("inputs:scale").tolist() == [*[lit.light_map.white] * 3, 1.0]
    assert light.targets("inputs:st.connect") == [f"{path}/st1.outputs:result"]
    file = light.values["inputs:file"].strip("@").rpartition("/")[2]
    with Image.open(io.BytesIO(written.beside[file])) as picture:
        assert picture.size == (4 * SIZE, 4 * SIZE)
    assert "primvars:st1" not in meshes["ball"].values
    (plain,) = meshes["ball"].targets("material:binding")
    assert "inputs:emissiveColor.connect" not in prims[f"{plain}/surface"].values
    assert any(path.startswith("/lit/Lights/") for path in prims)  # for what has no light map


def _mesh(prims: dict[str, Prim], name: str) -> Prim:
    (found,) = (
        prim
        for path, prim in prims.items()
        if prim.kind == "Mesh" and path.startswith(f"/lit/Objects/{name}/geometry")
    )
    return found


def test_the_viewer_offers_light_that_is_there(path: Path) -> None:
    with Simulation(path, mode="lockstep", light="plain") as simulation:
        name, data = exported_file(simulation, ".glb")
        assert (name, data[:4]) == ("lit.glb", b"glTF")
        with pytest.raises(InvalidRequest, match="is not baked"):
            exported_file(simulation, ".glb", "baked")


@pytest.mark.parametrize(
    ("name", "light", "match"),
    [
        ("lit.sdf", "baked", "glb, .usda, .usdz alone"),
        ("lit.glb", "sunny", "lamps, baked"),
        ("lit.glb", "baked", "is not baked"),
    ],
)
def test_light_that_is_not_there_is_refused(
    name: str, light: str, match: str, path: Path, tmp_path: Path
) -> None:
    with pytest.raises(InvalidRequest, match=match):
        export_scene(path, tmp_path / name, light=light)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())
