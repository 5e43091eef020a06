"""How bright that is shown which lies outside a room: as the sky behind it.

Its materials emit the radiance that it has there. Where the sky is blended with the room
(`seen_sky`), so is this: by one factor for all, which brings its mean to where the sky's lies.
"""

from __future__ import annotations

import numpy as np

from sailenv_ros.render.scene.seen_sky import compressed, seen_exposure
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents

__all__ = ["NOTHING_OUTSIDE", "shown_outside"]

MEAN_SHARE = 1.0 / 3.0
"""Share of its greatest radiance that what lies outside has on average."""

NOTHING_OUTSIDE = 0, 0.0


def shown_outside(contents: SceneContents) -> tuple[int, float]:
    """Return the id of what lies outside, and the radiance shown where its colour is white.

    `NOTHING_OUTSIDE` where there is none.
    """
    for drawn in contents.instances:
        if drawn.outside is not None and drawn.model.parts:
            return drawn.instance.id, _radiance(drawn, contents.environment)
    return NOTHING_OUTSIDE


def _radiance(drawn: DrawnInstance, environment: Environment) -> float:
    white = max(drawn.model.parts[0].material.emission)
    factor = environment.outside_factor
    exposure = seen_exposure(environment)
    if exposure is None:
        return white * factor
    mean = np.array([max(1e-6, MEAN_SHARE * white * 2.0**exposure)], np.float32)
    return white * factor * float((compressed(mean) / mean)[0])
