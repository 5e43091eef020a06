"""Messages of a client as checked values, whatever they hold."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.viewer.request_arguments import Arguments, arguments_of_text

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=8,
)


@given(st.text())
def test_any_text_is_read_or_refused(text: str) -> None:
    """Nothing but the one error comes of it."""
    with contextlib.suppress(InvalidRequest):
        arguments_of_text(text)


@pytest.mark.parametrize(
    "text",
    [
        '{"a": NaN}',
        '{"a": Infinity}',
        "[1]",
        "3",
        "[" * 100_000,
        "",
        '{"a": 1e999}',
        '{"a": 99999999999999999999}',
    ],
)
def test_what_is_no_object_of_numbers_is_refused(text: str) -> None:
    """NaN is no JSON, a list no message, and depth no way to fill the stack."""
    with pytest.raises(InvalidRequest, match="message"):
        arguments_of_text(text)


@given(JSON)
def test_every_reader_gives_its_type_or_refuses(value: object) -> None:
    """A value of another type never gets through."""
    given_ = Arguments({"x": value}, "message")
    readers = {
        given_.text: str,
        given_.integer: int,
        given_.number: float,
        given_.flag: bool,
        given_.mapping: dict,
        given_.entries: list,
    }
    for reader, kind in readers.items():
        with contextlib.suppress(InvalidRequest):
            assert type(reader("x")) is kind


def test_only_bytes_in_base_64_are_data() -> None:
    assert Arguments({"x": "AAEC"}, "message").data("x") == b"\0\1\2"
    for wrong in ("A", "äöü=", 3, None):
        with pytest.raises(InvalidRequest, match="base 64"):
            Arguments({"x": wrong}, "message").data("x")


def test_a_missing_value_is_refused_by_name() -> None:
    """The sentence names it; a flag that is missing is false, a mapping empty."""
    nothing = Arguments({}, "message")
    with pytest.raises(InvalidRequest, match="agent"):
        nothing.text("agent")
    assert nothing.flag("overwrite") is False
    assert nothing.mapping("changes") == {}
    assert nothing.optional_text("title") is None
