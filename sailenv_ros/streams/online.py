"""Evaluation of learners on a stream: test, then learn, with few labels that may come late.

At each frame some random pixels have to be classified. Their labels are given after a delay. At
checkpoints each learner is tested on frames that are not in the stream.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.streams.labels import MOST_LABELS, pixel_labels
from sailenv_ros.streams.prequential import Prequential
from sailenv_ros.streams.stream import Stream
from sailenv_ros.types.validation import checked_integer

__all__ = ["Checkpoint", "LabelledPixels", "Learner", "OnlineProtocol", "Score", "evaluate"]

Rooms = Literal["same", "other"]
"""Rooms of a test: those of the stream at another time, or ones that it never visits."""

_MOST_FRAMES = 10_000_000


@dataclass(frozen=True, eq=False, slots=True)
class LabelledPixels:
    """Some pixels of a picture.

    Attributes
    ----------
    number : int
        Of the frame.
    rgb : (H, W, 3) uint8
    rows, columns : (N,) int64
    categories : (N,) int64
        Ids of the categories that the pixels show.
    """

    number: int
    rgb: NDArray[np.uint8]
    rows: NDArray[np.int64]
    columns: NDArray[np.int64]
    categories: NDArray[np.int64]


class Learner(Protocol):
    """Something that classifies pixels and learns from single labels."""

    def predict(
        self, rgb: NDArray[np.uint8], rows: NDArray[np.int64], columns: NDArray[np.int64]
    ) -> NDArray[np.int64]:
        """Return (N,) int64: the ids of the categories of pixels; -1 for "I do not know".

        Parameters
        ----------
        rgb : (H, W, 3) uint8
        rows, columns : (N,) int64
        """

    def learn(self, pixels: LabelledPixels) -> None:
        """Learn from pixels with their labels."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OnlineProtocol:
    """How learners are taught and tested.

    Attributes
    ----------
    labels : int
        Pixels of each frame that are asked for, and whose labels are given, 1 to 10,000.
    delay : int
        Frames after which labels are given; 0: after the frame's own predictions.
    every : int
        Frames from one checkpoint to the next; 0: no checkpoints.
    test_frames : int
        Frames of each test, spread over the rooms.
    test_labels : int
        Pixels of each frame of a test.
    rooms : tuple of {'same', 'other'}
        The tests at each checkpoint.
    fading : float
        See `Prequential`.
    seed : int
        Of the choice of pixels.

    Raises
    ------
    InvalidRequest
        If a value is not accepted.
    """

    labels: int = 4
    delay: int = 0
    every: int = 0
    test_frames: int = 25
    test_labels: int = 64
    rooms: tuple[Rooms, ...] = get_args(Rooms)
    fading: float = 0.999
    seed: int = 0

    def __post_init__(self) -> None:
        for name, least, most in (
            ("labels", 1, MOST_LABELS),
            ("delay", 0, _MOST_FRAMES),
            ("every", 0, _MOST_FRAMES),
            ("test_frames", 1, _MOST_FRAMES),
            ("test_labels", 1, MOST_LABELS),
            ("seed", 0, 2**63 - 1),
        ):
            checked_integer(name, getattr(self, name), least, most)
        for rooms in self.rooms:
            if rooms not in get_args(Rooms):
                raise InvalidRequest("rooms", rooms, "'same' or 'other'")
        Prequential(self.fading)


@dataclass(frozen=True, slots=True, kw_only=True)
class Checkpoint:
    """A learner in the middle of a stream.

    Attributes
    ----------
    at : int
        Number of the last frame that it was shown.
    recent : float
        `Prequential.recent` there.
    forgetting : float
        Mean of `Prequential.forgetting` over the classes.
    tests : mapping of str to float
        Share of right predictions, by the rooms of the test.
    """

    at: int
    recent: float
    forgetting: float
    tests: Mapping[str, float]


@dataclass(slots=True)
class Score:
    """Results of one learner.

    Attributes
    ----------
    online : Prequential
        On the stream itself.
    checkpoints : list of Checkpoint
        The last one is of the stream's end.
    """

    online: Prequential
    checkpoints: list[Checkpoint] = field(default_factory=list)


