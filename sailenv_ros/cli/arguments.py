"""Arguments that several commands take."""

from __future__ import annotations

from typing import Any

__all__ = ["add_allow_modules"]


def add_allow_modules(parser: Any) -> None:
    """Add the argument of every command that builds scenes."""
    parser.add_argument(
        "--allow-modules",
        action="store_true",
        help="let scene files have behaviours of Python modules, whose code then runs",
    )
