"""Motion of files: where a falling ball is at each sample, by both formats; shapes of people."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from sailenv_ros import Simulation
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene_export import export_scene
from sailenv_ros.scene_export.contents import ExportedScene
from sailenv_ros.scene_export.gathering import agents_in, exported_world, with_motion
from sailenv_ros.scene_export.glb import write_glb
from sailenv_ros.scene_export.motion import motion_of
from sailenv_ros.scene_export.usd import write_usda
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.deformation import Deformation
from sailenv_ros.types.model import Model
from tests.unit.scene_export.test_glb import WORLD_FROM_FILE, Glb
from tests.unit.scene_export.usda import Prim, read_usda

SCENE = """
version: 1
settled: false
objects:
  - {name: ball, asset: sphere, position: [0, 0.5, 2], scale: 0.3, angular_velocity: [0, 0, 90]}
  - {name: box, asset: cube, position: [1, 1, 0.5], static: true}
movers:
  - {name: walker, controller: waypoint, total_time: 4, waypoints: [{position: [0, 0, 1.5]},
      {position: [2, 0, 1.5]}]}
agents:
  - {name: eye, width: 64, height: 48}
"""
RATE_HZ, SAMPLES = 12.0, 7


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("moving") / "moving.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def scene(path: Path) -> Iterator[ExportedScene]:
    library = SceneLibrary(baked_light=False)
    with closing(library.build(path)) as world:
        agents = agents_in(world, library.agents_of(world.scene))
        yield with_motion(exported_world(world, agents), world, agents, 0.5, RATE_HZ)


def codes(prim: Prim, name: str) -> dict[float, NDArray[np.float64]]:
    """Return the values of an attribute by its time codes."""
    found = re.findall(r"([\d.]+): (\([^)]*\)|\[.*?\])(?=,| )", prim.values[f"{name}.timeSamples"])
    return {float(code): np.array(re.findall(r"[-+.\deE]+", value), np.float64)
            for code, value in found}  # fmt: skip


def test_what_moves_has_a_sample_each_time(scene: ExportedScene) -> None:
    motion = scene.motion
    assert motion is not None
    np.testing.assert_allclose(motion.times_s, np.arange(SAMPLES) / RATE_HZ, atol=1e-9)
    ball = scene.by_name["ball"].instance.id
    assert set(motion.bodies) == {ball}
    assert set(motion.cameras) == {"eye"}
    heights = [pose.position_m[2] for pose in motion.bodies[ball]]
    # Steps of 1/240 s: velocity first, then place.
    steps = np.arange(SAMPLES) * 20
    expected = 2.0 - 9.81 * steps * (steps + 1) / 2.0 / 240.0**2
    np.testing.assert_allclose(heights, expected, atol=2e-3)


def test_usd_has_it_by_time_codes(scene: ExportedScene) -> None:
    layer, prims = read_usda(write_usda(scene, "moving_usda").data)
    assert (layer["startTimeCode"], layer["endTimeCode"]) == ("0", "6")
    assert layer["timeCodesPerSecond"] == "12"
    motion = scene.motion
    assert motion is not None
    (poses,) = motion.bodies.values()
    ball = prims["/moving/Objects/ball"]
    places, turns = codes(ball, "xformOp:translate"), codes(ball, "xformOp:orient")
    assert list(places) == list(turns) == [float(k) for k in range(SAMPLES)]
    for pose, place, turn in zip(poses, places.values(), turns.values(), strict=True):
        np.testing.assert_allclose(place, pose.position_m, rtol=1e-12)
        np.testing.assert_allclose(turn[[1, 2, 3, 0]], pose.orientation_xyzw, atol=1e-12)
    assert ball.values["physics:kinematicEnabled"] == "1"
    assert "xformOp:translate.timeSamples" not in prims["/moving/Objects/box"].values
    assert "xformOp:translate.timeSamples" in prims["/moving/Cameras/eye"].values


def test_gltf_has_it_as_an_animation(scene: ExportedScene) -> None:
    glb = Glb(write_glb(scene, "").data)
    (animation,) = glb.tree["animations"]
    motion = scene.motion
    assert motion is not None
    (poses,) = motion.bodies.values()
    names = [node["name"] for node in glb.tree["nodes"]]
    told = {(names[channel["target"]["node"]], channel["target"]["path"]): channel["sampler"]
            for channel in animation["channels"]}  # fmt: skip
    assert set(told) == {(name, way) for name in ("ball", "eye")
                         for way in ("translation", "rotation")}  # fmt: skip
    own = [animation["samplers"][told["ball", way]] for way in ("translation", "rotation")]
    np.testing.assert_allclose(glb.array(own[0]["input"])[:, 0], motion.times_s, atol=1e-6)
    places, turns = (glb.array(one["output"]) for one in own)
    for pose, place, turn in zip(poses, places, turns, strict=True):
        np.testing.assert_allclose(WORLD_FROM_FILE @ place, pose.position_m, atol=1e-6)
        found = WORLD_FROM_FILE @ Rotation.from_quat(turn).as_matrix() @ WORLD_FROM_FILE.T
        np.testing.assert_allclose(found, pose.matrix()[:3, :3], atol=1e-6)
    assert ((turns[1:] * turns[:-1]).sum(axis=1) > 0.0).all()


def test_shapes_are_morph_targets_and_time_samples(scene: ExportedScene) -> None:
    """The box is taken for what deforms: it grows from sample to sample."""
    motion, box = scene.motion, scene.by_name["box"]
    assert motion is not None
    mesh = box.pieces[0].parts[0].mesh
    shapes = [(mesh.positions * np.float32(1 + k), mesh.normals) for k in range(SAMPLES)]
    model = Model(name="box", parts=box.pieces[0].parts)
    grown = {box.instance.id: tuple(Deformation.of(model, [one]).meshes for one in shapes)}
    moved = dataclasses.replace(scene, motion=dataclasses.replace(motion, meshes=grown))
    glb = Glb(write_glb(moved, "").data)
    (primitive,) = glb.tree["meshes"][glb.nodes["box"]["mesh"]]["primitives"]
    rest = glb.array(primitive["attributes"]["POSITION"])
    for k, target in enumerate(primitive["targets"]):
        np.testing.assert_allclose(glb.array(target["POSITION"]), k * rest, atol=1e-6)
        assert not glb.array(target["NORMAL"]).any()
    (animation,) = glb.tree["animations"]
    (weights,) = (one for one in animation["channels"] if one["target"]["path"] == "weights")
    output = glb.array(animation["samplers"][weights["sampler"]]["output"])
    np.testing.assert_array_equal(output.reshape(SAMPLES, SAMPLES), np.eye(SAMPLES))
    _, prims = read_usda(write_usda(moved, "moving_usda").data)
    (path,) = (name for name in prims if name.startswith("/moving/Objects/box/geometry/"))
    points = codes(prims[path], "points")
    first = prims[path].numbers("points")
    for code, values in points.items():
        np.testing.assert_allclose(values, (1.0 + code) * first, rtol=1e-5)


def test_frames_tell_the_motion_too(path: Path, tmp_path: Path) -> None:
    with Simulation(path, mode="lockstep") as simulation:
        frames = []
        for _ in range(3):
            frames.append(simulation.capture("depth", agent="eye"))
            simulation.step(20)
    report = export_scene(path, tmp_path / "told.usda", frames=frames, rate_hz=12.0)
    _, prims = read_usda(report.file.read_bytes())
    found = codes(prims["/moving/Objects/ball"], "xformOp:translate")
    for frame, place in zip(frames, found.values(), strict=True):
        assert frame.states is not None
        (row,) = np.flatnonzero(frame.states.ids == frame.objects.ids[0])
        np.testing.assert_allclose(place, frame.states.positions[row])
    eye = prims["/moving/Cameras/eye"].values
    assert "xformOp:translate.timeSamples" in eye


def test_other_formats_say_that_they_lost_it(path: Path, tmp_path: Path) -> None:
    report = export_scene(path, tmp_path / "moving.xml", duration_s=0.2)
    assert ".xml has no motion; the first moment was written" in report.losses


@pytest.mark.parametrize(
    ("changed", "match"),
    [
        ({"duration_s": 0.01}, "number of samples"),
        ({"duration_s": 400.0, "rate_hz": 240.0}, "number of samples"),
        ({"rate_hz": 0.0}, "rate_hz"),
        ({"duration_s": -1.0}, "duration_s"),
    ],
)
def test_what_is_no_motion_is_refused(
    changed: dict[str, float], match: str, path: Path, tmp_path: Path
) -> None:
    with pytest.raises(InvalidRequest, match=match):
        export_scene(path, tmp_path / "none.usda", **changed)  # type: ignore[arg-type]
    assert not list(tmp_path.iterdir())


def test_moments_ascend(path: Path) -> None:
    eye = AgentSpec(name="own", following=False, views=("depth",))
    with Simulation(path, mode="lockstep", agent=eye) as simulation:
        frame = simulation.capture(agent="own")
        with pytest.raises(InvalidRequest, match="ascending"):
            export_scene(simulation, path.with_suffix(".glb"), frames=[frame, frame])
    with pytest.raises(InvalidRequest, match="number of samples"):
        motion_of([], [], 24.0)
