"""Robots against arithmetic: kinematics, motors, wheels, sensors, ground truth, saving, reset."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.errors import InvalidEntry, InvalidRequest, InvalidState, NameTaken, UnknownName
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.operations.entity_operations import EntityOperations
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.engine_settings import ROBOT_SUBSTEPS
from tests.support.lockstep_core import lockstep_core
from tests.support.robot_files import ARM, CART, STEERED, link

STAGE = """
version: 1
objects:
  - {name: floor, asset: cube, static: true, position: [0, 0, -0.5], scale: [20, 20, 1]}
  - {name: wall, asset: cube, static: true, position: [4, 0, 1], scale: [0.2, 8, 2]}
robots:
  - name: arm
    file: arm.urdf
    position: [0, 2, 0]
    rotation: [0, 0, 90]
    joints:
      - {name: shoulder, position: 0.4}
lights:
  - {name: sun, type: directional, direction: [-1, -1, -2], intensity: 2}
"""


@pytest.fixture
def stage(stage: Path) -> Path:
    for name, text in (("arm", ARM), ("cart", CART), ("car", STEERED)):
        stage.with_name(f"{name}.urdf").write_text(text, encoding="utf-8")
    return stage


def joints(core: SynchronousSimulation, robot: str = "") -> dict[str, float]:
    """Positions of a robot's joints."""
    return {joint.name: joint.position for joint in core.get_robot(robot).joints}


def test_links_are_instances_of_the_category_robot(core: SynchronousSimulation) -> None:
    state = core.get_robot("arm")
    listed = {one.id: one for one in core.info.instances}
    assert list(state.links) == ["base", "upper", "lower", "left", "right"]
    for name, number in state.links.items():
        assert listed[number].name == f"arm {name}"
        assert listed[number].category == "robot"
    assert listed[state.links["upper"]].parent == state.links["base"]
    assert listed[state.links["left"]].parent == state.links["lower"]
    assert core.get_robots() == ("arm",)


def test_poses_of_links_are_those_of_trigonometry(core: SynchronousSimulation) -> None:
    a, b = 0.4, -0.9
    core.put_joints({"elbow": b})
    # The arm leans along its x axis, which is the world's y axis.
    elbow = (0.0, 2.0 + 0.4 * math.sin(a), 0.2 + 0.4 * math.cos(a))
    tip = (0.0, elbow[1] + 0.5 * math.sin(a + b), elbow[2] + 0.5 * math.cos(a + b))
    np.testing.assert_allclose(core.get_object("arm lower").pose.position_m, elbow, atol=1e-12)
    np.testing.assert_allclose(core.link_pose("lower").position_m, elbow, atol=1e-12)
    np.testing.assert_allclose(core.link_pose("tip").position_m, tip, atol=1e-12)
    straight = core.link_pose("tip", {"shoulder": 0.0, "elbow": 0.0})
    np.testing.assert_allclose(straight.position_m, (0, 2, 1.1), atol=1e-12)
    with pytest.raises(UnknownName, match="link"):
        core.link_pose("hand")


def test_motors_hold_reach_and_follow(core: SynchronousSimulation) -> None:
    core.step(240)
    assert joints(core)["shoulder"] == pytest.approx(0.4, abs=1e-4)
    core.drive_joints({"shoulder": -0.5, "elbow": 1.0, "grip": 0.03})
    core.step(480)
    now = joints(core)
    assert now["shoulder"] == pytest.approx(-0.5, abs=1e-3)
    assert now["elbow"] == pytest.approx(1.0, abs=1e-3)
    assert now["grip"] == pytest.approx(0.03, abs=1e-4)
    assert now["grip 2"] == pytest.approx(now["grip"], abs=1e-5)


