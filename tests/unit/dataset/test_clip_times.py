"""Instants of clips: after settling, at the clip's rate, a gap apart, from the start again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset
from tests.unit.dataset.conftest import written_recipe

MS = 1_000_000
CAMERA = {"type": "fixed", "position": [5.0, 0.0, 2.0], "look_at": [0, 0, 1], "width": 16,
          "height": 16}  # fmt: skip


@pytest.mark.parametrize(
    ("clip", "begins_ms"),
    [
        ({"settle": 0.5, "gap": 0.25, "per_scene": 2}, [500, 850, 500, 850]),
        ({"settle": 0.0, "gap": 0.1, "per_scene": 3}, [0, 200, 400, 0]),
        ({"per_scene": 1}, [0, 0, 0, 0]),
    ],
)
def test_clips_begin_when_the_recipe_says(
    tmp_path: Path, clip: dict[str, Any], begins_ms: list[int]
) -> None:
    """Each has three frames a twentieth of a second apart."""
    path = written_recipe(
        tmp_path, clips={"train": 4}, clip={"frames": 3, "rate": 20.0, **clip}, cameras=[CAMERA],
        views=["instance"], formats=["webdataset"], flow="forward", shard={"clips": 4},
    )  # fmt: skip
    make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    with open_dataset(tmp_path / "made") as frames:
        found = [(one.clip, one.time, one.frame.stamp_ns) for one in frames]
    assert found == [
        (number, time, (begin + 50 * time) * MS)
        for number, begin in enumerate(begins_ms)
        for time in range(3)
    ]
