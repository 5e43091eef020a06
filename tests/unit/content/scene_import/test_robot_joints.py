"""Joints of URDF and MJCF: where MuJoCo puts links, ours are; malformed limits are refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
import yaml

from sailenv_content.scene_import.importers import import_scene
from sailenv_ros import Simulation
from sailenv_ros.errors import AssetError
from sailenv_ros.types.geometry import Pose

STEP_S = 1.0 / 240.0

WARDROBE = """
<mujoco model="wardrobe">
  <compiler angle="radian"/>
  <option timestep="0.004166666666666667" integrator="implicitfast"/>
  <worldbody>
    <geom name="floor" type="plane" size="3 3 0.1" pos="0 0 -0.5"/>
    <body name="body" pos="1 0.5 0.4" euler="0 0 0.7">
      <geom type="box" size="0.2 0.4 0.4"/>
      <body name="wardrobe door" pos="-0.25 0.4 0" euler="0.1 0 0.2">
        <joint name="hinge" axis="0 0.1 1" pos="0.01 0.02 0.3" range="-1.9 0.2" damping="0.8"
               frictionloss="0.4"/>
        <geom type="box" pos="0 -0.4 0" size="0.015 0.39 0.38" mass="8"/>
        <body name="handle" pos="-0.03 -0.7 0.1" euler="0 0.3 0">
          <geom type="box" size="0.01 0.01 0.08" mass="0.2"/>
          <body name="latch" pos="-0.02 0 0">
            <joint name="turn" axis="1 0 0" range="-0.5 0.5" ref="0.1" damping="0.01"/>
            <geom type="box" pos="0 0 0.05" size="0.005 0.005 0.05" mass="0.05"/>
          </body>
        </body>
      </body>
      <body name="tray" pos="-0.1 0 -0.2">
        <joint name="rail" type="slide" axis="-1 0 0.2" range="0 0.35" frictionloss="2"/>
        <geom type="box" size="0.2 0.3 0.02" mass="1.5"/>
      </body>
      <body name="lamp" pos="0 0 0.6">
        <joint name="socket" type="ball"/>
        <geom type="sphere" size="0.05" mass="0.1"/>
      </body>
    </body>
  </worldbody>
</mujoco>
"""

ARM = """
<robot name="arm">
  <link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  {links}
  <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/>
    <origin xyz="0 0 0.1" rpy="0.1 0.2 0.3"/><axis xyz="0 0 1"/></joint>
  <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/>
    <origin xyz="0.3 0 0.05" rpy="1.5707963 0 0.4"/><axis xyz="0 1 0"/>
    <limit lower="-2.0" upper="1.5" effort="30" velocity="2"/>
    <dynamics damping="0.2" friction="3.0"/></joint>
  <joint name="finger" type="prismatic"><parent link="fore"/><child link="tip"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 0.6 0.8"/>
    <limit lower="0" upper="0.08" effort="10" velocity="1"/></joint>
  <joint name="glue" type="fixed"><parent link="tip"/><child link="nail"/>
    <origin xyz="0 0 0.05"/></joint>
</robot>
"""
LINK = """<link name="{name}"><inertial><mass value="1"/><origin xyz="0.15 0 0"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><origin xyz="0.15 0 0"/><geometry><box size="0.3 0.04 0.04"/></geometry></visual>
</link>"""


def arm() -> str:
    """The arm with its links."""
    return ARM.format(links="".join(LINK.format(name=n) for n in ("upper", "fore", "tip", "nail")))


def imported(text: str, name: str, tmp_path: Path, packs: Path) -> tuple[Path, tuple[str, ...]]:
    """Import a file; return the scene's path and the notes."""
    (tmp_path / name).write_text(text, encoding="utf-8")
    report = import_scene(tmp_path / name, tmp_path / "scene.yaml", packs)
    return tmp_path / "scene.yaml", report.notes


def assert_poses_agree(
    simulation: Simulation, model: Any, data: Any, bodies: dict[str, str]
) -> None:
    """Each link's pose is MuJoCo's to 1e-6."""
    for ours, theirs in bodies.items():
        pose = simulation.get_object(ours).pose
        body = data.body(theirs)
        np.testing.assert_allclose(pose.position_m, body.xpos, atol=1e-6)
        w, x, y, z = body.xquat
        turn = Pose((0, 0, 0), (x, y, z, w)).matrix()[:3, :3]
        np.testing.assert_allclose(pose.matrix()[:3, :3], turn, atol=1e-6)


