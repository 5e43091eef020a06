"""Movers that are bodies, in scene files and operations: what is announced, refused and saved."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from sailenv_ros.errors import InvalidRequest, InvalidState, SceneError, UnknownName
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation.editing.saving import described_world
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.types.look_at import LookAt
from sailenv_ros.types.rigid_body import RigidBody
from tests.support.lockstep_core import lockstep_core

STAGE = """
version: 1
objects:
  - {name: floor, asset: cube, scale: 10, position: [0, 0, -5], static: true}
  - {name: ball, asset: sphere, position: [3, 0, 0.5], mass: 0.4}
movers:
  - name: puck
    position: [0, 0, 0.5]
    body: {mass: 0.2, radius: 0.1, drag: 0.5, angular_drag: 0.25, friction: 0.1, restitution: 0.4,
           gravity: false, velocity: [1, 0, 0], angular_velocity: [0, 0, 90]}
  - {name: rail, waypoints: [{position: [0, 3, 1]}, {position: [1, 3, 1]}]}
  - {name: stand, position: [0, -3, 1]}
  - {name: ball, position: [0, -4, 1], body: {gravity: false}}
agents:
  - {name: rider, width: 16, height: 12}
  - {name: porter, width: 16, height: 12, mover: stand}
"""

PUCK = RigidBody(
    mass_kg=0.2,
    radius_m=0.1,
    drag_per_s=0.5,
    angular_drag_per_s=0.25,
    friction=0.1,
    restitution=0.4,
    gravity=False,
)


def test_a_scene_file_makes_a_body_and_a_reset_begins_anew(core: SynchronousSimulation) -> None:
    """Its constants are announced, its motion is told; who follows sees from it."""
    bodies = {mover.name: mover.body for mover in core.info.movers}
    assert bodies == {"puck": PUCK, "rail": None, "stand": None, "ball": RigidBody(gravity=False)}
    assert core.get_mover_velocity("puck") == ((1.0, 0.0, 0.0), (0.0, 0.0, math.pi / 2))
    core.step(240)
    there = core.get_mover_pose("puck")
    assert there.position_m[0] == pytest.approx((1.0 - math.exp(-0.5)) / 0.5, abs=0.005)
    assert there.rpy_deg[2] == pytest.approx(90 * (1 - math.exp(-0.25)) / 0.25, abs=0.5)
    assert core.get_pose(agent="rider") == there
    core.set_follow(False, agent="rider")
    core.step(24)
    assert core.get_pose(agent="rider") == there
    core.reset()
    assert core.get_mover_velocity("puck")[0] == (1.0, 0.0, 0.0)
    assert core.get_mover_pose("puck").position_m == (0.0, 0.0, 0.5)


def test_a_request_makes_a_body_and_tells_it(core: SynchronousSimulation) -> None:
    revision = core.info.revision
    core.set_mover_body(RigidBody(mass_kg=2.0), "stand")
    assert core.info.revision > revision
    assert core.movers["stand"].body == RigidBody(mass_kg=2.0)
    assert core.movers["stand"].controller == "rigidbody"
    core.step(60)
    fallen = core.get_pose(agent="rider").position_m, core.get_mover_pose("stand").position_m[2]
    assert fallen[1] == pytest.approx(1.0 - 9.81 / 32, abs=0.01)
    revision = core.info.revision
    core.set_mover_body(RigidBody(mass_kg=2.0), "stand")
    assert core.info.revision == revision
    core.set_follow(True, agent="porter")
    core.set_position((0.0, -3.0, 4.0), agent="porter")
    assert core.get_mover_velocity("stand") == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    core.set_mover_body(None, "stand")
    assert core.movers["stand"].body is None
    core.step(60)
    assert core.get_mover_pose("stand").position_m == (0.0, -3.0, 4.0)


def test_the_same_call_pushes_objects_and_movers(core: SynchronousSimulation) -> None:
    """By name; where both have it, the object is meant. A point is one of the ball's own frame."""
    core.apply_wrench("ball", force_n=(0.0, 0.0, 96.0), point_m=None)
    core.apply_wrench("puck", force_n=(0.0, 4.8, 0.0), point_m=(0.0, 0.0, 0.1))
    core.step(2)
    assert core.get_object("ball").linear_velocity[2] > 0.5
    assert core.get_mover_velocity("ball") == ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    linear, angular = core.get_mover_velocity("puck")
    assert linear[1] == pytest.approx(4.8 / 240 / 0.2, rel=1e-9)
    inertia = 0.4 * 0.2 * 0.01
    assert angular[0] == pytest.approx(-0.1 * 4.8 / 240 / inertia, rel=1e-6)


def test_a_body_faces_things_and_tells_what(core: SynchronousSimulation) -> None:
    """Whether it spins or not, what sees from it is turned; it goes on as it went."""
    core.set_mover_look_at("ball", mover="puck")
    assert core.get_mover_look_at("puck") == LookAt(obj="ball")
    core.step(120)
    pose = core.get_pose(agent="rider")
    way = np.subtract(core.get_object("ball").pose.position_m, pose.position_m)
    np.testing.assert_allclose(pose.matrix()[:3, 0], way / np.linalg.norm(way), atol=1e-9)
    assert core.get_mover_velocity("puck")[1][2] > 1.0
    core.set_look_at(point_m=(0, 0, 9), agent="rider")
    assert core.get_look_at(agent="rider") == LookAt(point_m=(0.0, 0.0, 9.0))
    core.set_rotation((0, 0, 0), agent="rider")
    assert core.get_look_at(agent="rider") is None
    assert core.get_mover_look_at("puck") is None
    with pytest.raises(UnknownName, match="nobody"):
        core.get_look_at(agent="nobody")
    with pytest.raises(UnknownName, match="nobody"):
        core.get_mover_look_at("nobody")


