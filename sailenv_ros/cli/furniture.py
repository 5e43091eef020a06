"""The standard pack of furniture, built with a progress bar: for `sailenv assets` and `setup`."""

from __future__ import annotations

import sys
from collections.abc import Collection

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from sailenv_content.standard.pack_build import build_standard_pack

__all__ = ["build_furniture", "object_progress"]

REPORTS = 10
"""Number of progress messages where there is no terminal for a bar."""


def build_furniture(
    *,
    names: Collection[str] | None = None,
    jobs: int | None = None,
    force: bool = False,
) -> None:
    """Build the pack; see `build_standard_pack` for the arguments and errors."""
    console = Console(stderr=True)
    with object_progress(console) as bar:
        task = bar.add_task("furniture", total=None)

        def report(name: str, done: int, total: int) -> None:
            bar.update(task, description=name, completed=done, total=total)
            if (
                not console.is_terminal
                and (done * REPORTS) // total > (done - 1) * REPORTS // total
            ):
                print(f"furniture: {done} of {total} objects", file=sys.stderr, flush=True)

        def said(text: str) -> None:
            bar.update(task, description=text)
            if not console.is_terminal:
                console.print(text)

        build_standard_pack(progress=report, say=said, jobs=jobs, force=force, names=names)
        bar.update(task, description="furniture")


def object_progress(console: Console) -> Progress:
    """Return a bar that counts objects."""
    return Progress(
        TextColumn("{task.description:<28}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=not console.is_terminal,
    )
