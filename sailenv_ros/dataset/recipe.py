"""Contents of a data-set recipe: `DatasetRecipe`, validated and immutable.

A recipe says which scenes are seen by which cameras how often, and what is written of it. Units in
a file are metres, seconds and degrees.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, ClassVar, Literal, TypeAlias, get_args

from pydantic import Field

from sailenv_ros.authoring.room_rules.rule_files import room_kinds
from sailenv_ros.dataset.formats.annotation_rules import AnnotationRules
from sailenv_ros.dataset.formats.formats import FORMATS, format_class
from sailenv_ros.dataset.formats.splits import SPLITS
from sailenv_ros.dataset.formats.view_files import COMPRESSIONS, Compression, compression_fault
from sailenv_ros.dataset.recipe_cameras import AnyCamera, carriers_stand, ordered
from sailenv_ros.scene.field_types import Choice, Number, Switch, Text, Vector, optional
from sailenv_ros.scene.fields import Name, Rule, SceneModel
from sailenv_ros.scene.randomise.thing_table import RandomThing
from sailenv_ros.scene.rules import distinct, distinct_values
from sailenv_ros.types.agents import MAX_RATE_HZ
from sailenv_ros.types.light_choice import STEADY_LIGHTS, SteadyLight
from sailenv_ros.types.views import FIVE_VIEWS, RENDERED_VIEWS, VIEWS

__all__ = ["ClipRecipe", "DatasetRecipe", "SceneRecipe", "ShardRecipe", "SplitSizes"]

FlowChoice: TypeAlias = Literal["forward", "backward", "both"]

MAX_CLIPS = 10_000_000
MAX_CLIP_FRAMES = 100_000

_Seed: TypeAlias = Annotated[int, Number(least=0, most=2**31 - 1, whole=True)]
_Clips: TypeAlias = Annotated[int, Number(least=0, most=MAX_CLIPS, whole=True)]


def _one_source(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    given = [key for key in ("scene", "generate") if entry.get(key) is not None]
    if not given:
        yield (), "must say which scenes: give scene or generate"
    elif len(given) > 1:
        yield ("generate",), "cannot stand beside scene; give one of them"
    elif "seeds" in entry and "generate" not in given:
        yield ("seeds",), "is known beside generate alone"


class SceneRecipe(SceneModel):
    """Scenes of a data set: one by name or file, or many that are generated."""

    rules: ClassVar[tuple[Rule, ...]] = (
        distinct_values("splits"),
        ordered("seeds"),
        _one_source,
    )

    scene: str | None = optional("a scene's name, or a file beside the recipe")
    generate: Annotated[str, Choice(room_kinds())] | None = optional(
        "a kind of room to be generated, one scene of each seed"
    )
    seeds: Annotated[
        tuple[_Seed, _Seed],
        Vector(2, "two numbers [first, last], or one for both", one_for_all=True),
    ] = Field(default=(0, 0), description="first and last seed of generated scenes")
    splits: tuple[Annotated[str, Choice(SPLITS)], ...] = Field(
        default=(), description="splits that see these scenes; all if left out"
    )


class SplitSizes(SceneModel):
    """Number of clips of each split."""

    train: _Clips = Field(default=0, description="clips for training")
    val: _Clips = Field(default=0, description="clips for validation")
    test: _Clips = Field(default=0, description="clips for testing")

    @property
    def by_name(self) -> dict[str, int]:
        """Clips of each split that has any, in the order of `SPLITS`."""
        return {name: getattr(self, name) for name in SPLITS if getattr(self, name)}


class ClipRecipe(SceneModel):
    """Continuous shot: frames of all cameras at a rate, from one moment on."""

    frames: Annotated[int, Number(least=1, most=MAX_CLIP_FRAMES, whole=True)] = Field(
        default=1, description="frames of each camera; 1: single pictures"
    )
    rate: Annotated[float, Number(above=0.0, most=MAX_RATE_HZ, unit="Hz")] = Field(
        default=30.0, description="frames per simulated second [Hz]"
    )
    settle: Annotated[float, Number(least=0.0, most=60.0, unit="s")] = Field(
        default=0.0, description="simulated time before the first frame [s]"
    )
    gap: Annotated[float, Number(least=0.0, most=600.0, unit="s")] = Field(
        default=0.0, description="simulated time between two clips of a scene [s]"
    )
    per_scene: Annotated[int, Number(least=1, most=10_000, whole=True)] = Field(
        default=10,
        description="clips that are taken one after another before the scene begins anew, with "
        "other random numbers; time goes on between them",
    )


class ShardRecipe(SceneModel):
    """Division of the work into shards."""

    clips: Annotated[int, Number(least=1, most=100_000, whole=True)] = Field(
        default=50, description="clips of a shard, which one worker makes in one go"
    )


def _formats_fit(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Return which formats lack views, or have too many cameras."""
    views = entry.get("views", FIVE_VIEWS)
    formats = entry.get("formats", ())
    if not isinstance(views, list | tuple) or not isinstance(formats, list | tuple):
        return
    for index, name in enumerate(formats):
        if not isinstance(name, str) or name not in FORMATS:
            continue
        needed = format_class(name)
        lacking = [view for view in needed.views if view not in views]
        if lacking:
            yield ("formats", index), f"{name} needs the views {', '.join(lacking)}, too"
        elif needed.any_of and not set(needed.any_of) & set(map(str, views)):
            yield ("formats", index), f"{name} needs one of the views {', '.join(needed.any_of)}"
        cameras = entry.get("cameras")
        if needed.of_one_camera and isinstance(cameras, list | tuple) and len(cameras) > 1:
            yield ("formats", index), f"{name} takes one camera, got {len(cameras)}"


