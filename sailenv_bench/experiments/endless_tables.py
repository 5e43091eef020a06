"""The result of `sailenv bench endless` as tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sailenv_bench.experiments.tables import Table, number

__all__ = ["endless_tables"]


def endless_tables(data: Mapping[str, Any]) -> list[Table]:
    """Return the tables: the whole stream, and each checkpoint."""
    return [
        Table(
            title=f"Pixels of '{data['course']}' classified online",
            columns=(
                "learner", "accuracy", "recent", "forgetting", "rooms, another time",
                "rooms never visited",
            ),
            rows=tuple(_row(entry) for entry in data["learners"]),
            notes=(
                f"{data['frames']:,} frames from {data['begin']:,} on, one in {data['stride']};"
                f" {data['labels']} labels a frame, {data['delay']} frames late;"
                f" {data['learners'][0]['classes']} classes",
                "accuracy: of predictions before the label was known; recent: fading;"
                " the last three columns: at the end",
            ),
        ),
        Table(
            title="At checkpoints: recent, rooms at another time, rooms never visited",
            columns=("learner", *(f"{one['at']:,}" for one in _checkpoints(data))),
            rows=tuple(
                (entry["name"], *(_short(one) for one in entry["checkpoints"]))
                for entry in data["learners"]
            ),
            notes=("tests have the stream's drift of their checkpoint",),
        ),
    ]  # fmt: skip


def _checkpoints(data: Mapping[str, Any]) -> Any:
    return data["learners"][0]["checkpoints"]


def _row(entry: Mapping[str, Any]) -> tuple[str, ...]:
    last = entry["checkpoints"][-1]
    return (
        entry["name"],
        number(entry["accuracy"], 3),
        number(last["recent"], 3),
        number(last["forgetting"], 3),
        number(last["tests"].get("same"), 3),
        number(last["tests"].get("other"), 3),
    )


def _short(point: Mapping[str, Any]) -> str:
    tests = (point["tests"].get(name) for name in ("same", "other"))
    return " ".join(number(value, 2) for value in (point["recent"], *tests))
