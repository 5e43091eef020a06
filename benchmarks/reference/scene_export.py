"""A frozen world as a scene of the path tracer Mitsuba 3: shapes, materials, light, cameras.

A `WorldSnapshot` in, a dict out that `trace.py` loads in an environment of its own; meshes and
textures go to `Parts`. It must not know Mitsuba itself: the dict holds numbers and names of files.

`ambient` and `sky_share` of the environment are left out: they stand for light that bounces, which
a path tracer follows. What lights the traced scene is the sky, the sun and the lamps.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.reference.parts import Parts, ply_bytes
from benchmarks.reference.surfaces import bsdf, emitter
from sailenv_ros.render.scene.flat_mirrors import material_shown
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.light_shapes import LAMP_RADIUS_M
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Material, Mesh
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = [
    "analytic_sky",
    "lamp",
    "scene_of",
    "sensor",
    "surroundings",
    "without_outside",
    "world_mesh",
]

Dict = dict[str, Any]
Floats = NDArray[np.float64]

MITSUBA_FROM_OPTICAL = np.diag([-1.0, -1.0, 1.0, 1.0])
"""Mitsuba's cameras look along +z as well, with x to the left and y up."""

WORLD_FROM_SKY: Floats = np.array(
    [[0.0, 0.0, 1.0, 0.0], [1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
)
"""(4, 4): Mitsuba's sky maps have y up and +z in the middle column, with +x left of it; ours have z
up and +x in the middle, with +y left of it."""

SUN_RADIUS_DEG = 0.2666
"""Half the angle under which the sun is seen from the earth."""

SKY_ROWS = 256
LARGEST_DEPTH = 24


def scene_of(snapshot: WorldSnapshot, parts: Parts) -> Dict:
    """Describe all that stands and shines in a world; shapes of one material are one mesh.

    Parameters
    ----------
    snapshot : WorldSnapshot
    parts : Parts
        Takes the meshes and textures.
    """
    contents = snapshot.contents
    scene: Dict = {"type": "scene", "integrator": _integrator()}
    scene["sky"] = surroundings(contents.environment, parts)
    for number, light in enumerate(contents.lights):
        if light.intensity > 0.0 and max(light.colour) > 0.0:
            scene[f"light {number:02d}"] = lamp(light)
    for number, (material, pieces) in enumerate(_pieces_by_material(snapshot)):
        scene[f"shape {number:04d}"] = _shape(material, pieces, parts)
    return scene


def without_outside(snapshot: WorldSnapshot) -> WorldSnapshot:
    """Return a snapshot as it is without what lies outside rooms.

    That takes no part in the light: it is shown as the sky is, of which a tracer knows nothing.
    """
    inside = [drawn.outside is None for drawn in snapshot.contents.instances]
    return snapshot.of_rows(np.array(inside))


def sensor(camera: Camera) -> Dict:
    """Describe a camera; its principal point is the picture's middle, as Mitsuba's is."""
    intrinsics = camera.intrinsics
    return {
        "type": "perspective",
        "fov_axis": "y",
        "fov": intrinsics.vertical_fov_deg,
        "near_clip": intrinsics.near_m,
        "far_clip": intrinsics.far_m,
        "to_world": (camera.world_from_camera @ MITSUBA_FROM_OPTICAL).tolist(),
        "film": {
            "type": "hdrfilm",
            "width": intrinsics.width,
            "height": intrinsics.height,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
    }


def lamp(light: Light) -> Dict:
    """Describe a light in the units of `Light`, by what its kind has, for `lamps`.

    An area light's width lies level; of one that faces straight up or down, along world y.
    """
    power = [channel * light.intensity for channel in light.colour]
    described: Dict = {"type": "sailenv_lamp", "kind": light.type, "power": power}
    if light.type != "point":
        # Normalised twice a direction differs in its last digit, which is no other light.
        described["direction"] = [round(part, 9) for part in light.direction]
    if light.type == "directional":
        return {**described, "cos_radius": _cosine(SUN_RADIUS_DEG)}
    described["position"] = list(light.position_m)
    if light.type == "area":
        return {**described, **_face(light)}
    described["radius"] = LAMP_RADIUS_M
    described["range"] = max(light.range_m, 1e-3)
    if light.type == "spot":
        described["cos_inner"] = _cosine(light.inner_cone_deg)
        described["cos_outer"] = _cosine(light.outer_cone_deg)
    return described


def _cosine(angle_deg: float) -> float:
    return math.cos(math.radians(angle_deg))


def _face(light: Light) -> Dict:
    direction = np.asarray(light.direction, dtype=np.float64)
    across = np.cross([0.0, 0.0, 1.0], direction)
    if np.linalg.norm(across) < 1e-6:
        across = np.array([0.0, 1.0, 0.0])
    across /= np.linalg.norm(across)
    return {
        "half_width": (across * light.width_m / 2.0).tolist(),
        "half_height": (np.cross(direction, across) * light.height_m / 2.0).tolist(),
        "area": light.width_m * light.height_m,
    }


def surroundings(environment: Environment, parts: Parts) -> Dict:
    """Describe what is seen, and what lights, from beyond all shapes."""
    if environment.background == "colour":
        value = {"type": "rgb", "value": list(environment.background_colour)}
        return {"type": "constant", "radiance": value}
    sky = environment.sky
    radiance = analytic_sky(environment) if sky is None else sky.radiance.astype(np.float32)
    return {"type": "envmap", "array": parts.array(radiance), "to_world": WORLD_FROM_SKY.tolist()}


def analytic_sky(environment: Environment, rows: int = SKY_ROWS) -> NDArray[np.float32]:
    """Draw the sky of three colours as a map, by the formula of picture.glsl.

    Returns
    -------
    radiance : (rows, 2 rows, 3) float32
        Row 0 is the zenith.
    """
    up = np.cos((np.arange(rows) + 0.5) / rows * np.pi)[:, None]
    zenith, horizon, ground = (
        np.asarray(colour)
        for colour in (environment.sky_zenith, environment.sky_horizon, environment.sky_ground)
    )
    upper = horizon + np.sqrt(np.clip(up, 0.0, 1.0)) * (zenith - horizon)
    below = np.clip(-up / 0.12, 0.0, 1.0)
    column = upper + below * below * (3.0 - 2.0 * below) * (ground - upper)
    return np.repeat(column[:, None, :], 2 * rows, axis=1).astype(np.float32)


def world_mesh(
    mesh: Mesh, world_from_body: Floats, scale: tuple[float, float, float]
) -> tuple[Floats, Floats, Floats]:
    """Put a mesh where its object stands.

    Returns
    -------
    positions, normals : (N, 3) float64
        World frame.
    uvs : (N, 2) float64
        With v downwards from the texture's top row.
    """
    rotation, stretch = world_from_body[:3, :3], np.asarray(scale, dtype=np.float64)
    positions = (mesh.positions * stretch) @ rotation.T + world_from_body[:3, 3]
    normals = (mesh.normals / stretch) @ rotation.T
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    return positions, normals, mesh.uvs * np.array([1.0, -1.0]) + np.array([0.0, 1.0])


BACK_M = 2e-4
"""Distance of the backs of sheets that shine from their fronts [m]."""

Vector3 = tuple[float, float, float]
_Piece = tuple[Mesh, Floats, tuple[float, float, float]]


def _pieces_by_material(snapshot: WorldSnapshot) -> list[tuple[Material, list[_Piece]]]:
    grouped: dict[tuple[int, bool, Vector3], tuple[Material, list[_Piece]]] = {}
    contents = snapshot.contents
    for drawn, pose in zip(contents.instances, snapshot.world_from_body, strict=True):
        power = drawn.lamp_power(contents.lights)
        for part in drawn.model.parts:
            lit = power if any(part.material.glow) else (0.0, 0.0, 0.0)
            shown = material_shown(part, drawn.instance.category)
            key = id(part.material), shown is part.material, lit
            pieces = grouped.setdefault(key, (_lit(shown, lit), []))[1]
            pieces.append((part.mesh, pose, drawn.scale))
    return list(grouped.values())


def _lit(material: Material, lamp_power: Vector3) -> Material:
    """Return a material with what it emits by the light of the lamp that it belongs to."""
    if not any(lamp_power):
        return material
    red, green, blue = (
        own + glow * power
        for own, glow, power in zip(material.emission, material.glow, lamp_power, strict=True)
    )
    return replace(material, emission=(red, green, blue))


def _shape(material: Material, pieces: list[_Piece], parts: Parts) -> Dict:
    placed = [world_mesh(*piece) for piece in pieces]
    counts = [len(mesh.positions) for mesh, *_ in pieces]
    firsts = np.cumsum([0, *counts[:-1]])
    triangles = [
        mesh.triangles.astype(np.int64) + first
        for (mesh, *_), first in zip(pieces, firsts, strict=True)
    ]
    positions, normals, uvs = (np.concatenate(arrays) for arrays in zip(*placed, strict=True))
    corners, glow = np.concatenate(triangles), emitter(material, parts)
    if glow is not None and material.double_sided:
        # Mitsuba's faces shine forwards alone: others close behind them shine backwards.
        corners = np.concatenate([corners, corners[:, ::-1] + len(positions)])
        positions = np.concatenate([positions, positions - BACK_M * normals])
        normals, uvs = np.concatenate([normals, -normals]), np.concatenate([uvs, uvs])
    content = ply_bytes(positions, normals, uvs, corners)
    shape: Dict = {"type": "ply", "filename": parts.mesh(content), "bsdf": bsdf(material, parts)}
    return shape if glow is None else {**shape, "emitter": glow}


def _integrator() -> Dict:
    # Of Mitsuba's integrators this one lets light from lamps pass through panes and cut-outs.
    return {"type": "volpath", "max_depth": LARGEST_DEPTH, "rr_depth": 5}