def _splits_have_scenes(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Return which splits no scene is for."""
    clips, scenes = entry.get("clips"), entry.get("scenes")
    if not isinstance(scenes, list | tuple) or not scenes:
        return
    sizes = clips if isinstance(clips, Mapping) else {"train": clips}
    for split in SPLITS:
        size = sizes.get(split, 0)
        if not isinstance(size, int) or size <= 0:
            continue
        named = [one.get("splits") or SPLITS for one in scenes if isinstance(one, Mapping)]
        if named and not any(split in one for one in named):
            yield ("scenes",), f"there is none for the split {split}; name it in splits of one"


def _clips_above_zero(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    clips = entry.get("clips")
    if isinstance(clips, Mapping) and all(clips.get(split) in (None, 0) for split in SPLITS):
        yield ("clips",), "must have at least one clip in one split"


def _no_stuff_wanted(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    stuff, wanted = entry.get("stuff"), entry.get("categories")
    if isinstance(stuff, list | tuple) and isinstance(wanted, list | tuple):
        for index, name in enumerate(wanted):
            if name in stuff:
                yield ("categories", index), f"{name} is stuff; name it in one of both"


class AnnotationRecipe(SceneModel):
    """Objects that are annotated."""

    rules: ClassVar[tuple[Rule, ...]] = (_no_stuff_wanted,)

    least_pixels: Annotated[int, Number(least=1, most=2**31 - 1, whole=True)] = Field(
        default=1, description="objects of which fewer are visible are left out"
    )
    categories: tuple[str, ...] = Field(
        default=(), description="objects of other categories are left out; all if left out"
    )
    stuff: tuple[str, ...] = Field(
        default=(),
        description="categories that are no objects, such as wall, floor and ceiling: in none of "
        "the annotations but coco's panoptic ones, one segment each",
    )


def _compressions_fit(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    """Return which views cannot be compressed so, are not made or named twice."""
    listed, formats = entry.get("compression") or (), entry.get("formats", ())
    views = entry.get("views", FIVE_VIEWS)
    if not all(isinstance(one, list | tuple) for one in (listed, formats, views)):
        return
    known = [name for name in formats if isinstance(name, str) and name in FORMATS]
    if listed and known and not any(format_class(name).can_compress for name in known):
        able = ", ".join(name for name in FORMATS if format_class(name).can_compress)
        yield ("compression",), f"is known to the format {able} alone"
    seen: set[str] = set()
    for index, one in enumerate(listed):
        named = one.get("views") if isinstance(one, Mapping) else None
        kind = one.get("kind") if isinstance(one, Mapping) else None
        for place, view in enumerate(named if isinstance(named, list | tuple) else ()):
            if view not in VIEWS or kind not in COMPRESSIONS:
                continue
            problem = compression_fault(view, str(kind))
            if view not in views:
                problem = f"{view} is not among the views"
            elif view in seen:
                problem = f"{view} is named twice"
            if problem:
                yield ("compression", index, "views", place), problem
            seen.add(view)


class CompressionRecipe(SceneModel):
    """Files of some views, in the format webdataset."""

    views: tuple[Annotated[str, Choice(RENDERED_VIEWS)], ...] = Field(
        min_length=1, description="which views"
    )
    kind: Annotated[Compression, Choice(tuple(COMPRESSIONS))] = Field(
        description="; ".join(f"{name}: {text}" for name, text in COMPRESSIONS.items())
    )


class DatasetRecipe(SceneModel):
    """A data set, as its author wrote it down."""

    rules: ClassVar[tuple[Rule, ...]] = (
        distinct("name", "cameras", "randomise"),
        carriers_stand,
        distinct_values("views"),
        distinct_values("formats"),
        _formats_fit,
        _compressions_fit,
        _splits_have_scenes,
        _clips_above_zero,
    )

    version: Annotated[int, Number(least=1, most=1, whole=True)] = Field(
        description="of this format: 1"
    )
    name: Name = Field(description="of the data set; the file's name if left out")
    description: Annotated[str, Text(r"(?s).{0,4000}", "at most 4000 characters")] = Field(
        default="", description="what it is for, told on its card"
    )
    seed: _Seed = Field(default=0, description="of everything that is random")
    scenes: tuple[SceneRecipe, ...] = Field(
        min_length=1, max_length=1000, description="what is seen"
    )
    randomise: tuple[RandomThing, ...] = Field(
        default=(),
        max_length=100,
        description="what is drawn at random whenever a scene begins, as in a scene file; instead "
        "of the scene's own",
    )
    light: Annotated[SteadyLight, Choice(STEADY_LIGHTS)] = Field(
        default="baked",
        description="baked: with bounced light, which is baked first where that was not done yet; "
        "plain: without",
    )
    clips: SplitSizes = Field(description="how many clips each split has")
    clip: ClipRecipe = Field(default_factory=ClipRecipe, description="what a clip is")
    cameras: tuple[AnyCamera, ...] = Field(
        min_length=1, max_length=16, description="what sees each clip"
    )
    views: tuple[Annotated[str, Choice(RENDERED_VIEWS)], ...] = Field(
        default=FIVE_VIEWS, min_length=1, description="what frames hold"
    )
    amodal: Annotated[bool, Switch()] = Field(
        default=False, description="true: amodal masks, too, for formats that tell them"
    )
    formats: tuple[Annotated[str, Choice(tuple(FORMATS))], ...] = Field(
        min_length=1, description="what is written, each into a folder of its own"
    )
    annotations: AnnotationRecipe = Field(
        default_factory=AnnotationRecipe, description="which objects are annotated"
    )
    compression: tuple[CompressionRecipe, ...] = Field(
        default=(),
        max_length=len(RENDERED_VIEWS),
        description="how webdataset writes some views; others are kept exactly",
    )
    flow: Annotated[FlowChoice, Choice(get_args(FlowChoice))] = Field(
        default="forward", description="of kitti and sintel: which flow is written"
    )
    shard: ShardRecipe = Field(default_factory=ShardRecipe, description="how the work is cut")

    @property
    def compression_of_views(self) -> dict[str, Compression]:
        """How views are compressed, by their names; others are not."""
        return {view: one.kind for one in self.compression for view in one.views}

    @property
    def needs_facts(self) -> bool:
        """Whether a format asks for what frames do not show."""
        return any(format_class(name).needs_facts for name in self.formats)

    @property
    def annotation_rules(self) -> AnnotationRules:
        """Objects that are annotated, as formats take it."""
        return AnnotationRules(**self.annotations.model_dump())
