"""Has detectors look for people in furnished rooms, and tells which share of them they find.

    sailenv dataset make benchmarks/judge_people.yaml -o set
    python -m benchmarks.judge_people set --model nanodet.onnx
    python -m benchmarks.judge_people set --pictures FOLDER     # for a detector of another kind
    node judge_people.mjs FOLDER found.json                     # such as CenterNet, see there
    python -m benchmarks.judge_people set --boxes found.json    # and what it found

One person counts in each view: the one that takes most pixels of those whose body lies in the
picture and is seen to 70 % or more. A box of a person that overlaps it by half is a hit.
`--pictures` writes PNG files; `--boxes` reads lists of [left, top, right, bottom, score] [px] by
their names.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from sailenv_bench.experiments.coco_classes import COCO_NAMES
from sailenv_bench.experiments.detection import HIT_IOU
from sailenv_bench.experiments.detections import box_iou
from sailenv_bench.experiments.detector import Detector
from sailenv_ros import dataset

VIEWS, LEAST_SEEN, LEAST_SCORE = 70, 0.7, 0.3

Boxes = NDArray[np.float64]
Finder = Callable[[str, NDArray[np.uint8]], Boxes]


class View(NamedTuple):
    """A picture with the box of the person in it [px]."""

    name: str
    asset: str
    picture: NDArray[np.uint8]
    box: Boxes


def views(folder: Path) -> Iterator[View]:
    """Yield the first views of a data set in which somebody is seen well enough."""
    found = 0
    for number, one in enumerate(dataset.open(folder)):
        height, width = one.frame["rgb"].shape[:2]
        seen = [o for o in one.objects if o["category"] == "person" and whole(o, width, height)]
        if not seen or found == VIEWS:
            continue
        found += 1
        most = max(seen, key=lambda o: o["visible_pixels"])
        left, top, right, bottom = most["box"]
        box = np.array([left, top, right + 1, bottom + 1], np.float64)
        yield View(f"{number:04d}.png", most["asset"], one.frame["rgb"], box)


def whole(person: Mapping[str, Any], width: int, height: int) -> bool:
    """Return whether somebody lies in the picture and is hardly hidden."""
    left, top, right, bottom = person["amodal_box"]
    within = left > 0 and top > 0 and right < width - 1 and bottom < height - 1
    return bool(within and person["visible_share"] >= LEAST_SEEN)


def by_model(path: Path) -> Finder:
    """Return what finds people by a network of COCO."""
    network, person = Detector(path), COCO_NAMES.index("person")
    return lambda _, picture: network.detect(picture).of_class(person, LEAST_SCORE).boxes


def by_file(path: Path) -> Finder:
    """Return what a file says was found."""
    told = json.loads(path.read_text())

    def find(name: str, _: NDArray[np.uint8]) -> Boxes:
        rows = np.array(told[name], np.float64).reshape(-1, 5)
        return rows[rows[:, 4] >= LEAST_SCORE, :4]

    return find


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    way = parser.add_mutually_exclusive_group(required=True)
    way.add_argument("--model", type=Path, help="an .onnx file that `sailenv eval` takes")
    way.add_argument("--boxes", type=Path, help="what another detector found")
    way.add_argument("--pictures", type=Path, help="folder to write the pictures to")
    given = parser.parse_args()
    if given.pictures is not None:
        given.pictures.mkdir(parents=True, exist_ok=True)
        for view in views(given.folder):
            cv2.imwrite(str(given.pictures / view.name), view.picture[..., ::-1])
        return
    find = by_model(given.model) if given.model is not None else by_file(given.boxes)
    overlaps = []
    for view in views(given.folder):
        boxes = find(view.name, view.picture)
        overlaps.append(float(box_iou(boxes, view.box).max()) if len(boxes) else 0.0)
        print(f"{view.name} {view.asset}: {overlaps[-1]:.2f}")
    hits = int((np.array(overlaps) >= HIT_IOU).sum())
    print(
        f"{hits} of {len(overlaps)} people found ({hits / len(overlaps):.0%}), "
        f"mean overlap {np.mean(overlaps):.2f}"
    )


if __name__ == "__main__":
    main()
