"""Behaviours under the engine: inside closed boxes, on exact tracks, byte for byte again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.behaviours import start_behaviour
from sailenv_ros.behaviours.waypoints import Waypoints, catmull_pose, linear_pose
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.types.model import BoxShape
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.bullet import STEPS_PER_SECOND
from tests.support.simple_solids import UNIT_BALL, placed, solid
from tests.unit.world.test_world import make_world

HALF_M = 2.0
THICK_M = 0.1

RULER = solid(BoxShape(half_extents_m=(0.1, 0.01, 0.005)))
CRATE = solid(BoxShape(half_extents_m=(0.15, 0.2, 0.1)))

WAYPOINTS: list[dict[str, Any]] = [
    {"position": [0.5, 0, 0]},
    {"position": [1.5, 0.5, 0.3], "rotation": [0, 0, 60]},
    {"position": [0.5, 1.0, -0.3], "rotation": [30, 0, 170]},
]

FIERCE: dict[str, dict[str, Any]] = {
    "poltergeist": {"mean_interval": 0.3, "acceleration": 200.0, "angular_acceleration": 2e4},
    "wander_plane": {"waypoints": [[3, 3, 3], [-3, -3, -3], [0, 0, 0], [1, -1, 1]], "speed": 10.0},
    "uniform_movement_random_bounce": {"speed": 10.0, "angular_speed": 400.0},
    "linear_waypoints": {
        "waypoints": [{"position": [-5, 0, 0]}, {"position": [5, 0.3, 0], "rotation": [0, 90, 9]}],
        "total_time": 2.0,
    },
    "catmull_waypoints": {
        "waypoints": [{"position": [0, -5, 0]}, {"position": [0.2, 5, 0]}, {"position": [1, 1, 9]}],
        "total_time": 2.0,
    },
    "rotate_rigidbody": {"angular_velocity": [200, 0, 90]},
}
"""As fast and as strong as is accepted, and through the walls if it could be."""


def closed_box() -> Iterator[Placement]:
    """Six static walls of 10 cm around 4 x 4 x 4 m of air."""
    for axis in range(3):
        for sign in (-1, 1):
            half, centre = [HALF_M + THICK_M] * 3, [0.0] * 3
            half[axis], centre[axis] = THICK_M / 2, sign * (HALF_M + THICK_M / 2)
            shape = BoxShape(half_extents_m=(half[0], half[1], half[2]))
            place = (centre[0], centre[1], centre[2])
            yield placed(f"wall {axis} {sign}", place, asset=solid(shape), static=True)


def driven(
    name: str, position: tuple[float, float, float], types: dict[str, Any], **kwargs: Any
) -> Placement:
    """A placement with behaviours, without gravity unless said otherwise."""
    behaviours = tuple(
        start_behaviour(type_, parameters, seed=5, object_name=name, place=place)
        for place, (type_, parameters) in enumerate(types.items())
    )
    kwargs.setdefault("gravity", False)
    return placed(name, position, behaviours=behaviours, **kwargs)


def crowd() -> Iterator[Placement]:
    """One thin and one thick body of each behaviour, away from one another."""
    number = 0
    for type_, parameters in FIERCE.items():
        for asset, mass_kg in ((RULER, 0.02), (CRATE, 1.0)):
            place = (number % 4 - 1.5, number // 4 - 1.0, 0.4 * (number % 3) - 0.4)
            heavy = type_ in ("poltergeist", "rotate_rigidbody")
            yield driven(
                f"{type_} {number}",
                place,
                {type_: parameters},
                asset=asset,
                mass_kg=mass_kg,
                gravity=heavy,
            )
            number += 1


def positions(world: Any) -> NDArray[np.float64]:
    return np.asarray(world.snapshot().world_from_body[:, :3, 3])


@pytest.mark.slow
def test_nothing_leaves_a_closed_box() -> None:
    """20 s of the fiercest motion: no body's middle gets beyond the middle of a 10 cm wall."""
    world = make_world(*closed_box(), *crowd())
    before, travelled = positions(world)[6:], np.zeros(12)
    for _ in range(20 * 12):
        world.step(20)
        now = positions(world)[6:]
        assert np.abs(now).max() < HALF_M + THICK_M / 2, world.step_count
        travelled += np.linalg.norm(now - before, axis=1)
        before = now
    world.close()
    # They were not simply stuck.
    assert travelled.min() > 1.0


@pytest.mark.parametrize(
    ("type_", "pose_of"), [("linear_waypoints", linear_pose), ("catmull_waypoints", catmull_pose)]
)
def test_a_free_object_is_exactly_on_its_track(type_: str, pose_of: Any) -> None:
    """Nothing in the way: after each step the body is where the track is at that time."""
    parameters = {"waypoints": WAYPOINTS, "total_time": 3.0}
    track = Waypoints(**parameters)
    world = make_world(driven("thing", (0.5, 0, 0), {type_: parameters}, mass_kg=3.0))
    for _ in range(100):
        world.step(9)
        expected = pose_of(track, world.step_count / STEPS_PER_SECOND).matrix()
        np.testing.assert_allclose(world.snapshot().world_from_body[0], expected, atol=1e-6)
    world.close()