def evaluate(
    stream: Stream,
    learners: Mapping[str, Learner],
    protocol: OnlineProtocol | None = None,
    *,
    on_frame: Callable[[], None] = lambda: None,
) -> dict[str, Score]:
    """Show a stream to learners, one after the other at each frame.

    Parameters
    ----------
    stream : Stream
        Or a part of one: ``stream[0:100_000:10]``. With the views ``rgb``, ``category`` and
        ``instance``.
    learners : mapping of str to Learner
        By name.
    protocol : OnlineProtocol or None
        None is the standard one.
    on_frame : callable
        Called after each frame of the stream and of tests.

    Returns
    -------
    scores : dict of str to Score

    Raises
    ------
    InvalidRequest
        If the stream lacks a view, or a learner's answer has another shape than was asked for.
    """
    protocol = protocol or OnlineProtocol()
    scores = {name: Score(Prequential(protocol.fading)) for name in learners}
    waiting: deque[LabelledPixels] = deque()
    count = len(stream)
    for place, frame in enumerate(stream.as_frames()):
        pixels = _pixels(frame.views, frame.number, protocol.labels, protocol.seed)
        for name, learner in learners.items():
            for predicted, label in zip(
                _predicted(name, learner, pixels), pixels.categories.tolist(), strict=True
            ):
                scores[name].online.add(predicted, label)
        waiting.append(pixels)
        if len(waiting) > protocol.delay:
            known = waiting.popleft()
            for learner in learners.values():
                learner.learn(known)
        on_frame()
        ends = place + 1 == count
        if ends or (protocol.every and (place + 1) % protocol.every == 0):
            tests = _tested(stream, frame.number, learners, protocol, on_frame)
            for name, score in scores.items():
                lost = list(score.online.forgetting.values())
                score.checkpoints.append(
                    Checkpoint(
                        at=frame.number,
                        recent=score.online.recent,
                        forgetting=sum(lost) / len(lost),
                        tests={rooms: shares[name] for rooms, shares in tests.items()},
                    )
                )
    return scores


def _tested(
    stream: Stream,
    at: int,
    learners: Mapping[str, Learner],
    protocol: OnlineProtocol,
    on_frame: Callable[[], None],
) -> dict[str, dict[str, float]]:
    """Return the share of right predictions by rooms and learner; nothing is learnt."""
    found: dict[str, dict[str, float]] = {}
    for rooms in protocol.rooms if protocol.every else ():
        right = dict.fromkeys(learners, 0)
        asked = 0
        with stream.test_set(at, protocol.test_frames, rooms=rooms) as test:
            for frame in test.as_frames():
                pixels = _pixels(frame.views, frame.number, protocol.test_labels, protocol.seed)
                asked += len(pixels.categories)
                for name, learner in learners.items():
                    predicted = np.array(_predicted(name, learner, pixels))
                    right[name] += int((predicted == pixels.categories).sum())
                on_frame()
        found[rooms] = {name: hits / asked for name, hits in right.items()}
    return found


def _pixels(
    views: Mapping[str, NDArray[np.generic]], number: int, count: int, seed: int
) -> LabelledPixels:
    if "rgb" not in views:
        raise InvalidRequest("views", tuple(views), "views with 'rgb'")
    labels = pixel_labels(views, number, seed=seed, count=count)
    table = np.array([label[:3] for label in labels], np.int64).reshape(-1, 3)
    rgb: NDArray[np.uint8] = views["rgb"].view(np.uint8)
    return LabelledPixels(number, rgb, table[:, 0], table[:, 1], table[:, 2])


def _predicted(name: str, learner: Learner, pixels: LabelledPixels) -> Sequence[int]:
    predicted = np.asarray(learner.predict(pixels.rgb, pixels.rows, pixels.columns))
    if predicted.shape != pixels.rows.shape:
        wanted = f"one category a pixel, {pixels.rows.shape}"
        raise InvalidRequest(f"predictions of {name!r}", f"shape {predicted.shape}", wanted)
    classes: list[int] = predicted.astype(np.int64).tolist()
    return classes
