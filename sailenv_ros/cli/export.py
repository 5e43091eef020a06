"""`sailenv export`: a recording as a data set."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sailenv_ros.cli.dataset import told

if TYPE_CHECKING:
    from sailenv_ros.dataset.formats import DatasetSummary

__all__ = ["add_parser", "run"]

_FORMATS = (
    *("png", "coco", "kitti", "sintel", "flo", "movi", "tapvid", "mp4"),
    *("bop", "mot", "yolo", "yolo_segments", "voc", "webdataset", "parquet"),
    *("lerobot", "mcap", "lve", "colmap", "nerfstudio"),
    *("instant-ngp", "3dgs", "scannet", "replica", "hypersim", "vqa", "vqa_parquet", "cosmos"),
)


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "export", help=f"write a recording as a data set: {', '.join(_FORMATS)}"
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
    parser.add_argument(
        "--flow",
        choices=("forward", "backward", "both"),
        default="forward",
        help="of kitti and sintel: to the next frame (default), to the one before",
    )
    parser.add_argument(
        "--split",
        nargs="+",
        type=float,
        metavar="SHARE",
        help="shares of train, val and test, e.g. 0.8 0.1 0.1; default: no splits",
    )
    parser.add_argument("--seed", type=int, default=0, help="of the split; default: 0")
    parser.add_argument(
        "--least-pixels",
        type=int,
        default=1,
        metavar="N",
        help="leave objects out of annotations of which fewer pixels are visible",
    )
    parser.add_argument(
        "--categories", nargs="+", default=(), metavar="NAME", help="annotate these alone"
    )
    parser.add_argument(
        "--stuff",
        nargs="+",
        default=(),
        metavar="NAME",
        help="categories that are no objects, e.g. wall floor ceiling; coco tells them apart",
    )
    parser.add_argument("--undistort", action="store_true", help="write what a pin-hole would see")
    parser.add_argument(
        "--resume", action="store_true", help="go on with an export that was broken off"
    )


def run(args: argparse.Namespace) -> int:
    """Write the data sets; 0 if all is well."""
    from sailenv_ros.dataset.formats import Splits, export
    from sailenv_ros.dataset.formats.annotation_rules import AnnotationRules

    def tell(done: int, of: int) -> None:
        if sys.stderr.isatty():
            print(f"\r{done} of {of} frames", end="", file=sys.stderr, flush=True)

    splits = None if args.split is None else Splits(tuple(args.split), args.seed)
    summary = export(
        args.path,
        args.output,
        args.formats,
        agent=args.agent,
        splits=splits,
        flow=args.flow,
        rules=AnnotationRules(
            least_pixels=args.least_pixels,
            categories=tuple(args.categories),
            stuff=tuple(args.stuff),
        ),
        undistort=args.undistort,
        resume=args.resume,
        on_frame=tell,
    )
    if sys.stderr.isatty():
        print(file=sys.stderr)
    print(f"{args.output}: {_text_of(summary)}")
    return 0


def _text_of(summary: DatasetSummary) -> str:
    lines = [f"{summary.frames} frames as {', '.join(summary.formats)}"]
    if summary.splits:
        lines[0] += f" ({told(summary.splits)})"
    for name, one in summary.formats.items():
        lines.append(f"  {name}: {told(one.written)}")
        if one.left_out:
            lines[-1] += f"; left out: {told(one.left_out)}"
    return "\n".join(lines)
