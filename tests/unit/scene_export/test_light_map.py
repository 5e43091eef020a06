"""Baked light in a file: what a texel and its intensity tell is what the layers add up to."""

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
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.colour import linear_from_srgb
from tests.support.baked import GRID, SIZE, chart, layer
from tests.unit.scene_export.test_glb import Glb

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


@pytest.mark.parametrize(
    ("name", "light", "match"),
    [
        ("lit.usda", "baked", "glb alone"),
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
