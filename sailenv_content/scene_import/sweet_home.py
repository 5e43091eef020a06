"""Sweet Home 3D files (``.sh3d``) → scenes.

An archive with ``Home.xml`` (since version 5.3 of the program) and the models and pictures that it
names. Walls and rooms are built here, furniture that the standard pack has is ours, other pieces
are the file's own models.
"""

from __future__ import annotations

import dataclasses
import math
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sailenv_content.scene_import.default_light import ENVIRONMENT, SUN
from sailenv_content.scene_import.home_furniture import HomeFurniture
from sailenv_content.scene_import.home_plan import read_home
from sailenv_content.scene_import.home_types import Home, HomePiece, HomeRoom, HomeWall, Paint
from sailenv_content.scene_import.imported import Entry, ImportedAsset, ImportedScene, Names
from sailenv_content.scene_import.plan_slabs import inside, slab
from sailenv_content.scene_import.plan_walls import Opening, wall_solid
from sailenv_ros.assets.archives import unpack_zip
from sailenv_ros.assets.meshes import RawMesh, smooth_mesh
from sailenv_ros.assets.model_files import LARGEST_TEXTURE_PX, RawPart, texture_of
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.assets.safe_xml import read_xml
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import ConvexShape, Material, ModelPart, Texture

__all__ = ["import_sweet_home"]

Doubles = NDArray[np.float64]

SLAB_M = 0.1
WALL_COLOUR = (0.72, 0.71, 0.69)
CEILING_COLOUR = (0.8, 0.8, 0.79)
FLOOR_COLOUR = (0.45, 0.4, 0.33)

MOST_LIGHTS = 24


def import_sweet_home(
    path: Path, names: Names, ours: Mapping[str, PackEntry] | None = None
) -> ImportedScene:
    """Read a Sweet Home 3D file.

    Parameters
    ----------
    path : Path
    names : Names
    ours : mapping of str to PackEntry
        The standard pack's entries by their names; empty imports every piece's own model.

    Raises
    ------
    AssetError
        If it is malformed, too large or malicious.
    """
    with tempfile.TemporaryDirectory(prefix="sailenv-") as unpacked:
        folder = Path(unpacked) / "files"
        folder.mkdir()
        unpack_zip(path, folder)
        plan = folder / "Home.xml"
        if not plan.is_file():
            raise AssetError(
                path.name,
                "it holds no Home.xml; files of Sweet Home 3D before 5.3 must be opened and saved "
                "by a later one",
            )
        home = read_home(read_xml(plan.read_bytes(), path.name))
        return _HomeBuilder(path, home, folder, names, ours or {}).scene()


