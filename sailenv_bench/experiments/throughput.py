"""Frames per second by size, views, agents, scene and transport, and other renderers beside ours.

A plan of groups in, their figures out. What is compared runs in turn, a few frames at a time, each
in its own process, so that what disturbs the machine disturbs all alike.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sailenv_bench.experiments.baselines import BASELINES
from sailenv_bench.experiments.statistics import summary_ms
from sailenv_bench.experiments.worker import Worker
from sailenv_bench.experiments.workloads import TRANSPORTS, Setting
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS

__all__ = ["Group", "Plan", "VIEW_SETS", "measure_group", "baseline_rows", "plan_of"]

ROUND = 5
"""Frames of each in a row before the next has its turn."""

WARM_UP = 3

VIEW_SETS: Mapping[str, tuple[str, ...]] = {
    "five views": FIVE_VIEWS,
    "picture alone": ("rgb",),
    "annotations alone": tuple(view for view in FIVE_VIEWS if view != "rgb"),
    "picture and flow": ("rgb", "flow"),
    "every view": RENDERED_VIEWS,
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Settings that are compared with each other, by their labels.

    Attributes
    ----------
    vary : str
        What they differ in.
    settings : dict of str to Setting
    """

    vary: str
    settings: Mapping[str, Setting]


@dataclass(frozen=True, slots=True, kw_only=True)
class Plan:
    """Everything that is measured, the base case and how it is varied."""

    base: Setting
    cases: tuple[Group, ...]
    baselines: tuple[Group, ...]


def plan_of(
    *,
    sizes: Sequence[tuple[int, int]],
    scenes: Sequence[str],
    agents: Sequence[int],
    transports: Sequence[str],
    full: bool,
    baseline_sizes: Sequence[tuple[int, int]],
) -> Plan:
    """Plan the measurement.

    The base case has 640×480 or else the first size, the five views, one agent, the first scene, in
    process. Every size is measured with every transport; views, agents and scenes are varied one at
    a time, or with `full` all of them together.

    Raises
    ------
    UnknownName
        If there is no such transport.
    """
    for name in transports:
        if name not in TRANSPORTS:
            raise UnknownName("transport", name, TRANSPORTS)
    size = (640, 480) if (640, 480) in sizes else sizes[0]
    base = Setting(
        kind="in process", scene=scenes[0], width=size[0], height=size[1], views=FIVE_VIEWS
    )
    groups = [_size_group(base, size, transports, "") for size in sizes]
    if full:
        groups = [
            _size_group(
                replace(base, scene=scene, views=views, agents=count),
                size,
                transports,
                f", {label}, {_agents(count)}, {scene}",
            )
            for size in sizes
            for scene in scenes
            for label, views in VIEW_SETS.items()
            for count in agents
        ]
    else:
        views = {label: replace(base, views=views) for label, views in VIEW_SETS.items()}
        counts = {_agents(count): replace(base, agents=count) for count in agents}
        rooms = {scene: replace(base, scene=scene) for scene in scenes}
        for vary, settings in (("views", views), ("agents", counts), ("scene", rooms)):
            if len(settings) > 1:
                groups.append(Group(vary=vary, settings=settings))
    baselines = tuple(
        Group(
            vary="renderer",
            settings={
                name: replace(base, kind=name, width=width, height=height) for name in BASELINES
            },
        )
        for width, height in baseline_sizes
    )
    return Plan(base=base, cases=tuple(groups), baselines=baselines)


def _agents(count: int) -> str:
    return "1 agent" if count == 1 else f"{count} agents"


def _size_group(
    base: Setting, size: tuple[int, int], transports: Sequence[str], besides: str
) -> Group:
    shown = replace(base, width=size[0], height=size[1])
    label = f"{size[0]}×{size[1]}{besides}"
    settings = {f"{label}, {kind}": replace(shown, kind=kind) for kind in transports}
    return Group(vary="transport", settings=settings)