def test_a_uniform_movement_keeps_its_speed_and_bounces() -> None:
    """Between walls its path has the length of speed times time, and it changes direction."""
    parameters = {"speed": 1.5, "start_direction": [1, 0.2, 0]}
    world = make_world(
        *closed_box(),
        driven("ball", (0, 0, 0), {"uniform_movement_random_bounce": parameters}, asset=UNIT_BALL),
    )
    path = [positions(world)[6]]
    for _ in range(480):
        world.step(10)
        path.append(positions(world)[6])
    world.close()
    legs = np.diff(path, axis=0)
    lengths = np.linalg.norm(legs, axis=1)
    assert lengths.sum() == pytest.approx(1.5 * 20.0, rel=0.03)
    turned = (legs[1:] * legs[:-1]).sum(axis=1) < 0.95 * lengths[1:] * lengths[:-1]
    assert turned.sum() >= 5


def test_a_plane_goes_from_place_to_place_and_leans_into_its_curves() -> None:
    """It comes near each waypoint, forward along its nose, rolled left where it turns left."""
    places = [[1.2, 1.2, 0.5], [-1.2, 1.0, -0.5], [0.0, -1.2, 0.3]]
    parameters = {"waypoints": places, "speed": 1.0, "turn_rate": 120.0}
    world = make_world(
        *closed_box(), driven("plane", (0, 0, 0), {"wander_plane": parameters}, asset=CRATE)
    )
    nearest, yaw_rates, rolls = np.full(3, np.inf), [], []
    world.step(240)
    for _ in range(40 * 24):
        world.step(10)
        body = world.body(7)
        pose, (linear, angular) = body.pose(), body.velocity()
        forward = pose.matrix()[:3, 0]
        assert linear @ forward > 0.8 * np.linalg.norm(linear) - 0.05
        nearest = np.minimum(nearest, np.linalg.norm(np.array(places) - pose.position_m, axis=1))
        yaw_rates.append(angular[2])
        rolls.append(pose.rpy_deg[0])
    world.close()
    assert nearest.max() < 0.5
    assert np.corrcoef(yaw_rates, rolls)[0, 1] < -0.5
    assert max(map(abs, rolls)) > 10.0
    assert max(map(abs, rolls)) <= 46.0


def test_a_poltergeist_wakes_what_sleeps() -> None:
    """A body at rest on the floor is pushed from there, again and again."""
    world = make_world(
        *closed_box(),
        driven(
            "crate",
            (0, 0, -1.9),
            {"poltergeist": {"mean_interval": 3.0}},
            asset=CRATE,
            gravity=True,
        ),
    )
    places = []
    for _ in range(12):
        world.step(480)
        places.append(positions(world)[6])
    world.close()
    assert len({tuple(np.round(place, 3)) for place in places}) >= 5


@pytest.mark.slow
def test_everything_at_once_comes_back_byte_for_byte() -> None:
    """2,000 steps with all behaviours, several on one body: two worlds agree in every byte."""

    def run() -> list[bytes]:
        both = driven("both", (0, 0, 1.5), {**FIERCE}, asset=CRATE)
        world = make_world(*closed_box(), *crowd(), both)
        taken = []
        for _ in range(20):
            world.step(100)
            taken.append(world.snapshot().world_from_body.tobytes())
        world.close()
        return taken

    assert run() == run()


def test_behaviours_come_and_go() -> None:
    """What is attached moves the body from then on; detached, its speed remains."""
    world = make_world(driven("thing", (0, 0, 0), {}))
    assert world.moving_ids == frozenset()
    track = {"waypoints": [{"position": [1, 0, 0]}, {"position": [2, 0, 0]}], "total_time": 2.0}
    world.body(1).attach(
        start_behaviour("linear_waypoints", track, seed=0, object_name="thing", place=0)
    )
    assert world.moving_ids == {1}
    world.step(120)
    assert positions(world)[0, 0] == pytest.approx(1.5, abs=1e-6)
    world.body(1).detach()
    assert world.moving_ids == frozenset()
    world.step(120)
    assert positions(world)[0, 0] == pytest.approx(2.0, abs=1e-6)
    world.close()


def test_a_static_object_takes_no_behaviour() -> None:
    """Refused with a sentence that names the object; it has none afterwards."""
    world = make_world(placed("rock", static=True))
    running = start_behaviour("poltergeist", {}, seed=0, object_name="rock", place=0)
    with pytest.raises(InvalidRequest, match="rock"):
        world.body(1).attach(running)
    assert world.body(1).behaviours == ()
    world.close()
