"""`ExportedScene` → MJCF, the XML of MuJoCo, with meshes and pictures beside it.

Bodies keep their names. What moves freely has a free joint, what is on a joint lies within what
carries it. Drawn geometries are in group 2 and collide with nothing; collision shapes are in group
3. Each geometry has the user data (instance id, category id), and texts name the categories. The
first keyframe is the moment that was exported.

Todorov, Erez, Tassa, "MuJoCo: A physics engine for model-based control" (2012); MuJoCo
documentation, "XML reference".
"""

from __future__ import annotations

import math
from xml.etree.ElementTree import Element, SubElement

from sailenv_ros.scene_export.contents import ExportedBody, ExportedPiece, ExportedScene, Written
from sailenv_ros.scene_export.losses import camera_losses, joint_losses, light_losses
from sailenv_ros.scene_export.mjcf_assets import MjcfAssets
from sailenv_ros.scene_export.mjcf_shapes import add_shape
from sailenv_ros.scene_export.optics import light_pose, looking_back, point_intensity, view_angles
from sailenv_ros.scene_export.trees import carried, together
from sailenv_ros.scene_export.xml_text import document, numbers
from sailenv_ros.types.geometry import Pose

__all__ = ["write_mjcf"]

DRAWN_GROUP, COLLISION_GROUP = "2", "3"

_FULL = {"directional": math.pi, "point": 4.0, "spot": 4.0, "area": 4.0}
"""Intensities that are full brightness in MuJoCo, whose lights have no unit [W/m²], [W/sr]."""


def write_mjcf(scene: ExportedScene, folder: str) -> Written:
    """Return a scene as MJCF; the same bytes for the same scene."""
    made = _MjcfWriter(scene, folder)
    return Written(
        data=document(made.tree()),
        beside=made.assets.files,
        losses=tuple(made.losses()),
    )


