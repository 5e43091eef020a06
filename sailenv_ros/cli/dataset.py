"""`sailenv dataset`: make data sets by recipe, check them, look at them."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from sailenv_ros.dataset import Progress

__all__ = ["add_parser", "run", "told"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "dataset", help="make data sets by recipe, check them, look at them"
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    make = actions.add_parser("make", help="make a data set, or go on with one")
    make.add_argument("recipe", type=Path, metavar="RECIPE", help="a YAML file")
    make.add_argument(
        "-o", "--output", metavar="DIR", help="a folder, or a URL that fsspec knows (s3://…)"
    )
    make.add_argument(
        "--workers", type=_positive, default=1, metavar="N", help="processes here; default: 1"
    )
    make.add_argument(
        "--ray", metavar="ADDRESS", help="have a Ray cluster make it: auto, local, ray://host:10001"
    )
    make.add_argument(
        "--limit",
        type=_positive,
        default=0,
        metavar="N",
        help="end after the shard with frame N; without it, a later call makes the rest",
    )
    make.add_argument(
        "--check",
        action="store_true",
        help="only check the recipe and what it names: scenes, objects, materials, packages",
    )
    make.add_argument(
        "--dry-run",
        action="store_true",
        help="check the recipe, make a few frames, say what all would cost",
    )
    verify = actions.add_parser(
        "verify", help="compare files with their hashes, and shards with ones made anew"
    )
    verify.add_argument("dataset", metavar="DIR")
    verify.add_argument(
        "--shards", type=int, default=1, metavar="N", help="made anew; default: 1, 0: none"
    )
    verify.add_argument("--seed", type=int, default=0, help="of the choice among shards")
    show = actions.add_parser(
        "show", help="write a page to look at a data set in a browser, or a contact sheet"
    )
    show.add_argument("dataset", type=Path, metavar="DIR")
    show.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="a page (.html) or a sheet (.png, .jpg); default: dataset.html in the data set",
    )
    show.add_argument("--split", default="", help="frames of that one alone")
    show.add_argument(
        "--frames", type=_positive, help="how many; default: 36 in a page, 12 in a sheet"
    )
    actions.add_parser("schema", help="print the JSON Schema of recipes, for editors")


def run(args: argparse.Namespace) -> int:
    """Carry out the action; 0 if all is well."""
    return {"make": _make, "verify": _verify, "show": _show, "schema": _schema}[args.action](args)


def _make(args: argparse.Namespace) -> int:
    from sailenv_ros.dataset import engine_of, load_job, make_dataset

    job = load_job(args.recipe)
    if args.check:
        count = len(job.recipe.scenes)
        entries = f"{count} {'entry' if count == 1 else 'entries'}"
        print(f"{args.recipe}: no errors, neither in it nor in the {entries} of scenes")
        return 0
    if args.dry_run:
        return _dry_run(job, args.workers)
    if args.output is None:
        print("sailenv dataset make: -o DIR is missing; it says where to", file=sys.stderr)
        return 2
    with _progress_bar() as tell:
        engine = engine_of(args.workers, args.ray)
        made = make_dataset(job, args.output, engine, limit=args.limit, on_progress=tell)
    known = f"SHA-256 {made.sha256}" if made.sha256 else "of more that the recipe asks for"
    print(
        f"{args.output}: {made.frames} frames in {made.shards} shards, "
        f"{made.bytes / 1e6:.1f} MB, {known}"
    )
    for name, counts in made.written.items():
        left_out = made.left_out.get(name, {})
        more = f"; left out: {told(left_out)}" if left_out else ""
        print(f"  {name}: {told(counts)}{more}")
    if made.skipped:
        print(f"  clips that could not be made: {told(made.skipped)}")
    return 0


def _dry_run(job: Any, workers: int) -> int:
    from sailenv_ros.dataset.estimating import estimate

    cost = estimate(job)
    print(
        f"{cost.frames} frames: {cost.clips} clips in {cost.shards} shards; a scene is begun "
        f"{cost.scenes_begun} times"
    )
    print(
        f"about {cost.bytes / 1e6:.0f} MB and {cost.worker_s / 60.0 / workers:.1f} minutes with "
        f"{workers} worker{'s' if workers > 1 else ''} on this machine, by {cost.sampled} frames "
        "that were made; light that is not baked yet comes on top"
    )
    return 0


def _verify(args: argparse.Namespace) -> int:
    from sailenv_ros.dataset import verify_dataset

    differences = verify_dataset(args.dataset, sample=args.shards, seed=args.seed)
    for difference in differences:
        print(f"{difference.path} {difference.why}")
    if not differences:
        print(f"{args.dataset}: all files are as they were written")
    return 1 if differences else 0


def _show(args: argparse.Namespace) -> int:
    from sailenv_ros.dataset.preview_page import save_preview
    from sailenv_ros.dataset.showing import save_sheet

    output = args.output or args.dataset / "dataset.html"
    page = output.suffix.lower() in (".html", ".htm")
    frames = args.frames or (36 if page else 12)
    save = save_preview if page else save_sheet
    count = save(args.dataset, output, split=args.split, frames=frames)
    print(f"{output}: {count} frames")
    return 0


def _schema(args: argparse.Namespace) -> int:
    from sailenv_ros.dataset.recipe import DatasetRecipe

    print(json.dumps(DatasetRecipe.model_json_schema(), indent=2))
    return 0


@contextmanager
def _progress_bar() -> Iterator[Callable[[Progress], None]]:
    """Yield what shows progress: a bar in a terminal, a line now and then elsewhere."""
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    columns = (
        TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[told]}"),
        TimeRemainingColumn(),
    )  # fmt: skip
    told_tenths = -1
    with Bar(*columns, console=console, disable=not console.is_terminal) as bar:
        task = bar.add_task("frames", total=None, told="")

        def tell(progress: Progress) -> None:
            nonlocal told_tenths
            line = (
                f"{progress.frames} of {progress.of_frames}, {progress.shards} of "
                f"{progress.of_shards} shards, {progress.rate_hz * 60.0:.0f} a minute"
            )
            bar.update(task, total=progress.of_frames, completed=progress.frames, told=line)
            tenths = 10 * progress.frames // max(1, progress.of_frames)
            if not console.is_terminal and tenths > told_tenths:
                told_tenths = tenths
                print(line, file=sys.stderr, flush=True)

        yield tell


def _positive(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError(f"must be 1 or more, got {text}")
    return number


def told(numbers: Mapping[str, int]) -> str:
    """Return in words how many there are of each thing."""
    return ", ".join(f"{count} {what}" for what, count in numbers.items()) or "nothing"
