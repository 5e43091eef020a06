"""Walking and standing on four legs: the posture of an animal between two prints of its paws.

One paw swings while three stand, in lateral sequence. The trunk goes between the paws, and rises
and sinks as the legs below it stand upright or slanting. Paws that stand lie on their prints; the
bones above them roll forward, as far as the leg needs to reach, and legs follow by two-bone inverse
kinematics. Legs depend on prints alone, so that those of a standing animal do not move.
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.postures.animal_bearing import DOG_TAIL, TailHabit, animal_head, animal_tail
from sailenv_ros.postures.animal_figure import LEGS, AnimalFigure, animal_figure_of
from sailenv_ros.postures.easing import smooth_step
from sailenv_ros.postures.footsteps import FootPrint, Moment
from sailenv_ros.postures.limbs import bend_bones, two_bones
from sailenv_ros.postures.look import AHEAD, Look
from sailenv_ros.postures.reclining import HOCK_DEG, WRIST_DEG, Recline
from sailenv_ros.postures.skeleton import Posture, joint_frames, turn_about
from sailenv_ros.postures.walking import own_print
from sailenv_ros.types.instance_states import rotation_matrices
from sailenv_ros.types.rig import Rig
from sailenv_ros.types.rotations import between, quaternions_of

__all__ = ["PawOffset", "four_legged_posture"]

Doubles = NDArray[np.float64]

_STRETCH = 0.975
"""Share of its length to which the upper part of a leg is stretched at most."""

_ROLL_DEG = ((52.0, 62.0), (46.0, 40.0))
"""Of the bones above a paw that is one height of the leg behind its place, and how far they are
folded in the middle of a swing: in front, and behind [deg]."""

_SINK = 0.3
"""Of legs of one height whose paws are that far from below them, over the height."""

_BLADE_DEG = 30.0
"""Of a shoulder blade whose paw is one height of the leg ahead [deg]."""

_PADS_DEG = (42.0, 40.0)
"""How far a paw hangs in the middle of a swing, in front and behind [deg]."""

_HIGH = 0.19
"""How high a paw is raised in the middle of a swing, over the height of the leg."""

_SPINE = (
    ("root", -0.4, 62.0),
    ("spine01", -0.2, 60.0),
    ("spine02", 0.1, 52.0),
    ("spine03", 0.4, 36.0),
)
"""Vertebrae, their shares of a bend of the trunk, and how upright they are at most [deg]."""

_RUMP = 0.40
"""Height of the root on the haunches, over that at rest."""

_HOCK_DEG = -53.0
"""On the haunches: roll of the bones above the paws behind, which lie on the floor then [deg]."""

_MOST_BEND_DEG = 24.0
_FORWARD = np.array([1.0, 0.0, 0.0])


class PawOffset(NamedTuple):
    """How far a paw is from where it stands, over the height of its leg.

    Attributes
    ----------
    up, ahead : float
    """

    up: float = 0.0
    ahead: float = 0.0


def four_legged_posture(
    rig: Rig,
    moment: Moment,
    time_s: float,
    *,
    seed: int = 0,
    look: Look = AHEAD,
    tail: TailHabit = DOG_TAIL,
    sits: float = 0.0,
    lies: tuple[float, Recline] | None = None,
    offsets: tuple[PawOffset, PawOffset] = (PawOffset(), PawOffset()),
) -> Posture:
    """Return the posture of an animal on its way, in the frame of its body there.

    Parameters
    ----------
    rig : Rig
        With four legs.
    moment : Moment
        Of its way.
    time_s : float
        Of its breath, its tail and its glances [s].
    seed : int
        Sets those of animals apart.
    look : Look
        Where it looks.
    tail : TailHabit
    sits : float
        How far it has sat down on its haunches, 0 to 1.
    lies : tuple of float and Recline, or None
        How far it has lain down, 0 to 1, and how it lies.
    offsets : (2,) tuple of PawOffset
        Of the paws in front, and behind, of one in the air.
    """
    figure = animal_figure_of(rig)
    own = [own_print(moment, place) for place in moment.feet]
    paws = [_Paw(figure, number, place) for number, place in enumerate(own)]
    if moment.swinging >= 0:
        assert moment.goal is not None
        swing = moment.swinging
        paws[swing] = _Paw.swung(
            figure, swing, own[swing], own_print(moment, moment.goal), moment.share
        )
    lain = 0.0 if lies is None else lies[0]
    for paw in paws:
        paw.lift(figure, offsets[paw.number // 2])
    for paw in paws[2:]:
        paw.roll_deg += sits * _HOCK_DEG
        paw.knee_up = 0.6 * sits + 0.1 * lain
    root, turns = _trunk(rig, figure, paws, moment, sits)
    if lies is not None and lain:
        root, turns = _lain(rig, figure, paws, root, turns, lain, lies[1])
    blade = {}
    for paw in paws[:2]:
        ahead = (1.0 - lain) * float(np.clip(paw.ahead / figure.legs_m[paw.number], -0.9, 0.9))
        blade[f"shoulder.{paw.side}"] = turns["spine03"] @ turn_about("y", -_BLADE_DEG * ahead)
    turns |= blade
    _, places = joint_frames(rig, Posture(root_m=root, turns=turns))
    tops = [places[rig.joint_of[f"{paw.bones[0]}.{paw.side}"]] for paw in paws]
    # As low as the leg needs that is farthest from its paw.
    lower = max(0.0, *(_above_reach(rig, paw, top) for paw, top in zip(paws, tops, strict=True)))
    down = np.array([0.0, 0.0, -lower])
    root = root + down
    for paw, top in zip(paws, tops, strict=True):
        turns |= _leg(rig, paw, top + down)
    breath = float(np.sin(2.0 * np.pi * (time_s / 2.3 + 0.37 * seed)))
    turns["belly"] = turns["spine02"] @ turn_about("y", 0.9 * breath)
    turns |= animal_head(turns["spine03"], time_s, seed, look)
    carried = root + turns["root"] @ (rig.head("tail01") - rig.head("root"))
    turns |= animal_tail(
        *(rig, turns["root"], float(carried[2]), time_s),
        seed=seed,
        habit=tail,
        gladness=look.gladness,
        rests=max(sits, lain),
        room=moment.swing_room,
    )
    return Posture(root_m=root, turns=turns)


class _Paw:
    """One paw: where its joint is, how it lies, and how the bones above it are rolled.

    Parameters
    ----------
    figure : AnimalFigure
    number : int
        Of the foot.
    place : FootPrint
        Where it stands, in the frame of the body.
    """

    def __init__(self, figure: AnimalFigure, number: int, place: FootPrint) -> None:
        self.number = number
        self.bones, self.side = LEGS[number]
        rest = figure.paws[number]
        self.joint = np.array([place.x, place.y, rest[2]])
        self.yaw = place.yaw
        self.hangs_deg = self.knee_up = self.aside = 0.0
        self.ahead = place.x - float(rest[0])
        self.away = float(np.hypot(self.ahead, place.y - rest[1]))
        behind = -self.ahead / float(figure.legs_m[number])
        self.roll_deg = _ROLL_DEG[number // 2][0] * float(np.clip(behind, -0.25, 1.2))

    @classmethod
    def swung(
        cls, figure: AnimalFigure, number: int, begin: FootPrint, goal: FootPrint, share: float
    ) -> _Paw:
        """Return a paw on its way from a print to the next one."""
        eased = smooth_step(share)
        first, last = cls(figure, number, begin), cls(figure, number, goal)
        turn = (goal.yaw - begin.yaw + np.pi) % (2.0 * np.pi) - np.pi
        between = FootPrint(
            begin.x + eased * (goal.x - begin.x),
            begin.y + eased * (goal.y - begin.y),
            float(begin.yaw + eased * turn),
        )
        found = cls(figure, number, between)
        raised = float(np.sin(np.pi * share) ** 2)
        way = float(np.hypot(goal.x - begin.x, goal.y - begin.y)) / float(figure.legs_m[number])
        vigour = 0.35 + 0.65 * min(way, 1.0)
        found.joint[2] += _HIGH * vigour * raised * float(figure.legs_m[number])
        fold = _ROLL_DEG[number // 2][1] * vigour * raised
        found.roll_deg = first.roll_deg + eased * (last.roll_deg - first.roll_deg) + fold
        found.hangs_deg = _PADS_DEG[number // 2] * vigour * raised * (1.0 - 0.6 * share)
        return found

    def lift(self, figure: AnimalFigure, offset: PawOffset) -> None:
        """Raise the paw, which hangs then, and fold the leg."""
        self.joint += float(figure.legs_m[self.number]) * np.array([offset.ahead, 0.0, offset.up])
        folded = min(offset.up / _HIGH, 1.0)
        self.roll_deg += _ROLL_DEG[self.number // 2][1] * folded
        self.hangs_deg += _PADS_DEG[self.number // 2] * folded

    def from_joint(self, place: Doubles) -> tuple[float, float, float]:
        """Return how far ahead of its joint, beside and above it a place is [m]."""
        x, y, z = (turn_about("z", float(-np.degrees(self.yaw))) @ (place - self.joint)).tolist()
        return x, y, z

    def above(self, rest: Doubles, roll_deg: float) -> tuple[Doubles, Doubles]:
        """Return where the joint above is, by its place from this one at rest, and its turn."""
        turn = turn_about("z", float(np.degrees(self.yaw))) @ turn_about("y", roll_deg)
        return self.joint + turn @ rest, turn


def _trunk(
    rig: Rig, figure: AnimalFigure, paws: list[_Paw], moment: Moment, sits: float
) -> tuple[Doubles, dict[str, Doubles]]:
    """Return where the root is, and the turns of the trunk."""
    sinks, sides, yaws = [], [], []
    for pair in (paws[:2], paws[2:]):
        slant = [(paw.away / figure.legs_m[paw.number]) ** 2 for paw in pair]
        sinks.append(-_SINK * float(np.mean(slant)) * float(figure.legs_m[pair[0].number]))
        sides.append(0.5 * float(pair[0].joint[1] + pair[1].joint[1]))
        yaws.append(0.5 * (pair[0].yaw + pair[1].yaw))
    sway = 0.0
    if moment.swinging >= 0:
        # Over the side that stands.
        towards = -1.0 if moment.swinging % 2 == 0 else 1.0
        sway = 0.012 * float(figure.legs_m[0]) * towards * float(np.sin(np.pi * moment.share))
    heading = float(np.degrees(np.arctan2(sides[0] - sides[1], figure.base_m)))
    pitch = float(np.degrees((sinks[1] - sinks[0]) / figure.base_m))
    bend = float(np.clip(np.degrees(yaws[0] - yaws[1]), -_MOST_BEND_DEG, _MOST_BEND_DEG))
    # The vertebrae from the root to the chest, bent, about their middle.
    chain = [rig.head(name) for name, _, _ in _SPINE]

    def bent(sits: float) -> tuple[Doubles, dict[str, Doubles]]:
        along, turns = np.zeros(3), {}
        for number, (name, share, upright) in enumerate(_SPINE):
            yaw = turn_about("z", heading + share * bend)
            turns[name] = yaw @ turn_about("y", pitch - sits * upright)
            if number < 3:
                along = along + turns[name] @ (chain[number + 1] - chain[number])
        return along, turns

    along, turns = bent(0.0)
    moved = np.array([0.0, 0.5 * (sides[0] + sides[1]) + sway, 0.5 * (sinks[0] + sinks[1])])
    standing = figure.middle + moved - 0.5 * along
    if not sits:
        return standing, turns
    # The chest stays above the paws in front, and the trunk is as upright as the rump is low.
    chest = 0.5 * (paws[0].joint + paws[1].joint) + chain[3] - figure.paws[:2].mean(axis=0)
    low = _RUMP * float(chain[0][2])
    least, most = 0.0, 1.0
    for _ in range(12):
        middle = 0.5 * (least + most)
        drops = float(chest[2] - bent(middle)[0][2])
        least, most = (middle, most) if drops > low else (least, middle)
    along, turns = bent(sits * most)
    return (1.0 - sits) * standing + sits * (chest - along), turns


def _lain(
    rig: Rig,
    figure: AnimalFigure,
    paws: list[_Paw],
    root: Doubles,
    turns: dict[str, Doubles],
    share: float,
    recline: Recline,
) -> tuple[Doubles, dict[str, Doubles]]:
    """Return where the root is, and the turns of the trunk, of one who lies down; legs fold."""
    left, right = paws[2:]
    behind = 0.5 * (left.joint + right.joint)
    before = 0.5 * (paws[0].joint + paws[1].joint)
    heading = float(np.degrees(np.arctan2(*(before - behind)[1::-1])))
    facing = turn_about("z", heading)
    low = behind * [1.0, 1.0, 0.0] + facing @ [recline.root_m[0], 0.0, recline.root_m[1]]
    level = facing @ turn_about("y", recline.pitch_deg)
    for paw in paws:
        rolls = (WRIST_DEG, HOCK_DEG)[paw.number // 2]
        paw.roll_deg += share * (rolls - paw.roll_deg)
        paw.aside = 0.5 * share * (1.0 if paw.side == "L" else -1.0)
    begin = quaternions_of(np.array(list(turns.values())))
    end = np.broadcast_to(quaternions_of(level[None]), begin.shape)
    turned = rotation_matrices(between(begin, end, share))
    return (1.0 - share) * root + share * low, dict(zip(turns, turned, strict=True))


def _above_reach(rig: Rig, paw: _Paw, top: Doubles) -> float:
    """Return how much too high a leg begins to reach its paw [m]; negative if it is not."""
    rest = [rig.head(f"{bone}.{paw.side}") for bone in paw.bones]
    bones = [float(np.linalg.norm(end - begin)) for begin, end in itertools.pairwise(rest)]
    ahead, aside, above = paw.from_joint(top)
    most = _STRETCH * (bones[0] + bones[1])
    reach = bones[2] + float(np.sqrt(max(most**2 - aside**2, 0.0)))
    return above - 0.995 * float(np.sqrt(max(reach**2 - ahead**2, 0.0)))


def _leg(rig: Rig, paw: _Paw, top: Doubles) -> dict[str, Doubles]:
    """Return the turns of a leg from the joint that carries it to the paw."""
    names = [f"{bone}.{paw.side}" for bone in paw.bones]
    rest = [rig.head(name) for name in names]
    first, second = (float(np.linalg.norm(rest[k + 1] - rest[k])) for k in (0, 1))
    most = _STRETCH * (first + second)
    offset = rest[2] - rest[3]
    joint, turn = paw.above(offset, paw.roll_deg)
    if float(np.linalg.norm(joint - top)) > most:
        # Towards the straight leg, as far as is needed.
        ahead, _, above = paw.from_joint(top)
        straight = np.arctan2(ahead, above) - np.arctan2(offset[0], offset[2])
        near, far = paw.roll_deg, float(np.degrees(straight))
        for _ in range(16):
            middle = 0.5 * (near + far)
            joint, turn = paw.above(offset, middle)
            near, far = (middle, far) if np.linalg.norm(joint - top) > most else (near, middle)
        joint, turn = paw.above(offset, far)
    # Knees point forwards, elbows backwards.
    pole = _FORWARD if paw.number >= 2 else -_FORWARD
    facing = turn_about("z", float(np.degrees(paw.yaw)))
    points = facing @ (pole + np.array([0.0, paw.aside, 0.0])) + [0.0, 0.0, paw.knee_up]
    bent, end = two_bones(top, joint, first, second, points)
    upper, lower = bend_bones(rest[:3], (top, bent, end), pole, points)
    lies = facing @ turn_about("y", paw.hangs_deg)
    return dict(zip(names, (upper, lower, turn, lies), strict=True))
