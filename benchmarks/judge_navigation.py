"""Has a small robot driven through generated apartments, from door to door, by topics alone.

    python benchmarks/judge_navigation.py [COUNT] [--scans FILE]

A* on its `map`, pure pursuit on `odom` and `cmd_vel`. Prints a line for each apartment, and ends
with status 1 if a door was not reached or anything was touched. `--scans` keeps what `scan` told
with true poses as a NumPy file, for judges of odometry.
"""

from __future__ import annotations

import argparse
import heapq
import math
import sys
import tempfile
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from geometry_msgs.msg import Twist
from nav_msgs.msg import OccupancyGrid, Odometry
from scipy.ndimage import distance_transform_edt
from sensor_msgs.msg import LaserScan

from sailenv_ros import Agent
from tests.support.ros_probe import LATCHED, Probe
from tests.support.waiting import until

NAMESPACE = "/navigation"
RADIUS_M = 0.2
CLEAR_M = 0.07
AHEAD_M = 0.2
SPEED_M_S = 0.5
TRACTION_M_S2 = 5.0  # of wheels of rubber, half of what holds them to the floor
SENSOR = {"name": "scan", "type": "lidar", "position": [0, 0, 0.2], "rate": 20}
STEPS = 12
STEP_M = 0.02
MOST_TURNS = 4000
# As large as the wheels: what the map calls free, such as rugs of up to 2 cm, must be driven over.
_BALL = '<geometry><sphere radius="0.05"/></geometry>'
_WHEEL = '<geometry><cylinder radius="0.05" length="0.02"/></geometry>'
_SLIPS = '<contact><lateral_friction value="0"/></contact>'


def _link(name: str, mass: float, inertia: float, shape: str, place: str, more: str = "") -> str:
    return (
        f'<link name="{name}">{more}<inertial>{place}<mass value="{mass}"/>'
        f'<inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/>'
        f"</inertial><visual>{place}{shape}</visual><collision>{place}{shape}</collision></link>"
    )


def _joint(kind: str, child: str, xyz: str) -> str:
    return (
        f'<joint name="{child}" type="{kind}"><parent link="base_link"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="0 1 0"/></joint>'
    )


_TURNED = '<origin rpy="1.5707963267948966 0 0"/>'
_BODY = '<geometry><cylinder radius="0.17" length="0.1"/></geometry>'
ROBOT = (
    '<robot name="turtle">'
    + _link("base_link", 6.0, 0.08, _BODY, '<origin xyz="0 0 0.1"/>')
    + "".join(_link(f"{side}_wheel", 0.2, 3e-4, _WHEEL, _TURNED) for side in ("left", "right"))
    + "".join(_link(f"{end}_ball", 0.1, 1e-4, _BALL, "", _SLIPS) for end in ("front", "rear"))
    + _joint("continuous", "left_wheel", "0 0.14 0.05")
    + _joint("continuous", "right_wheel", "0 -0.14 0.05")
    + _joint("fixed", "front_ball", "0.12 0 0.05")
    + _joint("fixed", "rear_ball", "-0.12 0 0.05")
    + "</robot>"
)


