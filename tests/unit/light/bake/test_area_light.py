"""What arrives from area lights, against sums over fine grids and against what is possible."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sailenv_ros.light.bake.area_light import form_factors, solid_angles
from sailenv_ros.light.bake.direct import Points, arriving
from sailenv_ros.light.bake.light_probes import straight_light
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.ray_patterns import low_discrepancy_points
from sailenv_ros.rays.static_geometry import static_geometry_of
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light, area_sides
from tests.support.bake_scenes import COARSE, ground, read, still
from tests.support.tiny_scenes import Thing, box_mesh, model_of

PANEL = Light(
    name="panel", type="area", position_m=(1.0, 0.2, -0.3), direction=(-0.8, 0.36, 0.48),
    width_m=1.3, height_m=0.7,
)  # fmt: skip


def summed(light: Light, points: np.ndarray, normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The form factors and solid angles of a light's front, by 300 by 300 pieces."""
    width, height = area_sides(light)
    grid = (np.arange(300) + 0.5) / 300 - 0.5
    u, v = np.meshgrid(grid, grid)
    spots = np.asarray(light.position_m) + u.reshape(-1, 1) * width + v.reshape(-1, 1) * height
    piece = light.width_m * light.height_m / len(spots)
    factors, angles = np.zeros((2, len(points)))
    for k, (point, normal) in enumerate(zip(points, normals, strict=True)):
        towards = spots - point
        d2 = (towards**2).sum(axis=1)
        leaving = np.maximum(-(towards @ np.asarray(light.direction)), 0.0)
        angle = piece * leaving / d2**1.5
        cosine = np.maximum(towards @ normal, 0.0) / np.sqrt(d2)
        factors[k], angles[k] = (angle * cosine).sum() / math.pi, angle.sum()
    return factors, angles


def test_formulas_are_the_sum_over_pieces() -> None:
    """At points around a rectangle, behind it and below the horizon too."""
    rng = np.random.default_rng(3)
    points = rng.uniform(-2.0, 2.0, (200, 3)).astype(np.float32)
    normals = rng.normal(size=(200, 3))
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    factors, angles = summed(PANEL, points, normals)
    assert (factors == 0.0).any()
    assert (factors > 0.01).any()
    np.testing.assert_allclose(form_factors(PANEL, points, normals), factors, atol=1e-4)
    np.testing.assert_allclose(solid_angles(PANEL, points), angles, rtol=2e-3, atol=1e-4)


@pytest.mark.parametrize("away", [1e-6, 1e-4, 0.003, 0.01])
def test_all_is_seen_of_a_light_that_is_touched(away: float) -> None:
    """Before the middle of a rectangle nothing else is seen, and nothing is brighter."""
    front = np.asarray(PANEL.direction)
    points = np.float32([np.asarray(PANEL.position_m) + away * front])
    facing = form_factors(PANEL, points, np.float32([-front]))
    np.testing.assert_allclose(facing, 1.0, atol=3 * away + 1e-5)
    assert facing[0] <= 1.0
    np.testing.assert_allclose(solid_angles(PANEL, points), 2 * math.pi, rtol=0.06)
    assert form_factors(PANEL, points, np.float32([front]))[0] == 0.0


def test_a_thing_that_touches_a_light_is_no_brighter_than_it() -> None:
    """On a curtain before a window's light arrives at most all of it, as much as the formula has.

    Sixteen samples of the light, one of which was millimetres away, made single texels a hundred
    times too bright, and rays that met these made bright spots on walls.
    """
    rng = np.random.default_rng(5)
    width, height = area_sides(PANEL)
    front = np.asarray(PANEL.direction)
    across = rng.uniform(-0.45, 0.45, (4000, 2)) @ np.stack([width, height])
    away = rng.uniform(0.001, 0.01, (4000, 1)) * front
    positions = (np.asarray(PANEL.position_m) + across + away).astype(np.float32)
    normals = np.broadcast_to(-front, positions.shape).astype(np.float32)
    far = still([Thing(ground(1.0), Pose((0.0, 0.0, 9.0)))], lights=(PANEL,))
    points = Points(
        positions=positions, normals=normals, faces=normals,
        shifts=rng.uniform(0.0, 1.0, (4000, 2)).astype(np.float32),
    )  # fmt: skip
    scene = RayScene(static_geometry_of(far))
    direct, _ = arriving(scene, PANEL, points, low_discrepancy_points(16))
    np.testing.assert_allclose(direct, form_factors(PANEL, positions, normals), rtol=1e-5)
    assert direct.min() > 0.9
    probes = straight_light(scene, PANEL, positions, low_discrepancy_points(16))
    np.testing.assert_allclose(probes[:, 0], 0.5, rtol=0.15)


def test_half_of_a_light_that_is_hidden_is_half_of_what_arrives() -> None:
    """A screen before one half: far away, where both halves count alike."""
    panel = Light(name="panel", type="area", position_m=(0, 0, 2.0), width_m=1.0, height_m=1.0)
    screen = Thing(model_of(box_mesh((1.0, 2.0, 0.01))), Pose((0.5, 0.0, 1.97)))
    floor = Thing(ground(0.2))
    direct = []
    for things in ([floor], [floor, screen]):
        snapshot = still(things, lights=(panel,))
        baked = bake(snapshot, settings=COARSE)
        direct.append(read(baked, 1, snapshot, baked.layers[1].direct)[1].mean())
    assert direct[1] == pytest.approx(direct[0] / 2, rel=0.08)
