"""The light of day: windows and sun get darker and redder towards the night, lamps are lit then."""

from __future__ import annotations

import math

from pydantic import Field

from sailenv_ros.scene.fields import Fraction, SceneModel
from sailenv_ros.streams.fields import FrameCount
from sailenv_ros.streams.state import DriftRecord, StreamState, tinted

__all__ = ["Daylight"]

NIGHT = 0.25
"""Share of the day's light below which lamps are lit."""

_RED = (1.0, 0.62, 0.35)
"""Factors of the light when the sun is at the horizon."""


class Daylight(SceneModel):
    """Day and year; frame 0 is at noon of a spring day."""

    day: FrameCount = Field(default=20_000, description="frames of a day")
    year: FrameCount = Field(default=2_000_000, description="frames of a year")
    night: Fraction = Field(default=0.04, description="share of the light that is left at night")
    season: Fraction = Field(default=0.3, description="by how much a winter's noon is darker")
    lamps_by_day: Fraction = Field(default=0.2, description="power of lamps while it is light")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Set the power and colour of windows, sun and lamps."""
        hour = (12.0 + 24.0 * frame / self.day) % 24.0
        height = math.cos(2.0 * math.pi * (hour - 12.0) / 24.0)  # 1 at noon, -1 at midnight
        summer = 0.5 + 0.5 * math.sin(2.0 * math.pi * frame / self.year)
        noon = 1.0 - self.season * (1.0 - summer)
        share = self.night + (noon - self.night) * math.sqrt(max(0.0, height))
        low = 1.0 - min(1.0, max(0.0, height) / 0.5)  # 1 at the horizon, 0 when it is high
        state.daylight *= share
        state.daylight_colour = tinted(_RED, low)
        state.lamplight *= 1.0 if share < NIGHT else self.lamps_by_day
        values = {"hour": hour, "share": share, "year": frame / self.year}
        return DriftRecord(values=values, since=0, active=True)
