"""Job → how many frames, bytes and minutes, by making a few frames of it."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory

from sailenv_ros.dataset.folder_storage import FolderStorage
from sailenv_ros.dataset.job import Job
from sailenv_ros.dataset.shard_maker import ShardMaker
from sailenv_ros.dataset.shard_plan import ShardPlan, clip_groups

__all__ = ["Estimate", "estimate"]

SAMPLE_FRAMES = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Estimate:
    """Estimated cost of making a data set.

    Attributes
    ----------
    frames, clips, shards : int
    scenes_begun : int
        How often a scene is built.
    bytes : int
        Of all files, about [B].
    worker_s : float
        Work of one worker, about [s]; baking light that is not baked yet comes on top.
    sampled : int
        Frames that were made to know it.
    """

    frames: int
    clips: int
    shards: int
    scenes_begun: int
    bytes: int
    worker_s: float
    sampled: int


def estimate(job: Job) -> Estimate:
    """Make a few clips of the first scene in a temporary folder and extrapolate the rest.

    Raises
    ------
    SailenvError
        If its scene cannot be built, or its files not be written.
    """
    plan = ShardPlan(job.recipe)
    recipe = job.recipe
    begun = sum(
        sum(1 for _ in clip_groups(plan.shard(number), recipe.clip.per_scene))
        for number in range(plan.shards)
    )
    frames = max(1, min(recipe.clip.frames, SAMPLE_FRAMES // len(recipe.cameras)))
    clips = max(1, SAMPLE_FRAMES // (frames * len(recipe.cameras)))
    split = next(iter(recipe.clips.by_name))
    clips = min(clips, recipe.clips.by_name[split], recipe.clip.per_scene)
    one_clip = {name: 0 for name in recipe.clips.by_name} | {split: clips}
    with TemporaryDirectory(prefix="sailenv-estimate-") as folder:
        storage = FolderStorage(Path(folder))
        # Once to warm everything up, once to measure.
        started_s, _, _ = _made(job, storage, one_clip | {split: 1}, frames=1)
        measured_s, made, size = _made(job, storage, one_clip, frames=frames)
        started_s, _, _ = _made(job, storage, one_clip | {split: 1}, frames=1)
    per_frame_s = max(0.0, measured_s - started_s) / max(1, made - 1)
    return Estimate(
        frames=plan.frames,
        clips=plan.clips,
        shards=plan.shards,
        scenes_begun=begun,
        bytes=round(size / max(1, made) * plan.frames),
        worker_s=begun * started_s + plan.frames * per_frame_s,
        sampled=made,
    )


def _made(
    job: Job, storage: FolderStorage, clips: dict[str, int], *, frames: int
) -> tuple[float, int, int]:
    """Make one shard of a smaller recipe; return seconds, frames and bytes."""
    recipe = job.recipe
    smaller = recipe.model_copy(
        update={
            "clips": recipe.clips.model_copy(update=clips),
            "clip": recipe.clip.model_copy(update={"frames": frames}),
        }
    )
    with ShardMaker(replace(job, recipe=smaller), storage) as maker, storage.staging() as folder:
        began = time.monotonic()
        summary = maker.make_into(0, folder)
        seconds = time.monotonic() - began
    return seconds, summary.frames, sum(one.bytes for one in summary.files.values())
