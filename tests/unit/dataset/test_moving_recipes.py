"""Things move by recipe: spawned objects and behaviours, the same on any number of workers."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sailenv_ros.dataset import RecipeError, engine_of, load_job, make_dataset, open_dataset
from sailenv_ros.types.geometry import Pose

ROOM: dict[str, Any] = {
    "version": 1,
    "room": {"size": [4, 4, 3]},
    "lights": [{"name": "lamp", "type": "point", "position": [0, 0, 2.5], "intensity": 3}],
    "objects": [
        {"name": "crate", "asset": "cube", "position": [1, -1, 0.2], "scale": 0.4, "static": True}
    ],
}
RECIPE: dict[str, Any] = {
    "version": 1,
    "seed": 3,
    "light": "plain",
    "scenes": [{"scene": "den.yaml"}],
    "clips": {"train": 3},
    "clip": {"frames": 4, "rate": 10, "per_scene": 1},
    "shard": {"clips": 1},
    "cameras": [
        {"type": "fixed", "position": [-1.8, -1.8, 2.5], "look_at": [0.5, 0, 0], "width": 96,
         "height": 72}
    ],
    "views": ["rgb", "instance", "flow"],
    "formats": ["webdataset"],
    "randomise": [
        {"name": "toy", "type": "spawn", "assets": ["sphere", "cone", "cube"], "count": 3,
         "scale": {"uniform": [0.2, 0.4]}, "height": {"uniform": [0.5, 1.5]}},
        {"name": "stir", "type": "behaviour", "of": {"category": "cube"},
         "behaviours": [{"type": "rotate_rigidbody", "angular_velocity": [0, 0, 90]}]},
    ],
}  # fmt: skip


def written(folder: Path, **changes: Any) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "den.yaml").write_text(yaml.safe_dump(ROOM))
    path = folder / "moving.yaml"
    path.write_text(yaml.safe_dump({**RECIPE, **changes}, sort_keys=False))
    return path


@pytest.mark.timeout(300)
def test_things_move_and_workers_change_nothing(tmp_path: Path) -> None:
    """Places, shapes and ways are in the record; each begin of the scene has others."""
    path = written(tmp_path)
    one = make_dataset(load_job(path), tmp_path / "one", engine_of(1, None))
    two = make_dataset(load_job(path), tmp_path / "two", engine_of(2, None))
    assert one.frames == 12
    assert one.sha256 == two.sha256
    assert not one.skipped
    with open_dataset(tmp_path / "one") as frames:
        listed = list(frames)
    records = [one.frame.randomised["epoch"] for one in listed]  # type: ignore[index]
    assert json.loads(json.dumps(records)) == records
    assert all(set(one["behaviours"]) == {"crate"} for one in records)
    places = {tuple(one["added"][0]["position"]) for one in records}
    assert len(places) == 3
    for clip in range(3):
        first, last = (listed[4 * clip + time].frame for time in (0, 3))
        assert not np.array_equal(first["instance"], last["instance"])
        assert not np.array_equal(first["rgb"], last["rgb"])


def test_doors_alone_move_by_joints(tmp_path: Path) -> None:
    """A behaviour of joints means only what is on one, told before the work begins."""
    entry = {"name": "open", "type": "behaviour", "of": "*"}
    swing = {**entry, "behaviours": [{"type": "open_and_close"}]}
    with pytest.raises(RecipeError, match=r"meets nothing in the scene den\.yaml"):
        load_job(written(tmp_path, randomise=[swing]))
    unknown = {**entry, "behaviours": [{"type": "open_and_clos"}]}
    with pytest.raises(RecipeError, match="did you mean 'open_and_close'"):
        load_job(written(tmp_path, randomise=[unknown]))


def test_what_finds_no_place_is_told_on_the_card(tmp_path: Path) -> None:
    hall = {"name": "hall", "type": "spawn", "assets": ["cube"], "scale": 6}
    path = written(tmp_path, randomise=[hall], clips={"train": 1})
    made = make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    assert made.findings["no place upon the floor for `hall 1`"] == {"den.yaml": 1}
    assert "hall 1" in (tmp_path / "made" / "README.md").read_text()


def test_a_mounted_camera_goes_where_its_carrier_goes(tmp_path: Path) -> None:
    """In every frame and clip; at one instant with it, also where the carrier comes later."""
    lens = {"width": 48, "height": 36}
    cameras = [
        {"name": "right", "type": "mounted", "on": "left", "position": [0, -0.1, 0.05],
         "rotation": [5, 0, -10], **lens},
        {"name": "left", "type": "orbit", "point": [0, 0, 1.2], "turn": 90, **lens},
    ]  # fmt: skip
    job = load_job(written(tmp_path, cameras=cameras, randomise=[], views=["depth"]))
    made = make_dataset(job, tmp_path / "rig", engine_of(1, None))
    assert made.frames == 24
    extrinsics = Pose.from_rpy_deg((0.0, -0.1, 0.05), (5.0, 0.0, -10.0)).matrix()
    poses: dict[tuple[int, int], dict[str, Any]] = {}
    with open_dataset(tmp_path / "rig") as data:
        for one in data:
            seen = poses.setdefault((one.clip, one.frame.stamp_ns), {})
            seen[one.camera] = one.frame.camera.pose.matrix()
    assert len(poses) == 12
    for seen in poses.values():
        np.testing.assert_allclose(seen["right"], seen["left"] @ extrinsics, atol=1e-9)
    starts = {tuple(seen["left"][:3, 3].round(6)) for seen in poses.values()}
    assert len(starts) == 12
