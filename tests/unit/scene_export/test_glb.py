"""glTF: poses, triangles, lights, lenses and labels of a file are the scene's; we read it back."""

from __future__ import annotations

import dataclasses
import json
import math
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from numpy.typing import NDArray
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

from sailenv_content.scene_import.importers import import_scene
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.glb import write_glb
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import LUMENS_PER_WATT
from sailenv_ros.world.world import World

WORLD_FROM_FILE = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


class Glb:
    """A binary glTF file taken apart, without any library."""

    def __init__(self, data: bytes) -> None:
        magic, version, size, length, kind = struct.unpack_from("<4sII I4s", data)
        assert (magic, version, size, kind) == (b"glTF", 2, len(data), b"JSON")
        self.tree: dict[str, Any] = json.loads(data[20 : 20 + length])
        self.binary = data[28 + length :]
        self.nodes = {node["name"]: node for node in self.tree["nodes"]}

    def array(self, number: int) -> NDArray[Any]:
        accessor = self.tree["accessors"][number]
        view = self.tree["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[accessor["type"]]
        first = view["byteOffset"] + accessor["byteOffset"]
        found = np.frombuffer(self.binary, kind, accessor["count"] * width, first)
        return found.reshape(accessor["count"], width)

    def pose(self, name: str) -> NDArray[np.float64]:
        """(4, 4) world_from_node, both in our axes."""
        node = self.nodes[name]
        turn = Rotation.from_quat(node.get("rotation", (0, 0, 0, 1))).as_matrix()
        matrix = np.eye(4)
        matrix[:3, :3] = WORLD_FROM_FILE @ turn @ WORLD_FROM_FILE.T
        matrix[:3, 3] = WORLD_FROM_FILE @ node.get("translation", (0, 0, 0))
        return matrix

    def direction(self, name: str) -> NDArray[np.float64]:
        """(3,) where what looks along its node's -z looks, in the world."""
        turn = Rotation.from_quat(self.nodes[name]["rotation"])
        return np.asarray(WORLD_FROM_FILE @ turn.apply((0.0, 0.0, -1.0)))


@pytest.fixture(scope="module")
def data(scene: ExportedScene) -> bytes:
    return write_glb(scene, "little_glb").data


@pytest.fixture(scope="module")
def glb(data: bytes) -> Glb:
    return Glb(data)


def test_every_body_is_where_it_is(glb: Glb, world: World) -> None:
    """Also what stands open on its joint."""
    for body in world.bodies:
        name = body.placement.name
        assert np.abs(glb.pose(name) - body.world_from_body()).max() < 1e-12, name
    assert np.abs(glb.pose("cabinet door")[:3, :3] - np.eye(3)).max() > 0.1


def test_scales_go_with_the_axes(glb: Glb) -> None:
    """The file's x, y, z are the body's y, z, x."""
    assert glb.nodes["cabinet"]["scale"] == [0.8, 0.9, 0.5]


def test_triangles_are_the_models_own(glb: Glb, scene: ExportedScene) -> None:
    """Vertices, normals, texture coordinates and indices, bit for bit but for v."""
    for body in scene.bodies:
        for piece in body.pieces:
            node = glb.nodes[piece.instance.name]
            primitives = glb.tree["meshes"][node["mesh"]]["primitives"]
            for part, primitive in zip(piece.parts, primitives, strict=True):
                of = primitive["attributes"]
                positions = glb.array(of["POSITION"]) @ WORLD_FROM_FILE.T
                assert np.array_equal(positions, part.mesh.positions)
                normals = glb.array(of["NORMAL"]) @ WORLD_FROM_FILE.T
                assert np.abs(normals - part.mesh.normals).max() < 2e-6
                uvs = glb.array(of["TEXCOORD_0"])
                assert np.abs(uvs * (1, -1) + (0, 1) - part.mesh.uvs).max() < 1e-6
                indices = glb.array(primitive["indices"]).reshape(-1, 3)
                assert np.array_equal(indices, part.mesh.triangles)


def test_equal_things_are_written_once(glb: Glb) -> None:
    """Two balls of one colour are one mesh with one material."""
    assert glb.nodes["ball"]["mesh"] == glb.nodes["second ball"]["mesh"]
    colours = [json.dumps(material, sort_keys=True) for material in glb.tree["materials"]]
    assert len(set(colours)) == len(colours)


def test_labels_stand_in_extras(glb: Glb, scene: ExportedScene) -> None:
    """Categories, ids, masses, joints; labelled parts are children of their bodies."""
    told = {name: node["extras"] for name, node in glb.nodes.items() if "mesh" in node}
    for body in scene.bodies:
        for piece in body.pieces:
            extras = told[piece.instance.name]
            assert extras["instance_id"] == piece.instance.id
            assert extras["category"] == piece.instance.category
    assert told["ball"]["mass_kg"] == 0.7
    assert told["cabinet door"]["joint"]["limits"] == [-1.9, 0.2]
    door = glb.nodes["wardrobe door 1"]
    children = [glb.tree["nodes"][number]["name"] for number in door["children"]]
    assert children
    assert all(child.startswith("wardrobe door 1/") for child in children)


def test_lights_have_their_power(glb: Glb, scene: ExportedScene) -> None:
    """In candela and lux; an area is a spot of the same power."""
    lights = {one["name"]: one for one in glb.tree["extensions"]["KHR_lights_punctual"]["lights"]}
    assert lights["sun"]["intensity"] == pytest.approx(2.0 * LUMENS_PER_WATT)
    assert lights["bulb"]["intensity"] == pytest.approx(8.0 * LUMENS_PER_WATT)
    assert lights["bulb"]["color"] == pytest.approx([1.0, 0.8, 0.6])
    assert lights["bulb"]["range"] == 7.0
    assert lights["panel"]["intensity"] == pytest.approx(3.0 * 2.0 * 0.5 * LUMENS_PER_WATT)
    assert lights["spot"]["spot"]["outerConeAngle"] == pytest.approx(math.radians(40.0))
    for light in scene.lights:
        if light.type != "point":
            assert np.abs(glb.direction(light.name) - light.direction).max() < 1e-9
        if light.type != "directional":
            assert np.abs(glb.pose(light.name)[:3, 3] - light.position_m).max() < 1e-12


def test_cameras_look_where_agents_look(glb: Glb, scene: ExportedScene) -> None:
    """A pin-hole's angle is exact; a fisheye is in extras, and told as lost."""
    eye, _fish = scene.cameras
    assert np.abs(glb.direction("eye") - eye.pose.matrix()[:3, 0]).max() < 1e-12
    assert np.abs(glb.direction("fish") - (1.0, 0.0, 0.0)).max() < 1e-12
    held = glb.tree["cameras"][glb.nodes["eye"]["camera"]]
    assert held["perspective"]["yfov"] == pytest.approx(math.radians(50.0))
    assert held["perspective"]["aspectRatio"] == pytest.approx(320 / 240)
    lens = glb.tree["cameras"][glb.nodes["fish"]["camera"]]["extras"]
    assert (lens["distortion_model"], lens["fx"]) == ("equidistant", 90.0)
    losses = " ".join(write_glb(scene, "").losses)
    assert "lenses of 1 camera" in losses
    assert "collision shapes" in losses


def test_the_same_scene_gives_the_same_bytes(scene: ExportedScene, data: bytes) -> None:
    assert write_glb(scene, "little_glb").data == data


def test_strong_emission_has_the_extension(scene: ExportedScene) -> None:
    """Factors above 1 are a factor and a strength."""
    body = scene.by_name["ball"]
    (part,) = body.pieces[0].parts
    material = dataclasses.replace(part.material, emission=(4.0, 2.0, 0.0))
    piece = dataclasses.replace(
        body.pieces[0], parts=(dataclasses.replace(part, material=material),)
    )
    lit = dataclasses.replace(scene, bodies=(dataclasses.replace(body, pieces=(piece,)),))
    glb = Glb(write_glb(lit, "").data)
    (held,) = glb.tree["materials"]
    assert held["emissiveFactor"] == [1.0, 0.5, 0.0]
    strength = held["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
    assert strength == 4.0
    assert "KHR_materials_emissive_strength" in glb.tree["extensionsUsed"]


def test_the_importer_reads_it_back(data: bytes, scene: ExportedScene, tmp_path: Path) -> None:
    """The same names, categories, lights, and every vertex in its place."""
    file = tmp_path / "little.glb"
    file.write_bytes(data)
    import_scene(file, tmp_path / "again.yaml", tmp_path / "pack")
    found = yaml.safe_load((tmp_path / "again.yaml").read_text(encoding="utf-8"))
    pack = AssetPack(tmp_path / "pack")
    objects = {entry["name"]: entry for entry in found["objects"]}
    pieces = {
        piece.instance.name.replace("/", " "): (body, piece)
        for body in scene.bodies
        for piece in body.pieces
    }
    assert set(objects) == set(pieces)
    for name, (body, piece) in pieces.items():
        asset = pack.load(objects[name]["asset"])
        assert asset.category == piece.instance.category, name
        place = Pose.from_rpy_deg(objects[name]["position"], objects[name].get("rotation", [0] * 3))
        read = _corners([part.mesh.positions[part.mesh.triangles] for part in asset.model.parts])
        own = _corners([part.mesh.positions[part.mesh.triangles] for part in piece.parts])
        read = read @ place.matrix()[:3, :3].T + place.position_m
        own = (own * body.scale) @ body.pose.matrix()[:3, :3].T + body.pose.position_m
        assert len(read) == len(own)
        # The scene file's positions end with a hundredth of a millimetre.
        assert _apart(read, own) < 2e-5, name
    intensities = {light["name"]: light["intensity"] for light in found["lights"]}
    assert intensities["bulb"] == pytest.approx(8.0)
    eye = next(agent for agent in found["agents"] if agent["name"].endswith("eye"))
    assert eye["rotation"] == pytest.approx([0.0, 20.0, 15.0], abs=1e-3)
    assert eye["vertical_fov"] == pytest.approx(50.0, abs=1e-3)


def _corners(triangles: list[NDArray[Any]]) -> NDArray[np.float64]:
    return np.concatenate(triangles).reshape(-1, 3).astype(np.float64)


def _apart(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Greatest distance from the middle of a triangle to the nearest one's of the other [m]."""
    middles = [points.reshape(-1, 3, 3).mean(axis=1) for points in (first, second)]
    ways = [KDTree(a).query(b)[0] for a, b in (middles, middles[::-1])]
    return float(max(way.max() for way in ways))
