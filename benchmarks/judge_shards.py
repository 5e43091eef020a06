"""Has a data set by recipe read by the loaders that others wrote: counts agree, and so do values.

    sailenv dataset make benchmarks/judge_shards.yaml -o set
    python -m venv judges
    judges/bin/pip install webdataset datasets pillow pycocotools torch torchvision lerobot
    judges/bin/python benchmarks/judge_shards.py set

Needs neither sailenv_ros nor ROS. What is not installed is skipped, and said.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np


def judge_webdataset(folder: Path, manifest: dict[str, Any]) -> str:
    """Read all samples; remember depth for the others."""
    webdataset = importlib.import_module("webdataset")
    count = objects = 0
    for path in sorted((folder / "webdataset").glob("*.tar")):
        samples = webdataset.WebDataset(str(path), shardshuffle=False, empty_check=False)
        for sample in samples.decode("rgb8"):
            count += 1
            objects += len(sample["json"]["objects"])
            if "depth.npy" in sample:
                DEPTHS[sample["json"]["number"]] = np.asarray(sample["depth.npy"])
            PICTURES[sample["json"]["number"]] = np.asarray(sample["rgb.png"])
    assert count == manifest["frames"], (count, manifest["frames"])
    return f"{count} samples, {objects} objects"


def judge_datasets(folder: Path, manifest: dict[str, Any]) -> str:
    """Load all tables by Hugging Face's `datasets`, and compare pictures and depth."""
    datasets = importlib.import_module("datasets")
    files: dict[str, list[str]] = {}
    for path in sorted((folder / "parquet" / "data").glob("*.parquet")):
        files.setdefault(path.name.partition("-")[0], []).append(str(path))
    table = datasets.load_dataset("parquet", data_files=files)
    count = objects = 0
    for split in table.values():
        for row in split:
            count += 1
            objects += len(row["objects"])
            number = row["number"]
            if number in PICTURES:
                assert np.array_equal(np.asarray(row["rgb"]), PICTURES[number]), number
            if number in DEPTHS and "depth" in row:
                same = np.array_equal(np.float32(row["depth"]), DEPTHS[number], equal_nan=True)
                assert same, number
    assert count == manifest["frames"], (count, manifest["frames"])
    return f"{count} rows, {objects} objects, pictures and depth equal to WebDataset's"


def judge_lerobot(folder: Path, manifest: dict[str, Any]) -> str:
    """Load all episodes by LeRobot itself, and compare pictures and depth."""
    _import_torchvision()
    os.environ["HF_HUB_OFFLINE"] = "1"
    kind = importlib.import_module("lerobot.datasets.lerobot_dataset").LeRobotDataset
    loaded = kind("local/judged", root=folder / "lerobot")
    assert len(loaded) == manifest["frames"], (len(loaded), manifest["frames"])
    compared = 0
    for item in loaded:
        number = int(item["index"])
        if number in PICTURES:
            picture = np.rint(item["observation.images.camera"].numpy() * 255.0)
            assert np.array_equal(picture.transpose(1, 2, 0), PICTURES[number]), number
            compared += 1
        if number in DEPTHS and "observation.depth" in item:
            depth = item["observation.depth"].numpy()
            assert np.array_equal(depth, DEPTHS[number], equal_nan=True), number
    return f"{len(loaded)} frames in {loaded.num_episodes} episodes, {compared} compared"


def judge_pycocotools(folder: Path, manifest: dict[str, Any]) -> str:
    """Load the annotations of all splits and decode every mask."""
    coco = importlib.import_module("pycocotools.coco").COCO
    images = annotations = 0
    for path in sorted((folder / "coco").glob("*/annotations.json")):
        table = coco(str(path))
        images += len(table.getImgIds())
        for one in table.loadAnns(table.getAnnIds()):
            assert int(table.annToMask(one).sum()) == one["area"]
            annotations += 1
    assert images == manifest["frames"], (images, manifest["frames"])
    assert annotations == manifest["written"]["coco"]["annotations"]
    return f"{images} images, {annotations} masks of the areas that are told"


def _import_torchvision() -> None:
    """Import torchvision, which LeRobot does; also one that is made for PyTorch with CUDA.

    Such a one cannot load its operators beside a PyTorch without, and then misses two by their
    names. LeRobot needs none of them here.
    """
    torch = importlib.import_module("torch")
    try:
        importlib.import_module("torchvision")
    except RuntimeError:
        for name in [name for name in sys.modules if name.startswith("torchvision")]:
            del sys.modules[name]
        OPERATORS.append(torch.library.Library("torchvision", "DEF"))
        for name in ("nms", "qnms"):
            arguments = "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor"
            OPERATORS[-1].define(name + arguments)
        importlib.import_module("torchvision")


OPERATORS: list[Any] = []
DEPTHS: dict[int, Any] = {}
PICTURES: dict[int, Any] = {}

JUDGES: dict[str, Callable[[Path, dict[str, Any]], str]] = {
    "webdataset": judge_webdataset,
    "parquet": judge_datasets,
    "lerobot": judge_lerobot,
    "coco": judge_pycocotools,
}


def main() -> None:
    """Judge each format that the data set has."""
    folder = Path(sys.argv[1])
    manifest = json.loads((folder / "manifest.json").read_text())
    for name, judge in JUDGES.items():
        if not (folder / name).is_dir():
            continue
        try:
            print(f"{name}: {judge(folder, manifest)}", flush=True)
        except ImportError as problem:
            print(f"{name}: passed over: {problem}", flush=True)


if __name__ == "__main__":
    main()
