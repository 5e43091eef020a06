#!/usr/bin/env python3
"""Print the share of statements that tests ran, by room: coverage_rooms.py COVERAGE.json.

The file is coverage.py's JSON report. `scripts/test --coverage` writes it. Statements that run in
processes that tests start, such as nodes, do not count.
"""

from __future__ import annotations

import json
import sys
from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from import_graph import PACKAGES, room_of  # type: ignore[import-not-found]  # beside this file


def module_of(path: str) -> str | None:
    """Return the module of a file of one of the packages, wherever they are installed."""
    parts = Path(path).with_suffix("").parts
    starts = [start for start, part in enumerate(parts) if part in PACKAGES]
    # The last one: a clone of the repository may have the name of a package, too.
    return ".".join(parts[starts[-1] :]).removesuffix(".__init__") if starts else None


def rooms(report: Mapping[str, Any]) -> dict[str, tuple[int, int]]:
    """Return statements that ran and all statements, by room."""
    counted: dict[str, tuple[int, int]] = defaultdict(lambda: (0, 0))
    for path, entry in report["files"].items():
        module = module_of(path)
        if module is not None:
            ran, all_of_them = counted[room_of(module)]
            summary = entry["summary"]
            counted[room_of(module)] = (
                ran + summary["covered_lines"],
                all_of_them + summary["num_statements"],
            )
    return dict(counted)


def main() -> int:
    """Print a line for each room, the least covered first, and one for all."""
    counted = rooms(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    counted = {room: counts for room, counts in counted.items() if counts[1]}
    total = sum(ran for ran, _ in counted.values()), sum(count for _, count in counted.values())
    by_share = sorted(counted.items(), key=lambda item: item[1][0] / item[1][1])
    for room, (ran, statements) in [*by_share, ("all", total)]:
        print(f"{room:28} {ran:6} of {statements:6} statements  {100 * ran / statements:5.1f} %")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
