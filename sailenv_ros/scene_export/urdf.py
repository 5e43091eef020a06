"""`ExportedScene` of one piece → URDF, with meshes and pictures beside it.

The frame of a link on a joint lies on the joint's axis, as URDF demands. Open Robotics, "Unified
Robot Description Format", XML specification.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from sailenv_ros.scene_export.contents import ExportedBody, ExportedScene, Vector3, Written
from sailenv_ros.scene_export.losses import joint_losses
from sailenv_ros.scene_export.mesh_files import hull_bytes
from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.scene_export.textures import FilesBeside
from sailenv_ros.scene_export.xml_text import document, numbers
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.geometry import Pose, rpy_deg_from_quat_xyzw
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    Material,
    SphereShape,
)

__all__ = ["write_urdf"]

FASTEST = 10.0
"""Velocity that joints are said to bear, which URDF demands [rad/s], [m/s]."""

_KINDS = {"hinge": "revolute", "slide": "prismatic", "fixed": "fixed"}


def write_urdf(scene: ExportedScene, folder: str) -> Written:
    """Return a piece as a URDF file; the same bytes for the same piece."""
    made = _UrdfWriter(scene, folder)
    return Written(
        data=document(made.tree()),
        beside=made.files,
        losses=tuple(made.losses()),
    )


class _UrdfWriter(FilesBeside):
    def __init__(self, scene: ExportedScene, folder: str) -> None:
        super().__init__()
        self._scene = scene
        self._folder = folder
        names = FreeNames()
        self._names = {body.name: names.take(body.name) for body in scene.bodies}
        self._materials: dict[int, str] = {}
        self._material_names = FreeNames()
        self._root = Element("robot", name=names.take(f"{scene.name} piece"))

    def tree(self) -> Element:
        """Return the whole document."""
        for body in self._scene.bodies:
            self._add_link(body)
        for body in self._scene.bodies:
            self._add_joint(body)
        return self._root

    def losses(self) -> Iterator[str]:
        """Yield what URDF cannot hold."""
        if any(len(body.pieces) > 1 for body in self._scene.bodies):
            yield "labelled parts have no labels of their own in URDF"
        yield "materials are a colour and a picture in URDF"
        yield from joint_losses(self._scene, "URDF")

    def _add_link(self, body: ExportedBody) -> None:
        link = SubElement(self._root, "link", name=self._names[body.name])
        origin = _origin_of(body)
        if body.mass_kg > 0.0:
            inertial = SubElement(link, "inertial")
            _add_place(inertial, _minus(body.centre_m, origin))
            SubElement(inertial, "mass", value=numbers((body.mass_kg,)))
            ixx, iyy, izz = (numbers((moment,)) for moment in body.inertia_kg_m2)
            moments = {"ixx": ixx, "ixy": "0", "ixz": "0", "iyy": iyy, "iyz": "0", "izz": izz}
            SubElement(inertial, "inertia", moments)
        for piece in body.pieces:
            for part in piece.parts:
                visual = SubElement(link, "visual")
                _add_place(visual, _minus((0.0, 0.0, 0.0), origin))
                textured = part.material.base_colour_texture is not None
                file = self._meshes.of(part.mesh, piece.instance.asset, textured=textured)
                entry = {"filename": f"{self._folder}/{file}", "scale": numbers(body.scale)}
                SubElement(SubElement(visual, "geometry"), "mesh", entry)
                self._add_material(visual, part.material)
        for shape in body.shapes:
            self._add_shape(link, shape, body, origin)

    def _add_material(self, visual: Element, material: Material) -> None:
        known = self._materials.get(id(material))
        if known is not None:
            SubElement(visual, "material", name=known)
            return
        name = self._material_names.take(material.name or "material")
        self._materials[id(material)] = name
        node = SubElement(visual, "material", name=name)
        rgb = srgb_from_linear(material.base_colour[:3]).tolist()
        SubElement(node, "color", rgba=numbers([*rgb, material.base_colour[3]]))
        if material.base_colour_texture is not None:
            alpha = material.alpha != "opaque"
            picture = self._textures.of(material.base_colour_texture, alpha=alpha)
            SubElement(node, "texture", filename=f"{self._folder}/{picture.name}")

    def _add_shape(
        self, link: Element, shape: CollisionShape, body: ExportedBody, origin: Vector3
    ) -> None:
        node = SubElement(link, "collision")
        geometry = Element("geometry")
        if isinstance(shape, BoxShape | SphereShape | CylinderShape):
            turn = shape.orientation_xyzw if isinstance(shape, BoxShape) else (0.0, 0.0, 0.0, 1.0)
            _add_place(node, _minus(shape.centre_m, origin), turn)
        else:
            _add_place(node, _minus((0.0, 0.0, 0.0), origin))
        node.append(geometry)
        if isinstance(shape, BoxShape):
            sides = [2.0 * half for half in shape.half_extents_m]
            SubElement(geometry, "box", size=numbers(sides))
        elif isinstance(shape, SphereShape):
            SubElement(geometry, "sphere", radius=numbers((shape.radius_m,)))
        elif isinstance(shape, CylinderShape):
            entry = {"radius": numbers((shape.radius_m,)), "length": numbers((shape.height_m,))}
            SubElement(geometry, "cylinder", entry)
        else:
            points = shape.points if isinstance(shape, ConvexShape) else shape.positions
            data = hull_bytes(ConvexShape(points=points))
            file = self._meshes.add(f"{body.name} hull", data)
            SubElement(geometry, "mesh", filename=f"{self._folder}/{file}")

    def _add_joint(self, body: ExportedBody) -> None:
        joint = body.joint
        if joint is None or not joint.parent:
            return
        parent = self._scene.by_name[joint.parent]
        kind = _KINDS[joint.type]
        if kind == "revolute" and joint.limits is None:
            kind = "continuous"
        name = f"{self._names[body.name]}_joint"
        node = SubElement(self._root, "joint", name=name, type=kind)
        rest = joint.parent_from_rest.carried(Pose(_origin_of(body)))
        place = _minus(rest.position_m, _origin_of(parent))
        _add_place(node, place, rest.orientation_xyzw)
        SubElement(node, "parent", link=self._names[joint.parent])
        SubElement(node, "child", link=self._names[body.name])
        if joint.type == "fixed":
            return
        SubElement(node, "axis", xyz=numbers(joint.axis))
        bounds = {"effort": numbers((joint.effort,)), "velocity": numbers((FASTEST,))}
        if joint.limits is not None:
            low, high = (numbers((limit,)) for limit in joint.limits)
            bounds |= {"lower": low, "upper": high}
        SubElement(node, "limit", bounds)
        damping, friction = numbers((joint.damping,)), numbers((joint.friction,))
        SubElement(node, "dynamics", damping=damping, friction=friction)


def _origin_of(body: ExportedBody) -> Vector3:
    """Return where a link's frame is in that of its body: on the axis of its joint."""
    return (0.0, 0.0, 0.0) if body.joint is None else body.joint.origin_m


def _add_place(
    node: Element,
    position_m: Vector3,
    orientation_xyzw: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 1.0),
) -> None:
    rpy = np.radians(rpy_deg_from_quat_xyzw(orientation_xyzw)).tolist()
    SubElement(node, "origin", xyz=numbers(position_m), rpy=numbers(rpy))


def _minus(first: Vector3, second: Vector3) -> Vector3:
    x, y, z = (a - b for a, b in zip(first, second, strict=True))
    return x, y, z
