#!/usr/bin/env python3
"""Writes the messages of the viewer's socket as TypeScript, from their declarations in Python.

    scripts/page_messages.py           writes sailenv_ros/viewer/page/messages.d.ts
    scripts/page_messages.py --check   returns 1 if that file is not what would be written

What the page is told are the typed dictionaries of `viewer.messages` and `viewer.scene_messages`;
what it may ask for are the signatures of the commands, those that are operations included.
"""

from __future__ import annotations

import argparse
import inspect
import json
import sys
import types
from collections import abc
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, Literal, Union, get_args, get_origin

from typing_extensions import (
    NotRequired,
    Unpack,
    get_type_hints,
    is_typeddict,
)

from sailenv_ros.simulation.operations import Operation, Operations
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.viewer.client import OWN_COMMANDS
from sailenv_ros.viewer.command_context import Command
from sailenv_ros.viewer.commands import COMMANDS
from sailenv_ros.viewer.messages import (
    FileHead,
    FrameHead,
    HelloMessage,
    ObjectMessage,
    ObjectValues,
    RefusedMessage,
    ReplyMessage,
    SentFile,
    ShownMessage,
    StatsMessage,
    WatchEndedMessage,
)
from sailenv_ros.viewer.scene_messages import PoseValues, SceneMessage

FILE = Path(__file__).resolve().parent.parent / "sailenv_ros" / "viewer" / "page" / "messages.d.ts"

HEADER = """\
// Messages of the viewer's socket. Written by scripts/page_messages.py from the declarations in
// Python; not to be edited.
"""

SENT_FILE = """\
/** A file as the page takes it from a binary message. */
export interface SentFile {
  name: string;
  blob: Blob;
}
"""

NEWS = (HelloMessage, SceneMessage, StatsMessage, ObjectMessage, WatchEndedMessage)
ANSWERS = (ReplyMessage, RefusedMessage)
HEADS = (FrameHead, FileHead)


class Numbers:
    """Stands for NumPy's ArrayLike, which is a long union: a number, or a list of them."""


NAMES = {"ArrayLike": Numbers}

PLAIN: Mapping[Any, str] = {
    int: "number",
    float: "number",
    str: "string",
    bool: "boolean",
    bytes: "string",  # in base 64
    type(None): "null",
    Any: "any",
    object: "unknown",
    Numbers: "number | readonly number[]",
    SentFile: "SentFile",
}

ANSWERED_AS: Mapping[Any, Any] = {ObjectState: ObjectValues, Pose: PoseValues}
"""Results of operations that the page gets in another form; see `scene_json.to_json`."""

ASKED_AS: Mapping[Any, str] = {Pose: "{ position: readonly number[]; rotation: readonly number[] }"}
"""Arguments of operations that are sent in another form; see `operation_commands`."""


