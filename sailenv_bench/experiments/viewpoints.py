"""Views of the rooms' objects, chosen by a rule and a seed and not by anybody's taste.

Scenes in, pictures with their ground truth out: the object covers a share of the picture, most of
it is seen, azimuths and distances differ.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.authoring.viewpoints.object_targets import Rule, Target, boxes_of, targets_of
from sailenv_ros.authoring.viewpoints.object_view import SeenTarget, views_in_turn
from sailenv_ros.render.contract import RenderBackend, RenderRequest
from sailenv_ros.render.selection import make_backend
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["ROOMS", "Rule", "Stage", "Viewpoint", "rule_as_data"]

ROOMS = ("room_01", "room_02", "room_03")
SETTLE_STEPS = 480
"""Physics steps after which everything has come to rest: 2 s."""

VERTICAL_FOV_DEG = 50.0

Measured: TypeAlias = tuple[float, float, NDArray[np.uint16]]
"""Cover, visible share, the instance view."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Viewpoint:
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
        library = SceneLibrary()
        self._snapshots: dict[str, WorldSnapshot] = {}
        for room in rooms:
            world = library.build(room)
            try:
                world.step(SETTLE_STEPS)
                self._snapshots[room] = world.snapshot()
            finally:
                world.close()
        self._boxes = {room: boxes_of(shot) for room, shot in self._snapshots.items()}
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
        """Return how many objects of a category the rooms have."""
        return len(self._targets(category))

    def viewpoints(
        self, category: str, rule: Rule, on_viewpoint: Callable[[], None] = lambda: None
    ) -> list[Viewpoint]:
        """Choose viewpoints around a category's objects, each object in its turn.

        Cameras are drawn at random, each with a distance for a share of the picture, none in a wall
        or in another object's box; the first that meet the rule are taken. The same seed gives the
        same viewpoints.

        Returns
        -------
        viewpoints : list of Viewpoint
            As many as `rule` wants, or fewer if no more were found.
        """
        targets = self._targets(category)
        name = int.from_bytes(category.encode(), "little") % 2**63
        random = np.random.default_rng((rule.seed, name))
        chosen: list[Viewpoint] = []

        def measure(target: Target, camera: Camera) -> Measured | None:
            return self._measured(target, camera, rule)

        for view in views_in_turn(targets, rule, self._lens, random, measure):
            if view is not None:
                chosen.append(self._pictured(view))
            on_viewpoint()
        return chosen

    def _targets(self, category: str) -> list[Target]:
        return [
            target
            for room, snapshot in self._snapshots.items()
            for target in targets_of(room, snapshot, self._boxes[room], category)
        ]

    def _measured(self, target: Target, camera: Camera, rule: Rule) -> Measured | None:
        """Return cover, visible share and the instance view if they meet the rule."""
        views = self._renderer.render(RenderRequest(target.snapshot, camera, ("instance",))).views
        number = target.drawn.instance.id
        pixels = int((views["instance"] == number).sum())
        cover = pixels / views["instance"].size
        if not rule.cover[0] <= cover <= rule.cover[1]:
            return None
        wide = Camera(intrinsics=self._wide_lens, pose=camera.pose)
        alone = self._lone_renderer.render(RenderRequest(target.alone, wide, ("instance",))).views
        visible = pixels / max(1, int((alone["instance"] == number).sum()))
        return None if visible < rule.visible else (cover, visible, views["instance"])

    def _pictured(self, view: SeenTarget) -> Viewpoint:
        target, camera = view.target, view.camera
        cover, visible, instance = view.measured
        picture = self._renderer.render(RenderRequest(target.snapshot, camera, ("rgb",))).views[
            "rgb"
        ]
        contents = target.snapshot.contents
        shown = target.drawn.instance
        return Viewpoint(
            category=shown.category,
            room=target.room,
            name=shown.name,
            picture=picture,
            target=instance == shown.id,
            of_category=contents.category_of_instance[instance] == shown.category_id,
            eye_m=camera.pose.position_m,
            azimuth_deg=view.azimuth_deg,
            distance_m=view.distance_m,
            cover=cover,
            visible=visible,
        )


def rule_as_data(rule: Rule, rooms: Sequence[str]) -> Mapping[str, object]:
    """Return a rule as a result file keeps it."""
    return {
        "views": rule.viewpoints,
        "cover": rule.cover,
        "visible": rule.visible,
        "apart_deg": rule.apart_deg,
        "elevation_deg": rule.elevation_deg,
        "attempts": rule.attempts,
        "seed": rule.seed,
        "rooms": list(rooms),
    }
