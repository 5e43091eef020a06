"""MJCF files against MuJoCo itself, and the robots of pybullet_data."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

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


def test_worlds_of_several_and_ball_joints_are_refused(tmp_path: Path) -> None:
    for text, why in (
        ('<mujoco><worldbody><body/><body/></worldbody></mujoco>', "2 bodies"),
        (ROBOT.format(free='<joint type="ball"/>'), "ball joints"),
    ):  # fmt: skip
        path = tmp_path / "robot.xml"
        path.write_text(text, encoding="utf-8")
        with pytest.raises(AssetError, match=why):
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
