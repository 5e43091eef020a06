"""`sailenv play`: publish a recording on the topics it was recorded from."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from sailenv_ros.cli.node_process import become_node

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "play", help="publish a recording on the topics it was recorded from"
    )
    parser.set_defaults(run=run)
    parser.add_argument("path", type=Path, metavar="BAG", help="a bag's folder or an MCAP file")
    parser.add_argument("--rate", type=float, default=1.0, help="recorded seconds per second")
    parser.add_argument("--loop", action="store_true", help="begin anew at the end")
    parser.add_argument("--start", type=float, default=0.0, metavar="S", help="start here [s]")
    parser.add_argument("--paused", action="store_true", help="wait for the service resume")
    parser.add_argument("--topics", nargs="+", default=[], metavar="NAME", help="default: all")
    parser.add_argument("--no-clock", action="store_true", help="leave /clock alone")


def run(args: argparse.Namespace) -> int:
    """Become the player node."""
    parameters: dict[str, object] = {
        "input": str(args.path),
        "rate": args.rate,
        "loop": args.loop,
        "start_s": args.start,
        "paused": args.paused,
        "clock": not args.no_clock,
    }
    if args.topics:
        parameters["topics"] = args.topics
    become_node("player", parameters)
