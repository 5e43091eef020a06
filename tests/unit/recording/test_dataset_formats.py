"""Data sets of objects, read back: COCO, BOP, MOT, YOLO, Pascal VOC. Each number by arithmetic."""

from __future__ import annotations

import configparser
import contextlib
import io
import json
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import cv2
import numpy as np
import pytest
import trimesh
import yaml
from pycocotools import mask as coco_mask
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

from sailenv_ros.dataset.formats import DatasetWriter, Splits, export
from sailenv_ros.dataset.formats.annotation_rules import AnnotationRules
from sailenv_ros.dataset.formats.bop import DEPTH_STEP_MM
from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.recording.lockstep import record_lockstep
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from tests.support.recordings import noise_frame

pytestmark = pytest.mark.ros

SCENE = """
version: 1
objects:
  - {name: ground, asset: plane, static: true, category: floor}
  - {name: near, asset: cube, position: [2.5, 0.3, 0.5], rotation: [0, 0, 30], static: true}
  - {name: far, asset: cube, position: [5, -0.2, 0.5], scale: 1.5, static: true}
  - {name: can, asset: cylinder, position: [3.5, -1.3, 0.5], static: true}
  - {name: ball, asset: sphere, position: [3, 1.5, 3], part_of: near}
  - {name: behind, asset: cube, position: [-3, 0, 0.5], static: true}
"""
VIEWS = ("rgb", "depth", "category", "instance", "flow")
COUNT = 3


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Frame]]:
    """Frames of solids, and the same ones recorded with their amodal masks."""
    folder = tmp_path_factory.mktemp("solids")
    (folder / "solids.yaml").write_text(SCENE)
    spec = AgentSpec(
        name="eye", intrinsics=CameraIntrinsics(width=120, height=90), views=VIEWS, rate_hz=30.0
    )
    frames = []
    with Simulation(folder / "solids.yaml", mode="lockstep", agent=spec) as simulation:
        simulation.set_position((0.0, 0.0, 1.0))
        with RecordingWriter(folder / "bag") as writer:
            record_lockstep(simulation, writer, frames=COUNT, agents=["eye"], amodal=True)
    with Simulation(folder / "solids.yaml", mode="lockstep", agent=spec) as simulation:
        simulation.set_position((0.0, 0.0, 1.0))
        for number in range(COUNT):
            if number:
                simulation.step(8)
            frame = simulation.capture(agent="eye")
            assert len(frame.amodal) == 6
            frames.append(frame)
    return folder / "bag", frames


def boxes_of(frame: Frame) -> dict[int, tuple[list[int], int]]:
    """Return the box of each visible object with its number of pixels, by a plain loop."""
    found = {}
    for id_ in np.unique(frame["instance"][frame["instance"] > 0]).tolist():
        rows, columns = np.nonzero(frame["instance"] == id_)
        box = [int(columns.min()), int(rows.min()), int(columns.max()), int(rows.max())]
        found[id_] = (box, len(rows))
    return found


def written(folder: Path, formats: list[str], frames: list[Frame], **options: Any) -> DatasetWriter:
    """Write a whole data set; return its writer."""
    with DatasetWriter(folder, formats, **options) as writer:
        for frame in frames:
            writer.add(frame)
    return writer


