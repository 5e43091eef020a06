"""`sailenv bag`: say what a recording holds, restore a damaged one."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sailenv_ros.recording.mcap.recovery import Recovered

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "bag", help="say what a recording holds, restore a damaged one"
    )
    parser.set_defaults(run=run)
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    info = actions.add_parser("info", help="list topics, counts and frames")
    info.add_argument("path", type=Path, metavar="BAG", help="a bag's folder or an MCAP file")
    recover = actions.add_parser(
        "recover",
        help="restore what is whole of a damaged recording",
        description="Restore every whole chunk. The damaged file is kept beside the restored one,"
        " as FILE.damaged, unless the result goes elsewhere by -o.",
    )
    recover.add_argument("path", type=Path, metavar="FILE", help="an MCAP file or a bag's folder")
    recover.add_argument("-o", "--output", type=Path, metavar="OUT", help="new file to write to")


def run(args: argparse.Namespace) -> int:
    """Do what was asked; 0 if all is well."""
    return _info(args.path) if args.action == "info" else _recover(args.path, args.output)


def _info(path: Path) -> int:
    from sailenv_ros.recording.reader import RecordingReader

    with RecordingReader(path) as reader:
        seconds = (reader.end_ns - reader.start_ns) * 1e-9
        print(f"{path}: {len(reader)} messages over {seconds:.3f} s")
        width = max((len(topic.name) for topic in reader.topics), default=0)
        for topic in reader.topics:
            print(f"  {topic.name:<{width}}  {len(reader.rows(topic.name)):>7}  {topic.type}")
    return 0


def _recover(path: Path, output: Path | None) -> int:
    from sailenv_ros.recording.bag_recovery import recover
    from sailenv_ros.recording.mcap.recovery import recover_file

    done = recover(path) if output is None else [recover_file(path, output)]
    for recovered in done:
        print(_summary(recovered))
    if not done:
        print(f"{path}: nothing to restore, it is whole")
    return 0


def _summary(recovered: Recovered) -> str:
    kept = f"; the damaged file is {recovered.kept}" if recovered.kept else ""
    return (
        f"{recovered.path}: restored {recovered.messages} messages; damaged or incomplete chunks:"
        f" {recovered.lost_chunks}, unread: {recovered.unread_bytes} bytes{kept}"
    )
