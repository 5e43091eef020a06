"""Extended regular expressions of POSIX (IEEE 1003.1, chapter 9.4), matched in linear time.

Patterns are untrusted: an automaton of limited size reads each character once, where a
matcher that tries one way after another may need years. Without back-references, collating
symbols and equivalence classes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Final

from sailenv_ros.errors import InvalidRequest

__all__ = ["PosixRegex"]

MOST_STATES = 5_000
"""Greatest size of an automaton; each repetition of ``{m,n}`` counts."""

_MOST_CHARACTERS = 1_000
_MOST_REPEATS = 255
_DEEPEST = 50

_CLASSES: Final[dict[str, Callable[[str], bool]]] = {
    "alnum": str.isalnum,
    "alpha": str.isalpha,
    "blank": lambda c: c in " \t",
    "cntrl": lambda c: ord(c) < 32 or ord(c) == 127,
    "digit": lambda c: c in "0123456789",
    "graph": lambda c: c.isprintable() and c != " ",
    "lower": str.islower,
    "print": str.isprintable,
    "punct": lambda c: c.isprintable() and not c.isalnum() and not c.isspace(),
    "space": str.isspace,
    "upper": str.isupper,
    "xdigit": lambda c: c in "0123456789abcdefABCDEF",
}


@dataclass(slots=True)
class _State:
    """One state: consumes a character that `takes` accepts, or passes on at once.

    A state without `takes` passes on to each of `then`, at the text's begin or end alone if `at`
    says so.
    """

    takes: Callable[[str], bool] | None = None
    then: tuple[int, ...] = ()
    at: str = ""


class PosixRegex:
    """A compiled pattern.

    Parameters
    ----------
    pattern : str

    Raises
    ------
    InvalidRequest
        If it is not one, or its automaton is too large.
    """

    def __init__(self, pattern: str) -> None:
        if len(pattern) > _MOST_CHARACTERS:
            raise InvalidRequest("regular expression", pattern, "at most 1000 characters long")
        self._pattern = pattern
        self._place = 0
        self._depth = 0
        self._states: list[_State] = []
        end = self._add(_State())
        self._start = self._alternatives(end)
        if self._place < len(pattern):
            raise self._wrong("without a ')' that closes nothing")
        self._end = end

    def found_in(self, text: str) -> bool:
        """Return whether some part of a text matches; ``^`` and ``$`` are its ends."""
        present: set[int] = set()
        for place in range(len(text) + 1):
            reached = self._reached([*present, self._start], place, len(text))
            if self._end in reached:
                return True
            if place < len(text):
                present = self._after(reached, text[place])
        return False

    # -- matching --------------------------------------------------------------------------

    def _reached(self, begin: Iterable[int], place: int, length: int) -> set[int]:
        reached: set[int] = set()
        waiting = list(begin)
        while waiting:
            number = waiting.pop()
            if number in reached:
                continue
            reached.add(number)
            state = self._states[number]
            here = {"": True, "begin": place == 0, "end": place == length}[state.at]
            if state.takes is None and here:
                waiting += state.then
        return reached

    def _after(self, reached: set[int], character: str) -> set[int]:
        states = (self._states[number] for number in reached)
        return {s.then[0] for s in states if s.takes is not None and s.takes(character)}

    # -- compiling: each takes the state that follows and returns the one that begins -----------

    def _alternatives(self, follows: int) -> int:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise self._wrong(f"nested at most {_DEEPEST} deep")
        starts = [self._branch(follows)]
        while self._next() == "|":
            self._place += 1
            starts.append(self._branch(follows))
        self._depth -= 1
        return starts[0] if len(starts) == 1 else self._add(_State(then=tuple(starts)))

    def _branch(self, follows: int) -> int:
        pieces: list[tuple[int, list[tuple[int, int | None]]]] = []
        while self._next() not in ("", "|", ")"):
            at = self._place
            self._atom(follows)  # its end is found; it is built below, from the last to the first
            repeats = []
            while (repeat := self._repeat()) is not None:
                repeats.append(repeat)
            pieces.append((at, repeats))
        end = self._place
        for at, repeats in reversed(pieces):
            follows = self._repeated(at, repeats, follows)
        self._place = end
        return follows

    def _repeated(self, at: int, repeats: list[tuple[int, int | None]], follows: int) -> int:
        """Build the atom at a place, repeated as the first and all further marks say."""
        if not repeats:
            self._place = at
            return self._atom(follows)
        *inner, (least, most) = repeats
        start = follows
        if most is None:
            loop = self._add(_State())
            body = self._repeated(at, inner, loop)
            self._states[loop].then = (body, follows)
            start = loop
        else:
            for _ in range(most - least):
                start = self._add(_State(then=(self._repeated(at, inner, start), follows)))
        for _ in range(least):
            start = self._repeated(at, inner, start)
        return start

    def _atom(self, follows: int) -> int:
        character = self._take()
        if character == "(":
            start = self._alternatives(follows)
            if self._next() != ")":
                raise self._wrong("with a ')' for each '('")
            self._place += 1
            return start
        if character in "*+?{":
            raise self._wrong(f"with something before {character!r}")
        if character in "^$":
            at = "begin" if character == "^" else "end"
            return self._add(_State(then=(follows,), at=at))
        if character == ".":
            return self._add(_State(lambda c: True, (follows,)))
        if character == "[":
            return self._add(_State(self._bracket(), (follows,)))
        if character == "\\":
            character = self._take()
            if character.isalnum():
                raise self._wrong("without '\\' before letters and digits")
        return self._add(_State(character.__eq__, (follows,)))

    def _repeat(self) -> tuple[int, int | None] | None:
        """Read ``*``, ``+``, ``?`` or ``{m,n}``; None if there is none."""
        marks: dict[str, tuple[int, int | None]] = {"*": (0, None), "+": (1, None), "?": (0, 1)}
        character = self._next()
        if character in marks:
            self._place += 1
            return marks[character]
        if character != "{":
            return None
        text = self._until("}", 1)
        least, comma, most = text.partition(",")
        if not least.isdecimal() or (most and not most.isdecimal()):
            raise self._wrong("with whole numbers in '{m,n}'")
        low = int(least)
        high = low if not comma else int(most) if most else None
        if low > _MOST_REPEATS or (high is not None and not low <= high <= _MOST_REPEATS):
            raise self._wrong(f"with m up to n, and n up to {_MOST_REPEATS}, in '{{m,n}}'")
        return low, high

    def _bracket(self) -> Callable[[str], bool]:
        negated = self._next() == "^"
        self._place += negated
        parts: list[Callable[[str], bool]] = []
        first = True
        while self._next() != "]" or first:
            first = False
            parts.append(self._bracket_part())
        self._place += 1
        return lambda c: any(part(c) for part in parts) != negated

    def _bracket_part(self) -> Callable[[str], bool]:
        rest = self._pattern[self._place : self._place + 2]
        if rest == "[:":
            name = self._until(":]", 2)
            if name not in _CLASSES:
                raise self._wrong(f"with classes that are one of: {', '.join(_CLASSES)}")
            return _CLASSES[name]
        if rest in ("[.", "[="):
            raise self._wrong("without collating symbols and equivalence classes")
        low = high = self._take()
        if self._next() == "-" and self._pattern[self._place + 1 : self._place + 2] not in (
            "]",
            "",
        ):
            self._place += 1
            high = self._take()
            if high < low:
                raise self._wrong("with ranges that ascend")
        return lambda c: low <= c <= high

    # -- reading ---------------------------------------------------------------------------

    def _next(self) -> str:
        return self._pattern[self._place : self._place + 1]

    def _take(self) -> str:
        character = self._next()
        if not character:
            raise self._wrong("whole; it ends too early")
        self._place += 1
        return character

    def _until(self, mark: str, skipped: int) -> str:
        begin = self._place + skipped
        end = self._pattern.find(mark, begin)
        if end < 0:
            raise self._wrong(f"with a {mark!r} at the end of it")
        self._place = end + len(mark)
        return self._pattern[begin:end]

    def _add(self, state: _State) -> int:
        if len(self._states) >= MOST_STATES:
            raise self._wrong("smaller: its repetitions make it too large")
        self._states.append(state)
        return len(self._states) - 1

    def _wrong(self, accepted: str) -> InvalidRequest:
        return InvalidRequest("regular expression", self._pattern, f"one of POSIX, {accepted}")