def test_speeds_and_efforts_have_the_limits_of_the_file(core: SynchronousSimulation) -> None:
    core.drive_joints({"elbow": 2.0})
    core.step(30)
    assert max(abs(j.velocity) for j in core.get_robot().joints) == pytest.approx(3.0, rel=0.01)
    core.drive_joints({"elbow": 0.5}, "velocity")
    core.step(24)
    (elbow,) = [j for j in core.get_robot().joints if j.name == "elbow"]
    assert elbow.velocity == pytest.approx(0.5, abs=0.01)
    assert abs(elbow.effort) <= 40.0
    for targets, mode in (({"elbow": 3.0}, "position"), ({"elbow": 50.0}, "effort")):
        with pytest.raises(InvalidRequest, match="elbow"):
            core.drive_joints(targets, mode)  # type: ignore[arg-type]  # either mode
    with pytest.raises(InvalidRequest, match="which it follows"):
        core.drive_joints({"grip 2": 0.0})


def test_an_effort_accelerates_as_newton_says(core: SynchronousSimulation) -> None:
    """A finger of 0.1 kg on a slide, which the other follows: 0.2 kg by 0.4 N."""
    core.set_gravity((0.0, 0.0, 0.0))
    core.drive_joints({"grip": 0.0}, "effort")
    core.step(2)  # the engine takes a step to wake what sleeps
    core.drive_joints({"grip": 0.4}, "effort")
    core.step(24)
    (grip,) = [j for j in core.get_robot().joints if j.name == "grip"]
    assert grip.velocity == pytest.approx(2.0 * 0.1, rel=0.02)


def test_a_pendulum_swings_as_its_equation_says(core: SynchronousSimulation, stage: Path) -> None:
    """A bar of 0.4 m from 0.8 rad for 2 s: within 0.4 % of its path, by small Runge-Kutta steps."""
    hung = f'<robot name="clock">{link("wall")}{link("bar", z=-0.2)}'
    hung += '<joint name="pin" type="continuous"><parent link="wall"/><child link="bar"/>'
    path = stage.with_name("clock.urdf")
    path.write_text(hung + '<axis xyz="0 1 0"/></joint></robot>', encoding="utf-8")
    name = core.spawn_robot(str(path), (-3, 0, 3), settings={"self_collision": False})
    core.put_joints({"pin": 0.8}, robot=name)
    core.drive_joints({"pin": 0.0}, "off", robot=name)
    core.step(2)  # the engine takes a step to wake what sleeps
    (pin,) = core.get_robot(name).joints
    inertia = (0.1**2 + 0.4**2) / 12.0 + 0.2**2
    state, step = np.array([pin.position, pin.velocity]), 1.0 / 2400.0

    def rate(state: np.ndarray) -> np.ndarray:
        return np.array([state[1], -9.81 * 0.2 / inertia * math.sin(state[0])])

    worst = 0.0
    for _ in range(240):
        core.step(2)
        for _ in range(20):
            one = rate(state)
            two = rate(state + 0.5 * step * one)
            three = rate(state + 0.5 * step * two)
            four = rate(state + step * three)
            state = state + step / 6.0 * (one + 2.0 * two + 2.0 * three + four)
        worst = max(worst, abs(joints(core, name)["pin"] - state[0]))
    assert worst < 0.004 * 1.6


def test_inverse_kinematics_reaches_what_can_be_reached(core: SynchronousSimulation) -> None:
    goal = core.link_pose("tip", {"shoulder": 0.7, "elbow": 0.6})
    found = core.reach_pose("tip", goal)
    there = core.link_pose("tip", found)
    np.testing.assert_allclose(there.position_m, goal.position_m, atol=1e-4)
    with pytest.raises(InvalidRequest, match="reaches"):
        core.reach_pose("tip", Pose((3.0, 0.0, 0.0)))


