"""A camera that is mounted again every so many frames: turned, shifted, with another zoom."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated

from pydantic import Field

from sailenv_ros.authoring.room_rules.random_stream import RandomStream
from sailenv_ros.scene.field_types import Number
from sailenv_ros.scene.fields import Fraction, SceneModel
from sailenv_ros.streams.fields import FrameCount, FrameNumber
from sailenv_ros.streams.state import DriftRecord, StreamState

__all__ = ["Mount"]


class Mount(SceneModel):
    """How a camera sits on what carries it; exactly, before the onset."""

    onset: FrameNumber = Field(default=150_000, description="frame of the first change")
    every: FrameCount = Field(default=150_000, description="frames from one mounting to the next")
    turn: Annotated[float, Number(least=0.0, most=45.0, unit="deg")] = Field(
        default=5.0, description="most about each axis [deg]"
    )
    shift: Annotated[float, Number(least=0.0, most=0.2, unit="m")] = Field(
        default=0.05, description="most along each axis [m]"
    )
    zoom: Fraction = Field(default=0.1, description="most by which the focal length differs")

    def apply(self, state: StreamState, frame: int, seed: int) -> DriftRecord:
        """Turn and shift the camera."""
        if frame < self.onset:
            return DriftRecord(values={"times": 0.0}, since=self.onset, active=False)
        times = (frame - self.onset) // self.every
        most = (self.turn,) * 3 + (self.shift,) * 3 + (self.zoom,)
        roll, pitch, yaw, ahead, left, up, zoom = _drawn(most, seed, times)
        state.mount_rpy_deg, state.mount_m = (roll, pitch, yaw), (ahead, left, up)
        state.zoom = 1.0 + zoom
        return DriftRecord(
            values={"times": float(times + 1), "roll": roll, "pitch": pitch, "yaw": yaw,
                    "zoom": state.zoom},
            since=self.onset + times * self.every,
            active=True,
        )  # fmt: skip


@lru_cache(maxsize=8)
def _drawn(most: tuple[float, ...], seed: int, times: int) -> tuple[float, ...]:
    """Return numbers between these and their negatives; asked for in each frame."""
    dice = RandomStream("mount", seed, times)
    return tuple(dice.between((-one, one)) for one in most)
