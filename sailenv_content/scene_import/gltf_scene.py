"""glTF files → scenes: each node with a mesh an object, with the file's lights and cameras.

Positions are metres. The file's axes (y up, front towards +z) become the world's (x forward, y
left, z up), so that what looks towards +z there looks towards +x here. Lights are those of the
extension KHR_lights_punctual, in candela and lux; 683 of these are one watt.
"""

from __future__ import annotations

import dataclasses
import math
import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sailenv_content.scene_import.categories_by_name import category_of_name
from sailenv_content.scene_import.default_light import add_daylight
from sailenv_content.scene_import.imported import Entry, ImportedAsset, ImportedScene, Names
from sailenv_content.scene_import.scene_parts import asset_of_parts
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.gltf_description import description_of
from sailenv_ros.assets.model_files import RawPart, read_parts
from sailenv_ros.assets.pack import PackEntry
from sailenv_ros.errors import AssetError
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import LUMENS_PER_WATT

__all__ = ["import_gltf"]

Matrix = NDArray[np.float64]
Tree = Mapping[str, Any]

MOST_NODES = 20_000
MOST_LIGHTS = 60

_WORLD_FROM_FILE = np.array(
    [[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
# A camera and a lamp of glTF look along their -z, with y up: x forward, y left, z up of a body.
_CAMERA_FROM_BODY = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]])


def import_gltf(path: Path, names: Names, ours: Mapping[str, PackEntry]) -> ImportedScene:
    """Read a glTF file; ``.glb``, or ``.gltf`` with what it names beside it.

    Raises
    ------
    AssetError
        If it is malformed, too large, or names files that are not beside it.
    """
    tree, _ = description_of(path)
    _check_files(path, tree)
    title = next((str(s.get("name")) for s in _list(tree, "scenes") if s.get("name")), path.stem)
    scene = ImportedScene(title=title, description=f"Imported from the glTF file {path.name}.")
    poses = _node_poses(path, tree)
    _add_objects(path, scene, names, poses, _told_categories(tree))
    for node, pose in zip(_list(tree, "nodes"), poses, strict=True):
        if pose is not None:
            _add_light(tree, node, pose, scene, names)
            _add_camera(tree, node, pose, scene, names)
    if not scene.lights:
        add_daylight(scene)
    return scene


# -- the file ------------------------------------------------------------------------------


def _check_files(path: Path, tree: Tree) -> None:
    """Refuse what would be read from elsewhere: only files beside the glTF are."""
    home = path.resolve().parent
    for entry in (*_list(tree, "buffers"), *_list(tree, "images")):
        uri = entry.get("uri")
        if uri is None or (isinstance(uri, str) and uri.startswith("data:")):
            continue
        if not isinstance(uri, str) or not (home / uri).resolve().is_relative_to(home):
            raise AssetError(path.name, f"it names {uri!r}, which is not beside it")


def _list(tree: Tree, key: str) -> list[dict[str, Any]]:
    found = tree.get(key, [])
    if not isinstance(found, list) or not all(isinstance(entry, dict) for entry in found):
        raise AssetError("glTF", f"its {key} are no list of objects")
    return found


def _node_poses(path: Path, tree: Tree) -> list[Matrix | None]:
    """Return the (4, 4) pose of each node in the file's world; None for those of no scene."""
    nodes = _list(tree, "nodes")
    if len(nodes) > MOST_NODES:
        raise AssetError(path.name, f"it has {len(nodes)} nodes, and {MOST_NODES} are accepted")
    poses: list[Matrix | None] = [None] * len(nodes)
    scenes = _list(tree, "scenes")
    shown = tree.get("scene", 0)
    first = scenes[shown] if isinstance(shown, int) and 0 <= shown < len(scenes) else {}
    roots = first.get("nodes", [])
    waiting = [(number, np.eye(4)) for number in roots] if isinstance(roots, list) else []
    while waiting:
        number, parent = waiting.pop()
        if not isinstance(number, int) or not 0 <= number < len(nodes):
            raise AssetError(path.name, f"it names the node {number!r}, which is not there")
        if poses[number] is not None:
            raise AssetError(path.name, f"its node {number} has two parents, or is its own")
        own = parent @ _local(path, nodes[number])
        poses[number] = own
        children = nodes[number].get("children", [])
        if not isinstance(children, list):
            raise AssetError(path.name, f"the children of node {number} are no list")
        waiting += [(child, own) for child in children]
    return poses