def test_a_cart_rolls_and_turns_as_it_is_told(core: SynchronousSimulation, stage: Path) -> None:
    core.spawn_robot(str(stage.parent / "cart.urdf"), (0, -1, 0), mount="differential")
    core.step(120)
    began = core.get_robot("cart").pose.position_m
    core.drive_robot(0.5, robot="cart", seconds=10.0)
    core.step(480)
    state = core.get_robot("cart")
    assert state.linear_m_s[0] == pytest.approx(0.5, abs=1e-6)
    # It gains speed at 2 m/s²: a quarter of a second, in which it goes half as far.
    assert state.pose.position_m[0] - began[0] == pytest.approx(0.5 * (2.0 - 0.125), abs=0.01)
    wheels = [joint for joint in state.joints if joint.name.endswith("joint")]
    for wheel in wheels:
        assert wheel.velocity == pytest.approx(5.0, rel=1e-6)
    core.drive_robot(0.0, 0.8, robot="cart", seconds=10.0)
    core.step(240)
    turning = core.get_robot("cart")
    assert turning.angular_rad_s[2] == pytest.approx(0.8, abs=1e-6)
    by_name = {joint.name: joint.velocity for joint in turning.joints}
    assert by_name["front_left joint"] == pytest.approx(-0.8 * 0.2 / 0.1, rel=1e-6)
    assert by_name["front_right joint"] == pytest.approx(0.8 * 0.2 / 0.1, rel=1e-6)
    core.drive_robot(robot="cart")
    core.step(240)
    assert np.abs(core.get_robot("cart").linear_m_s).max() < 0.01


def test_walls_stop_a_cart(core: SynchronousSimulation, stage: Path) -> None:
    core.spawn_robot(str(stage.parent / "cart.urdf"), (3, -1, 0), mount="differential")
    core.drive_robot(1.0, robot="cart", seconds=10.0)
    core.step(720)
    assert core.get_robot("cart").pose.position_m[0] < 3.9 - 0.24
    with pytest.raises(InvalidRequest, match="mounted on wheels"):
        core.drive_robot(1.0, robot="arm")


def test_mecanum_wheels_go_sideways(core: SynchronousSimulation, stage: Path) -> None:
    core.spawn_robot(str(stage.parent / "cart.urdf"), (0, -3, 0), mount="mecanum")
    core.drive_robot(0.0, 0.0, 0.4, robot="cart", seconds=10.0)
    core.step(360)
    state = core.get_robot("cart")
    assert state.linear_m_s[1] == pytest.approx(0.4, abs=1e-6)
    by_name = {joint.name: joint.velocity for joint in state.joints}
    assert by_name["front_left joint"] == pytest.approx(-4.0, rel=1e-6)
    assert by_name["front_right joint"] == pytest.approx(4.0, rel=1e-6)
    assert by_name["rear_left joint"] == pytest.approx(4.0, rel=1e-6)


def test_a_car_steers_about_its_rear_axle(core: SynchronousSimulation, stage: Path) -> None:
    core.spawn_robot(str(stage.parent / "car.urdf"), (0, -3, 0), mount="ackermann")
    core.drive_robot(0.5, 0.4, robot="car", seconds=10.0)
    core.step(240)
    state = core.get_robot("car")
    assert state.command[2] == pytest.approx(0.4)
    angles = {j.name: j.position for j in state.joints if "steering" in j.name}
    radius = 0.5 / 0.4
    left, right = math.atan2(0.4, radius - 0.2), math.atan2(0.4, radius + 0.2)
    assert angles["front_left steering"] == pytest.approx(left, abs=0.03)
    assert angles["front_right steering"] == pytest.approx(right, abs=0.03)
    core.drive_robot(0.0, 1.0, robot="car")
    assert core.get_robot("car").command == (0.0, 0.0, 0.0)  # it cannot turn on the spot


def test_a_reset_gives_the_bytes_of_the_start(core: SynchronousSimulation) -> None:
    first = core.world.snapshot().world_from_body.tobytes()
    core.drive_joints({"shoulder": -0.5, "elbow": 1.0})
    core.step(100)
    once = core.world.snapshot().world_from_body.tobytes()
    assert once != first
    core.reset()
    assert core.world.snapshot().world_from_body.tobytes() == first
    core.drive_joints({"shoulder": -0.5, "elbow": 1.0})
    core.step(100)
    assert core.world.snapshot().world_from_body.tobytes() == once


