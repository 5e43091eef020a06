"""Polygons of OBJ files keep their area and sense when they are cut into triangles."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

from sailenv_ros.assets.obj_polygons import with_triangles


def triangles(text: str) -> NDArray[np.float64]:
    points = [
        [float(w) for w in line.split()[1:]] for line in text.splitlines() if line[:2] == "v "
    ]
    faces = [
        [int(w.split("/")[0]) - 1 for w in line.split()[1:]]
        for line in text.splitlines()
        if line[:2] == "f "
    ]
    assert all(len(face) == 3 for face in faces)
    return np.array(points)[np.array(faces)]


def area_vector(cut: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.cross(cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0]).sum(axis=0) / 2.0)


@given(
    radii=st.lists(st.floats(0.2, 3.0), min_size=4, max_size=24),
    axis=st.integers(0, 2),
    flipped=st.booleans(),
)
def test_star_shaped_polygons_keep_their_area(radii: list[float], axis: int, flipped: bool) -> None:
    """However deep its notches, the triangles cover the polygon once and face its way."""
    turns = np.linspace(0.0, 2.0 * np.pi, len(radii), endpoint=False)
    if flipped:
        turns = -turns
    flat = np.stack([np.cos(turns), np.sin(turns)], axis=1) * np.array(radii)[:, None]
    points = np.insert(flat, axis, 0.7, axis=1)
    text = "".join(f"v {x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
    cut = triangles(with_triangles(text + "f " + " ".join(map(str, range(1, len(radii) + 1)))))
    following = np.roll(points, -1, axis=0)
    expected = np.cross(points, following).sum(axis=0) / 2.0
    np.testing.assert_allclose(area_vector(cut)[axis], expected[axis], rtol=1e-9, atol=1e-12)
    sizes = np.linalg.norm(np.cross(cut[:, 1] - cut[:, 0], cut[:, 2] - cut[:, 0]), axis=1) / 2.0
    np.testing.assert_allclose(sizes.sum(), abs(expected[axis]), rtol=1e-9, atol=1e-12)


def test_the_rest_of_the_file_stays() -> None:
    """Materials, texture coordinates and triangles pass through; corners keep their words."""
    text = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1 4/1\n"
    cut = with_triangles(text).splitlines()
    assert cut[:-2] == text.splitlines()[:-1]
    assert cut[-2:] == ["f 1/1 2/1 3/1", "f 1/1 3/1 4/1"]


@pytest.mark.parametrize("face", ["f 1 2 3 99", "f a b c d", "f 0 0 0 0 0"])
def test_broken_faces_are_left_to_the_reader(face: str) -> None:
    """What cannot be cut is passed on or vanishes; nothing is raised."""
    with_triangles(f"v 0 0 0\nv 1 0 0\nv 0 1 0\n{face}\n")
