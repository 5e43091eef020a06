"""Lamps in what a room mirrors, against solid angles and inverse squares."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.light.bake.area_light import solid_angles
from sailenv_ros.native.light_maps import blur_directions
from sailenv_ros.render.scene import reflection_map
from sailenv_ros.render.scene.lightmap_compositing import sum_texels
from sailenv_ros.render.scene.mirrored_lamps import Seen, Surroundings, glint_of, radiance_of
from sailenv_ros.render.scene.reflection_map import (
    EDGE,
    ROUGHNESSES,
    Glint,
    cube_cameras,
    octahedral_directions,
    prefilter,
)
from sailenv_ros.render.scene.reflection_points import LAMPLESS, MIDDLE
from sailenv_ros.render.scene.room_reflections import RoomReflections
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from tests.support.baked import GRID, baked
from tests.support.tiny_scenes import Thing, box_mesh, model_of, snapshot_of

HERE = np.array([0.3, -0.2, 1.1])
PANEL = Light(
    name="panel", type="area", position_m=(2.0, 0.4, 1.6), direction=(-0.8, 0.1, -0.3),
    width_m=1.2, height_m=0.7, intensity=3.0, colour=(1.0, 0.5, 0.25),
)  # fmt: skip
BULB = Light(name="bulb", type="point", position_m=(-1.0, 0.9, 1.9), intensity=2.0, range_m=500.0)
BLUR = partial(blur_directions, threads=1)


def around(depth_m: float = np.inf) -> Surroundings:
    """A black cube around `HERE`, whose sides are as far."""
    cameras = cube_cameras(HERE)
    size = cameras[0].intrinsics.height, cameras[0].intrinsics.width
    seen = Seen(np.zeros((*size, 3), np.float32), np.full(size, depth_m, np.float32))
    return Surroundings(cameras, [seen] * len(cameras))


def texel_angles() -> NDArray[np.float64]:
    """(EDGE, EDGE): solid angles [sr], by the octahedron's projection."""
    share = np.abs(octahedral_directions(EDGE).astype(np.float64)).sum(axis=2) ** 3
    return 4.0 * np.pi * share / share.sum()


@pytest.mark.parametrize("distance", [0.5, 1.0, 2.5])
def test_an_area_light_is_as_bright_and_as_large_as_it_is(distance: float) -> None:
    """Its radiance in its middle, and over all directions that times its solid angle."""
    offset = distance * (np.array(PANEL.position_m) - HERE)
    panel = replace(PANEL, position_m=tuple(HERE + offset))
    seen = radiance_of(panel, around())
    towards = octahedral_directions(EDGE) @ (offset / np.linalg.norm(offset))
    middle = seen.reshape(-1, 3)[np.argmax(towards)]
    np.testing.assert_allclose(middle, [3.0, 1.5, 0.75], rtol=1e-6)
    total = np.einsum("vuc,vu->c", seen, texel_angles())
    angle = solid_angles(panel, HERE[None].astype(np.float32))[0]
    assert angle > 0.03
    np.testing.assert_allclose(total, angle * np.array(panel.power), rtol=0.02)


def test_an_area_light_does_not_shine_behind() -> None:
    """And no other kind has a face."""
    turned = replace(PANEL, direction=tuple(-np.array(PANEL.direction)))
    for light in (turned, BULB, replace(BULB, type="spot"), Light(name="sun", type="directional")):
        assert not radiance_of(light, around()).any()


