"""A small result of each experiment, as the commands write them."""

from __future__ import annotations

from typing import Any

from sailenv_bench.experiments.statistics import summary_ms

TOLD = {
    "machine": "bench", "cpu": "A <fast> CPU", "cpus": 2, "memory_gib": 8.0, "system": "Linux",
    "python": "3.11", "versions": {"numpy": "2"}, "commit": "abc", "command": "sailenv bench x",
    "began": "2020-01-01T00:00:00+00:00", "load": [0.1, 0.2, 0.3],
}  # fmt: skip

TIME = {"total": summary_ms([0.010, 0.012]), "flow": summary_ms([0.0, 0.0])}
ERROR = {"mean": 1e-7, "p95": 2e-7, "max": 3e-5, "mean_moving": 1e-7, "mean_visible": 1e-7,
         "mean_hidden": 2e-7, "mean_leaving": None}  # fmt: skip
CLASS = {
    "views": 5, "instances": 1, "hit_rate": 0.6, "box_iou": (0.5, 0.4),
    "pixel_iou": (float("nan"), float("nan")),
}  # fmt: skip
CASE = {
    "vary": "transport", "scene": "optical", "width": 64, "height": 48, "views": ["rgb"],
    "agents": 1,
}  # fmt: skip
FIGURES = {
    "frame": summary_ms([0.01, 0.02]), "physics": summary_ms([0.001, 0.002]), "render": 9.0,
    "stages": {"render": 9.0}, "fps": 50.0, "cpu_s": 0.02, "memory_mib": 300.0, "repeated": 2,
}  # fmt: skip

DATA: dict[str, dict[str, Any]] = {
    "flow_speed": {
        "scene": "room_01", "transport": "in process", "frames": 2, "renderer": "GL",
        "methods": [
            {"name": "sailenv", "label": "ours", "kind": "ours"},
            {"name": "picture", "label": "picture", "kind": "picture"},
            {"name": "farneback", "label": "Farneback", "kind": "estimate"},
        ],
        "sizes": [
            {"width": 240, "height": 180,
             "times": dict.fromkeys(("sailenv", "picture", "farneback"), TIME)},
            {"width": 50, "height": 40,
             "times": dict.fromkeys(("sailenv", "picture", "farneback"), TIME)},
        ],
    },
    "flow_accuracy": {
        "width": 64, "height": 48, "pairs": 2, "renderer": "GL",
        "methods": [{"name": "sailenv", "label": "ours"}, {"name": "x", "label": "Farneback"}],
        "scenarios": [
            {"name": "both", "label": "camera & cube", "compared": 0.9999, "mean_motion_px": 1.2,
             "errors": {"sailenv": ERROR, "x": {**ERROR, "mean": 0.25}}},
        ],
        "pictures": ["flow_pictures.jpg"],
    },
    "detection": {
        "model": "net.onnx", "format": "nanodet", "score": 0.3, "hit_iou": 0.5, "masks": False,
        "remarks": ["A remark."], "baked": False, "renderer": "GL", "pictures": [],
        "rule": {"views": 5, "cover": (0.02, 0.6), "visible": 0.7, "seed": 0, "rooms": ["room_01"]},
        "classes": [{"name": "bed", **CLASS}, {"name": "tv", **CLASS, "views": 3}],
        "overall": {"views": 8, "hit_rate": 0.6, "box_iou": 0.5, "pixel_iou": float("nan")},
    },
    "streams": {
        "seed": 0,
        "streams": [
            {"name": "solid", "label": "Solid", "pairs": 4, "factor": 0.998,
             "factor_error": 0.002, "factor_pixels": 900,
             "left": {"ours": 0.2, "dis": 0.3},
             "published": {"factor": 5.4, "left_stored": 0.9, "left_best": 0.2, "left_dis": 0.2,
                           "f1": 0.18},
             "templates": {"whole": 0.2, "whole_deviation": 0.1, "focus": 0.3,
                           "focus_deviation": 0.1},
             "horn_schunck": None},
            {"name": "colof_a", "label": "Stream A", "pairs": 4, "factor": float("nan"),
             "factor_pixels": 0, "left": {"ours": float("nan"), "dis": 0.3}, "published": {},
             "templates": None,
             "horn_schunck": {"motion_f1": 0.3, "accuracies": [0.9, 0.8]}},
        ],
    },
    "endless": {
        "course": "home", "seed": 0, "begin": 0, "frames": 100, "stride": 10, "labels": 4,
        "delay": 2,
        "learners": [
            {"name": name, "accuracy": 0.4, "classes": 7,
             "checkpoints": [
                 {"at": at, "recent": 0.5, "forgetting": 0.2, "tests": tests}
                 for at, tests in ((490, {"same": 0.3, "other": 0.2}), (990, {}))
             ]}
            for name in ("frequent", "convnet")
        ],
    },
    "throughput": {
        "frames": 2, "transports": ["in process", "DDS, default"], "renderer": "GL",
        "base": {"transport": "in process", "scene": "optical", "width": 64, "height": 48,
                 "views": ["rgb"], "agents": 1},
        "stages": {"render": 9.0},
        "cases": [
            {"label": "base", "transport": "in process", **CASE, **FIGURES},
            {"label": "over DDS", "transport": "DDS, default", **CASE, "problem": "no ROS"},
        ],
        "baselines": [
            {"label": "sailenv_ros", "size": "64×48", "ours": True, "draws": "all",
             "frame": summary_ms([0.01]), "ratio": 1.0, "problem": None},
            {"label": "MuJoCo", "size": "64×48", "ours": False, "draws": "all", "frame": None,
             "ratio": None, "problem": "it is not installed"},
        ],
    },
}  # fmt: skip
