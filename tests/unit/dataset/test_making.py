"""Data sets are whole, the same on any number of workers, and go on after a break."""

from __future__ import annotations

import io
import json
import os
import shutil
import signal
import subprocess
import sys
import tarfile
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pyarrow.parquet as pq
import pytest
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO
from rosbags.highlevel import AnyReader

from sailenv_ros.dataset import engine_of, load_job, make_dataset, open_dataset, verify_dataset
from sailenv_ros.dataset.engines import SerialEngine
from sailenv_ros.dataset.manifest import summaries_of_files
from sailenv_ros.errors import BegunOtherwise, PlaceTaken, UnknownName
from sailenv_ros.frame.motion import motion
from sailenv_ros.system.resources import resource_path
from tests.support.waiting import until
from tests.unit.dataset.conftest import written_recipe

FRAMES = 7 * 3 * 2


def contents(folder: Path) -> dict[str, str]:
    """Hashes of all files but those that tell of the machine."""
    return {
        name: one.sha256
        for name, one in summaries_of_files(folder).items()
        if name != "manifest.json" and not name.startswith("shards/")
    }


@pytest.mark.timeout(400)
def test_workers_change_nothing(small: Path, tmp_path: Path) -> None:
    """Two processes make the bytes that one makes."""
    made = make_dataset(load_job(small.parent / "small.yaml"), tmp_path / "two", engine_of(2, None))
    assert contents(tmp_path / "two") == contents(small)
    assert made.sha256 == json.loads((small / "manifest.json").read_text())["sha256"]
    assert (made.frames, made.shards) == (FRAMES, 4)


def test_formats_hold_every_frame(small: Path) -> None:
    """Readers that are not ours find as many frames and objects as were written."""
    made = json.loads((small / "manifest.json").read_text())
    annotations = images = 0
    for split in ("train", "val"):
        coco = COCO(str(small / "coco" / split / "annotations.json"))
        images += len(coco.getImgIds())
        annotations += len(coco.getAnnIds())
        for one in coco.loadImgs(coco.getImgIds()):
            picture = cv2.imread(str(small / "coco" / split / "images" / one["file_name"]))
            assert picture.shape[:2] == (one["height"], one["width"])
    assert (images, annotations) == (FRAMES, made["written"]["coco"]["annotations"])
    names: list[str] = []
    for path in sorted((small / "webdataset").iterdir()):
        with tarfile.open(path) as tar:
            names += tar.getnames()
    assert len(names) == FRAMES * 6
    assert len({name.partition(".")[0] for name in names}) == FRAMES
    bags = sorted((small / "mcap").rglob("bag"))
    assert len(bags) == 14
    with AnyReader([bags[0]]) as reader:
        assert sum(1 for connection in reader.connections if "/rgb" in connection.topic) == 1
        assert reader.message_count > 3 * 6
    flows = sorted((small / "sintel").rglob("flow/*/*.flo"))
    assert len(flows) == 7 * 2 * 2
    assert len(sorted((small / "sintel").rglob("flow_backward/*/*.flo"))) == 7 * 2 * 2
    assert np.isfinite(cv2.readOpticalFlow(str(flows[0]))).any()


def test_frames_are_read_as_they_were(small: Path) -> None:
    """From tar files every value, the camera and the objects; splits are as the recipe says."""
    with open_dataset(small) as dataset, open_dataset(small, "val") as val:
        assert (len(dataset), len(val)) == (FRAMES, 12)
        one, later = dataset[1], dataset[2]
        assert (one.number, one.time, one.camera, one.split) == (1, 1, "around", "train")
        with tarfile.open(small / "webdataset" / "train-00000.tar") as tar:
            member = tar.extractfile("00000001.depth.npy")
            assert member is not None
            stored = np.load(io.BytesIO(member.read()))
        np.testing.assert_array_equal(one.frame["depth"], stored)
        lens = one.frame.camera.intrinsics
        assert one.frame["rgb"].shape == (lens.height, lens.width, 3) == (48, 64, 3)
        ids = {entry["id"] for entry in one.objects}
        assert ids <= set(np.unique(one.frame["instance"]).tolist())
        # The camera goes round at the recipe's rate: 20 to 40 degrees a second.
        here, there = (np.array(f.frame.camera.pose.position_m) for f in (one, later))
        angles = [np.degrees(np.arctan2(p[1], p[0])) for p in (here, there)]
        assert 20.0 / 30.0 <= abs((angles[1] - angles[0] + 180.0) % 360.0 - 180.0) <= 40.0 / 30.0
        assert later.frame.stamp_ns - one.frame.stamp_ns in (33_333_333, 33_333_334)
        still = dataset[3]
        assert still.camera == "still"
        np.testing.assert_allclose(still.frame.camera.pose.position_m, (5.0, 0.0, 2.0))
        with pytest.raises(UnknownName):
            open_dataset(small, "test")


