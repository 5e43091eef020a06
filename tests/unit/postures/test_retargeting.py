"""Recorded motion on another body: bones point as recorded, and feet that stand do not slide."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

from sailenv_ros.assets.motions import find_clip
from sailenv_ros.assets.motions.bvh import read_bvh
from sailenv_ros.errors import AssetError
from sailenv_ros.postures.figure import figure_of
from sailenv_ros.postures.retargeting import RetargetedClip, retargeted
from sailenv_ros.postures.skeleton import joint_frames, turn_about
from sailenv_ros.types.humanoid import humanoid_of
from tests.support.bvh_files import CMU, DAZ, KNEES, bvh_text
from tests.support.stick_person import stick_person

RIG = stick_person().rig
assert RIG is not None

_AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Ours from the file's: x is its z, y its x, z its y."""


def clip_of(*frames: Mapping[str, np.ndarray], **more: object) -> RetargetedClip:
    return RetargetedClip(read_bvh("a.bvh", bvh_text(frames, **more).encode()), RIG)  # type: ignore[arg-type]


def direction(clip: RetargetedClip, first: str, second: str, time_s: float = 0.0) -> np.ndarray:
    _, places = joint_frames(RIG, clip.posture(time_s))
    bone = places[RIG.joint_of[second]] - places[RIG.joint_of[first]]
    return np.asarray(bone / np.linalg.norm(bone))


def in_file(turn: np.ndarray) -> np.ndarray:
    """A rotation about our axes as the file has it."""
    return np.asarray(_AXES.T @ turn @ _AXES)


@pytest.mark.parametrize("names", [CMU, DAZ, KNEES], ids=["CMU", "DAZ", "knees"])
@pytest.mark.parametrize("unit", [1.0, 100.0, 2.54])
def test_names_and_units_do_not_matter(names: Mapping[str, str], unit: float) -> None:
    lifted = {"left upper arm": in_file(turn_about("x", 60.0))}
    clip = clip_of({}, lifted, names=names, unit=unit)
    assert direction(clip, "upperarm01.L", "lowerarm01.L") == pytest.approx([0, 1, 0], abs=1e-6)
    assert direction(clip, "upperarm01.R", "lowerarm01.R") == pytest.approx([0, -1, 0], abs=1e-6)
    up = np.radians(60.0)
    then = direction(clip, "upperarm01.L", "lowerarm01.L", 1.0 / 60.0)
    assert then == pytest.approx([0, np.cos(up), np.sin(up)], abs=1e-5)


def test_legs_bend_as_recorded_and_turns_add_up() -> None:
    sits = {
        "left thigh": in_file(turn_about("y", -90.0)),
        "left shin": in_file(turn_about("y", 90.0)),
    }
    clip = clip_of(sits)
    thigh = direction(clip, "upperleg01.L", "lowerleg01.L")
    shank = direction(clip, "lowerleg01.L", "foot.L")
    assert thigh[0] > 0.97
    assert shank[2] < -0.97
    # A person who turns round takes arms along.
    turned = clip_of({}, {"hips": in_file(turn_about("z", 90.0))})
    arm = direction(turned, "upperarm01.L", "lowerarm01.L", 1.0 / 60.0)
    assert arm == pytest.approx([-1, 0, 0], abs=1e-5)
    assert turned.end[2] == pytest.approx(np.pi / 2.0)


def test_the_first_frame_is_at_the_origin_and_looks_along_x() -> None:
    away = in_file(turn_about("z", 130.0))
    frames = [
        {"hips": away, "place": np.array([3.0, 0.93, -2.0]) + k * (_AXES.T @ [0.1, 0.0, 0.0])}
        for k in range(4)
    ]
    clip = clip_of(*frames)
    assert clip.way[0] == pytest.approx([0.0, 0.0])
    assert direction(clip, "upperarm01.L", "lowerarm01.L") == pytest.approx([0, 1, 0], abs=1e-6)
    # It goes where its way led: along x of the file's person turned by -130 degrees, by its legs.
    scale = figure_of(RIG).leg_m / 0.82
    ahead = turn_about("z", -130.0) @ [0.3 * scale, 0.0, 0.0]
    assert clip.way[-1] == pytest.approx(ahead[:2], abs=1e-5)


