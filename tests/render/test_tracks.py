"""Tracks against arithmetic in double precision, and their visibility against Embree's rays."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene
from numpy.typing import NDArray

from sailenv_bench.experiments.flow_accuracy import EYE, STEPS, begin_scenario, flow_test_scene
from sailenv_bench.experiments.flow_scenes import SCENARIOS
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion import ObjectPoints, SceneGeometry, Tracks, track
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.snapshot import SceneContents

SIZE = (96, 72)


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with flow_test_scene(*SIZE) as opened:
        yield opened


def embree_sees(contents: SceneContents, frame: Frame, points: NDArray[Any]) -> NDArray[Any]:
    """Return (N,) what Embree meets on the way to points in the world: 1 them, 0 others, -1 unsure.

    Rays go through the point and four places half a pixel beside it: at edges they disagree.
    """
    assert frame.states is not None
    corners, ids = [], []
    eye = frame.camera.world_from_camera[:3, 3]
    for drawn in contents.instances:
        row = frame.states.row(drawn.instance.id)
        matrix = frame.states.matrices[row]
        for part in drawn.model.parts:
            if part.material.alpha != "opaque":
                continue
            world = part.mesh.positions.astype(np.float64) * drawn.scale
            world = (world @ matrix[:3, :3].T + matrix[:3, 3])[part.mesh.triangles]
            normal = np.cross(world[:, 1] - world[:, 0], world[:, 2] - world[:, 0])
            faces = np.einsum("nx,nx->n", eye - world[:, 0], normal) > 0.0
            corners.append(world[faces | part.material.double_sided])
            ids.append(np.full(len(corners[-1]), drawn.instance.id))
    scene = EmbreeScene()
    mesh = TriangleMesh(scene, np.concatenate(corners).astype(np.float32))
    owner = np.concatenate(ids)
    right, down = frame.camera.world_from_camera[:3, :2].T
    depth = (points - eye) @ frame.camera.world_from_camera[:3, 2]
    beside = 0.5 * depth[:, None] / frame.camera.intrinsics.fx
    answers = []
    for a, b in ((0, 0), (1, 0), (-1, 0), (0, 1), (0, -1)):
        towards = points + beside * (a * right + b * down)
        origins = np.broadcast_to(eye, towards.shape).astype(np.float32)
        hit = scene.run(origins, (towards - eye).astype(np.float32), output=1)
        answers.append((np.where(hit["primID"] >= 0, owner[hit["primID"]], 0), hit["tfar"]))
    del mesh
    met = np.array([ids for ids, _ in answers])
    far = np.array([distance for _, distance in answers])
    # A step from one surface to another of the same instance is an edge, too.
    sure = (met == met[0]).all(axis=0) & (np.ptp(far, axis=0) < 0.05)
    return np.where(sure, np.where(np.abs(far[0] - 1.0) < 1e-4, met[0], 0), -1)


def compare_with_embree(
    contents: SceneContents, frames: list[Frame], tracks: Tracks, step: int = 1
) -> int:
    """Hold visibility against Embree, every few frames; return how many points were compared."""
    compared = 0
    for number, frame in list(enumerate(frames))[::step]:
        rows = np.flatnonzero(tracks.in_view[:, number])
        met = embree_sees(contents, frame, tracks.positions[rows, number])
        sure = met >= 0
        visible = met == tracks.instances[rows]
        assert (visible == tracks.visible[rows, number])[sure].all()
        compared += int(sure.sum())
    return compared


def grid(number: int, width: int, height: int, step: int) -> NDArray[Any]:
    columns, rows = np.meshgrid(np.arange(1, width, step), np.arange(1, height, step))
    return np.stack([np.full(columns.size, number), columns.ravel(), rows.ravel()], axis=1)


@pytest.mark.gl
@pytest.mark.parametrize("name", SCENARIOS)
def test_tracks_are_the_arithmetic_s(simulation: Simulation, name: str) -> None:
    """Places to 0.01 px from poses that physics told, visibility as Embree says, in 33 frames."""
    boxes = begin_scenario(simulation, SCENARIOS[name])
    frames, poses = [], []
    for _ in range(33):
        frames.append(simulation.capture(("depth",), agent=EYE))
        poses.append([simulation.get_object(box.instance_id).pose.matrix() for box in boxes])
        simulation.step(STEPS)
    geometry = SceneGeometry.of_contents(simulation.contents)
    queries = np.concatenate([grid(0, *SIZE, 6), grid(20, *SIZE, 9)])
    tracks = track(queries, frames, geometry)
    assert tracks.visible.shape == (len(queries), 33)
    own = tracks.instances > 0
    asked = queries[:, 0].astype(int)
    assert tracks.visible[own, asked[own]].all()
    np.testing.assert_allclose(
        tracks.pixels[own, asked[own]], queries[own, 1:], rtol=0.0, atol=1e-9
    )
    for index, box in enumerate(boxes):
        rows = tracks.instances == box.instance_id
        for number, frame in enumerate(frames):
            matrix = poses[number][index]
            world = tracks.coords[rows] @ matrix[:3, :3].T + matrix[:3, 3]
            camera = frame.camera.camera_from_world
            pixels = frame.camera.intrinsics.project(world @ camera[:3, :3].T + camera[:3, 3])
            np.testing.assert_allclose(tracks.pixels[rows, number], pixels, atol=1e-9)
            np.testing.assert_allclose(tracks.positions[rows, number], world, atol=1e-12)
    compared = compare_with_embree(simulation.contents, frames, tracks, step=8)
    assert compared > 0.5 * tracks.in_view[:, ::8].sum()
    again = ObjectPoints(tracks.instances[own], tracks.coords[own])
    same = track(again, frames, geometry)
    np.testing.assert_array_equal(same.visible, tracks.visible[own])
    np.testing.assert_array_equal(same.pixels, tracks.pixels[own])


@pytest.mark.gl
def test_visibility_in_a_furnished_room_is_embree_s() -> None:
    """Behind furniture, out of view and back, while the camera goes around a table."""
    spec = AgentSpec(
        name="eye", intrinsics=CameraIntrinsics(width=160, height=120), following=False, rate_hz=0.0
    )
    with Simulation("room_02", mode="lockstep", agent=spec) as simulation:
        frames = []
        for angle in np.linspace(0.0, 2.0, 12):
            place = (1.2 * np.cos(angle), 1.2 * np.sin(angle), 1.5)
            simulation.set_pose(look_at(place, (0.0, 0.0, 0.4)), agent="eye")
            simulation.step(8)
            frames.append(simulation.capture(("depth", "instance"), agent="eye"))
        contents = simulation.contents
    geometry = SceneGeometry.of_contents(contents)
    queries = np.concatenate([grid(0, 160, 120, 5), grid(11, 160, 120, 7)])
    tracks = track(queries, frames, geometry)
    # What a pixel shows is what its ray meets: the same as the rasteriser's but for edges.
    for number in (0, 11):
        chosen = queries[:, 0] == number
        columns, rows = queries[chosen, 1:].astype(int).T
        shown = frames[number]["instance"][rows, columns]
        assert (shown == tracks.instances[chosen]).mean() > 0.99
    assert compare_with_embree(contents, frames, tracks) > 5000
    hidden = tracks.in_view & ~tracks.visible
    assert hidden.any()
    came_back = tracks.visible[:, :-2] & hidden[:, 1:-1] & tracks.visible[:, 2:]
    assert came_back.any() or (tracks.visible.any(axis=1) & hidden.any(axis=1)).any()


@pytest.mark.gl
def test_what_cannot_be_tracked_is_refused_in_words(simulation: Simulation) -> None:
    """Pixels beside the picture, frames that there are not, unknown instances, no frames."""
    begin_scenario(simulation, SCENARIOS["uniform"])
    frame = simulation.capture(("depth",), agent=EYE)
    geometry = SceneGeometry.of_contents(simulation.contents)
    for points, why in (
        ([[0, 200.0, 3.0]], "within the picture"),
        ([[1, 3.0, 3.0]], "0 to 0"),
        ([[0.5, 3.0, 3.0]], "0 to 0"),
        ([3.0, 3.0], r"rows \(number"),
        (ObjectPoints([999], [[0.0, 0.0, 0.0]]), "the id of an instance in one of the frames"),
        (ObjectPoints([1, 2], [[0.0, 0.0, 0.0]]), r"instances \(N,\)"),
    ):
        with pytest.raises(InvalidRequest, match=why):
            track(points, [frame], geometry)
    with pytest.raises(InvalidRequest, match="at least one"):
        track([[0, 1.0, 1.0]], [], geometry)
    with pytest.raises(InvalidRequest, match="among those of the geometry"):
        track([[0, 1.0, 1.0]], [frame], SceneGeometry({}))
