"""One scene, with turned and scaled instances, cut-outs and glass: each way of casting rays at it
finds what arithmetic finds that holds every ray against every triangle.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sailenv_ros.rays.light_rays import RayScene
from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.rays.static_geometry import static_geometry_of
from sailenv_ros.types.geometry import Pose, quat_xyzw_from_rpy_deg
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.model import Model
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support import reference_rays
from tests.support.bake_scenes import ground, hollow, still
from tests.support.tiny_scenes import Thing, box_mesh, model_of, wall_mesh

RAYS = 3000
ALONE = np.eye(4)[None, :3], np.zeros(1, np.int32)


def striped(opaque: int) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """A picture of eight columns, of which some have a surface."""
    texels = np.full((8, 8, 4), 255, np.uint8)
    texels[:, opaque:, 3] = 0
    return texels


def sheet(opaque: int) -> Model:
    """A square with holes, seen from both sides."""
    look = {"base_colour_texture": striped(opaque), "alpha": "mask", "double_sided": True}
    return ground(1.5, **look)


def things() -> list[Thing]:
    """A closed room with something of every kind."""
    turned = Pose((0.6, 0.9, -0.2), quat_xyzw_from_rpy_deg((23, 52, 11)))
    glass = model_of(wall_mesh(2.0, 2.0), alpha="blend", base_colour=(1.0, 1.0, 1.0, 0.25))
    return [
        Thing(hollow((6.0, 6.0, 3.0))),
        Thing(model_of(box_mesh(0.7)), turned, (1.0, 2.0, 0.5)),
        Thing(model_of(box_mesh(0.7)), Pose((-1.2, 0.3, 0.4))),
        Thing(sheet(7), Pose((0.2, -1.4, -0.6), quat_xyzw_from_rpy_deg((29, 0, 17)))),
        Thing(sheet(1), Pose((-0.8, -1.0, 0.7), quat_xyzw_from_rpy_deg((0, 34, 0)))),
        Thing(glass, Pose((1.7, 0.0, 0.0))),
    ]


def states() -> InstanceStates:
    """Return where the things are."""
    every = things()
    return InstanceStates(
        ids=np.arange(1, len(every) + 1, dtype=np.uint16),
        positions=np.array([thing.pose.position_m for thing in every]),
        orientations=np.array([thing.pose.orientation_xyzw for thing in every]),
        linear_velocities=np.zeros((len(every), 3)),
        angular_velocities=np.zeros((len(every), 3)),
        scales=np.array([thing.scale for thing in every]),
    )


def rays_in_it() -> tuple[np.ndarray, np.ndarray]:
    """Rays from everywhere to everywhere."""
    rng = np.random.default_rng(8)
    origins = rng.uniform(-1.0, 1.0, (RAYS, 3)) * (2.9, 2.9, 1.4)
    return origins, rng.normal(size=(RAYS, 3)) * rng.uniform(0.1, 3.0, (RAYS, 1))


def triangles(snapshot: WorldSnapshot, row: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of one instance's triangles in the world, and their uvs."""
    drawn, pose = snapshot.contents.instances[row], snapshot.world_from_body[row]
    (part,) = drawn.model.parts
    points = part.mesh.positions.astype(np.float64) * drawn.scale
    world = points @ pose[:3, :3].T + pose[:3, 3]
    return world[part.mesh.triangles], part.mesh.uvs[part.mesh.triangles].astype(np.float64)


def meet(corners: np.ndarray, both: bool, origins: np.ndarray, directions: np.ndarray) -> Any:
    """Hold rays against triangles."""
    sides = np.full(len(corners), both)
    given = [(corners, sides)], *ALONE, origins, directions, np.zeros(len(origins))
    return reference_rays.cast_rays(*given)


def in_stripes(hits: Any, uvs: np.ndarray, opaque: int) -> np.ndarray:
    """Return where a sheet has a surface, by the column of the texel that was met."""
    second, third = hits.weights.T
    u = uvs[hits.triangle, :, 0]
    at = u[:, 0] * (1.0 - second - third) + u[:, 1] * second + u[:, 2] * third
    return np.asarray(np.floor(8.0 * at) < opaque)


def test_rays_of_ground_truth_pass_holes_and_glass() -> None:
    """Instance and distance of each ray; the back of what has one side is not there."""
    snapshot, (origins, directions) = still(things()), rays_in_it()
    expected, nearest = np.zeros(RAYS, np.int64), np.full(RAYS, np.inf)
    passed = 0
    for row in range(5):
        corners, uvs = triangles(snapshot, row)
        hits = meet(corners, row in (3, 4), origins, directions)
        distance = hits.distance.copy()
        if row in (3, 4):
            hole = np.isfinite(distance) & ~in_stripes(hits, uvs, {3: 7, 4: 1}[row])
            distance[hole] = np.inf
            passed += int(hole.sum())
        nearer = distance < nearest
        nearest[nearer], expected[nearer] = distance[nearer], row + 1
    assert passed > 30
    assert set(expected.tolist()) == {1, 2, 3, 4, 5}
    geometry = SceneGeometry.of_contents(snapshot.contents)
    got = geometry.cast(states(), origins, directions)
    assert (got.instance == expected).all()
    assert got.distance == pytest.approx(nearest, rel=1e-9)


def test_rays_of_light_take_sheets_as_a_whole() -> None:
    """A sheet of which seven eighths are there stops light, one of one eighth does not."""
    snapshot, (origins, directions) = still(things()), rays_in_it()
    given = origins.astype(np.float32), directions.astype(np.float32)
    parts = [triangles(snapshot, row)[0] for row in (0, 1, 2, 3)]
    expected = meet(np.concatenate(parts), True, *(array.astype(np.float64) for array in given))
    owner = np.repeat([0, 1, 2, 3], [len(part) for part in parts])
    geometry = static_geometry_of(snapshot)
    light = RayScene(geometry)
    got = light.hits(*given)
    met = np.isfinite(expected.distance)
    assert met.all()
    same = geometry.owner[got.triangle] == owner[expected.triangle]
    assert same.mean() > 0.998
    assert got.distance[same] == pytest.approx(expected.distance[same], rel=1e-4)
    lengths = np.full(RAYS, 0.9, np.float32)
    pane = meet(triangles(snapshot, 5)[0], True, *(array.astype(np.float64) for array in given))
    share = np.ones(RAYS)
    cosine = np.abs(directions[:, 0]) / np.linalg.norm(directions, axis=1)
    behind = pane.distance < lengths
    share[behind] = 0.75 * reference_rays.glazing_transmittance(cosine)[behind]
    assert light.transmittance(*given, lengths) == pytest.approx(share, abs=1e-3)
    share[expected.distance < lengths] = 0.0
    assert (np.abs(light.share_that_passes(*given, lengths) - share) < 1e-3).mean() > 0.998
    assert {0.0, 1.0} < set(np.round(share, 6).tolist())
