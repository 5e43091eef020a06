"""`sailenv bench`: the paper's experiments and the speed benchmarks, on this machine."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from sailenv_ros.cli import bench_all, bench_endless
from sailenv_ros.cli.experiment import add_common

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "bench",
        help="measure speed and the accuracy of flow",
        description="Measure this machine: every benchmark as one table (docs/performance.md), or"
        " the paper's experiments (docs/experiments.md).",
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="EXPERIMENT")
    bench_all.add_parser(actions)
    speed = actions.add_parser(
        "flow-speed", help="time of a frame with flow, beside OpenCV's estimates and networks"
    )
    add_common(speed)
    speed.add_argument("--frames", type=int, default=100, metavar="N", help="of each method")
    speed.add_argument("--size", nargs="+", metavar="WxH", help="default: the paper's six")
    speed.add_argument("--scene", default="room_01")
    speed.add_argument("--in-process", action="store_true", help="without ROS and DDS")
    _add_networks(speed)
    accuracy = actions.add_parser(
        "flow-accuracy", help="error of flow against the motion field of plain arithmetic"
    )
    add_common(accuracy)
    accuracy.add_argument("--pairs", type=int, default=20, metavar="N", help="of pictures")
    accuracy.add_argument(
        "--gaps",
        nargs="+",
        type=int,
        default=[1],
        metavar="N",
        help="frames from one picture of a pair to the other",
    )
    accuracy.add_argument("--size", default="640x480", metavar="WxH")
    accuracy.add_argument("--scenario", nargs="+", metavar="NAME", help="default: all")
    _add_networks(accuracy)
    streams = actions.add_parser(
        "streams", help="flow, templates and Horn-Schunck on the streams of `sailenv stream`"
    )
    add_common(streams)
    streams.add_argument("--pairs", type=int, default=100, metavar="N", help="of each stream")
    streams.add_argument("--stream", nargs="+", metavar="NAME", help="default: all six")
    streams.add_argument("--seed", type=int, default=0, help="default: %(default)s")
    bench_endless.add_parser(actions)
    through = actions.add_parser(
        "throughput",
        help="frames per second by size, views, agents, scene, transport; other renderers",
    )
    add_common(through)
    through.add_argument("--frames", type=int, default=60, metavar="N", help="of each case")
    through.add_argument(
        "--size", nargs="+", metavar="WxH", help="default: 320x240 640x480 1280x960"
    )
    through.add_argument("--scene", nargs="+", metavar="NAME", help="the first is the base case's")
    through.add_argument("--agents", type=int, nargs="+", metavar="N", help="default: 1 4")
    through.add_argument("--transport", nargs="+", metavar="NAME", help="default: all")
    through.add_argument("--no-renderers", action="store_true", help="ours alone")
    through.add_argument("--full", action="store_true", help="every combination of all of these")


def _add_networks(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--network", type=Path, nargs="+", default=[], metavar="FILE",
        help="flow networks: .onnx, or TorchScript",
    )  # fmt: skip
    parser.add_argument(
        "--network-white", type=float, default=255.0, metavar="X",
        help="what white is in their input: 255 or 1 (default: %(default)g)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Do one of them; 0 if all is well."""
    if args.action == "all":
        return bench_all.every_part(args)
    if args.action == "streams":
        from sailenv_ros.cli.bench_streams import streams

        return streams(args)
    if args.action == "endless":
        return bench_endless.endless(args)
    if args.action == "throughput":
        from sailenv_ros.cli.bench_throughput import throughput

        return throughput(args)
    from sailenv_ros.cli.bench_flow import flow_accuracy, flow_speed

    return flow_speed(args) if args.action == "flow-speed" else flow_accuracy(args)
