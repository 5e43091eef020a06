"""Follows what was baked while a scene runs. From snapshots to changes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.light.relight.baked_rows import BakedRows, baked_rows, has_shape_of
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import SceneContents, WorldSnapshot

__all__ = ["ChangeFollower"]

STILL_NS, STILL_FRAMES = 250_000_000, 5
"""Time, or number of frames, after which an object that moved twice is at rest again, in real
time."""


@dataclass(eq=False, slots=True)
class _Place:
    """Last known place of an object."""

    pose: bytes
    moved_ns: int
    frames: int = 0
    in_motion: bool = False

    def follow(self, pose: bytes, now_ns: int) -> None:
        """Take in where it is now: what moves twice in a row is in motion until it rests."""
        recent = self.frames < STILL_FRAMES and 0 <= now_ns - self.moved_ns < STILL_NS
        if pose != self.pose:
            self.pose, self.moved_ns, self.frames, self.in_motion = pose, now_ns, 0, recent
            return
        self.frames += 1
        self.in_motion = self.in_motion and recent


class ChangeFollower:
    """Follows one scene.

    Parameters
    ----------
    original : SceneContents
        As they were baked.

    Attributes
    ----------
    painted : dict of int to Model
        Models of what was baked and is of other materials at the last snapshot, by instance id.
    """

    def __init__(self, original: SceneContents) -> None:
        self.painted: dict[int, Model] = {}
        self._original = original
        self._places: dict[int, _Place] = {}
        self._of: BakedRows | None = None

    def changes(self, snapshot: WorldSnapshot, *, lockstep: bool) -> list[Change]:
        """Return what stands elsewhere than when the light was baked.

        Parameters
        ----------
        snapshot : WorldSnapshot
        lockstep : bool
            False leaves out what keeps moving.
        """
        original, contents = self._original, snapshot.contents
        assert original.baked is not None
        if self._of is None or self._of.contents is not contents:
            self._of = baked_rows(original, contents)
            self.painted = self._repainted(contents)
        of = self._of
        changes: list[Change] = []
        places: dict[int, _Place] = {}
        # NaN is like nothing: what was not baked is among them.
        moved = (snapshot.world_from_body[of.rows] != of.poses).any(axis=(1, 2))
        for place_of in np.flatnonzero(moved).tolist():
            row, id_ = int(of.rows[place_of]), of.ids[place_of]
            pose = snapshot.world_from_body[row]
            came = None
            before: NDArray[np.float64] | None = of.poses[place_of]
            if np.isnan(of.poses[place_of, 0, 0]):
                drawn = contents.instances[row]
                came, before = (drawn.model, drawn.scale), None
            name, now_ns = pose.tobytes(), snapshot.sim_time_ns
            place = places[id_] = self._places.get(id_) or _Place(name, now_ns)
            place.follow(name, now_ns)
            # In real time, what moves on is lit as things are that can move: at no cost.
            after = None if place.in_motion and not lockstep else pose
            if before is not None or after is not None:
                changes.append(Change(id=id_, before=before, after=after, came=came))
        self._places = places
        changes += of.gone
        charts = original.baked.charts
        for change in [c for c in changes if c.came is not None and c.id in charts]:
            # Another model or size in the place of what was baked.
            gone = Change(id=change.id, before=charts[change.id].world_from_body, after=None)
            changes.append(gone)
        return changes

    def _repainted(self, contents: SceneContents) -> dict[int, Model]:
        """Return the models of what was baked and is of other materials now."""
        assert self._original.baked is not None
        charts = self._original.baked.charts
        known = {drawn.instance.id: drawn for drawn in self._original.instances}
        return {
            drawn.instance.id: drawn.model
            for drawn in contents.instances
            if drawn.instance.id in charts
            and drawn.model is not known[drawn.instance.id].model
            and has_shape_of(drawn, known[drawn.instance.id])
        }
