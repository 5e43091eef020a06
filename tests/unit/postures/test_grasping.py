"""Fingers that close: they touch what is held and do not go into it, on both sides alike."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.postures.grasping import (
    Grip,
    Side,
    away_from_thing,
    finger_places,
    hand_at_rest,
    with_fingers,
)
from sailenv_ros.postures.skeleton import Posture
from sailenv_ros.postures.standing import SIDES, hands_at_ease
from sailenv_ros.types.rig import Rig
from tests.support.stick_person import stick_person

FINGERS = range(2, 6)


def rig() -> Rig:
    found = stick_person().rig
    assert found is not None
    return found


def round_thing(half_m: float, side: Side = "R") -> Grip:
    return Grip(half_m=half_m, half_length_m=half_m, half_height_m=0.1, side=side)


def fingers(person: Rig, grip: Grip, closed: float) -> dict[int, list[np.ndarray]]:
    """Turns of the joints of each finger from a hand that is not turned."""
    posture = Posture(root_m=person.heads[0], turns={f"wrist.{grip.side}": np.eye(3)})
    turns = with_fingers(person, posture, grip, closed).turns
    return {
        n: [turns[f"finger{n}-{joint}.{grip.side}"] for joint in (1, 2, 3)] for n in range(1, 6)
    }


def away(person: Rig, grip: Grip, closed: float) -> dict[int, float]:
    """How far each finger's skin is from the thing [m]."""
    return {
        n: float(away_from_thing(person, grip, n, finger_places(person, grip.side, n, turns)).min())
        for n, turns in fingers(person, grip, closed).items()
    }


def angle_deg(turn: np.ndarray) -> float:
    return float(np.degrees(np.arccos(np.clip(0.5 * (np.trace(turn) - 1.0), -1.0, 1.0))))


@pytest.mark.parametrize("side", ["L", "R"])
@pytest.mark.parametrize("half_m", [0.015, 0.03, 0.05])
def test_fingers_touch_what_they_hold_and_stay_outside(half_m: float, side: Side) -> None:
    person, grip = rig(), round_thing(half_m, side)
    found = away(person, grip, 1.0)
    for finger in FINGERS:
        assert -1e-6 < found[finger] < 1e-4
    opened = away(person, grip, 0.0)
    assert all(opened[finger] > -1e-9 for finger in FINGERS)


def test_the_wider_a_thing_is_the_less_fingers_bend() -> None:
    person = rig()
    tips = [
        sum(angle_deg(turns[2]) for n, turns in fingers(person, round_thing(half), 1.0).items()
            if n in FINGERS)
        for half in (0.015, 0.03, 0.05)
    ]  # fmt: skip
    assert tips[0] > tips[1] > tips[2]


def test_fingers_lie_flat_on_a_long_thing() -> None:
    person = rig()
    slab = Grip(half_m=0.02, half_length_m=0.2, half_height_m=0.1)
    found = away(person, slab, 1.0)
    assert all(-1e-6 < found[finger] < 1e-4 for finger in FINGERS)
    flat = fingers(person, slab, 1.0)
    bent = fingers(person, round_thing(0.02), 1.0)
    assert all(angle_deg(flat[n][0].T @ flat[n][2]) < angle_deg(bent[n][0].T @ bent[n][2])
               for n in FINGERS)  # fmt: skip


def test_both_hands_are_mirror_images() -> None:
    person, mirror = rig(), np.diag([1.0, -1.0, 1.0])
    left, right = (fingers(person, round_thing(0.03, side), 1.0) for side, _ in SIDES)
    for n in range(1, 6):
        for one, other in zip(left[n], right[n], strict=True):
            assert np.allclose(mirror @ one @ mirror, other, atol=1e-9)


def test_fingers_at_ease_curl_towards_the_palm() -> None:
    person = rig()
    for side, _ in SIDES:
        _, _, palm, _ = hand_at_rest(person, side)
        turns = hands_at_ease(person, {f"lowerarm01.{each}": np.eye(3) for each, _ in SIDES})
        for n in FINGERS:
            straight = finger_places(person, side, n, [np.eye(3)] * 3)[-1, -1]
            own = [turns[f"finger{n}-{joint}.{side}"] for joint in (1, 2, 3)]
            curled = finger_places(person, side, n, own)[-1, -1]
            assert (curled - straight) @ palm > 0.005
