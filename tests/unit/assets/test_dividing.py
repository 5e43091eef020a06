"""Meshes of a model that are labelled apart: by material, by piece, by height, book by book."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_content.procedural.forms import merged, moved
from sailenv_content.procedural.shapes import box, part
from sailenv_content.standard.dividing import divided
from sailenv_ros.assets.model_files import RawPart
from sailenv_ros.assets.recipe import RecipePart
from sailenv_ros.errors import AssetError


def cushions() -> list[RawPart]:
    """A frame, and two cushions of one mesh, each with a button that touches it."""
    pieces = [
        moved(box(size, (0.0, 0.0, 0.0)), (0.0, side, height))
        for side in (0.5, -0.5)
        for size, height in (((0.4, 0.4, 0.1), 0.5), ((0.02, 0.02, 0.02), 0.561))
    ]
    return [part("frame", box((1.0, 2.0, 0.4), (0.0, 0.0, 0.2))), part("soft", merged(pieces))]


def test_what_no_rule_names_is_the_body() -> None:
    found = divided("sofa", cushions(), {})
    assert [(mesh.name, mesh.category) for mesh in found] == [("", ""), ("", "")]


def test_a_material_is_one_part() -> None:
    rule = RecipePart(category="pillow", materials=("so*",))
    found = divided("sofa", cushions(), {"cushions": rule})
    assert [(m.name, m.category, m.mesh.material.name) for m in found] == [
        ("", "", "frame"),
        ("cushions", "pillow", "soft"),
    ]


def test_each_mesh_is_one_part_though_it_has_pieces() -> None:
    rule = RecipePart(category="pillow", materials=("*",), each="mesh")
    found = divided("sofa", cushions(), {"piece": rule})
    assert [(m.name, m.mesh.material.name) for m in found] == [
        ("piece 1", "frame"),
        ("piece 2", "soft"),
    ]


def test_pieces_that_touch_are_one_part_numbered_from_the_right() -> None:
    rule = RecipePart(category="pillow", materials=("soft",), each="piece")
    found = divided("sofa", cushions(), {"cushion": rule})
    middles = {}
    for mesh in found:
        middles.setdefault(mesh.name, []).append(float(mesh.mesh.mesh.positions[:, 1].mean()))
    assert set(middles) == {"", "cushion 1", "cushion 2"}
    assert np.allclose(middles["cushion 1"], -0.5)
    assert np.allclose(middles["cushion 2"], 0.5)
    whole = sum(len(raw.mesh.triangles) for raw in cushions())
    assert sum(len(mesh.mesh.mesh.triangles) for mesh in found) == whole


def test_only_what_is_high_enough_is_the_part() -> None:
    rule = RecipePart(category="tap", materials=("soft",), above=0.55)
    found = divided("sink", cushions(), {"tap": rule})
    taken = [mesh.mesh.mesh.positions for mesh in found if mesh.name == "tap"]
    assert len(taken) == 2
    assert all(np.ptp(positions[:, 0]) == pytest.approx(0.02) for positions in taken)
    left = [mesh.mesh.material.name for mesh in found if not mesh.name]
    assert left == ["frame", "soft", "soft"]


def test_a_row_of_books_is_cut_between_them() -> None:
    """Three books of 4, 2 and 3 cm, drawn as one strip: each step belongs to the higher one."""
    widths, heights = (0.04, 0.02, 0.03), (0.20, 0.26, 0.22)
    edges = np.concatenate([[0.0], np.cumsum(widths)])
    books = [
        box((0.15, width, height), (0.0, left + width / 2.0, height / 2.0))
        for width, height, left in zip(widths, heights, edges[:-1], strict=True)
    ]
    rule = RecipePart(category="book", materials=("row",), each="book")
    found = divided("shelf", [part("row", merged(books))], {"book": rule})
    assert [mesh.name for mesh in found] == ["book 1", "book 2", "book 3"]
    boxes = [(m.mesh.mesh.positions.min(axis=0), m.mesh.mesh.positions.max(axis=0)) for m in found]
    for (low, high), width, height, left in zip(boxes, widths, heights, edges[:-1], strict=True):
        np.testing.assert_allclose(
            [low[1], high[1], high[2]], [left, left + width, height], atol=1e-6
        )
    assert all(len(mesh.mesh.mesh.triangles) == 12 for mesh in found)


def test_a_part_without_a_mesh_is_refused() -> None:
    rule = RecipePart(category="pillow", materials=("glass",))
    with pytest.raises(AssetError, match="no mesh is one of its part 'pane'"):
        divided("window", cushions(), {"pane": rule})
