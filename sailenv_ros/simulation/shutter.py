"""When the rows of a camera's picture are exposed, and where everything stood at these instants.

A frame is complete when its last row has been read out: now. It belongs to the instant in the
middle. Poses between two physics steps follow from those at the steps: positions change linearly,
orientations turn about one axis at one speed. Before the first instant that is known of a camera,
and for what was spawned or teleported since, things stood where they are known first.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.simulation.agent_record import AgentRecord
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose, invert
from sailenv_ros.types.instance_states import InstanceStates, rotation_matrices
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from sailenv_ros.world.world import World

__all__ = ["Exposure", "advance", "exposed"]

_STEP_NS = 1_000_000_000 // STEPS_PER_SECOND + 1


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Exposure:
    """The observations that one frame is made of.

    Attributes
    ----------
    observed : Observation
        Snapshot and camera in the middle, and the poses of rows where they differ.
    samples : tuple of Observation
        Instants whose light is averaged; none where that is the light of `observed`.
    states : InstanceStates
        Of the middle.
    """

    observed: Observation
    samples: tuple[Observation, ...]
    states: InstanceStates


def advance(agents: AgentTable, world: World, count: int) -> None:
    """Advance physics by so many steps, and take notes for the agents whose shutters take time."""
    slow = [record for record in agents if _span_ns(record) > 0.0]
    if not slow:
        world.step(count)
        return
    for _ in range(count):
        _note(slow, agents, world)
        world.step()
    _note(slow, agents, world)


def exposed(record: AgentRecord, snapshot: WorldSnapshot, camera: Camera, world: World) -> Exposure:
    """Return what a frame that is complete now is made of.

    Parameters
    ----------
    record : AgentRecord
        With the notes of `advance`.
    snapshot, camera
        As they are now.
    world : World
        For the states.
    """
    now, settings = Observation(snapshot=snapshot, camera=camera), camera.picture
    span_ns = _span_ns(record)
    if span_ns == 0.0:
        return Exposure(observed=now, samples=(), states=world.states())
    middle_ns = max(0, round(snapshot.sim_time_ns - 0.5 * span_ns))
    height = camera.intrinsics.height
    numbers = np.arange(height, dtype=np.float64)
    offsets: NDArray[np.float64] = (numbers - 0.5 * (height - 1)) * settings.row_time_us * 1e3
    if settings.read_out == "up":
        offsets = -offsets
    known = _Track(record, now)
    observed = known.at(middle_ns, offsets)
    shares = (np.arange(settings.exposure_samples) + 0.5) / settings.exposure_samples - 0.5
    samples: tuple[Observation, ...] = ()
    if known.moves and settings.exposure_time_ms > 0.0 and len(shares) > 1:
        instants = middle_ns + np.round(shares * settings.exposure_time_ms * 1e6).astype(int)
        samples = tuple(known.at(int(instant), offsets) for instant in instants)
    states = _moved_states(world.states(), observed.snapshot, known.moving)
    return Exposure(observed=observed, samples=samples, states=states)


def _span_ns(record: AgentRecord) -> float:
    """Return the time from the first row's exposure to the end of the last one's [ns]."""
    return record.spec.picture.span_ns(record.spec.intrinsics.height)


def _note(records: Iterable[AgentRecord], agents: AgentTable, world: World) -> None:
    snapshot = world.snapshot()
    for record in records:
        notes = record.notes
        # What was moved by hand since the last step stands where it stands now.
        while notes and notes[-1].snapshot.sim_time_ns >= snapshot.sim_time_ns:
            notes.pop()
        notes.append(Observation(snapshot=snapshot, camera=agents.camera(record, world)))
        first_ns = snapshot.sim_time_ns - _span_ns(record) - 2 * _STEP_NS
        while len(notes) > 1 and notes[1].snapshot.sim_time_ns <= first_ns:
            notes.pop(0)


class _Track:
    """Poses of a camera and of everything at the instants that are known, the last one now."""

    def __init__(self, record: AgentRecord, now: Observation) -> None:
        self._now = now
        present = now.snapshot
        time_ns, step = present.sim_time_ns, present.step
        known: list[Observation] = []
        for note in reversed(record.notes):
            # Steps without a note end what is known: the shutter took no time then.
            if note.snapshot.step < step - 1:
                break
            if note.snapshot.step < step:
                known.insert(0, note)
                step = note.snapshot.step
        self._times = np.array([note.snapshot.sim_time_ns for note in known] + [time_ns])
        cameras = [note.camera.world_from_camera for note in known]
        self._cameras = np.stack([*cameras, now.camera.world_from_camera])
        poses = [present.world_from_body]
        for note in reversed(known):
            poses.append(_as_now(note.snapshot, present, poses[-1]))
        all_poses = np.stack(poses[::-1])
        differs = (all_poses != all_poses[-1]).any(axis=(0, 2, 3))
        self.moving: NDArray[np.int64] = np.flatnonzero(differs)
        self._poses = all_poses[:, self.moving]
        self.moves = bool(len(self.moving) or (self._cameras != self._cameras[-1]).any())

    def at(self, middle_ns: int, offsets_ns: NDArray[np.float64]) -> Observation:
        """Return what is observed by rows that are exposed so much later than the middle."""
        snapshot, camera = self._now.snapshot, self._now.camera
        snapshot = replace(snapshot, sim_time_ns=middle_ns)
        if not self.moves:
            return Observation(snapshot=snapshot, camera=camera)
        times = middle_ns + offsets_ns if camera.picture.rolls else np.zeros(0)
        instants = np.append(float(middle_ns), times)  # the middle, then the rows
        seen = self._between(self._cameras[:, None], instants)[:, 0]
        placed = self._between(self._poses, instants)
        poses = snapshot.world_from_body.copy()
        poses[self.moving] = placed[0]
        pose = Pose.from_matrix(seen[0] @ invert(BODY_FROM_OPTICAL))
        rows = None
        if camera.picture.rolls:
            rows = RowPoses(
                times_ns=np.round(times).astype(np.int64),
                world_from_camera=seen[1:],
                ids=snapshot.contents.instance_ids[self.moving],
                world_from_instance=placed[1:],
            )
        return Observation(
            snapshot=replace(snapshot, world_from_body=poses),
            camera=replace(camera, pose=pose),
            rows=rows,
        )

    def _between(
        self, poses: NDArray[np.float64], times: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Return (T, M, 4, 4): poses (K, M, 4, 4) of the known instants, at others."""
        from scipy.spatial.transform import Rotation  # takes long to import, and few need it

        last = len(self._times) - 1
        count = poses.shape[1]
        if last == 0 or count == 0:
            return np.broadcast_to(poses[0], (len(times), *poses.shape[1:])).copy()
        begin = np.clip(np.searchsorted(self._times, times, side="right") - 1, 0, last - 1)
        steps = np.diff(self._times)[begin]
        share = np.clip((times - self._times[begin]) / steps, 0.0, 1.0)[:, None]
        first, second = poses[:-1], poses[1:]
        turns = np.swapaxes(first[..., :3, :3], -1, -2) @ second[..., :3, :3]
        vectors = Rotation.from_matrix(turns.reshape(-1, 3, 3)).as_rotvec()
        vectors = vectors.reshape(last, count, 3)[begin] * share[..., None]
        turned = Rotation.from_matrix(first[begin][..., :3, :3].reshape(-1, 3, 3))
        turned = turned * Rotation.from_rotvec(vectors.reshape(-1, 3))
        result = np.zeros((len(times), count, 4, 4))
        result[..., :3, :3] = rotation_matrices(turned.as_quat()).reshape(-1, count, 3, 3)
        places = first[..., :3, 3][begin]
        result[..., :3, 3] = places + share[..., None] * (second - first)[..., :3, 3][begin]
        result[..., 3, 3] = 1.0
        return result


def _as_now(
    then: WorldSnapshot, now: WorldSnapshot, later: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return (N, 4, 4): poses of then, of what there is now; of what was not, those of later."""
    ids, others = now.contents.instance_ids, then.contents.instance_ids
    poses = later.copy()
    _, rows, columns = np.intersect1d(ids, others, assume_unique=True, return_indices=True)
    same = now.histories[rows] == then.histories[columns]
    poses[rows[same]] = then.world_from_body[columns[same]]
    return poses


def _moved_states(
    states: InstanceStates, snapshot: WorldSnapshot, moving: NDArray[np.int64]
) -> InstanceStates:
    """Return states with the poses of a snapshot, of instances that move."""
    if not len(moving):
        return states
    positions, orientations = states.positions.copy(), states.orientations.copy()
    for row in moving.tolist():
        pose = Pose.from_matrix(snapshot.world_from_body[row])
        at = states.row(int(snapshot.contents.instance_ids[row]))
        positions[at], orientations[at] = pose.position_m, pose.orientation_xyzw
    return replace(states, positions=positions, orientations=orientations)
