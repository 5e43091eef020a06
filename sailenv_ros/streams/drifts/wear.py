"""Furniture that wears: it darkens and yellows."""

from __future__ import annotations

from pydantic import Field

from sailenv_ros.scene.fields import Fraction, SceneModel
from sailenv_ros.streams.fields import FrameCount, FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState, progress

__all__ = ["Wear"]


class Wear(SceneModel):
    """How far furniture has yellowed; it stays as it is at the end."""

    onset: FrameNumber = Field(default=200_000, description="frame from which on it wears")
    over: FrameCount = Field(default=1_000_000, description="frames until it is worn")
    most: Fraction = Field(default=0.6, description="how far it yellows, 1 being brown")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Yellow the furniture."""
        state.worn = self.most * progress(frame, self.onset, self.over)
        return DriftRecord(
            values={"worn": state.worn}, since=self.onset, active=frame >= self.onset
        )
