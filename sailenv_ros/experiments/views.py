"""Views of the rooms' objects, chosen by a rule and a seed and not by anybody's taste.

Scenes in, pictures with their ground truth out: the object covers a share of the picture, most of
it is seen, azimuths and distances differ.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera, CameraIntrinsics
from sailenv_ros.geometry import look_at
from sailenv_ros.render.backend import RenderBackend
from sailenv_ros.simulation.backends import make_backend
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.snapshot import DrawnInstance, WorldSnapshot

__all__ = ["ROOMS", "Rule", "Stage", "View", "rule_as_data"]

ROOMS = ("room_01", "room_02", "room_03")
SETTLE_STEPS = 480
"""Physics steps after which everything has come to rest: 2 s."""

VERTICAL_FOV_DEG = 50.0


@dataclass(frozen=True, slots=True, kw_only=True)
class Rule:
    """Which views count.

    Attributes
    ----------
    views : int
        Of each class.
    cover : (2,) tuple of float
        Least and greatest share of the picture that the object's visible pixels take.
    visible : float
        Least share of the object that is seen: its pixels over those it would have alone, the part
        beyond the picture's borders included.
    apart_deg : float
        Least angle between the azimuths of two views of one object [deg].
    elevation_deg : (2,) tuple of float
        Lowest and highest camera above the horizon [deg].
    attempts : int
        Cameras that are tried for each view before it is given up.
    seed : int
    """

    views: int = 5
    cover: tuple[float, float] = (0.02, 0.6)
    visible: float = 0.7
    apart_deg: float = 20.0
    elevation_deg: tuple[float, float] = (5.0, 60.0)
    attempts: int = 60
    seed: int = 0


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class View:
    """A picture of an object, and what is to be seen there.

    Attributes
    ----------
    category : str
    room, name : str
        Scene, and the object's name in it.
    picture : (H, W, 3) uint8
        RGB.
    target : (H, W) bool
        The object's visible pixels.
    of_category : (H, W) bool
        The visible pixels of all objects of its category.
    eye_m : (3,) tuple of float
        The camera's place in the world [m].
    azimuth_deg, distance_m : float
        Of the camera, from the object's middle.
    cover, visible : float
        As `Rule` limits them.
    """

    category: str
    room: str
    name: str
    picture: NDArray[np.uint8]
    target: NDArray[np.bool_]
    of_category: NDArray[np.bool_]
    eye_m: tuple[float, float, float]
    azimuth_deg: float
    distance_m: float
    cover: float
    visible: float

    @property
    def box(self) -> NDArray[np.float64]:
        """(4,) box around the visible pixels, as `detections` has boxes."""
        v, u = np.nonzero(self.target)
        return np.array([u.min(), v.min(), u.max() + 1, v.max() + 1], np.float64)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class _Subject:
    """An object in its room."""

    room: str
    row: int
    snapshot: WorldSnapshot
    alone: WorldSnapshot
    boxes: NDArray[np.float64]
    middle: NDArray[np.float64]
    size_m: float

    @property
    def drawn(self) -> DrawnInstance:
        return self.snapshot.contents.instances[self.row]


class Stage:
    """The rooms after everything has come to rest; a context manager.

    Parameters
    ----------
    rooms : sequence of str
        Scenes' names or files.
    width, height : int
        Of the pictures [px].
    """

    def __init__(self, rooms: Sequence[str], width: int, height: int) -> None:
        self._lens = CameraIntrinsics(
            width=width, height=height, vertical_fov_deg=VERTICAL_FOV_DEG, near_m=0.02
        )
        # The same pixels and as many more on each side: what the borders cut off is seen here.
        wide = math.degrees(2 * math.atan(2 * math.tan(0.5 * math.radians(VERTICAL_FOV_DEG))))
        self._wide_lens = replace(
            self._lens, width=2 * width, height=2 * height, vertical_fov_deg=wide
        )
        counter = itertools.count(1)
        library = SceneLibrary()
        self._snapshots: dict[str, WorldSnapshot] = {}
        for room in rooms:
            world = library.build(room, 0, 1, lambda: next(counter))
            try:
                world.step(SETTLE_STEPS)
                self._snapshots[room] = world.snapshot()
            finally:
                world.close()
        self._boxes = {room: _boxes_of(shot) for room, shot in self._snapshots.items()}
        self._renderer: RenderBackend = make_backend("auto", None)
        self._lone_renderer: RenderBackend = make_backend("auto", None)

    @property
    def baked(self) -> bool:
        """True if every room has its light baked, which its pictures are better for."""
        return all(shot.contents.baked is not None for shot in self._snapshots.values())

    @property
    def description(self) -> str:
        """One line about the renderer."""
        return self._renderer.description

    def close(self) -> None:
        """Free the renderers."""
        self._renderer.close()
        self._lone_renderer.close()

    def __enter__(self) -> Stage:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def instances(self, category: str) -> int:
        """Say how many objects of a category the rooms have."""
        return len(self._subjects(category))

    def views(
        self, category: str, rule: Rule, on_view: Callable[[], None] = lambda: None
    ) -> list[View]:
        """Choose views of a category's objects, each object in its turn.

        Cameras are drawn at random, each with a distance for a share of the picture, none in a wall
        or in another object's box; the first that meet the rule are taken. The same seed gives the
        same views.

        Returns
        -------
        views : list of View
            As many as `rule` wants, or fewer if no more were found.
        """
        subjects = self._subjects(category)
        name = int.from_bytes(category.encode(), "little") % 2**63
        random = np.random.default_rng((rule.seed, name))
        chosen: list[View] = []
        for number in range(rule.views):
            # One after another; who has no view left passes the turn on.
            for subject in (*subjects[number % max(1, len(subjects)) :], *subjects)[
                : len(subjects)
            ]:
                view = self._view_of(subject, chosen, rule, random)
                if view is not None:
                    chosen.append(view)
                    break
            on_view()
        return chosen

    def _subjects(self, category: str) -> list[_Subject]:
        return [
            subject
            for room, snapshot in self._snapshots.items()
            for subject in _subjects_of(room, snapshot, self._boxes[room], category)
        ]

    def _view_of(
        self,
        subject: _Subject,
        taken: Sequence[View],
        rule: Rule,
        random: np.random.Generator,
    ) -> View | None:
        used = [
            view.azimuth_deg
            for view in taken
            if (view.room, view.name) == (subject.room, subject.drawn.instance.name)
        ]
        for azimuth_deg, camera, distance_m in _cameras(subject, rule, self._lens, random):
            if _stands_in_something(subject, np.asarray(camera.pose.position_m)):
                continue
            if any(_between_deg(azimuth_deg, other) < rule.apart_deg for other in used):
                continue
            found = self._measured(subject, camera, rule)
            if found is not None:
                cover, visible, instance = found
                return self._pictured(
                    subject, camera, instance, (azimuth_deg, distance_m, cover, visible)
                )
        return None

    def _measured(
        self, subject: _Subject, camera: Camera, rule: Rule
    ) -> tuple[float, float, NDArray[np.uint16]] | None:
        """Give cover, visible share and the instance view if they meet the rule."""
        views = self._renderer.render(subject.snapshot, None, camera, ("instance",)).views
        number = subject.drawn.instance.id
        pixels = int((views["instance"] == number).sum())
        cover = pixels / views["instance"].size
        if not rule.cover[0] <= cover <= rule.cover[1]:
            return None
        wide = Camera(intrinsics=self._wide_lens, pose=camera.pose)
        alone = self._lone_renderer.render(subject.alone, None, wide, ("instance",)).views
        visible = pixels / max(1, int((alone["instance"] == number).sum()))
        return None if visible < rule.visible else (cover, visible, views["instance"])

    def _pictured(
        self,
        subject: _Subject,
        camera: Camera,
        instance: NDArray[np.uint16],
        place: tuple[float, float, float, float],
    ) -> View:
        azimuth_deg, distance_m, cover, visible = place
        picture = self._renderer.render(subject.snapshot, None, camera, ("rgb",)).views["rgb"]
        contents = subject.snapshot.contents
        shown = subject.drawn.instance
        return View(
            category=shown.category,
            room=subject.room,
            name=shown.name,
            picture=picture,
            target=instance == shown.id,
            of_category=contents.category_of_instance[instance] == shown.category_id,
            eye_m=camera.pose.position_m,
            azimuth_deg=azimuth_deg,
            distance_m=distance_m,
            cover=cover,
            visible=visible,
        )


def _boxes_of(snapshot: WorldSnapshot) -> NDArray[np.float64]:
    """Give (N, 2, 3) the lowest and the highest corner of each object in its own axes [m]."""
    drawn = snapshot.contents.instances
    return np.stack([entry.model.bounds() * np.asarray(entry.scale) for entry in drawn])


def _subjects_of(
    room: str, snapshot: WorldSnapshot, boxes: NDArray[np.float64], category: str
) -> Iterator[_Subject]:
    contents = snapshot.contents
    for row, drawn in enumerate(contents.instances):
        if drawn.instance.category != category:
            continue
        low, high = boxes[row]
        pose = snapshot.world_from_body[row]
        yield _Subject(
            room=room,
            row=row,
            snapshot=snapshot,
            alone=replace(
                snapshot,
                contents=replace(contents, instances=(drawn,), lights=(), baked=None),
                world_from_body=snapshot.world_from_body[row : row + 1].copy(),
                histories=snapshot.histories[row : row + 1].copy(),
            ),
            boxes=boxes,
            middle=pose[:3, :3] @ (0.5 * (low + high)) + pose[:3, 3],
            size_m=float(np.linalg.norm(high - low)),
        )


def _cameras(
    subject: _Subject, rule: Rule, lens: CameraIntrinsics, random: np.random.Generator
) -> Iterator[tuple[float, Camera, float]]:
    """Yield azimuth [deg], camera and distance [m]: as many as the rule's attempts."""
    spread = math.tan(0.5 * math.radians(lens.vertical_fov_deg))
    for _ in range(rule.attempts):
        azimuth_deg = float(random.uniform(0.0, 360.0))
        elevation_deg = float(random.uniform(*rule.elevation_deg))
        # The share of the picture that a ball around the object would fill, which it seldom does.
        filled = math.exp(random.uniform(math.log(rule.cover[0] * 3.0), math.log(1.6)))
        distance_m = max(0.12, 0.5 * subject.size_m / (spread * math.sqrt(filled)))
        a, e = math.radians(azimuth_deg), math.radians(elevation_deg)
        towards = np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])
        pose = look_at(subject.middle + distance_m * towards, subject.middle)
        yield azimuth_deg, Camera(intrinsics=lens, pose=pose), distance_m