@pytest.mark.parametrize(
    ("ask", "error", "words"),
    [
        (lambda c: c.set_mover_body(PUCK, "rail"), InvalidState, "set_mover_controller"),
        (lambda c: c.set_mover_body(PUCK, "nobody"), UnknownName, "nobody"),
        (lambda c: c.set_mover_body({"mass": 1.0}), InvalidRequest, "RigidBody"),
        (lambda c: c.set_mover_controller("waypoint", "puck"), InvalidState, "set_mover_body"),
        (lambda c: c.drive_mover((1, 0, 0), mover="puck"), InvalidState, "apply_wrench"),
        (lambda c: c.apply_wrench("rail", force_n=(1, 0, 0)), InvalidState, "set_mover_body"),
        (lambda c: c.apply_wrench("puck", force_n=(math.nan, 0, 0)), InvalidRequest, "force_n"),
        (lambda c: c.apply_wrench("puck", duration_s=-1.0), InvalidRequest, "duration_s"),
        (lambda c: c.get_mover_velocity("rail"), InvalidState, "set_mover_body"),
    ],
)
def test_what_is_refused_changes_nothing(
    core: SynchronousSimulation,
    ask: Callable[[SynchronousSimulation], Any],
    error: type[Exception],
    words: str,
) -> None:
    def state() -> tuple[object, ...]:
        return core.info.movers, core.info.revision, core.get_mover_velocity("puck")

    before = state()
    with pytest.raises(error, match=words):
        ask(core)
    assert state() == before
    core.step(60)
    assert core.get_mover_velocity("puck")[0][1:] == (0.0, 0.0)


@pytest.mark.parametrize(
    ("mover", "words"),
    [
        ("{controller: waypoint, body: {}}", "controller: must be rigidbody"),
        ("{waypoints: [{position: [0, 0, 1]}], body: {}}", "controller: must be rigidbody"),
        ("{body: {mass: 0}}", "mass"),
        ("{body: {mass: -2}}", "mass"),
        ("{body: {drag: .nan}}", "drag"),
        ("{body: {restitution: 1.5}}", "restitution"),
        ("{body: {weight: 1}}", "weight"),
    ],
)
def test_files_are_told_what_is_wrong(tmp_path: Path, mover: str, words: str) -> None:
    path = tmp_path / "wrong.yaml"
    path.write_text(f"version: 1\nmover: {mover}\n")
    with pytest.raises(SceneError, match=words):
        load_scene(path)


def test_a_body_with_waypoints_is_one_until_it_is_none(tmp_path: Path) -> None:
    """With the controller `rigidbody` the track waits."""
    path = tmp_path / "both.yaml"
    track = "waypoints: [{position: [0, 0, 1]}, {position: [1, 0, 1]}]"
    path.write_text(f"version: 1\nmover: {{controller: rigidbody, {track}, body: {{}}}}\n")
    core = lockstep_core(path)
    core.step(48)
    assert core.get_mover_pose().position_m[2] < 0.9
    core.set_mover_body(None)
    core.set_mover_controller("waypoint")
    assert core.get_mover_pose().position_m == (0.0, 0.0, 1.0)
    core.close()


def saved(core: SynchronousSimulation) -> dict[str, Any]:
    return {entry["name"]: entry for entry in described_world(core.world, core.agents)["movers"]}


def test_a_saved_scene_has_bodies_as_they_move(core: SynchronousSimulation, tmp_path: Path) -> None:
    """Untouched ones keep the words of the file; others are written as they are now."""
    begun = {entry["name"]: entry for entry in yaml.safe_load(STAGE)["movers"]}
    assert saved(core)["puck"]["body"] == begun["puck"]["body"]
    core.step(48)
    core.set_mover_body(RigidBody(mass_kg=3.0, gravity=False), "stand")
    core.set_mover_body(None, "ball")
    entries = saved(core)
    assert "body" not in entries["ball"]
    assert entries["stand"]["body"] == {"mass": 3.0, "gravity": False}
    speed = entries["puck"]["body"]["velocity"][0]
    assert speed == pytest.approx(math.exp(-0.1), abs=1e-6)
    path = tmp_path / "again.yaml"
    path.write_text(yaml.safe_dump(described_world(core.world, core.agents)))
    again = lockstep_core(path)
    assert again.movers["puck"].body == PUCK
    assert again.get_mover_velocity("puck")[0][0] == speed
    there = core.get_mover_pose("puck").position_m
    np.testing.assert_allclose(again.get_mover_pose("puck").position_m, there, atol=1e-6)
    again.close()


def test_other_seeds_and_runs(stage: Path) -> None:
    """The same calls give the same bytes, whatever the seed: nothing here is drawn."""

    def run(seed: int) -> bytes:
        core = lockstep_core(stage)
        core.reset(seed)
        core.apply_wrench("puck", force_n=(3.0, 1.0, -2.0), duration_s=0.2)
        core.step(480)
        pose = core.get_mover_pose("puck")
        found = np.array([*pose.position_m, *pose.orientation_xyzw]).tobytes()
        found += core.world.snapshot().world_from_body.tobytes()
        core.close()
        return found

    assert run(1) == run(1) == run(2)
