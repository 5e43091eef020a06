"""What bounces and what comes from the surroundings, against closed formulas."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.light.bake.returned_light import BELOW, GLOSS, returned
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light, SkyMap
from tests.support.bake_scenes import COARSE, DARK, ground, hollow, read, still
from tests.support.reference_rays import glazing_transmittance
from tests.support.tiny_scenes import Thing, box_mesh, mesh_of, model_of, wall_mesh


def grey(share: float) -> tuple[float, float, float, float]:
    """A base colour."""
    return (share, share, share, 1.0)


def sending(colour: tuple[float, float, float, float]) -> dict[str, Any]:
    """A material that sends back its base colour and no more: other than metals have gloss."""
    return {"base_colour": colour, "metallic": 1.0}


@pytest.mark.parametrize("roughness", [0.2, 0.5, 0.85, 1.0])
def test_surfaces_give_back_what_their_lobes_do(roughness: float) -> None:
    """The table is the integral of the lobes of lighting.frag over both hemispheres."""
    rng = np.random.default_rng(7)
    share, turn, other, far = rng.random((4, 400_000))
    sine, nv = np.sqrt(share), np.sqrt(1.0 - share)
    view = np.stack([sine, np.zeros_like(sine), nv], axis=1)

    def fresnel(vh: np.ndarray) -> np.ndarray:
        return 0.04 + 0.96 * (1.0 - np.clip(vh, 0.0, 1.0)) ** 5

    def direction(cosine: np.ndarray) -> np.ndarray:
        away = np.sqrt(1.0 - cosine**2)
        angle = 2.0 * np.pi * turn
        return np.stack([away * np.cos(angle), away * np.sin(angle), cosine], axis=1)

    light = direction(np.sqrt(1.0 - other))
    halfway = view + light
    halfway /= np.linalg.norm(halfway, axis=1, keepdims=True)
    below = np.mean(1.0 - fresnel(np.einsum("nx,nx->n", view, halfway)))
    a2 = roughness**4
    facet = direction(np.sqrt((1.0 - far) / (1.0 + (a2 - 1.0) * far)))
    vh = np.einsum("nx,nx->n", view, facet)
    nl = 2.0 * vh * facet[:, 2] - nv
    seen = (nl > 0.0) & (vh > 0.0)
    nl = np.where(seen, nl, 1.0)
    smith = nl * np.sqrt(nv * nv * (1.0 - a2) + a2) + nv * np.sqrt(nl * nl * (1.0 - a2) + a2)
    gloss = np.mean(np.where(seen, fresnel(vh) * 0.5 / smith * nl * 4.0 * vh / facet[:, 2], 0.0))
    assert pytest.approx(below, abs=1e-3) == BELOW
    given = returned(np.array([[0.6, 0.3, 0.0]]), np.array([[roughness]]), np.array([[0.0]]))
    np.testing.assert_allclose(given[0], gloss + below * np.array([0.6, 0.3, 0.0]), atol=2e-3)
    metal = returned(np.array([[0.6, 0.3, 0.0]]), np.array([[roughness]]), np.array([[1.0]]))
    np.testing.assert_allclose(metal[0], [0.6, 0.3, 0.0])


@pytest.mark.parametrize(("colour", "roughness"), [(0.0, 0.0), (0.7, 1.0)])
def test_gloss_sends_back_what_colour_does_not(colour: float, roughness: float) -> None:
    """Of a furnace that is no metal a part comes back before its colour is met, the rest after."""
    look = {"base_colour": grey(colour), "roughness": roughness, "emission": (1.0, 0.5, 0.0)}
    box = Thing(hollow((2.0, 3.0, 2.5), **look))
    snapshot = still([box], lights=())
    baked = bake(snapshot, settings=COARSE)
    expected = np.array([1.0, 0.5, 0.0]) / (1.0 - (GLOSS[int(10 * roughness)] + BELOW * colour))
    _, bounced = read(baked, 1, snapshot, baked.layers[0].bounced)
    np.testing.assert_allclose(bounced.mean(axis=0), expected, rtol=0.03)


@pytest.mark.parametrize("albedo", [0.0, 0.5, 0.8])
def test_a_furnace_glows_alike_everywhere(albedo: float) -> None:
    """In a closed box that glows with e, radiance is e / (1 - albedo), also at the probes."""
    box = Thing(hollow((2.0, 3.0, 2.5), **sending(grey(albedo)), emission=(1.0, 0.5, 0.0)))
    snapshot = still([box], lights=())
    baked = bake(snapshot, settings=COARSE)
    expected = np.array([1.0, 0.5, 0.0]) / (1.0 - albedo)
    _, bounced = read(baked, 1, snapshot, baked.layers[0].bounced)
    np.testing.assert_allclose(bounced, np.broadcast_to(expected, bounced.shape), rtol=0.08)
    np.testing.assert_allclose(bounced.mean(axis=0), expected, rtol=0.03)
    probes = baked.layers[0].probe_bounced.astype(float)[1:-1, 1:-1, 1:-1]
    np.testing.assert_allclose(probes[..., 0, :].mean(axis=(0, 1, 2)), expected, rtol=0.03)
    assert np.abs(probes[..., 1:, :]).max() < 0.05 * expected.max()


def test_a_furnace_glows_in_its_edges_too() -> None:
    """Floor and ceiling go on behind the walls, in texels that are half in the room and half not.

    Their middles lie inside of the walls, where no light is known. Rays from the walls' edges, of
    which half meet these texels, once found them black.
    """
    look = {**sending(grey(0.5)), "emission": (1.0, 1.0, 1.0)}
    inner, thick = 1.0, 0.237
    outer = 2 * (inner + thick)
    slab = model_of(box_mesh((outer, outer, thick)), **look)
    long = model_of(box_mesh((thick, outer, 2 * inner)), **look)
    short = model_of(box_mesh((2 * inner, thick, 2 * inner)), **look)
    away = inner + thick / 2
    walls = [Thing(long, Pose((x, 0.0, 0.0))) for x in (-away, away)]
    walls += [Thing(short, Pose((0.0, y, 0.0))) for y in (-away, away)]
    things = [Thing(slab, Pose((0.0, 0.0, z))) for z in (-away, away)] + walls
    snapshot = still(things, lights=())
    baked = bake(snapshot, settings=COARSE)
    for wall in range(3, 7):
        points, bounced = read(baked, wall, snapshot, baked.layers[0].bounced, steps=40)
        inside = (np.abs(points) < inner + 1e-3).all(axis=1)
        assert inside.sum() > 100
        np.testing.assert_allclose(bounced[inside], 2.0, rtol=0.04)


def test_what_emits_does_so_in_the_pattern_of_its_picture() -> None:
    """Walls of which a quarter of the picture is white light a black box with a quarter."""
    picture = np.zeros((64, 64, 4), np.uint8)
    picture[..., 3] = 255
    picture[:32, 32:, :3] = 255
    look = {"emission": (2.0, 1.0, 0.0), "base_colour_texture": picture, "roughness": 1.0}
    snapshot = still([Thing(hollow((2.0, 2.0, 2.0), **look))], lights=())
    baked = bake(snapshot, settings=COARSE)
    _, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, steps=30)
    # A quarter of the surface is white, and gives back what it gets.
    share = 0.25 / (1.0 - 0.25 * (GLOSS[10] + BELOW))
    np.testing.assert_allclose(bounced.mean(axis=0), share * np.array([2, 1, 0]), rtol=0.06)


def test_a_lamp_that_glows_lights_with_its_own_light_alone() -> None:
    """In a box that is a lamp's shade, the layer of its light has the glow, and no other has."""
    shade = hollow((2.0, 3.0, 2.5), **sending(grey(0.0)), glow=(3.0, 2.0, 1.0))
    lights = tuple(
        Light(name=name, type="point", position_m=(0.0, 0.0, height))
        for name, height in (("its own", 0.3), ("another", -0.3))
    )
    for lit_by, expected in (((), (0, 0, 0)), (("its own",), (3, 2, 1))):
        snapshot = still([Thing(shade, lit_by=lit_by)], lights=lights)
        baked = bake(snapshot, settings=COARSE)
        _, own = read(baked, 1, snapshot, baked.layers[1].bounced)
        np.testing.assert_allclose(own.mean(axis=0), expected, rtol=0.02, atol=1e-6)
        for other in (0, 2):
            assert not baked.layers[other].bounced.any()