def test_bags_give_frames_with_everything(tmp_path: Path) -> None:
    """Where only bags are written, frames come from them, with states for motion."""
    path = written_recipe(tmp_path, formats=["mcap"], clips={"train": 1})
    make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    with open_dataset(tmp_path / "made") as dataset:
        first, second = dataset[0].frame, dataset[1].frame
        assert first.agent == "around"
        moved = motion(second, first)
        np.testing.assert_allclose(
            moved.flow[moved.valid], second["flow"][moved.valid] * -second.dt_s, atol=1e-3
        )


def test_what_was_broken_off_goes_on(small: Path, tmp_path: Path) -> None:
    """Shards that are whole stay; those that are not are made; nothing is left of the break."""
    broken = tmp_path / "broken"
    shutil.copytree(small, broken)
    (broken / "manifest.json").unlink()
    (broken / "shards" / "00001.json").unlink()
    (broken / "webdataset" / "train-00001.tar").write_bytes(b"half")
    before = (broken / "shards" / "00000.json").stat().st_mtime_ns
    told = []
    job = load_job(small.parent / "small.yaml")
    make_dataset(job, broken, engine_of(1, None), on_progress=told.append)
    assert contents(broken) == contents(small)
    assert (broken / "shards" / "00000.json").stat().st_mtime_ns == before
    assert (told[0].shards, told[-1].frames) == (3, FRAMES)


def test_a_limit_makes_the_first_shards_and_the_rest_later(small: Path, tmp_path: Path) -> None:
    """Whole shards up to the frame; they can be read, and become the same data set."""
    job = load_job(small.parent / "small.yaml")
    part = make_dataset(job, tmp_path / "part", engine_of(1, None), limit=13)
    # A shard has 2 clips of 3 frames by 2 cameras.
    assert (part.frames, part.shards, part.sha256) == (24, 2, "")
    with open_dataset(tmp_path / "part") as dataset:
        assert len(dataset) == 24
    assert make_dataset(job, tmp_path / "part", engine_of(1, None), limit=24).frames == 24
    whole = make_dataset(job, tmp_path / "part", engine_of(1, None))
    assert whole.sha256
    assert contents(tmp_path / "part") == contents(small)


