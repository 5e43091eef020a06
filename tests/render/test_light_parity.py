"""One law of light: whatever works out a lamp's light comes to the same, at any distance.

The wall at x = 3 faces -x. Each lamp stands before it, on the line through the wall's point at
(3, 0, 0) along which light arrives at right angles, and may be turned by some degrees.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.light.bake import direct
from sailenv_ros.native.ray_types import RAY_SCENE
from sailenv_ros.native.relight_kernels import direct_light_delta
from sailenv_ros.native.render_types import address, record
from sailenv_ros.render.picture.post_pass import Light as SensorLight
from sailenv_ros.render.picture.post_pass import PostPass
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.light_shapes import light_record
from sailenv_ros.types.lights import Environment, Light, LightType
from tests.render.conftest import Render
from tests.support.tiny_scenes import Thing, camera_at, model_of, snapshot_of, wall_mesh

DISTANCES_M = (0.5, 2.0, 8.0, 15.0, 25.0)
AT_X = 3.0
BLACK = Environment(sky_zenith=(0, 0, 0), sky_horizon=(0, 0, 0), sky_ground=(0, 0, 0))
IRRADIANCE = 2.0


@dataclass(frozen=True)
class Case:
    """A type of light, what else is said of it, and by what it is turned."""

    type: LightType
    turned_deg: float = 0.0
    range_m: float = 30.0
    inner_cone_deg: float = 20.0
    outer_cone_deg: float = 35.0
    exponent: float = 0.0
    side_m: float = 1.0

    def light(self, distance_m: float, intensity: float = 1.0) -> Light:
        """The lamp at a distance from the wall."""
        turn = math.radians(self.turned_deg)
        return Light(
            name="lamp",
            type=self.type,
            intensity=intensity,
            position_m=(AT_X - distance_m, 0.0, 0.0),
            direction=(math.cos(turn), math.sin(turn), 0.0),
            range_m=self.range_m,
            inner_cone_deg=self.inner_cone_deg,
            outer_cone_deg=self.outer_cone_deg,
            exponent=self.exponent,
            width_m=self.side_m,
            height_m=self.side_m,
        )

    def irradiance(self, distance_m: float) -> float:
        """The law: irradiance at the wall's point by the lamp with an intensity of 1."""
        along = math.cos(math.radians(self.turned_deg))
        if self.type == "directional":
            return along
        if self.type == "area":
            return self.side_m**2 * along / distance_m**2
        window = max(1.0 - (distance_m / self.range_m) ** 4, 0.0) ** 2
        bright = self._within_the_cone(along) * (along**self.exponent if self.type == "spot" else 1)
        return window * bright / distance_m**2

    def _within_the_cone(self, along: float) -> float:
        if self.type != "spot":
            return 1.0
        inner, outer = (
            math.cos(math.radians(a)) for a in (self.inner_cone_deg, self.outer_cone_deg)
        )
        if inner == outer:
            return float(along >= outer)
        t = min(max((along - outer) / (inner - outer), 0.0), 1.0)
        return t * t * (3.0 - 2.0 * t)


SHARP: dict[str, Any] = {"inner_cone_deg": 25.0, "outer_cone_deg": 25.0}
CASES = {
    "directional": Case("directional"),
    "point": Case("point"),
    "spot, all of it": Case("spot", 10.0),
    "spot, its soft edge": Case("spot", 27.0),
    "spot, beside it": Case("spot", 40.0),
    "spot with an exponent": Case("spot", 15.0, exponent=10.0),
    "spot with an exponent, its edge": Case("spot", 27.0, exponent=2.5),
    "sharp spot, within": Case("spot", 24.9, **SHARP),
    "sharp spot, without": Case("spot", 25.1, **SHARP),
    # Area lights have no range: it must not count.
    "area": Case("area", 20.0, range_m=10.0),
    "area of small range": Case("area", range_m=0.1),
}
EVERY = pytest.mark.parametrize("case", CASES.values(), ids=CASES)
FROM_AFAR = pytest.mark.parametrize("distance_m", DISTANCES_M)