def test_a_recording_gives_the_data_set_of_live_frames(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Each file but the summary, which names the source, is the same."""
    bag, frames = made
    formats = ["coco", "bop", "mot", "yolo", "yolo_segments", "voc"]
    export(bag, tmp_path / "recorded", formats)
    written(tmp_path / "live", formats, frames)
    files = [path for path in (tmp_path / "live").rglob("*") if path.is_file()]
    assert len(files) > 50
    differing = []
    for path in files:
        name = path.relative_to(tmp_path / "live")
        other = tmp_path / "recorded" / name
        # Stamps of frames and poses are there to rounding alone.
        rounded = path.name in ("export.json", "annotations.json", "scene_gt.json")
        if not rounded and path.read_bytes() != other.read_bytes():
            differing.append(str(name))
    assert differing == []


# pycocotools' own, with NumPy 2.
@pytest.mark.filterwarnings("ignore:__array__ implementation doesn't accept:DeprecationWarning")
def test_coco_evaluates_ground_truth_as_perfect(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """AP is 1 for boxes and masks; amodal masks, shares and foreign names are there."""
    _, frames = made
    writer = written(tmp_path, ["coco"], frames)
    summary = writer.finish().formats["coco"]
    assert summary.left_out == {"no pixel is visible": COUNT}
    with contextlib.redirect_stdout(io.StringIO()):
        coco = COCO(str(tmp_path / "annotations.json"))
        found = [{**a, "score": 1.0} for a in coco.loadAnns(coco.getAnnIds())]
        for kind in ("bbox", "segm"):
            judged = COCOeval(coco, coco.loadRes(found), kind)
            judged.evaluate()
            judged.accumulate()
            # Of objects of all sizes, with as many detections as there are.
            precision = judged.eval["precision"][:, :, :, 0, -1]
            assert precision[precision > -1].min() == 1.0
    for number, frame in enumerate(frames):
        table = frame.objects_with_amodal
        for annotation in coco.loadAnns(coco.getAnnIds(imgIds=[number])):
            id_ = annotation["instance_id"]
            row = table.row(id_)
            amodal = coco_mask.decode(annotation["amodal_segmentation"]).astype(bool)
            assert (amodal == frame.amodal.mask(id_)).all()
            assert annotation["parent_id"] == table.parents[row]
            assert annotation["amodal_area"] == amodal.sum()
            assert annotation["occlusion"] == 1.0 - table.visible_share[row]
            assert min(annotation["bbox"][2:]) > 0
    names = {c["name"]: c for c in coco.loadCats(coco.getCatIds())}
    assert (names["couch"]["coco"], names["couch"]["nyu40"]) == ("couch", "sofa")


def test_bop_files_hold_poses_masks_and_models(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """In millimetres; a scaled object is a model of its own; symmetries are those of the solids."""
    _, frames = made
    written(tmp_path, ["bop"], frames)
    epoch = frames[0].epoch
    scene = tmp_path / "train" / f"{epoch:06d}"
    truths, infos, cameras = (
        json.loads((scene / f"scene_{name}.json").read_text())
        for name in ("gt", "gt_info", "camera")
    )
    names = json.loads((tmp_path / "models" / "names.json").read_text())
    info = json.loads((tmp_path / "models" / "models_info.json").read_text())
    by_name = {(n["asset"], n["scale"][0]): number for number, n in names.items()}
    assert {("cube", 1.0), ("cube", 1.5), ("cylinder", 1.0), ("sphere", 1.0)} <= set(by_name)
    cube, large = info[by_name["cube", 1.0]], info[by_name["cube", 1.5]]
    assert cube["diameter"] == pytest.approx(1000.0 * np.sqrt(3.0), rel=1e-6)
    assert large["size_x"] == pytest.approx(1500.0)
    assert len(cube["symmetries_discrete"]) == 9
    assert len(info[by_name["sphere", 1.0]]["symmetries_continuous"]) == 3
    assert [s["axis"] for s in info[by_name["cylinder", 1.0]]["symmetries_continuous"]] == [
        [0.0, 0.0, 1.0]
    ]
    mesh = trimesh.load(tmp_path / "models" / f"obj_{int(by_name['cube', 1.5]):06d}.ply")
    np.testing.assert_allclose(mesh.extents, 1500.0, rtol=1e-6)
    for number, frame in enumerate(frames):
        table = frame.objects_with_amodal
        image = str(number)
        assert cameras[image]["cam_K"] == frame.camera.intrinsics.K.reshape(-1).tolist()
        depth = cv2.imread(str(scene / "depth" / f"{number:06d}.png"), cv2.IMREAD_UNCHANGED)
        there = np.isfinite(frame["depth"]) & (frame["depth"] < 13.0)
        error = depth[there] * DEPTH_STEP_MM - 1000.0 * frame["depth"][there]
        assert np.abs(error).max() <= 0.5 * DEPTH_STEP_MM + 1e-3
        for place, (truth, about) in enumerate(zip(truths[image], infos[image], strict=True)):
            row = table.row(truth["instance_id"])
            assert truth["parent_id"] == table.parents[row]
            rotation = np.array(truth["cam_R_m2c"]).reshape(3, 3)
            np.testing.assert_allclose(rotation, table.camera_from_object[row, :3, :3])
            centre = np.array(truth["cam_t_m2c"]) / 1000.0
            np.testing.assert_allclose(centre, table.camera_from_object[row, :3, 3])
            assert about["visib_fract"] == table.visible_pixels[row] / table.whole_pixels[row]
            for kind, mask in (
                ("mask", frame.amodal.mask(truth["instance_id"])),
                ("mask_visib", frame["instance"] == truth["instance_id"]),
            ):
                path = scene / kind / f"{number:06d}_{place:06d}.png"
                assert ((cv2.imread(str(path), cv2.IMREAD_UNCHANGED) > 0) == mask).all()


def test_mot_lines_are_boxes_of_whole_objects(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Frames and pixels count from 1, and the last column is the visible share."""
    _, frames = made
    written(tmp_path, ["mot"], frames)
    lines = np.loadtxt(tmp_path / "gt" / "gt.txt", delimiter=",")
    seen = [len(boxes_of(frame)) for frame in frames]
    assert [int((lines[:, 0] == n + 1).sum()) for n in range(COUNT)] == seen
    for line in lines:
        frame = frames[int(line[0]) - 1]
        table = frame.objects_with_amodal
        row = table.row(int(line[1]))
        left, top, right, bottom = table.amodal_boxes[row].tolist()
        assert line[2:6].tolist() == [left + 1, top + 1, right - left + 1, bottom - top + 1]
        assert line[6:8].tolist() == [1, table.category_ids[row]]
        assert line[8] == pytest.approx(table.visible_share[row], abs=1e-5)
    about = configparser.ConfigParser()
    about.read(tmp_path / "seqinfo.ini")
    assert about["Sequence"]["seqLength"] == str(COUNT)
    assert float(about["Sequence"]["frameRate"]) == pytest.approx(30.0)


def test_yolo_boxes_and_outlines_are_those_of_the_pixels(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Boxes give whole pixels back; filled outlines cover the object's pixels and no other."""
    _, frames = made
    splits = Splits((0.5, 0.5), seed=1)
    written(tmp_path, ["yolo", "yolo_segments"], frames, splits=splits)
    table = yaml.safe_load((tmp_path / "yolo" / "data.yaml").read_text())
    assert table["names"][0] == "cube"
    for number, frame in enumerate(frames):
        split = splits.of_frame(number)
        height, width = frame["instance"].shape
        text = (tmp_path / "yolo" / "labels" / split / f"{number:06d}.txt").read_text()
        rows = np.array([line.split() for line in text.splitlines()], float)
        expected = sorted(boxes_of(frame).values())
        corners = rows[:, 1:] * (width, height, width, height)
        low = corners[:, :2] - 0.5 * corners[:, 2:]
        high = corners[:, :2] + 0.5 * corners[:, 2:] - 1.0
        got = sorted(np.concatenate([low, high], axis=1).round(2).tolist())
        np.testing.assert_allclose(got, [box for box, _ in expected], atol=0.01)
        path = tmp_path / "yolo_segments" / "labels" / split / f"{number:06d}.txt"
        drawn = np.zeros((height, width), bool)
        for line in path.read_text().splitlines():
            points = np.array(line.split()[1:], float).reshape(-1, 2) * (width, height)
            # Centres of pixels lie within the outline.
            v, u = np.mgrid[:height, :width] + 0.5
            inside = [
                cv2.pointPolygonTest(points.astype(np.float32), (float(x), float(y)), False) > 0
                for x, y in zip(u.ravel(), v.ravel(), strict=True)
            ]
            drawn |= np.reshape(inside, (height, width))
        assert (drawn == (frame["instance"] > 0)).all()


def test_voc_files_count_pixels_from_one(made: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """Boxes, flags and masks of each object; the lists name the pictures."""
    _, frames = made
    written(tmp_path, ["voc"], frames)
    edges = ("xmin", "ymin", "xmax", "ymax")
    for number, frame in enumerate(frames):
        root = ElementTree.parse(tmp_path / "Annotations" / f"{number:06d}.xml").getroot()
        boxes = [
            [int(entry.findtext(f"bndbox/{edge}") or 0) - 1 for edge in edges]
            for entry in root.iter("object")
        ]  # fmt: skip
        assert sorted(boxes) == sorted(box for box, _ in boxes_of(frame).values())
        path = tmp_path / "SegmentationObject" / f"{number:06d}.png"
        numbers = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        for place, box in enumerate(boxes, 1):
            rows, columns = np.nonzero(numbers == place)
            assert [columns.min(), rows.min(), columns.max(), rows.max()] == box
    listed = (tmp_path / "ImageSets" / "Main" / "trainval.txt").read_text().split()
    assert listed == [f"{number:06d}" for number in range(COUNT)]


def test_bop_needs_poses_and_amodal_masks(tmp_path: Path) -> None:
    """What lacks them is refused with what to do."""
    writer = DatasetWriter(tmp_path, ["bop"])
    with pytest.raises(RecordingError, match="record with --amodal"):
        writer.add(noise_frame(1))


def test_small_objects_and_other_categories_are_left_out(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    """Of COCO, YOLO and Pascal VOC alike, counted by the reason; categories go with them."""
    bag, frames = made
    table = frames[0].objects
    cubes = [
        row for row in range(len(table)) if table.categories[row] == "cube" and table.visible[row]
    ]
    sizes = sorted(int(table.visible_pixels[row]) for row in cubes)
    assert len(sizes) > 1
    rules = AnnotationRules(least_pixels=sizes[-1], categories=("cube",))
    summary = export(bag, tmp_path, ["coco", "yolo", "voc"], rules=rules)
    told = json.loads((tmp_path / "coco" / "annotations.json").read_text())
    assert [one["name"] for one in told["categories"]] == ["cube"]
    assert [one["area"] for one in told["annotations"]] == [sizes[-1]] * COUNT
    assert len((tmp_path / "yolo" / "labels" / "train" / "000000.txt").read_text().split("\n")) == 2
    entry = ElementTree.parse(tmp_path / "voc" / "Annotations" / "000000.xml")
    assert [one.findtext("name") for one in entry.iter("object")] == ["cube"]
    others = sum(
        bool(seen) and name != "cube"
        for seen, name in zip(table.visible, table.categories, strict=True)
    )
    for one in summary.formats.values():
        assert one.left_out["other category"] == others * COUNT
        assert one.left_out[f"fewer than {sizes[-1]} pixels"] == (len(sizes) - 1) * COUNT


def test_stuff_is_one_segment_and_no_object(made: tuple[Path, list[Frame]], tmp_path: Path) -> None:
    """COCO's panoptic pictures: each pixel is of a thing, of stuff or of nothing."""
    bag, frames = made
    export(bag, tmp_path, ["coco"], rules=AnnotationRules(stuff=("floor", "sphere")))
    instances = json.loads((tmp_path / "annotations.json").read_text())
    panoptic = json.loads((tmp_path / "panoptic.json").read_text())
    kinds = {one["name"]: one["isthing"] for one in panoptic["categories"]}
    assert kinds["floor"] == kinds["sphere"] == 0
    assert kinds["cube"] == kinds["cylinder"] == 1
    names = {one["id"]: one["name"] for one in panoptic["categories"]}
    assert {"floor", "sphere"}.isdisjoint(one["name"] for one in instances["categories"])
    for frame, told in zip(frames, panoptic["annotations"], strict=True):
        picture = cv2.imread(str(tmp_path / "panoptic" / told["file_name"]))
        assert picture is not None
        ids = picture[..., ::-1].astype(np.int64) @ (1, 256, 65536)
        assert {one["id"] for one in told["segments_info"]} == set(np.unique(ids)) - {0}
        for one in told["segments_info"]:
            mask = ids == one["id"]
            assert one["area"] == mask.sum()
            left, top, width, height = one["bbox"]
            assert mask[top : top + height, left : left + width].sum() == one["area"]
            seen = {frame.info.categories[c].name for c in np.unique(frame["category"][mask])}
            assert seen == {names[one["category_id"]]}
        things = [one for one in told["segments_info"] if kinds[names[one["category_id"]]]]
        own = [one for one in instances["annotations"] if one["image_id"] == told["image_id"]]
        assert sorted(one["id"] for one in things) == sorted(one["instance_id"] for one in own)
        assert ((ids == 0) == (frame["instance"] == 0)).all()


def test_without_stuff_there_is_nothing_panoptic(
    made: tuple[Path, list[Frame]], tmp_path: Path
) -> None:
    export(made[0], tmp_path, ["coco"])
    assert not (tmp_path / "panoptic.json").exists()


def test_rules_that_make_no_sense_are_refused() -> None:
    for settings in ({"least_pixels": 0}, {"categories": ("cube",), "stuff": ("cube",)}):
        with pytest.raises(InvalidRequest):
            AnnotationRules(**settings)
