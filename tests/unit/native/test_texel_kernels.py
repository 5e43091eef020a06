"""The kernels of a light map's texels, against the same arithmetic in plain Python."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.native.bake_types import TexelMap
from sailenv_ros.native.texel_kernels import (
    bordered_blocks,
    cover_texels,
    denoise_texels,
    dilate_texels,
    nearest_triangles,
    texel_stand_ins,
)

SIDE = 12


class Sheet:
    """A map of which nine tenths are used: two owners, faces that look up but for a strip."""

    def __init__(self, seed: int = 0) -> None:
        rng = np.random.default_rng(seed)
        self.rows, self.columns = (
            a.astype(np.int32) for a in np.nonzero(rng.random((SIDE,) * 2) < 0.9)
        )
        self.count = len(self.rows)
        self.index = np.full((SIDE, SIDE), -1, np.int32)
        self.index[self.rows, self.columns] = np.arange(self.count)
        self.owners = (self.columns > 7).astype(np.int32)
        self.faces = np.where(self.rows[:, None] > 8, (1.0, 0.0, 0.0), (0.0, 0.0, 1.0))
        self.faces = self.faces.astype(np.float32)
        places = np.stack([self.columns, self.rows, np.zeros(self.count)], axis=1)
        self.positions = (0.03 * places + rng.normal(0.0, 1e-3, places.shape)).astype(np.float32)
        self.valid = rng.random(self.count) < 0.7
        self.values = rng.random((self.count, 17)).astype(np.float32)
        self.nearness = rng.uniform(0.02, 1.0, self.count).astype(np.float32)
        self.map = TexelMap(
            self.index, self.rows, self.columns, self.owners, self.positions, self.faces, self.faces
        )

    def around(self, k: int, reach: int) -> list[tuple[int, int, int]]:
        """Texels up to so many rows and columns away: number, down, right."""
        found = []
        for down in range(-reach, reach + 1):
            for right in range(-reach, reach + 1):
                row, column = self.rows[k] + down, self.columns[k] + right
                if 0 <= row < SIDE and 0 <= column < SIDE and self.index[row, column] >= 0:
                    found.append((int(self.index[row, column]), down, right))
        return found

    def neighbours(self, k: int) -> list[int]:
        """Texels beside one that belong to its surface."""
        return [
            n
            for n, _, _ in self.around(k, 1)
            if self.owners[n] == self.owners[k] and self.faces[n] @ self.faces[k] > 0.5
        ]


def averaged(sheet: Sheet, k: int) -> NDArray[np.float64]:
    """What a texel gets by two averages over tiles of 4 by 4."""
    total, weights = np.zeros(sheet.values.shape[1]), 0.0
    for n, down, right in sheet.around(k, 3):
        if not sheet.valid[n] or sheet.owners[n] != sheet.owners[k]:
            continue
        step = sheet.positions[n].astype(float) - sheet.positions[k]
        alike, off = sheet.faces[n] @ sheet.faces[k], step @ sheet.faces[k]
        far2 = step @ step
        if alike < 0.8 or far2 > 0.04 or off * off > 0.1 * far2 + 1e-8:
            continue
        weight = (4 - abs(down)) * (4 - abs(right)) * alike
        close = 0.25 * float(min(sheet.nearness[k], sheet.nearness[n]))
        weight *= math.exp(-far2 / max(close**2, 1e-7))
        weights += weight
        total += weight * sheet.values[n]
    return total / weights


@pytest.mark.parametrize("threads", [1, 3])
def test_denoising_averages_over_tiles_as_far_as_the_surface_goes_on(threads: int) -> None:
    """Valid texels alone are averaged, and written."""
    sheet = Sheet()
    got = denoise_texels(sheet.map, sheet.values, sheet.valid, sheet.nearness, threads=threads)
    np.testing.assert_array_equal(got[~sheet.valid], sheet.values[~sheet.valid])
    chosen = np.flatnonzero(sheet.valid)
    expected = np.array([averaged(sheet, int(k)) for k in chosen])
    np.testing.assert_allclose(got[chosen], expected, rtol=1e-5)


def test_what_lies_in_a_gap_keeps_its_shadow_to_itself() -> None:
    """A wall that sees the room takes no darkness from its part behind a picture."""
    sheet = Sheet()
    sheet.valid[:] = True
    behind = sheet.columns < 4
    sheet.owners[:] = 0
    sheet.nearness[:] = np.where(behind, 0.02, 2.0)
    sheet.values[:] = np.where(behind, 0.0, 1.0)[:, None]
    got = denoise_texels(sheet.map, sheet.values, sheet.valid, sheet.nearness, threads=1)
    np.testing.assert_allclose(got, sheet.values, atol=1e-3)


def test_dilation_gives_unknown_texels_the_mean_of_known_neighbours() -> None:
    """Step by step; those that no step reaches keep what they have."""
    sheet = Sheet()
    sheet.valid &= sheet.columns < 3
    values, known = sheet.values.astype(float), sheet.valid.copy()
    for _ in range(4):
        before = known.copy()
        for k in np.flatnonzero(~before):
            near = [n for n in sheet.neighbours(int(k)) if before[n]]
            if near:
                values[k], known[k] = values[near].mean(axis=0), True
    got = dilate_texels(sheet.map, sheet.values, sheet.valid, 4)
    assert known.sum() > sheet.valid.sum()
    assert not known.all()
    np.testing.assert_allclose(got, values, rtol=1e-5)


def test_the_nearest_valid_texel_stands_for_others() -> None:
    """By distance in the world, among neighbours of the same surface; itself if there is none."""
    sheet = Sheet()
    got = texel_stand_ins(sheet.map, sheet.valid, 1)
    np.testing.assert_array_equal(got[sheet.valid], np.flatnonzero(sheet.valid))
    for k in np.flatnonzero(~sheet.valid):
        near = [n for n in sheet.neighbours(int(k)) if sheet.valid[n]]
        far = np.linalg.norm(sheet.positions[near].astype(float) - sheet.positions[k], axis=1)
        assert got[k] == (near[int(far.argmin())] if near else k)


def test_blocks_go_on_where_the_surface_does() -> None:
    """Else a border repeats the block's own edge."""
    sheet = Sheet()
    shares = np.random.default_rng(1).random((sheet.count, 4, 4)).astype(np.float32)
    got = bordered_blocks(sheet.map, shares)
    np.testing.assert_array_equal(got[:, 1:5, 1:5], shares)
    for k in range(sheet.count):
        own = np.pad(shares[k], 1, mode="edge")
        near = sheet.neighbours(k)
        for n, down, right in sheet.around(k, 1):
            if n == k or n not in near:
                continue
            rows = {-1: [0], 0: [1, 2, 3, 4], 1: [5]}[down]
            columns = {-1: [0], 0: [1, 2, 3, 4], 1: [5]}[right]
            at = np.ix_([(row - 1) % 4 for row in rows], [(c - 1) % 4 for c in columns])
            own[np.ix_(rows, columns)] = shares[n][at]
        np.testing.assert_array_equal(got[k], own)


