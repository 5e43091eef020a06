"""Has data sets judged by the tools that others wrote for them: what they recompute, and how near.

    sailenv record -o walk --lockstep --frames 30 --scene room_01 --amodal
    sailenv export walk -o sets --format coco bop mot
    python -m venv judges
    judges/bin/pip install pycocotools motmetrics trimesh vispy PyOpenGL pypng pytz imageio
    PYTHONPATH=bop_toolkit judges/bin/python benchmarks/judge_data_sets.py sets

Needs neither sailenv_ros nor ROS. bop_toolkit (https://github.com/thodan/bop_toolkit) is used from
its folder; its renderer needs EGL. What is not installed is skipped, and said.
"""

from __future__ import annotations

import contextlib
import importlib
import io
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from bop_differences import Differences, project


def judge_coco(folder: Path) -> None:
    """Evaluate ground truth as detections: AP of boxes and masks, visible and amodal."""
    coco = importlib.import_module("pycocotools.coco").COCO
    evaluate = importlib.import_module("pycocotools.cocoeval").COCOeval
    table = json.loads((folder / "annotations.json").read_text())
    for what in ("visible", "amodal"):
        if what == "amodal":
            if not all("amodal_segmentation" in a for a in table["annotations"]):
                continue
            for annotation in table["annotations"]:
                annotation["segmentation"] = annotation["amodal_segmentation"]
                annotation["bbox"] = annotation["amodal_bbox"]
                annotation["area"] = annotation["amodal_area"]
        detections = [{**a, "score": 1.0} for a in table["annotations"]]
        for kind in ("bbox", "segm"):
            with contextlib.redirect_stdout(io.StringIO()):
                truth = coco()
                truth.dataset = table
                truth.createIndex()
                judged = evaluate(truth, truth.loadRes(detections), kind)
                judged.params.maxDets = [1, 10, 1000]
                judged.evaluate()
                judged.accumulate()
            precision = judged.eval["precision"][:, :, :, 0, -1]
            print(f"pycocotools: AP of {what} {kind} {precision[precision > -1].mean():.6f}")


def judge_mot(folder: Path) -> None:
    """Track with the ground truth itself."""
    metrics = importlib.import_module("motmetrics")
    if not hasattr(np, "asfarray"):  # which motmetrics 1.4 calls and NumPy 2 lacks
        setattr(np, "asfarray", lambda values: np.asarray(values, np.float64))  # noqa: B010
    truth = metrics.io.loadtxt(str(folder / "gt" / "gt.txt"), fmt="mot15-2D", min_confidence=1)
    judged = metrics.utils.compare_to_groundtruth(truth, truth, "iou", distth=0.5)
    summary = metrics.metrics.create().compute(
        judged, metrics=["mota", "motp", "idf1", "num_switches"], name="truth"
    )
    print("motmetrics:", summary.loc["truth"].to_dict())


