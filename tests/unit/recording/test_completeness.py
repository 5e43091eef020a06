"""What never came is counted, once, and nothing else is."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.completeness import SLACK, CompletenessCounter
from sailenv_ros.recording.queue_writer import QueueWriter
from sailenv_ros.recording.topics import RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from tests.support.recordings import file_size_limit
from tests.support.waiting import until

NOTE = RecordedTopic(name="/note", type="std_msgs/msg/String", schema="string data\n")


@given(
    frames=st.lists(st.tuples(st.booleans(), st.booleans()), max_size=30),
    late=st.integers(0, SLACK - 1),
)
def test_images_that_were_announced_and_never_came_are_counted(
    frames: list[tuple[bool, bool]], late: int
) -> None:
    """Each missing image counts from its view's first one on, however late others come."""
    counter = CompletenessCounter()
    arrivals: list[tuple[int, int, str, int]] = []
    missing, heard = 0, [False, False]
    for number, came in enumerate(frames):
        sent_ns = 100 * (number + 1)
        arrivals.append((number, 1, "", sent_ns))
        for view, (name, is_there) in enumerate(zip(("rgb", "depth"), came, strict=True)):
            if is_there:
                heard[view] = True
                arrivals.append((number + late * view, 0 if late * view == 0 else 2, name, sent_ns))
            missing += heard[view] and not is_there
    for _, _, name, sent_ns in sorted(arrivals, key=lambda arrival: arrival[:2]):
        if name:
            counter.add_image(name, sent_ns - 5)
        else:
            counter.add_info(("rgb", "depth"), sent_ns)
    counter.finish()
    assert counter.frames == len(frames)
    assert counter.missing == missing


def test_views_that_were_not_announced_are_not_missed() -> None:
    """A frame that was published without a view does not lack it."""
    counter = CompletenessCounter()
    counter.add_image("rgb", 5)
    for number in range(20):
        counter.add_info((), 10 * (number + 1))
    counter.finish()
    assert counter.missing == 0


def test_a_queue_that_is_full_drops_and_counts(tmp_path: Path) -> None:
    """What waits is bounded; every message is either in the file or counted."""
    queue = QueueWriter(RecordingWriter(tmp_path / "bag"), limit_bytes=2000)
    queue.add_topic(NOTE)
    for number in range(400):
        queue.put("/note", bytes(300), number)
    queue.close()
    with (tmp_path / "bag/bag_0.mcap").open("rb") as stream:
        kept = sum(1 for _ in make_reader(stream).iter_messages())
    assert kept + queue.dropped == 400
    assert kept >= 6


def test_a_full_disk_is_told_and_everything_is_accounted_for(tmp_path: Path) -> None:
    """The failure is there to be seen while recording; no message is neither kept nor counted."""
    total = 200
    with file_size_limit(60_000):
        options = RecordingOptions(compression="none", chunk_bytes=4000)
        queue = QueueWriter(RecordingWriter(tmp_path / "bag", options), limit_bytes=10**9)
        queue.add_topic(NOTE)
        for number in range(total):
            queue.put("/note", bytes(1500), number)
        until(lambda: queue.failure is not None, "the disk to be full")
        queue.put("/note", b"late", total)
        caught = []
        try:
            queue.close()
        except RecordingError as problem:
            caught.append(problem)
    assert "disk is full" in str(caught[0])
    with (tmp_path / "bag/bag_0.mcap").open("rb") as stream:
        kept = sum(1 for _ in make_reader(stream).iter_messages())
    assert kept + queue.statistics.lost + queue.dropped == total + 1
    assert kept > 10
