"""The result of `sailenv bench streams` as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_bench.experiments.tables import Table, number

__all__ = ["stream_tables"]


def stream_tables(data: Mapping[str, Any]) -> list[Table]:
    """Return the tables: flow against the pictures, templates, Horn–Schunck."""
    streams = data["streams"]
    tables = [
        Table(
            title="Flow, judged by the pictures alone",
            columns=(
                "stream", "factor of flow", "left: our flow", "left: DIS", "published: factor",
                "left: as stored", "left: best factor", "left: DIS there",
            ),
            rows=tuple(_flow_row(entry) for entry in streams),
            notes=(
                "left: share of the difference of two pictures, on what moves, that is left after"
                " warping the earlier one (median over pairs; 1 = no warp)",
                "factor: by which flow must be multiplied to leave least; 1 is exact"
                " (± standard error)",
            ),
        )
    ]  # fmt: skip
    known = [entry for entry in streams if entry["templates"]]
    if known:
        tables.append(
            Table(
                title="F1 of the raw image: three labels of one pixel for each object",
                columns=("stream", "whole frame", "focus of attention", "published, whole frame"),
                rows=tuple(_template_row(entry) for entry in known),
                notes=("mean ± standard deviation over drawings of the labels",),
            )
        )
    judged = [entry for entry in streams if entry["horn_schunck"]]
    if judged:
        tables.append(
            Table(
                title="Horn and Schunck's estimate",
                columns=("stream", "Motion-F1", "accuracy 0.05", "accuracy 0.025"),
                rows=tuple(
                    (
                        entry["label"],
                        number(entry["horn_schunck"]["motion_f1"], 3),
                        *(number(one, 3) for one in entry["horn_schunck"]["accuracies"]),
                    )
                    for entry in judged
                ),
                notes=("200 iterations from nothing, smoothness 0.5; motion above 0.5 px",),
            )
        )
    return tables


def _flow_row(entry: Mapping[str, Any]) -> tuple[str, ...]:
    there = entry["published"]
    return (
        entry["label"],
        f"{number(entry['factor'], 3)} ± {number(entry.get('factor_error'), 3)}",
        number(entry["left"]["ours"], 2),
        number(entry["left"]["dis"], 2),
        number(there.get("factor"), 1),
        *(number(there.get(name), 2) for name in ("left_stored", "left_best", "left_dis")),
    )


def _template_row(entry: Mapping[str, Any]) -> tuple[str, ...]:
    found = entry["templates"]
    return (
        entry["label"],
        f"{found['whole']:.2f} ± {found['whole_deviation']:.2f}",
        f"{found['focus']:.2f} ± {found['focus_deviation']:.2f}",
        number(entry["published"].get("f1"), 2),
    )
