"""What lies on a bed or sits on a couch does not float: what collides is where the surface is."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from sailenv_ros.assets import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.types.model import Asset, ConvexShape

SEATS = (
    *("bed_01", "bed_02", "couch_01", "couch_02", "couch_03", "couch_04"),
    *("armchair_01", "armchair_02", "armchair_03", "chair_05", "chair_07", "cabinet_03"),
)
LINES = 40
"""Vertical lines along each side."""

FLAT = 0.95
"""Vertical part of a normal from which a surface carries things."""


def drawn(asset: Asset) -> trimesh.Trimesh:
    """Return what is seen of an asset."""
    return trimesh.util.concatenate(
        [
            trimesh.Trimesh(part.mesh.positions, part.mesh.triangles, process=False)
            for part in asset.model.parts
        ]
    )


def colliding(asset: Asset) -> trimesh.Trimesh:
    """Return what is felt of an asset."""
    hulls = [shape for shape in asset.collision if isinstance(shape, ConvexShape)]
    return trimesh.util.concatenate([trimesh.convex.convex_hull(hull.points) for hull in hulls])


def tops(
    mesh: trimesh.Trimesh, lines: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return where lines from above first meet a mesh, NaN if nowhere, and normals' z there."""
    down = np.tile([0.0, 0.0, -1.0], (len(lines), 1))
    places, line, triangle = mesh.ray.intersects_location(lines, down, multiple_hits=False)
    heights, slopes = np.full(len(lines), np.nan), np.zeros(len(lines))
    heights[line] = places[:, 2]
    slopes[line] = np.abs(mesh.face_normals[triangle][:, 2])
    return heights, slopes


@pytest.mark.parametrize("name", SEATS)
def test_a_seat_is_felt_where_it_is_seen(name: str) -> None:
    """On the median line within 6 mm, and nine of ten are felt at most 40 mm too high."""
    asset = AssetLibrary(installed_sources()).get(name)
    seen = drawn(asset)
    low, high = seen.bounds
    sides = [np.linspace(low[axis], high[axis], LINES + 2)[1:-1] for axis in (0, 1)]
    lines = np.stack([*np.meshgrid(*sides), np.full((LINES, LINES), high[2] + 1.0)], -1)
    lines = lines.reshape(-1, 3)
    heights, slopes = tops(seen, lines)
    felt, _ = tops(colliding(asset), lines)
    carries = (slopes > FLAT) & (heights > 0.25 * high[2]) & np.isfinite(felt)
    gap = (felt - heights)[carries]
    assert len(gap) > 50
    assert abs(np.median(gap)) < 0.006
    assert np.percentile(gap, 90) < 0.04
