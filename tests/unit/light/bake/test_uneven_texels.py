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

GROOVE_M, HIGH_M = 0.016, 0.005


@pytest.mark.parametrize("turn_deg", [0.0, 30.0])
@pytest.mark.parametrize(
    ("rib_m", "above_m"), [(0.018, 0.0), (0.09, HIGH_M + 0.001)], ids=["ribs", "hollow_plates"]
)
def test_grooves_are_evenly_lit(turn_deg: float, rib_m: float, above_m: float) -> None:
    """Of a radiator or a panelled door: texels are wider than a groove and meet it anywhere."""
    turn = (0.0, 0.0, turn_deg)
    across = Pose.from_rpy_deg((0.0, 0.0, 0.0), turn).matrix()[:3, 1]
    half_m = HIGH_M if above_m == 0.0 else 0.001
    rib = model_of(box_mesh((0.6, rib_m, 2 * half_m)), base_colour=BLACK)
    period_m = rib_m + GROOVE_M
    most = math.ceil(0.29 / period_m)
    steps = np.arange(-most, most + 1) * period_m
    things = [Thing(ground(0.55, base_colour=BLACK), Pose.from_rpy_deg((0.0, 0.0, 0.0), turn))]
    up = np.array((0.0, 0.0, above_m))
    things += [Thing(rib, Pose.from_rpy_deg(tuple(y * across + up), turn)) for y in steps]
    # What nobody sees has larger texels: the scene reaches up to where one can look from.
    things.append(Thing(ground(0.01), Pose((0.0, 0.0, 1.0))))
    snapshot = still(things, environment=EVEN, lights=())
    baked = bake(snapshot, settings=SETTINGS)
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, 60)
    beside = (points @ across) % period_m
    groove = beside > 0.5 * period_m - 0.003
    groove &= (beside < 0.5 * period_m + 0.003) & (np.linalg.norm(points, axis=1) < 0.2)
    light = bounced[groove].mean(axis=1)
    # Rays begin so far above surfaces. Of an even sky the bottom of a groove sees so much in its
    # middle, at its sides, and on average by Hottel's crossed strings.
    width, high = GROOVE_M, HIGH_M - LIFT_M
    middle = 0.5 * width / math.hypot(0.5 * width, high)
    side = 0.5 * width / math.hypot(width, high)
    average = (math.hypot(width, high) - high) / width
    assert len(light) > 50
    # Beside wide plates there are texels that meet no more of a groove than its side.
    assert light.min() > (average - 0.07 if rib_m < GROOVE_M + 0.01 else side)
    assert light.max() < middle + 0.03
