"""Arguments that several commands take."""

from __future__ import annotations

from typing import Any

__all__ = ["add_allow_modules", "add_light"]


def add_allow_modules(parser: Any) -> None:
    """Add the argument of every command that builds scenes."""
    parser.add_argument(
        "--allow-modules",
        action="store_true",
        help="let scene files have behaviours of Python modules, whose code then runs",
    )


def add_light(parser: Any, default: str) -> None:
    """Add the argument of every command whose pictures must not depend on what is baked by now."""
    parser.add_argument(
        "--light",
        choices=("baked", "plain"),
        default=default,
        help="of a room: with bounced light, baked first where it is not yet, or without"
        " (default: %(default)s)",
    )
