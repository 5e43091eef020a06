"""Other materials on what was baked: the light map stays where it was, corner by corner."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.material_library import MaterialLibrary
from sailenv_ros.assets.model_materials import finished
from sailenv_ros.assets.pictures import Pictures
from sailenv_ros.render.scene.drawn_meshes import drawn_meshes
from sailenv_ros.scene.spec_materials import MaterialSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Model
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.baked import baked, chart, layer
from tests.support.tiny_scenes import Thing, camera_at, snapshot_of

AHEAD = Pose((2.0, 0.0, 0.0))


def exchanged(model: Model) -> Model:
    specs = [MaterialSpec.model_validate({"material": "stone_tiles", "tile": 0.4})]
    return finished(model, specs, MaterialLibrary(AssetLibrary(), Pictures()), (1.0, 1.0, 1.0))


def corner_places(snapshot: WorldSnapshot) -> NDArray[np.float32]:
    """(T, 3, 5): position and place in the light map of each corner that is drawn."""
    mesh = drawn_meshes(snapshot.contents)[0][0]
    vertices = mesh.interleaved()
    drawn = np.concatenate([vertices["position"], vertices["light_uv"]], axis=1)
    return np.asarray(drawn[mesh.triangles])


def test_corners_keep_their_places_in_the_light_map() -> None:
    for name in ("cube", "sphere", "cylinder"):
        model = AssetLibrary().get(name).model
        other = exchanged(model)
        for baked_for, drawn in ((model, other), (other, model), (model, model)):
            light = baked({1: chart(baked_for, AHEAD)}, [])
            places = [
                corner_places(snapshot_of([Thing(one, AHEAD)], baked=light))
                for one in (baked_for, drawn)
            ]
            np.testing.assert_array_equal(*places)


def test_picture_shows_the_light_of_the_bake(render: Render) -> None:
    """A surface of another material is as bright as its albedo times what was baked there."""
    cube = AssetLibrary().get("cube").model
    grey, red = (
        finished(
            cube,
            [MaterialSpec.model_validate({"colour": colour, "roughness": 1.0})],
            MaterialLibrary(AssetLibrary()),
            (1.0, 1.0, 1.0),
        )
        for colour in ([0.5, 0.5, 0.5], [0.5, 0.1, 0.1])
    )
    light = baked({1: chart(cube, AHEAD)}, [], layer(None, bounced=0.5))
    pictures = {}
    for name, model in (("grey", grey), ("red", red)):
        snapshot = snapshot_of([Thing(model, AHEAD)], lights=(), baked=light)
        camera = camera_at(width=64, height=48)
        camera = replace(camera, picture=PictureSettings(smooth_edges=False))
        seen = render(snapshot, camera, "rgb", "albedo", "instance")
        inside = seen["instance"] == 1
        pictures[name] = seen["rgb"][inside].astype(int), seen["albedo"][inside]
    assert np.abs(pictures["grey"][0][:, 0] - pictures["red"][0][:, 0]).max() <= 6
    assert (pictures["grey"][0][:, 1] - pictures["red"][0][:, 1]).min() > 40