class _MjcfWriter:
    def __init__(self, scene: ExportedScene, folder: str) -> None:
        self._scene = scene
        self._root = Element("mujoco", model=scene.name)
        SubElement(
            self._root,
            "compiler",
            {"angle": "radian", "autolimits": "true", "meshdir": folder, "texturedir": folder},
        )
        SubElement(
            self._root,
            "option",
            {"gravity": numbers(scene.gravity), "integrator": "implicitfast", "cone": "elliptic"},
        )
        default = SubElement(self._root, "default")
        # Bodies have their own masses; what stands still has none.
        SubElement(default, "geom", density="0")
        # Dry friction holds what it can: with MuJoCo's own softness lids and levers would sink.
        SubElement(default, "joint", solimpfriction="0.9999 0.9999 0.001")
        self._add_categories()
        self.assets = MjcfAssets(SubElement(self._root, "asset"))
        self._world = SubElement(self._root, "worldbody")
        self._positions: list[float] = []
        self._carried = carried(scene)
        self._left_out = False

    def tree(self) -> Element:
        """Return the whole document."""
        for body in self._scene.bodies:
            if body.joint is None or not body.joint.parent:
                self._add_body(self._world, body)
        self._add_lights()
        self._add_cameras()
        contact = SubElement(self._root, "contact")
        for first, second in together(self._scene):
            SubElement(contact, "exclude", {"body1": first, "body2": second})
        if self._positions:
            keyframe = SubElement(self._root, "keyframe")
            SubElement(keyframe, "key", {"name": "start", "qpos": numbers(self._positions)})
        return self._root

    def losses(self) -> list[str]:
        """Return what was left out, in a sentence each."""
        found = [*light_losses(self._scene, "MJCF"), *camera_losses(self._scene, "MJCF")]
        found += joint_losses(self._scene, "MJCF")
        if self._left_out:
            found.append("what lies outside the windows was left out")
        return [*found, *self.assets.losses()]

    # -- bodies ----------------------------------------------------------------------------

    def _add_body(self, above: Element, body: ExportedBody) -> None:
        if body.is_outside:
            self._left_out = True
            return
        joint = body.joint
        pose = body.pose if joint is None else joint.parent_from_rest
        node = SubElement(above, "body", {"name": body.name, **placed(pose)})
        if not body.gravity:
            node.set("gravcomp", "1")
        self._add_joint(node, body)
        if body.mass_kg > 0.0:
            SubElement(
                node,
                "inertial",
                {
                    "pos": numbers(body.centre_m),
                    "mass": numbers((body.mass_kg,)),
                    "diaginertia": numbers(body.inertia_kg_m2),
                },
            )
        for piece in body.pieces:
            self._add_piece(node, piece, body)
        for number, shape in enumerate(body.shapes):
            labels = {"group": COLLISION_GROUP, "user": _user(body.pieces[0])}
            name = f"shape {number} of {body.name}"
            rolls = not body.static
            add_shape(node, shape, self.assets, name, body.friction, labels, rolls=rolls)
        for other in self._carried.get(body.name, ()):
            self._add_body(node, other)

    def _add_joint(self, node: Element, body: ExportedBody) -> None:
        joint = body.joint
        if joint is None:
            if not body.static:
                SubElement(node, "freejoint", {"name": body.name})
                x, y, z, w = body.pose.orientation_xyzw
                self._positions += [*body.pose.position_m, w, x, y, z]
            return
        if joint.type == "fixed":
            return
        self._positions.append(joint.position)
        entry = {
            "name": body.name,
            "type": joint.type,
            "axis": numbers(joint.axis),
            "pos": numbers(joint.origin_m),
            "damping": numbers((joint.damping,)),
            "frictionloss": numbers((joint.friction,)),
        }
        if joint.limits is not None:
            entry["range"] = numbers(joint.limits)
        SubElement(node, "joint", entry)

    def _add_piece(self, node: Element, piece: ExportedPiece, body: ExportedBody) -> None:
        for number, part in enumerate(piece.parts):
            SubElement(
                node,
                "geom",
                {
                    "name": f"drawn {number} of {piece.instance.name}",
                    "type": "mesh",
                    "mesh": self.assets.mesh(part, piece.instance.asset, body.scale),
                    "material": self.assets.material(part.material),
                    "group": DRAWN_GROUP,
                    "contype": "0",
                    "conaffinity": "0",
                    "user": _user(piece),
                },
            )

    # -- all else --------------------------------------------------------------------------

    def _add_categories(self) -> None:
        custom = SubElement(self._root, "custom")
        pieces = [piece.instance for body in self._scene.bodies for piece in body.pieces]
        for number, name in sorted({(one.category_id, one.category) for one in pieces}):
            SubElement(custom, "text", {"name": f"category {number}", "data": name})

    def _add_lights(self) -> None:
        for light in self._scene.lights:
            colour, intensity = point_intensity(light)
            full = intensity / _FULL[light.type]
            turn = light_pose(light).matrix()[:3, 0]
            kinds = {"directional": "directional", "point": "point"}
            entry = {
                "name": light.name,
                "type": kinds.get(light.type, "spot"),
                "pos": numbers(light.position_m),
                "dir": numbers(turn.tolist()),
                "diffuse": numbers([full * channel for channel in colour]),
                "specular": "0 0 0",
                "castshadow": "false",
            }
            if entry["type"] == "spot":
                angle = 89.0 if light.type == "area" else light.outer_cone_deg
                entry |= {"cutoff": numbers((angle,)), "exponent": numbers((light.exponent,))}
            SubElement(self._world, "light", entry)

    def _add_cameras(self) -> None:
        for camera in self._scene.cameras:
            lens = camera.intrinsics
            entry = {"name": camera.name, **placed(looking_back(camera.pose))}
            entry["resolution"] = f"{lens.width} {lens.height}"
            if lens.is_parallel:
                entry |= {"projection": "orthographic", "fovy": numbers((lens.height / lens.fy,))}
            else:
                entry["fovy"] = numbers((math.degrees(view_angles(lens)[1]),))
            SubElement(self._world, "camera", entry)


def placed(pose: Pose) -> dict[str, str]:
    """Return a pose as MuJoCo's attributes; quaternions begin with their real part there."""
    x, y, z, w = pose.orientation_xyzw
    return {"pos": numbers(pose.position_m), "quat": numbers((w, x, y, z))}


def _user(piece: ExportedPiece) -> str:
    return f"{piece.instance.id} {piece.instance.category_id}"
