"""Rigid bodies, collision shapes and joints as UsdPhysics.

Pixar, "UsdPhysics: Rigid Body Physics in USD" (2020).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.scene_export.contents import ExportedBody
from sailenv_ros.scene_export.mesh_files import hull_triangles
from sailenv_ros.scene_export.usd_geometry import used_points, write_place, write_points
from sailenv_ros.scene_export.usd_text import UsdText, number, quoted, vector, vectors
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    SphereShape,
    TriangleShape,
)

__all__ = ["body_schemas", "write_joint", "write_mass", "write_shape"]

_KINDS = {"hinge": "PhysicsRevoluteJoint", "slide": "PhysicsPrismaticJoint"}


def body_schemas(body: ExportedBody) -> list[str]:
    """Return the API schemas of a body that has a mass; none of what only others collide with."""
    return ["PhysicsRigidBodyAPI", "PhysicsMassAPI"] if body.mass_kg > 0.0 else []


def write_mass(text: UsdText, body: ExportedBody, *, follows: bool) -> None:
    """Write mass, centre and moments of inertia, and whether it stands still all the same.

    What follows poses by time codes pushes others, and nothing pushes it.
    """
    if body.mass_kg > 0.0:
        text.attribute("float", "physics:mass", number(body.mass_kg))
        text.attribute("point3f", "physics:centerOfMass", vector(body.centre_m))
        # People have none, as nothing turns them.
        if min(body.inertia_kg_m2) > 0.0:
            text.attribute("float3", "physics:diagonalInertia", vector(body.inertia_kg_m2))
            text.attribute("quatf", "physics:principalAxes", "(1, 0, 0, 0)")
        if follows:
            text.attribute("bool", "physics:kinematicEnabled", "1")
        if body.static:
            text.attribute("bool", "physics:rigidBodyEnabled", "0")


def write_shape(text: UsdText, shape: CollisionShape, name: str, material: str) -> None:
    """Write a collision shape in its body's frame, which is not drawn."""
    schemas = ["PhysicsCollisionAPI", "MaterialBindingAPI"]
    kinds: Mapping[type, str] = {BoxShape: "Cube", SphereShape: "Sphere", CylinderShape: "Cylinder"}
    kind = kinds.get(type(shape), "Mesh")
    if kind == "Mesh":
        schemas.append("PhysicsMeshCollisionAPI")
    with text.prim(kind, name, schemas=schemas):
        text.attribute("uniform token", "purpose", quoted("guide"))
        text.relate("material:binding:physics", material)
        if isinstance(shape, BoxShape):
            text.attribute("float3[]", "extent", "[(-1, -1, -1), (1, 1, 1)]")
            text.attribute("double", "size", "2")
            text.attribute("float3", "xformOp:scale", vector(shape.half_extents_m))
            pose = Pose(shape.centre_m, shape.orientation_xyzw)
            write_place(text, pose, more=["xformOp:scale"])
        elif isinstance(shape, SphereShape):
            _write_extent(text, shape.radius_m, shape.radius_m)
            text.attribute("double", "radius", number(shape.radius_m))
            write_place(text, Pose(shape.centre_m))
        elif isinstance(shape, CylinderShape):
            _write_extent(text, shape.radius_m, 0.5 * shape.height_m)
            text.attribute("uniform token", "axis", quoted("Z"))
            text.attribute("double", "height", number(shape.height_m))
            text.attribute("double", "radius", number(shape.radius_m))
            write_place(text, Pose(shape.centre_m))
        elif isinstance(shape, ConvexShape):
            text.attribute("uniform token", "physics:approximation", quoted("convexHull"))
            _write_solid(text, *hull_triangles(shape))
        else:
            assert isinstance(shape, TriangleShape)
            text.attribute("uniform token", "physics:approximation", quoted("none"))
            _write_solid(text, shape.positions, shape.triangles)


def write_joint(
    text: UsdText, moving: ExportedBody, name: str, body: str, carrier: str | None
) -> None:
    """Write a joint; its axis is the x axis of both its frames.

    Parameters
    ----------
    body, carrier : str
        Paths of what moves and of what carries it; None is the world.
    """
    joint = moving.joint
    assert joint is not None
    kind = _KINDS.get(joint.type, "PhysicsFixedJoint")
    word = "angular" if joint.type == "hinge" else "linear"
    damped = joint.damping > 0.0 and joint.type != "fixed"
    with text.prim(kind, name, schemas=[f"PhysicsDriveAPI:{word}"] if damped else []):
        own = Pose(joint.origin_m, _turn_of_x(joint.axis))
        there = joint.parent_from_rest.carried(own)
        if carrier is not None:
            text.relate("physics:body0", carrier)
        text.relate("physics:body1", body)
        for number_, pose in enumerate((there, own)):
            x, y, z, w = pose.orientation_xyzw
            text.attribute("point3f", f"physics:localPos{number_}", vector(pose.position_m))
            text.attribute("quatf", f"physics:localRot{number_}", vector((w, x, y, z)))
        # As draft REP 158 wants joints named.
        text.attribute("custom string", "ros:joint:name", quoted(moving.name))
        if joint.type == "fixed":
            return
        text.attribute("uniform token", "physics:axis", quoted("X"))
        unit = math.degrees(1.0) if joint.type == "hinge" else 1.0
        if joint.limits is not None:
            low, high = (unit * limit for limit in joint.limits)
            text.attribute("float", "physics:lowerLimit", number(low))
            text.attribute("float", "physics:upperLimit", number(high))
        if damped:
            text.attribute("float", f"drive:{word}:physics:damping", number(joint.damping / unit))
            text.attribute("float", f"drive:{word}:physics:stiffness", "0")


def _write_solid(text: UsdText, points: NDArray[np.float64], triangles: NDArray[np.int32]) -> None:
    """Write triangles with a normal each."""
    points, numbers = used_points(points, triangles)
    write_points(text, points, numbers)
    a, b, c = (points[numbers[:, corner]] for corner in range(3))
    normals = np.cross(b - a, c - a)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    text.attribute(
        "normal3f[]", "normals", vectors(normals / np.maximum(lengths, 1e-30), 6), of="uniform"
    )


def _write_extent(text: UsdText, radius: float, half: float) -> None:
    low, high = vector((-radius, -radius, -half)), vector((radius, radius, half))
    text.attribute("float3[]", "extent", f"[{low}, {high}]")


def _turn_of_x(axis: tuple[float, float, float]) -> tuple[float, float, float, float]:
    """Return a quaternion that turns the x axis into another unit vector."""
    x, y, z = axis
    # Near -x the shortest way is not unique: half a turn about y comes first.
    quat = np.array([y, 1.0 - x, 0.0, -z] if x < -0.9 else [0.0, -z, y, 1.0 + x])
    a, b, c, w = (quat / np.linalg.norm(quat)).tolist()
    return a, b, c, w
