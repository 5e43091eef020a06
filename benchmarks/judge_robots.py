"""Judges robots by MuJoCo: places of links, and how an arm swings; and by OpenCV the hand camera.

    python -m venv judge && judge/bin/pip install numpy 'opencv-python-headless<5'
    python benchmarks/judge_robots.py --opencv judge/bin/python

MuJoCo reads each URDF itself, without its meshes. Prints a line for each figure that
docs/robots.md tells, and ends with status 1 if one is missed.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from sailenv_ros.assets.robots import robot_path
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose

ROBOTS = (
    "franka_panda/panda.urdf",
    "kuka_iiwa/model.urdf",
    "xarm/xarm6_with_gripper.urdf",
    "husky/husky.urdf",
    "r2d2.urdf",
)
SWINGING = (("kuka_iiwa/model.urdf", 0.3), ("kuka_iiwa/model.urdf", 0.8))
"""MuJoCo refuses the inertia of xarm, and Panda's limits end its swing."""

MOST_M, MOST_SHARE, MOST_HAND_M, MOST_HAND_DEG = 1e-6, 0.01, 1e-4, 0.01
EMPTY = """
version: 1
settled: false
objects:
  - {name: far, asset: cube, static: true, position: [50, 0, 0]}
"""


def mujoco_model(path: Path, options: str = "") -> Any:
    """Compile the links and joints of a URDF without geometries."""
    text = re.sub(r"\$\(optenv\s+\w+\s*([^)]*)\)", r"\1", path.read_text(encoding="utf-8"))
    root = ET.fromstring(text)
    for child in list(root):
        if child.tag not in ("link", "joint"):
            root.remove(child)
    for one in root:
        for part in list(one):
            if part.tag in ("visual", "collision", "contact", "mimic", "safety_controller"):
                one.remove(part)
        inertial = one.find("inertial")
        mass = None if inertial is None else inertial.find("mass")
        if inertial is not None and mass is not None and float(mass.get("value", 0)) == 0.0:
            one.remove(inertial)
    compiler = ET.SubElement(ET.SubElement(root, "mujoco"), "compiler")
    compiler.attrib.update(
        fusestatic="false", balanceinertia="true", boundmass="1e-9", boundinertia="1e-12",
        angle="radian", strippath="false",
    )  # fmt: skip
    # MuJoCo fuses what carries all with its world unless something is above it.
    return mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode")).compile()


def simulation(folder: Path) -> SynchronousSimulation:
    """Return an empty scene."""
    path = folder / "empty.yaml"
    path.write_text(EMPTY, encoding="utf-8")
    return SynchronousSimulation(SceneLibrary(), path, NativeRenderer())


def kinematics(core: SynchronousSimulation, file: str) -> float:
    """Return the greatest distance of a link from where MuJoCo has it [m]."""
    path = robot_path(f"pybullet_data:{file}")
    model = mujoco_model(path)
    data = mujoco.MjData(model)
    name = core.spawn_robot(f"pybullet_data:{file}", settings={"self_collision": False})
    robot = core.world.robots[name]
    draws = np.random.default_rng(0)
    worst = 0.0
    for _ in range(50):
        positions = {}
        for link in robot.model.moving:
            low, high = link.joint.limits or (-math.pi, math.pi)
            if link.joint.mimic is None:
                positions[link.joint.name] = float(draws.uniform(low, high))
        rolled = set() if robot.wheels is None else set(robot.wheels.joints)
        core.put_joints({k: v for k, v in positions.items() if k not in rolled}, robot=name)
        for joint, position in robot.positions().items():
            number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint)
            data.qpos[model.jnt_qposadr[number]] = position
        mujoco.mj_kinematics(model, data)
        first = robot.model.links[0].name
        frames = [link.name for link in robot.model.links]
        frames += [frame.name for frame in robot.model.frames]
        numbers = {one: mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, one) for one in frames}
        base = _matrix(data, max(numbers[first], 0))
        for one, number in numbers.items():
            if number < 0:
                continue
            theirs = np.linalg.inv(base) @ _matrix(data, number)
            ours = (
                np.linalg.inv(robot.first_pose().matrix())
                @ core.link_pose(one, robot=name).matrix()
            )
            worst = max(worst, float(np.linalg.norm(theirs[:3, 3] - ours[:3, 3])))
            worst = max(worst, float(np.abs(theirs[:3, :3] - ours[:3, :3]).max()))
    core.despawn_robot(name)
    return worst


def swinging(core: SynchronousSimulation, file: str, lean: float) -> float:
    """Return how far the last link gets from where it is to be in 2 s, by its path's extent."""
    path = robot_path(f"pybullet_data:{file}")
    # It hangs from above, so that it swings and does not fall into its limits.
    name = core.spawn_robot(
        f"pybullet_data:{file}", (0, 0, 3), (180, 0, 0), settings={"self_collision": False}
    )
    robot = core.world.robots[name]
    joints = list(robot.positions())
    start = {joint: lean * (1 if place % 2 else -1) for place, joint in enumerate(joints)}
    for one in robot.model.links:
        for told in (one.joint,):
            if told.name in start and told.limits is not None:
                start[told.name] = min(max(start[told.name], told.limits[0]), told.limits[1])
    core.put_joints(start, robot=name)
    core.drive_joints(dict.fromkeys(joints, 0.0), "off", robot=name)
    core.step(2)
    state = core.get_robot(name)
    model = mujoco_model(path)
    model.opt.gravity[:] = (0.0, 0.0, 9.81)
    model.opt.timestep, model.opt.integrator = 1e-4, mujoco.mjtIntegrator.mjINT_RK4
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT
    model.dof_damping[:] = [one.joint.damping for one in robot.model.moving]
    model.dof_frictionloss[:] = [one.joint.friction for one in robot.model.moving]
    data = mujoco.MjData(model)
    for joint in state.joints:
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, joint.name)
        data.qpos[model.jnt_qposadr[number]] = joint.position
        data.qvel[model.jnt_dofadr[number]] = joint.velocity
    ours: list[Any] = []
    theirs: list[Any] = []
    for _ in range(240):
        core.step(2)
        while data.time < len(ours) / 120 + 1 / 120 - 5e-5:
            mujoco.mj_step(model, data)
        ours.append(core.link_pose(robot.model.links[-1].name, robot=name).position_m)
        mujoco.mj_kinematics(model, data)
        x, y, z = data.xpos[model.nbody - 1]
        theirs.append((x, -y, 3.0 - z))
    core.despawn_robot(name)
    off_m = np.linalg.norm(np.array(ours) - np.array(theirs), axis=1)
    return float(off_m.max() / np.linalg.norm(np.ptp(np.array(theirs), axis=0)))