class Writer:
    """Collects declarations of the types that are used, in the order of their first use."""

    def __init__(self) -> None:
        self._declared: dict[str, str] = {}

    @property
    def declarations(self) -> str:
        """All that has been used by now."""
        return "\n".join(self._declared.values())

    def type_of(self, hint: Any, *, asked: bool = False) -> str:
        """Return a type as TypeScript has it; `asked` for what a page sends."""
        if asked and hint in ASKED_AS:
            return ASKED_AS[hint]
        hint = hint if asked else ANSWERED_AS.get(hint, hint)
        if hint in PLAIN:
            return PLAIN[hint]
        if is_typeddict(hint) or is_dataclass(hint):
            return self._named(hint, asked)
        origin: Any = get_origin(hint)
        args = get_args(hint)
        if origin is Literal:
            return " | ".join(json.dumps(value) for value in args)
        within = [self.type_of(one, asked=asked) for one in args if one is not ...]
        if origin in (Union, types.UnionType):
            return " | ".join(within)
        if origin is tuple and ... not in args:
            return f"{'readonly ' if asked else ''}[{', '.join(within)}]"
        if origin in (list, tuple, abc.Sequence, abc.Collection):
            item = within[0]
            item = f"({item})" if " " in item else item
            return f"{'readonly ' if asked else ''}{item}[]"
        if origin in (dict, abc.Mapping):
            return f"Record<{within[0]}, {within[1]}>"
        raise TypeError(f"{hint!r} has no form in TypeScript")

    def command(self, hints: Mapping[str, Any], signature: inspect.Signature) -> str:
        """Return what a command takes and gives."""
        taken = []
        for parameter in signature.parameters.values():
            hint = hints[parameter.name]
            variable = parameter.kind is parameter.VAR_KEYWORD
            origin: Any = get_origin(hint)
            kind = get_args(hint)[0] if origin is Unpack else hint
            needed = parameter.default is parameter.empty and not variable
            taken.append(
                f"{parameter.name}{'' if needed else '?'}: {self.type_of(kind, asked=True)}"
            )
        values = f"{{ {'; '.join(taken)} }}" if taken else "{}"
        return f"{{ values: {values}; result: {self.type_of(hints['return'])} }}"

    def _named(self, kind: Any, asked: bool) -> str:
        name: str = kind.__name__
        if name in self._declared:
            return name
        self._declared[name] = ""  # before those that it uses
        lines = [f"/** {line} */" for line in (inspect.getdoc(kind) or "").splitlines()[:1]]
        lines.append(f"export interface {name} {{")
        # By fields, not by hints: these leave out what a data class computes.
        known = {one.name for one in fields(kind)} if is_dataclass(kind) else None
        for key, hint in get_type_hints(kind, localns=NAMES, include_extras=True).items():
            if known is not None and key not in known:
                continue
            origin: Any = get_origin(hint)
            maybe = origin is NotRequired or key not in getattr(kind, "__required_keys__", {key})
            inner = get_args(hint)[0] if origin is NotRequired else hint
            lines.append(f"  {key}{'?' if maybe else ''}: {self.type_of(inner, asked=asked)};")
        self._declared[name] = "\n".join([*lines, "}", ""])
        return name


def declared(run: Callable[..., Any]) -> tuple[dict[str, Any], inspect.Signature]:
    """Return the types and the signature of a function that a command was made of."""
    function = inspect.unwrap(run)
    whole = inspect.signature(function)
    return get_type_hints(function), whole.replace(parameters=list(whole.parameters.values())[1:])


def declared_operation(name: str, command: Command) -> tuple[dict[str, Any], inspect.Signature]:
    """Return the same of a command that is an operation."""
    operation: Operation[..., Any] = getattr(Operations, name)
    hints = get_type_hints(operation.run, localns=NAMES, include_extras=True)
    if command.answer is not None:
        hints["return"] = command.answer
    return hints, operation.signature


def written() -> str:
    """Return the file."""
    writer = Writer()
    unions = []
    for name, members in (
        ("News", NEWS),
        ("Answer", ANSWERS),
        ("Head", HEADS),
        ("Shown", (ShownMessage,)),
    ):
        unions.append(f"export type {name} = {' | '.join(map(writer.type_of, members))};\n")
    commands = []
    for name in sorted({*COMMANDS, *OWN_COMMANDS}):
        if name in OWN_COMMANDS:
            hints, signature = declared(OWN_COMMANDS[name])
        elif COMMANDS[name].is_operation:
            hints, signature = declared_operation(name, COMMANDS[name])
        else:
            hints, signature = declared(COMMANDS[name].run)
        commands.append(f"  {name}: {writer.command(hints, signature)};\n")
    return "\n".join(
        [
            HEADER,
            SENT_FILE,
            writer.declarations,
            *unions,
            "/** What can be asked for, by its name. */",
            f"export interface Commands {{\n{''.join(commands)}}}\n",
        ]
    )


def main() -> int:
    """Write the file, or compare it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--check", action="store_true")
    text = written()
    if not parser.parse_args().check:
        FILE.write_text(text, encoding="utf-8")
        return 0
    if FILE.is_file() and FILE.read_text(encoding="utf-8") == text:
        return 0
    print(f"{FILE.name} is not what the declarations say; run scripts/page_messages.py")
    return 1


if __name__ == "__main__":
    sys.exit(main())
