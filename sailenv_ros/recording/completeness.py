"""Counts the images of announced frames that never arrived, so that every loss is reported.

Times of sending in, a count out. Images and infos come on topics of their own and overtake each
other; a frame is settled when `SLACK` later ones have been announced. Knows no ROS.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field

__all__ = ["SLACK", "CompletenessCounter"]

SLACK = 8
"""A frame is settled once so many later ones were announced; by then its images have come."""


@dataclass(slots=True)
class CompletenessCounter:
    """Counts one agent's frames; used by one thread at a time.

    Attributes
    ----------
    frames : int
        Announced so far.
    missing : int
        Images that were announced, of views that had been coming before, and never came.
    """

    frames: int = 0
    missing: int = 0
    _pending: deque[tuple[int, tuple[str, ...]]] = field(default_factory=deque)
    _sent: dict[str, deque[int]] = field(default_factory=dict)
    _first_ns: dict[str, int] = field(default_factory=dict)
    _after_ns: int = 0

    def add_image(self, view: str, sent_ns: int) -> None:
        """Take note of an image that came."""
        self._first_ns.setdefault(view, sent_ns)
        self._sent.setdefault(view, deque()).append(sent_ns)

    def add_info(self, views: Iterable[str], sent_ns: int) -> None:
        """Take note of a frame that was announced, with the images that were sent of it."""
        self.frames += 1
        self._pending.append((sent_ns, tuple(views)))
        while len(self._pending) > SLACK:
            self._settle()

    def finish(self) -> None:
        """Settle what is left."""
        while self._pending:
            self._settle()

    def _settle(self) -> None:
        until_ns, views = self._pending.popleft()
        for view, sent in self._sent.items():
            # Before the first image of a view its topic was not heard yet.
            heard = self._first_ns[view] <= until_ns
            came = False
            while sent and sent[0] <= until_ns:
                came |= sent.popleft() > self._after_ns
            self.missing += view in views and heard and not came
        self._after_ns = until_ns
