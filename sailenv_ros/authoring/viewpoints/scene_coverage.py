"""`coverage`: few views from free space that show every object together."""

from __future__ import annotations

import itertools
from collections import Counter

import numpy as np
from pydantic import Field

from sailenv_ros.authoring.viewpoints.free_view import FreeView, poses_in_free_space
from sailenv_ros.authoring.viewpoints.view_scene import CameraView, ViewScene, camera_rule
from sailenv_ros.types.geometry import Pose

__all__ = ["Coverage", "coverage"]


class Coverage(FreeView):
    """Settings of `coverage`: those of `free_view`, and what counts as shown."""

    attempts: int = Field(
        default=60, ge=1, le=10_000, description="poses that are looked through, in all"
    )
    objects: int = Field(default=1, ge=0, le=1000, description="least number of objects in view")
    visible: float = Field(
        default=0.4, ge=0.0, le=1.0, description="least share of an object that is seen"
    )


@camera_rule("coverage", Coverage)
def coverage(
    scene: ViewScene, settings: Coverage, count: int, random: np.random.Generator
) -> list[CameraView]:
    """Look from free space so that few views show every object; what adds most comes next.

    Each next view is the one whose objects have been shown least often so far, so views beyond
    those that show everything show it again from elsewhere.
    """
    candidates: list[tuple[Pose, frozenset[int]]] = []
    poses = poses_in_free_space(scene, settings, random)
    for pose in itertools.islice(poses, settings.attempts):
        if (scene.depth_m(pose) >= settings.nearest_m).all():
            seen = scene.seen(pose, settings.cover)
            whole = scene.whole_pixels(pose)
            shown = frozenset(
                id_ for id_, pixels in seen.items() if pixels >= settings.visible * whole[id_]
            )
            if len(shown) >= settings.objects and scene.filled(pose) >= settings.filled:
                candidates.append((pose, shown))
    times: Counter[int] = Counter()
    chosen: list[CameraView] = []
    while candidates and len(chosen) < count:
        # What was shown n times counts 4⁻ⁿ: a new object outweighs three that were shown once.
        gains = [sum(0.25 ** times[id_] for id_ in shown) for _, shown in candidates]
        pose, shown = candidates.pop(int(np.argmax(gains)))
        times.update(shown)
        chosen.append(CameraView(pose=pose))
    return chosen