def test_no_energy_is_won_or_lost() -> None:
    """In a closed box the walls swallow what the lamp sends out: 4 pi I."""
    albedo, size = 0.6, np.array([2.0, 3.0, 2.5])
    lamp = Light(name="lamp", type="point", position_m=(0.1, -0.2, 0.3), range_m=1000.0)
    snapshot = still([Thing(hollow(size, **sending(grey(albedo))))], lights=(lamp,))
    baked = bake(snapshot, settings=COARSE)
    points, direct = read(baked, 1, snapshot, baked.layers[1].direct, steps=30)
    _, bounced = read(baked, 1, snapshot, baked.layers[1].bounced, steps=30)
    arriving = math.pi * (direct + bounced[:, 0])
    face = np.argmax(np.abs(points) / (size / 2), axis=1)
    areas = [2 * size[1] * size[2], 2 * size[0] * size[2], 2 * size[0] * size[1]]
    absorbed = sum(areas[axis] * arriving[face == axis].mean() for axis in range(3))
    assert (1 - albedo) * absorbed == pytest.approx(4 * math.pi, rel=0.04)


def test_light_takes_the_colour_of_what_it_bounced_from() -> None:
    """Before a red wall the floor gets red light, and its own colour plays no part in it."""
    floor = Thing(ground(4.0, **sending(grey(0.0))))
    wall = Thing(model_of(wall_mesh(4.0, 4.0), **sending((0.9, 0.1, 0.0, 1.0))), Pose((1.0, 0, 0)))
    sun = Light(name="sun", type="directional", direction=(1.0, 0.0, -0.2))
    snapshot = still([floor, wall], lights=(sun,))
    baked = bake(snapshot, settings=COARSE)
    points, bounced = read(baked, 1, snapshot, baked.layers[1].bounced)
    near = (points[:, 0] < 0.8) & (points[:, 0] > 0.0)
    red, green, blue = bounced[near].mean(axis=0)
    assert red > 0.02
    assert green == pytest.approx(red / 9, rel=0.01)
    assert blue == 0.0


