"""Shared segments for frames: used again when nobody holds them, never before."""

from __future__ import annotations

import gc
import mmap
import os
from collections.abc import Callable

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.system.frame_memory import (
    ALIGNMENT,
    SEGMENTS,
    Segment,
    SegmentPool,
    map_segment,
    padded,
    view_of,
)

SIZE = 4096


def lent(pool: SegmentPool) -> tuple[Segment, np.ndarray]:
    """Take a segment and lend it out."""
    segment = pool.take(SIZE)
    assert segment is not None
    return segment, pool.lend(segment)


def test_what_the_writer_writes_is_what_the_reader_has() -> None:
    """Both sides map the same memory, and arrays lie in it where they were put."""
    pool = SegmentPool()
    segment, whole = lent(pool)
    writers = np.frombuffer(map_segment(segment.fd), np.uint8)
    flow = np.arange(24, dtype=np.float32).reshape(3, 4, 2)
    np.copyto(view_of(writers, ALIGNMENT, flow.dtype, flow.shape), flow)
    segment.forget_fd()
    read = view_of(whole, ALIGNMENT, np.float32, (3, 4, 2))
    assert np.array_equal(read, flow)
    assert read.flags.writeable


@pytest.mark.parametrize(
    "derived",
    [
        lambda whole: whole[8:16],
        lambda whole: view_of(whole, 0, np.float32, (4, 4, 2))[1:, ::2].T,
        lambda whole: memoryview(whole[:64].view(np.float64)),
    ],
)
def test_a_held_segment_is_not_used_again(derived: Callable[[np.ndarray], object]) -> None:
    """Whatever was made of its bytes holds it; then the same memory is lent once more."""
    pool = SegmentPool()
    segment, whole = lent(pool)
    held = derived(whole)
    del whole
    gc.collect()
    other, _ = lent(pool)
    assert other is not segment
    del held
    again = [pool.take(SIZE), pool.take(SIZE)]
    assert segment in again


def test_no_more_than_so_many_are_held() -> None:
    """Who keeps frames for ever makes the memory of the pool no larger."""
    pool = SegmentPool()
    held = [lent(pool) for _ in range(SEGMENTS - 1)]
    assert pool.is_short
    held.append(lent(pool))
    assert pool.take(SIZE) is None
    assert sorted(segment.number for segment, _ in held) == list(range(SEGMENTS))
    held.pop()
    assert pool.take(SIZE) is not None


def test_larger_frames_get_larger_segments() -> None:
    """Segments that are too small are let go, and larger ones serve smaller frames."""
    pool = SegmentPool()
    small, whole = lent(pool)
    del whole
    large = pool.take(2 * SIZE)
    assert large is not None
    assert large.size == 2 * SIZE
    assert small.fd == -1
    pool.give_back(large)
    assert pool.take(SIZE) is large


def test_a_fork_keeps_what_was_held() -> None:
    """The child has the same memory, so that it is not written to again."""
    pool = SegmentPool()
    segment, whole = lent(pool)
    child = os.fork()
    if not child:
        os._exit(0)
    os.waitpid(child, 0)
    del whole
    other = pool.take(SIZE)
    assert other is not None
    assert other is not segment


def test_memory_that_could_shrink_is_refused() -> None:
    """To write beyond the end of a file that was cut would end the writer."""
    fd = os.memfd_create("unsealed", os.MFD_ALLOW_SEALING)
    try:
        os.ftruncate(fd, SIZE)
        with pytest.raises(InvalidRequest, match="sealed memory file"):
            map_segment(fd)
    finally:
        os.close(fd)
    with open(os.devnull) as null, pytest.raises(InvalidRequest, match="sealed memory file"):
        map_segment(null.fileno())
    segment = Segment(0, SIZE)
    with pytest.raises(OSError, match="not permitted"):
        os.ftruncate(segment.fd, 1)
    assert isinstance(map_segment(segment.fd), mmap.mmap)
    segment.forget_fd()


@pytest.mark.parametrize("offset", [-64, 1, SIZE - 64, SIZE])
def test_a_place_outside_is_refused(offset: int) -> None:
    """What the other side says is checked."""
    with pytest.raises(InvalidRequest, match="place in a segment"):
        view_of(np.zeros(SIZE, np.uint8), offset, np.float32, (8, 8))


def test_sizes_are_whole_cache_lines() -> None:
    """Rounded up, never down."""
    assert [padded(size) for size in (0, 1, 64, 65)] == [0, 64, 64, 128]
