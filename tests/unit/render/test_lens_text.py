"""The text of the lens: Python's structure says the same, and shaders include it."""

from __future__ import annotations

import re

import pytest

from sailenv_ros.native.compile import SOURCES
from sailenv_ros.native.lens import LENS
from sailenv_ros.render.gl.programs import shader_source

TEXT = (SOURCES / "kernels" / "lens.h").read_text()

SHADERS = ["geometry.vert", "geometry.frag", "lighting.frag", "glass.frag", "sky.frag"]


def test_a_lens_is_laid_out_as_its_text_says() -> None:
    """The same numbers in the same order: kernels read what Python writes."""
    found = re.search(r"^struct Lens \{\n(.*?)^\};", TEXT, re.MULTILINE | re.DOTALL)
    assert found is not None
    lines = re.findall(r"^ *Number (.*?);", found[1], re.MULTILINE)
    assert tuple(name for line in lines for name in line.split(", ")) == LENS.names
    assert LENS.itemsize == 8 * len(LENS.names)


@pytest.mark.parametrize("name", SHADERS)
def test_shaders_include_the_lens(name: str) -> None:
    """Once, without what is for C++; none works a ray out by itself."""
    text = shader_source(name)
    assert len(re.findall(r"\bray_x\(const", text)) == 1
    assert "__cplusplus" not in text
    assert "FastLens" not in text
    own, _, _ = text.partition("struct Lens")
    rest = text[text.index("vec3 ray_through(") :].partition("}")[2]
    assert not re.search(r"\blens\.(fx|fy|cx|cy)\b", own + rest)