def test_a_plane_under_an_even_sky_gets_its_radiance() -> None:
    """Irradiance / pi is the radiance; probes have it as c0 and no direction."""
    sky = Environment(background="colour", background_colour=(0.2, 0.4, 0.8))
    snapshot = still([Thing(ground(1.0, **sending(grey(0.0))))], lights=(), environment=sky)
    baked = bake(snapshot, settings=COARSE)
    _, bounced = read(baked, 1, snapshot, baked.layers[0].bounced)
    np.testing.assert_allclose(bounced, np.broadcast_to((0.2, 0.4, 0.8), bounced.shape), rtol=2e-3)


def test_probes_in_even_light_have_no_direction() -> None:
    """c0 is the radiance, c1 is 0."""
    sky = Environment(background="colour", background_colour=(0.2, 0.4, 0.8))
    speck = Thing(model_of(box_mesh(0.001)), Pose((0.5, 0.5, 0.5)))
    other = Thing(model_of(box_mesh(0.001)), Pose((-0.5, -0.5, -0.5)))
    baked = bake(still([speck, other], lights=(), environment=sky), settings=COARSE)
    probes = baked.layers[0].probe_bounced.astype(float)
    middle = probes.reshape(-1, 4, 3)
    np.testing.assert_allclose(
        middle[:, 0], np.broadcast_to((0.2, 0.4, 0.8), middle[:, 0].shape), rtol=0.01
    )
    assert np.abs(middle[:, 1:]).max() < 0.01


@pytest.mark.parametrize("azimuth", [0.0, 90.0, -135.0])
def test_a_sky_picture_lights_from_where_it_is_bright(azimuth: float) -> None:
    """Middle column towards +x, clockwise as seen from above; row 0 is the zenith."""
    rows = 64
    radiance = np.zeros((rows, 2 * rows, 3), dtype=np.float16)
    column = round((0.5 - azimuth / 360.0) * 2 * rows) % (2 * rows)
    radiance[rows // 2 - 8 : rows // 2, np.arange(column - 4, column + 4) % (2 * rows)] = 30.0
    sky = SkyMap(radiance=radiance, zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0))
    far = [Thing(model_of(box_mesh(0.001)), Pose((s, s, s))) for s in (0.5, -0.5)]
    baked = bake(still(far, lights=(), environment=Environment(sky=sky)), settings=COARSE)
    light = baked.layers[0].probe_bounced.astype(float).reshape(-1, 4, 3).mean(axis=0)[1:, 0]
    assert math.degrees(math.atan2(light[1], light[0])) == pytest.approx(azimuth, abs=2.0)
    assert light[2] > 0.0


