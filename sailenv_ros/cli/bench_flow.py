"""`sailenv bench flow-speed` and `flow-accuracy`: options in, result files and tables out."""

from __future__ import annotations

import argparse
import importlib.util
import itertools
from functools import partial
from typing import Any

from sailenv_bench.experiments.flow_accuracy import OURS, evaluate_scenario, flow_test_scene
from sailenv_bench.experiments.flow_methods import FlowMethod, opencv_methods
from sailenv_bench.experiments.flow_network import flow_network
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_bench.experiments.flow_speed import PICTURE, SIZES, WARM_UP, time_flow
from sailenv_bench.experiments.frame_sources import agent_source, in_process_source
from sailenv_bench.experiments.machine import provenance
from sailenv_ros.cli.experiment import (
    checked_sizes,
    command_line,
    finish,
    progress_bar,
)
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.extras import need

__all__ = ["flow_accuracy", "flow_speed"]

OUR_LABEL = "sailenv_ros"

EXACT_PX = 0.01
"""Mean error of what moves, below which our flow counts as exact [px per frame]."""


def flow_speed(args: argparse.Namespace) -> int:
    """Time flow at each size."""
    _check(args, "frames", args.frames)
    sizes = checked_sizes(args.size or ()) or list(SIZES)
    frames = args.frames
    if args.quick:
        sizes, frames = sizes[:2], min(frames, 5)
    methods = _methods(args)
    in_process = args.in_process or importlib.util.find_spec("rclpy") is None
    source_of = in_process_source if in_process else agent_source
    origin = provenance(command_line())
    measured, renderer = [], ""
    with progress_bar(len(sizes) * (WARM_UP + frames)) as tell:
        for width, height in sizes:
            label = f"{width}×{height}"
            with source_of(args.scene, width, height) as source:
                times = time_flow(source, methods, frames=frames, on_frame=partial(tell, label))
                renderer = source.renderer
            measured.append({"width": width, "height": height, "times": times})
    entries = [
        {"name": OURS, "label": f"{OUR_LABEL}: picture and flow", "kind": "ours"},
        {"name": PICTURE, "label": f"{OUR_LABEL}: picture alone", "kind": "picture"},
        *({"name": m.name, "label": f"picture + {m.label}", "kind": "estimate"} for m in methods),
    ]
    data = {
        "scene": args.scene,
        "transport": "in process" if in_process else "Agent.get_frame()",
        "frames": frames,
        "renderer": renderer,
        "methods": entries,
        "sizes": measured,
    }
    finish(args, "flow_speed", origin, data)
    return 0


def flow_accuracy(args: argparse.Namespace) -> int:
    """Compare flow with arithmetic in each scenario; 1 if ours is not exact."""
    _check(args, "pairs", args.pairs)
    for name in args.scenario or ():
        if name not in SCENARIOS:
            raise UnknownName("scenario", name, SCENARIOS)
    ((width, height),) = checked_sizes([args.size])
    pairs = args.pairs
    if args.quick:
        width, height, pairs = min(width, 160), min(height, 120), min(pairs, 2)
    names = args.scenario or list(SCENARIOS)
    gaps = list(dict.fromkeys(args.gaps))
    for gap in gaps:
        _check(args, "gaps", gap)
    methods = _methods(args)
    origin = provenance(command_line())
    evaluated, sheets = [], {}
    with (
        progress_bar(len(names) * len(gaps) * pairs) as tell,
        flow_test_scene(width, height) as simulation,
    ):
        for name, gap in itertools.product(names, gaps):
            scenario = SCENARIOS[name]
            label = scenario.label if gap == 1 else f"{scenario.label}, {gap} frames"
            found = evaluate_scenario(
                simulation, scenario, methods, pairs=pairs, gap=gap, on_pair=partial(tell, label)
            )
            evaluated.append(
                {
                    "name": name,
                    "label": label,
                    "gap": gap,
                    "compared": found.compared,
                    "mean_motion_px": found.mean_motion_px,
                    "errors": found.errors,
                }
            )
            sheets[name if gap == 1 else f"{name}_{gap}"] = found.pictures
        renderer = simulation.info.renderer
    pictures = _save_pictures(args, sheets)
    data = {
        "width": width,
        "height": height,
        "pairs": pairs,
        "renderer": renderer,
        "methods": [
            {"name": OURS, "label": OUR_LABEL},
            *({"name": method.name, "label": method.label} for method in methods),
        ],
        "scenarios": evaluated,
        "pictures": pictures,
    }
    finish(args, "flow_accuracy", origin, data)
    worst = max(entry["errors"][OURS]["mean_moving"] for entry in evaluated)
    return 0 if worst < EXACT_PX else 1


def _check(args: argparse.Namespace, what: str, count: int) -> None:
    if count < 1:
        raise InvalidRequest(f"--{what}", count, "at least 1")
    if not args.no_plots:
        # Now, and not after an hour of measuring.
        need("matplotlib", "a plot (or --no-plots)")


def _methods(args: argparse.Namespace) -> list[FlowMethod]:
    networks = [flow_network(path, value_range=args.network_white) for path in args.network]
    return [*opencv_methods(), *networks]


def _save_pictures(args: argparse.Namespace, sheets: dict[str, dict[str, Any]]) -> list[str]:
    """Write one sheet for each scenario, and the four of the paper's question on one."""
    from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet

    args.output.mkdir(parents=True, exist_ok=True)
    for name, pictures in sheets.items():
        save_contact_sheet(args.output / f"flow_{name}.png", pictures, columns=4)
    chosen: list[str] = [
        name for name in ("uniform", "textured", "camera", "both") if name in sheets
    ]
    chosen = chosen or list(sheets)[:4]
    together = {
        f"{name}: {label}": picture for name in chosen for label, picture in sheets[name].items()
    }
    columns = len(sheets[chosen[0]])
    path = args.output / "flow_pictures.jpg"
    save_contact_sheet(path, together, columns=columns, tile_width=240)
    return [path.name, *(f"flow_{name}.png" for name in sheets)]
