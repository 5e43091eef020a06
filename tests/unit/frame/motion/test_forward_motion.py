"""Frames with their motion to the next one: in order, each once, whatever comes in between."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import motion, with_forward_motion
from sailenv_ros.types.views import checked_views
from tests.support.recordings import noise_frame

SURFACES = ("depth", "instance")


def frame(sequence: int, **fields: object) -> Frame:
    return noise_frame(sequence, views=SURFACES, **fields)  # type: ignore[arg-type]


def same(one: Frame, other: Frame) -> bool:
    return (one.agent, one.sequence) == (other.agent, other.sequence)


def test_each_frame_has_the_motion_to_the_agent_s_next_one() -> None:
    """Two agents in turn; frames come in their order, the last of each without motion."""
    given = [frame(1), frame(1, agent="other"), frame(2), frame(2, agent="other"), frame(3)]
    made = list(with_forward_motion(given))
    assert [(f.agent, f.sequence) for f in made] == [(f.agent, f.sequence) for f in given]
    for one, following in ((0, 2), (1, 3), (2, 4)):
        moved = motion(given[one], given[following])
        np.testing.assert_array_equal(made[one]["flow_forward"], moved.flow)
        np.testing.assert_array_equal(made[one]["scene_flow"], moved.scene_flow)
        assert np.isfinite(made[one]["flow_forward"]).any()
    for last in (3, 4):
        assert np.isnan(made[last]["flow_forward"]).all()
        assert np.isnan(made[last]["scene_flow"]).all()


def test_frames_of_one_instant_share_what_follows_and_epochs_do_not() -> None:
    """The next frame is the next of a later instant; a new epoch has nothing to do with it."""
    given = [
        frame(1),
        replace(frame(2), stamp_ns=0),
        frame(3),
        frame(4, epoch=2, stamp_ns=0),
    ]
    made = list(with_forward_motion(given, ["scene_flow"]))
    assert [f.sequence for f in made] == [1, 2, 3, 4]
    assert "flow_forward" not in made[0].views
    for k in (0, 1):
        np.testing.assert_array_equal(made[k]["scene_flow"], motion(given[k], given[2]).scene_flow)
    assert np.isnan(made[2]["scene_flow"]).all()


def test_frames_are_given_as_soon_as_the_next_one_is_there() -> None:
    """One frame late, not at the end."""
    taken = 0

    def source() -> object:
        nonlocal taken
        for number in range(1, 5):
            taken += 1
            yield frame(number)

    frames = with_forward_motion(source())  # type: ignore[arg-type]
    assert same(next(frames), frame(1))
    assert taken == 2


def test_what_cannot_be_had_is_refused_in_words() -> None:
    """Views of the next frame with the frame itself, motion without depth, states or past."""
    with pytest.raises(InvalidRequest, match=r"take motion\(frame, next_frame\)"):
        checked_views(["rgb", "scene_flow"], supported=["rgb"])
    with pytest.raises(InvalidRequest, match="among flow_forward, scene_flow"):
        next(with_forward_motion([frame(1)], ["depth"]))
    bare = noise_frame(2, views=("rgb", "depth"))
    with pytest.raises(InvalidRequest, match="without instance"):
        motion(frame(1), bare)
    with pytest.raises(InvalidRequest, match="without states"):
        motion(replace(frame(1), states=None), frame(2))
    with pytest.raises(InvalidRequest, match="one epoch"):
        motion(frame(1), frame(2, epoch=2))
    with pytest.raises(InvalidRequest, match="a Frame"):
        motion({"depth": 1}, frame(2))


def test_frames_as_agents_give_them_have_the_same_motion() -> None:
    """The dict carries what is needed."""
    one, other = frame(1), frame(2)
    expected, got = motion(one, other), motion(one.to_dict(), other.to_dict())
    for name in ("flow", "scene_flow", "valid", "occluded", "out_of_view"):
        np.testing.assert_array_equal(getattr(got, name), getattr(expected, name))
    assert got.duration_s == expected.duration_s


def test_other_histories_have_no_motion() -> None:
    """An object that was teleported, spawned or despawned in between is in no mask."""
    one, other = frame(1), frame(2)
    assert other.states is not None
    cut = replace(other, states=replace(other.states, histories=np.array([9, 2])))
    gone = replace(
        other,
        states=replace(
            other.states,
            **{
                name: getattr(other.states, name)[1:]
                for name in (
                    *("ids", "positions", "orientations", "linear_velocities"),
                    *("angular_velocities", "scales", "histories"),
                )
            },
        ),
    )
    for changed in (cut, gone):
        moved = motion(one, changed)
        its = one["instance"] == 1
        assert np.isnan(moved.flow[its]).all()
        assert not (moved.valid | moved.occluded | moved.out_of_view)[its].any()
        assert moved.valid[one["instance"] == 2].any()
