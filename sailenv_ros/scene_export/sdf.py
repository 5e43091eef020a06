"""`ExportedScene` → SDFormat 1.9, for Gazebo, with meshes and pictures beside it.

Each object is a model; what hangs together by joints is one, fixed to the world. Open Robotics,
"SDFormat Specification" 1.9.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from xml.etree.ElementTree import Element, SubElement

from sailenv_ros.scene_export.contents import ExportedBody, ExportedCamera, ExportedScene, Written
from sailenv_ros.scene_export.losses import camera_losses, joint_losses, light_losses
from sailenv_ros.scene_export.names import FreeNames
from sailenv_ros.scene_export.optics import point_intensity, view_angles
from sailenv_ros.scene_export.sdf_geometry import SdfGeometry, add_pose, add_text
from sailenv_ros.scene_export.trees import carried
from sailenv_ros.scene_export.xml_text import document, numbers
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light

__all__ = ["write_sdf"]

_KINDS = {"hinge": "revolute", "slide": "prismatic", "fixed": "fixed"}
_LIGHTS = {"area": "spot"}

WORLD = "world"
LABEL_PLUGIN = {"filename": "gz-sim-label-system", "name": "gz::sim::systems::Label"}
MOST_LABEL = 255


def write_sdf(scene: ExportedScene, folder: str) -> Written:
    """Return a scene as a world, a piece as a model; the same bytes for the same scene."""
    made = _SdfWriter(scene, folder)
    return Written(
        data=document(made.tree()), beside=made.geometry.files, losses=tuple(made.losses())
    )


class _SdfWriter:
    def __init__(self, scene: ExportedScene, folder: str) -> None:
        self._scene = scene
        self._root = Element("sdf", version="1.9")
        self.geometry = SdfGeometry(folder)
        names = FreeNames()
        names.take(WORLD)
        self._names = {body.name: names.take(body.name) for body in scene.bodies}
        self._free = names
        self._carried = carried(scene)

    def tree(self) -> Element:
        """Return the whole document."""
        if self._scene.environment is None:
            self._add_model(self._root, self._scene.bodies[0])
            return self._root
        world = SubElement(self._root, "world", name=self._scene.name)
        add_text(world, "gravity", numbers(self._scene.gravity))
        for light in self._scene.lights:
            _add_light(world, light)
        for body in self._scene.bodies:
            if not body.is_outside and (body.joint is None or not body.joint.parent):
                self._add_model(world, body)
        for camera in self._scene.cameras:
            _add_camera(world, camera, self._free.take(camera.name))
        return self._root

    def losses(self) -> Iterator[str]:
        """Yield what SDFormat cannot hold."""
        yield from light_losses(self._scene, "SDFormat")
        yield from camera_losses(self._scene, "SDFormat")
        yield from joint_losses(self._scene, "SDFormat")
        if any(body.is_outside for body in self._scene.bodies):
            yield "what lies outside the windows was left out"
        moved = sum(bool(b.joint and b.joint.position) for b in self._scene.bodies)
        if moved:
            yield "joints stand at 0 in SDFormat, which has no positions to begin with"
        if any(len(body.pieces) > 1 for body in self._scene.bodies):
            yield "labelled parts have no labels of their own in SDFormat"

    # -- models ----------------------------------------------------------------------------

    def _add_model(self, above: Element, body: ExportedBody) -> None:
        model = SubElement(above, "model", name=self._names[body.name])
        stands = body.joint is None and body.static and body.name not in self._carried
        rest = body.pose if body.joint is None else body.joint.parent_from_rest
        add_text(model, "static", "true" if stands else "false")
        add_pose(model, rest)
        if body.instance.category_id <= MOST_LABEL:
            plugin = SubElement(model, "plugin", LABEL_PLUGIN)
            add_text(plugin, "label", str(body.instance.category_id))
        self._add_link(model, body, Pose())
        self._add_joint(model, body)

    def _add_link(self, model: Element, body: ExportedBody, pose: Pose) -> None:
        """Add the link of a body and of all that it carries, at the joints' positions 0."""
        link = SubElement(model, "link", name=self._names[body.name])
        add_pose(link, pose)
        if not body.gravity:
            add_text(link, "gravity", "false")
        if body.mass_kg > 0.0:
            inertial = SubElement(link, "inertial")
            add_pose(inertial, Pose(body.centre_m))
            add_text(inertial, "mass", numbers((body.mass_kg,)))
            inertia = SubElement(inertial, "inertia")
            for key, moment in zip(("ixx", "iyy", "izz"), body.inertia_kg_m2, strict=True):
                add_text(inertia, key, numbers((moment,)))
            for key in ("ixy", "ixz", "iyz"):
                add_text(inertia, key, "0")
        self.geometry.add(link, body)
        for other in self._carried.get(body.name, ()):
            assert other.joint is not None
            self._add_link(model, other, pose.carried(other.joint.parent_from_rest))
            self._add_joint(model, other)

    def _add_joint(self, model: Element, body: ExportedBody) -> None:
        joint = body.joint
        holds = joint is None and body.static and body.name in self._carried
        if joint is None and not holds:
            return
        kind = "fixed" if joint is None else _KINDS[joint.type]
        if joint is not None and kind == "revolute" and joint.limits is None:
            kind = "continuous"
        name = f"{self._names[body.name]}_joint"
        node = SubElement(model, "joint", name=name, type=kind)
        parent = self._names[joint.parent] if joint is not None and joint.parent else WORLD
        add_text(node, "parent", parent)
        add_text(node, "child", self._names[body.name])
        if joint is None or joint.type == "fixed":
            return
        add_pose(node, Pose(joint.origin_m))
        axis = SubElement(node, "axis")
        add_text(axis, "xyz", numbers(joint.axis))
        limit = SubElement(axis, "limit")
        if joint.limits is not None:
            for key, value in zip(("lower", "upper"), joint.limits, strict=True):
                add_text(limit, key, numbers((value,)))
        add_text(limit, "effort", numbers((joint.effort,)))
        dynamics = SubElement(axis, "dynamics")
        add_text(dynamics, "damping", numbers((joint.damping,)))
        add_text(dynamics, "friction", numbers((joint.friction,)))


