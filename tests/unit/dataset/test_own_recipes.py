"""The package's recipes: each is made in its smallest form and read by the loaders of others."""

from __future__ import annotations

import io
import json
import tarfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import trimesh
import yaml
import zstandard
from pycocotools.coco import COCO

from sailenv_ros.dataset import engine_of, load_job, load_recipe, make_dataset
from sailenv_ros.system.resources import resource_path

RECIPES = sorted(resource_path("config", "recipes").glob("*.yaml"))


def smallest(recipe: dict[str, Any]) -> dict[str, Any]:
    """Return a recipe with few and small frames, without bounced light."""
    clip = {**recipe.get("clip", {}), "frames": min(3, recipe.get("clip", {}).get("frames", 1))}
    cameras = [{**one, "width": 96, "height": 72} for one in recipe["cameras"]]
    return {
        **recipe,
        "clips": {"train": 2},
        "clip": clip,
        "cameras": cameras,
        "light": "plain",
        "scenes": recipe["scenes"][:1],
    }


def detection(folder: Path) -> None:
    """COCO's own reader decodes visible and amodal masks, and the one contains the other."""
    table = json.loads((folder / "coco" / "train" / "annotations.json").read_text())
    coco = COCO(str(folder / "coco" / "train" / "annotations.json"))
    assert len(coco.getImgIds()) == 2
    assert coco.getAnnIds()
    for annotation in table["annotations"]:
        seen = coco.annToMask(annotation).astype(bool)
        whole = coco.annToMask({**annotation, "segmentation": annotation["amodal_segmentation"]})
        assert seen.sum() == annotation["area"] > 0
        assert not (seen & ~whole.astype(bool)).any()


def pose(folder: Path) -> None:
    """Projected models of BOP's poses lie in the boxes that the truth gives for them."""
    root = folder / "bop"
    models = {
        int(path.stem[4:]): np.asarray(trimesh.load_mesh(path, process=False).vertices)
        for path in (root / "models").glob("obj_*.ply")
    }
    scenes = sorted((root / "train").iterdir())
    gaps: list[float] = []
    for scene in scenes:
        cameras = json.loads((scene / "scene_camera.json").read_text())
        infos = json.loads((scene / "scene_gt_info.json").read_text())
        for image, truths in json.loads((scene / "scene_gt.json").read_text()).items():
            k = np.reshape(cameras[image]["cam_K"], (3, 3))
            assert (scene / "rgb" / f"{int(image):06d}.png").is_file()
            for truth, info in zip(truths, infos[image], strict=True):
                turn = np.reshape(truth["cam_R_m2c"], (3, 3))
                points = models[truth["obj_id"]] @ turn.T + truth["cam_t_m2c"]
                if (points[:, 2] <= 10.0).any() or min(info["bbox_obj"][2:]) < 3:
                    continue
                pixels = points @ k.T
                pixels = pixels[:, :2] / pixels[:, 2:]
                left, top, width, height = info["bbox_obj"]
                # A canvas of three pictures holds the whole of it.
                if left > -96 and top > -72 and left + width < 192 and top + height < 144:
                    low, high = pixels.min(axis=0), pixels.max(axis=0)
                    # Pixels have whole sides, and a tip may be thinner than one.
                    gaps += [left - low[0], top - low[1]]
                    gaps += [high[0] - left - width, high[1] - top - height]
    assert len(gaps) > 4 * 3
    assert min(gaps) > -1.0
    assert np.median(np.abs(gaps)) < 1.0


def flow(folder: Path) -> None:
    """OpenCV reads the fields; forward and backward undo each other where nothing is hidden."""
    compared = 0
    for path in sorted((folder / "sintel" / "train" / "flow").rglob("frame_0001.flo")):
        there = cv2.readOpticalFlow(str(path))
        back = cv2.readOpticalFlow(
            str(folder / "sintel" / "train" / "flow_backward" / path.parent.name / "frame_0002.flo")
        )
        hidden = cv2.imread(str(path).replace("/flow/", "/occlusions/")[:-4] + ".png", -1) > 0
        v, u = np.nonzero(~hidden & np.isfinite(there).all(axis=2))
        to = np.rint(there[v, u] + np.column_stack([u, v])).astype(int)
        inside = (to >= 0).all(axis=1) & (to[:, 0] < 96) & (to[:, 1] < 72)
        sums = there[v, u][inside] + back[to[inside][:, 1], to[inside][:, 0]]
        assert np.nanmedian(np.abs(sums)) < 0.2
        compared += 1
    assert compared == 2


def stream(folder: Path) -> None:
    """Readers that are not ours find every frame with all its views, once."""
    names: list[str] = []
    for path in sorted((folder / "webdataset").glob("*.tar")):
        with tarfile.open(path) as tar:
            for member in tar:
                names.append(member.name.partition(".")[2])
                file = tar.extractfile(member)
                assert file is not None
                if member.name.endswith(".npy.zst"):
                    plain = zstandard.ZstdDecompressor().decompress(file.read())
                    assert np.load(io.BytesIO(plain)).shape[:2] == (72, 96)
    endings = ("rgb.png", "depth.npy.zst", "category.png", "instance.png", "flow.npy.zst", "json")
    assert Counter(names) == dict.fromkeys(endings, 6)


CHECKS: dict[str, Callable[[Path], None]] = {
    "detection": detection, "pose": pose, "flow": flow, "stream": stream,
}  # fmt: skip


def test_every_recipe_has_a_check() -> None:
    assert {path.stem for path in RECIPES} == set(CHECKS)


@pytest.mark.timeout(400)
@pytest.mark.filterwarnings("ignore:__array__ implementation:DeprecationWarning")  # of pycocotools
@pytest.mark.parametrize("path", RECIPES, ids=lambda path: path.stem)
def test_a_recipe_is_made_and_read(path: Path, tmp_path: Path) -> None:
    """As it is it has no fault; its smallest form is what its format's loader takes."""
    load_recipe(path)
    small = tmp_path / path.name
    small.write_text(yaml.safe_dump(smallest(yaml.safe_load(path.read_text()))))
    made = make_dataset(load_job(small), tmp_path / "made", engine_of(1, None))
    assert not made.skipped
    CHECKS[path.stem](tmp_path / "made")
