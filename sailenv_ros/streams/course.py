"""Courses of streams: which rooms, which cameras, what moves, how the world drifts.

Reads ``config/courses``; errors have file, line and column, all at once, as those of scenes have.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationError

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.authoring.room_rules.rule_files import room_kinds
from sailenv_ros.errors import UnknownName
from sailenv_ros.scene.documents import load_document
from sailenv_ros.scene.field_types import Number, Switch, optional
from sailenv_ros.scene.fields import Fraction, Rule, SceneModel
from sailenv_ros.scene.randomise.thing_table import RandomThing
from sailenv_ros.scene.rules import distinct
from sailenv_ros.scene.scene_diagnostics import Diagnostic, model_diagnostics
from sailenv_ros.scene.spec_picture import PictureSpec
from sailenv_ros.streams.drifts.classes import ClassSpan
from sailenv_ros.streams.drifts.daylight import Daylight
from sailenv_ros.streams.drifts.furniture import Furniture
from sailenv_ros.streams.drifts.lamps import LampAge
from sailenv_ros.streams.drifts.mount import Mount
from sailenv_ros.streams.drifts.paint import Paint
from sailenv_ros.streams.drifts.sensor import SensorDrift
from sailenv_ros.streams.drifts.wear import Wear
from sailenv_ros.streams.state import Drift, DriftRecord, StreamState
from sailenv_ros.system.resources import resource_path
from sailenv_ros.types.agents import MAX_RATE_HZ
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["MOST_FRAMES", "Course", "courses", "load_course"]

MOST_FRAMES = 10_000_000
"""Frames of a stream."""

FOLDER = ("config", "courses")
SUFFIX = ".yaml"

_Side = Annotated[int, Number(least=16, most=4096, whole=True)]
_Count = Annotated[int, Number(least=0, most=16, whole=True)]


def _some_rooms(entry: Mapping[str, Any]) -> Iterator[tuple[tuple[str | int, ...], str]]:
    if not entry.get("scenes") and not entry.get("kinds", True):
        yield (), "needs scenes, or kinds of rooms to be generated"


class RoomsSpec(SceneModel):
    """Rooms that a stream visits, one after the other, in an order that the seed draws."""

    rules: ClassVar[tuple[Rule, ...]] = (_some_rooms,)

    scenes: tuple[str, ...] = Field(default=(), description="names of scenes, or files")
    kinds: tuple[str, ...] = Field(
        default=(), description="kinds of rooms that the seed generates; none: those of `scenes`"
    )
    count: Annotated[int, Number(least=1, most=1000, whole=True)] = Field(
        default=24, description="generated rooms"
    )


class EyeSpec(SceneModel):
    """The camera: its lens, its picture, its habits."""

    width: _Side = Field(default=256, description="[px]")
    height: _Side = Field(default=256, description="[px]")
    fov: Annotated[float, Number(least=10.0, most=120.0, unit="deg")] = Field(
        default=60.0, description="vertical field of view [deg]"
    )
    picture: PictureSpec = Field(default_factory=PictureSpec, description="as of an agent")
    walk: Fraction = Field(default=0.4, description="weight of walking along the room's way")
    carry: Fraction = Field(default=0.2, description="weight of being carried, swaying")
    fixate: Fraction = Field(default=0.3, description="weight of looking at one object on the way")
    stand: Fraction = Field(default=0.1, description="weight of standing still")

    def lens(self, zoom: float = 1.0) -> CameraIntrinsics:
        """Return its lens at a factor of the focal length."""
        half = math.tan(math.radians(self.fov / 2.0)) / zoom
        fov = self.fov if zoom == 1.0 else 2.0 * math.degrees(math.atan(half))
        return CameraIntrinsics(width=self.width, height=self.height, vertical_fov_deg=fov)


class MovesSpec(SceneModel):
    """How many things move in each episode."""

    open: _Count = Field(default=3, description="doors and drawers that open and close")
    pushed: _Count = Field(default=3, description="loose objects that are pushed now and then")


class DriftSpec(SceneModel):
    """How the world changes over the stream; what is left out does not change."""

    daylight: Daylight | None = optional("light of day and year")
    lamps: LampAge | None = optional("age of lamps")
    paint: Paint | None = optional("colour of walls")
    furniture: Furniture | None = optional("furniture that is replaced")
    wear: Wear | None = optional("wear of furniture")
    mount: Mount | None = optional("how the camera is mounted")
    sensor: tuple[SensorDrift, ...] = Field(default=(), description="settings of the picture")
    classes: tuple[ClassSpan, ...] = Field(default=(), description="categories that come and go")

    def single(self) -> Iterator[tuple[str, Drift]]:
        """Yield all that one entry describes, by name."""
        for name in ("daylight", "lamps", "paint", "furniture", "wear", "mount"):
            drift = getattr(self, name)
            if drift is not None:
                yield name, drift
        for drift in self.sensor:
            yield f"sensor {drift.setting}", drift


class Course(SceneModel):
    """A file of ``config/courses``."""

    rules: ClassVar[tuple[Rule, ...]] = (distinct("name", "randomise"),)

    version: Literal[1] = Field(description="of this format; 1")
    name: str = Field(default="", description="the file's name")
    title: str = Field(default="", max_length=200, description="what people call it")
    rate: Annotated[float, Number(above=0.0, most=MAX_RATE_HZ, unit="Hz")] = Field(
        default=25.0, description="frames per simulated second [Hz]"
    )
    episode: Annotated[int, Number(least=2, most=100_000, whole=True)] = Field(
        default=500, description="frames until the room begins again"
    )
    visit: Annotated[int, Number(least=1, most=1000, whole=True)] = Field(
        default=8, description="episodes in a row in the same room"
    )
    baked: Annotated[bool, Switch()] = Field(
        default=False, description="true: with baked light, which takes a while for each room"
    )
    rooms: RoomsSpec = Field(default_factory=RoomsSpec, description="where")
    eye: EyeSpec = Field(default_factory=EyeSpec, description="the camera")
    randomise: tuple[RandomThing, ...] = Field(
        default=(),
        max_length=100,
        description="what is drawn at random in each episode, as in a scene file, people among it",
    )
    moves: MovesSpec = Field(default_factory=MovesSpec, description="what moves")
    drift: DriftSpec = Field(default_factory=DriftSpec, description="what changes")

    def state(self, frame: int, seed: int) -> tuple[StreamState, Mapping[str, DriftRecord]]:
        """Return the drifting state of the world at a frame, and what each drift did to it."""
        state = StreamState()
        records = {name: drift.apply(state, frame, seed) for name, drift in self.drift.single()}
        if self.drift.classes:
            records["classes"] = ClassSpan.apply_all(self.drift.classes, state, frame)
        return state, records


@lru_cache(maxsize=1)
def courses() -> tuple[str, ...]:
    """Return the names of the package's own courses."""
    return tuple(sorted(path.stem for path in resource_path(*FOLDER).glob(f"*{SUFFIX}")))


