"""Common parts of the experiments' commands: a progress bar, tables, result files."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sailenv_ros.errors import InvalidRequest

__all__ = [
    "RESULTS",
    "add_common",
    "checked_sizes",
    "command_line",
    "finish",
    "print_tables",
    "progress_bar",
]

RESULTS = Path("sailenv_results")
"""Folder of results unless another is named."""


def add_common(parser: argparse.ArgumentParser) -> None:
    """Add what every experiment takes."""
    parser.add_argument(
        "-o", "--output", type=Path, default=RESULTS, metavar="DIR",
        help="folder of JSON and plots (default: %(default)s)",
    )  # fmt: skip
    parser.add_argument("--quick", action="store_true", help="few and small: to see that it works")
    parser.add_argument("--no-plots", action="store_true", help="JSON alone; needs no matplotlib")


def command_line() -> list[str]:
    """Return the words that this command was started with, as one would type them."""
    return ["sailenv", *sys.argv[1:]]


def checked_sizes(words: Sequence[str]) -> list[tuple[int, int]]:
    """Read sizes like ``640x480``."""
    sizes = []
    for word in words:
        width, _, height = word.lower().partition("x")
        if not (width.isdecimal() and height.isdecimal()):
            raise InvalidRequest("size", word, "WIDTHxHEIGHT, e.g. 640x480")
        sizes.append((int(width), int(height)))
    return sizes


@contextmanager
def progress_bar(total: int) -> Iterator[Callable[..., None]]:
    """Show a bar on standard error; call what is given with a description, once per unit done."""
    from rich.console import Console
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    console = Console(stderr=True)
    bar = Progress(
        TextColumn("{task.description:<34}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
        transient=not console.is_terminal,
    )
    with bar:
        task = bar.add_task("", total=total)

        def report(description: str | None = None, advance: int = 1) -> None:
            bar.update(task, description=description, advance=advance)

        yield report


def print_tables(tables: Sequence[Any]) -> None:
    """Print tables as wide as they are, so that they can be piped and pasted."""
    from rich import box
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    terminal = Console()
    console = terminal if terminal.is_terminal else Console(width=200)
    for entry in tables:
        table = Table(title=Text(entry.title, "bold"), title_justify="left", box=box.SIMPLE_HEAD)
        for place, column in enumerate(entry.columns):
            table.add_column(
                Text(column), justify="left" if place == 0 else "right", no_wrap=place == 0
            )
        for row in entry.rows:
            table.add_row(*(Text(cell) for cell in row))
        console.print(table)
        for note in entry.notes:
            console.print(Text(note))
        console.print()


def finish(
    args: argparse.Namespace, experiment: str, origin: Mapping[str, Any], data: Mapping[str, Any]
) -> None:
    """Write the result, print its tables and draw its plots."""
    from sailenv_bench.experiments.result_tables import tables_of
    from sailenv_bench.experiments.results import load_result, save_result

    path = save_result(args.output, experiment, origin, data)
    result = load_result(args.output, experiment)
    assert result is not None
    print_tables(tables_of(result))
    load = ", ".join(map(str, origin["load"]))
    print(f"{origin['cpu']}, {origin['cpus']} CPUs, load {load}; {data.get('renderer', '')}")
    print(path)
    if not args.no_plots:
        from sailenv_bench.experiments.plots import save_plots

        for plot in save_plots(result, args.output):
            print(plot)