def _add_light(world: Element, light: Light) -> None:
    colour, intensity = point_intensity(light)
    kind = _LIGHTS.get(light.type, light.type)
    node = SubElement(world, "light", name=light.name, type=kind)
    add_pose(node, Pose(light.position_m))
    add_text(node, "intensity", numbers((intensity,)))
    add_text(node, "diffuse", numbers((*colour, 1.0)))
    add_text(node, "specular", "0.1 0.1 0.1 1")
    add_text(node, "cast_shadows", "true" if light.type == "directional" else "false")
    if light.type != "point":
        add_text(node, "direction", numbers(light.direction))
    if light.type != "directional":
        attenuation = SubElement(node, "attenuation")
        add_text(attenuation, "range", numbers((light.range_m,)))
        for key, value in (("constant", "0"), ("linear", "0"), ("quadratic", "1")):
            add_text(attenuation, key, value)
    if kind == "spot":
        spot = SubElement(node, "spot")
        outer = 89.0 if light.type == "area" else light.outer_cone_deg
        inner = 0.0 if light.type == "area" else light.inner_cone_deg
        add_text(spot, "inner_angle", numbers((math.radians(2.0 * inner),)))
        add_text(spot, "outer_angle", numbers((math.radians(2.0 * outer),)))
        add_text(spot, "falloff", "1")


def _add_camera(world: Element, camera: ExportedCamera, name: str) -> None:
    """Add an agent as a model with a camera, which looks along its x axis."""
    model = SubElement(world, "model", name=name)
    add_text(model, "static", "true")
    add_pose(model, camera.pose)
    sensor = SubElement(SubElement(model, "link", name="link"), "sensor", name=name, type="camera")
    add_text(sensor, "topic", name)
    node, lens = SubElement(sensor, "camera"), camera.intrinsics
    if not lens.is_parallel:
        add_text(node, "horizontal_fov", numbers((view_angles(lens)[0],)))
    image = SubElement(node, "image")
    add_text(image, "width", str(lens.width))
    add_text(image, "height", str(lens.height))
    clip = SubElement(node, "clip")
    add_text(clip, "near", numbers((lens.near_m,)))
    add_text(clip, "far", numbers((lens.far_m,)))