def load_course(name: str | Path) -> Course:
    """Read a course: one of `courses`, or a file.

    Raises
    ------
    UnknownName
        If there is neither.
    SceneError
        All errors of the file.
    """
    path = Path(name)
    if path.suffix != SUFFIX:
        if str(name) not in courses():
            raise UnknownName("course of a stream", str(name), courses())
        path = resource_path(*FOLDER, f"{name}{SUFFIX}")
    return load_document(path, Course, "a course of a stream", find_errors=_errors)


def _errors(data: dict[str, Any], error: ValidationError | None) -> Iterator[Diagnostic]:
    found = list(model_diagnostics(Course, data, error))
    yield from found
    if found or error is not None:
        return
    course = Course.model_validate(data)
    for index, kind in enumerate(course.rooms.kinds):
        if kind not in room_kinds():
            problem = UnknownName("kind", kind, room_kinds())
            yield Diagnostic(("rooms", "kinds", index), str(problem))
    known = {category.name for category in load_categories().values()}
    for index, span in enumerate(course.drift.classes):
        if span.category not in known:
            problem = UnknownName("category", span.category, known)
            yield Diagnostic(("drift", "classes", index, "category"), str(problem))
    for index, thing in enumerate(course.randomise):
        if thing.every != "epoch":
            yield Diagnostic(("randomise", index, "every"), "must be epoch in a stream")
    if course.eye.picture.to_settings().auto_exposure_s:
        # It depends on all that was seen before, which a frame by its number must not.
        yield Diagnostic(("eye", "picture", "auto_exposure_s"), "is not possible in a stream")
