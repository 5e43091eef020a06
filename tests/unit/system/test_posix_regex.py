"""Extended regular expressions of POSIX: as Python's on what both know, and never slow."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.posix_regex import PosixRegex

ATOMS = st.sampled_from(["a", "b", ".", "[ab]", "[^a]", "[a-c]", "^", "$", "\\.", "\\(", "x_1"])
REPEATS = st.sampled_from(["", "", "*", "+", "?", "{2}", "{1,2}", "{2,}"])


def joined(parts: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
    """Patterns that are made of others."""
    sequences = st.lists(parts, min_size=1, max_size=3).map("".join)
    groups = st.builds("({}){}".format, parts, REPEATS)
    return sequences | groups | st.builds("{}|{}".format, parts, parts)


PATTERNS = st.recursive(
    st.builds("{}{}".format, ATOMS.filter(lambda a: a not in "^$"), REPEATS) | ATOMS, joined
)


@given(PATTERNS, st.text("ab.(cx_1", max_size=8))
def test_it_finds_what_python_finds(pattern: str, text: str) -> None:
    """On a subset that means the same in both; there `$` is not before a last line break."""
    assert PosixRegex(pattern).found_in(text) == (re.search(pattern, text) is not None)


@pytest.mark.parametrize(
    ("pattern", "text", "found"),
    [
        ("", "anything", True),
        ("^[[:alpha:]_]+[[:digit:]]$", "chair_7", True),
        ("^[[:alpha:]_]+[[:digit:]]$", "chair_77", False),
        ("[]x]", "]", True),
        ("[^]]", "]", False),
        ("[a-]", "-", True),
        ("^robot1/", "robot1/arm", True),
        ("a|", "", True),
        ("(^a|b$)", "cb", True),
        ("a**", "b", True),
        ("^(a{2}){2}$", "aaaa", True),
        ("^(a{2}){2}$", "aaa", False),
    ],
)
def test_what_posix_adds(pattern: str, text: str, found: bool) -> None:
    """Classes, brackets, empty branches, marks upon marks."""
    assert PosixRegex(pattern).found_in(text) is found


@pytest.mark.parametrize(
    "pattern",
    [
        *("(", ")", "a)", "[a", "[[:no:]]", "[[.a.]]", "*a", "a{", "a{x}", "a{3,2}", "a{256}"),
        *("\\", "\\d", "[z-a]", "(" * 60 + ")" * 60, "a" * 1001, "((a{200}){200}){200}"),
    ],
)
def test_what_is_none_is_refused(pattern: str) -> None:
    """In a sentence, and before it has taken much memory."""
    with pytest.raises(InvalidRequest, match="regular expression"):
        PosixRegex(pattern)


def test_no_pattern_is_slow() -> None:
    """One upon which others go through 2^40 ways."""
    assert not PosixRegex("^(a*)*(a|a)*(a?){30}b$").found_in("a" * 200)