HAND_EYE = """
import cv2, json, numpy as np, sys
views = np.load(sys.argv[1])
turns, places = [], []
for pixels in views["pixels"]:
    _, turn, place = cv2.solvePnP(views["grid"], pixels, views["k"], None)
    turns.append(cv2.Rodrigues(turn)[0]), places.append(place)
hands = views["hands"]
turn, place = cv2.calibrateHandEye(
    hands[:, :3, :3], hands[:, :3, 3], turns, places, method=cv2.CALIB_HAND_EYE_PARK)
print(json.dumps([[*row, p] for row, p in zip(turn.tolist(), place.ravel())] + [[0, 0, 0, 1]]))
"""


def hand_eye(core: SynchronousSimulation, opencv: str) -> tuple[float, float]:
    """Return how far OpenCV finds the hand camera from where it is [m], [deg]."""
    name = core.spawn_robot("pybullet_data:franka_panda/panda.urdf")
    held = Pose.from_rpy_deg((0.07, 0.01, 0.03), (4.0, -88.0, 3.0))
    lens = CameraIntrinsics(width=1280, height=960, vertical_fov_deg=50.0)
    core.register_agent(
        AgentSpec(name="hand", carrier=f"{name} panda_hand", pose=held, intrinsics=lens)
    )
    draws = np.random.default_rng(1)
    grid = np.array([(x, y, 0.0) for x in range(7) for y in range(5)]) * 0.03 + (0.45, -0.06, 0.0)
    pixels_of: list[Any] = []
    hands: list[Any] = []
    while len(hands) < 25:
        eye = (0.5 + draws.uniform(-0.1, 0.1), draws.uniform(-0.15, 0.15), draws.uniform(0.35, 0.5))
        rpy = (180 + draws.uniform(-20, 20), draws.uniform(-20, 20), draws.uniform(-40, 40))
        try:
            found = core.reach_pose("panda_hand", Pose.from_rpy_deg(eye, rpy), robot=name)
        except ValueError:
            continue
        core.put_joints({k: v for k, v in found.items() if "finger" not in k}, robot=name)
        frame = core.capture(["depth"], agent="hand")
        # The corners of a board on the floor, by the camera of the frame itself.
        optical = np.linalg.inv(frame.camera.world_from_camera)
        seen = (optical[:3, :3] @ grid.T).T + optical[:3, 3]
        pixels = (lens.K @ seen.T).T
        pixels = pixels[:, :2] / pixels[:, 2:]
        pixels_of.append(np.round(pixels / 0.01) * 0.01)  # as a good detector finds corners
        hands.append(core.link_pose("panda_hand", robot=name).matrix())
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "views.npz"
        np.savez(file, grid=grid, pixels=pixels_of, hands=hands, k=lens.K)
        done = subprocess.run(
            [opencv, "-c", HAND_EYE, str(file)], capture_output=True, text=True, check=True
        )
    hand_from_optical = np.array(json.loads(done.stdout))
    hand_from_body = hand_from_optical @ np.linalg.inv(BODY_FROM_OPTICAL)
    expected = held.matrix()
    off_m = float(np.linalg.norm(hand_from_body[:3, 3] - expected[:3, 3]))
    cosine = (np.trace(hand_from_body[:3, :3] @ expected[:3, :3].T) - 1.0) / 2.0
    return off_m, math.degrees(math.acos(min(1.0, cosine)))


def _matrix(data: Any, body: int) -> np.ndarray[Any, Any]:
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = data.xmat[body].reshape(3, 3), data.xpos[body]
    return matrix


def main() -> int:
    """Measure; 0 if every figure is kept."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--opencv", required=True, help="a Python that has OpenCV 4")
    opencv = parser.parse_args().opencv
    kept = True
    with tempfile.TemporaryDirectory() as folder:
        core = simulation(Path(folder))
        for file in ROBOTS:
            off = kinematics(core, file)
            kept &= off <= MOST_M
            print(f"kinematics of {file}: {off:.1e} m")
        for file, lean in SWINGING:
            share = swinging(core, file, lean)
            kept &= share <= MOST_SHARE
            print(f"2 s of swinging {file}: {100 * share:.2f} %")
        off_m, off_deg = hand_eye(core, opencv)
        kept &= off_m <= MOST_HAND_M and off_deg <= MOST_HAND_DEG
        print(f"hand camera by cv2.calibrateHandEye: {1e3 * off_m:.4f} mm, {off_deg:.5f} deg")
        core.close()
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
