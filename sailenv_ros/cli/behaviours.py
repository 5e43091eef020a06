"""`sailenv behaviours`: list how objects can move of themselves, with every parameter."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from typing import Any

from sailenv_ros.behaviours import BehaviourKind, behaviour_kinds
from sailenv_ros.errors import UnknownName

__all__ = ["add_parser", "run"]


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "behaviours", help="list how objects can move of themselves, with every parameter"
    )
    parser.set_defaults(run=run)
    parser.add_argument("types", nargs="*", metavar="TYPE", help="only these (default: all)")


def run(args: argparse.Namespace) -> int:
    """Print the behaviours; 0."""
    kinds = behaviour_kinds()
    for type_ in args.types:
        if type_ not in kinds:
            raise UnknownName("behaviour", type_, kinds)
    print("\n\n".join("\n".join(_lines(kinds[type_])) for type_ in args.types or sorted(kinds)))
    return 0


def _lines(kind: BehaviourKind) -> Iterator[str]:
    yield f"{kind.type}: {kind.summary}"
    fields = kind.parameters.model_fields
    width = max(map(len, fields))
    for name, field in fields.items():
        default = "needed" if field.is_required() else f"default {_shown(field.default)}"
        yield f"  {name:<{width}}  {field.description} ({default})"


def _shown(value: object) -> str:
    if value is None or value == "":
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, tuple):
        return f"[{', '.join(map(_shown, value))}]"
    return f"{value:g}" if isinstance(value, float) else str(value)
