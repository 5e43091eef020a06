"""People who play clips: they go there, move as recorded, and stand where the clip ended."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.behaviours.person import ClipPlay
from sailenv_ros.errors import InvalidRequest
from tests.support.peopled_worlds import box, one, person, placed, world_of

WALK = "pybullet_data:data/motions/humanoid3d_walk.txt"


def test_one_plays_a_clip_where_it_is_told_and_goes_along_with_it() -> None:
    world = world_of(person("anna", -1.0, 0.0), placed("far", box("b", (0.3, 0.3, 0.5)), 5, 5))
    anna = one(world, "anna")
    world.step(1)
    assert anna.walker.play(ClipPlay(WALK, times=2, place=(-0.5, 0.5), facing_deg=0.0))
    seen, last, fastest = [], None, 0.0
    for _ in range(600):
        world.step(8)
        seen.append(anna.walker.activity)
        joints = anna.skeleton().joints
        if last is not None:
            fastest = max(fastest, float(np.linalg.norm(joints - last, axis=1).max()))
        last = joints
        if seen[-1] == "standing":
            break
    assert list(dict.fromkeys(seen)) == ["walking", "playing", "standing"]
    x, y = anna.pose().position_m[:2]
    assert x > 1.5  # two rounds of about 1.2 m
    assert abs(y - 0.5) < 0.5
    assert fastest < 0.35  # in 1/30 s: nothing jumps
    feet = anna.skeleton().joint_names.index("foot.L")
    assert np.linalg.norm(joints[feet][:2] - [x, y]) < 0.3
    world.close()


def test_a_clip_is_refused_where_there_is_no_room() -> None:
    wall = placed("wall", box("w", (0.2, 3.0, 1.0)), 0.3, 0.0, static=True)
    world = world_of(person("anna", -1.0, 0.0), wall)
    anna = one(world, "anna")
    world.step(1)
    assert not anna.walker.play(ClipPlay(WALK, facing_deg=0.0))
    assert "no room for the clip" in anna.walker.problem
    assert anna.walker.play(ClipPlay(WALK, facing_deg=180.0))
    world.close()


def test_the_behaviour_plays_again_after_a_pause() -> None:
    world = world_of(
        person("anna", 0.0, 0.0, "play_clip", clip=WALK, pause=(0.1, 0.2), place=[0.0, 0.0]),
        placed("far", box("b", (0.3, 0.3, 0.5)), 5, 5),
    )
    anna = one(world, "anna")
    seen = []
    for _ in range(500):
        world.step(12)
        seen.append(anna.walker.activity)
    changes = [word for word, before in zip(seen[1:], seen, strict=False) if word != before]
    assert changes.count("playing") >= 2
    assert "walking" in changes  # back to its place
    world.close()


def test_clips_that_cannot_be_read_are_refused_before_anything_moves() -> None:
    with pytest.raises(InvalidRequest, match=r"must be a clip that can be read.*no such clip"):
        start_behaviour("play_clip", {"clip": "none such"}, seed=1, object_name="anna", place=0)
    with pytest.raises(InvalidRequest, match="is no name of a clip"):
        start_behaviour("play_clip", {"clip": "../walk"}, seed=1, object_name="anna", place=0)
