"""Table of the streams: scene, rate and length of each, and its pusher."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from sailenv_ros.dataset.streams.forces import FurnitureForces, LaptopForces, RoamingForces
from sailenv_ros.errors import UnknownName
from sailenv_ros.simulation import Simulation
from sailenv_ros.system.resources import resource_path

__all__ = ["STREAMS", "ForceSchedule", "StreamKind", "stream_named"]


class ForceSchedule(Protocol):
    """Action on a stream's scene before each frame but the first."""

    def apply(self, simulation: Simulation, number: int) -> None:
        """Act before the steps that lead to frame `number`, from 1 on."""


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamKind:
    """A published stream, as it is made here.

    Attributes
    ----------
    name : str
        Its scene is ``config/streams/<name>.yaml``.
    title : str
        Its name in the paper.
    rate_hz : float
        Pictures per simulated second [Hz].
    lap_frames : int
        Pictures of a lap; of the whole stream where it has no laps.
    laps : bool
        True if what happens is repeated lap by lap.
    forces : callable or None
        Makes what acts on the scene, from a seed.
    """

    name: str
    title: str
    rate_hz: float
    lap_frames: int
    laps: bool = True
    forces: Callable[[int], ForceSchedule] | None = None

    @property
    def scene(self) -> Path:
        """Its scene file."""
        return resource_path("config", "streams", f"{self.name}.yaml")


def _colof(which: str, forces: Callable[[int], ForceSchedule]) -> StreamKind:
    """Return a stream of CoLLAs 2022: an hour at 25 Hz."""
    return StreamKind(
        name=f"colof_{which}",
        title=f"Stream {which.upper()}",
        rate_hz=25.0,
        lap_frames=90_000,
        laps=False,
        forces=forces,
    )


STREAMS: dict[str, StreamKind] = {
    kind.name: kind
    for kind in (
        StreamKind(name="empty_space", title="EmptySpace", rate_hz=20.0, lap_frames=1550),
        StreamKind(name="solid", title="Solid", rate_hz=8.0, lap_frames=400),
        StreamKind(name="living_room", title="LivingRoom", rate_hz=25.0, lap_frames=558),
        _colof("a", LaptopForces),
        _colof("b", FurnitureForces),
        _colof("c", RoamingForces),
    )
}
"""The streams by their names."""


def stream_named(name: str) -> StreamKind:
    """Return a stream.

    Raises
    ------
    UnknownName
        If there is none of this name.
    """
    if name not in STREAMS:
        raise UnknownName("stream", name, STREAMS)
    return STREAMS[name]
