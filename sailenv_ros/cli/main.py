"""`sailenv`: finds the subcommand's module and runs it.

The module of a command has ``add_parser(subparsers)`` and ``run(args) -> int``; it is imported only
where its command is named, so that help appears at once and one command cannot break another.
"""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

from sailenv_ros import __version__
from sailenv_ros.cli.printing import make_printable
from sailenv_ros.errors import SailenvError
from sailenv_ros.system.interrupts import catch_interrupts
from sailenv_ros.system.memory import no_memory

__all__ = ["COMMANDS", "command_parser", "main"]

COMMANDS = {
    "behaviours": "list how objects can move of themselves, with every parameter",
    "assets": "build the furniture, list, picture and export objects, add one's own",
    "bag": "say what a recording holds, restore a damaged one",
    "bench": "measure speed and the accuracy of flow, as one table or as the paper's experiments",
    "dataset": "make data sets by recipe, check them, look at them",
    "doctor": "examine this machine: Python, ROS, OpenGL devices, scenes, shared memory",
    "eval": "show a detector the rooms' objects and score what it sees",
    "export": "write a recording as a data set: png, coco, kitti, webdataset, and others",
    "play": "publish a recording on the topics it was recorded from",
    "record": "record what agents see in an MCAP bag",
    "report": "write one page of all results of bench and eval",
    "run": "start the simulator, with or without ROS",
    "scene": "check, render, bake, import, export and begin scenes",
    "setup": "build the furniture and bake the light of the rooms, once on each machine",
    "stream": "make the published streams of continual learning as bags",
}
"""Purpose of each subcommand, by its name, which is also the name of its module."""


def command_parser(words: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser of a command line; it knows the options of the command that is named."""
    parser = argparse.ArgumentParser(
        prog="sailenv", description="A virtual visual environment: its tools for the command line."
    )
    parser.add_argument("--version", action="version", version=f"sailenv_ros {__version__}")
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, purpose in COMMANDS.items():
        if list(words[:1]) == [name]:
            importlib.import_module(f"sailenv_ros.cli.{name}").add_parser(subparsers)
        else:
            subparsers.add_parser(name, help=purpose)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand; return its exit status.

    Returns
    -------
    status : int
        0 if all is well, 1 if what was examined has errors, 2 where the command could not be done,
        130 after Ctrl-C.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    make_printable(sys.stdout, sys.stderr)
    args = command_parser(words).parse_args(words)
    catch_interrupts()
    try:
        status = int(args.run(args))
        sys.stdout.flush()  # here, where a reader that has gone is still caught
        return status
    except SailenvError as problem:
        print(f"sailenv {args.command}: {problem}", file=sys.stderr)
        return 2
    except MemoryError:
        print(f"sailenv {args.command}: {no_memory()}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:
        # Python would complain once more when it closes its output at the very end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


if __name__ == "__main__":
    sys.exit(main())
