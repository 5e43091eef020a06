"""Which casters a shadow map is drawn of, and where it lies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sailenv_ros.render.scene.shadow_plan import SETTLED_UPDATES, ShadowPlan, ShadowRedraw
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    contents_of,
    model_of,
    moved,
    snapshot_of,
)

SUN = Light(name="sun", type="directional", direction=(0.2, 0.3, -1.0), intensity=1.0)
THINGS = [Thing(model_of(box_mesh(1.0)), Pose((x, 0.0, 0.0))) for x in (-4.0, 0.0, 1.5, 4.0)]
CONTENTS = contents_of(THINGS, lights=(SUN,))


def at(second_m: float, third_m: float) -> WorldSnapshot:
    """Return the world with the two in the middle so far along the x axis [m]."""
    poses = [thing.pose for thing in THINGS]
    poses[1], poses[2] = Pose((second_m, 0.0, 0.0)), Pose((1.5 + third_m, 0.0, 0.0))
    velocities = np.ones((4, 2, 3))
    return replace(snapshot_of(moved(THINGS, *poses), contents=CONTENTS), velocities=velocities)


def drawn(redraw: ShadowRedraw | None) -> list[int]:
    """Return the rows that are drawn into the map."""
    assert redraw is not None
    return np.flatnonzero(redraw.casters).tolist()


def test_what_moves_within_a_room_leaves_the_map_where_it_is() -> None:
    plan = ShadowPlan()
    assert drawn(plan.update(SUN, at(0.0, 0.0))) == [0, 1, 2, 3]
    place = plan.map_from_world
    assert drawn(plan.update(SUN, at(0.1, 0.0))) == [0, 1, 2, 3]  # it had been taken to rest
    for step in range(2, 8):
        redraw = plan.update(SUN, at(0.1 * step, 0.0))
        assert drawn(redraw) == [1]
        assert redraw is not None
        assert redraw.from_resting
    assert plan.map_from_world is place
    assert plan.update(SUN, at(0.7, 0.0)) is None


def test_what_has_stopped_is_drawn_with_what_rests() -> None:
    plan = ShadowPlan()
    for step in range(4):
        redraw = plan.update(SUN, at(0.1 * step, 0.1 * step))
    assert drawn(redraw) == [1, 2]
    steps = range(4, 5 + SETTLED_UPDATES)
    redraws = [plan.update(SUN, at(0.1 * step, 0.3)) for step in steps]
    assert [drawn(one) for one in redraws[:-2]] == [[1, 2]] * (len(redraws) - 2)
    settling = redraws[-2]
    assert settling is not None
    assert settling.resting is not None
    assert np.flatnonzero(settling.resting).tolist() == [2]
    assert not settling.clear
    assert drawn(settling) == drawn(redraws[-1]) == [1]
    # It moves again: all is drawn anew.
    assert drawn(plan.update(SUN, at(3.0, 0.4))) == [0, 1, 2, 3]


def test_things_may_all_go_and_come_back() -> None:
    plan = ShadowPlan()
    nothing = snapshot_of([], lights=(SUN,))
    for step in range(3):
        assert drawn(plan.update(SUN, at(0.1 * step, 0.0))) == [0, 1, 2, 3]
        assert drawn(plan.update(SUN, nothing)) == []
