"""Puts the images of one frame together again: all of one frame or none, the newest first.

Messages of one agent's topics in, `Bundle`s out. Images carry a stamp and no number; the
frame_info that closes each frame on the sender's side names its number and views. Two frames of
one stamp (the simulation stands still) are distinguished by when they were sent. Knows no ROS.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Bundle", "FrameSync"]

DEPTH = 4
"""Messages of a topic that are kept while their siblings have not come."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Bundle:
    """Everything that was sent of one frame.

    Attributes
    ----------
    sequence : int
        The frame's number.
    info : object
        The frame_info message.
    images : mapping of str to object
        An image message for each view that the info names.
    """

    sequence: int
    info: Any
    images: Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class _Info:
    sequence: int
    stamp_ns: int
    views: tuple[str, ...]
    after_ns: int
    sent_ns: int
    message: Any


@dataclass(frozen=True, slots=True, kw_only=True)
class _Image:
    stamp_ns: int
    sent_ns: int
    message: Any


@dataclass(slots=True)
class FrameSync:
    """Matches one agent's messages exactly, in bounded memory; used by one thread at a time.

    Attributes
    ----------
    incomplete : int
        How many frames were given up because newer ones came first or their images were lost.
    """

    incomplete: int = 0
    _infos: deque[_Info] = field(default_factory=deque)
    _images: dict[str, deque[_Image]] = field(default_factory=dict)
    _last_sent_ns: int = 0

    def add_info(
        self, sequence: int, stamp_ns: int, views: tuple[str, ...], sent_ns: int, message: Any
    ) -> Bundle | None:
        """Take a frame_info; return its frame if that is now complete.

        Parameters
        ----------
        sequence : int
            The frame's number.
        stamp_ns : int
            Its simulated time [ns].
        views : tuple of str
            The images that were sent of it.
        sent_ns : int
            When the message was sent, after those images, by the sender's clock [ns].
        message : object
            Handed on in the bundle.
        """
        info = _Info(
            sequence=sequence,
            stamp_ns=stamp_ns,
            views=views,
            after_ns=self._last_sent_ns,
            sent_ns=sent_ns,
            message=message,
        )
        self._last_sent_ns = sent_ns
        self._infos.append(info)
        if len(self._infos) > DEPTH:
            self._infos.popleft()
            self.incomplete += 1
        return self._completed()

    def add_image(self, view: str, stamp_ns: int, sent_ns: int, message: Any) -> Bundle | None:
        """Take an image; return its frame if that is now complete."""
        waiting = self._images.setdefault(view, deque(maxlen=DEPTH))
        waiting.append(_Image(stamp_ns=stamp_ns, sent_ns=sent_ns, message=message))
        return self._completed()

    def clear(self) -> None:
        """Forget everything that is waiting, and when the last frame was sent."""
        self.incomplete += len(self._infos)
        self._infos.clear()
        self._images.clear()
        self._last_sent_ns = 0

    def _completed(self) -> Bundle | None:
        for info in reversed(self._infos):
            images = {view: self._find(view, info) for view in info.views}
            if all(image is not None for image in images.values()):
                self._drop_until(info)
                messages = {view: image.message for view, image in images.items() if image}
                return Bundle(sequence=info.sequence, info=info.message, images=messages)
        return None

    def _find(self, view: str, info: _Info) -> _Image | None:
        for image in self._images.get(view, ()):
            if image.stamp_ns == info.stamp_ns and info.after_ns < image.sent_ns <= info.sent_ns:
                return image
        return None

    def _drop_until(self, info: _Info) -> None:
        """Leave what was sent after that frame."""
        older = [other for other in self._infos if other.sent_ns < info.sent_ns]
        self.incomplete += len(older)
        self._infos = deque(other for other in self._infos if other.sent_ns > info.sent_ns)
        for view, waiting in self._images.items():
            newer = (image for image in waiting if image.sent_ns > info.sent_ns)
            self._images[view] = deque(newer, maxlen=DEPTH)
