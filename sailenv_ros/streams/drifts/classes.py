"""Classes that appear and retire: objects of a category are there within some frames alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, ClassVar

from pydantic import Field

from sailenv_ros.scene.fields import Rule, SceneModel
from sailenv_ros.streams.fields import FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState

__all__ = ["ClassSpan"]


def _ends_later(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    begin, end = entry.get("begin", 0), entry.get("end")
    if isinstance(begin, int) and isinstance(end, int) and end <= begin:
        yield ("end",), f"must be a frame after {begin}, its begin, got {end}"


class ClassSpan(SceneModel):
    """Frames in which there is a category."""

    rules: ClassVar[tuple[Rule, ...]] = (_ends_later,)

    category: str = Field(min_length=1, description="name of a category")
    begin: FrameNumber = Field(default=0, description="first frame with it")
    end: FrameNumber = Field(default=10**9, description="first frame without it again")

    def is_there(self, frame: int) -> bool:
        """Return whether a frame may have it."""
        return self.begin <= frame < self.end

    @staticmethod
    def apply_all(spans: tuple[ClassSpan, ...], state: StreamState, frame: int) -> DriftRecord:
        """Take out what has not appeared yet or has retired."""
        state.absent |= {span.category for span in spans if not span.is_there(frame)}
        changes = [time for span in spans for time in (span.begin, span.end) if time <= frame]
        return DriftRecord(
            values={"absent": tuple(sorted(state.absent))},
            since=max(changes, default=0),
            active=True,
        )
