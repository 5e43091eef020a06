"""`sailenv`: finds the subcommand's module and runs it.

A module in `COMMANDS` has ``add_parser(subparsers)`` and ``run(args) -> int``; it is imported only
where its command is named, or for the list of all.
"""

from __future__ import annotations

import argparse
import importlib
import sys
from collections.abc import Sequence

from sailenv_ros.errors import SailenvError

__all__ = ["COMMANDS", "main"]

COMMANDS = ("doctor", "scene")
"""Names of the subcommands and of their modules."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a subcommand; give its exit status.

    Returns
    -------
    status : int
        0 if all is well, 1 if what was examined has faults, 2 where the command could not be done,
        130 after Ctrl-C.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    named = [name for name in COMMANDS if words[:1] == [name]]
    parser = argparse.ArgumentParser(
        prog="sailenv", description="A virtual visual environment: its tools for the command line."
    )
    subparsers = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name in named or COMMANDS:
        importlib.import_module(f"sailenv_ros.cli.{name}").add_parser(subparsers)
    args = parser.parse_args(words)
    try:
        return int(args.run(args))
    except SailenvError as problem:
        print(f"sailenv {args.command}: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
