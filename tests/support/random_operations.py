"""Many threads that do random things to one simulation, and a model of what must come of it.

Each thread has objects and an agent of its own, so that its model is exact whatever the others do;
what all share (pauses of the clock, rates, lights, the seed's world) is done beside.
"""

from __future__ import annotations

import random
import threading
from dataclasses import dataclass, field

import numpy as np

from sailenv_ros.errors import InvalidRequest, SailenvError
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose

__all__ = ["storm"]

MOST_OBJECTS = 6


@dataclass
class _Model:
    """State that one thread expects to find."""

    poses: dict[int, Pose] = field(default_factory=dict)
    names: dict[int, str] = field(default_factory=dict)
    scales: dict[int, float] = field(default_factory=dict)
    camera: Pose = field(default_factory=lambda: Pose((0.0, 0.0, 1.0)))
    refused: int = 0


def storm(simulation: Simulation, *, threads: int, operations: int, seed: int) -> dict[str, int]:
    """Do so many operations in each of so many threads, then compare the world with the models.

    Returns
    -------
    counts : dict of str to int
        How many operations, refusals and frames there were.
    """
    models = [_Model() for _ in range(threads)]
    faults: list[BaseException] = []
    frames = [0] * threads
    before = {instance.id for instance in simulation.info.instances}

    def work(number: int) -> None:
        try:
            frames[number] = _work(simulation, models[number], number, operations, seed)
        except BaseException as fault:
            faults.append(fault)

    workers = [threading.Thread(target=work, args=(number,)) for number in range(threads)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    if faults:
        raise faults[0]
    _compare(simulation, models, before)
    return {
        "operations": threads * operations,
        "refused": sum(model.refused for model in models),
        "frames": sum(frames),
    }


def _work(simulation: Simulation, model: _Model, number: int, operations: int, seed: int) -> int:
    rng = random.Random(seed * 1000 + number)
    agent, frames = f"storm_{number}", 0
    intrinsics = CameraIntrinsics(width=32, height=24)
    spec = AgentSpec(
        name=agent, intrinsics=intrinsics, rate_hz=0.0, following=False, pose=model.camera
    )
    simulation.register_agent(spec)
    for count in range(operations):
        kind = rng.randrange(10)
        if kind < 2 and len(model.poses) < MOST_OBJECTS:
            _spawn(simulation, model, f"thing_{number}_{count}", rng)
        elif kind == 2 and model.poses:
            id_ = rng.choice(list(model.poses))
            simulation.despawn_object(id_)
            for known in (model.poses, model.names, model.scales):
                del known[id_]
        elif kind < 5 and model.poses:
            id_ = rng.choice(list(model.poses))
            model.poses[id_] = _pose(rng, number)
            simulation.move_object(id_, pose=model.poses[id_], teleport=rng.random() < 0.5)
        elif kind == 5 and model.poses:
            id_ = rng.choice(list(model.poses))
            model.scales[id_] = rng.choice((0.5, 1.0, 2.0))
            simulation.change_object(id_, scale=(model.scales[id_],) * 3)
        elif kind == 6:
            model.camera = _pose(rng, number)
            simulation.set_pose(model.camera, agent=agent)
        elif kind == 7:
            frame = simulation.capture(["instance"], agent=agent)
            frames += 1
            np.testing.assert_allclose(frame.camera.pose.position_m, model.camera.position_m)
        elif kind == 8:
            simulation.step(1)
        else:
            _refused(simulation, model, rng)
    return frames


def _spawn(simulation: Simulation, model: _Model, name: str, rng: random.Random) -> None:
    pose = _pose(rng, int(name.split("_")[1]))
    asset = rng.choice(("cube", "sphere", "cylinder"))
    id_ = simulation.spawn_object(asset, object_name=name, pose=pose, remove_dynamics=True)
    assert id_ not in model.poses
    model.poses[id_], model.names[id_], model.scales[id_] = pose, name, 1.0


def _refused(simulation: Simulation, model: _Model, rng: random.Random) -> None:
    """Ask for something that cannot be; nothing may change."""
    try:
        if rng.random() < 0.5:
            simulation.despawn_object("nothing of that name")
        else:
            simulation.spawn_object("cube", object_name="a", scale=(0, 1, 1))
    except SailenvError:
        model.refused += 1
    else:
        raise InvalidRequest("what cannot be", "accepted", "refused")


def _pose(rng: random.Random, number: int) -> Pose:
    """Return a place in the thread's own part of the world."""
    place = (100.0 * (number + 1) + rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(1, 9))
    return Pose.from_rpy_deg(place, (0.0, 0.0, rng.uniform(-180, 180)))


def _compare(simulation: Simulation, models: list[_Model], before: set[int]) -> None:
    """Hold the world against all models: the same objects, where and as they must be."""
    there = {instance.id: instance.name for instance in simulation.info.instances}
    wanted = {id_: name for model in models for id_, name in model.names.items()}
    assert {id_: name for id_, name in there.items() if id_ not in before} == wanted
    assert before <= set(there)
    for number, model in enumerate(models):
        for id_, pose in model.poses.items():
            state = simulation.get_object(id_)
            np.testing.assert_allclose(state.pose.position_m, pose.position_m, atol=1e-6)
            turned = abs(np.dot(state.pose.orientation_xyzw, pose.orientation_xyzw))
            assert turned > 1.0 - 1e-9
            assert tuple(state.scale) == (model.scales[id_],) * 3
        camera = simulation.get_pose(agent=f"storm_{number}")
        np.testing.assert_allclose(camera.position_m, model.camera.position_m)
