"""Motion of a scene over time: what moves, and the vertices of what deforms, at each sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.deformation import MovedMesh
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates

__all__ = ["MOST_SAMPLES", "ExportedMotion", "Moment", "check_samples", "motion_of"]

MOST_SAMPLES = 3600
"""Most samples of a motion: two and a half minutes at 24 a second."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Moment:
    """One instant of a motion.

    Attributes
    ----------
    time_s : float
        Since the first one [s].
    states : InstanceStates
    cameras : mapping of str to Pose
        Of agents' cameras, x along the optical axis.
    """

    time_s: float
    states: InstanceStates
    cameras: Mapping[str, Pose] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class ExportedMotion:
    """Poses and shapes of everything that moves, a sample at each time.

    Attributes
    ----------
    rate_hz : float
        Time codes a second, where a format counts in them.
    times_s : (T,) float64
        From 0, ascending [s].
    bodies : mapping of int to tuple of Pose
        By the ids of bodies; of those that move.
    cameras : mapping of str to tuple of Pose
        By names; of those that move.
    meshes : mapping of int to tuple of tuple of MovedMesh
        Of what deforms, by instance ids: of each sample those of each part.
    """

    rate_hz: float
    times_s: NDArray[np.float64]
    bodies: Mapping[int, tuple[Pose, ...]]
    cameras: Mapping[str, tuple[Pose, ...]]
    meshes: Mapping[int, tuple[tuple[MovedMesh, ...], ...]]

    @property
    def codes(self) -> list[float]:
        """The times as time codes, which need no more digits."""
        found: list[float] = (self.times_s * self.rate_hz).round(6).tolist()
        return found


def motion_of(moments: Sequence[Moment], ids: Sequence[int], rate_hz: float) -> ExportedMotion:
    """Gather the motion of bodies from instants.

    Parameters
    ----------
    moments : sequence of Moment
        Of the same bodies, in the order of their times; at most `MOST_SAMPLES`.
    ids : sequence of int
        Of bodies. What is not there at each instant stays where it is.
    rate_hz : float

    Raises
    ------
    InvalidRequest
        If there are fewer than two or too many instants, or they do not ascend.
    """
    times = np.array([moment.time_s for moment in moments], np.float64)
    check_samples(len(times))
    if (np.diff(times) <= 0.0).any():
        raise InvalidRequest("times of a motion", "not ascending", "each later than the one before")
    bodies = {}
    for id_ in ids:
        rows = [np.flatnonzero(moment.states.ids == id_) for moment in moments]
        if all(len(row) for row in rows):
            placed = zip(moments, rows, strict=True)
            poses = tuple(_pose(moment.states, int(row[0])) for moment, row in placed)
            if any(pose != poses[0] for pose in poses):
                bodies[id_] = poses
    names = set.intersection(*(set(moment.cameras) for moment in moments))
    cameras = {
        name: poses
        for name in sorted(names)
        if any((poses := tuple(m.cameras[name] for m in moments))[0] != pose for pose in poses)
    }
    deforming = set.intersection(*(set(moment.states.deformations) for moment in moments))
    meshes = {
        id_: tuple(moment.states.deformations[id_].meshes for moment in moments)
        for id_ in sorted(deforming)
    }
    return ExportedMotion(
        rate_hz=rate_hz, times_s=times - times[0], bodies=bodies, cameras=cameras, meshes=meshes
    )


def check_samples(count: int) -> None:
    """Refuse too few samples, or too many.

    Raises
    ------
    InvalidRequest
    """
    if not 2 <= count <= MOST_SAMPLES:
        raise InvalidRequest("number of samples of a motion", count, f"2 to {MOST_SAMPLES}")


def _pose(states: InstanceStates, row: int) -> Pose:
    x, y, z = states.positions[row].tolist()
    a, b, c, w = states.orientations[row].tolist()
    return Pose((x, y, z), (a, b, c, w))
