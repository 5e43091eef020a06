"""Path planners that we did not write cross the free-space maps of the rooms.

    python -m venv planners && planners/bin/pip install numpy pathfinding networkx
    python benchmarks/free_space_planners.py --write maps   # in the environment of sailenv_ros
    planners/bin/python benchmarks/free_space_planners.py --judge maps

Prints, for each room, how many ways they found of those that we found, and how long theirs are
beside ours (along rows, columns and diagonals, before straightening).
"""

from __future__ import annotations

import argparse
import json
import math
from pathlib import Path

import numpy as np

ROOMS = ("room_01", "room_02", "room_03")
BODY = {"height_m": 0.5, "radius_m": 0.15}
WAYS = 20


def write(folder: Path) -> None:
    """Write the maps and our ways."""
    from sailenv_ros import Simulation

    folder.mkdir(parents=True, exist_ok=True)
    for room in ROOMS:
        with Simulation(room, mode="lockstep") as simulation:
            simulation.step(480)
            space = simulation.free_space(**BODY)
        ways = []
        for number in range(WAYS):
            ends = [space.random_pose(f"{end} {number}").position_m for end in ("start", "goal")]
            cells = [space.cell_of(end) for end in ends]
            straight = space.path(*ends)
            ways.append(
                {
                    "start": cells[0],
                    "goal": cells[1],
                    "length_cells": float(space.distances_m(ends[0])[cells[1]])
                    / space.resolution_m,
                    "straightened_m": float(
                        np.linalg.norm(np.diff(straight, axis=0), axis=1).sum()
                    ),
                }
            )
        np.save(folder / f"{room}.npy", space.cells)
        (folder / f"{room}.json").write_text(json.dumps(ways))


def judge(folder: Path) -> None:
    """Find the same ways by others, and print how they compare."""
    import networkx
    from pathfinding.core.diagonal_movement import DiagonalMovement
    from pathfinding.core.grid import Grid
    from pathfinding.finder.dijkstra import DijkstraFinder

    for room in ROOMS:
        free = np.load(folder / f"{room}.npy") == 0
        ways = json.loads((folder / f"{room}.json").read_text())
        graph = networkx.Graph()
        for row, column in np.argwhere(free).tolist():
            for down, right in ((0, 1), (1, 0), (1, 1), (1, -1)):
                to = row + down, column + right
                if not all(0 <= to[k] < free.shape[k] for k in (0, 1)) or not free[to]:
                    continue
                if not (down and right) or (free[row + down, column] and free[row, to[1]]):
                    graph.add_edge((row, column), to, weight=math.hypot(down, right))
        found = {"pathfinding": 0, "networkx": 0}
        worst = dict.fromkeys(found, 0.0)
        for way in ways:
            grid = Grid(matrix=free.astype(int).tolist())
            finder = DijkstraFinder(diagonal_movement=DiagonalMovement.only_when_no_obstacle)
            start, goal = way["start"], way["goal"]
            cells, _ = finder.find_path(grid.node(*start[::-1]), grid.node(*goal[::-1]), grid)
            points = np.array([(node.x, node.y) for node in cells], float)
            lengths = {
                "pathfinding": float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()),
                "networkx": networkx.dijkstra_path_length(graph, tuple(start), tuple(goal)),
            }
            for name, length in lengths.items():
                found[name] += bool(len(cells))
                worst[name] = max(worst[name], abs(length - way["length_cells"]))
        print(room, free.shape, f"{WAYS} ways; found: {found}; worst difference [cells]: {worst}")


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--judge", type=Path)
    arguments = parser.parse_args()
    if arguments.write:
        write(arguments.write)
    if arguments.judge:
        judge(arguments.judge)


if __name__ == "__main__":
    main()
