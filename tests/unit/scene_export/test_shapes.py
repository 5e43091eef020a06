"""Every kind of collision shape in every format that has them; MuJoCo says where they are."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.mesh_files import hull_triangles
from sailenv_ros.scene_export.mjcf import write_mjcf
from sailenv_ros.scene_export.saving import save
from sailenv_ros.scene_export.sdf import write_sdf
from sailenv_ros.scene_export.urdf import write_urdf
from sailenv_ros.scene_export.usd import write_usda
from sailenv_ros.types.geometry import quat_xyzw_from_rpy_deg
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)
from tests.unit.scene_export.usda import read_usda

QUARTER = quat_xyzw_from_rpy_deg((0.0, 0.0, 90.0))
CORNERS = np.array([[0, 0, 0], [0.4, 0, 0], [0, 0.3, 0], [0, 0, 0.2]], np.float64)

SHAPES: tuple[tuple[CollisionShape, tuple[float, ...], tuple[float, ...]], ...] = (
    (
        BoxShape(half_extents_m=(0.1, 0.2, 0.3), centre_m=(1, 2, 3), orientation_xyzw=QUARTER),
        (0.8, 1.9, 2.7),
        (1.2, 2.1, 3.3),
    ),
    (SphereShape(radius_m=0.2, centre_m=(0.0, 1.0, 0.0)), (-0.2, 0.8, -0.2), (0.2, 1.2, 0.2)),
    (
        CylinderShape(radius_m=0.1, height_m=0.6, centre_m=(0.0, 0.0, 1.0)),
        (-0.1, -0.1, 0.7),
        (0.1, 0.1, 1.3),
    ),
    (ConvexShape(points=CORNERS), (0.0, 0.0, 0.0), (0.4, 0.3, 0.2)),
    (ConvexShape(points=CORNERS[:3]), (0.0, 0.0, -1e-4), (0.4, 0.3, 1e-4)),
    (
        TriangleShape(positions=CORNERS, triangles=np.array([[0, 1, 2], [0, 2, 3]], np.int32)),
        (0.0, 0.0, 0.0),
        (0.4, 0.3, 0.2),
    ),
)
"""Shapes, with the lowest and the highest corner around each."""

IDS = ("box", "sphere", "cylinder", "hull", "flat hull", "triangles")


@pytest.fixture(scope="module")
def alone(scene: ExportedScene) -> ExportedScene:
    """A static body at the origin, whose shapes the tests exchange."""
    floor = dataclasses.replace(scene.by_name["floor"], joint=None)
    return dataclasses.replace(scene, bodies=(floor,), lights=(), cameras=(), environment=None)


def shaped(alone: ExportedScene, shape: CollisionShape) -> ExportedScene:
    body = dataclasses.replace(alone.bodies[0], shapes=(shape,))
    return dataclasses.replace(alone, bodies=(body,))


def around(model: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lowest and highest corner around everything that collides."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    lows, highs = [], []
    for number in range(model.ngeom):
        if not model.geom_contype[number]:
            continue
        middle, half = model.geom_aabb[number, :3], model.geom_aabb[number, 3:]
        turn = data.geom_xmat[number].reshape(3, 3)
        signs = np.array(np.meshgrid((-1, 1), (-1, 1), (-1, 1))).reshape(3, -1).T
        corners = data.geom_xpos[number] + (middle + signs * half) @ turn.T
        mesh = model.geom_dataid[number]
        if mesh >= 0:
            first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
            corners = data.geom_xpos[number] + model.mesh_vert[first : first + count] @ turn.T
        lows.append(corners.min(axis=0))
        highs.append(corners.max(axis=0))
    return np.min(lows, axis=0), np.max(highs, axis=0)


@pytest.mark.parametrize(("shape", "low", "high"), SHAPES, ids=IDS)
def test_mjcf_and_urdf_collide_where_shapes_are(
    shape: CollisionShape,
    low: tuple[float, ...],
    high: tuple[float, ...],
    alone: ExportedScene,
    tmp_path: Path,
) -> None:
    own = shaped(alone, shape)
    save(write_mjcf(own, "m"), tmp_path / "a.xml", tmp_path / "m")
    found = around(mujoco.MjModel.from_xml_path(str(tmp_path / "a.xml")))
    assert np.abs(found[0] - low).max() < 1.1e-4
    assert np.abs(found[1] - high).max() < 1.1e-4
    written = write_urdf(own, "u")
    text = written.data.decode().replace("u/", "")
    assert 'name="floor"' in text
    root = ElementTree.fromstring(text)
    for link in root.iter("link"):  # MuJoCo would draw what it shall collide with
        for visual in link.findall("visual"):
            link.remove(visual)
    model = mujoco.MjModel.from_xml_string(
        ElementTree.tostring(root, encoding="unicode"), dict(written.beside)
    )
    found = around(model)
    assert np.abs(found[0] - low).max() < 1.1e-4
    assert np.abs(found[1] - high).max() < 1.1e-4


@pytest.mark.parametrize(("shape", "low", "high"), SHAPES, ids=IDS)
def test_usd_and_sdf_have_the_shape(
    shape: CollisionShape,
    low: tuple[float, ...],
    high: tuple[float, ...],
    alone: ExportedScene,
) -> None:
    """As a prim of its kind with the API of collisions; as an element of its kind."""
    own = shaped(alone, shape)
    _, prims = read_usda(write_usda(own, "").data)
    prim = prims["/little/Objects/floor/collision/shape_0"]
    assert "PhysicsCollisionAPI" in prim.metadata["apiSchemas"]
    kinds = {BoxShape: "Cube", SphereShape: "Sphere", CylinderShape: "Cylinder"}
    assert prim.kind == kinds.get(type(shape), "Mesh")
    if prim.kind == "Mesh":
        points = prim.numbers("points").reshape(-1, 3)
        assert np.abs(points.min(axis=0) - low).max() < 1.1e-4
        assert np.abs(points.max(axis=0) - high).max() < 1.1e-4
    collision = next(ElementTree.fromstring(write_sdf(own, "s").data).iter("collision"))
    geometry = collision.find("geometry")
    assert geometry is not None
    assert geometry[0].tag == {"Cube": "box", "Mesh": "mesh"}.get(prim.kind, prim.kind.lower())


@pytest.mark.parametrize(
    "points", [CORNERS, CORNERS[:3], CORNERS[:2]], ids=["solid", "flat", "line"]
)
def test_hulls_are_closed_and_face_outwards(points: NDArray[np.float64]) -> None:
    """Their volume is that of their corners, above 0."""
    corners, triangles = hull_triangles(ConvexShape(points=points))
    a, b, c = (corners[triangles[:, k]] - corners.mean(axis=0) for k in range(3))
    volumes = np.einsum("ni,ni->n", a, np.cross(b, c)) / 6.0
    assert volumes.min() > -1e-12
    assert volumes.sum() > 0.0
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    assert {tuple(edge) for edge in edges.tolist()} == {
        tuple(edge[::-1]) for edge in edges.tolist()
    }
