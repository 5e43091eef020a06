"""Messages of the viewer's socket as typed dictionaries: what the page is told and answered.

Declared once for both sides: mypy checks those who make them, and `scripts/page_messages.py` writes
them as TypeScript for the page. What a page may ask for is declared by the signatures of the
commands; the scene is in `scene_messages`, the room in `room_messages`.
"""

from __future__ import annotations

from typing import Any, Literal

from typing_extensions import NotRequired, TypedDict

from sailenv_ros.types.joints import JointKind
from sailenv_ros.types.view_spec import ViewDisplay
from sailenv_ros.viewer.scene_messages import LensValues, PersonLines, PoseValues, Segment, Vector3

__all__ = [
    "BehaviourInfo",
    "BehaviourParameter",
    "CapturedDataSet",
    "FileHead",
    "FrameForAll",
    "FrameForClient",
    "FrameHead",
    "HelloMessage",
    "JointValues",
    "ObjectMessage",
    "ObjectValues",
    "Overlay",
    "PictureSetting",
    "PixelValues",
    "PlacedObject",
    "RefusedMessage",
    "ReplyMessage",
    "SentFile",
    "ShownMessage",
    "StatsMessage",
    "UndoneStep",
    "ViewInfo",
    "ViewOfFrame",
    "WatchEndedMessage",
]

# -- the greeting -----------------------------------------------------------------------------


class ViewInfo(TypedDict):
    """A view that can be shown; `shown` if it is at first."""

    name: str
    meaning: str
    unit: str
    display: ViewDisplay
    shown: bool


class BehaviourParameter(TypedDict):
    """A parameter of a kind of behaviour."""

    name: str
    about: str
    needed: bool
    default: Any


class BehaviourInfo(TypedDict):
    """A kind of behaviour."""

    type: str
    summary: str
    parameters: list[BehaviourParameter]


class PictureSetting(TypedDict):
    """A setting of pictures: `choices` is empty where it is no list, limits are null for none."""

    name: str
    default: float | bool | str
    choices: list[str]
    whole: bool
    least: float | None
    most: float | None
    unit: str


class HelloMessage(TypedDict):
    """The first message: what never changes while the page is open."""

    type: Literal["hello"]
    control: bool
    debug_agent: str
    views: list[ViewInfo]
    behaviours: list[BehaviourInfo]
    picture_settings: list[PictureSetting]
    materials: list[str]
    skies: list[str]
    data_sets: list[str]


# -- frames and news --------------------------------------------------------------------------


class ViewOfFrame(TypedDict):
    """One picture of a frame: its media type and its size in bytes."""

    name: str
    mime: str
    size: int


class FrameForClient(TypedDict):
    """Part of a frame's head that is each client's own.

    The page asks by `number` for its values and says by it that it has shown the frame; `dropped`
    counts the frames that were not sent before it; `outline` has closed lines u, v, u, v, … [px]
    around the selected object, where the frame has the instance view.
    """

    number: int
    dropped: int
    views: list[ViewOfFrame]
    outline: NotRequired[list[list[int]]]


class FrameForAll(TypedDict):
    """Part of a frame's head that is the same for all; `visible` has ids and numbers of pixels."""

    type: Literal["frame"]
    agent: str
    scene: str
    epoch: int
    revision: int
    sequence: int
    time_s: float
    width: int
    height: int
    fov_deg: float
    lens: LensValues
    position: Vector3
    rpy_deg: Vector3
    lesson: str
    timings_ms: dict[str, float]
    visible: NotRequired[list[tuple[int, int]]]


class FrameHead(FrameForClient, FrameForAll):
    """Head of a binary message; the pictures follow it in the order of `views`."""


class StatsMessage(TypedDict):
    """How fast the simulation runs, what it builds, what can be undone; twice a second."""

    type: Literal["stats"]
    time_s: float
    real_time_factor: float
    skipped_frames: int
    viewers: int
    building: str
    capturing: str
    undo: str
    redo: str


class WatchEndedMessage(TypedDict):
    """No more frames come of the watched agent, and why."""

    type: Literal["watch_ended"]
    why: str


class ObjectValues(PoseValues):
    """An object as it is now: scale, size [m], mass [kg] and what moves it."""

    id: int
    name: str
    asset: str
    category: str
    scale: Vector3
    size: Vector3
    static: bool
    mass_kg: float
    behaviours: list[dict[str, Any]]


class JointValues(TypedDict):
    """The joint that an object moves on: its place and its limits [rad] or [m]."""

    type: JointKind
    position: float
    low: float
    high: float


class ObjectMessage(TypedDict):
    """The selected object, sent when it is selected and when it has changed; null if it is gone."""

    type: Literal["object"]
    id: int
    object: ObjectValues | None
    joint: JointValues | None


class ShownMessage(TypedDict):
    """The page has shown a frame; this alone is not answered."""

    do: Literal["shown"]
    number: int


# -- answers ----------------------------------------------------------------------------------


class ReplyMessage(TypedDict):
    """The result of a command."""

    type: Literal["reply"]
    id: int | None
    result: Any


class RefusedMessage(TypedDict):
    """Why a command was not done, in a sentence."""

    type: Literal["refused"]
    id: int | None
    error: str


class FileHead(TypedDict):
    """Head of a binary message that answers a command by a file; its bytes follow."""

    type: Literal["file"]
    id: int | None
    name: str
    mime: str


class PixelValues(TypedDict):
    """Values at a pixel, by the views' names; those of further views stand beside these.

    ``category_id`` and ``instance_id`` are the numbers, the names are empty for none; a depth is
    null where nothing was hit.
    """

    u: int
    v: int
    sequence: int
    category: NotRequired[str]
    category_id: NotRequired[int]
    instance: NotRequired[str]
    instance_id: NotRequired[int]
    depth: NotRequired[float | Literal["near"] | None]
    flow: NotRequired[tuple[float, float] | None]


class Overlay(TypedDict):
    """Drawn over a frame [px].

    ``boxes``: id, left, top, right, bottom. ``edges``: id, and pieces of lines. ``whole``: closed
    lines u, v, u, v, …, as is ``circle``, the border of what the lens sees. ``waypoints``: number
    from 1 and place; ``track``: the pieces between them. ``people``: see `PersonLines`.
    """

    boxes: list[tuple[int, int, int, int, int]]
    edges: list[tuple[int, list[Segment]]]
    whole: list[list[int]]
    waypoints: list[tuple[int, float, float]]
    track: list[Segment]
    circle: list[list[int]]
    people: list[PersonLines]


class PlacedObject(ObjectValues):
    """An object that was set down; `held` if it was made static to stay where it is."""

    held: bool


class UndoneStep(TypedDict):
    """A change that was undone or done again, and the id of its object or 0."""

    what: str
    id: int


class CapturedDataSet(TypedDict):
    """A data set that was captured: the key of its address, ``captured/KEY``, and what it has."""

    key: str
    name: str
    frames: int
    bytes: int


class SentFile:
    """A file as an answer, sent behind a `FileHead`.

    Parameters
    ----------
    name : str
    data : bytes
    mime : str
    """

    def __init__(self, name: str, data: bytes, mime: str = "image/png") -> None:
        self.name, self.data, self.mime = name, data, mime

    def head(self, number: int | None) -> FileHead:
        """Return the head, for the answer to a call of a number."""
        return {"type": "file", "id": number, "name": self.name, "mime": self.mime}
