"""Records of the parts in, the Markdown page with the one table of figures out."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from sailenv_bench.suite.measurement import Measurement, from_plain
from sailenv_bench.suite.parts import PARTS

__all__ = ["figures_page", "shown"]

COLUMNS = ("measured", "ratio", "median", "compared with", "which has")


def figures_page(origin: Mapping[str, Any], data: Mapping[str, Any]) -> str:
    """Return the page.

    Parameters
    ----------
    origin : mapping
        Provenance of the result.
    data : mapping
        ``quick``, ``parts`` (records as `running` makes them) and ``load_end``.
    """
    records = {record["name"]: record for record in data["parts"]}
    lines = [
        "# Measured figures",
        "",
        "This page holds the speed of each part of the simulator on one machine, as "
        "`sailenv bench all` measured it. [Speed](performance.md) says what the figures mean.",
        "",
        *_machine(origin, data),
        "",
        _row(COLUMNS),
        "|---|---:|---:|---|---:|",
    ]
    for part in PARTS:
        record = records.get(part.name)
        if record is None:
            continue
        lines.append(_row((f"**{part.title}** (`{part.name}`)", "", "", "", "")))
        if "failed" in record:
            lines.append(_row((f"failed: {record['failed']}", "", "", "", "")))
        for entry in record.get("measurements", ()):
            lines.append(_row(_cells(from_plain(entry))))
    return "\n".join([*lines, ""])


def shown(value: float | None) -> str:
    """Write a number with three digits that count; None as nothing."""
    if value is None:
        return ""
    if value != 0.0 and abs(value) < 1e-3:
        return f"{value:.1e}"
    digits = 3
    for limit in (1.0, 10.0, 100.0):
        digits -= abs(value) >= limit
    return f"{value:.{digits}f}"


def _cells(row: Measurement) -> Iterable[str]:
    yield row.name
    yield "" if row.ratio is None else f"**{_ratio(row.ratio)}**"
    yield f"{shown(row.value)} {row.unit}"
    yield row.other
    yield shown(row.other_value)


def _ratio(ratio: float) -> str:
    return f"{ratio:.2f}" if ratio >= 0.005 else shown(ratio)


def _row(cells: Iterable[str]) -> str:
    escaped = (" ".join(cell.replace("|", "\\|").split()) for cell in cells)
    return f"|{'|'.join(escaped)}|"


def _machine(origin: Mapping[str, Any], data: Mapping[str, Any]) -> list[str]:
    versions = ", ".join(f"{name} {version}" for name, version in origin["versions"].items())
    load = ", ".join(map(str, origin["load"]))
    load_end = ", ".join(map(str, data["load_end"]))
    seconds = sum(record["seconds"] for record in data["parts"])
    lines = [
        f"- Machine: {origin['cpu']}, {origin['cpus']} CPUs, {origin['memory_gib']} GiB; "
        f"{origin['system']}",
        f"- Load (1, 5, 15 minutes): {load} at the start, {load_end} at the end",
        f"- Commit: {origin['commit'] or 'unknown'}, {origin['began']}, "
        f"{seconds / 60.0:.0f} minutes",
        f"- Versions: Python {origin['python']}, {versions}",
        "- A ratio is the median divided by the other one, in the same unit. Both were measured in "
        "turn. "
        "Of times, a ratio below 1 is faster; of rates, one above 1.",
    ]
    if data["quick"]:
        lines.append("- **Made with `--quick`**: few repetitions, so the figures are rough.")
    return lines
