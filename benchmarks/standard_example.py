"""Run the example of the standard interfaces that Gazebo, Isaac Sim and O3DE are shown with.

    python benchmarks/standard_example.py FOLDER

FOLDER has `warehouse_simulation_script.py` and `ur10_helpers.py` of the repository
RobotecAI/simulation_interfaces_examples. The script has a row of names for each simulator (world,
things, services). It gets one for this simulator and is not changed otherwise. It loads a world,
spawns a table, cubes, a cart, an arm and boxes, plays, pauses and steps. Then the cart pushes three
boxes to their goals by `/cmd_vel`. Exits with 1 if the script reports a failure or does not end.
"""

from __future__ import annotations

import functools
import importlib
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import Any

from rclpy.node import Node

SCRIPT = "warehouse_simulation_script"
START_S, LIMIT_S = 60.0, 180.0

WORLD = """\
version: 1
title: Warehouse
objects:
  - {name: floor, asset: plane, scale: [12, 12, 1], static: true}
lights:
  - {name: sun, type: directional, direction: [0.3, 0.2, -1]}
"""

ARM_JOINTS = ("shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3")


def main() -> int:
    """Start a simulator, run the script beside it, and show what both said."""
    if len(sys.argv) == 3:
        play(Path(sys.argv[1]), Path(sys.argv[2]))
        return 0
    folder = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as name:
        assets = Path(name)
        write_assets(assets)
        node = [sys.executable, "-m", "sailenv_ros.ros.nodes.sim_node", "--ros-args"]
        for topic in ("/dingo/cmd_vel:=/cmd_vel", "/ur10/joint_commands:=/joint_commands"):
            node += ["-r", topic]
        for setting in ("scene:=optical", f"scene_paths:=['{assets}']", "viewer.port:=0"):
            node += ["-p", setting]
        with subprocess.Popen(
            [*node, "-r", "__ns:=/", "-p", "gateway.port:=0"], text=True
        ) as simulator:
            try:
                said = run_apart(folder, assets)
            finally:
                simulator.terminate()
    passed = "Demo completed" in said[-1] and not any("Failed" in line for line in said)
    print("passed" if passed else "failed")
    return int(not passed)


def run_apart(folder: Path, assets: Path) -> list[str]:
    """Run the script in a process of its own; print and return what it says."""
    command = [sys.executable, "-u", __file__, str(folder), str(assets)]
    said = [""]
    with subprocess.Popen(
        command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as script:
        stopping = threading.Timer(LIMIT_S, script.kill)
        stopping.start()
        assert script.stdout is not None
        for line in script.stdout:
            print(line, end="", flush=True)
            said.append(line)
        stopping.cancel()
    return said


def play(folder: Path, assets: Path) -> None:
    """Run the script with the names that this simulator has for its things."""
    sys.path.insert(0, str(folder))
    sys.argv = [SCRIPT, "--sim-backend", "isaacsim"]  # whose topics of the arm are the same
    script = importlib.import_module(SCRIPT)
    names = vars(script)
    services = script.configure_simulation_backend.__code__.co_names

    def configure(_: str) -> None:
        for key in services:
            if key.endswith("_SERVICE"):
                names[key] = "/" + key.removesuffix("_SERVICE").lower()
        names["GET_FEATURES_SERVICE"] = "/get_simulator_features"
        names["RENAME_ENTITY"] = False
        names["WORLD_URI"] = "sailenv://scene/warehouse"
        names["TABLE_URI"] = "sailenv://asset/dining_table_03"
        names["BLUE_CUBE_URI"] = names["RED_CUBE_URI"] = "sailenv://asset/puzzle_cube_01"
        names["CARDBOARD_URI"] = "sailenv://asset/box_01"
        names["DINGO_URI"] = str(assets / "dingo.urdf")
        names["UR10_URI"] = (assets / "ur10.urdf").as_uri()

    names["configure_simulation_backend"] = configure
    # It makes a client for each call, asks before it knows of the service, and keeps all clients:
    # requests are lost, and with 150 clients rclpy takes 0.2 s a call, whoever answers.
    create = Node.create_client

    @functools.cache
    def create_client(node: Node, kind: Any, name: str) -> Any:
        client = create(node, kind, name)
        client.wait_for_service(START_S)
        return client

    Node.create_client = create_client  # type: ignore[method-assign]
    script.main()


def write_assets(folder: Path) -> None:
    """Write the world and the two robots, whose names of joints are those of the script."""
    (folder / "warehouse.yaml").write_text(WORLD, encoding="utf-8")
    wheel = '<geometry><cylinder radius="0.1" length="0.05"/></geometry>'
    turned = '<origin rpy="1.5707963 0 0"/>'
    corners = {f"wheel_{x}{y}": f"{x}0.2 {y}0.2 0.1" for x in ("-", "") for y in ("-", "")}
    cart = link("chassis", 20.0, 0.6, box("0.5 0.3 0.1"), '<origin xyz="0 0 0.2"/>')
    for name, place in corners.items():
        cart += link(name, 0.5, 0.002, wheel, turned) + joint(
            name, "continuous", "chassis", place, "0 1 0"
        )
    cart += '<gazebo><plugin filename="gz-sim-diff-drive-system"/></gazebo>'
    arm = link("base", 4.0, 0.02, box("0.1 0.1 0.1"), '<origin xyz="0 0 0.05"/>')
    above = "base"
    for number, name in enumerate(ARM_JOINTS):
        axis = "0 0 1" if number in (0, 5) else "0 1 0"
        arm += link(name, 1.0, 0.003, box("0.05 0.05 0.12"), '<origin xyz="0 0 0.08"/>')
        limit = '<limit lower="-6.28" upper="6.28" effort="150" velocity="3"/>'
        arm += joint(name, "revolute", above, "0 0 0.15", axis, limit)
        above = name
    for name, body in (("dingo", cart), ("ur10", arm)):
        (folder / f"{name}.urdf").write_text(f'<robot name="{name}">{body}</robot>', "utf-8")


def box(size: str) -> str:
    """Return a geometry."""
    return f'<geometry><box size="{size}"/></geometry>'


def link(name: str, mass: float, inertia: float, shape: str, place: str) -> str:
    """Return a link of one shape."""
    return (
        f'<link name="{name}"><inertial>{place}<mass value="{mass}"/><inertia ixx="{inertia}" '
        f'iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>'
        f"<visual>{place}{shape}</visual><collision>{place}{shape}</collision></link>"
    )


def joint(name: str, kind: str, parent: str, place: str, axis: str, limit: str = "") -> str:
    """Return the joint above a link."""
    return (
        f'<joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
        f'<origin xyz="{place}"/><axis xyz="{axis}"/>{limit}</joint>'
    )


if __name__ == "__main__":
    sys.exit(main())
