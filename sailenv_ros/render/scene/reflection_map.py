"""Reflection map: a room seen from its middle, blurred for several roughnesses.

Pictures of linear radiance in six directions come in, a texture goes out: the directions of the
world unwrapped to an octahedron, for several roughnesses one behind the other.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import NamedTuple, TypeAlias

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.baked_light import ProbeGrid
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.colour import HALF_MOST, LUMINANCE
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.picture_settings import PictureSettings

__all__ = [
    "EDGE",
    "Blur",
    "Glint",
    "ROUGHNESSES",
    "cube_cameras",
    "flattened",
    "layers_per_roughness",
    "light_from_around",
    "octahedral_directions",
    "prefilter",
    "view_point",
]

EDGE = 96
"""Texels along an edge of the octahedron's square, without its border."""

ROUGHNESSES = (0.0, 0.15, 0.3, 0.45, 0.6)
"""Roughness of each layer; what rougher surfaces mirror is the more by the light map, which knows
their surroundings better."""

SAMPLES = 96

EYE_HEIGHT_M = 1.4
"""Height of the view point of reflections above the floor of the probes' box [m]."""

_FACE_PX = 96
_FACE_FOV_DEG = 92.0

_HEADINGS = ((0.0, 0.0), (90.0, 0.0), (180.0, 0.0), (270.0, 0.0), (0.0, 90.0), (0.0, -90.0))
"""Turn about z and about y [deg]."""


def cube_cameras(position_m: NDArray[np.float64]) -> list[Camera]:
    """Return six cameras that together see everything around a point."""
    intrinsics = CameraIntrinsics(
        width=_FACE_PX, height=_FACE_PX, vertical_fov_deg=_FACE_FOV_DEG, near_m=0.02
    )
    x, y, z = (float(number) for number in position_m)
    return [
        Camera(
            intrinsics=intrinsics,
            pose=Pose.from_rpy_deg((x, y, z), (0.0, pitch, yaw)),
            picture=PictureSettings(smooth_edges=False),
        )
        for yaw, pitch in _HEADINGS
    ]


@lru_cache(maxsize=4)
def octahedral_directions(edge: int) -> NDArray[np.float32]:
    """Return (edge, edge, 3) read-only: the unit direction of each texel's centre."""
    at = (np.arange(edge, dtype=np.float32) + 0.5) / edge * 2.0 - 1.0
    x, y = np.meshgrid(at, at)
    z = 1.0 - np.abs(x) - np.abs(y)
    fold = np.maximum(-z, 0.0)
    directions = np.stack([x - np.copysign(fold, x), y - np.copysign(fold, y), z], axis=-1)
    unit: NDArray[np.float32] = directions / np.linalg.norm(directions, axis=-1, keepdims=True)
    result = unit.astype(np.float32)
    result.flags.writeable = False
    return result


def flattened(
    cameras: list[Camera], pictures: list[NDArray[np.float32]], edge: int
) -> NDArray[np.float32]:
    """Put six pictures together.

    Parameters
    ----------
    cameras : list of Camera
    pictures : list of (H, W, 3) float32

    Returns
    -------
    radiance : (edge, edge, 3) float32
    """
    directions = octahedral_directions(edge)
    result = np.zeros((edge, edge, 3), np.float32)
    nearest = np.full((edge, edge), -2.0, np.float32)
    for camera, picture in zip(cameras, pictures, strict=True):
        x, y, z = np.moveaxis(
            directions @ camera.world_from_camera[:3, :3].astype(np.float32), -1, 0
        )
        ahead = np.maximum(z, 1e-3)
        u, v = camera.intrinsics.places_of_rays(x / ahead, y / ahead)
        seen = cv2.remap(picture, u, v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        mine = z > nearest
        result[mine], nearest[mine] = seen[mine], z[mine]
    return result


Blur: TypeAlias = Callable[
    [NDArray[np.float32], NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]], None
]
"""``blur(radiance, directions, lobe, result)``: averages over a lobe about each direction."""


class Glint(NamedTuple):
    """Light from one direction.

    Attributes
    ----------
    towards : (3,) float64
        Unit vector to where it comes from.
    irradiance : (3,) float64
        On a surface that faces it.
    """

    towards: NDArray[np.float64]
    irradiance: NDArray[np.float64]


