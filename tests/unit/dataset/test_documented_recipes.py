"""What the pages show of recipes and randomisation is right: keys, values and names."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
import yaml

from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.scene.scene_diagnostics import name_diagnostics
from sailenv_ros.simulation.scenes import SceneLibrary

DOCS = Path(__file__).parents[3] / "docs"
BASE: dict[str, Any] = {
    "version": 1,
    "scenes": [{"scene": "optical"}],
    "clips": {"train": 1},
    "cameras": [{"type": "fixed", "position": [0, 0, 1]}],
    "formats": ["webdataset"],
}


def blocks(page: str) -> list[dict[str, Any]]:
    """Return the blocks of YAML of a page that say what is drawn or seen."""
    text = (DOCS / page).read_text(encoding="utf-8")
    found = [yaml.safe_load(one) for one in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)]
    return [one for one in found if "randomise" in one or "cameras" in one]


@pytest.mark.parametrize(("page", "least"), [("randomisation.md", 4), ("datasets.md", 2)])
def test_the_pages_examples_are_accepted(page: str, least: int) -> None:
    shown = blocks(page)
    assert len(shown) >= least
    known = SceneLibrary().knowledge
    for block in shown:
        data = {**BASE, **{key: block[key] for key in DatasetRecipe.model_fields if key in block}}
        DatasetRecipe.model_validate({"name": "shown", **data})
        assert list(name_diagnostics(DatasetRecipe, data, known)) == []
