"""The books of a bookcase: each in its bay, none within another, their spines to the front."""

from __future__ import annotations

import itertools

import numpy as np

from sailenv_content.procedural.shelf_books import BAYS, FRONT_M, shelf_books


def _boxes() -> list[np.ndarray]:
    parts = shelf_books()
    return [np.stack([p.mesh.positions.min(0), p.mesh.positions.max(0)]) for p in parts]


def test_each_book_lies_in_a_bay_and_behind_its_front() -> None:
    for low, high in _boxes():
        assert -0.13 < low[0] < high[0] < FRONT_M + 0.01
        assert any(
            bay.right <= low[1]
            and high[1] <= bay.left
            and bay.floor - 1e-9 <= low[2]
            and high[2] <= bay.ceiling
            for bay in BAYS
        )


def test_no_two_books_take_the_same_room() -> None:
    for (low, high), (other_low, other_high) in itertools.combinations(_boxes(), 2):
        apart = np.maximum(low - other_high, other_low - high)
        assert apart.max() > 0.0


def test_every_bay_has_books_and_they_are_the_same_each_time() -> None:
    boxes = _boxes()
    for bay in BAYS:
        assert sum(bay.right <= low[1] and high[1] <= bay.left for low, high in boxes) >= 3
    assert np.array_equal(np.stack(boxes), np.stack(_boxes()))
