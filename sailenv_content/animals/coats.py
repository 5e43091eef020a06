"""Fur: the colour of each place on an animal, by its pattern."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_content.animals.anatomy import TAIL_JOINTS, Anatomy
from sailenv_content.animals.shape import EYE, NOSE
from sailenv_ros.types.colour import linear_from_hex

__all__ = ["MARKS", "CoatPainter", "marks_of"]

Doubles = NDArray[np.float64]

MARKS = 3
"""Numbers of a place beside where it is: shares of the head and the limbs, and how far along the
tail it is, 0 where it is not on it."""

_CELLS = 32


def marks_of(anatomy: Anatomy, dense: Doubles) -> Doubles:
    """Return (V, MARKS): `MARKS` of vertices, by (V, J) weights."""
    names = list(anatomy.joints)

    def share(*starts: str) -> Doubles:
        chosen = [n for n, name in enumerate(names) if name.startswith(starts)]
        return np.asarray(dense[:, chosen].sum(axis=1), np.float64)

    tail = sum(
        (k + 0.5) / TAIL_JOINTS * dense[:, names.index(f"tail{k + 1:02d}")]
        for k in range(TAIL_JOINTS)
    )
    limbs = share("forearm", "wrist", "forepaw", "shank", "hock", "hindpaw")
    upper = share("upperarm", "thigh")
    return np.column_stack([share("head"), limbs + 0.45 * upper, tail])


class CoatPainter:
    """Colours of one animal.

    Parameters
    ----------
    anatomy : Anatomy
    """

    def __init__(self, anatomy: Anatomy) -> None:
        self._anatomy, self._look = anatomy, anatomy.look
        coat = anatomy.look.coat
        self._coat = coat
        self._base, self._second, self._under = (
            np.array(linear_from_hex(text)) for text in (coat.base, coat.second, coat.under)
        )
        self._nose = np.array(linear_from_hex(anatomy.look.nose))
        self._lattice = np.random.default_rng(coat.seed).standard_normal((_CELLS,) * 3)

    def at(self, points: Doubles, marks: Doubles) -> Doubles:
        """Return (N, 3) linear colours of (N, 3) places at rest [m] with their `MARKS`."""
        own = points / self._anatomy.unit
        head = (points - self._anatomy["head"]) / self._anatomy.head_m
        is_head = np.clip(2.0 * marks[:, 0] - 0.5, 0.0, 1.0) * (head[:, 0] > -0.1)
        colour = np.tile(self._base, (len(points), 1))
        colour = _over(colour, self._under, self._underside(own, head, is_head, marks))
        colour = _over(colour, self._second, self._pattern(own, head, is_head, marks))
        colour = _over(colour, np.array([0.82, 0.80, 0.76]), self._white(own, head, is_head, marks))
        limb = np.clip(marks[:, 1], 0.0, 1.0)[:, None]
        hair = (1.0 - limb) * own * [14.0, 70.0, 55.0] + limb * own * [70.0, 70.0, 18.0]
        fine = self._noise(hair) + 0.7 * self._noise(2.1 * hair + 5.0)
        broad = self._noise(3.0 * own + 9.0)
        colour = colour * np.clip(1.0 + 0.13 * fine + 0.06 * broad, 0.4, 1.6)[:, None]
        return self._face(colour, head, is_head)

    # -- inside ----------------------------------------------------------------------------

    def _noise(self, places: Doubles) -> Doubles:
        """Return (N,): smooth noise about 0, whose grains are one unit wide."""
        from scipy.ndimage import map_coordinates

        found: Doubles = map_coordinates(
            self._lattice, places.T, order=1, mode="grid-wrap", prefilter=False
        )
        return found

    def _underside(self, own: Doubles, head: Doubles, is_head: Doubles, marks: Doubles) -> Doubles:
        x, y, z = own.T
        low = _step(z, 0.60 + 0.04 * self._noise(4.0 * own), 0.16)
        low *= 1.0 - np.clip(1.8 * marks[:, 1], 0.0, 1.0)
        inner = np.clip(marks[:, 1], 0.0, 1.0) * _step(np.abs(y), 0.11, 0.03) * _step(z, 0.55, 0.2)
        chest = _step(np.abs(y), 0.10, 0.08) * np.clip((x - 0.42) / 0.1, 0.0, 1.0)
        trunk = np.maximum.reduce([low, inner, 0.8 * chest * _step(z, 0.80, 0.15)])
        chin = np.clip((0.02 - head[:, 2]) / 0.12, 0, 1) * np.clip((head[:, 0] - 0.3) / 0.2, 0, 1)
        pads = np.exp(-(((head[:, 0] - 0.90) / 0.13) ** 2)) * (head[:, 2] < 0.05)
        face = np.maximum(chin, pads)
        share = (1.0 - is_head) * trunk + is_head * face
        return np.asarray(self._coat.under_share * share * (marks[:, 2] < 0.05), np.float64)

    def _pattern(self, own: Doubles, head: Doubles, is_head: Doubles, marks: Doubles) -> Doubles:
        pattern = self._coat.pattern
        if pattern == "tabby":
            return self._tabby(own, head, is_head, marks)
        if pattern == "saddle":
            return self._saddle(own, is_head, marks)
        if pattern == "patches":
            return self._patches(own, head, is_head)
        back = _step(-own[:, 2], -0.92, 0.12) * (1.0 - marks[:, 1])
        return np.asarray(0.35 * back * (1.0 - is_head), np.float64)

    def _tabby(self, own: Doubles, head: Doubles, is_head: Doubles, marks: Doubles) -> Doubles:
        x, y, z = own.T
        wobble = self._noise(3.2 * own)
        limb, tail = np.clip(marks[:, 1], 0.0, 1.0), marks[:, 2]
        torso = _bands(x / 0.105 + 0.55 * wobble + 0.9 * (z - 0.8), 0.34)
        torso *= np.clip((z - 0.54) / 0.12, 0.0, 1.0)
        torso *= np.clip(0.85 + 1.0 * self._noise(7.0 * own + 3.0), 0.12, 0.85)
        back = np.exp(-((y / 0.035) ** 4)) * (z > 0.80) * (x < 0.5)
        legs = _bands(z / 0.095 + 0.2 * wobble, 0.22) * np.clip((z - 0.10) / 0.06, 0.0, 1.0)
        legs *= np.clip((np.abs(y) - 0.09) / 0.03, 0.0, 1.0)
        rings = np.maximum(_bands(tail * 7.5, 0.32), tail > 0.86)
        body = (1.0 - limb) * np.maximum(torso, 0.85 * back) + 0.8 * limb * legs
        body = np.where(tail > 0.04, rings, body)
        u, v, w = head.T
        brow = _bands(v / 0.15, 0.30) * np.clip((w - 0.27) / 0.06, 0, 1) * (u < 0.78)
        side = np.clip((np.abs(v) - 0.24) / 0.04, 0, 1) * np.clip((0.66 - u) / 0.08, 0, 1)
        cheek = _bands(w / 0.20 + 0.7 * u + 0.1 * wobble, 0.22) * side * (w < 0.28)
        face = 0.9 * np.maximum(brow, cheek)
        return np.asarray((1.0 - is_head) * body + is_head * face, np.float64)

    def _saddle(self, own: Doubles, is_head: Doubles, marks: Doubles) -> Doubles:
        x, _, z = own.T
        edge = 0.66 + 0.05 * self._noise(5.0 * own) + 0.25 * np.clip(x - 0.28, 0.0, 1.0)
        edge += 0.2 * np.clip(-0.40 - x, 0.0, 1.0)
        back = _step(-z, -edge, 0.04) * (1.0 - np.clip(1.6 * marks[:, 1] - 0.5, 0.0, 1.0))
        back *= _step(x, 0.46 + 0.05 * self._noise(6.0 * own) + 0.25 * (z - 0.9), 0.05)
        tail = (marks[:, 2] > 0.04) * (marks[:, 2] < 0.62)
        return np.asarray((1.0 - is_head) * np.maximum(back, tail), np.float64)

    def _patches(self, own: Doubles, head: Doubles, is_head: Doubles) -> Doubles:
        z = own[:, 2]
        spots = _step(-self._noise(2.3 * own + 7.0), -0.30, 0.12) * (z > 0.5)
        u, v, w = head.T
        mask = np.clip((np.abs(v + 0.02) - 0.055) / 0.03, 0, 1) * _step(u, 0.66, 0.06)
        mask *= np.clip((w + 0.12 + 0.04 * self._noise(6.0 * own)) / 0.05, 0.0, 1.0)
        return np.asarray((1.0 - is_head) * spots + is_head * mask, np.float64)

    def _white(self, own: Doubles, head: Doubles, is_head: Doubles, marks: Doubles) -> Doubles:
        white = self._coat.white
        if not white:
            return np.zeros(len(own))
        x, y, z = own.T
        ragged = 0.04 * self._noise(7.0 * own)
        limb = np.clip(2.0 * marks[:, 1], 0.0, 1.0)
        legs = limb * _step(z + ragged, 0.08 + 0.36 * white, 0.03)
        belly = _step(z + ragged, 0.42 + 0.16 * white, 0.04) * (1.0 - limb)
        front = np.clip((x + 0.5 * ragged - 0.44) / 0.06, 0, 1) * _step(z, 0.72 + 0.3 * white, 0.06)
        chest = front * _step(np.abs(y) + ragged, 0.06 + 0.09 * white, 0.03)
        u, v, w = head.T
        across = 0.02 + 0.05 * white + 0.35 * np.clip(u - 0.62, 0.0, 0.3)
        blaze = _step(np.abs(v) + 0.5 * ragged, across, 0.03) * (u > 0.15)
        muzzle = np.clip((u - 0.60) / 0.06, 0, 1) * _step(w, 0.06, 0.05)
        face = np.maximum(blaze * (white > 0.5), muzzle)
        tip = marks[:, 2] > 0.80
        rest = np.maximum.reduce([legs, belly, chest, tip.astype(float)]) * (
            (marks[:, 2] < 0.04) | tip
        )
        return np.asarray((1.0 - is_head) * rest + is_head * face, np.float64)

    def _face(self, colour: Doubles, head: Doubles, is_head: Doubles) -> Doubles:
        """Return colours with the nose, the mouth and the rims of the eyes."""
        kind, look = self._look.kind, self._look
        (x, y, z), radius, _ = EYE[kind]
        mirrored = head * [1.0, 0.0, 1.0] + np.abs(head) * [0.0, 1.0, 0.0]
        away = np.linalg.norm(mirrored - [x, y, z], axis=1) / radius
        rim = _step(away, 1.22, 0.10)
        halo = 0.5 * np.exp(-(((away - 1.65) / 0.30) ** 2)) * (self._coat.pattern == "tabby")
        colour = _over(colour, self._under, is_head * halo)
        colour = _over(colour, np.array([0.012, 0.010, 0.009]), is_head * 0.92 * rim)
        long = (0.14 if kind == "cat" else 0.5) * (look.muzzle - 1.0)
        u, v, w = (mirrored - [long, 0.0, 0.0]).T
        tip = np.array(NOSE[kind])
        if kind == "cat":
            line = np.exp(-((v / 0.010) ** 2)) * (w < -0.015) * (w > -0.10) * (u > 0.9)
            smile = np.exp(-(((w + 0.095 + 0.6 * (v - 0.07) ** 2 / 0.1) / 0.011) ** 2))
            smile *= (u > 0.80) * (v < 0.15)
            wide = np.clip(0.055 + 0.75 * (w - tip[2]), 0.012, 0.062)
            nose = _step(v, wide, 0.012) * (u > 0.935) * (np.abs(w - tip[2]) < 0.042)
        else:
            line = np.exp(-((v / 0.008) ** 2)) * (w < -0.02) * (w > -0.085) * (u > 0.9)
            smile = np.exp(-(((w + 0.088 + 0.05 * (0.95 - u)) / 0.010) ** 2))
            smile *= (u > 0.56) * (u < 0.99)
            off = np.array([u - 0.972, v, w - 0.030]).T / [0.062, 0.070, 0.056]
            nose = _step(np.linalg.norm(off, axis=1), 1.08, 0.08)
        mouth = np.maximum(line, smile)
        colour = _over(colour, np.array([0.02, 0.012, 0.010]), is_head * 0.8 * mouth)
        return _over(colour, self._nose, is_head * nose)


def _step(value: Doubles | float, edge: Doubles | float, width: float) -> Doubles:
    """Return 1 where a value is below an edge, 0 above it, and what is between on the edge."""
    return np.asarray(np.clip(0.5 + (edge - value) / width, 0.0, 1.0), np.float64)


def _bands(phase: Doubles, share: float) -> Doubles:
    """Return 1 in a share of each whole number of a phase, with soft edges."""
    away = np.abs((phase % 1.0) - 0.5)
    return np.asarray(np.clip(0.5 + (0.5 * share - away) / 0.09, 0.0, 1.0), np.float64)


def _over(colour: Doubles, paint: Doubles, share: Doubles) -> Doubles:
    weight = np.clip(share, 0.0, 1.0)[:, None]
    return np.asarray((1.0 - weight) * colour + weight * paint, np.float64)
