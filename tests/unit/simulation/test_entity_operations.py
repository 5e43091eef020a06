"""Operations behind ROS's standard interfaces: velocities of origins, starts, what was added."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sailenv_ros.errors import InvalidRequest, InvalidState
from sailenv_ros.simulation.operations.entity_operations import EntityOperations as Entities
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.space.outlines import Solid
from sailenv_ros.types.entities import Entity
from sailenv_ros.types.geometry import Pose
from tests.support.lockstep_core import lockstep_core
from tests.support.plain_doors import SCENE

HIGH = Pose.from_rpy_deg((30.0, 0.0, 50.0), (20.0, 30.0, 40.0))


def do(core: SynchronousSimulation, operation: Any, *arguments: Any) -> Any:
    return operation.submit_to(core, *arguments).result()


def named(core: SynchronousSimulation) -> dict[str, Entity]:
    return {entity.name: entity for entity in do(core, Entities.entities)}


@pytest.fixture
def doors(tmp_path: Path) -> Iterator[SynchronousSimulation]:
    """A cabinet with a door, a knob on it, and a drawer."""
    path = tmp_path / "joints.yaml"
    path.write_text(SCENE, encoding="utf-8")
    core = lockstep_core(path)
    yield core
    core.close()


@pytest.fixture
def core() -> Iterator[SynchronousSimulation]:
    """The scene `optical`."""
    core = lockstep_core()
    yield core
    core.close()


def test_a_velocity_is_that_of_the_origin_wherever_the_mass_is(core: SynchronousSimulation) -> None:
    """A plate turns about its centre of mass, below its origin; what is set is told."""
    plate = {"name": "plate", "asset": "plane", "scale": (0.5, 0.5, 4.0)}
    number = do(core, Entities.spawn_entry, plate, HIGH)
    velocities = (1.0, 2.0, -0.5), (0.3, -0.2, 4.0)
    do(core, Entities.set_entity, number, HIGH, velocities)
    told = named(core)["plate"]
    np.testing.assert_allclose(told.linear_velocity, velocities[0], atol=1e-12)
    np.testing.assert_allclose(told.angular_velocity, velocities[1], atol=1e-12)
    body = core.world.body(number)
    arm = HIGH.matrix()[:3, :3] @ (0.0, 0.0, -0.05 * 4.0)
    centre = np.asarray(velocities[0]) + np.cross(velocities[1], arm)
    np.testing.assert_allclose(body.velocity()[0], centre, atol=1e-12)
    assert told.added
    assert not named(core)["floor"].added


def test_what_cannot_move_is_refused_and_stays(doors: SynchronousSimulation) -> None:
    """Static objects have no velocity, those on joints no pose of their own."""
    before = named(doors)
    still, moving = ((0.0, 0.0, 0.0),) * 2, ((1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    for name, pose, velocities in (
        ("cabinet", HIGH, moving),
        ("drawer", HIGH, still),
        ("drawer", HIGH, None),
        ("door", None, moving),
    ):
        with pytest.raises(InvalidRequest):
            do(doors, Entities.set_entity, before[name].id, pose, velocities)
    with pytest.raises(InvalidRequest, match="9999"):
        do(doors, Entities.set_entity, 9999, HIGH, None)
    assert named(doors) == before
    do(doors, Entities.set_entity, before["cabinet"].id, HIGH, still)
    assert named(doors)["cabinet"].pose == HIGH


def test_what_was_there_goes_back_joints_too(doors: SynchronousSimulation) -> None:
    """Where it was and as it moved; what was spawned stays, and time."""
    before = named(doors)
    doors.spawn_object("cube", pose=HIGH, object_name="more", mass_kg=1.0)
    doors.move_object("cabinet", position=(3.0, 0.0, 0.0))
    doors.set_joint_position("drawer", 0.25)
    doors.step(24)
    moved = named(doors)
    assert moved["drawer"].pose != before["drawer"].pose
    do(doors, Entities.put_entities_back)
    now = named(doors)
    assert now.keys() == {*before, "more"}
    assert now["more"] == moved["more"]
    for name, entity in before.items():
        np.testing.assert_allclose(now[name].pose.position_m, entity.pose.position_m, atol=1e-12)
        assert now[name].sim_time_ns == 100_000_000


def test_what_moved_at_the_start_moves_again() -> None:
    """A ball that rolls begins to roll again, at its place and its speed."""
    core = lockstep_core("solid_benchmark")
    before = named(core)
    rolling = [e for e in before.values() if any(e.linear_velocity)]
    assert rolling
    core.step(240)
    do(core, Entities.put_entities_back)
    now = named(core)
    for entity in rolling:
        assert now[entity.name].pose == entity.pose
        np.testing.assert_allclose(
            now[entity.name].linear_velocity, entity.linear_velocity, atol=1e-12
        )
    core.close()


def test_what_was_added_goes_and_nothing_else(doors: SynchronousSimulation) -> None:
    """With what hangs on it; none of it while lessons name one."""
    before = named(doors)
    doors.spawn_object("cube", pose=HIGH, object_name="carrier")
    knob = {
        **{"name": "knob 2", "asset": "cube", "scale": (0.1, 0.1, 0.1)},
        "joint": {"type": "hinge", "parent": "carrier", "axis": (0, 0, 1)},
    }
    do(doors, Entities.spawn_entry, knob, HIGH)
    assert named(doors).keys() == {*before, "carrier", "knob 2"}
    do(doors, Entities.remove_added)
    assert named(doors) == before
    doors.spawn_object("cube", pose=HIGH, object_name="taught")
    doors.spawn_object("cube", position=(50.0, 0.0, 50.0), object_name="other")
    doors.start_lessons({"sequence": [{"objects": ["taught"], "duration": 0.5}]})
    with pytest.raises(InvalidState, match="taught"):
        do(doors, Entities.remove_added)
    assert {"taught", "other"} <= {*named(doors), *doors.world.waiting.names()}


def test_nothing_falls_through_the_floor_by_itself(core: SynchronousSimulation) -> None:
    """What has collision shapes falls, unless the entry says otherwise."""
    at = Pose((0.0, 0.0, 60.0))
    do(core, Entities.spawn_entry, {"name": "loose", "asset": "cube"}, HIGH)
    do(core, Entities.spawn_entry, {"name": "fixed", "asset": "cube", "static": True}, at)
    entities = named(core)
    assert (entities["loose"].static, entities["fixed"].static) == (False, True)


def test_a_region_has_what_its_shapes_touch(core: SynchronousSimulation) -> None:
    """A ball beside a turned cube reaches its nearest corner or does not."""
    turned = Pose.from_rpy_deg((0.0, 0.0, 60.0), (0.0, 0.0, 45.0))
    do(core, Entities.spawn_entry, {"name": "cube", "asset": "cube", "static": True}, turned)
    corner = np.sqrt(0.5)
    for radius, found in ((0.29, False), (0.30, True)):
        ball = Solid(np.array([(corner + 0.295, 0.0, 60.0)]), radius)
        names = {entity.name for entity in do(core, Entities.entities, ball)}
        assert ("cube" in names) == found
    point = (corner + 0.295, 0.0, 60.0)
    assert do(core, Entities.clearance_m, point) == pytest.approx(0.295)
    low, high = do(core, Entities.entity_box, named(core)["cube"].id)
    assert (low, high) == ((-0.5, -0.5, -0.5), (0.5, 0.5, 0.5))


def test_accelerations_are_those_of_the_last_step(core: SynchronousSimulation) -> None:
    """What falls gains 9.81 m/s²; nobody had listened before the first question."""
    cube = {"name": "stone", "asset": "cube", "mass": 1.0}
    do(core, Entities.spawn_entry, cube, HIGH)
    core.step(2)
    assert named(core)["stone"].linear_acceleration == (0.0, 0.0, 0.0)
    core.step(5)
    falling = named(core)
    assert falling["stone"].linear_acceleration == pytest.approx((0.0, 0.0, -9.81), abs=1e-9)
    assert falling["stone"].angular_acceleration == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)
    assert falling["floor"].linear_acceleration == (0.0, 0.0, 0.0)
