"""What is made lying on something lies on it: neither in it nor above it."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

from sailenv_content.procedural import PROCEDURAL
from sailenv_content.procedural.airliner import RADIUS
from sailenv_content.procedural.cutlery import PLATE, SAUCER
from sailenv_ros.assets.model_files import RawPart


def points(parts: list[RawPart], word: str) -> NDArray[np.float64]:
    """Return the corners of the parts whose material's name has a word [m]."""
    found = [part.mesh.positions for part in parts if word in part.material.name]
    return np.concatenate(found)


@pytest.mark.parametrize(
    ("name", "dish", "profile", "lying"),
    [
        ("cake_plate", "plate ceramic", PLATE, "fork"),
        ("tea_cup", "china ceramic", SAUCER, "spoon"),
    ],
)
def test_cutlery_rests_on_its_plate(name: str, dish: str, profile: ArrayLike, lying: str) -> None:
    """It touches the plate, on both sides of its middle, and goes into it nowhere."""
    parts = PROCEDURAL[name]()
    outline = np.asarray(profile)
    top = outline[int(outline[:, 0].argmax()) :][::-1]
    plate = points(parts, dish)
    rim = plate[np.abs(plate[:, 2] - outline[int(outline[:, 0].argmax()), 1]) < 1e-9]
    centre = (rim.min(axis=0) + rim.max(axis=0)) / 2.0
    x, y, z = points(parts, lying).T
    under = np.interp(np.hypot(x - centre[0], y - centre[1]), top[:, 0], top[:, 1], right=0.0)
    gap = z - under
    assert 0.0 < gap.min() < 2e-4
    touching = x[gap < 6e-4]
    assert touching.min() < x.mean() < touching.max()


def test_an_airliner_has_an_airliners_proportions() -> None:
    """Those of an Airbus A320: 37.6 m long, 3.95 m thick, 34 to 36 m wide, its fin 5.9 m high."""
    parts = PROCEDURAL["airliner"]()
    low, high = (
        np.min([part.mesh.positions.min(axis=0) for part in parts], axis=0),
        np.max([part.mesh.positions.max(axis=0) for part in parts], axis=0),
    )
    length, width, height = high - low
    fuselage = np.ptp(points(parts, "fuselage"), axis=0)
    assert fuselage[1] / fuselage[0] == pytest.approx(3.95 / 37.57, rel=0.02)
    assert fuselage[1] == pytest.approx(2.0 * RADIUS * fuselage[0], rel=0.02)
    assert 0.90 < width / length < 1.0
    assert 0.25 < height / length < 0.33
    # Left and right are alike.
    assert low[1] == pytest.approx(-high[1], abs=1e-6)


def test_a_racket_is_as_the_rules_of_tennis_allow() -> None:
    """At most 73.7 cm long and 31.7 cm wide, the strung face at most 39.4 by 29.2 cm."""
    parts = PROCEDURAL["tennis_racket"]()
    every = np.concatenate([part.mesh.positions for part in parts])
    assert np.ptp(every[:, 0]) < 0.737
    assert np.ptp(every[:, 1]) < 0.317
    strings = np.ptp(points(parts, "strings"), axis=0)
    assert strings[0] < 0.394 + 0.02
    assert strings[1] < 0.292
    assert every[:, 2].min() == pytest.approx(0.0, abs=1e-9)
