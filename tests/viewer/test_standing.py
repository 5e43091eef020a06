"""What is put into furniture stands on its boards, though physics knows a box in their place."""

from __future__ import annotations

import pytest
import trimesh

from sailenv_ros.assets import AssetLibrary
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations.edits import EditOperations
from sailenv_ros.types.geometry import Pose

EMPTY = """
version: 1
lights: [{name: sun, type: directional, direction: [0.2, 0.1, -1.0]}]
objects:
  - {name: floor, asset: cube, position: [0, 0, -0.5], scale: [8, 8, 1], static: true}
  - {name: bookcase, asset: bookcase_01, position: [0, 0, 0], static: true}
"""


def boards_m(x: float, y: float) -> list[float]:
    """Return the heights at which a vertical line meets the bookcase, by trimesh's own rays."""
    meshes = []
    for part in AssetLibrary(installed_sources()).get("bookcase_01").model.parts:
        meshes.append(trimesh.Trimesh(part.mesh.positions, part.mesh.triangles, process=False))
    met, _, _ = trimesh.util.concatenate(meshes).ray.intersects_location(
        [[x, y, 5.0]], [[0.0, 0.0, -1.0]], multiple_hits=True
    )
    return sorted(float(point[2]) for point in met)


def test_a_book_in_a_bookcase_stands_on_its_board(tmp_path_factory: pytest.TempPathFactory) -> None:
    """And stays there: physics, which would push it out of the box, is not asked to hold it."""
    file = tmp_path_factory.mktemp("scene") / "bookcase.yaml"
    file.write_text(EMPTY)
    with Simulation(file, mode="lockstep") as simulation:
        number = simulation.spawn_object("bottle_01", (3.0, 0.0, 0.5), remove_dynamics=False)
        # One that is not full of books.
        below = [height for height in boards_m(0.0, 0.0) if height < 0.6]
        held = EditOperations.set_down(simulation, number, Pose((0.0, 0.0, below[-1] + 0.01)))
        state = simulation.get_object(number)
        bottom = state.pose.position_m[2] + state.bottom_m
        assert bottom == pytest.approx(below[-1], abs=1e-5)
        assert held
        simulation.step(240)
        assert simulation.get_object(number).pose == state.pose
        # On the open floor it is left to physics, and stays where it was set down.
        assert not EditOperations.set_down(simulation, number, Pose((2.0, 0.0, 0.01)))


def test_what_stands_free_is_left_to_physics(tmp_path_factory: pytest.TempPathFactory) -> None:
    """It is set down on the floor and does not move when time runs."""
    file = tmp_path_factory.mktemp("scene") / "bookcase.yaml"
    file.write_text(EMPTY)
    with Simulation(file, mode="lockstep") as simulation:
        number = simulation.spawn_object("cube", (3.0, 0.0, 2.0), scale=0.3, remove_dynamics=False)
        bottom = simulation.get_object(number).bottom_m
        assert not EditOperations.set_down(simulation, number, Pose((2.0, 0.0, 0.02 - bottom)))
        placed = simulation.get_object(number)
        assert placed.pose.position_m[2] + bottom == pytest.approx(0.0, abs=1e-6)
        assert not placed.static
        simulation.step(240)
        after = simulation.get_object(number).pose.position_m
        assert after == pytest.approx(placed.pose.position_m, abs=0.003)