def with_a_window(h: float, w: float) -> list[Thing]:
    """A black box of half size h; the wall at x = h has a hole of half size w with glass in it."""
    bars = [(-h, -h, h, -w), (-h, w, h, h), (-h, -w, -w, w), (w, -w, h, w)]
    corners = [[(h, a, b), (h, a, d), (h, c, d), (h, c, b)] for a, b, c, d in bars]
    wall = mesh_of(
        np.array(corners).reshape(-1, 3), [(-1, 0, 0)] * 16, np.zeros((16, 2)),
        [4 * k + np.array(t) for k in range(4) for t in ((0, 1, 2), (0, 2, 3))],
    )  # fmt: skip
    box = hollow(2 * h, **sending(grey(0.0)))
    mesh = box.parts[0].mesh
    open_box = mesh_of(
        mesh.positions, mesh.normals, mesh.uvs,
        [t for t in mesh.triangles if not (mesh.positions[t][:, 0] > h - 1e-6).all()],
    )  # fmt: skip
    black = sending(grey(0.0))
    glass = {"alpha": "blend", "double_sided": True, "base_colour": (1.0, 1.0, 1.0, 0.1)}
    pane = model_of(box_mesh((2e-4, 2 * w, 2 * w)), **glass)
    return [
        Thing(model_of(open_box, **black)),
        Thing(model_of(wall, **black)),
        Thing(pane, Pose((h, 0.0, 0.0))),
    ]


def test_a_window_gives_its_form_factor() -> None:
    """Far from and near to a pane in a black box, the sky's share is that of the opening."""
    h, w = 1.0, 0.4
    sky = Environment(background="colour", background_colour=(1.0, 1.0, 1.0))
    snapshot = still(with_a_window(h, w), lights=(), environment=sky)
    baked = bake(snapshot, settings=replace(COARSE, texel_m=0.04))
    points, bounced = read(baked, 1, snapshot, baked.layers[0].bounced, steps=5)
    # Beside the window's wall all rays graze the glass: light changes within a texel.
    floor = (points[:, 2] < -h + 1e-6) & (points[:, 0] < h - 0.2)
    assert floor.sum() > 10
    grid = (np.arange(60) + 0.5) / 60 * 2 * w - w
    spots = np.stack(np.meshgrid([h], grid, grid), axis=-1).reshape(-1, 3)
    offset = spots[None] - points[floor][:, None]
    d2 = (offset**2).sum(axis=2)
    clear = glazing_transmittance(offset[..., 0] / np.sqrt(d2))
    factors = (clear * offset[..., 2] * offset[..., 0] / d2**2).mean(axis=1)
    expected = 0.9 * factors * (2 * w) ** 2 / math.pi
    np.testing.assert_allclose(bounced[floor][:, 0], expected, rtol=0.06, atol=1e-3)


def test_what_moves_is_told_how_much_glass_lets_through() -> None:
    """Of the sun that comes in through a window as much as of its rays; of one that does not, 1."""
    suns = [
        Light(name=f"sun {x}", type="directional", direction=(x, 0.0, -0.2)) for x in (-1.0, 1.0)
    ]
    baked = bake(still(with_a_window(1.0, 0.4), lights=suns), settings=COARSE)
    passes = 0.9 * float(glazing_transmittance(np.float32([1.0 / math.hypot(1.0, 0.2)]))[0])
    assert [layer.clear for layer in baked.layers] == pytest.approx([1.0, passes, 1.0], abs=1e-4)


def test_the_backs_of_walls_are_black() -> None:
    """Light does not come through a wall, neither straight nor bounced."""
    sun = Light(name="sun", type="directional", direction=(0.3, 0.2, -1.0))
    sky = Environment(background="colour", background_colour=(1.0, 1.0, 1.0))
    snapshot = still([Thing(hollow(2.0))], lights=(sun,), environment=sky)
    baked = bake(snapshot, settings=COARSE)
    for layer in baked.layers:
        assert not read(baked, 1, snapshot, layer.bounced)[1].any()
    assert not DARK.background_colour[0]
