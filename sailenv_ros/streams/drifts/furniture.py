"""Furniture that is replaced: each piece by another of its kind, at a time of its own."""

from __future__ import annotations

from pydantic import Field

from sailenv_ros.scene.fields import SceneModel
from sailenv_ros.streams.fields import FrameCount, FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState

__all__ = ["Furniture"]


class Furniture(SceneModel):
    """Age of furniture from seeds; each piece is replaced once in that many frames."""

    onset: FrameNumber = Field(default=100_000, description="frame from which on pieces go")
    life: FrameCount = Field(default=500_000, description="frames within which each goes once")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Tell how many lives have passed."""
        state.furniture_lives = max(0, frame - self.onset) / self.life
        return DriftRecord(
            values={"lives": state.furniture_lives}, since=self.onset, active=frame >= self.onset
        )
