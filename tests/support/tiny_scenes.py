"""Scenes of a few solids made in code, and snapshots of them at chosen poses and times."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import Category, CategoryTable, Instance
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Material, Mesh, Model, ModelPart
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents, WorldSnapshot

CATEGORIES = CategoryTable(
    [
        Category(id=number, name=f"kind {number}", colour=(number, 2 * number, 255 - number))
        for number in range(1, 60)
    ]
)

FORWARD = Pose()
"""At the origin, looking along world x."""

FRAME_NS = 50_000_000
"""Time between the two snapshots of a motion test: 1/20 s, that is 12 steps."""


def mesh_of(positions: ArrayLike, normals: ArrayLike, uvs: ArrayLike, triangles: ArrayLike) -> Mesh:
    """A mesh from anything that NumPy understands."""
    return Mesh(
        positions=np.asarray(positions, np.float32),
        normals=np.asarray(normals, np.float32),
        uvs=np.asarray(uvs, np.float32),
        triangles=np.asarray(triangles, np.uint32),
    )


def model_of(mesh: Mesh, **material: Any) -> Model:
    """A model of one mesh."""
    return Model(name="test", parts=(ModelPart(mesh=mesh, material=Material(**material)),))


def wall_mesh(width: float = 1.0, height: float = 1.0) -> Mesh:
    """A rectangle in the plane x = 0 that faces -x: a camera that looks along x sees it.

    Its uv's u grows to the right and its v upwards, as seen from there.
    """
    y, z = 0.5 * width, 0.5 * height
    corners = [(0, y, -z), (0, -y, -z), (0, -y, z), (0, y, z)]
    return mesh_of(
        corners, [(-1, 0, 0)] * 4, [(0, 0), (1, 0), (1, 1), (0, 1)], [(0, 1, 2), (0, 2, 3)]
    )


def box_mesh(size: float | Sequence[float] = 1.0) -> Mesh:
    """A box around the origin with flat faces."""
    half = 0.5 * np.broadcast_to(np.asarray(size, float), 3)
    positions: list[NDArray[np.float64]] = []
    normals, uvs, triangles = [], [], []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            normal = np.zeros(3)
            normal[axis] = sign
            right = np.roll(normal, 1)
            up = np.cross(normal, right)
            first = len(positions)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                positions.append((normal + a * right + b * up) * half)
                normals.append(normal)
                uvs.append(((a + 1) / 2, (b + 1) / 2))
            triangles += [(first, first + 1, first + 2), (first, first + 2, first + 3)]
    return mesh_of(positions, normals, uvs, triangles)


def disc_mesh(radius: float, segments: int = 256) -> Mesh:
    """A disc in the plane x = 0 that faces -x."""
    angles = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    rim = np.stack([0 * angles, -radius * np.cos(angles), radius * np.sin(angles)], axis=1)
    positions = np.concatenate([[[0.0, 0.0, 0.0]], rim])
    triangles = [(0, 1 + i, 1 + (i + 1) % segments) for i in range(segments)]
    return mesh_of(
        positions, [(-1, 0, 0)] * len(positions), np.zeros((len(positions), 2)), triangles
    )


def checker(cells: int = 8, size: int = 256) -> np.ndarray[Any, np.dtype[np.uint8]]:
    """A smooth colourful pattern without symmetry: every place can be told from its neighbours."""
    v, u = np.mgrid[0:size, 0:size] / size
    red = 0.5 + 0.5 * np.sin(2 * np.pi * cells * u)
    green = 0.5 + 0.5 * np.sin(2 * np.pi * cells * v + 1.0)
    blue = 0.5 + 0.5 * np.sin(2 * np.pi * cells * (u + 0.7 * v))
    picture = np.stack([red, green, blue, np.ones_like(u)], axis=-1)
    return (255 * (0.1 + 0.8 * picture)).astype(np.uint8)


@dataclass(frozen=True)
class Thing:
    """A model at a pose."""

    model: Model
    pose: Pose = field(default_factory=Pose)
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    category_id: int = 1
    lit_by: tuple[str, ...] = ()


SUN = Light(name="sun", type="directional", direction=(0.6, -0.3, -0.75), intensity=2.5)


def contents_of(
    things: Sequence[Thing], *, epoch: int = 1, first_id: int = 1, **kwargs: Any
) -> SceneContents:
    """Contents with instance ids from `first_id` on, in order."""
    drawn = tuple(
        DrawnInstance(
            instance=Instance(
                id=first_id + row,
                name=f"thing {row}",
                asset="test",
                category_id=thing.category_id,
                category=CATEGORIES[thing.category_id].name,
                static=False,
            ),
            model=thing.model,
            scale=thing.scale,
            lit_by=thing.lit_by,
        )
        for row, thing in enumerate(things)
    )
    kwargs.setdefault("lights", (SUN,))
    kwargs.setdefault("environment", Environment())
    return SceneContents(
        scene="tiny", epoch=epoch, revision=1, instances=drawn, categories=CATEGORIES, **kwargs
    )


def snapshot_of(
    things: Sequence[Thing],
    *,
    time_ns: int = 0,
    contents: SceneContents | None = None,
    histories: Sequence[int] | None = None,
    **kwargs: Any,
) -> WorldSnapshot:
    """A snapshot of things where they are."""
    poses = [thing.pose.matrix() for thing in things]
    return WorldSnapshot(
        sim_time_ns=time_ns,
        step=round(time_ns * 240 / 1e9),
        contents=contents or contents_of(things, **kwargs),
        world_from_body=np.stack(poses) if poses else np.zeros((0, 4, 4)),
        histories=np.asarray(histories or [1] * len(things), dtype=np.int64),
    )


def moved(things: Sequence[Thing], *poses: Pose) -> list[Thing]:
    """The same things at other poses."""
    return [replace(thing, pose=pose) for thing, pose in zip(things, poses, strict=True)]


def camera_at(pose: Pose = FORWARD, **intrinsics: Any) -> Camera:
    """A camera of 96 x 72 pixels unless said otherwise."""
    intrinsics.setdefault("width", 96)
    intrinsics.setdefault("height", 72)
    return Camera(intrinsics=CameraIntrinsics(**intrinsics), pose=pose)


def two_instants() -> tuple[WorldSnapshot, WorldSnapshot, Camera, Camera]:
    """Many textured things that move, before and after, and a camera that does."""
    skin = {"base_colour_texture": checker(3)}
    box = model_of(box_mesh(0.5), **skin)
    things = [Thing(model_of(wall_mesh(30.0, 30.0), **skin), Pose((9.0, 0.0, 0.0)))]
    ends = [things[0].pose]
    for i in range(9):
        place = (3.0 + 0.3 * i, i - 4.0, 0.2 * i - 1.0)
        things.append(Thing(box, Pose.from_rpy_deg(place, (7 * i, 11 * i, 13 * i))))
        ends.append(Pose.from_rpy_deg(np.add(place, 0.02), (7 * i, 11 * i + 2, 13 * i - 3)))
    contents = contents_of(things)
    before = snapshot_of(things, contents=contents)
    after = snapshot_of(moved(things, *ends), contents=contents, time_ns=FRAME_NS)
    now = camera_at(Pose.from_rpy_deg((0.0, 0.05, 0.0), (1, 2, 3)), width=203, height=151)
    return before, after, camera_at(width=203, height=151), now


def white_furnace() -> WorldSnapshot:
    """A white box before a white wall, in uniform light."""
    grey = (0.3, 0.3, 0.3)
    uniform = Environment(sky_zenith=grey, sky_horizon=grey, sky_ground=grey)
    white = {"base_colour": (1, 1, 1, 1), "roughness": 1.0}
    things = [
        Thing(model_of(wall_mesh(60, 60), **white), Pose((3.0, 0, 0))),
        Thing(model_of(box_mesh(0.7), **white), Pose.from_rpy_deg((2.7, 0, 0), (20, 30, 40))),
    ]
    return snapshot_of(things, lights=(), environment=uniform)
