"""Commands that the documentation shows are ones that the programs take.

Nothing is run: a service call is type-checked against its service and bound to its operation, a
`sailenv` command in a sentence is parsed by its parser, a call of an agent or a simulation in a
table is bound to its signature and checked as the operation checks it.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import inspect
import re
import shlex
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any, cast

import pytest
import yaml

from sailenv_msgs_py.services import SERVICES
from sailenv_ros.cli.main import command_parser
from sailenv_ros.ros.client.agent import Agent
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.simulation.operations.operation import Caller
from sailenv_ros.types.picture_settings import PictureSettings
from tests.packaging.pages import PAGES, sailenv_words
from tests.packaging.project import ROOT
from tests.support.faults import faults_of

CALLER = cast(Caller, SimpleNamespace(own_agent=None))
CLASSES = {"agent": Agent, "simulation": Simulation}
VALUES = {"PictureSettings": PictureSettings}
"""Data classes of which a page may show one as ``Name(…)``."""


def lines() -> Iterator[tuple[str, str]]:
    """Yield each line of each page with its place."""
    for page in PAGES:
        for number, line in enumerate(page.read_text().splitlines(), 1):
            yield f"{page.relative_to(ROOT)}:{number}", line


def found(pattern: str, *, table: bool = False) -> dict[str, str]:
    """Return what matches a pattern, by its place; `table` looks at rows of tables alone."""
    return {
        f"{place}: {match[1][:60]}": match[1]
        for place, line in lines()
        if not table or line.startswith("|")
        for match in re.finditer(pattern, line)
    }


# -- services ----------------------------------------------------------------------------------

CALLS = found(r"(?:^|\s|`)(ros2 service call [^`]+)")


def fill(message: Any, values: Mapping[str, Any]) -> None:
    """Set fields of a message from YAML, as ros2 does; a wrong name or type raises."""
    types = message.get_fields_and_field_types()
    for name, value in values.items():
        assert name in types, f"{type(message).__name__} has no field {name}: {sorted(types)}"
        field, type_ = getattr(message, name), types[name]
        if isinstance(value, Mapping):
            fill(field, value)
        elif (listed := re.fullmatch(r"sequence<(\w+)/(\w+)>", type_)) is not None:
            kind = getattr(importlib.import_module(f"{listed[1]}.msg"), listed[2])
            entries = [kind() for _ in value]
            for entry, given in zip(entries, value, strict=True):
                fill(entry, given)
            setattr(message, name, entries)
        else:
            setattr(message, name, type(field)(value) if isinstance(field, float) else value)


def test_service_calls_have_the_fields_of_their_services() -> None:
    """And an operation of ours takes what they say."""
    assert faults_of(check_call, CALLS) == {}


def check_call(call: str) -> None:
    """Make the request, and bind it to the operation."""
    words = shlex.split(call)
    name, type_ = words[3], words[4]
    package, _, kind = type_.split("/")
    service_type = getattr(importlib.import_module(f"{package}.srv"), kind)
    request = service_type.Request()
    fill(request, yaml.safe_load(words[5]) if len(words) > 5 else {})
    if package != "sailenv_msgs":
        return
    service = SERVICES[name.rpartition("/")[2]]
    assert service.type is service_type
    of_agent = name.count("/") == 3
    assert of_agent == service.of_agent
    args, kwargs = service.arguments(request)
    bound = service.operation.bind(CALLER, args, kwargs)
    check_changes(service.operation, bound)


def check_changes(operation: Operation[..., Any], bound: inspect.BoundArguments) -> None:
    """Refuse changes of a picture that no picture has."""
    if operation.name == "set_picture":
        PictureSettings().changed(bound.arguments.get("changes", {}))


# -- the command line --------------------------------------------------------------------------

INLINE = found(r"`(sailenv [a-z][^`]*)`")


def options_of(line: str) -> list[str]:
    """Return the words after ``sailenv``."""
    words = shlex.split(line, comments=True)
    return sailenv_words(words[words.index("sailenv") + 1 :])


def test_commands_in_sentences_are_parsed(monkeypatch: pytest.MonkeyPatch) -> None:
    """They may leave out what they need, and name an option without its value; no more."""

    def leave(self: argparse.ArgumentParser, status: int = 0, message: str | None = None) -> None:
        raise HelpShown

    def refuse(self: argparse.ArgumentParser, message: str) -> None:
        raise ValueError(message)

    monkeypatch.setattr(argparse.ArgumentParser, "exit", leave)
    monkeypatch.setattr(argparse.ArgumentParser, "error", refuse)
    assert faults_of(check_line, INLINE) == {}


def check_line(line: str) -> None:
    """Parse a command."""
    words = options_of(line)
    try:
        command_parser(words).parse_args(words)
    except HelpShown:
        assert "--help" in words
    except ValueError as problem:
        if not re.search("are required|expected (one|at least one) argument", str(problem)):
            raise


class HelpShown(Exception):
    """The parser has shown its help instead."""


# -- Python ------------------------------------------------------------------------------------

ONE_LINERS = found(r"`((?:agent|simulation)\.\w+(?:\(.*?\))?)`(?=[^`]*\|)", table=True)
ONE_LINERS = {
    place: code
    for place, code in ONE_LINERS.items()
    # Parameters of the node are called so, too, in their own table.
    if not re.fullmatch(r"docs/parameters\.md:\d+: agent\.\w+", place)
}


def value_of(node: ast.expr) -> Any:
    """Return a value that a one-liner tells: a literal, or a data class."""
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return VALUES[node.func.id]()
    return ast.literal_eval(node)


def test_one_liners_of_tables_fit_their_signatures() -> None:
    """An operation checks its arguments as well."""
    assert faults_of(check_one_liner, ONE_LINERS) == {}


def check_one_liner(code: str) -> None:
    """Bind what is called to its signature; what is not called is no function."""
    node = ast.parse(code.replace("…", "..."), mode="eval").body
    call = node if isinstance(node, ast.Call) else None
    attribute = node.func if isinstance(node, ast.Call) else node
    assert isinstance(attribute, ast.Attribute)
    assert isinstance(attribute.value, ast.Name)
    member = getattr(CLASSES[attribute.value.id], attribute.attr)
    if call is None:
        assert not callable(member)
        return
    args = tuple(value_of(arg) for arg in call.args)
    kwargs = {str(keyword.arg): value_of(keyword.value) for keyword in call.keywords}
    if isinstance(member, Operation):
        check_changes(member, member.bind(CALLER, args, kwargs))
    else:
        inspect.signature(member).bind(CALLER, *args, **kwargs)


def test_there_are_commands() -> None:
    """The tests above have something to look at."""
    assert len(CALLS) >= 6
    assert len(INLINE) > 50
    assert len(ONE_LINERS) >= 6
