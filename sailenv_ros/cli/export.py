"""`sailenv export`: a recording as a data set."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import Any

__all__ = ["add_parser", "run"]

_FORMATS = ("png", "coco", "kitti", "flo", "mp4")


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "export", help="write a recording as a data set: png, coco, kitti, flo, mp4"
    )
    parser.set_defaults(run=run)
    parser.add_argument("path", type=Path, metavar="BAG", help="a bag's folder or an MCAP file")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument(
        "--format",
        dest="formats",
        nargs="+",
        choices=_FORMATS,
        required=True,
        help="several get a folder each",
    )
    parser.add_argument("--agent", default="", metavar="NAME", help="default: the only one")


def run(args: argparse.Namespace) -> int:
    """Write the data sets; 0 if all is well."""
    from sailenv_ros.recording.export import export

    def tell(done: int, of: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{done} of {of} frames", end="", file=sys.stderr, flush=True)

    count = export(args.path, args.output, args.formats, agent=args.agent, on_frame=tell)
    print(f"{args.output}: {count} frames as {', '.join(args.formats)}")
    return 0