@pytest.fixture
def seen_of(render: Render, monkeypatch: pytest.MonkeyPatch) -> Callable[..., NDArray[np.float64]]:
    """Radiance in the middle of the picture of a matt white wall, before tone curve and sRGB."""
    lit: list[NDArray[np.float16]] = []
    gather = PostPass.gathered

    def noting(post: PostPass, radiance: NDArray[np.float16], *others: Any) -> SensorLight:
        lit.append(radiance.copy())
        return gather(post, radiance, *others)

    monkeypatch.setattr(PostPass, "gathered", noting)
    wall = model_of(wall_mesh(60.0, 60.0), base_colour=(1, 1, 1, 1), roughness=1.0)

    def look(*lights: Light) -> NDArray[np.float64]:
        scene = snapshot_of([Thing(wall, Pose((AT_X, 0.0, 0.0)))], lights=lights, environment=BLACK)
        render(scene, camera_at(width=97, height=73), "rgb")
        return np.asarray(lit.pop()[36, 48, :3], np.float64)

    return look


@EVERY
@FROM_AFAR
def test_live_lamps_follow_the_law(
    case: Case, distance_m: float, seen_of: Callable[..., NDArray[np.float64]]
) -> None:
    """A lamp that the law makes as strong as a sun looks as that sun does.

    Pictures hold halves: two roundings of 2^-11 each are the tolerance.
    """
    # The strongest directional light is drawn apart. This one lights the wall's back.
    back = Light(name="back", type="directional", intensity=1e4, direction=(-1.0, 0.0, 0.0))
    sun = Light(name="sun", type="directional", intensity=IRRADIANCE, direction=(1.0, 0.0, 0.0))
    share = case.irradiance(distance_m)
    seen = seen_of(back, case.light(distance_m, IRRADIANCE / share if share > 0.0 else 1e4))
    wanted = seen_of(sun) if share > 0.0 else np.zeros(3)
    np.testing.assert_allclose(seen, wanted, rtol=2.0**-10, atol=0.0)
    assert share == 0.0 or wanted.min() > 0.1


def without_size(light: Light) -> NDArray[np.void]:
    """A lamp that is a point, a sun without a disc: shadows' edges are another matter."""
    row = light_record(light, sun_radius=0.0)
    if light.type in ("point", "spot"):
        row["radius"] = 0.0
    return row


@EVERY
@FROM_AFAR
def test_relighting_follows_the_law(case: Case, distance_m: float) -> None:
    """Irradiance by the kernel that makes the direct part of light anew."""
    small = replace(case, side_m=1e-3)  # what is near a panel sees more than a point of it
    light = without_size(small.light(distance_m))
    sky, patches = np.zeros((1, 1, 3), np.float32), np.zeros((1, 1), np.int32)
    scene = record(
        RAY_SCENE,
        sky_at=address(sky),
        patches_at=address(patches),
        patch_count=1,
        **dict.fromkeys(("sky_height", "sky_width", "height", "width"), 1),
        channels=3,
    )
    _, found, _ = direct_light_delta(
        scene,
        light,
        np.array([[AT_X, 0.0, 0.0]], np.float32),
        np.array([[-1.0, 0.0, 0.0]], np.float32),
        np.zeros(1, np.int32),
        np.full(1, 2, np.uint8),
        np.full((1, 2), 0.5, np.float32),
        threads=1,
    )
    np.testing.assert_allclose(math.pi * found[0], small.irradiance(distance_m), rtol=1e-5)


@EVERY
@FROM_AFAR
def test_baking_follows_the_law(
    case: Case, distance_m: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Irradiance of the direct part of a bake."""
    monkeypatch.setattr(direct, "light_record", without_size)
    small = replace(case, side_m=1e-3)
    normals = np.array([[-1.0, 0.0, 0.0]], np.float32)
    points = direct.Points(
        positions=np.array([[AT_X, 0.0, 0.0]], np.float32),
        normals=normals,
        faces=normals,
        shifts=np.zeros((1, 2), np.float32),
    )
    pattern = np.full((1, 2), 0.5, np.float32)
    whole = np.ones(1, np.float32)
    nothing: Any = None  # no ray is cast where it is known what arrives
    found, _ = direct.arriving(nothing, small.light(distance_m), points, pattern, whole)
    np.testing.assert_allclose(math.pi * found[0], small.irradiance(distance_m), rtol=1e-5)
