#!/usr/bin/env python3
"""Shows a COCO detector the rooms' objects and says which classes it names.

A tool for who changes objects or rooms: five views of each class, where its objects stand, chosen
by what is visible. Needs onnxruntime, and the path of a NanoDet model exported to ONNX (416 × 416,
80 classes of COCO).

    python scripts/eval_catalogue.py nanodet.onnx [--sheet pictures.png]
"""

from __future__ import annotations

import argparse
import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from sailenv_ros.agents import AgentSpec
from sailenv_ros.camera import CameraIntrinsics
from sailenv_ros.frame import Frame
from sailenv_ros.geometry import look_at
from sailenv_ros.pictures.contact_sheet import save_contact_sheet
from sailenv_ros.simulation.simulation import Simulation

CLASSES = {
    "airplane": 4,
    "tennis racket": 38,
    "fork": 42,
    "spoon": 44,
    "chair": 56,
    "couch": 57,
    "potted plant": 58,
    "bed": 59,
    "dining table": 60,
    "toilet": 61,
    "tv": 62,
    "laptop": 63,
    "remote": 65,
    "book": 73,
}
"""Place of each class among COCO's 80 names."""

ROOMS = ("room_01", "room_02", "room_03")
AZIMUTHS_DEG = range(0, 360, 30)
ELEVATIONS_DEG = (15.0, 35.0, 60.0)
SIZES = (1.1, 1.8)
"""Distances, in sizes of the object divided by the tangent of the angle of view."""

VISIBLE = (0.02, 0.6)
"""Share of the picture that an object may cover."""

MEAN, DEVIATION = (103.53, 116.28, 123.675), (57.375, 57.12, 58.395)


def main() -> int:
    """Print one line for each class, and how many of them were named."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("model", type=Path)
    parser.add_argument("--threshold", type=float, default=0.3)
    parser.add_argument("--views", type=int, default=5)
    parser.add_argument("--sheet", type=Path)
    args = parser.parse_args()
    import onnxruntime

    session = onnxruntime.InferenceSession(str(args.model), providers=["CPUExecutionProvider"])
    views: dict[str, list[np.ndarray]] = {category: [] for category in CLASSES}
    for room in ROOMS:
        for category, pictures in _views_of(room, args.views):
            views[category].extend(pictures)
    named, sheet = 0, {}
    for category, pictures in views.items():
        chosen = pictures[:: max(1, len(pictures) // args.views)][: args.views]
        scores = [float(_scores(session, p)[CLASSES[category]]) for p in chosen]
        named += max(scores, default=0.0) >= args.threshold
        hits = sum(score >= args.threshold for score in scores)
        print(f"{category:<14} named in {hits} of {len(scores)}, scores {np.round(scores, 2)}")
        for number, picture in enumerate(chosen):
            sheet[f"{category} {number} {scores[number]:.2f}"] = picture
    print(f"{named} of {len(CLASSES)} classes named at a score of {args.threshold:g}")
    if args.sheet:
        print(save_contact_sheet(args.sheet, sheet, columns=args.views, tile_width=208))
    return 0


def _views_of(room: str, count: int) -> Iterator[tuple[str, list[np.ndarray]]]:
    """Yield pictures of each object of the classes, of those views that show most of it."""
    lens = CameraIntrinsics(width=416, height=416, vertical_fov_deg=50.0)
    with Simulation(scene=room, mode="lockstep") as simulation:
        simulation.register_agent(
            AgentSpec(name="eye", intrinsics=lens, rate_hz=0.0, following=False)
        )
        simulation.step(480)
        for instance in simulation.info.instances:
            if instance.category in CLASSES:
                yield instance.category, _pictures(simulation, instance.id, count)


def _pictures(simulation: Simulation, instance_id: int, count: int) -> list[np.ndarray]:
    state = simulation.get_object(instance_id)
    middle = (state.pose.matrix() @ [0.0, 0.0, state.size_m[2] / 2.0, 1.0])[:3]
    size = float(np.linalg.norm(state.size_m))
    shown: list[tuple[int, np.ndarray]] = []
    for azimuth, elevation, factor in itertools.product(AZIMUTHS_DEG, ELEVATIONS_DEG, SIZES):
        a, e = np.radians(azimuth), np.radians(elevation)
        towards = np.array([np.cos(a) * np.cos(e), np.sin(a) * np.cos(e), np.sin(e)])
        eye = middle + towards * max(0.25, factor * size)
        simulation.set_pose("eye", look_at(eye, middle), teleport=True)
        frame: Frame = simulation.capture("eye", ("rgb", "instance"))
        pixels = int((frame.views["instance"] == instance_id).sum())
        if VISIBLE[0] * 416**2 <= pixels <= VISIBLE[1] * 416**2:
            shown.append((pixels, np.asarray(frame.views["rgb"])))
    shown.sort(key=lambda entry: -entry[0])
    return [picture for _, picture in shown[: 2 * count]]


def _scores(session: Any, rgb: np.ndarray) -> np.ndarray:
    """Give the best score of each of the 80 classes, wherever in the picture."""
    bgr = cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR).astype(np.float32)
    blob = ((bgr - MEAN) / DEVIATION).transpose(2, 0, 1)[None].astype(np.float32)
    outputs = session.run(None, {session.get_inputs()[0].name: blob})
    scores = [output[0] for output in outputs if output.shape[-1] == 80]
    return np.concatenate(scores).max(axis=0)


if __name__ == "__main__":
    raise SystemExit(main())