@pytest.mark.timeout(400)
def test_ctrl_c_is_quick_and_leaves_nothing_among_temporary_files(
    small: Path, tmp_path: Path
) -> None:
    """Workers end with their parent, and take their folders along."""
    scratch = tmp_path / "scratch"
    scratch.mkdir()
    folder = tmp_path / "broken"
    (tmp_path / "mine.yaml").write_text(resource_path("scenes", "optical.yaml").read_text())
    # So many that it cannot end by itself before the signal comes.
    recipe = written_recipe(
        tmp_path, scenes=[{"scene": "mine.yaml"}], shard={"clips": 1}, clips={"train": 5000}
    )
    running = subprocess.Popen(
        [
            sys.executable, "-m", "sailenv_ros.cli.main", "dataset", "make", str(recipe),
            "-o", str(folder), "--workers", "2",
        ],
        env={
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
            "TMPDIR": str(scratch),
        },
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        until(lambda: list(folder.glob("shards/*.json")), "the first shard", 120.0)
        assert any(path.name.startswith("sailenv-") for path in scratch.iterdir())
        running.send_signal(signal.SIGINT)
        assert running.wait(30.0) == 130
    finally:
        running.kill()
        running.wait(10.0)
    until(lambda: not list(scratch.glob("sailenv-*")), "the workers' folders to go", 20.0)
    assert not (folder / "manifest.json").exists()


class DyingEngine(SerialEngine):
    """Stops after two shards, as Ctrl-C does."""

    def run(self, job, where, shards, on_frames):  # type: ignore[no-untyped-def]
        for count, summary in enumerate(super().run(job, where, shards, on_frames)):
            yield summary
            if count == 1:
                raise KeyboardInterrupt


def test_an_unfinished_data_set_can_be_read(small: Path, tmp_path: Path) -> None:
    """The frames of whole shards are there, and no others."""
    job = load_job(small.parent / "small.yaml")
    with pytest.raises(KeyboardInterrupt):
        make_dataset(job, tmp_path / "part", DyingEngine())
    with open_dataset(tmp_path / "part") as dataset:
        assert len(dataset) == 4 * 3 * 2
        assert dataset[-1].frame["rgb"].any()


def test_another_recipe_does_not_go_on(small: Path, tmp_path: Path) -> None:
    """A folder is of one recipe; one with other files is left alone."""
    other = load_job(written_recipe(tmp_path, seed=6))
    before = contents(small)
    with pytest.raises(BegunOtherwise, match=r"begun otherwise: recipe\.seed is 5, not 6"):
        make_dataset(other, small, engine_of(1, None))
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    with pytest.raises(PlaceTaken, match="not empty"):
        make_dataset(other, tmp_path / "full", engine_of(1, None))
    assert contents(small) == before
    assert sorted(path.name for path in (tmp_path / "full").iterdir()) == ["mine.txt"]


def test_what_another_version_began_does_not_go_on(small: Path, tmp_path: Path) -> None:
    """What decides on the bytes is compared as it was when the data set was begun."""
    broken = tmp_path / "broken"
    shutil.copytree(small, broken)
    told = json.loads((broken / "job.json").read_text())
    told["head"]["opencv"], told["head"]["sailenv_ros"] = "4.0.0", "0.1.0"
    (broken / "job.json").write_text(json.dumps(told))
    before = contents(broken)
    job = load_job(small.parent / "small.yaml")
    with pytest.raises(BegunOtherwise) as problem:
        make_dataset(job, broken, engine_of(1, None))
    assert problem.value.differing.keys() == {"opencv", "sailenv_ros"}
    assert contents(broken) == before


def test_verifying_finds_what_was_changed(small: Path, tmp_path: Path) -> None:
    """A changed byte, a missing file, and a shard that the recipe does not make."""
    assert verify_dataset(small, sample=1) == []
    broken = tmp_path / "broken"
    shutil.copytree(small, broken)
    tar = broken / "webdataset" / "train-00000.tar"
    data = bytearray(tar.read_bytes())
    data[3000] ^= 1
    tar.write_bytes(data)
    (broken / "coco" / "train" / "images" / "000003.png").unlink()
    (broken / "coco" / "val" / "annotations.json").write_text("{}")
    found = {one.path: one.why for one in verify_dataset(broken, sample=0)}
    assert found == {
        "webdataset/train-00000.tar": "has another content than was written",
        "coco/train/images/000003.png": "is not there",
        "coco/val/annotations.json": "has another content than was written",
    }
    summary = broken / "shards" / "00003.json"
    told = json.loads(summary.read_text())
    path = next(name for name in told["files"] if name.startswith("webdataset"))
    told["files"][path]["sha256"] = "0" * 64
    summary.write_text(json.dumps(told))
    found = {one.path: one.why for one in verify_dataset(broken, sample=4)}
    assert found[path] == "is another one when it is made anew"


def test_verifying_goes_on_after_damaged_summaries(small: Path, tmp_path: Path) -> None:
    """What can be read is compared, whichever of the files that tell of the others cannot."""
    broken = tmp_path / "broken"
    shutil.copytree(small, broken)
    shards = broken / "shards"
    (shards / "00000.json").write_bytes(b"{" + (shards / "00000.json").read_bytes())
    (shards / "00001.json").unlink()
    told = json.loads((shards / "00003.json").read_text())
    (shards / "00003.json").write_text(json.dumps({**told, "files": {"a": {"bytes": 1}}}))
    changed = next(
        path
        for path in json.loads((shards / "00002.json").read_text())["files"]
        if path.startswith("webdataset")
    )
    (broken / changed).write_bytes(b"")

    found = {one.path: one.why for one in verify_dataset(broken, sample=4)}
    assert found.keys() == {*(f"shards/0000{number}.json" for number in (0, 1, 3)), changed}
    assert found["shards/00000.json"].startswith("is no summary of a shard: Expecting property")
    assert found["shards/00001.json"] == "is not there"
    assert found["shards/00003.json"].startswith("is no summary of a shard: ")
    assert found[changed] == "has another content than was written"

    shutil.copy(small / "shards" / "00002.json", shards / "00001.json")
    (shards / "00003.json").unlink()
    (shards / "00003.json").mkdir()
    (broken / "coco" / "val" / "annotations.json").write_text("{}")
    found = {one.path: one.why for one in verify_dataset(broken, sample=0)}
    assert found["shards/00001.json"] == "is no summary of a shard: it tells of shard 2"
    assert found["shards/00003.json"] == "cannot be read: Is a directory"
    assert found["coco/val/annotations.json"] == "has another content than was written"

    (broken / "manifest.json").write_text("[]")
    found = {one.path: one.why for one in verify_dataset(broken, sample=0)}
    assert found["manifest.json"].startswith(f"in {broken} cannot be read: ")
    assert {"shards/00000.json", changed} < found.keys()


def test_verifying_finds_a_summary_that_tells_of_other_files(small: Path, tmp_path: Path) -> None:
    """The manifest knows what each shard holds."""
    broken = tmp_path / "broken"
    shutil.copytree(small, broken)
    summary = broken / "shards" / "00002.json"
    told = json.loads(summary.read_text())
    told["files"].popitem()
    summary.write_text(json.dumps(told))
    found = verify_dataset(broken, sample=0)
    why = "tells of other files than manifest.json"
    assert [(one.path, one.why) for one in found] == [("shards/00002.json", why)]


def test_cameras_without_a_place_are_counted(tmp_path: Path) -> None:
    """A clip whose camera finds nothing to look at is left out, and the card says so."""
    (tmp_path / "bare.yaml").write_text("version: 1\nobjects: [{name: one, asset: cube}]\n")
    path = written_recipe(
        tmp_path,
        scenes=[{"scene": "optical"}, {"scene": "bare.yaml"}],
        cameras=[{"type": "orbit", "object": "red cube", "width": 32, "height": 24}],
        formats=["webdataset"],
        clips={"train": 4},
    )
    made = make_dataset(load_job(path), tmp_path / "made", engine_of(1, None))
    reason = "bare.yaml: no object and no category 'red cube' in the scene"
    assert (made.frames, dict(made.skipped)) == (2 * 3, {reason: 2})
    assert f"{reason}: 2" in (tmp_path / "made" / "README.md").read_text()


def test_the_card_tells_what_is_there(small: Path) -> None:
    """Counts on the card are those of the annotations."""
    card = (small / "README.md").read_text()
    assert "42 frames (30 train, 12 val) in 4 shards" in card
    cubes = [
        one
        for split in ("train", "val")
        for one in json.loads((small / "coco" / split / "annotations.json").read_text())[
            "annotations"
        ]
        if one["instance_name"].endswith("cube")
    ]
    row = next(line for line in card.splitlines() if line.startswith("| cube |"))
    assert int(row.split("|")[2]) == len(cubes)
    assert cv2.imread(str(small / "pictures.jpg")) is not None


def test_what_is_drawn_at_random_differs_from_scene_to_scene(tmp_path: Path) -> None:
    """The same cube has another colour whenever its scene begins, and the same in both runs."""
    changes: dict[str, Any] = {
        "cameras": [{"type": "fixed", "position": [4, 0, 2], "look_at": [0, 0, 1.2]}],
        "clips": {"train": 4},
        "clip": {"frames": 1, "per_scene": 1},
        "formats": ["webdataset", "coco", "parquet"],
        "randomise": [
            {
                "name": "paint", "type": "material", "of": "red cube",
                "colour": {"uniform": [[0, 0, 0], [1, 1, 1]]},
            }
        ],
    }  # fmt: skip
    job = load_job(written_recipe(tmp_path, **changes))
    for name in ("one", "two"):
        make_dataset(job, tmp_path / name, engine_of(1, None))
    assert contents(tmp_path / "one") == contents(tmp_path / "two")
    with open_dataset(tmp_path / "one") as dataset:
        cube = next(one["id"] for one in dataset[0].objects if one["name"] == "red cube")
        colours = [one.frame["rgb"][one.frame["instance"] == cube].mean(axis=0) for one in dataset]
        records = {one.number: one.frame.randomised for one in dataset}
    assert np.abs(np.diff(colours, axis=0)).max(axis=1).min() > 5.0
    # Each format says what was drawn, so that a frame can be made again.
    assert all("red cube" in json.dumps(record) for record in records.values())
    coco = tmp_path / "one" / "coco" / "train" / "annotations.json"
    listed = json.loads(coco.read_text())["images"]
    assert {image["number"]: image["randomised"] for image in listed} == records
    rows = pq.read_table(tmp_path / "one" / "parquet" / "data").to_pylist()
    assert {row["number"]: json.loads(row["randomised"]) for row in rows} == records


@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # of pycocotools
def test_tar_files_have_the_amodal_masks_too(tmp_path: Path) -> None:
    """The same as COCO's, where a recipe asks for them; COCO's own tool decodes them."""
    changes: dict[str, Any] = {
        "clips": {"train": 1},
        "clip": {"frames": 1},
        "formats": ["webdataset", "coco"],
        "amodal": True,
    }
    make_dataset(
        load_job(written_recipe(tmp_path, **changes)), tmp_path / "made", engine_of(1, None)
    )
    coco = json.loads((tmp_path / "made" / "coco" / "train" / "annotations.json").read_text())
    masks = {
        (one["image_id"], one["instance_id"]): one["amodal_segmentation"]
        for one in coco["annotations"]
    }
    with open_dataset(tmp_path / "made") as dataset:
        seen = {(one.number, each["id"]): (one, each) for one in dataset for each in one.objects}
    assert {key: each["amodal_segmentation"] for key, (_, each) in seen.items()} == masks
    for one, each in seen.values():
        whole = coco_mask.decode(each["amodal_segmentation"]).astype(bool)
        assert whole.sum() == each["amodal_pixels"]
        assert not ((one.frame["instance"] == each["id"]) & ~whole).any()


def test_a_camera_of_the_scene_faces_what_it_does_there(tmp_path: Path) -> None:
    """An agent that keeps looking at an object that moves has it in the middle of each frame."""
    (tmp_path / "drift.yaml").write_text(
        "version: 1\ngravity: [0, 0, 0]\n"
        "objects: [{name: ball, asset: sphere, position: [3, 0, 1], gravity: false,"
        " velocity: [0, 2, 0]}]\n"
        "agents: [{name: eye, following: false, position: [0, 0, 1.5],"
        " keep_looking_at: {object: ball}}]\n",
        encoding="utf-8",
    )
    changes: dict[str, Any] = {
        "scenes": [{"scene": "drift.yaml"}],
        "cameras": [{"type": "agent", "width": 33, "height": 33}],
        "clips": {"train": 1},
        "formats": ["mcap"],
    }
    make_dataset(
        load_job(written_recipe(tmp_path, **changes)), tmp_path / "made", engine_of(1, None)
    )
    with open_dataset(tmp_path / "made") as dataset:
        frames = [one.frame for one in dataset]
    headings = []
    for frame in frames:
        assert frame.states is not None
        away = frame.states.positions[0] - frame.camera.pose.position_m
        axis = frame.camera.pose.matrix()[:3, 0]
        np.testing.assert_allclose(axis, away / np.linalg.norm(away), atol=1e-9)
        assert frame["instance"][16, 16] == 1
        headings.append(frame.camera.pose.rpy_deg[2])
    assert len(headings) == 3
    assert headings[0] < headings[1] < headings[2]
