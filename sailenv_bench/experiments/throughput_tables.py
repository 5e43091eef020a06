"""The throughput experiment's result as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_bench.experiments.tables import Table, number

__all__ = ["throughput_tables"]

Data = Mapping[str, Any]

CASE_COLUMNS = (
    "case", "frames/s", "frame [ms]", "p90", "physics [ms]", "render [ms]", "rest [ms]",
    "CPU [s/frame]", "memory [MiB]",
)  # fmt: skip


def throughput_tables(data: Data) -> list[Table]:
    """Return the tables of `sailenv bench throughput`: cases, stages, other renderers."""
    base = data["base"]
    cases = tuple(_case(row) for row in data["cases"])
    notes = (
        f"Unless a case says otherwise: {base['width']}×{base['height']}, "
        f"{', '.join(base['views'])}, {base['agents']} agent, {base['scene']}, "
        f"{base['transport']}. Medians of {data['frames']} frames; 8 physics steps between two.",
        "frames/s: of all agents together, physics included. rest: what a frame takes beyond "
        "rendering. CPU and memory: of simulator and client together.",
        *(f"{row['label']}: {row['problem']}." for row in data["cases"] if row.get("problem")),
        *(
            f"{row['label']}: images of {row['repeated']} frames were lost and asked for again, "
            "which is part of the times."
            for row in data["cases"]
            if row.get("repeated")
        ),
    )
    tables = [Table(title="Throughput", columns=CASE_COLUMNS, rows=cases, notes=notes)]
    if data.get("stages"):
        rows = tuple((name, number(value, 2)) for name, value in data["stages"].items())
        title = "Stages of rendering in the base case"
        tables.append(Table(title=title, columns=("stage", "median [ms]"), rows=rows))
    if data["baselines"]:
        tables.append(_baselines(data))
    return tables


def _case(row: Data) -> tuple[str, ...]:
    if not row.get("frame"):
        return (row["label"], *("–" for _ in CASE_COLUMNS[1:]))
    render, frame = row["render"], row["frame"]
    rest = None if render is None else max(0.0, frame["median"] - render)
    return (
        row["label"],
        number(row["fps"]),
        number(frame["median"]),
        number(frame["p90"]),
        number(row["physics"]["median"]),
        number(render),
        number(rest),
        number(row["cpu_s"], 3),
        number(row["memory_mib"], 0),
    )


def _baselines(data: Data) -> Table:
    rows = tuple(
        (
            entry["label"],
            entry["size"],
            number(entry["frame"]["median"]) if entry.get("frame") else "not installed",
            number(entry.get("ratio"), 2),
            entry["draws"],
        )
        for entry in data["baselines"]
    )
    notes = (
        f"The bodies of {data['base']['scene']} from the same camera, in turn; ratio to "
        "sailenv_ros with picture, depth and instance.",
        *(f"{e['label']}: {e['problem']}." for e in data["baselines"] if e.get("problem")),
    )
    columns = ("renderer", "size", "median [ms]", "ratio", "draws")
    return Table(
        title="Other renderers, same geometry", columns=columns, rows=rows, notes=tuple(notes)
    )
