"""Visuals and collisions of SDFormat."""

from __future__ import annotations

from xml.etree.ElementTree import Element, SubElement

from sailenv_ros.scene_export.contents import ExportedBody, Vector3
from sailenv_ros.scene_export.mesh_files import hull_bytes
from sailenv_ros.scene_export.textures import FilesBeside, texture_slots
from sailenv_ros.scene_export.xml_text import numbers
from sailenv_ros.types.colour import srgb_from_linear
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import (
    BoxShape,
    CollisionShape,
    ConvexShape,
    CylinderShape,
    Material,
    ModelPart,
    SphereShape,
)

__all__ = ["SdfGeometry", "add_pose", "add_text"]

_MAPS = {"base_colour": "albedo_map", "normal": "normal_map"}


class SdfGeometry(FilesBeside):
    """Meshes and pictures of a file.

    Parameters
    ----------
    folder : str
        Where they are, relative to the file.
    """

    def __init__(self, folder: str) -> None:
        super().__init__()
        self._folder = folder

    def add(self, link: Element, body: ExportedBody) -> None:
        """Add to a link what is drawn of a body, and what it collides as."""
        for piece in body.pieces:
            for number, part in enumerate(piece.parts):
                name = f"drawn {number} of {piece.instance.name}"
                self._add_visual(link, part, name, piece.instance.asset, body.scale)
        for number, shape in enumerate(body.shapes):
            self._add_collision(link, shape, f"shape {number}", body)

    def _add_visual(
        self, link: Element, part: ModelPart, name: str, wanted: str, scale: Vector3
    ) -> None:
        visual = SubElement(link, "visual", name=name)
        mesh = SubElement(SubElement(visual, "geometry"), "mesh")
        textured = any(texture_slots(part.material))
        add_text(
            mesh, "uri", f"{self._folder}/{self._meshes.of(part.mesh, wanted, textured=textured)}"
        )
        add_text(mesh, "scale", numbers(scale))
        self._add_material(visual, part.material)
        if part.material.alpha == "blend":
            add_text(visual, "transparency", numbers((1.0 - part.material.base_colour[3],)))

    def _add_material(self, visual: Element, material: Material) -> None:
        node = SubElement(visual, "material")
        colour = srgb_from_linear(material.base_colour[:3]).tolist()
        add_text(node, "diffuse", numbers([*colour, material.base_colour[3]]))
        if any(material.emission):
            glow = srgb_from_linear(material.emission).tolist()
            add_text(node, "emissive", numbers([*glow, 1.0]))
        if material.double_sided:
            add_text(node, "double_sided", "true")
        metal = SubElement(SubElement(node, "pbr"), "metal")
        add_text(metal, "metalness", numbers((material.metallic,)))
        add_text(metal, "roughness", numbers((material.roughness,)))
        for slot, texture, alpha in texture_slots(material):
            if slot in _MAPS:
                name = self._textures.of(texture, alpha=alpha).name
                add_text(metal, _MAPS[slot], f"{self._folder}/{name}")

    def _add_collision(
        self, link: Element, shape: CollisionShape, name: str, body: ExportedBody
    ) -> None:
        node = SubElement(link, "collision", name=name)
        if isinstance(shape, BoxShape):
            add_pose(node, Pose(shape.centre_m, shape.orientation_xyzw))
        elif isinstance(shape, SphereShape | CylinderShape):
            add_pose(node, Pose(shape.centre_m))
        geometry = SubElement(node, "geometry")
        if isinstance(shape, BoxShape):
            sides = [2.0 * half for half in shape.half_extents_m]
            add_text(SubElement(geometry, "box"), "size", numbers(sides))
        elif isinstance(shape, SphereShape):
            add_text(SubElement(geometry, "sphere"), "radius", numbers((shape.radius_m,)))
        elif isinstance(shape, CylinderShape):
            cylinder = SubElement(geometry, "cylinder")
            add_text(cylinder, "radius", numbers((shape.radius_m,)))
            add_text(cylinder, "length", numbers((shape.height_m,)))
        else:
            points = shape.points if isinstance(shape, ConvexShape) else shape.positions
            file = self._meshes.add(f"{body.name} hull", hull_bytes(ConvexShape(points=points)))
            add_text(SubElement(geometry, "mesh"), "uri", f"{self._folder}/{file}")
        # Here two bodies have the product of their frictions, in Gazebo the smaller one.
        ode = SubElement(SubElement(SubElement(node, "surface"), "friction"), "ode")
        for key in ("mu", "mu2"):
            add_text(ode, key, numbers((body.friction**2,)))


def add_pose(node: Element, pose: Pose) -> None:
    """Add a pose."""
    entry = SubElement(node, "pose", rotation_format="quat_xyzw")
    entry.text = numbers((*pose.position_m, *pose.orientation_xyzw))


def add_text(node: Element, name: str, text: str) -> None:
    """Add an element that holds a text."""
    SubElement(node, name).text = text