def _local(path: Path, node: Tree) -> Matrix:
    matrix = np.eye(4)
    try:
        if "matrix" in node:
            matrix = np.array(node["matrix"], np.float64).reshape(4, 4).T
        else:
            turn = Rotation.from_quat(node.get("rotation", (0, 0, 0, 1))).as_matrix()
            matrix[:3, :3] = turn * np.array(node.get("scale", (1, 1, 1)), np.float64)
            matrix[:3, 3] = node.get("translation", (0, 0, 0))
    except (TypeError, ValueError):
        matrix = np.full((4, 4), np.nan)
    if not np.isfinite(matrix).all() or np.abs(matrix).max() > 1e6:
        raise AssetError(path.name, f"the node {node.get('name', '')!r} has no pose that is one")
    return matrix


# -- objects -------------------------------------------------------------------------------


def _told_categories(tree: Tree) -> dict[str, str]:
    """Return the categories that extras of nodes have, by the names of these nodes."""
    known = {category.name for category in load_categories().values()}
    told = ((node.get("name"), node.get("extras")) for node in _list(tree, "nodes"))
    named = ((name, extras.get("category")) for name, extras in told if isinstance(extras, dict))
    return {str(name): category for name, category in named if category in known}


def _add_objects(
    path: Path,
    scene: ImportedScene,
    names: Names,
    poses: Sequence[Matrix | None],
    told: Mapping[str, str],
) -> None:
    if all(pose is None for pose in poses):
        return
    made: dict[tuple[object, ...], ImportedAsset] = {}
    for label, parts in _grouped(read_parts(path)):
        if told.get(label) == "outside":
            # Rooms have theirs by a word; as an object it would be in everybody's way.
            scene.notes.append(f"{label!r}, which is seen through windows, was left out")
            continue
        shown = names.of_object(label)
        pose, local = _placed(parts)
        category = told.get(label) or category_of_name(f"{label} {parts[0].name}")
        key = (told.get(label), *(_look(part) for part in local))
        if key not in made:
            made[key] = asset_of_parts(
                names.of_asset(label),
                local,
                display_name=f"{scene.title[:40]} {shown}",
                category=category,
                source=scene.description,
            )
            scene.assets.append(made[key])
        entry: Entry = {
            "name": shown,
            "asset": made[key].name,
            "position": [round(v, 5) + 0.0 for v in pose.position_m],
        }
        rpy = [round(v, 4) + 0.0 for v in pose.rpy_deg]
        if any(rpy):
            entry["rotation"] = rpy
        entry["static"] = True
        scene.add_object(entry)


def _look(part: RawPart) -> tuple[object, ...]:
    """Return what two parts that look the same have in common."""
    material, mesh = part.material, part.mesh
    texture = material.base_colour_texture
    return (
        *(material.base_colour, material.metallic, material.roughness, material.alpha),
        material.emission,
        None if texture is None else zlib.crc32(texture.tobytes()),
        # To a tenth of a millimetre: places are sums of single precision.
        (mesh.positions.round(4) + 0.0).tobytes(),
        mesh.triangles.tobytes(),
    )


def _grouped(parts: Sequence[RawPart]) -> Iterator[tuple[str, list[RawPart]]]:
    """Yield a node's name with its parts: the reader names the primitives of one node alike."""
    groups: dict[str, list[RawPart]] = {}
    nodes = {part.node for part in parts}
    for part in parts:
        stem, _, mark = part.node.rpartition("_")
        alike = sum(
            node.rpartition("_")[0] == stem and len(node.rpartition("_")[2]) == 6 for node in nodes
        )
        one_of_several = bool(stem) and len(mark) == 6 and alike > 1
        groups.setdefault(stem if one_of_several else part.node, []).append(part)
    # The reader keeps no order of its own.
    yield from sorted(groups.items())


