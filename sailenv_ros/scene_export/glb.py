"""`ExportedScene` → binary glTF 2.0.

Each body is a node with its pose and scale; labelled parts of its model are its children. Meshes,
materials and pictures are shared. The world's axes (x forward, y left, z up) become the file's (y
up, front towards +z), as the importer turns them back. What glTF has no word for stands in extras.

Khronos Group, "glTF 2.0 Specification" (2021), with KHR_lights_punctual and
KHR_materials_emissive_strength.
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

from sailenv_ros.assets.gltf_description import appended, glb_with
from sailenv_ros.assets.gltf_emission import write_strength
from sailenv_ros.scene_export.contents import (
    ExportedBody,
    ExportedPiece,
    ExportedScene,
    Written,
)
from sailenv_ros.scene_export.extras import body_extras, camera_extras, instance_extras
from sailenv_ros.scene_export.glb_buffers import GlbBuffers
from sailenv_ros.scene_export.glb_lights import LIGHTS, gltf_camera, gltf_light
from sailenv_ros.scene_export.glb_motion import GlbMotion
from sailenv_ros.scene_export.losses import camera_losses, light_losses, physics_losses
from sailenv_ros.scene_export.optics import light_pose, looking_back
from sailenv_ros.scene_export.textures import Textures, texture_slots
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.model import Material
from sailenv_ros.version import __version__

__all__ = ["write_glb"]

LIGHT_MAP = "MOZ_lightmap"
"""Mozilla, "MOZ_lightmap": radiance is the base colour times this texture times its intensity."""

_FILE_FROM_WORLD = Pose(orientation_xyzw=(-0.5, -0.5, -0.5, 0.5))
"""The file's x, y, z are the world's y, z, x."""

LOST_BY_BAKING = "light is in the light map (MOZ_lightmap) alone; what can move has none"

_BODY_FROM_FILE = (0.5, 0.5, 0.5, 0.5)

_TEXTURE_KEYS = {
    "base_colour": ("pbrMetallicRoughness", "baseColorTexture"),
    "metallic_roughness": ("pbrMetallicRoughness", "metallicRoughnessTexture"),
    "normal": (None, "normalTexture"),
}


def write_glb(scene: ExportedScene, stem: str) -> Written:
    """Return a scene as a glTF file in one piece; the same bytes for the same scene."""
    made = _GlbWriter(scene)
    losses = (
        *physics_losses(scene, "glTF", extras=True),
        *(light_losses(scene, "glTF") if scene.light_map is None else (LOST_BY_BAKING,)),
        *camera_losses(scene, "glTF"),
    )
    return Written(data=made.data(), losses=losses)


class _GlbWriter:
    def __init__(self, scene: ExportedScene) -> None:
        self._scene = scene
        self._buffers = GlbBuffers()
        self._textures = Textures()
        self._images: dict[str, int] = {}
        self._materials: dict[tuple[int, bool], int] = {}
        self._meshes: dict[tuple[tuple[int, ...], ...], int] = {}
        self._motion = None if scene.motion is None else GlbMotion(scene.motion, self._buffers)
        self._tree: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": f"sailenv_ros {__version__}"},
            "scene": 0,
            "scenes": [{"name": scene.name, "nodes": []}],
        }

    def data(self) -> bytes:
        """Return the whole file."""
        roots = self._tree["scenes"][0]["nodes"]
        roots += [self._add_body(body) for body in self._scene.bodies]
        # All of them are in the light map, if there is one.
        lights = self._scene.lights if self._scene.light_map is None else ()
        roots += [self._add_light(light) for light in lights]
        for camera in self._scene.cameras:
            extras = camera_extras(camera.intrinsics)
            entry = {"name": camera.name, **gltf_camera(camera.intrinsics), "extras": extras}
            node = {"name": camera.name, "camera": appended(self._tree, "cameras", entry)}
            roots.append(appended(self._tree, "nodes", {**node, **_looking(camera.pose)}))
            self._follow(roots[-1], "cameras", camera.name, _looking)
        if lights or self._scene.light_map is not None:
            self._tree["extensionsUsed"] = [LIGHTS if lights else LIGHT_MAP]
        if self._motion is not None and self._motion.moves:
            self._tree["animations"] = [self._motion.entry()]
        views, binary = self._buffers.finished()
        self._tree["accessors"] = self._buffers.accessors
        self._tree["bufferViews"] = views
        self._tree["buffers"] = [{"byteLength": len(binary)}]
        write_strength(self._tree)
        return glb_with(self._tree, struct.pack("<I", len(binary)) + b"BIN\0" + binary)

    # -- nodes -----------------------------------------------------------------------------

    def _add_body(self, body: ExportedBody) -> int:
        own, *labelled = body.pieces
        node = {**self._node(own), **_standing(body.pose)}
        x, y, z = body.scale
        if body.scale != (1.0, 1.0, 1.0):
            node["scale"] = [y, z, x]
        node["extras"].update(body_extras(body))
        if labelled:
            node["children"] = [self._add_piece(piece) for piece in labelled]
        number = appended(self._tree, "nodes", node)
        self._deform(number, own)
        self._follow(number, "bodies", body.instance.id, _standing)
        return number

    def _add_piece(self, piece: ExportedPiece) -> int:
        number = appended(self._tree, "nodes", self._node(piece))
        self._deform(number, piece)
        return number

    def _follow(
        self, node: int, kind: str, key: int | str, placed: Callable[[Pose], dict[str, Any]]
    ) -> None:
        """Let a node follow what the motion knows of it."""
        if self._motion is not None and key in (poses := getattr(self._scene.motion, kind)):
            self._motion.add_poses(node, poses[key], placed)

    def _deform(self, node: int, piece: ExportedPiece) -> None:
        if self._motion is not None and self._samples(piece):
            self._motion.add_weights(node)

    def _samples(self, piece: ExportedPiece) -> Sequence[Sequence[MovedMesh]]:
        """Return the shapes of a piece, a sample each; none where it keeps its own."""
        motion = self._scene.motion
        return () if motion is None else motion.meshes.get(piece.instance.id, ())

    def _node(self, piece: ExportedPiece) -> dict[str, Any]:
        node: dict[str, Any] = {"name": piece.instance.name}
        if piece.parts:
            node["mesh"] = self._mesh(piece)
        return {**node, "extras": instance_extras(piece.instance)}

    def _add_light(self, light: Light) -> int:
        held = self._tree.setdefault("extensions", {}).setdefault(LIGHTS, {"lights": []})
        held["lights"].append(gltf_light(light))
        node = {"name": light.name, "extensions": {LIGHTS: {"light": len(held["lights"]) - 1}}}
        return appended(self._tree, "nodes", {**node, **_looking(light_pose(light))})

    # -- meshes and materials --------------------------------------------------------------

    def _mesh(self, piece: ExportedPiece) -> int:
        parts, samples, places = piece.parts, self._samples(piece), piece.light_places
        name = piece.instance.asset
        key: tuple[tuple[int, ...], ...] = tuple(
            (id(part.mesh), id(part.material)) for part in parts
        )
        if places:
            key = (*key, (piece.instance.id,))
        if key not in self._meshes:
            primitives = []
            for place, part in enumerate(parts):
                attributes, indices = self._buffers.mesh(part.mesh)
                if places:
                    attributes = {**attributes, "TEXCOORD_1": self._buffers.places(places[place])}
                material = self._material(part.material, lit=bool(places))
                primitive = {"attributes": attributes, "indices": indices, "material": material}
                if self._motion is not None and samples:
                    shapes = [sample[place] for sample in samples]
                    primitive["targets"] = self._motion.targets(part, shapes)
                primitives.append(primitive)
            entry: dict[str, Any] = {"name": name, "primitives": primitives}
            if samples:
                entry["weights"] = [1.0] + [0.0] * (len(samples) - 1)
            self._meshes[key] = appended(self._tree, "meshes", entry)
        return self._meshes[key]

    def _material(self, material: Material, *, lit: bool) -> int:
        own = id(material), lit
        if own not in self._materials:
            entry: dict[str, Any] = {
                "pbrMetallicRoughness": {
                    "baseColorFactor": list(material.base_colour),
                    "metallicFactor": material.metallic,
                    "roughnessFactor": material.roughness,
                }
            }
            if material.name:
                entry["name"] = material.name
            for slot, texture, alpha in texture_slots(material):
                within, key = _TEXTURE_KEYS[slot]
                place = entry[within] if within else entry
                place[key] = {"index": self._texture(texture, alpha=alpha)}
            if any(material.emission):
                entry["emissiveFactor"] = list(material.emission)
                if "baseColorTexture" in entry["pbrMetallicRoughness"]:
                    entry["emissiveTexture"] = entry["pbrMetallicRoughness"]["baseColorTexture"]
            if material.alpha != "opaque":
                entry["alphaMode"] = material.alpha.upper()
            if material.alpha == "mask":
                entry["alphaCutoff"] = material.alpha_cutoff
            if material.double_sided:
                entry["doubleSided"] = True
            if lit:
                entry["extensions"] = {LIGHT_MAP: self._light_map()}
            self._materials[own] = appended(self._tree, "materials", entry)
        return self._materials[own]

    def _light_map(self) -> dict[str, Any]:
        """Return how a material finds its light."""
        light = self._scene.light_map
        assert light is not None
        texture = self._texture(light.texture, alpha=True)  # without loss
        return {"index": texture, "texCoord": 1, "intensity": light.white}

    def _texture(self, texture: Any, *, alpha: bool) -> int:
        picture = self._textures.of(texture, alpha=alpha)
        if picture.name not in self._images:
            view = self._buffers.picture(picture)
            image = {"mimeType": picture.mime_type, "bufferView": view}
            source = appended(self._tree, "images", image)
            self._images[picture.name] = appended(self._tree, "textures", {"source": source})
        return self._images[picture.name]


def _standing(pose: Pose) -> dict[str, Any]:
    return _placed(_FILE_FROM_WORLD.carried(pose).turned(_BODY_FROM_FILE))


def _placed(pose: Pose) -> dict[str, Any]:
    return {"translation": list(pose.position_m), "rotation": list(pose.orientation_xyzw)}


def _looking(pose: Pose) -> dict[str, Any]:
    return _placed(looking_back(_FILE_FROM_WORLD.carried(pose)))