class Driver:
    """Knows topics alone."""

    def __init__(self, probe: Probe) -> None:
        self.maps = probe.listen(OccupancyGrid, "turtle/map", LATCHED)
        self.odom = probe.listen(Odometry, "turtle/odom")
        self.scans = probe.listen(LaserScan, "turtle/scan")
        self._commands = probe.node.create_publisher(Twist, "turtle/cmd_vel", 1)

    def heard_more(self, count: int) -> bool:
        """Return whether odometry has come since there were so many."""
        return len(self.odom.messages) > count

    def command(self, forward: float, turn: float) -> None:
        """Drive for a moment."""
        twist = Twist()
        twist.linear.x, twist.angular.z = forward, turn
        self._commands.publish(twist)

    def place(self, start: tuple[float, float, float]) -> tuple[float, float, float]:
        """Return x, y and yaw on the map, of the newest odometry."""
        pose = self.odom.messages[-1].pose.pose
        yaw = 2.0 * math.atan2(pose.orientation.z, pose.orientation.w)
        x, y, began = start
        cos, sin = math.cos(began), math.sin(began)
        px, py = pose.position.x, pose.position.y
        return x + cos * px - sin * py, y + sin * px + cos * py, began + yaw

    def path(self, start: tuple[float, float], goal: tuple[float, float]) -> np.ndarray[Any, Any]:
        """Return (N, 2): a way by A* on the map, away from obstacles where there is room."""
        grid = self.maps.messages[-1]
        side = grid.info.resolution
        cells = np.array(grid.data, np.int8).reshape(grid.info.height, grid.info.width)
        clear = distance_transform_edt(cells == 0) * side
        free = clear > RADIUS_M + CLEAR_M - 0.035  # by which the map widens obstacles
        cost = 1.0 + 4.0 * np.clip(0.45 - clear, 0.0, None) / 0.45
        origin = grid.info.origin.position.x, grid.info.origin.position.y

        def cell(point: tuple[float, float]) -> tuple[int, int]:
            row, column = (int((point[k] - origin[k]) / side) for k in (1, 0))
            rows, columns = np.nonzero(free)
            nearest = np.argmin((rows - row) ** 2 + (columns - column) ** 2)
            return int(rows[nearest]), int(columns[nearest])

        begin, end = cell(start), cell(goal)
        came: dict[tuple[int, int], tuple[int, int]] = {}
        best = {begin: 0.0}
        waiting = [(0.0, begin)]
        while waiting:
            _, here = heapq.heappop(waiting)
            if here == end:
                break
            for row, column in (
                (0, 1),
                (1, 0),
                (0, -1),
                (-1, 0),
                (1, 1),
                (1, -1),
                (-1, 1),
                (-1, -1),
            ):
                there = here[0] + row, here[1] + column
                if not (0 <= there[0] < free.shape[0] and 0 <= there[1] < free.shape[1]):
                    continue
                if not free[there]:
                    continue
                so_far = best[here] + math.hypot(row, column) * float(cost[there])
                if so_far < best.get(there, math.inf):
                    best[there], came[there] = so_far, here
                    ahead = math.hypot(there[0] - end[0], there[1] - end[1])
                    heapq.heappush(waiting, (so_far + ahead, there))
        if end not in best:
            raise LookupError(f"no way from {start} to {goal}")
        way = [end]
        while way[-1] != begin:
            way.append(came[way[-1]])
        points = [(origin[0] + (c + 0.5) * side, origin[1] + (r + 0.5) * side) for r, c in way]
        return np.array(points[::-1])


def pursue(place: tuple[float, float, float], way: np.ndarray[Any, Any]) -> tuple[float, float]:
    """Return the speeds of pure pursuit."""
    x, y, yaw = place
    distances = np.hypot(way[:, 0] - x, way[:, 1] - y)
    nearest = int(distances.argmin())
    ahead = next((k for k in range(nearest, len(way)) if distances[k] > AHEAD_M), len(way) - 1)
    dx, dy = way[ahead] - (x, y)
    bearing = math.remainder(math.atan2(dy, dx) - yaw, math.tau)
    if abs(bearing) > 0.7:
        # To the left where the goal is straight behind: it would waver otherwise.
        return 0.0, math.copysign(1.2, bearing) if abs(bearing) < 2.8 else 1.2
    reach = max(math.hypot(dx, dy), 0.05)
    speed = SPEED_M_S * min(1.0, reach / AHEAD_M) * max(0.3, 1.0 - abs(bearing))
    return speed, 2.0 * speed * math.sin(bearing) / reach


def doors_of(scene: str) -> tuple[tuple[float, float, float], list[tuple[float, float]]]:
    """Return a place within the outer door, and the middles of all doorways."""
    room = yaml.safe_load(scene)["room"]
    width, depth = room["size"][0], room["size"][1]
    sides = {
        "south": (0, -1, width, depth), "north": (0, 1, width, depth),
        "west": (-1, 0, width, depth), "east": (1, 0, width, depth),
    }  # fmt: skip
    start = (0.0, 0.0, 0.0)
    for opening in room.get("openings", ()):
        if opening["type"] == "door":
            nx, ny, w, d = sides[opening["wall"]]
            along, inwards = opening.get("at", 0.0), 0.5
            x = nx * (w / 2 - inwards) if nx else along
            y = ny * (d / 2 - inwards) if ny else along
            start = (x, y, math.atan2(-ny, -nx))
    goals = []
    for wall in room.get("partitions", ()):
        (ax, ay), (bx, by) = wall["start"], wall["end"]
        length = math.hypot(bx - ax, by - ay)
        for doorway in wall.get("doorways", ()):
            share = 0.5 + doorway.get("at", 0.0) / length
            goals.append((ax + share * (bx - ax), ay + share * (by - ay)))
    return start, goals


