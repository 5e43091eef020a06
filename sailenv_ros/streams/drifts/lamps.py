"""Lamps that age: weaker and warmer, until they are replaced."""

from __future__ import annotations

from pydantic import Field

from sailenv_ros.scene.fields import Fraction, SceneModel
from sailenv_ros.streams.fields import FrameCount, FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState, progress, tinted

__all__ = ["LampAge"]

_OLD = (1.0, 0.82, 0.6)


class LampAge(SceneModel):
    """Age of all lamps; they are new again after each life."""

    onset: FrameNumber = Field(default=0, description="frame from which on they age")
    life: FrameCount = Field(default=300_000, description="frames until they are replaced")
    left: Fraction = Field(default=0.4, description="share of their power at the end of their life")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Weaken lamps."""
        lives = max(0, frame - self.onset) // self.life
        begin = self.onset + lives * self.life
        age = progress(frame, begin, self.life)
        power = 1.0 - (1.0 - self.left) * age
        state.lamplight *= power
        state.lamp_colour = tinted(_OLD, age)
        return DriftRecord(
            values={"power": power, "replaced": float(lives)},
            since=begin,
            active=frame >= self.onset,
        )
