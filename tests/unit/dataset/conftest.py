"""A small recipe, of a scene that needs no furniture, and its data set."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
import yaml

from sailenv_ros.dataset import engine_of, load_job, make_dataset

SMALL: Mapping[str, Any] = {
    "version": 1,
    "seed": 5,
    "scenes": [{"scene": "optical"}],
    "clips": {"train": 5, "val": 2},
    "clip": {"frames": 3, "rate": 30.0, "per_scene": 2},
    "cameras": [
        {
            "type": "orbit", "name": "around", "object": "red cube", "width": 64, "height": 48,
            "distance": [4.0, 5.0], "turn": [20.0, 40.0],
        },
        {
            "type": "fixed", "name": "still", "position": [5.0, 0.0, 2.0], "look_at": [0, 0, 1],
            "width": 48, "height": 48,
        },
    ],
    "views": ["rgb", "depth", "category", "instance", "flow"],
    "formats": ["coco", "webdataset", "mcap", "sintel"],
    "flow": "both",
    "shard": {"clips": 2},
}  # fmt: skip


def written_recipe(folder: Path, **changes: Any) -> Path:
    """Write the small recipe with changes; return its path."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / "small.yaml"
    path.write_text(yaml.safe_dump({**SMALL, **changes}, sort_keys=False))
    return path


@pytest.fixture(scope="session")
def small(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the small data set, made in this process."""
    folder = tmp_path_factory.mktemp("dataset")
    job = load_job(written_recipe(folder))
    make_dataset(job, folder / "made", engine_of(1, None))
    return folder / "made"