def test_links_of_mjcf_are_where_mujoco_has_them(tmp_path: Path, packs: Path) -> None:
    """At the start and at 20 random positions of three joints; what is fixed is said to be."""
    scene, notes = imported(WARDROBE, "wardrobe.xml", tmp_path, packs)
    assert notes == (
        "1 joint is fixed where the file begins (a ball joint): socket",
        "1 joint has no friction in the file and gets enough to hold its weight: turn",
    )
    model = mujoco.MjModel.from_xml_string(WARDROBE)
    data = mujoco.MjData(model)
    names = {n: n for n in ("body", "wardrobe door", "handle", "latch", "tray", "lamp")}
    joints = {"wardrobe door": ("hinge", 0.0), "latch": ("turn", 0.1), "tray": ("rail", 0.0)}
    rng = np.random.default_rng(4)
    with Simulation(scene, mode="lockstep") as simulation:
        found = {joint.name: joint for joint in simulation.get_joints()}
        assert set(found) == set(joints)
        assert (found["latch"].low, found["latch"].high) == pytest.approx((-0.6, 0.4))
        parents = {i.name: i.parent for i in simulation.info.instances}
        ids = {i.name: i.id for i in simulation.info.instances}
        assert parents["latch"] == ids["handle"]
        assert parents["handle"] == ids["wardrobe door"]
        categories = {i.name: i.category for i in simulation.info.instances}
        assert categories["wardrobe door"] in ("door", "cabinet", "wardrobe")
        mujoco.mj_kinematics(model, data)
        assert_poses_agree(simulation, model, data, names)
        for _ in range(20):
            for name, (joint, reference) in joints.items():
                at = rng.uniform(found[name].low, found[name].high)
                simulation.set_joint_position(name, at)
                data.joint(joint).qpos = at + reference
            mujoco.mj_kinematics(model, data)
            assert_poses_agree(simulation, model, data, names)


def test_links_of_urdf_are_where_mujoco_has_them(tmp_path: Path, packs: Path) -> None:
    """Continuous, revolute, prismatic and fixed; limits, damping and friction of the file."""
    scene, notes = imported(arm(), "arm.urdf", tmp_path, packs)
    assert "shoulder, finger" in notes[-1]
    spec = mujoco.MjSpec.from_string(arm())
    spec.compiler.fusestatic = False
    model = spec.compile()
    data = mujoco.MjData(model)
    rng = np.random.default_rng(5)
    entries = {e["name"]: e for e in yaml.safe_load(scene.read_text("utf-8"))["objects"]}
    elbow = entries["fore"]["joint"]
    assert (elbow["limits"], elbow["damping"], elbow["friction"]) == ([-2.0, 1.5], 0.2, 3.0)
    with Simulation(scene, mode="lockstep") as simulation:
        joints = {"upper": "shoulder", "fore": "elbow", "tip": "finger"}
        found = {joint.name: joint for joint in simulation.get_joints()}
        assert set(found) == set(joints)
        assert found["upper"].high == np.inf
        for _ in range(20):
            for name, joint in joints.items():
                low, high = max(found[name].low, -3.0), min(found[name].high, 3.0)
                at = rng.uniform(low, high)
                simulation.set_joint_position(name, at)
                data.joint(joint).qpos = at
            mujoco.mj_kinematics(model, data)
            assert_poses_agree(simulation, model, data, {n: n for n in (*joints, "nail")})
        simulation.reset()
        simulation.step(240)
        held = [joint.position for joint in simulation.get_joints()]
        np.testing.assert_allclose(held, 0.0, atol=1e-6)


def test_a_pushed_door_moves_as_mujocos_does(tmp_path: Path, packs: Path) -> None:
    """20 N for 0.2 s across the leaf: the same way within 0.5 %, until friction has stopped it."""
    door = """<mujoco model="door"><compiler angle="radian"/>
      <option timestep="0.004166666666666667" gravity="0 0 -9.81" integrator="implicitfast"/>
      <worldbody><body name="leaf" pos="0 0 1"><joint name="hinge" axis="0 0 1" range="-0.1 3"
        damping="1.5" frictionloss="2"/>
        <geom type="box" pos="0.4 0 0" size="0.4 0.02 1" mass="20"/></body></worldbody></mujoco>"""
    scene, _ = imported(door, "door.xml", tmp_path, packs)
    model = mujoco.MjModel.from_xml_string(door)
    data = mujoco.MjData(model)
    with Simulation(scene, mode="lockstep") as simulation:
        simulation.apply_wrench("leaf", force_n=(0, 20, 0), duration_s=0.2)
        simulation.step(1)
        for steps in (48, 100, 300):
            simulation.step(steps)
            for _ in range(steps):
                data.xfrc_applied[1] = (0, 20, 0, 0, 0, 0) if data.time < 0.2 - 1e-9 else 0
                mujoco.mj_step(model, data)
            (joint,) = simulation.get_joints()
            assert joint.position == pytest.approx(float(data.qpos[0]), rel=0.005)
        assert joint.position > 0.05
        assert abs(joint.velocity) < 1e-3 > abs(float(data.qvel[0]))


@pytest.mark.parametrize(
    ("name", "text", "sentence"),
    [
        ("a.urdf", arm().replace('lower="-2.0"', 'lower="2.0"'), "the lower one first"),
        ("a.urdf", arm().replace('lower="-2.0"', 'lower="nan"'), "two numbers"),
        ("a.urdf", arm().replace('upper="1.5"', 'upper="1e300"'), "two numbers"),
        ("a.urdf", arm().replace('<limit lower="0"', '<x lower="0"'), "has no <limit>"),
        ("a.xml", WARDROBE.replace("-1.9 0.2", "0.2 -1.9"), "the lower one first"),
        ("a.xml", WARDROBE.replace("-1.9 0.2", "-1e9 0.2"), "limits of joint 'hinge'"),
    ],
)
def test_malformed_limits_are_refused(
    tmp_path: Path, packs: Path, name: str, text: str, sentence: str
) -> None:
    """With a sentence; neither a scene nor a pack is left."""
    with pytest.raises(AssetError, match=sentence):
        imported(text, name, tmp_path, packs)
    assert not (tmp_path / "scene.yaml").exists()
    assert not packs.exists()
