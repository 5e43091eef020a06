"""`sailenv eval`: what a detector trained on photographs makes of the rooms' objects."""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path
from typing import Any

from sailenv_ros.cli.experiment import (
    add_common,
    checked_sizes,
    command_line,
    finish,
    progress_bar,
)

__all__ = ["add_parser", "run"]

REMARKS = {
    "nanodet": "Published NanoDets have 1 to 4 million weights and 20 to 34 % AP on COCO, the "
    "paper's Mask R-CNN with ResNet-50 has 44 million and about 38 %: a lower figure here says as "
    "much of the network as of the pictures.",
    "centernet": "CenterNet gives boxes alone.",
}


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "eval",
        help="show a detector the rooms' objects and score what it sees",
        description="The paper's experiment on photo-realism; see docs/experiments.md.",
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="EXPERIMENT")
    detection = actions.add_parser("detection", help="a COCO network on pictures of 14 classes")
    add_common(detection)
    detection.add_argument("--model", type=Path, required=True, metavar="FILE", help=".onnx")
    detection.add_argument(
        "--format", default="auto",
        help="nanodet, centernet, yolo, maskrcnn (torchvision's), maskrcnn-zoo (default: by its "
        "outputs)",
    )  # fmt: skip
    detection.add_argument(
        "--labels", choices=("auto", "coco80", "coco91"), default="auto", help="of Mask R-CNN"
    )
    detection.add_argument("--score", type=float, default=0.3, metavar="X", help="least score")
    detection.add_argument("--views", type=int, default=5, metavar="N", help="of each class")
    detection.add_argument("--seed", type=int, default=0, help="of the choice of viewpoints")
    detection.add_argument("--rooms", nargs="+", metavar="SCENE", help="default: the three rooms")
    detection.add_argument("--classes", nargs="+", metavar="NAME", help="default: the paper's 14")
    detection.add_argument(
        "--size", metavar="WxH", help="of the pictures (default: the network's input)"
    )


def run(args: argparse.Namespace) -> int:
    """Evaluate; 0 if all is well."""
    import numpy as np

    from sailenv_bench.experiments.coco_classes import PAPER_CLASSES
    from sailenv_bench.experiments.detector import Detector
    from sailenv_bench.experiments.machine import provenance
    from sailenv_bench.experiments.viewpoints import ROOMS, Rule, Stage, rule_as_data
    from sailenv_ros.errors import UnknownName
    from sailenv_ros.extras import need
    from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet

    classes = tuple(args.classes or PAPER_CLASSES)
    for name in classes:
        if name not in PAPER_CLASSES:
            raise UnknownName("class", name, PAPER_CLASSES)
    if not args.no_plots:
        need("matplotlib", "a plot (or --no-plots)")
    given = checked_sizes([args.size] if args.size else ())
    detector = Detector(args.model, args.format, labels=args.labels)
    width, height = given[0] if given else detector.size
    rule = Rule(viewpoints=2 if args.quick else args.views, seed=args.seed)
    rooms = tuple(args.rooms or ROOMS)
    origin = provenance(command_line())
    sheet: dict[str, Any] = {}
    measured = []
    with (
        Stage(rooms, width, height) as stage,
        progress_bar(len(classes) * rule.viewpoints) as tell,
    ):
        for name in classes:
            viewpoints = stage.viewpoints(name, rule, partial(tell, name))
            measured.append(
                _evaluated(name, viewpoints, stage.instances(name), detector, args, sheet)
            )
            for number in range(len(viewpoints) + 1, rule.viewpoints + 1):
                sheet[f"{name} {number}: no viewpoint"] = np.zeros((height, width, 3), np.uint8)
        renderer, baked = stage.description, stage.baked
    data = {
        "model": args.model.name,
        "format": detector.format,
        "score": args.score,
        "hit_iou": _hit_iou(),
        "picture": [width, height],
        "masks": any(entry["pixel_iou"][0] == entry["pixel_iou"][0] for entry in measured),
        "remarks": [REMARKS[detector.format]] if detector.format in REMARKS else [],
        "rule": rule_as_data(rule, rooms),
        "classes": measured,
        "overall": _overall(measured),
        "renderer": renderer,
        "baked": baked,
        "pictures": ["detection_views.jpg"] if sheet else [],
    }
    if sheet:
        args.output.mkdir(parents=True, exist_ok=True)
        path = args.output / "detection_views.jpg"
        save_contact_sheet(path, sheet, columns=rule.viewpoints, tile_width=168)
    finish(args, "detection", origin, data)
    return 0


def _evaluated(
    name: str,
    viewpoints: Any,
    instances: int,
    detector: Any,
    args: argparse.Namespace,
    sheet: dict[str, Any],
) -> dict[str, Any]:
    """Score a class's viewpoints, and put them on the sheet."""
    from sailenv_bench.experiments.detection import class_scores, scored, with_boxes

    results = []
    for number, viewpoint in enumerate(viewpoints, start=1):
        result = scored(viewpoint, detector.detect(viewpoint.picture), args.score)
        results.append(result)
        label = f"{name} {number}: {result.best_score:.2f}, IoU {result.box_iou:.2f}"
        sheet[label] = with_boxes(viewpoint, result)
    entry = class_scores(name, results, instances)
    entry["chosen"] = [
        {
            "room": viewpoint.room,
            "object": viewpoint.name,
            "eye_m": [round(value, 3) for value in viewpoint.eye_m],
            "azimuth_deg": round(viewpoint.azimuth_deg, 1),
            "distance_m": round(viewpoint.distance_m, 3),
            "cover": round(viewpoint.cover, 4),
            "visible": round(viewpoint.visible, 4),
        }
        for viewpoint in viewpoints
    ]
    return entry


def _hit_iou() -> float:
    from sailenv_bench.experiments.detection import HIT_IOU

    return HIT_IOU


def _overall(measured: list[dict[str, Any]]) -> dict[str, Any]:
    from sailenv_bench.experiments.detection import overall_scores

    return overall_scores(measured)
