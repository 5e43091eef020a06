"""A person, as behaviours see one: it is told where to go, and says what it does."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Protocol, TypeAlias

import numpy as np
from pydantic import Field

from sailenv_ros.behaviours.base import Action, BehaviourKind, BehaviourParameters, BodyState
from sailenv_ros.scene.field_types import Number

__all__ = [
    "Activity",
    "ClipPlay",
    "Person",
    "PersonParameters",
    "Rest",
    "in_turn",
    "pause",
    "person_behaviour",
    "resting_behaviour",
]

Activity: TypeAlias = Literal[
    "standing",
    "walking",
    "sitting down",
    "seated",
    "lying down",
    "lying",
    "getting up",
    "playing",
    "reaching",
]

Seconds = Annotated[float, Number(least=0.0, most=1e5, unit="s")]

_PAUSES_AFTER = frozenset({"walking", "playing", "reaching"})

ASK_AGAIN_S = 0.5
"""Time after which one who found no way asks again [s]."""


class ClipPlay(NamedTuple):
    """Order to play a clip of recorded motion.

    Attributes
    ----------
    clip : str
        Its name.
    times : int
        How often, without a pause.
    speed : float
        1 as it was recorded.
    place : (2,) tuple of float or None
        Where it begins [m]; None for here.
    facing_deg : float or None
        About the vertical, at the beginning [deg]; None for any.
    """

    clip: str
    times: int = 1
    speed: float = 1.0
    place: tuple[float, float] | None = None
    facing_deg: float | None = None


class Person(Protocol):
    """A person who can walk, sit and look."""

    @property
    def activity(self) -> Activity:
        """Activity now."""

    def random_place(self, rng: np.random.Generator) -> tuple[float, float] | None:
        """Return a free place that it can reach [m]; None if there is none."""

    def walk_to(self, place: tuple[float, float]) -> bool:
        """Begin to walk to a place [m]; False, and nothing begins, if no way leads there."""

    def walk_near(self, name: str) -> bool:
        """Begin to walk to where it stands before an object and faces it; False if it cannot."""

    def sit_on(self, name: str) -> bool:
        """Begin to walk to a seat and sit down; False if it cannot."""

    def lie_on(self, name: str) -> bool:
        """Begin to walk to a bed and lie down; False if it cannot."""

    def play(self, play: ClipPlay) -> bool:
        """Begin to walk to where a clip is played, and play it; False if it cannot."""

    @property
    def holds(self) -> str:
        """Name of what it has in its hand; empty for nothing."""

    def take(self, name: str) -> bool:
        """Begin to walk to a thing and take it in the hand; False if it cannot."""

    def put_on(self, name: str) -> bool:
        """Begin to walk to a piece and put on it what it holds; False if it cannot."""

    def open(self, name: str) -> bool:
        """Begin to walk to a door or a drawer and open or close it; False if it cannot."""

    def get_up(self) -> None:
        """Begin to get up, if it sits or lies."""

    def seats(self) -> tuple[str, ...]:
        """Return the names of seats that nobody has taken."""

    def beds(self) -> tuple[str, ...]:
        """Return the names of what it can lie on and nobody has taken."""

    def things(self) -> tuple[str, ...]:
        """Return the names of furniture that one may look at."""

    def look_at(self, name: str) -> None:
        """Look at an object from now on; the empty name looks ahead."""


class PersonParameters(BehaviourParameters):
    """Base of the parameters of behaviours of people."""

    legs: ClassVar[tuple[int, ...]] = (2,)

    pause: tuple[Seconds, Seconds] = Field(
        default=(1.0, 4.0), description="shortest and longest pause [s]"
    )


PersonFunction: TypeAlias = Callable[
    [Any, float, Person, dict[str, Any], np.random.Generator], object
]
"""Called with parameters, time [s], the person, memory and random numbers; returns whether anything
began: what says False is asked again soon."""


def person_behaviour(
    type_: str, parameters: type[PersonParameters]
) -> Callable[[PersonFunction], BehaviourKind]:
    """Turn what one who stands and has paused begins into a behaviour kind; used as a decorator."""

    def decorate(function: PersonFunction) -> BehaviourKind:
        def act(
            given: PersonParameters,
            time_s: float,
            person: Person | None,
            memory: dict[str, Any],
            rng: np.random.Generator,
        ) -> None:
            if person is None or time_s < 0.0 or person.activity != "standing":
                memory["walks"] = person is not None and person.activity in _PAUSES_AFTER
            elif memory.pop("walks", False):
                pause(given, time_s, memory, rng)
            elif not _waits(memory, time_s) and not function(given, time_s, person, memory, rng):
                memory["until_s"] = time_s + ASK_AGAIN_S

        return _kind(type_, parameters, act, function.__doc__)

    return decorate


def in_turn(names: Sequence[str], memory: dict[str, Any]) -> str:
    """Return the next of some names, the first one after the last."""
    number = memory["number"] = int(memory.get("number", -1)) + 1
    return names[number % len(names)]


def pause(
    parameters: PersonParameters, time_s: float, memory: dict[str, Any], rng: np.random.Generator
) -> None:
    """Wait for a random time."""
    low, high = parameters.pause
    memory["until_s"] = time_s + float(rng.uniform(low, max(low, high)))


class Rest(NamedTuple):
    """A way to rest.

    Attributes
    ----------
    word : str
        Activity of one who rests.
    span_s : (2,) tuple of float
        Shortest and longest time of it [s].
    wanted : tuple of str
        Names of pieces; none for all that are free.
    free : callable
        Returns the names of pieces that are free.
    begin : callable
        ``begin(name)`` goes there; False if it cannot.
    """

    word: Activity
    span_s: tuple[float, float]
    wanted: tuple[str, ...]
    free: Callable[[], tuple[str, ...]]
    begin: Callable[[str], bool]


def resting_behaviour(
    type_: str, parameters: type[PersonParameters]
) -> Callable[[Callable[[Any, Person], Rest]], BehaviourKind]:
    """Turn a way to rest into a behaviour kind; used as a decorator."""

    def decorate(function: Callable[[Any, Person], Rest]) -> BehaviourKind:
        def act(
            given: PersonParameters,
            time_s: float,
            person: Person | None,
            memory: dict[str, Any],
            rng: np.random.Generator,
        ) -> None:
            if person is not None and time_s >= 0.0:
                _rest_somewhere(given, function(given, person), time_s, person, memory, rng)

        return _kind(type_, parameters, act, function.__doc__)

    return decorate


def _kind(
    type_: str, parameters: type[PersonParameters], act: Callable[..., None], doc: str | None
) -> BehaviourKind:
    """Return the kind of a behaviour that gives orders to a person, and moves no body itself."""

    def behave(
        given: PersonParameters,
        time_s: float,
        body: BodyState,
        memory: dict[str, Any],
        rng: np.random.Generator,
    ) -> Action:
        act(given, time_s, body.person, memory, rng)
        return Action()

    behave.__doc__ = doc
    return BehaviourKind(type=type_, parameters=parameters, function=behave)


def _rest_somewhere(
    parameters: PersonParameters,
    rest: Rest,
    time_s: float,
    person: Person,
    memory: dict[str, Any],
    rng: np.random.Generator,
) -> None:
    """Go where one can rest, rest for a while, get up, and pause."""
    if person.activity == rest.word:
        low, high = rest.span_s
        until = memory.setdefault("up_s", time_s + float(rng.uniform(low, max(low, high))))
        if time_s >= until:
            person.get_up()
        return
    if person.activity != "standing":
        return
    if memory.pop("up_s", None) is not None:
        pause(parameters, time_s, memory, rng)
        return
    if _waits(memory, time_s):
        return
    free = rest.free()
    wanted = [name for name in rest.wanted or free if name in free]
    for place in rng.permutation(len(wanted)).tolist():
        if rest.begin(wanted[place]):
            return
    memory["until_s"] = time_s + ASK_AGAIN_S


def _waits(memory: dict[str, Any], time_s: float) -> bool:
    """Return whether one who behaves waits until a time that its memory has."""
    return bool(time_s < memory.get("until_s", 0.0))