def drive(agent: Agent, driver: Driver, scene: str, file: Path, kept: list[Any]) -> str:
    """Drive through one apartment; return what went wrong, else nothing."""
    agent.change_scene.within(1200)(scene)  # it is generated first
    start, goals = doors_of(agent.scene_text())
    for heard in (driver.maps, driver.odom, driver.scans):
        heard.messages.clear()
    free = agent.free_space(0.4, RADIUS_M + CLEAR_M, step_m=0.02)
    near = min(
        (math.hypot(x - start[0], y - start[1]), x, y)
        for x, y in (free.random_pose(str(k), seed=k).position_m[:2] for k in range(200))
    )
    start = (near[1], near[2], start[2])
    agent.spawn_robot(
        str(file), (start[0], start[1], 0.002), (0, 0, math.degrees(start[2])),
        name="turtle", mount="differential",
        settings={"sensors": [SENSOR], "wheels": {"acceleration": TRACTION_M_S2}},
    )  # fmt: skip
    agent.step(24)
    until(lambda: bool(driver.maps.messages and driver.odom.messages), "map and odometry")
    own = set(agent.get_robot("turtle").links.values())
    # Rugs and what is lower than the map's step are driven over.
    grounds = {n for n, one in agent.instances.items() if one.category in ("floor", "rug", "mat")}
    low = {
        n
        for n in agent.instances
        if n not in own and agent.get_object(n).size_m[2] < STEP_M and n not in grounds
    }
    grounds |= low
    agent.contacts()
    done, turns = [], 0
    for goal in goals:
        place = driver.place(start)
        try:
            way = driver.path(place[:2], goal)
        except LookupError as problem:
            return str(problem)
        while math.hypot(place[0] - way[-1][0], place[1] - way[-1][1]) > 0.12:
            turns += 1
            if turns > MOST_TURNS:
                return f"it did not reach {goal} from {place}"
            driver.command(*pursue(place, way))
            count = len(driver.odom.messages)
            agent.step(STEPS)
            until(partial(driver.heard_more, count), "odometry")
            for contact in agent.contacts(STEPS / 240):
                pair = {contact.first, contact.second}
                if pair & own and not pair <= own | grounds:
                    names = [agent.instances[n].name for n in pair if n in agent.instances]
                    return f"it touched {names} at {place}"
            place = driver.place(start)
            kept.append(
                (
                    scene,
                    place,
                    list(driver.scans.messages[-1].ranges) if driver.scans.messages else [],
                )
            )
        done.append(goal)
    print(f"{scene}: {len(done)} doors in {turns * STEPS / 240:.0f} s", flush=True)
    return ""


def main() -> int:
    """Drive; 0 if all doors were reached without a bump."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("count", nargs="?", type=int, default=20)
    parser.add_argument("--scans", type=Path)
    options = parser.parse_args()
    failures = 0
    kept: list[Any] = []
    simulator = {"scene": "void", "mode": "lockstep", "agent.name": ""}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "turtle.urdf"
        file.write_text(ROBOT, encoding="utf-8")
        with (
            Agent(namespace=NAMESPACE, simulator=simulator, width=64, height=48) as agent,
            Probe(NAMESPACE) as probe,
        ):
            driver = Driver(probe)
            for seed in range(1, options.count + 1):
                scene = f"generated:apartment:{seed}"
                why = drive(agent, driver, scene, file, kept)
                failures += bool(why)
                if why:
                    print(f"{scene}: {why}", flush=True)
            if options.scans and kept:
                scans = [np.array(ranges, np.float32) for _, _, ranges in kept]
                np.savez(
                    options.scans,
                    scene=[name for name, _, _ in kept],
                    place=[place for _, place, _ in kept],
                    ranges=np.array(scans),
                )
    print(f"{options.count - failures} of {options.count} apartments")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
