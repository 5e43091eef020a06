"""`sailenv bench throughput`: options in, the result file and its tables out."""

from __future__ import annotations

import argparse
from functools import partial
from typing import Any

from sailenv_bench.experiments.machine import provenance
from sailenv_bench.experiments.throughput import baseline_rows, measure_group, plan_of
from sailenv_bench.experiments.workloads import TRANSPORTS
from sailenv_ros.cli.experiment import checked_sizes, command_line, finish, progress_bar
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.extras import need

__all__ = ["throughput"]

SIZES = [(320, 240), (640, 480), (1280, 960)]
SCENES = ["room_01", "room_02", "room_03", "optical"]
AGENTS = [1, 4]
BASELINE_FRAMES = 20
"""Greatest number of frames of each renderer: some take a second for one."""


def throughput(args: argparse.Namespace) -> int:
    """Measure everything that is planned; 0 if all is well."""
    sizes = checked_sizes(args.size or ()) or SIZES
    scenes, agents, frames = args.scene or SCENES, args.agents or AGENTS, args.frames
    if frames < 1 or min(agents) < 1:
        raise InvalidRequest("--frames and --agents", (frames, *agents), "at least 1")
    if not args.no_plots:
        need("matplotlib", "a plot (or --no-plots)")
    if args.quick:
        sizes, scenes, frames = sizes[:1], scenes[:1], min(frames, 3)
    plan = plan_of(
        sizes=sizes,
        scenes=scenes,
        agents=agents,
        transports=args.transport or list(TRANSPORTS),
        full=args.full,
        baseline_sizes=() if args.no_renderers else sizes[:2],
    )
    origin = provenance(command_line())
    cases: list[dict[str, Any]] = []
    baselines: list[dict[str, Any]] = []
    baseline_frames = min(frames, BASELINE_FRAMES)
    total = len(plan.cases) * frames + len(plan.baselines) * baseline_frames
    with progress_bar(total) as tell:
        for group in plan.cases:
            first = next(iter(group.settings))
            cases += measure_group(group, frames, partial(tell, f"{group.vary}: {first}"))
        for group in plan.baselines:
            tell("other renderers", 0)
            rows = measure_group(group, baseline_frames, partial(tell, "other renderers"))
            baselines += baseline_rows(rows)
    base = plan.base
    like_base = [row for row in cases if row.get("stages") and _is_base(row, base)]
    data = {
        "frames": frames,
        "transports": args.transport or list(TRANSPORTS),
        "base": {
            "transport": base.kind,
            "scene": base.scene,
            "width": base.width,
            "height": base.height,
            "views": base.views,
            "agents": base.agents,
        },
        "renderer": next((row["renderer"] for row in cases if row.get("renderer")), ""),
        "cases": cases,
        "stages": like_base[0]["stages"] if like_base else {},
        "baselines": baselines,
    }
    finish(args, "throughput", origin, data)
    return 0


def _is_base(row: dict[str, Any], base: Any) -> bool:
    same = (row["width"], row["height"], row["scene"], row["agents"], tuple(row["views"]))
    return row["transport"] == base.kind and same == (
        base.width, base.height, base.scene, base.agents, base.views
    )  # fmt: skip
