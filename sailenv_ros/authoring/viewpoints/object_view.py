"""`object_view`: objects in turn, each large enough in the picture and little hidden.

The rule of `sailenv eval detection`, which uses `views_in_turn`, too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from pydantic import Field

from sailenv_ros.authoring.viewpoints.object_targets import (
    Rule,
    Target,
    between_deg,
    cameras,
    is_outside,
    stands_in_something,
    target_of_row,
)
from sailenv_ros.authoring.viewpoints.view_scene import (
    CameraView,
    RuleSettings,
    ViewScene,
    camera_rule,
)
from sailenv_ros.errors import UnknownName
from sailenv_ros.scene.randomise.selectors import is_meant
from sailenv_ros.types.camera import Camera, CameraIntrinsics

__all__ = ["ObjectView", "SeenTarget", "object_view", "views_in_turn"]

Range = tuple[float, float]


class ObjectView(RuleSettings):
    """Settings of `object_view`."""

    objects: tuple[str, ...] = Field(
        default=(), description="names of the objects to look at, or patterns; none: by category"
    )
    categories: tuple[str, ...] = Field(
        default=(), description="categories to look at; none: every object but parts of rooms"
    )
    cover: Range = Field(
        default=(0.02, 0.6), description="share of the picture that the object's pixels take"
    )
    visible: float = Field(
        default=0.7, ge=0.0, le=1.0, description="least share of the object that is seen"
    )
    apart_deg: float = Field(
        default=20.0, ge=0.0, le=180.0, description="between the azimuths of an object's views"
    )
    elevation_deg: Range = Field(
        default=(5.0, 60.0), description="lowest and highest camera above the horizon"
    )


class SeenTarget(NamedTuple):
    """A camera that meets the rule.

    Attributes
    ----------
    target : Target
    camera : Camera
    azimuth_deg, distance_m : float
        Of the camera, from the object's middle.
    measured : tuple
        What the measure returned.
    """

    target: Target
    camera: Camera
    azimuth_deg: float
    distance_m: float
    measured: Any


Measure = Callable[[Target, Camera], Any]


def views_in_turn(
    targets: Sequence[Target],
    rule: Rule,
    lens: CameraIntrinsics,
    random: np.random.Generator,
    measure: Measure,
) -> Iterator[SeenTarget | None]:
    """Choose views around objects, each object in its turn.

    Cameras are drawn at random, each with a distance for a share of the picture, none in a wall, in
    another object's box or outside a room; the first that meets the rule is taken.

    Parameters
    ----------
    targets : sequence of Target
    rule : Rule
    lens : CameraIntrinsics
    random : numpy.random.Generator
    measure : callable
        ``measure(target, camera)`` returns None for what does not meet the rule.

    Yields
    ------
    view : SeenTarget or None
        As many as `rule` wants; None where no object had one left.
    """
    chosen: list[SeenTarget] = []
    for number in range(rule.viewpoints):
        found = None
        # One after another; who has no viewpoint left passes the turn on.
        for target in (*targets[number % max(1, len(targets)) :], *targets)[: len(targets)]:
            used = [view.azimuth_deg for view in chosen if _same(view.target, target)]
            found = _first_view(target, used, rule, lens, random, measure)
            if found is not None:
                chosen.append(found)
                break
        yield found


@camera_rule("object_view", ObjectView)
def object_view(
    scene: ViewScene, settings: ObjectView, count: int, random: np.random.Generator
) -> list[CameraView]:
    """Look at objects in turn, each large enough in the picture and little hidden."""
    rule = Rule(
        viewpoints=count,
        cover=settings.cover,
        visible=settings.visible,
        apart_deg=settings.apart_deg,
        elevation_deg=settings.elevation_deg,
        attempts=settings.attempts,
    )

    def measure(target: Target, camera: Camera) -> bool | None:
        number = target.drawn.instance.id
        view = scene.instances(camera.pose)
        pixels = int((view == number).sum())
        if not rule.cover[0] <= pixels / view.size <= rule.cover[1]:
            return None
        whole = scene.whole_pixels(camera.pose, number)[number]
        return True if pixels / max(1, whole) >= rule.visible else None

    views = views_in_turn(_targets(scene, settings), rule, scene.lens, random, measure)
    return [
        CameraView(pose=view.camera.pose, target_id=view.target.drawn.instance.id)
        for view in views
        if view is not None
    ]


def _targets(scene: ViewScene, settings: ObjectView) -> list[Target]:
    contents = scene.snapshot.contents
    shown = [drawn.instance for drawn in contents.instances]
    for kind, wanted, known in (
        ("object", settings.objects, {i.name for i in shown}),
        ("category", settings.categories, {c.name for c in contents.categories.values()}),
    ):
        for name in wanted:
            if not any(is_meant(name, one) for one in known):
                raise UnknownName(kind, name, sorted(known))
    named = {i.name for i in shown for one in settings.objects if is_meant(one, i.name)}
    categories = set(settings.categories)
    rows = [
        row
        for row, instance in enumerate(shown)
        if (
            instance.name in named or instance.category in categories
            if named or categories
            else instance.id in scene.object_ids
        )
    ]
    return [target_of_row(contents.scene, scene.snapshot, scene.boxes, row) for row in rows]


def _same(first: Target, second: Target) -> bool:
    return (first.room, first.drawn.instance.name) == (second.room, second.drawn.instance.name)


def _first_view(
    target: Target,
    used_deg: Sequence[float],
    rule: Rule,
    lens: CameraIntrinsics,
    random: np.random.Generator,
    measure: Measure,
) -> SeenTarget | None:
    for azimuth_deg, camera, distance_m in cameras(target, rule, lens, random):
        eye = np.asarray(camera.pose.position_m)
        if stands_in_something(target, eye) or is_outside(target, eye):
            continue
        if any(between_deg(azimuth_deg, other) < rule.apart_deg for other in used_deg):
            continue
        measured = measure(target, camera)
        if measured is not None:
            return SeenTarget(target, camera, azimuth_deg, distance_m, measured)
    return None
