"""Skin, lips, brows and eyes as pictures, painted by where their texels are on the neutral body."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from sailenv_content.people.landmarks import Landmarks
from sailenv_content.people.makehuman import BodyData
from sailenv_ros.native.texel_kernels import cover_texels
from sailenv_ros.types.colour import srgb_from_linear

__all__ = ["HEAD_WINDOW", "WHOLE", "SkinLook", "eye_picture", "eye_uvs", "skin_picture"]

Doubles = NDArray[np.float64]
Texture = NDArray[np.uint8]
Colour = tuple[float, float, float]
Window = tuple[float, float, float, float]

WHOLE: Window = (0.0, 0.0, 1.0, 1.0)
HEAD_WINDOW: Window = (0.632, 0.146, 1.0, 0.824)
"""Places in the layout of texture coordinates: left, lower, right, upper."""

_REACH_TEXELS = 6.0


class SkinLook:
    """Colours of a person's skin and hair, all linear.

    Parameters
    ----------
    skin, lips, hair : (3,) tuple of float
    brows : float
        0 to 1: how thick they are.
    stubble : float
        0 to 1.
    age_years : float
    seed : int
    """

    def __init__(
        self,
        *,
        skin: Colour,
        lips: Colour,
        hair: Colour,
        brows: float,
        stubble: float,
        age_years: float,
        seed: int,
    ) -> None:
        self.skin, self.lips, self.hair = (np.array(c) for c in (skin, lips, hair))
        self.brows, self.stubble = brows, stubble
        self.age_years, self.seed = age_years, seed


def skin_picture(data: BodyData, look: SkinLook, window: Window, side: int) -> Texture:
    """Return (side, side, 4) of a window of the skin; scalps and brows have the hair's colour."""
    places, there, scalp = _texels(data, window, side)
    x, y, z = places.T
    rng = np.random.default_rng(look.seed)
    flecks = _flecks(rng, side)[there]
    broad = _flecks(rng, max(side // 16, 8), side)[there]
    colour = look.skin * (1.0 + 0.05 * flecks + 0.06 * broad)[:, None]
    side_m = np.abs(y)
    # Cheeks, nose, ears, knees and knuckles carry more blood.
    red = 0.16 * _spot(x - 0.115, side_m - 0.045, z - 0.695, 0.022)
    red += 0.14 * _spot(x - 0.155, side_m, z - 0.695, 0.014)
    red += 0.18 * _spot(x - 0.03, side_m - 0.085, z - 0.72, 0.025)
    colour *= 1.0 + red[:, None] * np.array([0.35, -0.55, -0.5])
    # Light does not reach into the corners of eyes and under the chin.
    dark = 0.22 * _spot(x - 0.12, side_m - 0.020, z - 0.728, 0.012)
    dark += 0.10 * _spot(x - 0.125, side_m - 0.031, z - 0.714, 0.014) * (look.age_years > 35)
    colour *= (1.0 - dark)[:, None]
    if look.age_years > 45:
        lines = np.sin(z * 950.0 + 6.0 * np.sin(y * 90.0)) ** 8
        strength = min((look.age_years - 45.0) / 40.0, 1.0) * 0.10
        forehead = _spot(x - 0.12, 0.0 * y, z - 0.775, 0.03)
        colour *= (1.0 - strength * lines * forehead)[:, None]
    colour = _over(colour, look.lips, 0.85 * _mask(data, "lips", window, side)[there])
    nails = _mask(data, "fingernails", window, side)[there]
    colour = _over(colour, look.skin * 0.6 + 0.38, 0.5 * nails)
    if look.stubble > 0.0:
        jaw = np.clip((0.690 - z) / 0.03, 0.0, 1.0) * np.clip((x - 0.03) / 0.05, 0.0, 1.0)
        jaw *= (z > 0.60) & (side_m < 0.08)
        grain = np.clip(0.55 + 0.45 * flecks, 0.0, 1.0)
        colour = _over(colour, look.hair * 0.8 + 0.02, look.stubble * jaw * grain * 0.6)
    colour = _over(colour, look.hair, _brow(x, side_m, z, flecks) * look.brows)
    line = _spot(x - 0.135, side_m - 0.031, (z - 0.7335) * 4.0, 0.017)
    colour = _over(colour, np.array([0.02, 0.015, 0.012]), 0.55 * line * (z > 0.7325))
    grown = np.clip(-scalp / 0.012 + 0.35 * flecks, 0.0, 1.0)
    colour = _over(colour, look.hair * 0.7, 0.92 * grown)
    return _picture(colour, there, look.skin)


def eye_uvs(positions: Doubles) -> Doubles:
    """Return (N, 2): places of an eyeball's points in its picture, forward in the middle."""
    centre = 0.5 * (positions.min(axis=0) + positions.max(axis=0))
    towards = positions - centre
    towards /= np.maximum(np.linalg.norm(towards, axis=1, keepdims=True), 1e-9)
    away = np.maximum(1.0 + towards[:, 0], 0.2)
    return np.asarray(0.5 + 0.5 * towards[:, 1:] / away[:, None], np.float64)


def eye_picture(iris: Colour, side: int = 128) -> Texture:
    """Return (side, side, 4) of an eye, as `eye_uvs` has its points."""
    rows, columns = (np.mgrid[:side, :side] + 0.5) / side * 2.0 - 1.0
    across = np.hypot(rows, columns).reshape(-1)
    angle = np.degrees(2.0 * np.arctan(across))
    spokes = 1.0 + 0.15 * np.sin(17.0 * np.arctan2(rows, columns)).reshape(-1)
    white = np.array([0.72, 0.68, 0.65])
    colour = np.broadcast_to(white, (side * side, 3)).copy()
    colour = _over(colour, np.array([0.5, 0.25, 0.22]), 0.25 * np.clip((angle - 40) / 40, 0, 1))
    colour = _over(colour, np.array(iris) * spokes[:, None], np.clip((31.0 - angle) / 2.0, 0, 1))
    rim = np.exp(-(((angle - 30.0) / 2.2) ** 2))
    colour *= (1.0 - 0.7 * rim)[:, None]
    colour = _over(colour, np.array([0.004, 0.004, 0.005]), np.clip((14.0 - angle) / 1.5, 0, 1))
    return _picture(colour, np.ones((side, side), bool), white)


def _brow(x: Doubles, side_m: Doubles, z: Doubles, flecks: Doubles) -> Doubles:
    along = (side_m - 0.011) / 0.042
    middle = 0.7475 + 0.0065 * np.sin(np.clip(along, 0.0, 1.0) * 2.4) - 0.002 * along
    thick = 0.0042 * (1.0 - 0.55 * np.clip(along, 0.0, 1.0))
    inside = np.clip(1.6 - np.abs(z - middle) / thick, 0.0, 1.0)
    ends = np.clip(along / 0.12, 0.0, 1.0) * np.clip((1.0 - along) / 0.2, 0.0, 1.0)
    return inside * ends * (x > 0.08) * np.clip(0.75 + 0.4 * flecks, 0.0, 1.0)


def _spot(x: Doubles, y: Doubles, z: Doubles, radius: float) -> Doubles:
    found: Doubles = np.exp(-(x * x + y * y + z * z) / (2.0 * radius * radius))
    return found


def _over(colour: Doubles, paint: Doubles, share: Doubles) -> Doubles:
    weight = np.clip(share, 0.0, 1.0)[:, None]
    mixed: Doubles = (1.0 - weight) * colour + weight * paint
    return mixed


def _flecks(rng: np.random.Generator, side: int, wanted: int | None = None) -> Doubles:
    noise = rng.standard_normal((side, side)).astype(np.float32)
    if wanted is not None:
        large = Image.fromarray(noise).resize((wanted, wanted), Image.Resampling.BICUBIC)
        return np.asarray(large, np.float64)
    return noise.astype(np.float64)


def _picture(colour: Doubles, there: NDArray[np.bool_], otherwise: Doubles) -> Texture:
    side = len(there)
    picture = np.empty((side, side, 3))
    picture[:] = otherwise
    picture[there] = colour
    result = np.full((side, side, 4), 255, np.uint8)
    srgb = srgb_from_linear(np.clip(picture, 0.0, 1.0))
    result[..., :3] = np.round(255.0 * np.asarray(srgb)).astype(np.uint8)
    return result


@lru_cache(maxsize=4)
def _texels(
    data: BodyData, window: Window, side: int
) -> tuple[Doubles, NDArray[np.bool_], Doubles]:
    group = data.groups["body"]
    scalp = np.concatenate([data.base, Landmarks(data).scalp_m[:, None]], axis=1)
    found, there = _positions(data, group.triangles, group.uv_triangles, window, side, scalp)
    return found[:, :3], there, found[:, 3]


def _positions(
    data: BodyData,
    triangles: NDArray[np.int64],
    uv_triangles: NDArray[np.int64],
    window: Window,
    side: int,
    values: Doubles | None = None,
) -> tuple[Doubles, NDArray[np.bool_]]:
    """Return what vertices have at each texel that a triangle is near, and where those are."""
    left, low, right, high = window
    uvs = (data.uvs[uv_triangles] - [left, low]) / [right - left, high - low]
    within = ((uvs > -0.05) & (uvs < 1.05)).all(axis=(1, 2))
    places = np.stack([uvs[..., 0], 1.0 - uvs[..., 1]], axis=-1)[within] * side
    owner, weights = cover_texels(np.ascontiguousarray(places, np.float32), side, _REACH_TEXELS)
    there = owner >= 0
    corners = triangles[within][owner[there]]
    table = data.base if values is None else values
    return np.einsum("nk,nkj->nj", weights[there].astype(np.float64), table[corners]), there


@lru_cache(maxsize=8)
def _mask(data: BodyData, name: str, window: Window, side: int) -> Doubles:
    with Image.open(data.mask(name)) as picture:
        width, height = picture.size
        left, low, right, high = window
        box = (left * width, (1.0 - high) * height, right * width, (1.0 - low) * height)
        small = picture.convert("L").resize((side, side), Image.Resampling.BILINEAR, box=box)
    return np.asarray(small, np.float64) / 255.0
