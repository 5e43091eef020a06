"""`sailenv bench all`: options in, one table of figures as Markdown and JSON out."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

from sailenv_ros.cli.experiment import RESULTS, command_line

__all__ = ["add_parser", "every_part"]


def add_parser(actions: Any) -> None:
    """Add the command to those of `sailenv bench`."""
    parser: argparse.ArgumentParser = actions.add_parser(
        "all",
        help="the speed benchmarks, as one table: about 15 minutes",
        description="Run the speed benchmarks and write figures.md and figures.json. Parts that "
        "were finished on this machine at this commit are kept. The status is 1 if a part failed.",
    )
    parser.add_argument(
        "-o", "--output", default=RESULTS, type=Path, metavar="DIR",
        help="folder of figures.md and figures.json (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="few and small: about 2 minutes")
    parser.add_argument("--part", nargs="+", default=[], metavar="NAME", help="these alone")
    parser.add_argument("--again", action="store_true", help="measure finished parts, too")


def every_part(args: argparse.Namespace) -> int:
    """Measure the parts; 1 if one failed."""
    from sailenv_bench.experiments.machine import provenance
    from sailenv_bench.experiments.results import load_result
    from sailenv_bench.suite.page import figures_page
    from sailenv_bench.suite.parts import Part, parts_named
    from sailenv_bench.suite.running import RESULT, Record, measure_part, run_parts
    from sailenv_ros.system.files import storage_errors, write_file

    parts = parts_named(args.part)
    origin = provenance(command_line())
    if args.again:
        with storage_errors("the result", args.output):
            (args.output / f"{RESULT}.json").unlink(missing_ok=True)

    def begin(part: Part) -> None:
        print(f"{part.name} ...", file=sys.stderr, flush=True)

    def done(part: Part, record: Record) -> None:
        state = f"FAILED: {record['failed']}" if "failed" in record else "done"
        place = f"{1 + parts.index(part)} of {len(parts)}"
        print(f"{place}: {part.name} {state}, {record['seconds']} s", file=sys.stderr, flush=True)

    records = run_parts(
        parts, args.output, origin, quick=args.quick, measure=measure_part, begin=begin, done=done
    )
    result = load_result(args.output, RESULT)
    assert result is not None
    page = args.output / f"{RESULT}.md"
    text = figures_page(result["provenance"], result["data"])
    with storage_errors("the page", page):
        write_file(page, text.encode())
    print(text)
    print(page)
    return 1 if any("failed" in record for record in records) else 0
