"""A recipe's job → a data set: what is missing is made, then what belongs to the whole."""

from __future__ import annotations

import json
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sailenv_ros.dataset.card import write_card
from sailenv_ros.dataset.engine import Engine
from sailenv_ros.dataset.job import JOB_FILE, Job
from sailenv_ros.dataset.manifest import (
    MANIFEST,
    FileHash,
    ShardSummary,
    dataset_hash,
    done_shards,
    summaries_of_files,
)
from sailenv_ros.dataset.merging import finish_formats
from sailenv_ros.dataset.remote_storage import open_storage
from sailenv_ros.dataset.shard_plan import ShardPlan
from sailenv_ros.dataset.storage import Storage
from sailenv_ros.dataset.store import ResumableStore
from sailenv_ros.errors import RecordingError

__all__ = ["RECIPE_FILE", "MadeDataset", "Progress", "job_of", "make_dataset"]

RECIPE_FILE = "recipe.yaml"


@dataclass(frozen=True, slots=True, kw_only=True)
class Progress:
    """Progress of making a data set.

    Attributes
    ----------
    frames, of_frames : int
        Frames that are there, counting those of unfinished shards, and all.
    shards, of_shards : int
        Shards that are whole, and all.
    rate_hz : float
        Frames a second since this began; 0 at first.
    """

    frames: int
    of_frames: int
    shards: int
    of_shards: int
    rate_hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class MadeDataset:
    """A data set that was made, or a part of it.

    Attributes
    ----------
    frames, shards : int
    bytes : int
        Of all its files [B].
    sha256 : str
        Of all names and contents; empty while shards are missing.
    written, left_out : mapping of str to mapping of str to int
        Of each format.
    skipped : mapping of str to int
        Clips that could not be made, by the reason.
    findings : mapping of str to mapping of str to int
        What people should know, such as dark frames: how often in which scene.
    """

    frames: int
    shards: int
    bytes: int
    sha256: str
    written: Mapping[str, Mapping[str, int]]
    left_out: Mapping[str, Mapping[str, int]]
    skipped: Mapping[str, int] = field(default_factory=dict)
    findings: Mapping[str, Mapping[str, int]] = field(default_factory=dict)


def make_dataset(
    job: Job,
    where: str | Path,
    engine: Engine,
    *,
    limit: int = 0,
    on_progress: Callable[[Progress], None] = lambda progress: None,
) -> MadeDataset:
    """Make a data set, or continue one.

    Parameters
    ----------
    job : Job
    where : str or Path
        A folder, or a URL that `fsspec` knows.
    engine : Engine
    limit : int
        Frames after which no other shard is begun; 0 makes all. What is there can be read, and a
        later call continues it.
    on_progress : callable
        Called now and then.

    Raises
    ------
    PlaceTaken, BegunOtherwise
        If something else is there, or a data set of other settings was begun there.
    DeadlineExceeded
        If another process makes it.
    WriteFailed
        If a file cannot be written.
    SailenvError
        If a scene cannot be built.
    """
    storage = open_storage(where)
    store = ResumableStore(storage, job.identity)
    if store.check() and (known := storage.read(MANIFEST)) is not None:
        storage.release()
        return _made(json.loads(known))
    with store.opened():
        if storage.read(RECIPE_FILE) is None:
            storage.write(RECIPE_FILE, job.recipe_text.encode())
        done = _make_shards(job, storage, str(where), engine, limit, on_progress)
        if len(done) < ShardPlan(job.recipe).shards:
            return _made({**_manifest(job, done, {}), "sha256": ""})
        manifest = _finish(job, store, done)
        store.finish()
    return _made(manifest)


def _make_shards(
    job: Job,
    storage: Storage,
    where: str,
    engine: Engine,
    limit: int,
    on_progress: Callable[[Progress], None],
) -> Mapping[int, ShardSummary]:
    """Make the shards that are missing; return the summaries of all, by their numbers."""
    plan = ShardPlan(job.recipe)
    done = done_shards(storage)
    began = time.monotonic()
    before = sum(summary.frames for summary in done.values())

    def tell(frames: int) -> None:
        elapsed = time.monotonic() - began
        on_progress(
            Progress(
                frames=min(before + frames, plan.frames),
                of_frames=plan.frames,
                shards=len(done),
                of_shards=plan.shards,
                rate_hz=frames / elapsed if elapsed > 0.0 else 0.0,
            )
        )

    wanted = plan.shards_of(limit) if limit else plan.shards
    missing = [number for number in range(wanted) if number not in done]
    tell(0)
    if missing:
        for summary in engine.run(job, where, missing, tell):
            done[summary.shard] = summary
    return dict(sorted(done.items()))


def job_of(storage: Storage) -> Job:
    """Return the job of a data set, whole or not.

    Raises
    ------
    RecordingError
        If there is none.
    """
    data = storage.read(JOB_FILE)
    if data is None:
        raise RecordingError(f"{storage.shown} holds no data set: it has no {JOB_FILE}")
    return Job.from_json(data, f"{storage.shown}/{JOB_FILE}")


def _finish(
    job: Job, store: ResumableStore, shards: Mapping[int, ShardSummary]
) -> Mapping[str, Any]:
    """Write what belongs to the whole, and the manifest last."""
    with store.part() as part:
        finish_formats(job.recipe, store.storage, shards, part.folder)
        write_card(job, store.storage, shards, part.folder)
        manifest = _manifest(job, shards, summaries_of_files(part.folder))
        part.note = MANIFEST, (json.dumps(manifest, indent=1) + "\n").encode()
    return manifest


def _manifest(
    job: Job, shards: Mapping[int, ShardSummary], files: Mapping[str, FileHash]
) -> dict[str, Any]:
    everything = [*files.items(), *(pair for one in shards.values() for pair in one.files.items())]
    made = [one.made for one in shards.values()]
    return {
        "name": job.recipe.name,
        "sha256": dataset_hash(everything),
        "frames": sum(one.frames for one in shards.values()),
        "bytes": sum(one.bytes for _, one in everything),
        "shards": [
            {"shard": one.shard, "sha256": dataset_hash(one.files.items()), "frames": one.frames}
            for one in shards.values()
        ],
        "files": {name: {"bytes": one.bytes, "sha256": one.sha256} for name, one in files.items()},
        "written": _sums(one.written for one in shards.values()),
        "left_out": _sums(one.left_out for one in shards.values()),
        "skipped": _sum(one.skipped for one in shards.values()),
        "findings": _sums(one.findings for one in shards.values()),
        "job": job.fingerprint,
        "machines": sorted({str(one.get("machine", "")) for one in made}),
        "seconds": round(sum(float(one.get("seconds", 0.0)) for one in made), 3),
    }


def _made(manifest: Mapping[str, Any]) -> MadeDataset:
    return MadeDataset(
        frames=manifest["frames"],
        shards=len(manifest["shards"]),
        bytes=manifest["bytes"],
        sha256=manifest["sha256"],
        written=manifest["written"],
        left_out=manifest["left_out"],
        skipped=manifest["skipped"],
        findings=manifest.get("findings", {}),
    )


def _sum(parts: Iterable[Mapping[str, int]]) -> dict[str, int]:
    total: Counter[str] = Counter()
    for part in parts:
        total.update(part)
    return dict(sorted(total.items()))


def _sums(parts: Iterable[Mapping[str, Mapping[str, int]]]) -> dict[str, dict[str, int]]:
    listed = list(parts)
    names = dict.fromkeys(name for part in listed for name in part)
    return {name: _sum(part.get(name, {}) for part in listed) for name in names}
