"""The text of the light law: Python's tables say the same, and shaders include it."""

from __future__ import annotations

import re

import numpy as np
import pytest

from sailenv_ros.colour import LUMINANCE
from sailenv_ros.lights import LAMP, LIGHT_KINDS, Light, lamp_rows
from sailenv_ros.native.compile import SOURCES
from sailenv_ros.render.programs import shader_source

LAW = (SOURCES / "kernels" / "light_law.h").read_text()


def test_kinds_have_the_numbers_of_the_law() -> None:
    """A point light is LIGHT_POINT, and so on; no kind is missing."""
    found = re.findall(r"^const int LIGHT_(\w+) = (\d+);", LAW, re.MULTILINE)
    assert {name.lower(): int(number) for name, number in found} == LIGHT_KINDS


def test_luminance_has_the_weights_of_the_law() -> None:
    """Those of Rec. 709, once in Python and once in the law."""
    found = re.search(r"LUMINANCE = vec3\((.*)\);", LAW)
    assert found is not None
    weights = [float(number.rstrip("f")) for number in found[1].split(", ")]
    np.testing.assert_array_equal(weights, LUMINANCE)
    assert LUMINANCE.sum() == pytest.approx(1.0)


def test_a_lamp_is_laid_out_as_the_law_says() -> None:
    """Numbers of four bytes in the same order; vectors are three of them."""
    found = re.search(r"^struct Lamp \{\n(.*?)^\};", LAW, re.MULTILINE | re.DOTALL)
    assert found is not None
    members = re.findall(r"^ *(vec3|int|float) (\w+);", found[1], re.MULTILINE)
    offsets, at = {}, 0
    for kind, name in members:
        offsets[name] = at
        at += 12 if kind == "vec3" else 4
    assert at == LAMP.itemsize == 64
    assert LAMP.fields is not None
    assert LAMP.names is not None
    for name in LAMP.names[:-1]:
        assert LAMP.fields[name][1] == offsets[name], name


def test_lamps_are_moved_into_a_frame() -> None:
    """Positions are moved and turned, directions turned; the rest stays."""
    spot = Light(name="spot", type="spot", position_m=(1, 2, 3), direction=(0, 0, -1))
    frame = np.array([[0, 1, 0, 5], [-1, 0, 0, 6], [0, 0, 1, 7], [0, 0, 0, 1]], float)
    here, there = lamp_rows([spot])[0], lamp_rows([spot], frame)[0]
    np.testing.assert_array_equal(there["position"], [7, 5, 10])
    np.testing.assert_array_equal(there["direction"], [0, 0, -1])
    for name in ("colour", "kind", "range_m", "inner_cosine", "outer_cosine"):
        np.testing.assert_array_equal(here[name], there[name])


@pytest.mark.parametrize("name", ["lighting.frag", "glass.frag", "sky.frag"])
def test_shaders_include_the_law(name: str) -> None:
    """Once, without what is for C++."""
    text = shader_source(name)
    assert text.count("float lamp_falloff(") + text.count("Real lamp_falloff(") == 1
    assert "__cplusplus" not in text
    assert "namespace" not in text
