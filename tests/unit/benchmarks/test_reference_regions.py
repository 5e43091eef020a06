"""Of what each pixel of the comparison with the path tracer is told to show."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.reference.regions import REGIONS, regions_of


def views_of_a_wall() -> dict[str, NDArray[Any]]:
    """Return the views of an even wall, seen straight from 2 m, 40 px wide and 20 px high."""
    normals = np.zeros((20, 40, 3), np.float32)
    normals[..., 2] = -1.0
    return {
        "depth": np.full((20, 40), 2.0, np.float32),
        "instance": np.full((20, 40), 7, np.uint16),
        "normals": normals,
        "albedo": np.full((20, 40, 3), 0.5, np.float32),
    }


def columns_of(views: dict[str, NDArray[Any]], name: str) -> set[int]:
    """Return the columns in which every pixel is of one region."""
    found = regions_of(views) == REGIONS.index(name)
    assert (found == found[:1]).all()
    return set(np.nonzero(found[0])[0].tolist())


def test_an_even_wall_is_smooth() -> None:
    """Nothing else is there."""
    assert columns_of(views_of_a_wall(), "smooth") == set(range(40))


def test_surfaces_meet_two_pixels_wide() -> None:
    """Two objects, a fold and a step make edges of the pixels around them."""
    for view, value in (("instance", 8), ("normals", (1.0, 0.0, 0.0)), ("depth", 3.0)):
        views = views_of_a_wall()
        views[view][:, 20:] = value
        assert columns_of(views, "edges") == set(range(17, 23)), view


def test_a_slanted_plane_has_no_edges() -> None:
    """Over a plane 1 / depth is linear."""
    views = views_of_a_wall()
    views["depth"] = np.broadcast_to(1.0 / np.linspace(0.2, 0.8, 40), (20, 40)).astype(np.float32)
    assert columns_of(views, "edges") == set()


def test_stripes_are_a_texture_and_a_hole_is_outside() -> None:
    """A varied base colour is told from what lies behind the wall."""
    views = views_of_a_wall()
    views["albedo"][:, 2:12:2] = 0.2
    views["depth"][:, 30:] = np.inf
    assert columns_of(views, "outside") == set(range(28, 40))
    assert columns_of(views, "textures") >= set(range(2, 11))
    assert columns_of(views, "textures").isdisjoint(range(16, 40))
