"""Results as tables of text: the command prints them, the report shows them.

The data of a result file in, `Table`s out; nothing is computed here but ratios.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from sailenv_bench.experiments.paper import FLOW_MS, FLOW_SOURCE
from sailenv_ros.errors import InvalidRequest

__all__ = ["Table", "accuracy_tables", "number", "speed_tables"]

Data = Mapping[str, Any]

PARTS = {"ours": "  of it beyond the picture alone", "estimate": "  of it estimating"}
"""Label of the share of a frame's time that flow takes, by the kind of the method."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Table:
    """A table as people read it.

    Attributes
    ----------
    title : str
    columns : tuple of str
        The first one names the rows.
    rows : tuple of tuple of str
        As many cells each as there are columns.
    notes : tuple of str
        What has to be known to read it, a sentence each.
    """

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row) != len(self.columns):
                raise InvalidRequest("row of a table", row, f"{len(self.columns)} cells")


def number(value: float | None, digits: int = 1, *, missing: str = "–") -> str:
    """Write a number; None, which is what JSON keeps of nan, as a dash."""
    return missing if value is None or value != value else f"{value:.{digits}f}"


def speed_tables(data: Data) -> list[Table]:
    """Return the table of `sailenv bench flow-speed`."""
    sizes = data["sizes"]
    columns = ("[ms]", *(f"{entry['width']}×{entry['height']}" for entry in sizes))
    rows = []
    for method in data["methods"]:
        times = [entry["times"][method["name"]] for entry in sizes]
        rows.append((method["label"], *(_mean(time["total"]) for time in times)))
        part = PARTS.get(method["kind"])
        if part:
            rows.append((part, *(_mean(time["flow"]) for time in times)))
    paper = (FLOW_MS.get((entry["width"], entry["height"])) for entry in sizes)
    rows.append(("the paper's SAILenv, other machine", *(number(value, 0) for value in paper)))
    frames = f"Mean ± half of the 95 % interval of {data['frames']} frames of {data['scene']}, "
    return [
        Table(
            title="Time of a frame with flow",
            columns=columns,
            rows=tuple(rows),
            notes=(
                frames + f"{data['transport']}; all methods in turn on one simulator.",
                "Estimates take the picture by the same get_frame() and the one before it.",
                FLOW_SOURCE,
            ),
        )
    ]


def _mean(summary: Mapping[str, Any]) -> str:
    return f"{number(summary['mean'])} ± {number(summary['half_interval'])}"


def accuracy_tables(data: Data) -> list[Table]:
    """Return the tables of `sailenv bench flow-accuracy`."""
    methods: Sequence[Data] = data["methods"]
    columns = ("scenario", "motion", *(method["label"] for method in methods))
    rows = tuple(
        (
            entry["label"],
            number(entry["mean_motion_px"], 2),
            *(_error(entry["errors"][method["name"]]["mean"]) for method in methods),
        )
        for entry in data["scenarios"]
    )
    moving = tuple(
        (
            entry["label"],
            *(_error(entry["errors"][method["name"]]["mean_moving"]) for method in methods),
        )
        for entry in data["scenarios"]
    )
    parts = {"visible": "visible", "hidden": "hidden", "leaving": "out of view"}
    split = tuple(
        (
            entry["label"],
            place,
            *(_error(entry["errors"][method["name"]].get(f"mean_{part}")) for method in methods),
        )
        for entry in data["scenarios"]
        for part, place in parts.items()
        if entry["errors"]["sailenv"].get(f"mean_{part}") is not None
    )
    worst = max(entry["errors"]["sailenv"]["max"] for entry in data["scenarios"])
    share = min(entry["compared"] for entry in data["scenarios"])
    note = (
        f"{data['pairs']} pairs of pictures of {data['width']}×{data['height']}, 1/30 s apart "
        "unless the scenario names a number of frames. The reference is computed from the poses "
        "by rays and rigid-body arithmetic in float64."
    )
    return [
        Table(
            title="Mean end-point error, all pixels [px per frame]",
            columns=columns,
            rows=rows,
            notes=(
                note,
                f"Largest error of sailenv_ros at any pixel: {worst:.2g} px per frame (on faces "
                "seen edge-on, where the rasteriser rounds depth most). At "
                f"least {100 * share:.3f} % of the pixels were compared; at the others, on edges, "
                "ray and rasteriser meet different objects.",
            ),
        ),
        Table(
            title="Mean end-point error of pixels that move [px per frame]",
            columns=("scenario", *columns[2:]),
            rows=moving,
        ),
        Table(
            title="Mean end-point error by the point's place in the earlier picture [px per pair]",
            columns=("scenario", "in the earlier picture", *columns[2:]),
            rows=split,
        ),
    ][: 3 if split else 2]


def _error(value: float | None) -> str:
    if value is None:
        return "–"
    return f"{value:.1e}" if value < 1e-3 else f"{value:.3f}"
