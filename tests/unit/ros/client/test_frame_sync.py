"""Frames put together again: all images of one frame or none, whatever the order of arrival."""

from __future__ import annotations

from collections.abc import Sequence

from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.ros.client.frame_sync import DEPTH, Bundle, FrameSync

VIEWS = ("rgb", "depth", "instance")
Sent = tuple[str, int, int, int]
"""Topic, sequence, stamp [ns], time of sending [ns]."""


def sent_frames(stamps: Sequence[int]) -> dict[str, list[Sent]]:
    """What a sender puts on each topic: the images of a frame, then its info."""
    topics: dict[str, list[Sent]] = {topic: [] for topic in (*VIEWS, "info")}
    clock = 1000
    for sequence, stamp in enumerate(stamps, start=1):
        for topic in topics:
            clock += 1
            topics[topic].append((topic, sequence, stamp, clock))
    return topics


def deliver(sync: FrameSync, message: Sent) -> Bundle | None:
    """Hand one message over; its payload says which frame it is of."""
    topic, sequence, stamp, sent = message
    if topic == "info":
        return sync.add_info(sequence, stamp, VIEWS, sent, sequence)
    return sync.add_image(topic, stamp, sent, sequence)


def is_whole(bundle: Bundle) -> bool:
    """Return whether every part of a bundle is of its own frame."""
    return bundle.info == bundle.sequence and dict(bundle.images) == dict.fromkeys(
        VIEWS, bundle.sequence
    )


@st.composite
def deliveries(draw: st.DrawFn) -> list[Sent]:
    """Frames, some of one stamp, delivered in order on each topic and in any order between them."""
    stamps = sorted(draw(st.lists(st.integers(0, 3), min_size=1, max_size=DEPTH)))
    topics = sent_frames(stamps)
    order = draw(st.permutations([topic for topic, sent in topics.items() for _ in sent]))
    return [topics[topic].pop(0) for topic in order]


@given(deliveries())
def test_no_frame_is_ever_mixed_and_the_newest_arrives(messages: list[Sent]) -> None:
    """Every bundle is of one frame, numbers only grow, and with nothing lost the last one comes."""
    sync = FrameSync()
    bundles = [b for b in (deliver(sync, message) for message in messages) if b is not None]
    assert all(is_whole(bundle) for bundle in bundles)
    numbers = [bundle.sequence for bundle in bundles]
    assert numbers == sorted(set(numbers))
    assert numbers[-1] == max(sequence for _, sequence, _, _ in messages)
    assert sync.incomplete == numbers[-1] - len(numbers)


@given(deliveries(), st.data())
def test_a_lost_image_loses_its_frame_alone(messages: list[Sent], data: st.DataObject) -> None:
    """A frame that lacks an image is never given; those that lack none are not mixed up by it."""
    images = [message for message in messages if message[0] != "info"]
    lost = data.draw(st.sampled_from(images))
    sync = FrameSync()
    kept = [message for message in messages if message != lost]
    bundles = [b for b in (deliver(sync, message) for message in kept) if b is not None]
    assert lost[1] not in [bundle.sequence for bundle in bundles]
    infos = [m for m in messages if m[0] == "info"]
    in_order = infos == sorted(infos, key=lambda m: m[3])
    assert not in_order or all(is_whole(bundle) for bundle in bundles)


def test_two_frames_of_one_instant_are_told_apart() -> None:
    """While the simulation stands still, an image of the first frame is not one of the second."""
    topics = sent_frames([5, 5])
    sync = FrameSync()
    for topic in ("rgb", "depth", "info"):
        assert deliver(sync, topics[topic][0]) is None
    for topic in ("rgb", "depth", "info"):
        assert deliver(sync, topics[topic][1]) is None
    assert deliver(sync, topics["instance"][0]) is not None
    bundle = deliver(sync, topics["instance"][1])
    assert bundle is not None
    assert is_whole(bundle)


def test_memory_is_bounded() -> None:
    """However much comes and never completes, only the last few messages are kept."""
    sync = FrameSync()
    topics = sent_frames(range(100))
    for info, image in zip(topics["info"], topics["rgb"], strict=True):
        assert deliver(sync, info) is None
        assert deliver(sync, image) is None
    assert len(sync._infos) <= DEPTH
    assert len(sync._images["rgb"]) <= DEPTH
    assert sync.incomplete == 100 - DEPTH


def test_clearing_forgets_what_waits() -> None:
    """After a failed attempt nothing of it can get into the next one."""
    topics = sent_frames([5, 6])
    sync = FrameSync()
    deliver(sync, topics["info"][0])
    deliver(sync, topics["rgb"][0])
    sync.clear()
    assert sync.incomplete == 1
    assert deliver(sync, topics["depth"][0]) is None
    assert deliver(sync, topics["instance"][0]) is None
    for topic in (*VIEWS, "info"):
        bundle = deliver(sync, topics[topic][1])
    assert bundle is not None
    assert is_whole(bundle)