def test_what_lies_between_hides_a_lamp() -> None:
    """All of it, or the half that lies behind; what lies behind the lamp hides nothing."""
    for light, far in ((PANEL, 1.75), (BULB, 1.35)):
        for depth, hidden in ((0.5, True), (far, False)):
            place = around(depth)
            assert radiance_of(light, place).any() == (light is PANEL and not hidden)
            assert (glint_of(light, place) is not None) == (light is BULB and not hidden)
    ahead = replace(PANEL, position_m=(2.3, -0.2, 1.1), direction=(-1.0, 0.0, 0.0))
    free = around()
    first = free.pictures[0]
    near = first.depth_m.copy()
    near[:, near.shape[1] // 2 :] = 1.0
    half = Surroundings(free.cameras, [first._replace(depth_m=near), *free.pictures[1:]])
    shares = [(radiance_of(ahead, one)[..., 0] * texel_angles()).sum() for one in (half, free)]
    assert shares[0] / shares[1] == pytest.approx(0.5, abs=0.02)


def test_a_point_light_arrives_by_the_law_of_light() -> None:
    """Intensity over squared distance; of a spot nothing beside its cone."""
    glint = glint_of(BULB, around())
    assert glint is not None
    offset = np.array(BULB.position_m) - HERE
    np.testing.assert_allclose(glint.irradiance, 2.0 / (offset @ offset), rtol=1e-3)
    np.testing.assert_allclose(glint.towards, offset / np.linalg.norm(offset), atol=1e-6)
    direction = tuple(-offset / np.linalg.norm(offset))
    spot = replace(BULB, type="spot", direction=direction)
    lit = glint_of(spot, around())
    assert lit is not None
    np.testing.assert_allclose(lit.irradiance, glint.irradiance, rtol=1e-5)
    assert glint_of(replace(spot, direction=tuple(offset)), around()) is None
    assert glint_of(PANEL, around()) is None


def test_glints_are_blurred_as_bright_texels_are(monkeypatch: pytest.MonkeyPatch) -> None:
    """The formula of their lobe beside many samples of it; as much light in all."""
    monkeypatch.setattr(reflection_map, "SAMPLES", 8192)
    directions, angles = octahedral_directions(EDGE), texel_angles()
    lit = directions @ np.array([0.36, 0.48, 0.8]) > np.cos(np.radians(6.0))
    patch = np.zeros((EDGE, EDGE, 3), np.float32)
    patch[lit] = 1.0 / angles[lit].sum()
    glints = [
        Glint(towards.astype(np.float64), light * angle)
        for towards, light, angle in zip(directions[lit], patch[lit], angles[lit], strict=True)
    ]
    exact, sampled = (
        layers[:, 1:-1, 1:-1, 0].astype(np.float64)
        for layers in (
            prefilter(np.zeros_like(patch), blur=BLUR, glints=glints),
            prefilter(patch, blur=BLUR),
        )
    )
    for roughness, one, other in zip(ROUGHNESSES, exact, sampled, strict=True):
        assert (one * angles).sum() == pytest.approx(1.0, abs=0.025), roughness
        if roughness > 0.0:
            assert (np.abs(one - other) * angles).sum() < 0.1, roughness


def test_large_things_and_lamps_with_highlights_of_their_own_keep_what_they_mirrored() -> None:
    """The point for what is large has no lamp, nor has any one that is drawn live.

    Nor has any one a face where what draws finds faces for each picture.
    """
    middle = np.array(GRID.origin_m) + 5.0
    panel = replace(
        PANEL, position_m=tuple(middle + np.array([2.0, 0.0, -3.0])), direction=(-1.0, 0.0, 0.0)
    )
    box = Thing(model_of(box_mesh(0.2)), Pose((1.0, 2.0, 0.5)))
    scene = snapshot_of([box], lights=(panel,), baked=baked({}, []))

    def look(light: Light | None, views: list[tuple[Camera, bool]]) -> list[Seen]:
        lens = views[0][0].intrinsics
        size = lens.height, lens.width
        value = 0.0 if light is None else 0.01
        radiance = np.full((*size, 3), value, np.float32)
        return [Seen(radiance, np.full(size, np.inf, np.float32)) for _ in views]

    def shown(live: tuple[Light, ...], *, has_faces: bool = True) -> NDArray[np.float16]:
        made = RoomReflections(BLUR, sum_texels, has_faces=has_faces)
        made.update(scene, np.ones(1, np.bool_), None, look, live)
        return made.layers[:, 0, 1:-1, 1:-1, :3]

    lit, live = shown(()), shown((panel,))
    plain = 0.01 * np.array(panel.power)
    np.testing.assert_allclose(lit[LAMPLESS].max(axis=(0, 1)), plain, rtol=2e-3)
    np.testing.assert_allclose(lit[MIDDLE].max(axis=(0, 1)), 101.0 * plain, rtol=2e-3)
    for without in (live, shown((), has_faces=False)):
        np.testing.assert_allclose(without.max(axis=(0, 1, 2)), plain, rtol=2e-3)
