"""Mixing baked layers, against the sums written out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.render.scene.lightmap_compositing import composite_lightmap, instance_light
from sailenv_ros.types.lights import Environment, Light
from tests.support.baked import GRID, baked, layer

SUN = Light(name="sun", type="directional", direction=(0, 0, -1), intensity=2.0)
LAMP = Light(name="lamp", type="point", position_m=(1, 2, 3), intensity=5.0)
POWER = st.floats(0.0, 50.0)
COLOUR = st.tuples(*[st.floats(0.0, 2.0)] * 3)


@given(COLOUR, POWER, st.floats(0.0, 3.0))
def test_a_lamp_counts_by_colour_and_strength_its_bounces_by_their_multiplier(
    colour: tuple[float, float, float], intensity: float, indirect: float
) -> None:
    """Direct and bounced layer, each times what it is to be multiplied by."""
    light = baked({}, [layer(LAMP, direct=0.25, bounced=(0.5, 0.25, 0.125), probe_direct=0.5)])
    lamp = replace(LAMP, colour=colour, intensity=intensity, indirect_multiplier=indirect)
    composited = composite_lightmap(light, [lamp], Environment())
    power = np.asarray(colour) * intensity
    expected = power * (0.25 + indirect * np.array([0.5, 0.25, 0.125]))
    np.testing.assert_allclose(composited.texels()[3, 4, :3], expected, rtol=2e-3, atol=1e-6)
    np.testing.assert_allclose(composited.probes[1, 1, 1, 2], 0.5 * power, rtol=1e-5, atol=1e-6)
    assert not composited.live


def test_the_main_light_s_direct_part_is_left_to_the_renderer() -> None:
    """It adds its bounces alone; its shadows travel in the fourth channel."""
    sun = layer(SUN, direct=0.7, bounced=0.125, visible=0.5)
    composited = composite_lightmap(baked({}, [sun]), [SUN], Environment())
    np.testing.assert_allclose(composited.texels()[0, 0], [0.25, 0.25, 0.25, 0.5], atol=3e-3)
    assert composited.main_baked


def test_a_weaker_sun_is_mixed_in_whole() -> None:
    """Of two directional lights one is drawn in real time; the other is light like any."""
    weak = replace(SUN, name="sky light", intensity=1.0)
    layers = [layer(SUN, direct=0.7, visible=1.0), layer(weak, direct=0.25, visible=1.0)]
    composited = composite_lightmap(baked({}, layers), [SUN, weak], Environment())
    np.testing.assert_allclose(composited.texels()[0, 0, :3], 0.25, rtol=1e-3)


def test_a_light_that_was_moved_is_live_again() -> None:
    """Its layers no longer hold, so they are left out, and it is drawn as it stands."""
    moved = replace(LAMP, position_m=(0.0, 0.0, 1.0))
    composited = composite_lightmap(
        baked({}, [layer(LAMP, direct=1.0, bounced=1.0)]), [moved], Environment()
    )
    assert composited.live == (moved,)
    assert not composited.texels()[..., :3].any()


def test_a_sun_that_was_turned_has_no_baked_shadows() -> None:
    """The fourth channel is all lit, and says that it is nobody's."""
    turned = replace(SUN, direction=(1.0, 0.0, -1.0))
    composited = composite_lightmap(
        baked({}, [layer(SUN, bounced=1.0, visible=0.0)]), [turned], Environment()
    )
    assert not composited.main_baked
    assert composited.live == ()
    assert (composited.texels()[..., 3] == 1.0).all()


def test_a_light_that_was_removed_is_gone() -> None:
    """With its bounces."""
    composited = composite_lightmap(
        baked({}, [layer(LAMP, direct=1.0, bounced=1.0)]), [], Environment()
    )
    assert not composited.texels()[..., :3].any()


def test_ambient_light_counts_as_far_as_it_was_changed() -> None:
    """The scene's own ambient light stands in for bounces, which are baked."""
    of_scene = Environment(ambient=(0.5, 0.5, 0.5))
    light = replace(baked({}, [], layer(None, bounced=0.25)), environment=of_scene)
    np.testing.assert_allclose(composite_lightmap(light, [], of_scene).texels()[0, 0, :3], 0.25)
    brighter = Environment(ambient=(0.75, 0.5, 0.5))
    np.testing.assert_allclose(
        composite_lightmap(light, [], brighter).texels()[0, 0, :3], [0.5, 0.25, 0.25]
    )
    dark = Environment(ambient=(0.0, 0.0, 0.0))
    assert composite_lightmap(light, [], dark).texels().min() == 0.0


def test_the_sky_s_light_follows_the_sky() -> None:
    """Twice as bright a sky gives twice the light of the surroundings."""
    plain = Environment(sky_zenith=(0.5, 0.5, 0.5), sky_horizon=(0.5, 0.5, 0.5))
    light = replace(baked({}, [], layer(None, bounced=0.25)), environment=plain)
    red = Environment(sky_zenith=(1.0, 0.5, 0.5), sky_horizon=(1.0, 0.5, 0.5))
    np.testing.assert_allclose(
        composite_lightmap(light, [], red).texels()[0, 0, :3], [0.5, 0.25, 0.25]
    )


def test_probes_are_interpolated_linearly() -> None:
    """A field that grows linearly is met exactly between the probes, its border goes on."""
    z, y, x = np.meshgrid(*[np.array([-5.0, 0.0, 5.0])] * 3, indexing="ij")
    field = (2.0 * x - 3.0 * y + 0.5 * z + 1.0).astype(np.float32)
    probes = np.broadcast_to(field[..., None, None], (*GRID.shape, 4, 3))
    points = np.random.default_rng(3).uniform(-5.0, 5.0, (200, 3))
    found = instance_light(probes, GRID, points)
    expected = points @ [2.0, -3.0, 0.5] + 1.0
    np.testing.assert_allclose(found[:, 2, 1], expected, atol=1e-4)
    outside = instance_light(probes, GRID, np.array([[99.0, 0.0, 0.0]]))
    assert outside[0, 0, 0] == pytest.approx(11.0)
