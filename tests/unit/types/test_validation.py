"""What counts as a number, an integer, a switch, a vector; and the sentences that refuse others."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.validation import (
    IDENTIFIER,
    checked_flag,
    checked_integer,
    checked_number,
    is_finite_number,
    is_integer,
    is_number,
    vector,
)


@pytest.mark.parametrize("value", [0, -3, 2.5, np.float32(2.5), np.int64(7), np.uint8(1)])
def test_numbers_of_python_and_numpy_are_numbers(value: float) -> None:
    assert is_number(value)
    assert is_finite_number(value)
    assert type(checked_number("x", value, -10.0, 10.0)) is float


@pytest.mark.parametrize("value", [True, np.True_, "1", None, 1j, np.complex64(1), [1.0]])
def test_nothing_else_is_a_number(value: object) -> None:
    """Booleans least of all: ``rate_hz=True`` is a mistake, not 1 Hz."""
    assert not is_number(value)
    assert not is_integer(value)
    with pytest.raises(InvalidRequest, match=r"^x must be a number from 0 to 2.5 \[m\], got "):
        checked_number("x", value, 0.0, 2.5, unit="m")


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 10**400, np.float32("nan")])
def test_what_no_float_can_hold_is_not_finite(value: float) -> None:
    assert is_number(value)
    assert not is_finite_number(value)
    with pytest.raises(InvalidRequest, match="a number from 0 to 1"):
        checked_number("x", value, 0.0, 1.0)


def test_the_ends_of_a_range_belong_to_it() -> None:
    assert checked_number("x", 0, 0.0, 1.0) == 0.0
    assert checked_number("x", 1, 0.0, 1.0) == 1.0
    with pytest.raises(InvalidRequest):
        checked_number("x", np.nextafter(1.0, 2.0), 0.0, 1.0)


def test_integers_are_told_in_full() -> None:
    """Not as 1.04858e+06, which nobody could type."""
    assert type(checked_integer("n", np.int16(3), 0, 3)) is int
    for wrong in (3.0, 2**20 + 1, -1, True):
        with pytest.raises(InvalidRequest, match="an integer from 0 to 1048576"):
            checked_integer("n", wrong, 0, 2**20)


def test_a_switch_is_a_boolean() -> None:
    assert checked_flag("on", True) is True
    for wrong in (0, 1, "true", None):
        with pytest.raises(InvalidRequest, match=r"^on must be true or false"):
            checked_flag("on", wrong)


@pytest.mark.parametrize("values", [(1, 2), (1, 2, 3, 4), (0, 0, math.nan), "abc", None, 7, {}])
def test_a_vector_is_three_finite_numbers(values: object) -> None:
    assert vector("v", np.arange(3)) == (0.0, 1.0, 2.0)
    with pytest.raises(InvalidRequest, match=r"^v must be three finite numbers"):
        vector("v", values)  # type: ignore[arg-type]  # on purpose


def test_a_vector_keeps_its_limit() -> None:
    assert vector("v", (5, -5, 0), limit=5) == (5.0, -5.0, 0.0)
    with pytest.raises(InvalidRequest, match="within ±5"):
        vector("v", (5.1, 0, 0), limit=5)


@pytest.mark.parametrize("name", ["", "A", "1a", "_a", "a-b", "a\n", "ä", "a" * 64])
def test_identifiers_are_plain(name: str) -> None:
    assert IDENTIFIER.fullmatch("a" * 63)
    assert not IDENTIFIER.fullmatch(name)
