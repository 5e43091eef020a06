"""Functions as commands: a message's values are what their parameters declare, or are refused."""

from __future__ import annotations

import asyncio
import base64
from typing import Any, Literal

import pytest

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.types.lights import LightAttributes
from sailenv_ros.viewer.request_arguments import Arguments
from sailenv_ros.viewer.scene_messages import Vector3
from sailenv_ros.viewer.served_commands import served


@served
async def command(
    context: str,
    name: str,
    count: int,
    share: float,
    kind: Literal["a", "b"],
    size: Vector3,
    data: bytes,
    views: list[str],
    attributes: LightAttributes | None = None,
    frame: int | None = None,
    first: bool = False,
) -> tuple[Any, ...]:
    """Return all that it was given."""
    return context, name, count, share, kind, size, data, views, attributes, frame, first


GIVEN = {
    "do": "command",
    "id": 3,
    "name": "lamp",
    "count": 2,
    "share": 0.5,
    "kind": "a",
    "size": [1, 2, 3],
    "data": base64.b64encode(b"bytes").decode(),
    "views": ["rgb"],
}
NEEDED = ("here", "lamp", 2, 0.5, "a", (1.0, 2.0, 3.0), b"bytes", ["rgb"])


def answer(**changes: Any) -> Any:
    """What the command gives for the message with some values of others."""

    async def asked() -> Any:
        return await command("here", Arguments({**GIVEN, **changes}, "message"))

    return asyncio.run(asked())


def test_values_come_as_their_declared_types() -> None:
    """What is left out or null is as the function has it."""
    assert answer() == (*NEEDED, None, None, False)
    assert answer(frame=None) == (*NEEDED, None, None, False)
    given = {"attributes": {"intensity": 2.0}, "frame": 4, "first": True}
    assert answer(**given) == (*NEEDED, {"intensity": 2.0}, 4, True)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("name", 3),
        ("name", None),
        ("count", 1.5),
        ("count", "2"),
        ("share", "half"),
        ("kind", ["a"]),
        ("size", [1, 2]),
        ("size", None),
        ("data", "ä"),
        ("views", "rgb"),
        ("views", [1]),
        ("attributes", [1]),
        ("frame", "last"),
        ("first", 1),
    ],
)
def test_values_of_other_types_are_refused(name: str, value: object) -> None:
    """With the name of the value in the sentence."""
    with pytest.raises(InvalidRequest, match=name):
        answer(**{name: value})


def test_values_of_other_names_are_refused() -> None:
    """With the names that there are."""
    with pytest.raises(UnknownName, match=r"argument of command.*'frame'"):
        answer(fram=3)
