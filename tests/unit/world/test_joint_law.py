"""The law of joints against arithmetic: position and speed in, aim and greatest force out."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sailenv_ros.scene.spec_joints import JointSpec
from sailenv_ros.types.joints import Detents
from sailenv_ros.world.joint_law import BRAKE, JointLaw, law_of

SOFT = {"within": 0.08, "speed": 0.05, "strength": 3.0}
CLICKS = {"every": 0.5, "strength": 0.4}


def law(**keys: Any) -> JointLaw:
    """The law of a hinge from -1 to 1.2 rad with a friction of 0.1 N m."""
    spec = {"type": "hinge", "limits": [-1.0, 1.2], "friction": 0.1, **keys}
    found = law_of(JointSpec.model_validate(spec))
    assert found is not None
    return found


def test_a_joint_with_friction_alone_has_no_law() -> None:
    assert law_of(JointSpec.model_validate({"type": "hinge", "friction": 2.0})) is None


@pytest.mark.parametrize(("end", "shut", "out"), [("low", -1.0, 1.0), ("high", 1.2, -1.0)])
def test_a_soft_close_pulls_in_its_zone_alone(end: str, shut: float, out: float) -> None:
    """To the end that is named, by its spring; at the end and outside nothing moves it."""
    one = law(soft_close={**SOFT, "end": end})
    assert one.motor(shut + 0.081 * out, 0.0, 0.0) == (0.0, 0.1)
    assert one.motor(shut + 0.079 * out, 0.0, 0.0) == (-0.05 * out, 3.0)
    assert one.motor(shut + 0.04 * out, 0.3 * out, -3.0) == (-0.05 * out, 3.0)
    assert one.motor(shut, 0.0, 0.0) == (0.0, 3.0)


def test_a_damper_takes_the_square_of_the_share_of_the_way_that_is_left() -> None:
    """Of what is too fast; the last tenth of the zone is gone with the speed alone."""
    one = law(soft_close=SOFT)
    left = (0.04 - 0.008 - 0.65 / 240) / (0.04 - 0.008)
    aim, force = one.motor(-0.96, -0.65, 0.0)
    assert aim == pytest.approx(-(0.05 + 0.6 * left**2), rel=1e-12)
    assert force == BRAKE
    assert one.motor(-0.993, -0.65, 0.0) == (-0.05, BRAKE)


def test_a_brake_holds_what_it_has_slowed_and_never_pulls() -> None:
    """Something heavy at the speed stays braked; what is slower is pulled by the spring alone."""
    one = law(soft_close=SOFT)
    assert one.motor(-0.96, -0.05, 5.0) == (-0.05, BRAKE)
    assert one.motor(-0.96, -0.05, -1.0) == (-0.05, 3.0)
    assert one.motor(-0.96, -0.04, 5.0) == (-0.05, 3.0)


def test_detents_pull_to_the_nearer_one() -> None:
    """With half of the strength that it takes to leave them: a click takes energy."""
    one = law(detents=CLICKS)
    assert one.motor(0.5, 0.0, 0.0) == (0.0, 0.4)
    for position, place in ((0.26, 0.5), (0.24, 0.0), (-0.7, -0.5), (-0.8, -1.0), (1.2, 1.0)):
        aim, force = one.motor(position, 0.0, 0.0)
        assert force == 0.2
        assert one.motor(position, 1e-3 * (position - place), 0.0)[1] == 0.4
        assert math.copysign(1.0, aim) == math.copysign(1.0, place - position)
        assert aim == pytest.approx(20.0 * (place - position), rel=1e-12)


def test_a_soft_close_goes_before_detents() -> None:
    one = law(soft_close=SOFT, detents=CLICKS)
    assert one.motor(-0.93, 0.0, 0.0) == (-0.05, 3.0)
    assert one.motor(-0.9, 0.0, 0.0)[1] == 0.2


def test_detents_at_places_reach_half_way_or_as_far_as_told() -> None:
    apart = Detents(strength=1.0, at=(0.0, 0.3, 1.0))
    assert apart.reach == pytest.approx(0.15)
    assert apart.nearest(0.7, -math.inf, math.inf) == 1.0
    one = law(detents={"at": [0.0], "within": 0.05, "strength": 1.0})
    assert one.motor(0.06, 0.0, 0.0) == (0.0, 0.1)
    assert one.motor(0.04, 0.0, 0.0)[1] == 0.5


def test_detents_stay_within_limits_and_grow_with_their_piece() -> None:
    clicks = Detents(strength=1.0, every=0.5, within=0.1)
    assert clicks.nearest(1.4, -0.2, 1.4) == 1.0
    assert clicks.nearest(-0.2, -0.2, 1.4) == 0.0
    assert clicks.nearest(1.5, 0.0, 3 * 0.5 - 1e-12) == 1.5
    larger = clicks.scaled(2.0)
    assert (larger.every, larger.within, larger.strength) == (1.0, 0.2, 1.0)
    assert Detents(strength=1.0, at=(0.1, 0.4)).scaled(2.0).at == (0.2, 0.8)
