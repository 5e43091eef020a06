"""What an asset's physics cannot do is told with the scene file's other errors."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest

from sailenv_ros.assets import AssetLibrary, ObjectFit
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.types.model import Asset, TriangleShape


class Hollow:
    """A source of one asset that collides as triangles."""

    display_names: Mapping[str, str] = MappingProxyType({"cave": "Cave"})

    def load(self, name: str) -> Asset:
        shape = TriangleShape(positions=np.eye(3), triangles=np.array([[0, 1, 2]], dtype=np.int32))
        return dataclasses.replace(Primitives().load("cube"), name=name, collision=(shape,))


FIT = ObjectFit(AssetLibrary([Primitives(), Hollow()]))


@pytest.mark.parametrize(
    ("entry", "expected"),
    [
        ({"asset": "sphere", "scale": [1, 1, 2]}, "must be equal in x, y and z"),
        ({"asset": "Sphere", "scale": [1, 1, 2]}, "sphere collides as a ball"),
        ({"asset": "cylinder", "scale": [1, 2, 1]}, "must be equal in x and y"),
        ({"asset": "cave"}, "cannot move; add static: true"),
        ({"asset": "cave", "static": False}, "cannot move; add static: true"),
    ],
)
def test_what_does_not_fit(entry: dict[str, Any], expected: str) -> None:
    ((place, sentence),) = FIT(entry)
    assert place in (("scale",), ("asset",))
    assert expected in sentence


@pytest.mark.parametrize(
    "entry",
    [
        {},
        {"asset": 3},
        {"asset": "unknown", "scale": [1, 1, 2]},
        {"asset": "cube", "scale": [1, 2, 3]},
        {"asset": "cone", "scale": [1, 2, 3]},
        {"asset": "sphere", "scale": 3},
        {"asset": "sphere", "scale": [3, 3.0, 3]},
        {"asset": "sphere", "scale": [3, "x", 3]},
        {"asset": "sphere", "scale": [3, float("nan"), 3]},
        {"asset": "cylinder", "scale": [2, 2, 5]},
        {"asset": "cave", "static": True},
    ],
)
def test_what_fits_or_is_no_business_of_this_check(entry: dict[str, Any]) -> None:
    assert list(FIT(entry)) == []