class _HomeBuilder:
    def __init__(
        self,
        path: Path,
        home: Home,
        folder: Path,
        names: Names,
        ours: Mapping[str, PackEntry],
    ) -> None:
        self._home = home
        self._folder = folder
        self._names = names
        self._pictures: dict[str, Texture | None] = {}
        self._scene = ImportedScene(
            title=home.name or path.stem,
            description=f"Imported from the Sweet Home 3D file {path.name}.",
        )
        self._furniture = HomeFurniture(folder, names, ours, self._scene, self._material)

    def scene(self) -> ImportedScene:
        home, scene = self._home, self._scene
        for room in home.rooms:
            self._add_room(room)
        openings = [piece for piece in home.pieces if piece.kind == "opening"]
        for wall in home.walls:
            found = [o for piece in openings if (o := piece.opening_in(wall.line)) is not None]
            self._add_wall(wall, found)
        if not home.rooms:
            ground = {"name": self._names.of_object("ground"), "asset": "plane"}
            scene.add_object({**ground, "category": "floor", "static": True})
        for piece in home.pieces:
            self._furniture.add(piece)
        self._add_lights()
        self._add_cameras()
        return scene

    # -- what is built ---------------------------------------------------------------------

    def _add_room(self, room: HomeRoom) -> None:
        rise = room.level_rise_m
        for what, paint, low, high, colour in (
            ("floor", room.floor, -SLAB_M, 0.0, FLOOR_COLOUR),
            ("ceiling", room.ceiling, rise, rise + SLAB_M, CEILING_COLOUR),
        ):
            if paint is None:
                continue
            low, high = low + room.elevation_m, high + room.elevation_m
            mesh, hulls = slab(room.outline, low, high)
            if not len(mesh.triangles):
                continue
            part = self._part(mesh, paint, colour)
            self._add_built(f"{room.name} {what}", what, [part], hulls)

    def _add_wall(self, wall: HomeWall, openings: Sequence[Opening]) -> None:
        solid = wall_solid(wall.line, openings)
        if solid is None:
            return
        parts = [
            self._part(mesh, paint, WALL_COLOUR)
            for mesh, paint in ((solid.left, wall.left), (solid.right, wall.right))
        ]
        parts.append(self._part(solid.rest, wall.top, WALL_COLOUR))
        self._add_built("wall", "wall", parts, solid.hulls)
        if self._home.rooms:
            for opening in openings:
                if opening.height_m[0] < 0.02:
                    self._add_threshold(wall, opening)

    def _add_threshold(self, wall: HomeWall, opening: Opening) -> None:
        """Lay a floor into a door: rooms end at the walls' sides."""
        line = wall.line
        left, right = (min(max(edge, 0.0), line.length_m) for edge in opening.along_m)
        if right - left < 0.05:
            return
        half = 0.5 * line.thickness_m * line.left
        ends = [line.start + along * line.along for along in (left, right)]
        outline = np.array([ends[0] - half, ends[1] - half, ends[1] + half, ends[0] + half])
        middle = outline.mean(axis=0)
        same = [r for r in self._home.rooms if abs(r.elevation_m - line.low_m) < 0.5 and r.floor]
        if not same:
            return
        nearest = min(same, key=lambda room: _distance(room.outline, middle))
        mesh, hulls = slab(outline, line.low_m - SLAB_M, line.low_m)
        part = self._part(mesh, nearest.floor or Paint(), FLOOR_COLOUR)
        self._add_built("threshold", "floor", [part], hulls)

    def _add_built(
        self, name: str, category: str, parts: Sequence[RawPart], hulls: Sequence[ConvexShape]
    ) -> None:
        """Add something whose meshes are in the world; its origin is the middle of its base."""
        points = np.concatenate([part.mesh.positions for part in parts])
        low, high = points.min(axis=0), points.max(axis=0)
        origin = np.array([*(0.5 * (low + high))[:2], low[2]]).round(4)
        drawn = []
        for part in parts:
            mesh = part.mesh
            if len(mesh.triangles):
                moved = RawMesh(
                    positions=mesh.positions - origin, uvs=mesh.uvs, triangles=mesh.triangles
                )
                drawn.append(ModelPart(mesh=smooth_mesh(moved), material=part.material))
        shown = self._names.of_object(name)
        asset = ImportedAsset(
            name=self._names.of_asset(shown),
            display_name=f"{self._scene.title[:40]} {shown}",
            category=category,
            parts=tuple(drawn),
            hulls=tuple(ConvexShape(points=hull.points - origin) for hull in hulls),
            source=self._scene.description,
        )
        self._scene.assets.append(asset)
        position = [round(float(v), 4) + 0.0 for v in origin]
        entry = {"name": shown, "asset": asset.name, "position": position, "static": True}
        self._scene.add_object(entry)

    # -- light and cameras -----------------------------------------------------------------

    def _add_lights(self) -> None:
        scene = self._scene
        scene.environment = dict(ENVIRONMENT)
        scene.lights.append(dict(SUN))
        wanted: list[Entry] = []
        for piece in self._home.pieces:
            if piece.kind == "opening" and piece.position[2] > 0.02 and self._home.rooms:
                light = self._window_light(piece)
                wanted.extend([light] if light else [])
        for piece in self._home.pieces:
            for place, colour in piece.sources:
                peak = max(colour)
                if peak > 0.0:
                    wanted.append(
                        {
                            "name": self._names.of_object(f"{piece.name} light"),
                            "type": "point",
                            "position": [round(v, 4) for v in place],
                            "colour": [round(v / peak, 4) for v in colour],
                            "intensity": round(0.4 * peak, 4),
                        }
                    )
        if len(wanted) > MOST_LIGHTS:
            scene.notes.append(
                f"of {len(wanted)} lights the first {MOST_LIGHTS} were taken; the others are dark"
            )
        scene.lights.extend(wanted[:MOST_LIGHTS])

    def _window_light(self, piece: HomePiece) -> Entry | None:
        """Return the sky's light through a window into the room on one side of it."""
        x, y, z = piece.position
        a = math.radians(piece.yaw_deg)
        front = np.array([math.cos(a), math.sin(a)])
        depth, width, height = piece.size_m
        sides = []
        for sign in (1.0, -1.0):
            point = np.array([x, y]) + sign * (0.5 * depth + 0.1) * front
            sides.append(any(inside(room.outline, point) for room in self._home.rooms))
        if sides[0] == sides[1]:
            return None  # between two rooms, or between none
        inwards = front if sides[0] else -front
        place = np.array([x, y]) + (0.5 * depth + 0.02) * inwards
        return {
            "name": self._names.of_object(f"{piece.name} sky"),
            "type": "area",
            "position": [round(float(v), 4) + 0.0 for v in (*place, z + 0.5 * height)],
            "direction": [round(float(v), 4) + 0.0 for v in (*inwards, -0.25)],
            "width": round(width, 3),
            "height": round(height, 3),
            "colour": "#e4edf8",
            "intensity": 3.0,
        }

    def _add_cameras(self) -> None:
        for camera in self._home.cameras:
            pose = {
                "position": [round(v, 4) + 0.0 for v in camera.position],
                "rotation": [0.0, round(camera.pitch_deg, 3), round(camera.yaw_deg, 3)],
            }
            if camera.is_observer:
                self._scene.mover = dict(pose)
            elif camera.name not in ("topCamera", "observerCamera"):
                half = math.tan(0.5 * math.radians(min(max(camera.fov_deg, 2.0), 160.0)))
                fov = 2.0 * math.degrees(math.atan(0.75 * half))
                name = self._names.of_asset(camera.name)
                self._scene.agents.append(
                    {"name": name, **pose, "following": False, "vertical_fov": round(fov, 2)}
                )
        del self._scene.agents[8:]

    # -- paint -----------------------------------------------------------------------------

    def _part(self, mesh: RawMesh, paint: Paint, colour: tuple[float, float, float]) -> RawPart:
        material = self._material(paint, Material(base_colour=(*colour, 1.0), roughness=0.9))
        if material.base_colour_texture is not None:
            uvs = mesh.uvs / np.asarray(paint.tile_m)
            mesh = RawMesh(positions=mesh.positions, uvs=uvs, triangles=mesh.triangles)
        return RawPart(name="built", mesh=mesh, material=material, textured=True)

    def _material(self, paint: Paint, otherwise: Material) -> Material:
        """Return a material as painted, else another one."""
        texture = self._picture(paint.image) if paint.image else None
        if texture is not None:
            return dataclasses.replace(
                otherwise,
                base_colour=(1.0, 1.0, 1.0, 1.0),
                base_colour_texture=texture,
                roughness=0.9 - 0.7 * paint.shininess,
            )
        if paint.colour is not None:
            return dataclasses.replace(
                otherwise,
                base_colour=(*paint.colour, otherwise.base_colour[3]),
                base_colour_texture=None,
                roughness=0.9 - 0.7 * paint.shininess,
            )
        return otherwise

    def _picture(self, name: str) -> Texture | None:
        if name not in self._pictures:
            self._pictures[name] = _read_picture(self._folder, name)
        return self._pictures[name]


def _read_picture(folder: Path, name: str) -> Texture | None:
    """Read a picture of the archive; None if it cannot be read.

    Raises
    ------
    AssetError
        If it is too large.
    """
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()) or not path.is_file():
        return None
    try:
        with Image.open(path) as picture:
            if max(picture.size) > LARGEST_TEXTURE_PX:
                raise AssetError(name, f"its {picture.size} pixels pass {LARGEST_TEXTURE_PX}")
            return texture_of(picture)
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError):
        return None


def _distance(outline: Doubles, point: Doubles) -> float:
    """Return how far a point is from an outline's edges."""
    ahead = np.roll(outline, -1, axis=0) - outline
    length = np.maximum((ahead**2).sum(axis=1), 1e-12)
    share = np.clip(((point - outline) * ahead).sum(axis=1) / length, 0.0, 1.0)
    return float(np.linalg.norm(outline + share[:, None] * ahead - point, axis=1).min())