def test_a_saved_scene_has_its_robots_as_they_are(core: SynchronousSimulation, stage: Path) -> None:
    core.spawn_robot(str(stage.parent / "cart.urdf"), (0, -1, 0), mount="differential")
    core.drive_joints({"elbow": 0.8, "grip": 0.02})
    core.step(400)
    text = core.scene_text()
    path = stage.with_name("saved.yaml")
    path.write_text(text.replace("name: stage", "name: saved"), encoding="utf-8")
    again = lockstep_core(path)
    try:
        assert again.get_robots() == ("arm", "cart")
        assert joints(again, "arm") == pytest.approx(joints(core, "arm"), abs=1e-6)
        now = core.get_robot("cart").pose.position_m
        assert again.get_robot("cart").pose.position_m == pytest.approx(now, abs=1e-5)
        again.step(240)
        assert joints(again, "arm") == pytest.approx(joints(core, "arm"), abs=1e-4)
        assert "arm upper" not in text
    finally:
        again.close()


def test_flow_of_each_link_is_that_of_its_rigid_motion(stage: Path) -> None:
    """From poses before and after, by the pin-hole alone."""
    core = lockstep_core(stage, renderer=NativeRenderer())
    pose = Pose.from_rpy_deg((1.6, 2.0, 0.7), (0.0, 5.0, 180.0))
    spec = AgentSpec(name="eye", pose=pose, following=False)
    core.register_agent(spec)
    core.drive_joints({"shoulder": -0.4, "elbow": 0.9})
    core.step(20)
    views = ("flow", "depth", "instance")
    core.capture(views, agent="eye")
    before = {n: core.get_object(n).pose.matrix() for n in core.get_robot().links.values()}
    core.step(8)
    frame = core.capture(views, agent="eye")
    camera = frame.camera
    intrinsics = spec.intrinsics
    f, cx, cy = intrinsics.K[0, 0], intrinsics.K[0, 2], intrinsics.K[1, 2]
    seen = 0
    for number, then in before.items():
        v, u = np.nonzero(frame["instance"] == number)
        if len(v) < 50:
            continue
        seen += 1
        z = frame["depth"][v, u].astype(np.float64)
        optical = np.stack([(u - cx) / f * z, (v - cy) / f * z, z, np.ones_like(z)], axis=1)
        now = core.get_object(number).pose.matrix()
        world_from_optical = camera.world_from_camera
        earlier = optical @ (np.linalg.inv(world_from_optical) @ then
                             @ np.linalg.inv(now) @ world_from_optical).T  # fmt: skip
        x, y, depth, _ = earlier.T
        moved = np.stack([u - (f * x / depth + cx), v - (f * y / depth + cy)], axis=1)
        np.testing.assert_allclose(frame["flow"][v, u] * (8 / 240), moved, atol=2e-4)
    assert seen >= 3
    core.close()


def test_a_camera_in_the_hand_goes_where_the_hand_goes(core: SynchronousSimulation) -> None:
    held = Pose.from_rpy_deg((0.05, 0.0, 0.1), (0.0, -90.0, 0.0))
    core.register_agent(AgentSpec(name="hand", carrier="arm lower", pose=held))
    core.register_agent(AgentSpec(name="fingertip", carrier="arm tip"))
    core.drive_joints({"elbow": 1.0})
    core.step(200)
    expected = core.get_object("arm lower").pose.matrix() @ held.matrix()
    there = core.get_agent_pose(agent="hand").pose
    np.testing.assert_allclose(there.matrix(), expected, atol=1e-12)
    tip = core.link_pose("tip").position_m
    np.testing.assert_allclose(
        core.get_agent_pose(agent="fingertip").pose.position_m, tip, atol=1e-12
    )
    assert not core.get_agent_pose(agent="hand").following
    with pytest.raises(InvalidState, match="goes where"):
        core.set_position((0, 0, 0), agent="hand")
    with pytest.raises(UnknownName):
        core.register_agent(AgentSpec(name="lost", carrier="nobody"))


