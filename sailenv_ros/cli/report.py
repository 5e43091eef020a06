"""`sailenv report`: one page of all results that `bench` and `eval` have written."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from sailenv_ros.cli.experiment import RESULTS

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "report",
        help="write one page of all results of bench and eval",
        description="Write one HTML file with tables, plots and pictures of every result.",
    )
    parser.set_defaults(run=run)
    parser.add_argument(
        "folder", nargs="?", type=Path, default=RESULTS, metavar="DIR",
        help="folder of results (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="default: report.html in that folder"
    )


def run(args: argparse.Namespace) -> int:
    """Write the page; 0 if all is well."""
    from sailenv_bench.experiments.report_page import write_report

    print(write_report(args.folder, args.output or args.folder / "report.html"))
    return 0
