"""URDF and MJCF files → scenes: each body an object, on a joint if it has one that moves.

Both are read by MuJoCo in a process of its own (`robot_reader`), after a look at what the file
names: only files beside it, and nothing that grows without end.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import trimesh
from numpy.typing import NDArray

from sailenv_content.scene_import.categories_by_name import category_of_name
from sailenv_content.scene_import.default_light import add_daylight
from sailenv_content.scene_import.imported import Entry, ImportedScene, Names
from sailenv_content.scene_import.robot_joints import check_limits, pose_entry, pose_of_body
from sailenv_content.scene_import.robot_places import RobotPlaces
from sailenv_content.scene_import.scene_parts import asset_of_parts
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.meshes import RawMesh
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.assets.robots.read_apart import checked_tree, read_apart
from sailenv_ros.errors import AssetError
from sailenv_ros.extras import need
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Material

__all__ = ["import_robot_scene"]

Doubles = NDArray[np.float64]
Geom: TypeAlias = Mapping[str, Any]

PLANE_M = 20.0
"""Side of a plane without end [m]."""

# MuJoCo's numbers, which its files fix.
_PLANE, _SPHERE, _CAPSULE, _ELLIPSOID, _CYLINDER, _BOX, _MESH = 0, 2, 3, 4, 5, 6, 7
_LIGHT_TYPES = {0: "spot", 1: "directional", 2: "point"}
# A camera of MuJoCo looks along its -z, with y up.
_CAMERA_FROM_BODY = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])


def import_robot_scene(path: Path, names: Names, ours: Mapping[str, PackEntry]) -> ImportedScene:
    """Read a URDF or MJCF file with the meshes that it names.

    Raises
    ------
    AssetError
        If it is malformed, too large or malicious.
    MissingPackage
        If MuJoCo is not installed.
    """
    need("mujoco", "importing URDF and MJCF")
    root = checked_tree(path)
    limits = check_limits(root, path.name)
    read, arrays = read_apart(path)
    kind = "URDF" if root.tag == "robot" else "MJCF"
    title = root.text("name") or root.text("model") or path.stem
    scene = ImportedScene(title=title, description=f"Imported from the {kind} file {path.name}.")
    builder = _RobotBuilder(
        scene, names, read, arrays, visuals_apart=root.tag == "robot", limits=limits
    )
    builder.add_bodies()
    builder.add_lights()
    builder.add_cameras()
    return scene


# -- the scene -----------------------------------------------------------------------------


class _RobotBuilder:
    def __init__(
        self,
        scene: ImportedScene,
        names: Names,
        read: Mapping[str, Any],
        arrays: Mapping[str, Doubles],
        *,
        visuals_apart: bool,
        limits: Mapping[str, tuple[float, float]],
    ) -> None:
        self._places = RobotPlaces(read["bodies"], limits, scene.title)
        self._visuals_apart = visuals_apart
        self._scene = scene
        self._names = names
        self._read = read
        self._arrays = arrays
        self._categories = {category.name for category in load_categories().values()}

    def add_bodies(self) -> None:
        """Add each body with its geometries; those of the world are objects of their own."""
        geoms: dict[int, list[Geom]] = {}
        for geom in self._read["geoms"]:
            geoms.setdefault(geom["body"], []).append(geom)
        for number, body in enumerate(self._read["bodies"]):
            own = geoms.get(number, [])
            if number == 0:
                for geom in own:
                    entry: Entry = {**pose_entry(pose_of_body(body)), "static": True}
                    self._add_object(geom["name"] or "ground", body, [geom], entry)
                continue
            entry = self._places.place(number)
            if own and self._add_object(body["name"] or "body", body, own, entry):
                self._places.take_note(number, self._scene.objects[-1]["name"])
            elif "joint" in entry and entry["joint"]["type"] != "fixed":
                self._places.leave_out(number)
        self._scene.notes += self._places.notes()

    def _told_category(self, geoms: Sequence[Geom]) -> str:
        """Return the category that the first geometry's user data name, as exports have them."""
        user = geoms[0]["user"]
        told = self._read["texts"].get(f"category {user[1]:.0f}", "") if len(user) > 1 else ""
        return told if told in self._categories else ""

    def _drawn(self, geoms: Sequence[Geom]) -> list[Geom]:
        """Return what is drawn of a body: of URDF its visuals, of MJCF the groups that are shown.

        All of it where that would be nothing.
        """
        if self._visuals_apart:
            found = [geom for geom in geoms if not geom["collides"]]
        else:
            found = [geom for geom in geoms if geom["drawn"] and geom["rgba"][3] > 0.0]
        return found or list(geoms)

    def _add_object(
        self, label: str, body: Mapping[str, Any], geoms: Sequence[Geom], place: Entry
    ) -> bool:
        """Add an object with the keys of its place; False if it had to be left out."""
        shown_geoms = self._drawn(geoms)
        pose = pose_of_body(body)
        parts = [part for geom in shown_geoms for part in self._parts(geom, pose.matrix())]
        if not parts:
            self._scene.notes.append(f"{label!r} was left out: no geometry of it can be read")
            return False
        shown = self._names.of_object(label)
        try:
            asset = asset_of_parts(
                self._names.of_asset(label),
                parts,
                display_name=f"{self._scene.title[:40]} {shown}",
                category=self._told_category(geoms) or category_of_name(label),
                collides=any(geom["collides"] for geom in geoms),
                source=self._scene.description,
            )
        except AssetError as problem:
            self._scene.notes.append(f"{label!r} was left out: {problem.why}")
            return False
        self._scene.assets.append(asset)
        self._scene.add_object({"name": shown, "asset": asset.name, **place})
        return True

    def _parts(self, geom: Geom, world_from_body: Doubles) -> Iterator[RawPart]:
        mesh = self._mesh(geom)
        if mesh is None or not len(mesh.faces):
            return
        turn = np.array(geom["matrix"]).reshape(3, 3)
        points = np.asarray(mesh.vertices) @ turn.T + np.array(geom["position"])
        points = (points - world_from_body[:3, 3]) @ world_from_body[:3, :3]
        red, green, blue, alpha = (min(max(float(v), 0.0), 1.0) for v in geom["rgba"])
        colour = linear_from_srgb(np.array([red, green, blue])).tolist()
        material = Material(
            base_colour=(colour[0], colour[1], colour[2], alpha),
            roughness=0.9 - 0.7 * min(max(float(geom["shininess"]), 0.0), 1.0),
            alpha="blend" if alpha < 0.95 else "opaque",
        )
        raw = RawMesh(
            positions=points,
            uvs=np.zeros((len(points), 2)),
            triangles=np.asarray(mesh.faces, np.int64),
        )
        yield RawPart(name=geom["name"] or "geom", mesh=raw, material=material, textured=False)

    def _mesh(self, geom: Geom) -> Any:
        """Return a geometry's triangles in its own axes; None for kinds that are not read."""
        kind, (a, b, c) = geom["type"], geom["size"]
        if kind == _BOX:
            return trimesh.creation.box((2 * a, 2 * b, 2 * c))
        if kind == _PLANE:
            sides = [2.0 * side if side > 0.0 else PLANE_M for side in (a, b)]
            mesh = trimesh.creation.box((min(sides[0], 99.0), min(sides[1], 99.0), 0.1))
            mesh.apply_translation((0.0, 0.0, -0.05))
            return mesh
        if kind in (_SPHERE, _ELLIPSOID):
            mesh = trimesh.creation.icosphere(subdivisions=3)
            mesh.apply_scale((a, a, a) if kind == _SPHERE else (a, b, c))
            return mesh
        if kind == _CYLINDER:
            return trimesh.creation.cylinder(radius=a, height=2 * b, sections=48)
        if kind == _CAPSULE:
            return trimesh.creation.capsule(radius=a, height=2 * b, count=(24, 24))
        if kind == _MESH and f"vertices_{geom['mesh']}" in self._arrays:
            vertices = self._arrays[f"vertices_{geom['mesh']}"]
            faces = self._arrays[f"faces_{geom['mesh']}"].astype(np.int64)
            return trimesh.Trimesh(vertices, faces, process=False)
        return None

    def add_lights(self) -> None:
        """Add the lights; MuJoCo's have no unit, 1 is what lights a surface fully here."""
        for light in self._read["lights"][:60]:
            peak = max(light["colour"])
            if not 0.0 < peak <= 1e6:
                continue
            kind = _LIGHT_TYPES.get(light["type"], "point")
            entry: Entry = {"name": self._names.of_object(light["name"] or f"{kind} light")}
            entry["type"] = kind
            if kind != "directional":
                entry["position"] = [round(v, 5) + 0.0 for v in light["position"]]
            if kind != "point":
                entry["direction"] = [round(v, 6) + 0.0 for v in light["direction"]]
            entry["colour"] = [round(max(v, 0.0) / peak, 4) for v in light["colour"]]
            entry["intensity"] = round((math.pi if kind == "directional" else 4.0) * peak, 5)
            if kind == "spot":
                outer = min(max(light["cutoff"], 1.0), 89.0)
                entry["outer_cone"], entry["inner_cone"] = outer, round(0.7 * outer, 3)
            self._scene.lights.append(entry)
        if self._scene.lights:
            self._scene.environment.update({"ambient": [0.25, 0.25, 0.25]})
        else:
            add_daylight(self._scene)

    def add_cameras(self) -> None:
        """Add the cameras as agents."""
        for camera in self._read["cameras"][:16]:
            turn = np.array(camera["matrix"]).reshape(3, 3) @ _CAMERA_FROM_BODY
            matrix = np.eye(4)
            matrix[:3, :3], matrix[:3, 3] = turn, camera["position"]
            pose = Pose.from_matrix(matrix)
            self._scene.agents.append(
                {
                    "name": self._names.of_asset(camera["name"] or "camera"),
                    "position": [round(v, 5) + 0.0 for v in pose.position_m],
                    "rotation": [round(v, 4) + 0.0 for v in pose.rpy_deg],
                    "following": False,
                    "vertical_fov": round(min(max(camera["fov"], 1.0), 170.0), 3),
                }
            )