def _placed(parts: Sequence[RawPart]) -> tuple[Pose, list[RawPart]]:
    """Return where an object stands, and its parts about the middle of their base."""
    points = np.concatenate([p.mesh.positions[np.unique(p.mesh.triangles)] for p in parts])
    low, high = points.min(axis=0), points.max(axis=0)
    origin = np.array([*(0.5 * (low + high))[:2], low[2]])
    moved = []
    for part in parts:
        mesh = dataclasses.replace(part.mesh, positions=part.mesh.positions - origin)
        moved.append(dataclasses.replace(part, mesh=mesh))
    return Pose((float(origin[0]), float(origin[1]), float(origin[2]))), moved


# -- lights and cameras --------------------------------------------------------------------


def _add_light(tree: Tree, node: Tree, pose: Matrix, scene: ImportedScene, names: Names) -> None:
    number = _extension(node).get("light")
    lights = _extension(tree).get("lights", [])
    if not isinstance(number, int) or not isinstance(lights, list) or not 0 <= number < len(lights):
        return
    light = lights[number]
    if not isinstance(light, dict) or len(scene.lights) >= MOST_LIGHTS:
        return
    kind = {"directional": "directional", "point": "point", "spot": "spot"}.get(
        str(light.get("type"))
    )
    if kind is None:
        return
    place, turn = _in_world(pose)
    entry: Entry = {"name": names.of_object(str(light.get("name") or node.get("name") or kind))}
    entry["type"] = kind
    if kind != "directional":
        entry["position"] = [round(float(v), 5) + 0.0 for v in place]
    if kind != "point":
        entry["direction"] = [round(float(v), 6) + 0.0 for v in turn[:, 0]]
    colour = light.get("color", [1.0, 1.0, 1.0])
    if isinstance(colour, list) and len(colour) == 3:
        entry["colour"] = [round(min(max(_number(v, 1.0), 0.0), 1.0), 4) for v in colour]
    intensity = min(max(_number(light.get("intensity"), 1.0), 0.0), 1e9)
    entry["intensity"] = round(intensity / LUMENS_PER_WATT, 6)
    reach = _number(light.get("range"), 0.0)
    if kind != "directional" and 0.0 < reach <= 1000.0:
        entry["range"] = round(reach, 4)
    cone = light.get("spot")
    if kind == "spot":
        cone = cone if isinstance(cone, dict) else {}
        inner = math.degrees(_number(cone.get("innerConeAngle"), 0.0))
        outer = math.degrees(_number(cone.get("outerConeAngle"), math.pi / 4.0))
        outer = min(max(outer, 0.1), 89.0)
        entry["outer_cone"] = round(outer, 3)
        entry["inner_cone"] = round(min(max(inner, 0.0), outer - 0.05), 3)
    scene.lights.append(entry)


def _add_camera(tree: Tree, node: Tree, pose: Matrix, scene: ImportedScene, names: Names) -> None:
    number, cameras = node.get("camera"), _list(tree, "cameras")
    if not isinstance(number, int) or not 0 <= number < len(cameras) or len(scene.agents) >= 16:
        return
    lens = cameras[number].get("perspective")
    place, turn = _in_world(pose)
    body = Pose.from_matrix(np.block([[turn, place[:, None]], [np.zeros((1, 3)), np.ones((1, 1))]]))
    entry: Entry = {
        "name": names.of_asset(str(node.get("name") or cameras[number].get("name") or "camera")),
        "position": [round(v, 5) + 0.0 for v in body.position_m],
        "rotation": [round(v, 4) + 0.0 for v in body.rpy_deg],
        "following": False,
    }
    if isinstance(lens, dict):
        fov = math.degrees(_number(lens.get("yfov"), math.pi / 3.0))
        entry["vertical_fov"] = round(min(max(fov, 1.0), 170.0), 3)
    scene.agents.append(entry)


def _extension(tree: Tree) -> Tree:
    extensions = tree.get("extensions")
    found = extensions.get("KHR_lights_punctual") if isinstance(extensions, dict) else None
    return found if isinstance(found, dict) else {}


def _in_world(pose: Matrix) -> tuple[Matrix, Matrix]:
    """Return place (3,) and rotation (3, 3) of a body that looks along a node's -z."""
    matrix = _WORLD_FROM_FILE @ pose
    lengths = np.linalg.norm(matrix[:3, :3], axis=0)
    axes = matrix[:3, :3] / np.where(lengths > 1e-12, lengths, 1.0)
    return matrix[:3, 3], np.asarray(axes @ _CAMERA_FROM_BODY)


def _number(value: object, default: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return default
    return float(value)
