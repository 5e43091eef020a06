"""`ExportedScene` → OpenUSD as text (usda), alone or with its pictures in one file (usdz).

Axes, metres and kilograms are the world's own. Each body is an Xform with its pose: drawn meshes
below it have the body's scale, collision shapes have none. Labels are SemanticsLabelsAPI. Pieces
that are there several times inherit one class and are instances.

Pixar, "OpenUSD" 25.11; Alliance for OpenUSD, "Core Specification" 1.0.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from sailenv_ros.scene_export.contents import ExportedBody, ExportedPiece, ExportedScene, Written
from sailenv_ros.scene_export.lit_picture import lit_picture
from sailenv_ros.scene_export.losses import camera_losses, counted, joint_losses
from sailenv_ros.scene_export.names import FreeNames, identifier
from sailenv_ros.scene_export.optics import looking_back
from sailenv_ros.scene_export.trees import together
from sailenv_ros.scene_export.usd_geometry import UsdGeometry, write_place
from sailenv_ros.scene_export.usd_lights import write_camera, write_light, write_sky
from sailenv_ros.scene_export.usd_materials import UsdMaterials
from sailenv_ros.scene_export.usd_physics import (
    body_schemas,
    write_joint,
    write_mass,
    write_shape,
)
from sailenv_ros.scene_export.usd_text import UsdText, number, quoted, tokens, vector
from sailenv_ros.scene_export.usdz import usdz_bytes
from sailenv_ros.types.geometry import Pose
from sailenv_ros.version import __version__

__all__ = ["write_usda", "write_usdz"]

HEAD = """#usda 1.0
(
    defaultPrim = "{name}"
    doc = "{doc}"
    kilogramsPerUnit = 1
    metersPerUnit = 1
{times}    upAxis = "Z"
)
"""

LABELS = ("SemanticsLabelsAPI:category", "SemanticsLabelsAPI:instance")


def write_usda(scene: ExportedScene, folder: str) -> Written:
    """Return a scene as text with its pictures beside it; the same bytes for the same scene."""
    made = _UsdWriter(scene, folder)
    return Written(data=made.data, beside=made.pictures, losses=tuple(_losses(scene)))


def write_usdz(scene: ExportedScene, folder: str) -> Written:
    """Return a scene and its pictures as one file; the same bytes for the same scene."""
    made = _UsdWriter(scene, "textures")
    files = {f"{identifier(scene.name)}.usda": made.data}
    files |= {f"textures/{name}": data for name, data in made.pictures.items()}
    return Written(data=usdz_bytes(files), losses=tuple(_losses(scene)))


def _losses(scene: ExportedScene) -> Iterator[str]:
    yield from camera_losses(scene, "USD", shifts=True)
    yield from joint_losses(scene, "USD")
    if scene.light_map is not None:
        yield "colours of what is in the light map are as fine as its picture in USD"
    environment = scene.environment
    if environment is not None:
        yield "the sky is a dome of one colour in USD"
    exponents = sum(light.exponent > 0.0 for light in scene.lights if light.type == "spot")
    if exponents:
        yield f"{counted(exponents, 'spot')} lost the exponent in USD"
    if any(body.joint is not None and body.joint.friction > 0.0 for body in scene.bodies):
        yield "dry friction of joints has no equal in USD"
    floating = sum(not body.gravity and not body.static for body in scene.bodies)
    if floating:
        yield f"gravity pulls {counted(floating, 'object')} in USD that float here"


class _UsdWriter:
    def __init__(self, scene: ExportedScene, folder: str) -> None:
        self._scene = scene
        self._text = text = UsdText()
        self._root = identifier(scene.name)
        self._is_piece = scene.environment is None
        self._paths: dict[str, str] = {}
        surfaces = {(body.friction, body.restitution) for body in scene.bodies if body.shapes}
        light = scene.light_map
        lit = (None, 0.0) if light is None else (lit_picture(scene), light.white)
        self._materials = UsdMaterials(text, f"/{self._root}/Looks", folder, *lit)
        kind = "component" if self._is_piece else "assembly"
        metadata = {
            "assetInfo": f"{{ string identifier = {quoted(scene.name)}; string version = "
            f"{quoted(__version__)} }}",
            "kind": quoted(kind),
        }
        with text.prim("Xform", self._root, metadata=metadata):
            pieces = [piece for body in scene.bodies for piece in body.pieces]
            self._materials.write(pieces, sorted(surfaces))
            self._geometry = UsdGeometry(text, scene, self._materials, f"/{self._root}/Classes")
            self._geometry.write_classes()
            with text.prim("PhysicsScene", "PhysicsScene"):
                size = math.hypot(*scene.gravity)
                down = [value / size if size else 0.0 for value in scene.gravity]
                text.attribute("vector3f", "physics:gravityDirection", vector(down))
                text.attribute("float", "physics:gravityMagnitude", number(size))
            self._write_bodies()
            self._write_joints()
            self._write_lights()
            self._write_cameras()
        doc = f"{scene.name}, written by sailenv_ros"
        head = HEAD.format(name=self._root, doc=doc, times=_times(scene))
        self.data = head.encode() + b"\n" + text.data()
        pictures = self._materials.textures.pictures.values()
        self.pictures = {picture.name: picture.data for picture in pictures}

    # -- bodies ----------------------------------------------------------------------------

    def _write_bodies(self) -> None:
        text, names = self._text, FreeNames()
        metadata = {} if self._is_piece else {"kind": quoted("group")}
        for body in self._scene.bodies:
            self._paths[body.name] = f"/{self._root}/Objects/{names.take(body.name)}"
        filtered = self._filtered()
        with text.prim("Xform", "Objects", metadata=metadata):
            for body in self._scene.bodies:
                self._write_body(body, filtered.get(body.name, []))

    def _filtered(self) -> dict[str, list[str]]:
        """Return the paths of what each body does not collide with, beyond its own joint."""
        joined = {(body.joint.parent, body.name) for body in self._scene.bodies if body.joint}
        found: dict[str, list[str]] = {}
        for first, second in together(self._scene):
            if (first, second) not in joined:
                found.setdefault(first, []).append(self._paths[second])
        return found

    def _write_body(self, body: ExportedBody, filtered: list[str]) -> None:
        text, names = self._text, FreeNames()
        schemas = [*body_schemas(body), *LABELS]
        if filtered:
            schemas.append("PhysicsFilteredPairsAPI")
        kind = "subcomponent" if self._is_piece else "component"
        metadata = {"displayName": quoted(body.name), "kind": quoted(kind)}
        name = self._paths[body.name].rpartition("/")[2]
        with text.prim("Xform", name, schemas=schemas, metadata=metadata):
            self._write_labels(body.pieces[0])
            motion = self._scene.motion
            write_mass(text, body, follows=motion is not None and body.instance.id in motion.bodies)
            if filtered:
                text.relate("physics:filteredPairs", *filtered)
            poses = () if motion is None else motion.bodies.get(body.instance.id, ())
            write_place(text, body.pose, samples=self._by_codes(poses))
            own, *labelled = body.pieces
            self._geometry.write_piece(own, body.scale, names.take("geometry"))
            for piece in labelled:
                short = piece.instance.name.rpartition("/")[2]
                display = {"displayName": quoted(short)}
                with text.prim("Xform", names.take(short), schemas=LABELS, metadata=display):
                    self._write_labels(piece)
                    self._geometry.write_piece(piece, body.scale, "geometry")
            if body.shapes:
                material = self._materials.physics(body.friction, body.restitution)
                with text.prim("Scope", names.take("collision")):
                    for number_, shape in enumerate(body.shapes):
                        write_shape(text, shape, f"shape_{number_}", material)

    def _write_labels(self, piece: ExportedPiece) -> None:
        instance = piece.instance
        self._text.attribute("custom string", "sailenv:asset", quoted(instance.asset))
        self._text.attribute("custom int", "sailenv:category_id", str(instance.category_id))
        self._text.attribute("custom int", "sailenv:instance_id", str(instance.id))
        for schema, value in zip(LABELS, (instance.category, instance.name), strict=True):
            taxonomy = schema.partition(":")[2]
            self._text.attribute("token[]", f"semantics:labels:{taxonomy}", tokens([value]))

    def _write_joints(self) -> None:
        jointed = [body for body in self._scene.bodies if body.joint is not None]
        if not jointed:
            return
        names = FreeNames()
        with self._text.prim("Scope", "Joints"):
            for body in jointed:
                assert body.joint is not None
                carrier = self._paths.get(body.joint.parent)
                name = names.take(f"{body.name} joint")
                write_joint(self._text, body, name, self._paths[body.name], carrier)

    # -- all else --------------------------------------------------------------------------

    def _write_lights(self) -> None:
        if self._is_piece:
            return
        names = FreeNames()
        with self._text.prim("Scope", "Lights"):
            if self._scene.environment is not None:
                write_sky(self._text, self._scene.environment, names.take("sky"))
            for light in self._scene.lights:
                write_light(self._text, light, names.take(light.name))

    def _write_cameras(self) -> None:
        names, motion = FreeNames(), self._scene.motion
        if self._scene.cameras:
            with self._text.prim("Scope", "Cameras"):
                for camera in self._scene.cameras:
                    poses = () if motion is None else motion.cameras.get(camera.name, ())
                    samples = self._by_codes([looking_back(pose) for pose in poses])
                    write_camera(self._text, camera, names.take(camera.name), samples)

    def _by_codes(self, poses: Sequence[Pose]) -> dict[float, Pose]:
        """Return poses of the motion by their time codes."""
        motion = self._scene.motion
        if motion is None or not poses:
            return {}
        return dict(zip(motion.codes, poses, strict=True))


def _times(scene: ExportedScene) -> str:
    """Return the lines of a layer that tell its time codes."""
    motion = scene.motion
    if motion is None:
        return "    timeCodesPerSecond = 1\n"
    rate = number(motion.rate_hz)
    end = number(motion.codes[-1])
    return (
        f"    endTimeCode = {end}\n    framesPerSecond = {rate}\n    startTimeCode = 0\n"
        f"    timeCodesPerSecond = {rate}\n"
    )
