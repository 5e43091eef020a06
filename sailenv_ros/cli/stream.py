"""`sailenv stream`: the published streams of SAILab's work, and endless ones."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NoReturn

from sailenv_ros.cli.arguments import add_light
from sailenv_ros.cli.node_process import become_node
from sailenv_ros.errors import InvalidRequest

__all__ = ["add_parser", "run"]

_DESCRIPTION = (
    "Make a stream as a bag, in lockstep: every frame exactly once, with exact flow, labels, depth"
    " and occlusion. One that was broken off goes on when the same command is given again."
)


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "stream", help="make the published streams of continual learning", description=_DESCRIPTION
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="stream", required=True, metavar="STREAM")
    for name, purpose in (
        ("empty_space", "ewer, laptop, chair, pillow before grey: 1,550 pictures a lap at 20 Hz"),
        ("solid", "cylinder, cube, sphere before grey: 400 pictures a lap at 8 Hz"),
        ("living_room", "as empty_space, in a furnished room: 558 pictures a lap at 25 Hz"),
    ):
        one = actions.add_parser(name, help=purpose, description=_DESCRIPTION)
        length = one.add_mutually_exclusive_group()
        length.add_argument("--laps", type=int, default=1, metavar="N", help="default: 1")
        length.add_argument("--frames", type=int, metavar="N", help="instead of whole laps")
        _add_common(one)
    colof = actions.add_parser(
        "colof",
        help="a, b, c of continual optical flow: 90,000 pictures at 25 Hz",
        description=_DESCRIPTION,
    )
    colof.add_argument("--which", choices=("a", "b", "c"), required=True, help="which of them")
    colof.add_argument("--frames", type=int, metavar="N", help="default: 90,000")
    _add_common(colof)
    endless = actions.add_parser(
        "endless", help="frames of a stream without an end", description=_DESCRIPTION
    )
    _add_course(endless)
    endless.add_argument("--frames", type=int, required=True, metavar="N", help="how many")
    endless.add_argument(
        "--workers", type=int, default=1, metavar="N", help="processes here; default: 1"
    )
    _add_output(endless)
    publish = actions.add_parser(
        "publish",
        help="a stream without an end as topics",
        description="Publish frames of an endless stream as ROS topics, as they are drawn.",
    )
    _add_course(publish)
    publish.add_argument("--frames", type=int, default=0, metavar="N", help="default: to the end")
    publish.add_argument(
        "--rate", type=float, default=1.0, metavar="X",
        help="stream seconds per second; 0: as fast as it goes; default: 1",
    )  # fmt: skip
    publish.add_argument("--no-clock", action="store_true", help="leave /clock alone")
    _add_seed_and_views(publish)


def _add_course(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--course", default="home", metavar="NAME", help="or a file; default: home")
    parser.add_argument("--begin", type=int, default=0, metavar="N", help="first frame; default: 0")


def _add_common(parser: argparse.ArgumentParser) -> None:
    _add_output(parser)
    add_light(parser, "plain")
    parser.add_argument("--backend", choices=("auto", "native", "gl"), default="auto")


def _add_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="DIR", help="the bag; must not exist"
    )
    _add_seed_and_views(parser)
    parser.add_argument("--quiet", action="store_true", help="no progress line")


def _add_seed_and_views(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--seed", type=int, default=0, help="default: %(default)s")
    parser.add_argument("--views", nargs="+", default=[], metavar="VIEW", help="default: its own")


def run(args: argparse.Namespace) -> int:
    """Make the stream; 0 if all is well."""
    if args.stream == "publish":
        _become_streamer(args)
    from sailenv_ros.cli.scene_bake import ensure_baked
    from sailenv_ros.dataset.streams import StreamJob, make_stream, stream_named

    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # A shell starts what it puts into the background so; who sends it means it.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if args.stream == "endless":
        return _run_endless(args)
    kind = stream_named(f"colof_{args.which}" if args.stream == "colof" else args.stream)
    frames = args.frames
    if frames is None and not kind.laps:
        frames = kind.lap_frames
    elif frames is None:
        if args.laps < 1:
            raise InvalidRequest("--laps", args.laps, "1 or more")
        frames = args.laps * kind.lap_frames
    job = StreamJob(
        kind=kind,
        frames=frames,
        seed=args.seed,
        views=tuple(args.views),
        light=args.light,
        backend=args.backend,
    )
    if args.light == "baked":
        # Here, where a bar shows how far it is.
        ensure_baked(str(kind.scene), allow_modules=False)
    with _progress(frames, quiet=args.quiet) as tell:
        made = make_stream(job, args.output, on_frame=tell)
    print(f"{made}: {frames} frames at {kind.rate_hz:g} Hz")
    return 0


def _run_endless(args: argparse.Namespace) -> int:
    import sailenv_ros.streams as streams
    from sailenv_ros.dataset.streams.endless import EndlessJob, make_endless

    job = EndlessJob(
        course=streams.load_course(args.course),
        frames=args.frames,
        begin=args.begin,
        seed=args.seed,
        views=tuple(args.views) or streams.VIEWS,
    )
    with _progress(job.frames, quiet=args.quiet) as tell:
        made = make_endless(job, args.output, workers=args.workers, on_frame=tell)
    print(f"{made}: frames {job.begin} to {job.begin + job.frames - 1} of {job.course.name}")
    return 0


@contextmanager
def _progress(total: int, *, quiet: bool) -> Iterator[Callable[[int], None]]:
    """Yield what shows how many frames are done: a line on standard error, on a terminal."""
    shown = not quiet and sys.stderr.isatty()

    def tell(done: int) -> None:
        if shown and (done % 10 == 0 or done == total):
            print(f"\r{done} of {total} frames", end="", file=sys.stderr, flush=True)

    try:
        yield tell
    finally:
        if shown:
            print(file=sys.stderr)


def _become_streamer(args: argparse.Namespace) -> NoReturn:
    parameters: dict[str, object] = {
        "course": args.course, "seed": args.seed, "begin": args.begin, "frames": args.frames,
        "rate": args.rate, "clock": not args.no_clock,
    }  # fmt: skip
    if args.views:
        parameters["views"] = args.views
    become_node("streamer", parameters)