def test_a_scanner_measures_the_wall_and_not_itself(
    core: SynchronousSimulation, stage: Path
) -> None:
    sensors = [
        {"name": "scan", "type": "lidar", "position": [0, 0, 0.15], "rays": 5, "field": 60},
        {"name": "imu", "type": "imu", "position": [0.2, 0, 0]},
    ]
    file = str(stage.parent / "cart.urdf")
    core.spawn_robot(file, (0, -1, 0), mount="differential", settings={"sensors": sensors})
    core.step(240)
    scan = core.get_scan(robot="cart")
    x = scan.pose.position_m[0]
    angles = np.radians([-30, -15, 0, 15, 30])
    np.testing.assert_allclose(scan.ranges_m, (3.9 - x) / np.cos(angles), rtol=1e-4)
    assert scan.points_m()[:, 0] == pytest.approx([3.9 - x] * 5, rel=1e-4)
    rest = core.get_inertial(robot="cart")
    assert rest.acceleration_m_s2 == pytest.approx((0.0, 0.0, 9.81), abs=0.01)
    core.drive_robot(0.5, robot="cart", seconds=5.0)
    core.step(10)
    assert core.get_inertial(robot="cart").acceleration_m_s2[0] == pytest.approx(2.0, abs=0.01)
    with pytest.raises(UnknownName, match="lidar"):
        core.get_scan("imu", robot="cart")


def test_links_collide_with_one_another_unless_they_are_told_not_to(
    stage: Path,
) -> None:
    """The fingers meet the base where the arm folds."""
    folding = ARM.replace('lower="-2" upper="2" effort="40"', 'lower="-3" upper="3" effort="40"')
    stage.with_name("arm.urdf").write_text(folding, encoding="utf-8")
    text = stage.read_text(encoding="utf-8")
    ends = []
    for number, colliding in enumerate(("true", "false")):
        robot = text.replace("file: arm.urdf", f"file: arm.urdf\n    self_collision: {colliding}")
        path = stage.with_name(f"own_{number}.yaml")
        path.write_text(robot, encoding="utf-8")
        core = lockstep_core(path)
        try:
            core.put_joints({"shoulder": 0.0, "elbow": 0.0})
            core.drive_joints({"elbow": 2.95})
            core.step(480)
            ends.append(joints(core)["elbow"])
        finally:
            core.close()
    colliding_end, free_end = ends
    assert free_end == pytest.approx(2.95, abs=1e-2)
    assert colliding_end < free_end - 0.05


def test_robots_come_and_go_as_a_whole(core: SynchronousSimulation, stage: Path) -> None:
    file = str(stage.parent / "arm.urdf")
    name = core.spawn_robot(
        file, (2, 2, 0), settings={"joints": [{"name": "elbow", "position": 1}]}
    )
    assert name == "arm_2"
    assert joints(core, name)["elbow"] == 1.0
    with pytest.raises(NameTaken):
        core.spawn_robot(file, name="arm")
    with pytest.raises(UnknownName, match="joint"):
        core.spawn_robot(file, settings={"joints": [{"name": "neck", "position": 0}]})
    with pytest.raises(InvalidEntry, match="mount"):
        core.spawn_robot(file, mount="hovering")
    with pytest.raises(InvalidRequest, match="wheels"):
        core.spawn_robot(file, mount="differential")
    assert core.get_robots() == ("arm", "arm_2")
    with pytest.raises(InvalidRequest, match="as a whole"):
        core.despawn_object("arm_2 right")
    core.despawn_robot("arm_2")
    assert core.get_robots() == ("arm",)
    assert not any(one.name.startswith("arm_2") for one in core.info.instances)
    core.step(10)
    assert core.spawn_robot(file, (2, 2, 0)) == "arm_2"


