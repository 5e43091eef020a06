"""USD: poses, joints, shapes, lights and labels of the text are the scene's; packages align."""

from __future__ import annotations

import io
import math
import struct
import zipfile

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.trees import together
from sailenv_ros.scene_export.usd import write_usda, write_usdz
from sailenv_ros.scene_export.usd_text import quoted
from sailenv_ros.scene_export.usdz import usdz_bytes
from sailenv_ros.types.model import BoxShape
from sailenv_ros.world.kinematics import link_pose
from sailenv_ros.world.world import World
from tests.unit.scene_export.usda import Prim, frame, read_usda

OBJECTS = "/little/Objects"


@pytest.fixture(scope="module")
def layer(scene: ExportedScene) -> tuple[dict[str, str], dict[str, Prim]]:
    return read_usda(write_usda(scene, "little_usda").data)


@pytest.fixture(scope="module")
def prims(layer: tuple[dict[str, str], dict[str, Prim]]) -> dict[str, Prim]:
    return layer[1]


@pytest.fixture(scope="module")
def bodies(prims: dict[str, Prim]) -> dict[str, Prim]:
    """Prims of bodies by the names of these."""
    found = (one for path, one in prims.items() if path.rpartition("/")[0] == OBJECTS)
    return {one.metadata["displayName"].strip('"'): one for one in found}


def test_units_axes_and_root(layer: tuple[dict[str, str], dict[str, Prim]]) -> None:
    metadata, prims = layer
    assert metadata["metersPerUnit"] == metadata["kilogramsPerUnit"] == "1"
    assert metadata["upAxis"] == '"Z"'
    assert metadata["defaultPrim"] == '"little"'
    assert prims["/little"].metadata["kind"] == '"assembly"'
    assert all(path == "/little" or path.startswith("/little/") for path in prims)


def test_every_body_is_where_it_is(bodies: dict[str, Prim], world: World) -> None:
    assert set(bodies) == {body.placement.name for body in world.bodies}
    for body in world.bodies:
        pose = bodies[body.placement.name].pose()
        assert np.abs(pose - body.world_from_body()).max() < 1e-12


def test_joint_frames_move_as_ours_do(
    prims: dict[str, Prim], bodies: dict[str, Prim], world: World
) -> None:
    """Turned about the x axis of its frames, a body is where our kinematics put it."""
    joints = {joint.name: joint for joint in world.joints()}
    found = [prim for path, prim in prims.items() if path.startswith("/little/Joints/")]
    assert len(found) == len(joints) == 5
    for prim in found:
        name = prim.values["ros:joint:name"].strip('"')
        joint = joints[name]
        assert prim.targets("physics:body1") == [bodies[name].path]
        assert prim.targets("physics:body0") == [bodies[joint.parent].path]
        low, high = (
            math.radians(prim.numbers(f"physics:{end}Limit")[0]) for end in ("lower", "upper")
        )
        assert (low, high) == pytest.approx((joint.low, joint.high))
        body = world.body(joint.id)
        for position in (low, 0.37 * high, high):
            turn = np.eye(4)
            turn[1:3, 1:3] = [
                [math.cos(position), -math.sin(position)],
                [math.sin(position), math.cos(position)],
            ]
            carrier = bodies[joint.parent].pose()
            pose = carrier @ frame(prim, 0) @ turn @ np.linalg.inv(frame(prim, 1))
            placed = body.placement.joint
            assert placed is not None
            expected = link_pose(body.rest_pose(), placed, position).matrix()  # type: ignore[attr-defined]  # on a joint
            assert np.abs(pose - expected).max() < 1e-9


def test_meshes_are_the_models_own(prims: dict[str, Prim], scene: ExportedScene) -> None:
    """Points, triangles and scale of a scaled cylinder; two equal balls inherit one class."""
    part = scene.by_name["can"].pieces[0].parts[0]
    assert prims[f"{OBJECTS}/can/geometry"].numbers("xformOp:scale").tolist() == [0.1, 0.1, 0.2]
    mesh = prims[f"{OBJECTS}/can/geometry/mesh"]
    points = mesh.numbers("points").reshape(-1, 3).astype(np.float32)
    assert np.array_equal(points, part.mesh.positions)
    assert np.array_equal(mesh.numbers("faceVertexIndices"), part.mesh.triangles.reshape(-1))
    assert mesh.targets("material:binding")[0] in prims
    ball, other = (prims[f"{OBJECTS}/{name}/geometry"] for name in ("ball", "second_ball"))
    assert ball.metadata["inherits"] == other.metadata["inherits"]
    assert ball.metadata["instanceable"] == "true"


