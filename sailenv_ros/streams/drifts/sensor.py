"""Sensors that drift: a setting of the picture goes from one value to another."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar

from pydantic import Field

from sailenv_ros.scene.field_types import Choice, Number
from sailenv_ros.scene.fields import Rule, SceneModel
from sailenv_ros.scene.messages import shown
from sailenv_ros.streams.fields import FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState, progress
from sailenv_ros.types.picture_settings import LIMITS

__all__ = ["SensorDrift"]

_Value = Annotated[float, Number(least=-1e9, most=1e9)]

SETTINGS = (
    "exposure", "bloom", "full_well", "read_noise", "gain", "vignetting", "lateral_colour", "dirt",
    "white_balance",
)  # fmt: skip
"""Settings that may drift; whole numbers and times of exposure do not go over gradually."""


def _within_limits(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    bounds = LIMITS.get(str(entry.get("setting")))
    for key in ("begin", "end"):
        value = entry.get(key)
        if bounds is not None and value is not None and (accepted := bounds.refused(value)):
            yield (key,), f"must be {accepted}, as {entry['setting']}, got {shown(value)}"


class SensorDrift(SceneModel):
    """One setting of the picture."""

    rules: ClassVar[tuple[Rule, ...]] = (_within_limits,)

    setting: Annotated[str, Choice(SETTINGS)] = Field(description="name of a picture's setting")
    onset: FrameNumber = Field(default=0, description="frame from which on it drifts")
    over: FrameNumber = Field(description="frames until it has arrived; 0: at once")
    begin: _Value = Field(description="value before")
    end: _Value = Field(description="value afterwards")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Set it."""
        share = progress(frame, self.onset, self.over)
        value = self.begin + share * (self.end - self.begin)
        state.picture[self.setting] = value
        return DriftRecord(
            values={self.setting: value}, since=self.onset, active=frame >= self.onset
        )
