"""How shards are shared out."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.dataset.engine import interleave_shards


@given(shards=st.lists(st.integers(), unique=True, max_size=50), workers=st.integers(1, 12))
def test_every_shard_is_dealt_once(shards: list[int], workers: int) -> None:
    assert sorted(interleave_shards(shards, workers)) == sorted(shards)


def test_each_worker_gets_neighbours() -> None:
    order = interleave_shards(range(12), 3)
    # All of them take one in turn.
    assert [order[worker::3] for worker in range(3)] == [
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [8, 9, 10, 11],
    ]
