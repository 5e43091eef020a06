"""Patterns of rugs: medallions in borders, rows of diamonds, stripes, rings, shapes, checks.

A size and colours in, a `Texture` out whose rows run along the shorter side of the rug.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.types.model import Texture

__all__ = ["PATTERNS", "Loom", "woven"]

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]

PX_PER_M = 220.0


@dataclass(frozen=True, eq=False, slots=True)
class Loom:
    """A rug that is being woven.

    Attributes
    ----------
    rng : numpy.random.Generator
    size_m : (2,) tuple of float
        Its shorter and its longer side [m].
    colours : (4, 3) float64
        sRGB, 0 to 1: ground, second, light, dark.
    """

    rng: np.random.Generator
    size_m: tuple[float, float]
    colours: Floats

    def grid(self) -> tuple[Floats, Floats]:
        """Return x (rows, 1) and y (1, columns) from one corner [m]."""
        rows, columns = (max(2, round(PX_PER_M * side)) for side in self.size_m)
        x = (np.arange(rows) + 0.5) / rows * self.size_m[0]
        y = (np.arange(columns) + 0.5) / columns * self.size_m[1]
        return x[:, None], y[None, :]

    def ground(self, colour: int = 0) -> Floats:
        """Return a picture (rows, columns, 3) of one colour."""
        x, y = self.grid()
        picture = np.empty((len(x), y.shape[1], 3))
        picture[:] = self.colours[colour]
        return picture

    def edge(self) -> Floats:
        """Return how far each place is from the nearest edge [m]."""
        x, y = self.grid()
        d, w = self.size_m
        return np.minimum(np.minimum(x, d - x), np.minimum(y, w - y))


def woven(loom: Loom, pattern: str, rough: float = 0.09) -> Texture:
    """Return a pattern in wool, whose threads differ in shade by a share `rough`."""
    picture = PATTERNS[pattern](loom)
    shape = picture.shape[:2]
    threads = cv2.GaussianBlur(loom.rng.standard_normal(shape), (0, 0), 0.8)
    # One dye bath is not quite like the next: bands across.
    bands = cv2.GaussianBlur(loom.rng.standard_normal(shape), (0, 0), sigmaX=30.0, sigmaY=2.0)
    shade = 1.0 + rough * threads / threads.std() + 0.4 * rough * bands / bands.std()
    pixels = np.full((*shape, 4), 255, np.uint8)
    pixels[..., :3] = np.rint(255.0 * np.clip(picture * shade[..., None], 0.0, 1.0))
    pixels.flags.writeable = False
    return pixels


def _oriental(loom: Loom) -> Floats:
    """Set a medallion on a field of flowers, within three borders."""
    ground, second, light, dark = loom.colours
    picture, edge = loom.ground(), loom.edge()
    x, y = loom.grid()
    d, w = loom.size_m
    dx, dy = np.abs(x - d / 2), np.abs(y - w / 2)
    step = float(loom.rng.uniform(0.12, 0.17))
    petals = int(loom.rng.integers(4, 9))
    cy = np.mod(dy, step) - step / 2
    cx = np.mod(dx + step / 2 * (dy // step), step) - step / 2
    radius, angle = np.hypot(cx, cy), np.arctan2(cx, cy)
    flower = radius < 0.19 * step * (1.0 + 0.4 * np.cos(petals * angle))
    picture[flower] = light
    picture[radius < 0.07 * step] = second
    lobes = int(loom.rng.choice([4, 6, 8, 12]))
    far = np.hypot(dx / (0.33 * d), dy / (0.31 * w))
    far = far * (1.0 - 0.1 * np.cos(lobes * np.arctan2(dx / d, dy / w)))
    for limit, colour in ((1.0, dark), (0.96, second), (0.6, light), (0.55, ground), (0.24, dark)):
        picture[far < limit] = colour
    picture[(far > 0.66) & (far < 0.9) & flower] = light
    wide = float(loom.rng.uniform(0.13, 0.2))
    _borders(loom, picture, edge, wide)
    return picture


def _borders(loom: Loom, picture: Floats, edge: Floats, wide: float) -> None:
    """Draw a border with a wave and blossoms between two thin ones."""
    ground, second, light, dark = loom.colours
    x, y = loom.grid()
    d, w = loom.size_m
    along = np.where(np.minimum(x, d - x) < np.minimum(y, w - y), y, x)
    picture[edge < wide + 0.06] = light
    picture[edge < wide + 0.045] = second
    middle, every = 0.05 + wide / 2, 1.1 * wide
    wave = np.abs(edge - middle - 0.28 * wide * np.sin(2 * np.pi * along / every))
    inside = (edge > 0.05) & (edge < wide + 0.045)
    picture[inside & (wave < 0.012)] = light
    blossom = np.hypot(np.mod(along, every / 2) - every / 4, edge - middle)
    picture[inside & (blossom < 0.14 * wide)] = ground
    picture[edge < 0.05] = dark
    picture[(edge < 0.05) & (edge > 0.02) & (np.mod(along, 0.05) < 0.02)] = light


def _kilim(loom: Loom) -> Floats:
    """Weave bands across: diamonds, zigzags, teeth and plain ones between."""
    picture = loom.ground()
    x, y = loom.grid()
    d, w = loom.size_m
    count = 2 * int(loom.rng.integers(4, 8)) + 1
    half = [
        (str(loom.rng.choice(["diamonds", "zigzag", "teeth", "plain"])), loom.rng.permutation(4))
        for _ in range(count // 2 + 1)
    ]
    kinds = [*half, *half[-2::-1]]
    tall = w / count
    repeats = max(2, round(d / float(loom.rng.uniform(0.16, 0.3))))
    across = np.mod(x / d * repeats, 1.0)
    for number, (kind, order) in enumerate(kinds):
        mine = (y >= number * tall) & (y < (number + 1) * tall)
        up = (y - number * tall) / tall
        peak = 1.0 - 2.0 * np.abs(across - 0.5)
        low, high, line, _ = loom.colours[order]
        if kind == "diamonds":
            reach = np.abs(across - 0.5) + np.abs(up - 0.5)
            layers: list[tuple[Flags, Floats]] = [
                (reach < 9.0, low), (reach < 0.48, high), (reach < 0.3, line), (reach < 0.15, low)
            ]  # fmt: skip
        elif kind == "zigzag":
            shift = np.mod(2.0 * up - peak, 1.0)
            layers = [(shift < 9.0, low), (shift < 0.5, high)]
        elif kind == "teeth":
            layers = [(peak < 9.0, low), (up < peak, high)]
        else:
            layers = [(across < 9.0, low), ((np.abs(up - 0.5) < 0.2) & (across < 9.0), high)]
        for where, colour in layers:
            picture[where & mine] = colour
        picture[((up < 0.06) & mine) | np.zeros_like(x, bool)] = loom.colours[3]
    return picture


def _striped(loom: Loom) -> Floats:
    """Weave stripes of uneven width across."""
    picture = loom.ground()
    _, y = loom.grid()
    edges = np.sort(loom.rng.uniform(0.02, 0.98, int(loom.rng.integers(6, 26))))
    stripe = np.searchsorted(edges, y[0] / loom.size_m[1])
    order = loom.rng.permutation(4)
    picture[:] = loom.colours[order[stripe % int(loom.rng.integers(2, 5))]][None]
    return picture


def _berber(loom: Loom) -> Floats:
    """Draw dark lozenges, none quite straight, on light wool."""
    picture = loom.ground(2)
    x, y = loom.grid()
    step_x, step_y = loom.rng.uniform(0.3, 0.55, 2).tolist()
    phase = loom.rng.uniform(0.0, 6.3, 2).tolist()
    a = x / step_x + 0.06 * np.sin(3.1 * y + phase[0])
    b = y / step_y + 0.06 * np.sin(3.7 * x + phase[1])
    for value in (a + b, a - b):
        line = np.abs(np.mod(value, 1.0) - 0.5)
        picture[line < 0.016 / min(step_x, step_y)] = loom.colours[3]
    if loom.rng.uniform() < 0.5:
        reach = np.abs(np.mod(a + b, 1.0) - 0.5) + np.abs(np.mod(a - b, 1.0) - 0.5)
        picture[reach > 0.86] = loom.colours[0]
    return picture


def _rings(loom: Loom) -> Floats:
    """Coil a braid from the middle, some of its rounds dyed."""
    picture = loom.ground(2)
    x, y = loom.grid()
    far = np.hypot(x - loom.size_m[0] / 2, y - loom.size_m[1] / 2)
    braid = 0.022
    turn = np.arctan2(x - loom.size_m[0] / 2, y - loom.size_m[1] / 2) / (2 * np.pi)
    round_ = np.floor(far / braid + turn).astype(int)
    dyed = loom.rng.choice([2, 2, 2, 0, 1], size=int(round_.max()) + 3)
    picture[:] = loom.colours[dyed[np.clip(round_, 0, None) // 2]]
    inside = np.mod(far / braid + turn, 1.0)
    strands = np.mod(far * turn * 2 * np.pi / 0.03 + inside, 1.0)
    picture *= (0.72 + 0.28 * np.sin(np.pi * inside) * (0.75 + 0.25 * strands))[..., None]
    return picture


def _shapes(loom: Loom) -> Floats:
    """Lay broad shapes with soft outlines over one another."""
    picture = loom.ground(int(loom.rng.integers(0, 3)))
    rows, columns = picture.shape[:2]
    for colour in loom.rng.permutation(4):
        coarse = loom.rng.standard_normal((4, 5))
        field = cv2.resize(coarse, (columns, rows), interpolation=cv2.INTER_CUBIC)
        limit = np.quantile(field, float(loom.rng.uniform(0.62, 0.82)))
        picture[field > limit] = loom.colours[colour]
        if loom.rng.uniform() < 0.4:
            picture[np.abs(field - limit) < 0.03] = loom.colours[3]
    return picture


def _checks(loom: Loom) -> Floats:
    """Weave squares of two colours within a border."""
    picture, edge = loom.ground(2), loom.edge()
    x, y = loom.grid()
    d, w = loom.size_m
    side = d / int(loom.rng.integers(5, 10))
    odd = (np.floor((x - d / 2) / side) + np.floor((y - w / 2) / side)) % 2 == 1
    picture[odd] = loom.colours[0]
    picture[edge < 0.06] = loom.colours[1]
    return picture


def _bordered(loom: Loom) -> Floats:
    """Weave one plain field within lines and a plain border."""
    picture, edge = loom.ground(), loom.edge()
    wide = float(loom.rng.uniform(0.05, 0.16)) * min(1.0, loom.size_m[0])
    picture[edge < wide] = loom.colours[int(loom.rng.integers(1, 4))]
    if loom.rng.uniform() < 0.5:
        picture[(edge > 1.3 * wide) & (edge < 1.5 * wide)] = loom.colours[1]
    return picture


def _ribbed(loom: Loom) -> Floats:
    """Tuft ribs along, within a flat hem."""
    picture, edge = loom.ground(), loom.edge()
    x, _ = loom.grid()
    rib = 0.82 + 0.18 * np.abs(np.sin(np.pi * x / 0.028))
    picture *= np.where(edge > 0.05, rib, 0.94)[..., None]
    picture[(edge > 0.05) & (edge < 0.062)] *= 0.7
    return picture


PATTERNS: dict[str, Callable[[Loom], Floats]] = {
    "oriental": _oriental,
    "kilim": _kilim,
    "striped": _striped,
    "berber": _berber,
    "rings": _rings,
    "shapes": _shapes,
    "checks": _checks,
    "bordered": _bordered,
    "ribbed": _ribbed,
}
"""Each draws a picture (rows, columns, 3), sRGB from 0 to 1."""