def test_labels(bodies: dict[str, Prim], prims: dict[str, Prim], scene: ExportedScene) -> None:
    """Categories as SemanticsLabelsAPI, ids beside; a labelled part has its own."""
    for body in scene.bodies:
        prim = bodies[body.name]
        assert '"SemanticsLabelsAPI:category"' in prim.metadata["apiSchemas"]
        assert prim.values["semantics:labels:category"] == f'["{body.instance.category}"]'
        assert prim.values["sailenv:instance_id"] == str(body.instance.id)
    handle = prims[f"{OBJECTS}/wardrobe_door_1/handle"]
    assert handle.values["semantics:labels:category"] == '["handle"]'


def test_physics(bodies: dict[str, Prim], prims: dict[str, Prim], scene: ExportedScene) -> None:
    """Masses, boxes, which bodies are rigid, and what does not collide."""
    ball, cabinet = bodies["ball"], bodies["cabinet"]
    assert ball.numbers("physics:mass").tolist() == [0.7]
    assert '"PhysicsRigidBodyAPI"' in ball.metadata["apiSchemas"]
    assert "PhysicsRigidBodyAPI" not in cabinet.metadata["apiSchemas"]
    shape = scene.by_name["cabinet"].shapes[0]
    assert isinstance(shape, BoxShape)
    box = prims[f"{OBJECTS}/cabinet/collision/shape_0"]
    assert box.numbers("xformOp:scale") == pytest.approx(shape.half_extents_m)
    assert '"PhysicsCollisionAPI"' in box.metadata["apiSchemas"]
    pairs = {(joint.joint.parent, joint.name) for joint in scene.bodies if joint.joint is not None}
    assert set(together(scene)) == pairs  # nothing but what joints keep apart anyway


def test_lights_and_lenses(prims: dict[str, Prim], scene: ExportedScene) -> None:
    """A ball of light has its radiant intensity, a panel its radiance; angles of view are exact."""
    bulb, panel = prims["/little/Lights/bulb"], prims["/little/Lights/panel"]
    radius = bulb.numbers("inputs:radius")[0]
    assert bulb.numbers("inputs:intensity")[0] * math.pi * radius**2 == pytest.approx(8.0)
    assert panel.numbers("inputs:intensity")[0] == pytest.approx(3.0)
    assert panel.pose()[:3, 2] == pytest.approx((0.0, -1.0, 0.0), abs=1e-9)  # it looks along -z
    eye = prims["/little/Cameras/eye"]
    tangent = 0.5 * eye.numbers("verticalAperture")[0] / eye.numbers("focalLength")[0]
    assert 2.0 * math.degrees(math.atan(tangent)) == pytest.approx(50.0)
    forward = scene.cameras[0].pose.matrix()[:3, 0]
    assert eye.pose()[:3, 2] == pytest.approx(-forward, abs=1e-12)


def test_a_package_aligns_its_files(scene: ExportedScene) -> None:
    """Each file begins at a multiple of 64 bytes; the layer is the first, pictures are beside."""
    data = write_usdz(scene, "").data
    assert data == write_usdz(scene, "other").data
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        assert package.testzip() is None
        names = package.namelist()
        assert names[0] == "little.usda"
        for entry in package.infolist():
            name, extra = struct.unpack_from("<HH", data, entry.header_offset + 26)
            assert (entry.header_offset + 30 + name + extra) % 64 == 0
            assert entry.compress_type == zipfile.ZIP_STORED
        text = package.read("little.usda").decode()
    pictures = {name for name in names if name.startswith("textures/")}
    assert pictures
    assert all(f"@./{name}@" in text for name in pictures)


@given(st.dictionaries(st.text("abcXYZ/_.1", min_size=1), st.binary(max_size=300), min_size=1))
def test_any_files_align(files: dict[str, bytes]) -> None:
    data = usdz_bytes(files)
    with zipfile.ZipFile(io.BytesIO(data)) as package:
        for entry in package.infolist():
            name, extra = struct.unpack_from("<HH", data, entry.header_offset + 26)
            begins = entry.header_offset + 30 + name + extra
            assert begins % 64 == 0
            assert data[begins : begins + entry.file_size] == files[entry.filename]


@pytest.mark.parametrize("text", ['a "quoted" name', "back\\slash", "two\nlines", "Müller"])
def test_texts_are_quoted(text: str) -> None:
    """As one line, whatever is in a name."""
    held = quoted(text)
    assert "\n" not in held
    assert held.startswith('"')
    assert held.endswith('"')
    assert held[1:-1].replace("\\\\", "").replace('\\"', "").count('"') == 0