def measure_group(
    group: Group, frames: int, on_round: Callable[[int], None] = lambda frames: None
) -> list[dict[str, Any]]:
    """Time the settings of a group in turn.

    Parameters
    ----------
    frames : int
        Of each camera.
    on_round : callable
        Called with a number of frames when these are done by all.

    Returns
    -------
    rows : list of dict
        For each setting ``label``, ``vary``, its fields, and either ``problem`` or the figures:
        ``frame`` (of one camera) and ``physics`` as `statistics.summary_ms` gives them, ``render``
        (median [ms] or None), ``stages`` (medians [ms]), ``fps``, ``cpu_s`` per frame,
        ``memory_mib``, ``repeated`` (frames of which images were lost), ``renderer``.
    """
    rows = [_row(label, group.vary, setting) for label, setting in group.settings.items()]
    collected: list[list[dict[str, Any]]] = [[] for _ in rows]
    with ExitStack() as stack:
        started = [stack.enter_context(Worker(setting)) for setting in group.settings.values()]
        workers: list[Worker | None] = []
        for row, worker in zip(rows, started, strict=True):
            row.update(worker.ready())
            if "problem" not in row:
                warm = worker.take(WARM_UP)
                row.update({name: value for name, value in warm.items() if name == "problem"})
            workers.append(None if "problem" in row else worker)
        done = 0
        while done < frames:
            count = min(ROUND, frames - done)
            # The one that begins changes, so that nobody always follows the same other.
            for turn in range(len(rows)):
                place = (turn + done // ROUND) % len(rows)
                worker_then = workers[place]
                if worker_then is None:
                    continue
                answer = worker_then.take(count)
                if "problem" in answer:
                    rows[place].update(answer)
                    workers[place] = None
                else:
                    collected[place].append(answer)
            done += count
            on_round(count)
    for row, answers in zip(rows, collected, strict=True):
        if answers and "problem" not in row:
            row.update(_figures(answers, row["agents"]))
    return rows


def baseline_rows(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """Turn a group of renderers into the report's rows, with ratios to ours."""
    ours = next((row for row in rows if row["label"] == "sailenv_ros"), {})
    base = ours["frame"]["median"] if ours.get("frame") else None
    return [
        {
            "label": row["label"],
            "size": f"{row['width']}×{row['height']}",
            "ours": row["label"].startswith("sailenv_ros"),
            "draws": BASELINES[row["label"]][0],
            "frame": row.get("frame"),
            "ratio": row["frame"]["median"] / base if row.get("frame") and base else None,
            "problem": row.get("problem"),
        }
        for row in rows
    ]


def _row(label: str, vary: str, setting: Setting) -> dict[str, Any]:
    return {
        "label": label,
        "vary": vary,
        "transport": setting.kind,
        "scene": setting.scene,
        "width": setting.width,
        "height": setting.height,
        "views": list(setting.views),
        "agents": setting.agents,
    }


def _figures(answers: Sequence[Mapping[str, Any]], agents: int) -> dict[str, Any]:
    physics = [value for answer in answers for value in answer["physics"]]
    all_cameras = [value for answer in answers for value in answer["frame"]]
    stages = [stage for answer in answers for stage in answer["stages"]]
    names = dict.fromkeys(name for stage in stages for name in stage)
    medians = {
        name: 1e3 * float(np.median([stage[name] for stage in stages if name in stage]))
        for name in names
    }
    frames = len(all_cameras) * agents
    return {
        "frame": summary_ms(value / agents for value in all_cameras),
        "physics": summary_ms(physics),
        "render": medians.get("render"),
        "stages": medians,
        "fps": frames / (sum(physics) + sum(all_cameras)),
        "cpu_s": sum(answer["cpu_s"] for answer in answers) / frames,
        "memory_mib": max(answer["memory_mib"] for answer in answers),
        "repeated": answers[-1]["repeated"],
    }