def test_a_first_frame_of_rest_is_left_out() -> None:
    hangs = {"left upper arm": in_file(turn_about("x", -80.0))}
    clip = clip_of({}, *[hangs] * 5)
    assert direction(clip, "upperarm01.L", "lowerarm01.L")[2] < -0.9
    assert clip.duration_s == pytest.approx(4.0 / 60.0, abs=1e-5)


def test_feet_that_stand_do_not_slide() -> None:
    # Both feet slide by 4 cm in a second: badly recorded standing.
    frames = [{"place": np.array([0.0, 0.93, 0.04 * k / 60.0])} for k in range(60)]
    clip = clip_of(*frames)
    assert all(planting.stands.all() for planting in clip.planting)
    assert slides(clip) < 1e-6
    assert clip.way[-1, 0] - clip.way[0, 0] > 0.03  # the hips go along


def test_feet_of_a_recorded_walk_do_not_slide_and_do_not_sink() -> None:
    clip = retargeted(find_clip("pybullet_data:data/motions/humanoid3d_walk.txt"), RIG)
    assert clip is retargeted(find_clip("pybullet_data:data/motions/humanoid3d_walk.txt"), RIG)
    assert slides(clip) < 0.01
    assert clip.way[-1, 0] > 1.0
    for planting in clip.planting:
        assert 0.25 < planting.stands.mean() < 0.8
        assert np.abs(planting.moved).max() < 0.08
    assert lowest_ball(clip) > -0.005


def slides(clip: RetargetedClip) -> float:
    """How far a ball of a foot that stands gets from where it began to stand [m]."""
    figure, worst = figure_of(RIG), 0.0
    frame_s = clip.duration_s / (len(clip.way) - 1)
    begun: list[np.ndarray | None] = [None, None]
    for time_s in np.arange(0.0, clip.duration_s, 1.0 / 240.0):
        turns, places = joint_frames(RIG, clip.posture(float(time_s)))
        frame = int(time_s / frame_s)
        for k, side in enumerate("LR"):
            stands = clip.planting[k].stands
            foot = RIG.joint_of[f"foot.{side}"]
            ball = places[foot] + turns[foot] @ figure.ball
            if not stands[frame] or not stands[min(frame + 1, len(stands) - 1)]:
                begun[k] = None
                continue
            start = begun[k] = ball if begun[k] is None else begun[k]
            assert start is not None
            worst = max(worst, float(np.linalg.norm((ball - start)[:2])))
    return worst


def lowest_ball(clip: RetargetedClip) -> float:
    lowest = 1.0
    for time_s in np.arange(0.0, clip.duration_s, 1.0 / 60.0):
        turns, places = joint_frames(RIG, clip.posture(float(time_s)))
        for side in "LR":
            foot = RIG.joint_of[f"foot.{side}"]
            lowest = min(lowest, float((places[foot] + turns[foot] @ figure_of(RIG).ball)[2]))
    return lowest


def test_skeletons_that_are_no_peoples_are_refused() -> None:
    text = bvh_text([{}])
    with pytest.raises(AssetError, match="no joint has 'left' or 'l' and 'foot' or 'ankle'"):
        humanoid_of(read_bvh("a.bvh", text.replace("LeftFoot", "LeftPaw").encode()))
    with pytest.raises(AssetError, match="no joint has 'head'"):
        humanoid_of(read_bvh("a.bvh", text.replace(" Head", " Top").encode()))
    narrow = text.replace("OFFSET 0.100000 -0.050000", "OFFSET 0 -0.05")
    narrow = narrow.replace("OFFSET -0.100000 -0.050000", "OFFSET 0 -0.05")
    with pytest.raises(AssetError, match="its hips have no width"):
        humanoid_of(read_bvh("a.bvh", narrow.encode()))
    bone = "JOINT {}\n{{\nOFFSET 0 {} 0\n"
    parts = [bone.format(*part) for part in (("LeftFoot", -1), ("Head", 1))]
    few = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 1 Xrotation\n" + "}\n".join(parts)
    few += "}\n}\nMOTION\nFrames: 1\nFrame Time: 0.1\n0\n"
    with pytest.raises(AssetError, match="'Hips' has too few joints above it"):
        humanoid_of(read_bvh("a.bvh", few.encode()))