def judge_bop(folder: Path) -> None:
    """Recompute masks and visible shares from depth, models and poses; score poses against them."""
    inout, misc, pose_error, visibility = (
        importlib.import_module(f"bop_toolkit_lib.{name}")
        for name in ("inout", "misc", "pose_error", "visibility")
    )
    renderer = importlib.import_module("bop_toolkit_lib.rendering.renderer")
    size = json.loads((folder / "camera.json").read_text())
    width, height = size["width"], size["height"]
    drawn = renderer.create_renderer(3 * width, 3 * height, "vispy", mode="depth")
    models = inout.load_json(str(folder / "models_eval" / "models_info.json"), keys_to_int=True)
    for number in models:
        drawn.add_object(number, str(folder / "models_eval" / f"obj_{number:06d}.ply"))
    shares: dict[int, list[float]] = {15: [], 2: []}
    differing = {tolerance_mm: Differences() for tolerance_mm in shares}
    meshes = {n: inout.load_ply(str(folder / "models_eval" / f"obj_{n:06d}.ply")) for n in models}
    masks, poses = [], []
    for scene in sorted((folder / "train").iterdir()):
        cameras = inout.load_scene_camera(str(scene / "scene_camera.json"))
        truths = inout.load_scene_gt(str(scene / "scene_gt.json"))
        infos = inout.load_json(str(scene / "scene_gt_info.json"), keys_to_int=True)
        for image, objects in truths.items():
            k = cameras[image]["cam_K"]
            depth = inout.load_depth(str(scene / "depth" / f"{image:06d}.png"))
            seen = misc.depth_im_to_dist_im_fast(depth * cameras[image]["depth_scale"], k)
            for place, truth in enumerate(objects):
                # Its renderer has the centre of the first pixel at (0.5, 0.5), K at (0, 0).
                large = drawn.render_object(
                    *(truth["obj_id"], truth["cam_R_m2c"], truth["cam_t_m2c"]),
                    *(k[0, 0], k[1, 1], k[0, 2] + width + 0.5, k[1, 2] + height + 0.5),
                )["depth"]
                own = misc.depth_im_to_dist_im_fast(
                    large[height : 2 * height, width : 2 * width], k
                )
                # Its own tolerance is 15 mm, made for depth cameras; rendered depth needs less.
                whole = int((large > 0).sum())
                name = f"{image:06d}_{place:06d}.png"
                stored = {
                    kind: inout.load_im(str(scene / kind / name)) > 0
                    for kind in ("mask", "mask_visib")
                }
                mesh = meshes[truth["obj_id"]]
                flat = project(mesh["pts"], truth["cam_R_m2c"], truth["cam_t_m2c"], k)
                corners = flat[mesh["faces"].astype(int)]
                edges = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2, 2)
                for tolerance_mm, found in shares.items():
                    visible = visibility.estimate_visib_mask_gt(
                        seen, own, tolerance_mm, visib_mode="bop19"
                    )
                    if whole:
                        share = infos[image][place]["visib_fract"]
                        found.append(abs(visible.sum() / whole - share))
                        differing[tolerance_mm].add(
                            share=found[-1],
                            stored_visible=stored["mask_visib"],
                            visible=visible,
                            stored_mask=stored["mask"],
                            own=own,
                            seen=seen,
                            tolerance_mm=tolerance_mm,
                            edges=edges,
                            whole=(whole, infos[image][place]["px_count_all"]),
                        )
                for kind, mask in (("mask", own > 0), ("mask_visib", visible)):
                    both = (stored[kind] | mask).sum()
                    if both:
                        masks.append((kind, (stored[kind] & mask).sum() / both, int(both)))
                points = mesh["pts"]
                pose = (truth["cam_R_m2c"], truth["cam_t_m2c"])
                poses.append(
                    max(
                        pose_error.add(*pose, *pose, points),
                        pose_error.re(pose[0], pose[0]),
                        pose_error.te(pose[1], pose[1]),
                    )
                )
    for tolerance_mm, errors in shares.items():
        print(
            f"bop_toolkit: {len(errors)} objects, tolerance {tolerance_mm} mm; visible share "
            f"differs by {np.mean(errors):.5f} on average, {np.percentile(errors, 95):.5f} at 95 %"
            f", {max(errors):.5f} at most"
        )
        print(differing[tolerance_mm].told(tolerance_mm))
    for kind in ("mask", "mask_visib"):
        ious = [(iou, pixels) for name, iou, pixels in masks if name == kind]
        large_ones = [iou for iou, pixels in ious if pixels >= 1000]
        print(
            f"bop_toolkit: IoU of {kind}: {np.mean([iou for iou, _ in ious]):.4f} on average; of "
            f"those with 1000 px and more {np.min(large_ones):.4f} at least"
        )
    print(f"bop_toolkit: error of ground truth as an estimate {max(poses):.3g} [mm, deg]")


def judge_cloud(file: Path) -> None:
    """Read a point cloud."""
    cloud = importlib.import_module("trimesh").load(file)
    points, colours = np.asarray(cloud.vertices), np.asarray(cloud.colors)
    box = f"{points.min(axis=0).round(3)} to {points.max(axis=0).round(3)}"
    print(f"trimesh: {len(points)} points from {box} [m], {len(colours)} colours")


JUDGES: dict[str, Callable[[Path], Any]] = {
    "coco": judge_coco,
    "mot": judge_mot,
    "bop": judge_bop,
    "cloud.ply": judge_cloud,
}


def main(folder: Path) -> None:
    """Judge what there is in a folder."""
    for name, judge in JUDGES.items():
        if not (folder / name).exists():
            continue
        try:
            judge(folder / name)
        except ImportError as problem:
            print(f"{name} is not judged: {problem}")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