def prefilter(
    radiance: NDArray[np.float32], *, blur: Blur, glints: Sequence[Glint] = ()
) -> NDArray[np.float16]:
    """Blur a map of all directions as rough surfaces would.

    Parameters
    ----------
    radiance : (N, N, 3) float32
    blur : Blur
        Does it for one roughness.
    glints : sequence of Glint
        What comes besides from directions alone.

    Returns
    -------
    layers : (L, N + 2, N + 2, 4) float16
        One layer for each of `ROUGHNESSES`, with a border that continues it across the edges.

    Notes
    -----
    Importance sampling of the GGX distribution with the viewer along the normal (Karis 2013, "Real
    shading in Unreal Engine 4").
    """
    edge = len(radiance)
    layers = np.zeros((len(ROUGHNESSES), edge + 2, edge + 2, 4), np.float16)
    directions = octahedral_directions(edge)
    for layer, roughness in zip(layers, ROUGHNESSES, strict=True):
        blurred = radiance if roughness == 0.0 else np.empty_like(radiance)
        if roughness > 0.0:
            blur(radiance, directions, _lobe(roughness), blurred)
        for glint in glints:
            blurred = blurred + _blurred_glint(glint, directions, roughness)
        layer[1:-1, 1:-1, :3] = np.minimum(blurred, HALF_MOST)
        # Beyond an edge of the square lies the same edge, mirrored about its middle.
        layer[0, 1:-1], layer[-1, 1:-1] = layer[1, -2:0:-1], layer[-2, -2:0:-1]
        layer[1:-1, 0], layer[1:-1, -1] = layer[-2:0:-1, 1], layer[-2:0:-1, -2]
        layer[0, 0], layer[0, -1] = layer[-2, -2], layer[-2, 1]
        layer[-1, 0], layer[-1, -1] = layer[1, -2], layer[1, 1]
    return layers


def light_from_around(radiance: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the light that arrives on surfaces amidst a map of all directions.

    Parameters
    ----------
    radiance : (N, N, 3) float64

    Returns
    -------
    light : (4,) float64
        c0, cx, cy, cz: irradiance / pi on a surface of normal n is about c0 + c · n; its
        luminance.
    """
    directions = octahedral_directions(len(radiance)).astype(np.float64)
    # A texel's solid angle shrinks with the cube of its distance from the octahedron's middle.
    share = np.abs(directions).sum(axis=-1) ** 3
    weighted = radiance @ LUMINANCE * share / share.sum()
    along = np.einsum("vu,vux->x", weighted, directions)
    return np.array([weighted.sum(), *(2.0 * along)])


def layers_per_roughness() -> float:
    """Return by how many layers a roughness of 1 would lie behind the first."""
    return (len(ROUGHNESSES) - 1) / ROUGHNESSES[-1]


def view_point(probes: ProbeGrid) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return from where a room is looked at for reflections, and its box.

    Returns
    -------
    position_m : (3,) float64
        In the middle of the probes' box, at the height of eyes.
    box : (2, 3) float64
        Lowest and highest corner [m].
    """
    low = np.asarray(probes.origin_m)
    high = low + np.asarray(probes.spacing_m) * (np.array(probes.shape[::-1]) - 1)
    middle = 0.5 * (low + high)
    middle[2] = min(low[2] + EYE_HEIGHT_M, middle[2] + 0.5 * (high[2] - middle[2]))
    return middle, np.stack([low, high])


def _lobe(roughness: float) -> NDArray[np.float32]:
    """Return (S, 4): directions about the z axis, and how much each counts."""
    index = np.arange(SAMPLES)
    turn = 2.0 * np.pi * ((index * 0.6180339887498949) % 1.0)
    share = (index + 0.5) / SAMPLES
    alpha2 = roughness**4
    cosine = np.sqrt((1.0 - share) / (1.0 + (alpha2 - 1.0) * share))
    sine = np.sqrt(1.0 - cosine**2)
    half = np.stack([sine * np.cos(turn), sine * np.sin(turn), cosine], axis=-1)
    light = 2.0 * cosine[:, None] * half - np.array([0.0, 0.0, 1.0])
    weight = np.maximum(light[:, 2], 0.0)
    return np.concatenate([light, weight[:, None]], axis=1).astype(np.float32)


def _blurred_glint(
    glint: Glint, directions: NDArray[np.float32], roughness: float
) -> NDArray[np.float32]:
    """Return (N, N, 3): the mean of `_lobe` over light from one direction, by its formula.

    Texels hold no narrower lobe than that of the second layer.
    """
    roughness = max(roughness, ROUGHNESSES[1])
    alpha2 = roughness**4
    cosine = np.maximum(directions @ glint.towards.astype(np.float32), 0.0)
    # Halfway between the two directions.
    spread = 1.0 - 0.5 * (1.0 + cosine) * (1.0 - alpha2)
    density = alpha2 / (4.0 * np.pi * spread**2)
    share = density * cosine / _lobe(roughness)[:, 3].mean()
    found: NDArray[np.float32] = (share[..., None] * glint.irradiance).astype(np.float32)
    return found
