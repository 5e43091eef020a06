"""Walls that are painted again every so many frames."""

from __future__ import annotations

from functools import lru_cache

from pydantic import Field

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.scene.fields import LinearColour, SceneModel
from sailenv_ros.streams.fields import FrameCount, FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState
from sailenv_ros.types.colour import linear_from_hex

__all__ = ["Paint"]


PAINTS = tuple(
    linear_from_hex(colour)
    for colour in ("#e8e4da", "#b9c4b1", "#c9b8a3", "#9fb3c1", "#d8c2b8", "#8c9a93")
)


class Paint(SceneModel):
    """The colour of all walls; the rooms' own before the onset."""

    onset: FrameNumber = Field(default=100_000, description="frame at which they are painted first")
    every: FrameCount = Field(default=100_000, description="frames from one painting to the next")
    colours: tuple[LinearColour, ...] = Field(
        default=PAINTS,
        min_length=1,
        description="one after the other in an order that the seed draws",
    )

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Choose the colour."""
        if frame < self.onset:
            return DriftRecord(values={"colour": ()}, since=self.onset, active=False)
        time = (frame - self.onset) // self.every
        order = _order(self.colours, seed)
        state.paint = order[time % len(order)]
        return DriftRecord(
            values={"colour": state.paint}, since=self.onset + time * self.every, active=True
        )


@lru_cache(maxsize=8)
def _order(colours: tuple[LinearColour, ...], seed: int) -> tuple[LinearColour, ...]:
    """Return the order in which they come; asked for in each frame."""
    return tuple(RandomStream("paint", seed).mixed(colours))
