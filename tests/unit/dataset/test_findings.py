"""What the card warns of: dark and clipped frames, by a stated threshold on the histogram."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset
from sailenv_ros.dataset.findings import CLIPPED, DARK, brightness_fault, finding_lines
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from tests.unit.dataset.conftest import written_recipe


def picture(*shares: tuple[int, float]) -> Frame:
    """Return a frame with so much of each grey."""
    greys = np.concatenate([np.full(round(share * 1000), grey, np.uint8) for grey, share in shares])
    rgb = np.repeat(greys.reshape(25, 40, 1), 3, axis=2)
    return Frame(
        agent="a", scene="s", epoch=1, revision=0, sequence=1, stamp_ns=0, dt_ns=0,
        camera=Camera(intrinsics=CameraIntrinsics(width=40, height=25)),
        depth_range_m=(0.1, 10.0), views={"rgb": rgb},
    )  # fmt: skip


@pytest.mark.parametrize(
    ("shares", "fault"),
    [
        ([(63, 0.501), (200, 0.499)], DARK),
        ([(63, 0.5), (200, 0.5)], ""),
        ([(64, 1.0)], ""),
        ([(224, 1.0)], ""),
        ([(225, 0.501), (100, 0.499)], CLIPPED),
        ([(250, 0.05), (100, 0.95)], CLIPPED),
        ([(250, 0.049), (100, 0.951)], ""),
        ([(249, 0.4), (100, 0.6)], ""),
    ],
)
def test_thresholds_are_as_they_are_told(shares: list[tuple[int, float]], fault: str) -> None:
    assert brightness_fault(picture(*shares)) == fault


def test_findings_of_shards_are_added_up_and_scenes_named() -> None:
    shards = [{DARK: {"a": 2, "b": 1}}, {DARK: {"b": 4}}, {}]
    (line,) = finding_lines(shards)
    assert line == f"- **{DARK}**: 7, in b (5), a (2)"
    (line,) = finding_lines([{"x": {f"room {n:02d}": 1 for n in range(20)}}])
    assert line.endswith("room 11 (1) and 8 more scenes")


@pytest.mark.parametrize("workers", [1, 2])
def test_the_card_tells_which_scenes_are_dark(tmp_path: Path, workers: int) -> None:
    """An absolute exposure far below the scene's own darkens every frame; `add: 0` none."""
    stops = {"name": "stops", "type": "environment", "every": "frame"}
    changes = {"formats": ["webdataset"], "views": ["rgb"], "clips": {"train": 4}}
    for name, value, dark in (("dark", -9, True), ("own", {"add": 0}, False)):
        path = written_recipe(tmp_path / name, randomise=[{**stops, "exposure": value}], **changes)
        made = make_dataset(load_job(path), tmp_path / name / "made", engine_of(workers, None))
        assert made.findings.get(DARK, {}) == ({"optical": 24} if dark else {})
        card = (tmp_path / name / "made" / "README.md").read_text()
        assert (f"**{DARK}**: 24, in optical (24)" in card) == dark
    with open_dataset(tmp_path / "own" / "made") as frames:
        record = frames[0].frame.randomised
    assert record is not None
    assert record["frame"]["relative"] == {"environment": {"exposure": {"add": 0.0}}}
