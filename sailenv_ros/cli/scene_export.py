"""`sailenv scene export` and `sailenv assets export`: files for other programs."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from sailenv_ros.cli.arguments import add_allow_modules
from sailenv_ros.scene_export import ExportReport, export_asset, export_scene
from sailenv_ros.scene_export.formats import ASSET_FORMATS, SCENE_FORMATS

if TYPE_CHECKING:
    from sailenv_ros.frame.frame import Frame

__all__ = ["add_asset_arguments", "add_arguments", "export_one_asset", "export_one_scene"]


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `sailenv scene export`."""
    parser.add_argument(
        "scene", metavar="SCENE", help="a YAML file, a scene's name, or generated:KIND:SEED"
    )
    _add_output(parser, tuple(SCENE_FORMATS))
    parser.add_argument(
        "--time", type=float, default=0.0, metavar="S", help="simulated time of the moment"
    )
    parser.add_argument(
        "--duration", type=float, default=0.0, metavar="S", help="write its motion for so long, too"
    )
    parser.add_argument(
        "--rate", type=float, default=24.0, metavar="HZ", help="samples of the motion a second"
    )
    parser.add_argument(
        "--light",
        choices=("lamps", "baked"),
        default="lamps",
        help="baked: .glb, .usda and .usdz with a light map",
    )
    parser.add_argument(
        "--motion", type=Path, metavar="BAG", help="write the motion of a recording of the scene"
    )
    add_allow_modules(parser)


def add_asset_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of `sailenv assets export`."""
    parser.add_argument(
        "name", metavar="NAME", help="of an object, or of a piece from a seed: FAMILY~STYLE:SEED"
    )
    _add_output(parser, tuple(ASSET_FORMATS))


def export_one_scene(args: argparse.Namespace) -> int:
    """Export a scene; report what came of it."""
    path = Path(args.scene)
    with ExitStack() as stack:
        frames: Sequence[Frame] = ()
        if args.motion is not None:
            from sailenv_ros.recording.frames import RecordedFrames
            from sailenv_ros.recording.reader import RecordingReader

            frames = RecordedFrames(stack.enter_context(RecordingReader(args.motion)), "")
        report = export_scene(
            path if path.is_file() else args.scene,
            args.output,
            at_s=args.time,
            duration_s=args.duration,
            rate_hz=args.rate,
            frames=frames,
            light=args.light,
            overwrite=args.overwrite,
            allow_modules=args.allow_modules,
        )
    return _print(report)


def export_one_asset(args: argparse.Namespace) -> int:
    """Export an object; report what came of it."""
    return _print(export_asset(args.name, args.output, overwrite=args.overwrite))


def _add_output(parser: argparse.ArgumentParser, suffixes: tuple[str, ...]) -> None:
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="FILE",
        help=f"ends in one of: {', '.join(suffixes)}",
    )
    parser.add_argument("--overwrite", action="store_true", help="replace what is there")


def _print(report: ExportReport) -> int:
    beside = "" if report.folder is None else f" and {report.folder}"
    print(
        f"{report.file}{beside}: {report.objects} objects, {report.instances} instances, "
        f"{report.triangles} triangles, {report.size_bytes / 1e6:.1f} MB"
    )
    for loss in report.losses:
        print(f"lost: {loss}")
    return 0
