"""Gravity at run time: what falls, what wakes, what floats, what a reset and a file say of it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.geometry import Pose
from tests.unit.simulation.test_core import make_core

OF_THE_EARTH = (0.0, 0.0, -9.81)


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    """An empty scene in lockstep."""
    core, _ = make_core()
    yield core
    core.close()


def fallen_m(core: SynchronousSimulation, obj: int, steps: int = 48) -> tuple[float, float, float]:
    """Return how far an object moves in some steps."""
    before = core.get_object(obj).pose.position_m
    core.step(steps)
    after = core.get_object(obj).pose.position_m
    return tuple(b - a for a, b in zip(before, after, strict=True))  # type: ignore[return-value]


def test_bodies_fall_by_the_gravity_that_is_set(core: SynchronousSimulation) -> None:
    """By g t² / 2 along any axis, in a fifth of a second, to the integrator's step."""
    assert core.get_gravity() == OF_THE_EARTH
    for axis, pull in ((2, -9.81), (2, -1.62), (1, 4.0)):
        gravity = [0.0, 0.0, 0.0]
        gravity[axis] = pull
        core.set_gravity(gravity)
        assert core.get_gravity() == tuple(gravity)
        ball = core.spawn_object("sphere", pose=Pose((0.0, 0.0, 50.0)), mass_kg=1.0)
        moved = fallen_m(core, ball)
        assert moved[axis] == pytest.approx(0.5 * pull * 0.2**2, rel=0.05)
        core.despawn_object(ball)


def test_what_sleeps_wakes_and_what_floats_floats(core: SynchronousSimulation) -> None:
    """A cube at rest on a floor takes off; one without gravity stays where it was put."""
    core.spawn_object("cube", pose=Pose((0.0, 0.0, 99.5)), scale=(4.0, 4.0, 1.0))
    cube = core.spawn_object("cube", pose=Pose((0.0, 0.0, 100.501)), mass_kg=1.0)
    floating = core.spawn_object("cube", pose=Pose((3.5, 0.0, 105.0)), mass_kg=1.0)
    core.change_object(floating, gravity=False)
    core.step(1200)
    assert fallen_m(core, cube) == (0.0, 0.0, 0.0)
    core.set_gravity((0.0, 0.0, 5.0))
    assert fallen_m(core, cube)[2] == pytest.approx(0.1, rel=0.1)
    assert fallen_m(core, floating) == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_a_reset_restores_it_and_a_saved_scene_says_it(core: SynchronousSimulation) -> None:
    """Until then it holds; the file of the present world has the present gravity."""
    core.set_gravity((0.0, 1.5, -3.0))
    assert "gravity: [0, 1.5, -3]" in core.scene_text()
    core.reset()
    assert core.get_gravity() == OF_THE_EARTH
    assert "\ngravity:" not in core.scene_text()


@pytest.mark.parametrize(
    "gravity", [(0.0, 0.0), (0.0, 0.0, 1001.0), (0.0, 0.0, float("nan")), "up"]
)
def test_what_no_file_can_say_is_refused(core: SynchronousSimulation, gravity: object) -> None:
    """Three finite numbers within 1000; the old gravity stays."""
    with pytest.raises(InvalidRequest, match="gravity must be three finite numbers"):
        core.set_gravity(gravity)  # type: ignore[arg-type]  # on purpose
    assert core.get_gravity() == OF_THE_EARTH
