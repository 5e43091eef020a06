"""Arguments that several commands take."""

from __future__ import annotations

from typing import Any

from sailenv_ros.types.light_choice import LIGHTS, STEADY_LIGHTS, SteadyLight

__all__ = ["add_allow_modules", "add_any_light", "add_light"]


def add_allow_modules(parser: Any) -> None:
    """Add the argument of every command that builds scenes."""
    parser.add_argument(
        "--allow-modules",
        action="store_true",
        help="let scene files have behaviours of Python modules, whose code then runs",
    )


def add_light(parser: Any, default: SteadyLight) -> None:
    """Add the argument of every command whose pictures must not depend on what is baked by now."""
    parser.add_argument(
        "--light",
        choices=STEADY_LIGHTS,
        default=default,
        help="of a room: with bounced light, baked first where it is not yet, or without"
        " (default: %(default)s)",
    )


def add_any_light(parser: Any) -> None:
    """Add the argument of every command that shows a scene as it can be shown now."""
    parser.add_argument(
        "--light",
        choices=LIGHTS,
        default="newest",
        help="of a room: what is baked by now; the finished light, or an error; without bounced"
        " light (default: %(default)s)",
    )
