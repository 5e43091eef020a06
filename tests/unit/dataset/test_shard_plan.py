"""Shards by arithmetic: every clip once, whatever the sizes."""

from __future__ import annotations

from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.dataset.recipe import DatasetRecipe
from sailenv_ros.dataset.shard_plan import ShardPlan, clip_groups
from tests.unit.dataset.conftest import SMALL

sizes = st.integers(0, 40)


def plan_of(**changes: Any) -> ShardPlan:
    return ShardPlan(DatasetRecipe.model_validate({**SMALL, "name": "x", **changes}))


@given(
    train=st.integers(1, 40),
    val=sizes,
    test=sizes,
    per_shard=st.integers(1, 20),
    last_seed=st.integers(3, 30),
)
def test_every_clip_is_in_one_shard(
    train: int, val: int, test: int, per_shard: int, last_seed: int
) -> None:
    """Numbers go on without a gap; shards have one split; scenes come equally often."""
    plan = plan_of(
        clips={"train": train, "val": val, "test": test},
        shard={"clips": per_shard},
        scenes=[{"scene": "optical"}, {"generate": "kitchen", "seeds": [3, last_seed]}],
    )
    shards = [plan.shard(number) for number in range(plan.shards)]
    clips = [clip for shard in shards for clip in shard.clips]
    assert [clip.number for clip in clips] == list(range(plan.clips))
    assert [shard.number for shard in shards] == list(range(plan.shards))
    for shard in shards:
        assert {clip.split for clip in shard.clips} == {shard.split}
        assert len(shard.clips) <= per_shard
        assert all(plan.shard_of_clip(clip.number) == shard.number for clip in shard.clips)
    assert plan.frames == plan.clips * 3 * 2
    for split, size in (("train", train), ("val", val), ("test", test)):
        counts: dict[str, int] = {}
        for clip in clips:
            if clip.split == split:
                counts[str(clip.scene)] = counts.get(str(clip.scene), 0) + 1
        scenes = last_seed - 3 + 2
        assert sum(counts.values()) == size
        assert not counts or max(counts.values()) <= -(-size // scenes)
        assert size < scenes or len(counts) == scenes


@given(per_shard=st.integers(1, 30), per_scene=st.integers(1, 9))
def test_groups_are_of_one_scene(per_shard: int, per_scene: int) -> None:
    """All clips of a shard, in order, in groups of one scene and at most so many."""
    plan = plan_of(
        clips={"train": 30},
        shard={"clips": per_shard},
        scenes=[{"scene": "optical"}, {"generate": "kitchen", "seeds": [0, 3]}],
    )
    shard = plan.shard(0)
    groups = list(clip_groups(shard, per_scene))
    assert [clip for group in groups for clip in group] == list(shard.clips)
    assert all(len({clip.scene for clip in group}) == 1 for group in groups)
    assert max(map(len, groups)) <= per_scene


def test_scenes_can_be_kept_for_a_split() -> None:
    """What is tested on was never trained on."""
    plan = plan_of(
        clips={"train": 4, "test": 4},
        scenes=[
            {"scene": "optical", "splits": ["train"]},
            {"generate": "kitchen", "seeds": [0, 1], "splits": ["test"]},
        ],
    )
    seen = {
        (clip.split, clip.scene.name)
        for number in range(plan.shards)
        for clip in plan.shard(number).clips
    }
    assert seen == {("train", "optical"), ("test", "kitchen")}
