"""Head, ears and tail of an animal: where it looks, how it carries its tail, and how it wags it."""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.animal_figure import animal_figure_of
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.look import Look
from sailenv_ros.postures.skeleton import turn_about
from sailenv_ros.types.rig import Rig

__all__ = ["CAT_TAIL", "DOG_TAIL", "TailHabit", "animal_head", "animal_tail", "tail_habit"]

Doubles = NDArray[np.float64]

_MOST_LOOK_DEG = (75.0, 40.0)
_GLANCE_S = 2.6

_SWAY_DEG, _SWAY_HZ = 13.0, 0.45
"""How far, and how often, the tip of a tail sways that tells nothing [deg], [Hz]."""

_UPRIGHT_DEG, _ROUND_DEG = 94.0, 170.0
"""Of a tail that has no room behind: of one who stands, and of one who rests [deg]."""

_STEEPEST = 0.8
"""Sine of the steepest slope on which a tail goes down to the floor."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TailHabit:
    """How animals of a kind carry and move their tails.

    Attributes
    ----------
    glad_up_deg : float
        How far the tail of a glad one rises at least [deg].
    wag_deg : float
        How far it swings then, to either side [deg].
    wag_hz : float
        How often, for legs of 1 m; shorter ones go faster, as pendulums do.
    base_share : float
        Share of the swing that the base has; the tip has all.
    lag : float
        Phase by which each joint follows the one before it [rad].
    curl_deg : float
        How far it lies round the body of one who rests [deg].
    """

    glad_up_deg: float
    wag_deg: float
    wag_hz: float
    base_share: float
    lag: float
    curl_deg: float


CAT_TAIL = TailHabit(
    glad_up_deg=88.0, wag_deg=24.0, wag_hz=0.28, base_share=0.0, lag=0.4, curl_deg=115.0
)
DOG_TAIL = TailHabit(
    glad_up_deg=38.0, wag_deg=36.0, wag_hz=1.45, base_share=0.7, lag=0.3, curl_deg=30.0
)


def tail_habit(category: str) -> TailHabit:
    """Return the habit of animals of a category; all but cats do as dogs do."""
    return CAT_TAIL if category == "cat" else DOG_TAIL


def animal_head(chest: Doubles, time_s: float, seed: int, look: Look) -> dict[str, Doubles]:
    """Return the turns of neck, head and ears, which look at something, or here and there."""
    at_ease = 34.0 * _glance(time_s, seed, 1), 9.0 * _glance(time_s, seed, 2)
    yaw, pitch = look.within(_MOST_LOOK_DEG, at_ease)
    facing = float(np.degrees(np.arctan2(chest[1, 0], chest[0, 0])))

    def share(part: float) -> Doubles:
        return turn_about("z", facing + part * yaw) @ turn_about("y", part * pitch)

    turns = {"neck01": share(0.25), "neck02": share(0.6), "head": share(1.0)}
    for number, side in enumerate("LR", start=3):
        turns[f"ear.{side}"] = turns["head"] @ turn_about("z", 7.0 * _glance(time_s, seed, number))
    return turns


def _glance(time_s: float, seed: int, kind: int) -> float:
    """Return where something looks that rests, and then turns elsewhere: -1 to 1."""
    phase = time_s / _GLANCE_S + 0.31 * seed + 0.17 * kind
    number = int(np.floor(phase))

    def chosen(turn: int) -> float:
        return float(np.sin(12.9898 * turn + 78.233 * kind + 3.7 * seed) * 43758.5453 % 2.0 - 1.0)

    eased = smooth_step(min((phase - number) / 0.25, 1.0))
    return chosen(number - 1) + eased * (chosen(number) - chosen(number - 1))


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class _Tail:
    """Bones of a tail at rest: names, how they rise [deg], and their length [m]."""

    names: tuple[str, ...]
    rises_deg: Doubles
    bone_m: float


_known: WeakKeyDictionary[Rig, _Tail] = WeakKeyDictionary()


def _tail_of(rig: Rig) -> _Tail:
    if rig not in _known:
        names = tuple(name for name in rig.names if name.startswith("tail"))
        ways = np.diff(np.array([rig.head(name) for name in names]), axis=0)
        rises = np.degrees(np.arctan2(ways[:, 2], -ways[:, 0]))
        _known[rig] = _Tail(
            names=names,
            rises_deg=np.append(rises, rises[-1]),
            bone_m=float(np.linalg.norm(ways[0])),
        )
    return _known[rig]


def animal_tail(
    rig: Rig,
    pelvis: Doubles,
    height_m: float,
    time_s: float,
    *,
    seed: int,
    habit: TailHabit,
    gladness: float,
    rests: float,
    room: float,
) -> dict[str, Doubles]:
    """Return the turns of a tail: it sways, it wags, and it lies on the floor behind who rests.

    Parameters
    ----------
    pelvis : (3, 3) float64
        Turn of what carries it.
    height_m : float
        Of its base, over where it lies.
    time_s : float
    seed : int
    habit : TailHabit
    gladness : float
        0 to 1.
    rests : float
        How far the animal has sat or lain down, 0 to 1.
    room : float
        Share of the room that it has to swing; without, it is held up, or lies round the body.
    """
    tail, count = _tail_of(rig), len(_tail_of(rig).names)
    legs_m = float(animal_figure_of(rig).legs_m.mean())
    heading = turn_about("z", float(np.degrees(np.arctan2(pelvis[1, 0], pelvis[0, 0]))))
    tilt = float(np.degrees(np.arctan2(-pelvis[2, 0], pelvis[0, 0])))
    mean = float(tail.rises_deg[:4].mean())
    raised = gladness * max(habit.glad_up_deg - mean, 0.0)
    curl = habit.curl_deg + (1.0 - room) * max(_ROUND_DEG - habit.curl_deg, 0.0)
    phase = 2.0 * np.pi * time_s * habit.wag_hz / np.sqrt(legs_m)
    side = 1.0 if seed % 2 else -1.0
    above_m = height_m
    thick_m = 0.075 * legs_m
    turns = {}
    for number, name in enumerate(tail.names):
        tip = (number + 1) / count
        carried = float(tail.rises_deg[number]) + tilt + raised * min(1.0, 0.4 + 0.3 * number)
        carried += (1.0 - room**2) * min(1.0, 0.8 + 0.2 * number) * (_UPRIGHT_DEG - carried)
        # Ever less steeply down to the floor.
        slope = float(np.clip((above_m - thick_m) / (2.2 * tail.bone_m), -0.3, _STEEPEST))
        above_m -= slope * tail.bone_m
        rise = (1.0 - rests) * carried - rests * float(np.degrees(np.arcsin(slope)))
        sway = (
            tip
            * _SWAY_DEG
            * np.sin(2.0 * np.pi * (_SWAY_HZ * time_s + 0.29 * seed) - 0.55 * number)
        )
        wag = habit.wag_deg * (habit.base_share + (1.0 - habit.base_share) * tip**2)
        wag *= float(np.sin(phase + 0.29 * seed - habit.lag * number))
        aside = (1.0 - gladness) * sway + gladness * wag
        aside *= 0.35 + 0.65 * room
        aside += rests * (1.0 - 0.5 * gladness * room) * side * curl * max(tip - 0.15, 0.0)
        turns[name] = (
            heading
            @ turn_about("y", rise)
            @ turn_about("z", float(aside))
            @ turn_about("y", -float(tail.rises_deg[number]))
        )
    return turns