def test_a_free_object_carries_others_on_joints(core: SynchronousSimulation) -> None:
    """A robot without motors, of one link, falls as any object does."""
    file = Path(core.library.path("stage")).with_name("stone.urdf")
    file.write_text(f'<robot name="stone">{link("stone")}</robot>', encoding="utf-8")
    core.spawn_robot(str(file), (-3, 0, 5), mount="free")
    core.step(60)
    z = core.get_robot("stone").pose.position_m[2]
    # Velocities come before places in each part of a step: g n (n + 1) / 2 of them.
    parts = 60 * ROBOT_SUBSTEPS
    assert z == pytest.approx(5 - 9.81 * parts * (parts + 1) / 2 * (0.25 / parts) ** 2, abs=1e-6)


def test_what_is_put_back_stands_as_at_the_start(stage: Path) -> None:
    """The state alone: time goes on, and motors hold what they held."""
    text = stage.read_text(encoding="utf-8").replace(
        "file: arm.urdf", "file: arm.urdf\n    mount: free"
    )
    stage.write_text(text, encoding="utf-8")
    core = lockstep_core(stage)
    began = {name: core.get_object(name).pose for name in ("arm base", "arm lower")}
    core.drive_joints({"shoulder": -0.5, "elbow": 1.0})
    core.step(200)
    EntityOperations.put_entities_back.submit_to(core).result()
    for name, pose in began.items():
        np.testing.assert_allclose(core.get_object(name).pose.matrix(), pose.matrix(), atol=1e-12)
    core.step(5)
    assert joints(core)["shoulder"] == pytest.approx(0.4, abs=0.05)
    with pytest.raises(InvalidRequest, match="drive_joints"):
        core.set_joint_position("arm upper", 0.1)
    core.close()


def test_links_of_branches_are_those_that_touch(core: SynchronousSimulation, stage: Path) -> None:
    """The engine numbers links branch by branch; contacts name the feet of both legs."""
    text = '<robot name="legs">' + link("body", 5.0, "0.4 0.4 0.1", 0.6)
    for side, x in (("left", 0.15), ("right", -0.15)):
        for part, z in (("thigh", 0.5), ("foot", -0.25)):
            text += link(f"{side} {part}", 1.0, "0.05 0.05 0.25", -0.125)
            above = "body" if part == "thigh" else f"{side} thigh"
            place = f"{x if part == 'thigh' else 0} 0 {z}"
            text += f'<joint name="{side} {part}" type="revolute"><parent link="{above}"/>'
            text += f'<child link="{side} {part}"/><origin xyz="{place}"/><axis xyz="0 1 0"/>'
            text += '<limit lower="-1" upper="1" effort="100" velocity="5"/></joint>'
    path = stage.with_name("legs.urdf")
    path.write_text(text + "</robot>", encoding="utf-8")
    core.spawn_robot(str(path), (-3, -3, 0.01), mount="free")
    core.step(60)
    core.contacts()
    core.step(1)
    links = core.get_robot("legs").links
    touching = {c.second for c in core.contacts() if c.second in links.values()}
    assert touching == {links["left foot"], links["right foot"]}


def test_links_are_painted_and_moved_by_behaviours_as_objects_are(
    core: SynchronousSimulation,
) -> None:
    """Motors go on holding; whoever draws recordings finds the links' models by name."""
    core.change_object("arm upper", colour="#ff0000")
    core.step(60)
    assert joints(core)["shoulder"] == pytest.approx(0.4, abs=1e-3)
    core.add_behaviour("arm lower", {"type": "open_and_close"})
    core.step(100)
    assert joints(core)["elbow"] > 0.3
    core.remove_behaviours("arm lower")
    core.step(300)
    assert joints(core)["elbow"] == pytest.approx(0.0, abs=1e-2)
    asset = next(one.asset for one in core.info.instances if one.name == "arm lower")
    assert core.library.assets.drawn_model(asset).triangle_count == 12


