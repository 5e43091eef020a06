"""Tables of frames: Parquet as `datasets` has it, episodes as LeRobot has them."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest

from sailenv_ros.dataset import RecipeError, engine_of, load_job, make_dataset, open_dataset
from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.manifest import done_shards
from sailenv_ros.dataset.merging import ShardRecords
from tests.unit.dataset.conftest import SMALL, written_recipe

CLIPS, FRAMES = {"train": 3, "val": 1}, 3


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of one camera as tables, and as tar files to compare with."""
    place = tmp_path_factory.mktemp("tables")
    path = written_recipe(
        place,
        cameras=SMALL["cameras"][:1],
        clips=CLIPS,
        formats=["webdataset", "parquet", "lerobot"],
    )
    make_dataset(load_job(path), place / "made", engine_of(1, None))
    return place / "made"


def test_parquet_rows_are_the_frames(folder: Path) -> None:
    """Pictures, depth and objects as they were; each split has its files."""
    with open_dataset(folder) as dataset:
        frames = {one.number: one for one in dataset}
    count = 0
    for path in sorted((folder / "parquet" / "data").iterdir()):
        table = pq.read_table(path)
        told = json.loads(table.schema.metadata[b"huggingface"])["info"]["features"]
        assert told["rgb"] == {"_type": "Image"}
        assert told["depth"] == {"shape": [48, 64], "dtype": "float32", "_type": "Array2D"}
        for row in table.to_pylist():
            one = frames[row["number"]]
            count += 1
            assert path.name.startswith(one.split)
            picture = cv2.imdecode(np.frombuffer(row["rgb"]["bytes"], np.uint8), 1)[..., ::-1]
            np.testing.assert_array_equal(picture, one.frame["rgb"])
            np.testing.assert_array_equal(np.float32(row["depth"]), one.frame["depth"])
            assert [entry["id"] for entry in row["objects"]] == [e["id"] for e in one.objects]
            np.testing.assert_allclose(
                np.reshape(row["world_from_camera"], (4, 4)), one.frame.camera.world_from_camera
            )
    assert count == len(frames) == 4 * FRAMES


def test_lerobot_episodes_are_the_clips(folder: Path) -> None:
    """Times, states, actions and ranges; the tables follow one another as the ranges say."""
    root = folder / "lerobot"
    info = json.loads((root / "meta" / "info.json").read_text())
    assert (info["total_episodes"], info["total_frames"], info["fps"]) == (4, 12, 30)
    assert info["splits"] == {"train": "0:3", "val": "3:4"}
    rows = [
        row
        for path in sorted((root / "data").rglob("*.parquet"))
        for row in pq.read_table(path).to_pylist()
    ]
    assert [row["index"] for row in rows] == list(range(12))
    episodes = pq.read_table(root / "meta" / "episodes").to_pylist()
    with open_dataset(folder) as dataset:
        frames = list(dataset)
    for episode in episodes:
        own = rows[episode["dataset_from_index"] : episode["dataset_to_index"]]
        assert {row["episode_index"] for row in own} == {episode["episode_index"]}
        assert [row["frame_index"] for row in own] == [0, 1, 2]
        np.testing.assert_allclose([row["timestamp"] for row in own], [0, 1 / 30, 2 / 30], 1e-4)
        assert own[0]["action"] == own[1]["observation.state"]
        assert own[2]["action"] == own[2]["observation.state"]
    for row, one in zip(rows, frames, strict=True):
        pose = one.frame.camera.pose
        np.testing.assert_allclose(row["observation.state"][:3], pose.position_m, rtol=1e-6)
        np.testing.assert_array_equal(np.float32(row["observation.depth"]), one.frame["depth"])
    stats = json.loads((root / "meta" / "stats.json").read_text())
    pictures = np.stack([one.frame["rgb"] for one in frames]) / 255.0
    told = stats["observation.images.camera"]
    np.testing.assert_allclose(np.ravel(told["mean"]), pictures.mean(axis=(0, 1, 2)), rtol=1e-9)
    np.testing.assert_allclose(np.ravel(told["std"]), pictures.std(axis=(0, 1, 2)), rtol=1e-6)
    tasks = pq.read_table(root / "meta" / "tasks.parquet")
    index = json.loads(tasks.schema.metadata[b"pandas"])["index_columns"]
    assert tasks.column(index[0]).to_pylist() == ["look around"]


def test_lerobot_takes_one_camera(tmp_path: Path) -> None:
    """Its episodes follow one another; two cameras are refused before anything is made."""
    with pytest.raises(RecipeError, match="lerobot takes one camera, got 2"):
        load_job(written_recipe(tmp_path, formats=["lerobot"]))


def test_records_are_read_shard_by_shard(folder: Path) -> None:
    """Each is found by its place, and all come in order as often as they are asked for."""
    store = FolderStorage(folder)
    shards = done_shards(store)
    records = ShardRecords(store, shards, "lerobot")
    assert len(shards) > 1
    assert [one.number for one in records] == [*range(sum(CLIPS.values()) * FRAMES)]
    assert list(records) == [records[place] for place in range(len(records))] == records[:]
    assert records[-1] == list(records)[-1]
    assert all(one.value["sums"] for one in records)
    with pytest.raises(IndexError, match="none of number 12"):
        records[12]
