"""Light on relief that is finer than texels: no stripes, and as much as arithmetic says."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.bake.settings import BakeSettings
from sailenv_ros.rays.light_rays import LIFT_M
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment
from tests.support.bake_scenes import ground, read, still
from tests.support.tiny_scenes import Thing, box_mesh, model_of

WHITE = (1.0, 1.0, 1.0)
BLACK = (0.0, 0.0, 0.0, 1.0)
EVEN = Environment(sky_zenith=WHITE, sky_horizon=WHITE, sky_ground=WHITE)
SETTINGS = BakeSettings(texel_m=0.03, fine_texel_m=0.03, probe_spacing_m=1.0, rays=64)

RIB_M, HIGH_M, PERIOD_M = 0.018, 0.005, 0.034


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
def test_grooves_between_ribs_are_evenly_lit(turn_deg: float) -> None:
    """A radiator's plate: texels as wide as rib and groove, which they meet anywhere."""
    turn = (0.0, 0.0, turn_deg)
    across = Pose.from_rpy_deg((0.0, 0.0, 0.0), turn).matrix()[:3, 1]
    rib = model_of(box_mesh((0.6, RIB_M, 2 * HIGH_M)), base_colour=BLACK)
    steps = np.arange(-8, 9) * PERIOD_M
    things = [Thing(ground(0.55, base_colour=BLACK), Pose.from_rpy_deg((0.0, 0.0, 0.0), turn))]
    things += [Thing(rib, Pose.from_rpy_deg(tuple(y * across), turn)) for y in steps]
    # What nobody sees has larger texels: the scene reaches up to where one can look from.
    things.append(Thing(ground(0.01), Pose((0.0, 0.0, 1.0))))
    snapshot = still(things, environment=EVEN, lights=())
    baked = bake(snapshot, settings=SETTINGS)
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, 60)
    beside = (points @ across) % PERIOD_M
    groove = beside > 0.5 * PERIOD_M - 0.003
    groove &= (beside < 0.5 * PERIOD_M + 0.003) & (np.linalg.norm(points, axis=1) < 0.2)
    light = bounced[groove].mean(axis=1)
    # Rays begin so far above surfaces. Of an even sky the bottom of a groove sees so much in its
    # middle, and on average by Hottel's crossed strings.
    width, high = PERIOD_M - RIB_M, HIGH_M - LIFT_M
    middle = 0.5 * width / math.hypot(0.5 * width, high)
    average = (math.hypot(width, high) - high) / width
    assert len(light) > 50
    assert light.min() > average - 0.07
    assert light.max() < middle + 0.03