def nearest_point(
    corners: NDArray[np.float64], point: NDArray[np.float64]
) -> tuple[float, NDArray[np.float64]]:
    """The distance of a point from a triangle, and the weights of its corners there."""
    sides = np.stack([corners[1] - corners[0], corners[2] - corners[0]], axis=1)
    b, c = np.linalg.solve(sides, point - corners[0])
    if b >= 0 and c >= 0 and b + c <= 1:
        return 0.0, np.array([1 - b - c, b, c])
    found = []
    for k in range(3):
        side = corners[(k + 1) % 3] - corners[k]
        t = float(np.clip((point - corners[k]) @ side / (side @ side), 0.0, 1.0))
        weights = np.zeros(3)
        weights[k], weights[(k + 1) % 3] = 1.0 - t, t
        found.append((float(np.linalg.norm(point - corners[k] - t * side)), weights))
    return min(found, key=lambda one: one[0])


def strip(left: float, right: float) -> list[list[tuple[float, float]]]:
    """Return the two triangles of a rectangle from row 4 to row 20."""
    a, b, c, d = (left, 4.0), (right, 4.0), (right, 20.0), (left, 20.0)
    return [[a, b, c], [a, c, d]]


@pytest.mark.parametrize(("width", "kept"), [(0.05, False), (0.9, True)])
def test_a_texel_stands_for_no_sliver_at_the_edge_of_a_wide_triangle(
    width: float, kept: bool
) -> None:
    """A bevel of a twentieth of a texel is dropped, a strip as wide as a texel is not."""
    places = np.array(strip(3.2, 14.3) + strip(14.3, 14.3 + width), np.float32)
    owner, weights = cover_texels(places, 24, 1.5)
    rows = owner[5:19]
    assert set(rows[:, 4:13].ravel()) <= {0, 1}
    if kept:
        assert set(rows[:, 14]) <= {2, 3}
    else:
        # Centres 14.5 and 15.5: the sliver is nearer to both; look-ups meet the first alone.
        assert set(rows[:, 14]) <= {0, 1}
        at = np.einsum("rc,rcx->rx", weights[5:19, 14], places[rows[:, 14]])
        np.testing.assert_allclose(at[:, 0], 14.3, atol=1e-4)
        assert set(rows[:, 15]) <= {2, 3}


def test_texels_have_the_nearest_triangle_within_reach() -> None:
    """At its centre for the map, at 4 by 4 points for blocks, among the texels around."""
    rng = np.random.default_rng(3)
    places = rng.uniform(-1.0, SIDE + 1.0, (8, 1, 2)) + rng.normal(0.0, 2.0, (8, 3, 2))
    places = places.astype(np.float32)
    owner, weights = cover_texels(places, SIDE, 1.5)
    assert 0 < (owner >= 0).sum() < SIDE * SIDE
    for row, column in np.ndindex(SIDE, SIDE):
        point = np.array([column + 0.5, row + 0.5])
        far, share = zip(*(nearest_point(t.astype(float), point) for t in places), strict=True)
        best = int(np.argmin(far))
        assert owner[row, column] == (best if far[best] < 1.5 else -1)
        if owner[row, column] >= 0:
            np.testing.assert_allclose(weights[row, column], share[best], atol=1e-4)
    sheet = Sheet()
    triangles = rng.integers(0, 8, sheet.count).astype(np.int32)
    chosen = np.arange(0, sheet.count, 7)
    got, _ = nearest_triangles(sheet.map, triangles, places, chosen)
    for place, k in enumerate(chosen):
        around = sorted({int(triangles[n]) for n, _, _ in sheet.around(int(k), 1)})
        for number in range(16):
            x = sheet.columns[k] + (number % 4 + 0.5) / 4
            y = sheet.rows[k] + (number // 4 + 0.5) / 4
            far = [nearest_point(places[t].astype(float), np.array([x, y]))[0] for t in around]
            mine = far[around.index(int(got[16 * place + number]))]
            assert mine == pytest.approx(min(far), abs=1e-5)