def test_behaviours_drive_robots(core: SynchronousSimulation, stage: Path) -> None:
    """Waypoints lead a cart, whose wheels roll; a machine flies; forces push what is free."""
    core.spawn_robot(str(stage.parent / "cart.urdf"), (0, -3, 0), mount="differential")
    core.step(10)
    way = [{"position": [0, -3, 0.001]}, {"position": [1, -3, 0.001]}]
    track = {"type": "linear_waypoints", "total_time": 2.0, "loop": False, "waypoints": way}
    core.add_behaviour("cart chassis", track)
    core.step(240)
    state = core.get_robot("cart")
    assert state.pose.position_m[0] == pytest.approx(0.5, abs=0.02)
    assert state.linear_m_s[0] == pytest.approx(0.5, abs=0.02)
    for wheel in state.joints:
        assert wheel.velocity == pytest.approx(5.0, rel=0.05)
    path = stage.with_name("flier.urdf")
    path.write_text(f'<robot name="flier">{link("body", z=0.0)}</robot>', encoding="utf-8")
    core.spawn_robot(str(path), (-3, -3, 2), mount="free")
    core.apply_wrench("flier body", (1.0, 0.0, 9.81), duration_s=10.0)
    core.step(242)  # it acts from the step after the next on
    state = core.get_robot("flier")
    assert state.linear_m_s == pytest.approx((1.0, 0.0, 0.0), abs=0.06)


@pytest.mark.parametrize("mount", ["differential", "mecanum", "ackermann"])
def test_a_mover_leads_a_robot_along_its_way(stage: Path, mount: str) -> None:
    """At 0.3 m/s along y, the robot behind it; what it is told to do comes first."""
    text = stage.read_text(encoding="utf-8")
    text += """
movers:
  - name: guide
    total_time: 20
    loop: false
    waypoints:
      - {position: [0, -6, 0], rotation: [0, 0, 90]}
      - {position: [0, 0, 0], rotation: [0, 0, 90]}
"""
    stage.write_text(text, encoding="utf-8")
    core = lockstep_core(stage)
    file = str(stage.parent / ("car.urdf" if mount == "ackermann" else "cart.urdf"))
    led = {"wheels": {"mover": "guide"}}
    with pytest.raises(UnknownName, match="mover"):
        core.spawn_robot(file, mount=mount, settings={"wheels": {"mover": "nobody"}})
    name = core.spawn_robot(file, (0, -7, 0), (0, 0, 90), mount=mount, settings=led)
    core.step(240 * 12)
    state, guide = core.get_robot(name), core.get_mover_pose("guide")
    x, y, _ = state.pose.position_m
    assert y == pytest.approx(guide.position_m[1] - 0.3 / 2.0, abs=0.05)
    assert abs(x) < 0.05
    assert math.hypot(*state.linear_m_s[:2]) == pytest.approx(0.3, abs=0.02)
    core.drive_robot(-0.4, robot=name, seconds=1.0)
    core.step(200)
    assert core.get_robot(name).linear_m_s[0] == pytest.approx(-0.4, abs=0.01)
    core.step(240 * 12)
    assert core.get_robot(name).pose.position_m[1] == pytest.approx(0.0, abs=0.06)
    assert abs(core.get_robot(name).linear_m_s[0]) < 0.01
    core.close()


def test_a_robot_comes_again_under_its_old_name_after_a_reset(
    core: SynchronousSimulation, stage: Path
) -> None:
    file = str(stage.parent / "arm.urdf")
    for _ in range(2):
        assert core.spawn_robot(file, (2, 2, 0), name="second") == "second"
        core.step(10)
        core.reset()
        assert core.get_robots() == ("arm",)
