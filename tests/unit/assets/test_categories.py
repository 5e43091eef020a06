"""The category table is complete, stable and readable in pictures."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets import load_categories
from sailenv_ros.assets.categories import LAST_FIXED_ID
from sailenv_ros.errors import AssetError
from sailenv_ros.scene.spec import FIRST_SCENE_CATEGORY_ID
from sailenv_ros.types.colour import linear_from_srgb
from sailenv_ros.types.labels import BACKGROUND, UNLABELLED_CATEGORY

FIXED_FOR_EVER = {
    1: "cube",
    2: "sphere",
    3: "cylinder",
    4: "cone",
    5: "plane",
    6: "bed",
    8: "chair",
    10: "dining table",
    14: "potted plant",
    18: "toilet",
    19: "tv",
}


def test_ids_never_change() -> None:
    """Recordings and trained networks hold them."""
    table = load_categories()
    assert {id_: table[id_].name for id_ in FIXED_FOR_EVER} == FIXED_FOR_EVER


def test_ids_run_from_1_without_gaps_below_those_of_scenes() -> None:
    ids = [i for i in load_categories() if i not in (BACKGROUND, UNLABELLED_CATEGORY)]
    assert ids == list(range(1, len(ids) + 1))
    assert len(ids) >= 80
    assert LAST_FIXED_ID == FIRST_SCENE_CATEGORY_ID - 1


NEEDED = """bed,book,chair,couch,dining table,fork,laptop,airplane,potted plant,remote,spoon,
tennis racket,toilet,tv,wall,floor,ceiling,window,door,desk,cabinet,lamp,painting,rug,pillow,towel,
bottle,bathtub,sink,shelf,curtain,mirror,bowl,cup,knife,vase,clock,keyboard,mouse,pen,notebook"""


def test_what_rooms_need_has_a_category() -> None:
    known = {category.name for category in load_categories().values()}
    assert set(NEEDED.replace("\n", "").split(",")) - known == set()


def _lab(srgb: NDArray[np.float64]) -> NDArray[np.float64]:
    """CIE L*a*b* of (N, 3) sRGB colours from 0 to 255, white point D65 (IEC 61966-2-1)."""
    linear = linear_from_srgb(srgb / 255.0)
    matrix = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    xyz = linear @ matrix.T / [0.9505, 1.0, 1.089]
    f = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    x, y, z = f.T
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def test_no_two_colours_look_alike() -> None:
    """Background and unlabelled included; 2.3 is what an eye can just tell apart."""
    table = list(load_categories().values())
    lab = _lab(np.array([category.colour for category in table], dtype=np.float64))
    for i, j in itertools.combinations(range(len(table)), 2):
        distance = float(np.linalg.norm(lab[i] - lab[j]))
        assert distance > 15, (table[i].name, table[j].name)


_TWO = """
categories:
  - {{id: 1, name: a, colour: '#012345'}}
  - {{id: {second_id}, name: {second_name}, colour: '#543210'}}
"""


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("categories: [{id: 0, name: a, colour: '#012345'}]", "greater than or equal to 1"),
        ("categories: [{id: 200, name: a, colour: '#012345'}]", "less than or equal to 199"),
        ("categories: [{id: 1, name: a, color: '#012345'}]", "color"),
        (_TWO.format(second_id=2, second_name="a"), "'a'"),
        (_TWO.format(second_id=1, second_name="b"), "'1'"),
        ("categories: [", "expected"),
        ("", "valid"),
    ],
)
def test_a_table_with_a_fault_is_refused(tmp_path: Path, text: str, why: str) -> None:
    path = tmp_path / "categories.yaml"
    path.write_text(text)
    with pytest.raises(AssetError, match=why):
        load_categories(path)


def test_a_table_that_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match="No such file"):
        load_categories(tmp_path / "none.yaml")
