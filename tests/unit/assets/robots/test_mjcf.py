"""MJCF files against MuJoCo itself, and the robots of pybullet_data."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from sailenv_ros.assets.robots import RobotStore, robot_path
from sailenv_ros.errors import AssetError
from sailenv_ros.world.robot_kinematics import all_positions, base_from_frame

ROBOT = """
<mujoco model="leg">
  <compiler angle="radian"/>
  <worldbody>
    <geom type="plane" size="5 5 1"/>
    <body name="hip" pos="0.1 0.2 1" euler="0.1 0.2 0.3">
      {free}
      <geom type="box" size="0.1 0.1 0.05" mass="3" rgba="1 0 0 1"/>
      <body name="thigh" pos="0 0.1 0" euler="0 0.3 0">
        <joint name="swing" axis="0 1 0" pos="0 0 0.05" range="-1 1"/>
        <joint name="twist" axis="1 0 1" pos="0.02 0 0" range="-0.5 0.5"/>
        <geom type="capsule" fromto="0 0 0 0 0 -0.4" size="0.03" mass="1"/>
        <body name="shin" pos="0 0 -0.4">
          <joint name="slide" type="slide" axis="0 0 -1" range="0 0.2"/>
          <geom type="cylinder" size="0.02 0.2" pos="0 0 -0.2" mass="0.5"/>
        </body>
      </body>
      <body name="tail" pos="-0.1 0 0">
        <joint name="wag" axis="0 0 1" range="-1 1"/>
        <geom type="ellipsoid" size="0.1 0.02 0.02" mass="0.2"/>
      </body>
    </body>
  </worldbody>
  <equality><joint joint1="wag" joint2="swing" polycoef="0.1 0.5 0 0 0"/></equality>
</mujoco>
"""


def test_links_stand_where_mujoco_has_them(tmp_path: Path) -> None:
    """Several joints of one body, joints away from its origin, one that follows another."""
    path = tmp_path / "leg.xml"
    path.write_text(ROBOT.format(free="<freejoint/>"), encoding="utf-8")
    robot = RobotStore().read(path)
    assert robot.mount == "free"
    assert [link.joint.name for link in robot.moving] == ["swing", "wag", "twist", "slide"]
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    positions = all_positions(robot, {"swing": 0.7, "twist": -0.4, "slide": 0.15})
    assert positions["wag"] == pytest.approx(0.1 + 0.5 * 0.7)
    for name, position in positions.items():
        data.qpos[model.joint(name).qposadr[0]] = position
    mujoco.mj_kinematics(model, data)
    base = _pose(data, model.body("hip").id)
    for name in ("hip", "thigh", "shin", "tail"):
        theirs = np.linalg.inv(base) @ _pose(data, model.body(name).id)
        np.testing.assert_allclose(base_from_frame(robot, name, positions), theirs, atol=1e-9)
    masses = {link.name: link.asset.mass_kg for link in robot.links}
    assert masses["hip"] == 3.0
    assert masses["shin"] == 0.5


def test_a_ball_joint_is_three_hinges(tmp_path: Path) -> None:
    """About x, y and z: the same turn as MuJoCo's quaternion, also of a keyframe."""
    path = tmp_path / "leg.xml"
    turn = Rotation.from_euler("XYZ", (0.4, -0.7, 1.1))
    w, x, y, z = turn.as_quat()[[3, 0, 1, 2]]
    text = ROBOT.format(free='<joint name="neck" type="ball" pos="0.01 0.02 0.03"/>')
    key = f'<keyframe><key qpos="{w} {x} {y} {z} 0.1 0.1 0.1 0.15"/></keyframe></mujoco>'
    path.write_text(text.replace("</mujoco>", key), encoding="utf-8")
    robot = RobotStore().read(path)
    assert robot.mount == "fixed"
    assert [link.joint.name for link in robot.moving][:3] == ["neck x", "neck y", "neck z"]
    assert [robot.start[f"neck {axis}"] for axis in "xyz"] == pytest.approx([0.4, -0.7, 1.1])
    assert robot.moving[1].joint.limits == (-1.5, 1.5)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_kinematics(model, data)
    positions = all_positions(robot, robot.start)
    for name in ("hip", "thigh", "shin"):
        ours = base_from_frame(robot, name, positions)
        np.testing.assert_allclose(ours, _pose(data, model.body(name).id), atol=1e-9)


def test_several_bodies_on_the_world_are_one_robot(tmp_path: Path) -> None:
    """Its first link is the world; one of several that moves freely is refused, with its place."""
    arm = '<body name="{0}" pos="{1} 0 0">{2}<geom name="{0}" size="0.1" mass="1"/></body>\n'
    hinge = '<joint name="{}" axis="0 1 0"/>'
    begin = '<mujoco><compiler angle="radian"/><worldbody>\n'
    path = tmp_path / "arms.xml"
    arms = arm.format("left", 1, hinge.format("l")) + arm.format("right", -1, hinge.format("r"))
    path.write_text(f"{begin}{arms}</worldbody></mujoco>", encoding="utf-8")
    robot = RobotStore().read(path)
    assert [link.name for link in robot.links] == ["world", "left", "right"]
    assert {link.parent for link in robot.moving} == {"world"}
    assert robot.moving[1].joint.parent_from_rest.position_m == (-1.0, 0.0, 0.0)
    free = arm.format("left", 1, "") + arm.format("cup", 0, "<freejoint/>")
    path.write_text(f"{begin}{free}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(AssetError, match=r"arms.xml:3:1.*2 bodies.*moves freely"):
        RobotStore().read(path)
    path.write_text(f"{begin}</worldbody></mujoco>", encoding="utf-8")
    with pytest.raises(AssetError, match="no body"):
        RobotStore().read(path)


@pytest.mark.parametrize(
    ("file", "links", "moving"),
    [
        ("franka_panda/panda.urdf", 11, 9),
        ("kuka_iiwa/model.urdf", 8, 7),
        ("xarm/xarm6_robot.urdf", 7, 6),
        ("husky/husky.urdf", 9, 4),
        ("r2d2.urdf", 16, 8),
    ],
)
def test_robots_of_pybullet_data_are_read(file: str, links: int, moving: int) -> None:
    robot = RobotStore().read(robot_path(f"pybullet_data:{file}"))
    assert (len(robot.links), len(robot.moving)) == (links, moving)
    assert all(link.asset.mass_kg > 0.0 for link in robot.links)
    colours = {part.material.base_colour for link in robot.links for part in link.asset.model.parts}
    assert len(colours) > 1 or any(
        part.material.base_colour_texture is not None
        for link in robot.links
        for part in link.asset.model.parts
    )


def _pose(data: mujoco.MjData, body: int) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = data.xmat[body].reshape(3, 3), data.xpos[body]
    return matrix
