"""A recipe's work, cut into shards by arithmetic alone: `DatasetRecipe` → numbered `Shard`s.

Which scene, random numbers and frame numbers a clip has follows from the recipe and its number, so
any worker can make any shard, and nothing depends on how many there are.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

from sailenv_ros.dataset.recipe import DatasetRecipe

__all__ = ["Clip", "ShardPlan", "SceneSource", "Shard", "clip_groups"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneSource:
    """Origin of one scene.

    Attributes
    ----------
    name : str
        A scene's name or file; of a generated one its kind of room.
    seed : int or None
        Of a generated scene; None for one that there is.
    """

    name: str
    seed: int | None = None

    def __str__(self) -> str:
        return self.name if self.seed is None else f"{self.name} {self.seed}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Clip:
    """Continuous shot of a data set.

    Attributes
    ----------
    number : int
        In the data set, from 0.
    split : str
    scene : SceneSource
    """

    number: int
    split: str
    scene: SceneSource

    def sequence(self, camera: int, cameras: int) -> int:
        """Return the number of what one of so many cameras sees of it, in the data set."""
        return self.number * cameras + camera


@dataclass(frozen=True, slots=True, kw_only=True)
class Shard:
    """Clips that one worker makes together; all of one split.

    Attributes
    ----------
    number : int
        In the data set, from 0.
    split : str
    clips : tuple of Clip
        With consecutive numbers.
    """

    number: int
    split: str
    clips: tuple[Clip, ...]

    @property
    def name(self) -> str:
        """Of its files."""
        return f"{self.number:05d}"


class ShardPlan:
    """All shards of a recipe.

    Parameters
    ----------
    recipe : DatasetRecipe
    """

    def __init__(self, recipe: DatasetRecipe) -> None:
        self.recipe = recipe
        self._sizes = recipe.clips.by_name
        self._firsts = dict(zip(self._sizes, accumulate((0, *self._sizes.values())), strict=False))
        per_shard = recipe.shard.clips
        self._shards = {name: -(-size // per_shard) for name, size in self._sizes.items()}

    @property
    def shards(self) -> int:
        """Number of shards."""
        return sum(self._shards.values())

    @property
    def clips(self) -> int:
        """Number of clips."""
        return sum(self._sizes.values())

    @property
    def frames_of_clip(self) -> int:
        """Frames of all cameras in one clip."""
        return self.recipe.clip.frames * len(self.recipe.cameras)

    @property
    def frames(self) -> int:
        """Frames of the data set."""
        return self.clips * self.frames_of_clip

    def shard(self, number: int) -> Shard:
        """Return a shard by its number.

        Raises
        ------
        IndexError
            If there is none of that number.
        """
        within = number
        for split, count in self._shards.items():
            if 0 <= within < count:
                per_shard = self.recipe.shard.clips
                begin = within * per_shard
                end = min(begin + per_shard, self._sizes[split])
                clips = tuple(self._clip(split, index) for index in range(begin, end))
                return Shard(number=number, split=split, clips=clips)
            within -= count
        raise IndexError(f"there are {self.shards} shards, none of number {number}")

    def shards_of(self, frames: int) -> int:
        """Return how many shards, from the first on, have so many frames; all for more."""
        begun = 0
        for number in range(self.shards):
            if begun >= frames:
                return number
            begun += len(self.shard(number).clips) * self.frames_of_clip
        return self.shards

    def shard_of_clip(self, clip: int) -> int:
        """Return the number of the shard that a clip belongs to.

        Raises
        ------
        IndexError
            If there is none of that number.
        """
        before = 0
        for split, size in self._sizes.items():
            index = clip - self._firsts[split]
            if 0 <= index < size:
                return before + index // self.recipe.shard.clips
            before += self._shards[split]
        raise IndexError(f"there are {self.clips} clips, none of number {clip}")

    def scenes(self, split: str) -> int:
        """Return how many scenes a split sees at most."""
        return self._sources(split)[1][-1]

    def _clip(self, split: str, index: int) -> Clip:
        entries, counts = self._sources(split)
        # Scenes one after another, each as often as any other, but for one.
        scene = index * counts[-1] // self._sizes[split]
        entry = bisect_right(counts, scene)
        before = counts[entry - 1] if entry else 0
        source = entries[entry]
        if source.seed is not None:
            source = SceneSource(name=source.name, seed=source.seed + scene - before)
        return Clip(number=self._firsts[split] + index, split=split, scene=source)

    def _sources(self, split: str) -> tuple[Sequence[SceneSource], Sequence[int]]:
        return self._sources_by_split[split]

    @cached_property
    def _sources_by_split(self) -> dict[str, tuple[Sequence[SceneSource], Sequence[int]]]:
        """Sources, generated ones with their first seed, and the counts of scenes up to each."""
        found: dict[str, tuple[Sequence[SceneSource], Sequence[int]]] = {}
        for split in self._sizes:
            sources: list[SceneSource] = []
            counts: list[int] = []
            for entry in self.recipe.scenes:
                if entry.splits and split not in entry.splits:
                    continue
                if entry.generate is not None:
                    sources.append(SceneSource(name=entry.generate, seed=entry.seeds[0]))
                    counts.append(entry.seeds[1] - entry.seeds[0] + 1)
                else:
                    assert entry.scene is not None
                    sources.append(SceneSource(name=entry.scene))
                    counts.append(1)
            found[split] = (sources, list(accumulate(counts)))
        return found


def clip_groups(shard: Shard, per_scene: int) -> Iterator[tuple[Clip, ...]]:
    """Yield the clips of a shard that are taken from one scene before it begins again."""
    group: list[Clip] = []
    for clip in shard.clips:
        if group and (clip.scene != group[0].scene or len(group) == per_scene):
            yield tuple(group)
            group = []
        group.append(clip)
    yield tuple(group)