def _stands_in_something(subject: _Subject, eye: NDArray[np.float64]) -> bool:
    """Say if a camera stands in a wall or in furniture: in a box that is not around both."""
    eye_in, middle_in = (_in_boxes(subject, point) for point in (eye, subject.middle))
    return bool((eye_in & ~middle_in).any())


def _in_boxes(subject: _Subject, point: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Give (N,) in which objects' boxes, each in its own axes, a point of the world lies."""
    poses = subject.snapshot.world_from_body
    own = np.einsum("nij,ni->nj", poses[:, :3, :3], point - poses[:, :3, 3])
    low, high = subject.boxes[:, 0], subject.boxes[:, 1]
    inside: NDArray[np.bool_] = ((low <= own) & (own <= high)).all(axis=1)
    return inside


def _between_deg(first: float, second: float) -> float:
    """Give the angle between two azimuths, 0 to 180."""
    return abs((first - second + 180.0) % 360.0 - 180.0)


def rule_as_data(rule: Rule, rooms: Sequence[str]) -> Mapping[str, object]:
    """Give a rule as a result file keeps it."""
    return {
        "views": rule.views,
        "cover": rule.cover,
        "visible": rule.visible,
        "apart_deg": rule.apart_deg,
        "elevation_deg": rule.elevation_deg,
        "attempts": rule.attempts,
        "seed": rule.seed,
        "rooms": list(rooms),
    }
