"""Behaviours of people, with a person that only notes what it is told."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.behaviours import BodyState, RunningBehaviour, start_behaviour
from sailenv_ros.behaviours.person import ClipPlay
from sailenv_ros.types.geometry import Pose


class NotedPerson:
    """A person who arrives at once when time goes on."""

    def __init__(self, *, seats: tuple[str, ...] = ("sofa", "chair")) -> None:
        self.activity = "standing"
        self.told: list[tuple[str, Any]] = []
        self._seats = seats

    def random_place(self, rng: np.random.Generator) -> tuple[float, float] | None:
        return float(rng.uniform(-2.0, 2.0)), float(rng.uniform(-2.0, 2.0))

    def walk_to(self, place: tuple[float, float]) -> bool:
        return self._walks("walk", place)

    def walk_near(self, name: str) -> bool:
        return name != "nothing" and self._walks("near", name)

    def sit_on(self, name: str) -> bool:
        return self._walks("sit", name)

    def lie_on(self, name: str) -> bool:
        return self._walks("lie", name)

    def play(self, play: ClipPlay) -> bool:
        return self._walks("play", play)

    holds = ""

    def take(self, name: str) -> bool:
        self.holds = name
        return self._walks("take", name)

    def put_on(self, name: str) -> bool:
        self.holds = ""
        return self._walks("put", name)

    def open(self, name: str) -> bool:
        return self._walks("open", name)

    def get_up(self) -> None:
        self.told.append(("up", None))
        self.activity = "standing"

    def seats(self) -> tuple[str, ...]:
        return self._seats

    def beds(self) -> tuple[str, ...]:
        return ("bed",)

    def things(self) -> tuple[str, ...]:
        return "table", "lamp"

    def look_at(self, name: str) -> None:
        self.told.append(("look", name))

    def arrive(self) -> None:
        if self.activity == "walking":
            rests = {"sit": "seated", "lie": "lying"}
            self.activity = rests.get(self.told[-1][0], "standing")

    def _walks(self, what: str, where: Any) -> bool:
        self.told.append((what, where))
        self.activity = "walking"
        return True


def running(kind: str, **parameters: Any) -> RunningBehaviour:
    return start_behaviour(kind, parameters, seed=5, object_name="anna", place=0)


def live(behaviour: RunningBehaviour, person: NotedPerson, seconds: float) -> None:
    for tick in range(round(seconds / 0.1)):
        state = BodyState(
            pose=Pose(),
            linear_velocity=np.zeros(3),
            angular_velocity=np.zeros(3),
            mass_kg=70.0,
            person=person,
        )
        behaviour.act(0.1 * tick, state)
        if tick % 10 == 9:
            person.arrive()


def test_one_walks_from_place_to_place_with_pauses() -> None:
    person = NotedPerson()
    live(running("walk_around", pause=(0.5, 0.6)), person, 20.0)
    places = [where for what, where in person.told if what == "walk"]
    assert 6 <= len(places) <= 20
    assert len(set(places)) == len(places)


def test_one_sits_for_a_while_and_gets_up() -> None:
    person = NotedPerson()
    live(running("sit", sitting=(2.0, 2.5), pause=(0.2, 0.3)), person, 20.0)
    words = [what for what, _ in person.told]
    assert words[:4] == ["sit", "up", "sit", "up"]
    assert {where for what, where in person.told if what == "sit"} <= {"sofa", "chair"}


def test_one_sits_on_named_seats_alone() -> None:
    person = NotedPerson()
    live(running("sit", seats=["chair"], sitting=(1.0, 1.0)), person, 12.0)
    assert {where for what, where in person.told if what == "sit"} == {"chair"}
    nobody = NotedPerson(seats=())
    live(running("sit"), nobody, 5.0)
    assert nobody.told == []


def test_one_lies_for_a_while_and_gets_up() -> None:
    person = NotedPerson()
    live(running("lie", lying=(2.0, 2.5), pause=(0.2, 0.3)), person, 20.0)
    assert person.told[:4] == [("lie", "bed"), ("up", None), ("lie", "bed"), ("up", None)]
    other = NotedPerson()
    live(running("lie", beds=["sofa"]), other, 5.0)
    assert other.told == []


def test_one_plays_a_clip_again_and_again() -> None:
    person = NotedPerson()
    clip = "pybullet_data:data/motions/humanoid3d_walk.txt"
    live(running("play_clip", clip=clip, times=3, place=[1.0, 2.0], pause=(0.2, 0.3)), person, 9.0)
    assert len(person.told) > 2
    assert set(person.told) == {("play", ClipPlay(clip, 3, 1.0, (1.0, 2.0), None))}


def test_one_fetches_things_and_stops() -> None:
    person = NotedPerson()
    live(
        running("fetch", objects=["mug"], to=["table", "desk"], times=2, pause=(0.1, 0.2)),
        person,
        20.0,
    )
    assert person.told == [("take", "mug"), ("put", "table"), ("take", "mug"), ("put", "desk")]


def test_one_opens_doors_in_turn() -> None:
    person = NotedPerson()
    live(running("open_by_hand", joints=["door", "drawer"], pause=(0.1, 0.2)), person, 6.0)
    assert person.told[:3] == [("open", "door"), ("open", "drawer"), ("open", "door")]


def test_one_visits_things_in_turn_and_looks_at_them() -> None:
    person = NotedPerson()
    live(running("visit", objects=["lamp", "nothing", "table"], pause=(0.1, 0.2)), person, 12.0)
    assert [where for what, where in person.told if what == "near"][:4] == [
        "lamp",
        "table",
        "lamp",
        "table",
    ]
    assert ("look", "lamp") in person.told


@pytest.mark.parametrize("kind", ["walk_around", "sit", "lie", "visit"])
def test_the_same_seed_tells_the_same(kind: str) -> None:
    first, second = NotedPerson(), NotedPerson()
    live(running(kind), first, 10.0)
    live(running(kind), second, 10.0)
    assert first.told == second.told
    assert first.told


@pytest.mark.parametrize("kind", ["walk_around", "sit", "lie", "visit"])
def test_nothing_is_done_where_there_is_no_person(kind: str) -> None:
    state = BodyState(
        pose=Pose(), linear_velocity=np.zeros(3), angular_velocity=np.zeros(3), mass_kg=1.0
    )
    assert not running(kind).act(0.0, state).acts
