"""`sailenv bench endless`: options in, result file, tables and plot out."""

from __future__ import annotations

import argparse
from typing import Any

from sailenv_ros.cli.experiment import add_common, command_line, finish, progress_bar
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.extras import need

__all__ = ["add_parser", "endless"]

QUICK_FRAMES = 40


def add_parser(actions: Any) -> None:
    """Add the command to those of `sailenv bench`."""
    parser: argparse.ArgumentParser = actions.add_parser(
        "endless", help="baselines that learn online on a stream of `sailenv stream endless`"
    )
    add_common(parser)
    parser.add_argument("--course", default="home", metavar="NAME", help="or a file; default: home")
    parser.add_argument("--seed", type=int, default=0, help="default: %(default)s")
    for option, standard, purpose in (
        ("begin", 0, "number of the first frame"),
        ("frames", 20_000, "frames that are shown"),
        ("stride", 10, "from one frame to the next"),
        ("labels", 4, "pixels of each frame whose label is given"),
        ("delay", 0, "frames after which labels are given"),
        ("every", 5000, "frames from one checkpoint to the next; 0: none"),
        ("test-frames", 25, "frames of each test"),
    ):
        parser.add_argument(
            f"--{option}", type=int, default=standard, metavar="N",
            help=f"{purpose}; default: %(default)s",
        )  # fmt: skip
    parser.add_argument("--learner", nargs="+", metavar="NAME", help="default: all four")


def endless(args: argparse.Namespace) -> int:
    """Teach the baselines; 0 if all is well."""
    from sailenv_bench.experiments.endless_bench import bench_endless, frames_shown
    from sailenv_bench.experiments.machine import provenance
    from sailenv_bench.experiments.pixel_learners import LEARNERS
    from sailenv_ros.streams import OnlineProtocol, load_course
    from sailenv_ros.streams.course import MOST_FRAMES

    frames = min(args.frames, QUICK_FRAMES) if args.quick else args.frames
    for option, value, least in (("frames", frames, 1), ("stride", args.stride, 1)):
        if value < least:
            raise InvalidRequest(f"--{option}", value, f"at least {least}")
    if not 0 <= args.begin <= MOST_FRAMES - frames * args.stride:
        raise InvalidRequest("--begin", args.begin, f"0 or more, and {MOST_FRAMES:,} frames in all")
    if not args.no_plots:
        # Now, and not after an hour of learning.
        need("matplotlib", "a plot (or --no-plots)")
    protocol = OnlineProtocol(
        labels=args.labels,
        delay=args.delay,
        every=0 if args.quick else args.every,
        test_frames=args.test_frames,
        seed=args.seed,
    )
    course = load_course(args.course)
    origin = provenance(command_line())
    with progress_bar(frames_shown(frames, protocol)) as tell:
        data = bench_endless(
            course,
            seed=args.seed,
            begin=args.begin,
            frames=frames,
            stride=args.stride,
            learners=args.learner or tuple(LEARNERS),
            protocol=protocol,
            on_frame=lambda: tell("learning"),
        )
    finish(args, "endless", origin, data)
    return 0
