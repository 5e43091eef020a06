"""SDFormat: links stand where bodies do at their joints' zero; files that are named are there."""

from __future__ import annotations

import math
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros import export_asset
from sailenv_ros.scene_export.contents import ExportedBody, ExportedScene, Written
from sailenv_ros.scene_export.names import identifier
from sailenv_ros.scene_export.sdf import write_sdf
from sailenv_ros.types.geometry import Pose


@pytest.fixture(scope="module")
def written(scene: ExportedScene) -> Written:
    return write_sdf(scene, "little_sdf")


@pytest.fixture(scope="module")
def document(written: Written) -> Element:
    root = ElementTree.fromstring(written.data)
    assert (root.tag, root.get("version")) == ("sdf", "1.9")
    return _one(root, "world")


def test_links_stand_where_bodies_do(document: Element, scene: ExportedScene) -> None:
    """What is on a joint stands at its position 0."""
    links = {
        link.get("name"): _pose(model) @ _pose(link)
        for model in document.findall("model")
        for link in model.findall("link")
        if link.find("sensor") is None
    }
    assert len(links) == len(scene.bodies)
    for body in scene.bodies:
        found = links[identifier(body.name)]
        assert np.abs(found - _rest(scene, body)).max() < 1e-9, body.name


def test_joints_and_masses(document: Element, scene: ExportedScene) -> None:
    """Axes, points, limits; pieces whose doors move are fixed to the world."""
    joints = {_text(joint, "child"): joint for joint in document.iter("joint")}
    links = {link.get("name"): link for link in document.iter("link")}
    for body in scene.bodies:
        name = identifier(body.name)
        if body.mass_kg:
            inertial = _one(links[name], "inertial")
            assert float(_text(inertial, "mass")) == pytest.approx(body.mass_kg)
            assert _pose(inertial)[:3, 3] == pytest.approx(body.centre_m)
        if body.joint is not None:
            joint = joints[name]
            assert joint.get("type") == "revolute"
            assert _text(joint, "parent") == identifier(body.joint.parent)
            axis = _one(joint, "axis")
            assert _numbers(_one(axis, "xyz")) == pytest.approx(body.joint.axis)
            assert _pose(joint)[:3, 3] == pytest.approx(body.joint.origin_m)
            limit = _one(axis, "limit")
            found = (float(_text(limit, "lower")), float(_text(limit, "upper")))
            assert found == body.joint.limits
    for name in ("cabinet", "wardrobe"):
        assert joints[name].get("type") == "fixed"
        assert _text(joints[name], "parent") == "world"
    static = {m.get("name") for m in document.findall("model") if _text(m, "static") == "true"}
    assert static == {"floor", "eye", "fish"}


def test_every_file_that_is_named_is_there(document: Element, written: Written) -> None:
    named = {node.text or "" for node in document.iter() if node.tag in ("uri", "albedo_map")}
    assert named
    assert {name.removeprefix("little_sdf/") for name in named} <= set(written.beside)


def test_lights_and_cameras(document: Element) -> None:
    bulb = next(light for light in document.findall("light") if light.get("name") == "bulb")
    assert float(_text(bulb, "intensity")) == 8.0
    spot = next(light for light in document.findall("light") if light.get("name") == "spot")
    outer = float(_text(_one(spot, "spot"), "outer_angle"))
    assert outer == pytest.approx(math.radians(80.0))
    eye = next(model for model in document.findall("model") if model.get("name") == "eye")
    fov = float(next(eye.iter("horizontal_fov")).text or "nan")
    assert math.tan(0.5 * fov) == pytest.approx(320 / 240 * math.tan(math.radians(25.0)))


def test_a_piece_is_a_model(tmp_path: Path) -> None:
    export_asset("wardrobe~hinged:7", tmp_path / "wardrobe.sdf")
    root = ElementTree.parse(tmp_path / "wardrobe.sdf").getroot()
    model = _one(root, "model")
    assert len(model.findall("link")) == 5
    assert len(model.findall("joint")) == 5  # four doors, and it stands


def _rest(scene: ExportedScene, body: ExportedBody) -> NDArray[np.float64]:
    if body.joint is None:
        return body.pose.matrix()
    return _rest(scene, scene.by_name[body.joint.parent]) @ body.joint.parent_from_rest.matrix()


def _pose(node: Element) -> NDArray[np.float64]:
    pose = _one(node, "pose")
    assert pose.get("rotation_format") == "quat_xyzw"
    x, y, z, qx, qy, qz, qw = _numbers(pose)
    return Pose((x, y, z), (qx, qy, qz, qw)).matrix()


def _numbers(node: Element) -> list[float]:
    return [float(value) for value in (node.text or "").split()]


def _one(node: Element, name: str) -> Element:
    found = node.findall(name)
    assert len(found) == 1, name
    return found[0]


def _text(node: Element, name: str) -> str:
    return _one(node, name).text or ""
