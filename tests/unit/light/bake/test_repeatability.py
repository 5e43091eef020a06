"""The same scene gives the same bytes and the same name; another scene gives another name."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from sailenv_ros.light.bake.fingerprint import fingerprint
from sailenv_ros.light.bake.pipeline import bake
from sailenv_ros.types.baked_light import BakedLight
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Environment, Light, SkyMap
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.bake_scenes import COARSE, ground, still
from tests.support.tiny_scenes import Thing, box_mesh, checker, model_of

LAMP = Light(name="lamp", type="point", position_m=(0.5, 0.2, 1.5))
SUN = Light(name="sun", type="directional", direction=(0.3, 0.3, -1.0))
BOX = Thing(model_of(box_mesh(0.5)), Pose((0.0, 0.0, 0.4)))


def scene(
    box: Thing = BOX, lights: tuple[Light, ...] = (LAMP, SUN), **environment: Any
) -> WorldSnapshot:
    """A floor with a box above it."""
    return still([Thing(ground(2.0)), box], lights=lights, environment=Environment(**environment))


def arrays(baked: BakedLight) -> list[bytes]:
    """All numbers of a bake."""
    maps = [
        array.tobytes()
        for layer in baked.layers
        for array in (layer.direct, layer.bounced, layer.probe_direct, layer.probe_bounced)
    ]
    return maps + [chart.unwrapping.uvs[0].tobytes() for chart in baked.charts.values()]


def test_the_same_scene_gives_the_same_bytes() -> None:
    """Whatever the number of threads."""
    first = bake(scene(), settings=COARSE, workers=1)
    second = bake(scene(), settings=COARSE, workers=3)
    assert arrays(first) == arrays(second)
    assert first.fingerprint == second.fingerprint


def test_previews_are_near_to_the_result() -> None:
    """They have its charts and probes, and at most texels nearly its light."""
    shown: list[BakedLight] = []
    baked = bake(scene(), settings=replace(COARSE, pass_rays=16), preview=shown.append)
    assert len(shown) == 2
    for preview, most in zip(shown, (0.3, 0.1), strict=True):
        assert preview.fingerprint == baked.fingerprint
        assert preview.charts.keys() == baked.charts.keys()
        assert preview.probes == baked.probes
        for rough, fine in zip(preview.layers, baked.layers, strict=True):
            for name in ("direct", "bounced", "probe_bounced"):
                there, wanted = (getattr(y, name).astype(float) for y in (rough, fine))
                assert np.median(np.abs(there - wanted)) <= most * np.abs(wanted).mean()
    plain = bake(scene(), settings=replace(COARSE, pass_rays=16))
    assert arrays(plain) == arrays(baked)


def test_progress_grows_from_0_to_1() -> None:
    """Stages are named, and a bar never runs backwards."""
    told: list[tuple[str, float]] = []
    bake(scene(), settings=COARSE, report=lambda stage, share: told.append((stage, share)))
    shares = [share for _, share in told]
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert 0.9 < shares[-1] <= 1.0 + 1e-9
    assert {"lamp", "sun", "bounces", "probes"} <= {stage for stage, _ in told}


@pytest.mark.parametrize(
    "other",
    [
        scene(replace(BOX, pose=Pose((0.0, 0.0, 0.5)))),
        scene(replace(BOX, scale=(1.0, 1.0, 1.1))),
        scene(Thing(model_of(box_mesh(0.51)), BOX.pose)),
        scene(Thing(model_of(box_mesh(0.5), base_colour=(1, 0, 0, 1)), BOX.pose)),
        scene(Thing(model_of(box_mesh(0.5), base_colour_texture=checker()), BOX.pose)),
        scene(Thing(model_of(box_mesh(0.5), emission=(1, 0, 0)), BOX.pose)),
        scene(Thing(model_of(box_mesh(0.5), alpha="blend"), BOX.pose)),
        scene(Thing(model_of(box_mesh(0.5), double_sided=True), BOX.pose)),
        scene(lights=(LAMP,)),
        scene(lights=(SUN, LAMP)),
        scene(lights=(replace(LAMP, position_m=(0.5, 0.2, 1.6)), SUN)),
        scene(lights=(LAMP, replace(SUN, direction=(0.0, 0.0, -1.0)))),
        scene(lights=(replace(LAMP, range_m=3.0), SUN)),
        scene(sky_zenith=(1.0, 0.0, 0.0)),
        scene(background="colour"),
    ],
)
def test_what_changes_the_light_changes_the_name(other: WorldSnapshot) -> None:
    """Places, shapes, materials, lights, sky."""
    assert fingerprint(other) != fingerprint(scene())


@pytest.mark.parametrize(
    "other",
    [
        scene(lights=(replace(LAMP, colour=(1.0, 0.0, 0.0)), SUN)),
        scene(lights=(LAMP, replace(SUN, intensity=0.0, indirect_multiplier=2.0))),
        scene(exposure=2.0),
        scene(ambient=(1.0, 1.0, 1.0), sky_share=0.1),
    ],
)
def test_what_is_applied_later_does_not(other: WorldSnapshot) -> None:
    """Colours and intensities of lights, exposure, the stand-ins for bounced light."""
    assert fingerprint(other) == fingerprint(scene())


def test_settings_and_skies_count() -> None:
    """Finer texels and another picture of a sky are another bake."""
    assert fingerprint(scene(), COARSE) != fingerprint(scene())
    assert fingerprint(scene(), replace(COARSE, bounces=3)) != fingerprint(scene(), COARSE)
    names = set()
    for value in (0.5, 1.0):
        sky = SkyMap(
            radiance=np.full((4, 8, 3), value, np.float16),
            zenith=(0, 0, 0), horizon=(0, 0, 0), ground=(0, 0, 0),
        )  # fmt: skip
        names.add(fingerprint(scene(sky=sky)))
    assert len(names) == 2


def test_what_moves_does_not_count() -> None:
    """Moving things are no part of a bake, nor of its name."""
    with_ball = scene()
    extra = replace(
        with_ball.contents.instances[1],
        instance=replace(with_ball.contents.instances[1].instance, id=9, static=False),
    )
    contents = replace(with_ball.contents, instances=(*with_ball.contents.instances, extra))
    poses = np.concatenate([with_ball.world_from_body, np.eye(4)[None]])
    moving = replace(
        with_ball, contents=contents, world_from_body=poses, histories=np.ones(3, np.int64)
    )
    assert fingerprint(moving) == fingerprint(scene())
    assert set(bake(moving, settings=COARSE).charts) == {1, 2}
