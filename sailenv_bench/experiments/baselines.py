"""Other renderers on our scenes' geometry: PyBullet's two and MuJoCo's, beside our own.

A scene's name in, something that draws one frame after another out. Each is made and used in a
process of its own, so that no two share an OpenGL context or a cache.
"""

from __future__ import annotations

import importlib.util
import itertools
import os
import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol

import numpy as np
from scipy.spatial.transform import Rotation

from sailenv_bench.experiments.bullet_bodies import BulletBodies
from sailenv_ros.errors import PhysicsError
from sailenv_ros.extras import need
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.selection import make_backend
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.model import Material
from sailenv_ros.types.snapshot import Observation, SceneContents, WorldSnapshot
from sailenv_ros.types.views import FIVE_VIEWS
from sailenv_ros.world.bullet import BulletClient

__all__ = ["BASELINES", "BaselineScene", "Picture"]

COMMON = ("rgb", "depth", "instance")
"""Views that every renderer here can draw."""


class Picture(Protocol):
    """Draws what a camera sees."""

    def prepare(self, snapshot: WorldSnapshot, camera: Camera) -> None:
        """Put everything in its place; not timed."""

    def draw(self) -> None:
        """Draw once; timed."""

    def close(self) -> None:
        """Free it."""


class BaselineScene:
    """A world in motion, and its camera on rails.

    Parameters
    ----------
    scene : str
    width, height : int
        Of the pictures [px].
    """

    def __init__(self, scene: str, width: int, height: int) -> None:
        self._world = SceneLibrary().build(scene)
        self._mover = next(iter(self._world.movers.values()))
        self._lens = CameraIntrinsics(width=width, height=height)

    def advance(self, steps: int) -> tuple[WorldSnapshot, Camera]:
        """Step physics; return what is there then, and who sees it."""
        self._world.step(steps)
        pose = self._mover.pose_at(self._world.sim_time_ns)
        return self._world.snapshot(), Camera(intrinsics=self._lens, pose=pose)

    def close(self) -> None:
        """Free the world."""
        self._world.close()


class _Ours:
    def __init__(self, views: Sequence[str]) -> None:
        self._views = tuple(views)
        self._renderer = make_backend("auto", None)
        self._past: Observation | None = None
        self._now: tuple[WorldSnapshot, Camera] | None = None

    def prepare(self, snapshot: WorldSnapshot, camera: Camera) -> None:
        self._now = (snapshot, camera)

    def draw(self) -> None:
        assert self._now is not None
        snapshot, camera = self._now
        rendered = self._renderer.render(RenderRequest(snapshot, camera, self._views, self._past))
        self._past = Observation(snapshot=snapshot, camera=camera, depth=rendered.depth)

    def close(self) -> None:
        self._renderer.close()


class _FileBodies(BulletBodies):
    """The same bodies through Wavefront files: PyBullet's OpenGL knows no meshes in memory."""

    def __init__(self, client: BulletClient) -> None:
        super().__init__(client)
        self._folder = tempfile.TemporaryDirectory(prefix="sailenv-baselines-")
        self._files = itertools.count()
        self._bullet = client

    def close(self) -> None:
        """Remove the files."""
        self._folder.cleanup()

    def _body(self, arrays: dict[str, Any], material: Material) -> int:
        path = Path(self._folder.name) / f"{next(self._files)}.obj"
        path.write_text(_wavefront(arrays), encoding="ascii")
        create = self._bullet.createVisualShape
        shape = create(
            self._bullet.constants.GEOM_MESH,
            fileName=str(path),
            rgbaColor=_rgba(material),
        )
        body: int = self._bullet.createMultiBody(baseMass=0.0, baseVisualShapeIndex=shape)
        if material.base_colour_texture is not None:
            texture = self._texture(material.base_colour_texture)
            self._bullet.changeVisualShape(body, -1, textureUniqueId=texture)
        return body


def _wavefront(arrays: Mapping[str, Any]) -> str:
    lines = []
    for word, key in (("v", "vertices"), ("vt", "uvs"), ("vn", "normals")):
        lines += [f"{word} " + " ".join(f"{x:.6g}" for x in row) for row in arrays[key]]
    faces = np.asarray(arrays["indices"]).reshape(-1, 3) + 1
    lines += ["f " + " ".join(f"{n}/{n}/{n}" for n in face) for face in faces.tolist()]
    return "\n".join(lines) + "\n"


class _Bullet:
    """`getCameraImage`: colour, depth and segmentation at once, without shadows."""

    def __init__(self, *, opengl: bool) -> None:
        self._client = BulletClient()
        if opengl:
            plugin = importlib.util.find_spec("eglRenderer")
            loaded = -1
            if plugin is not None:
                loaded = self._client.loadPlugin(plugin.origin, "_eglRendererPlugin")
            if loaded < 0:
                self._client.close()
                raise PhysicsError("PyBullet's plugin eglRenderer could not be loaded here")
        self._bodies = _FileBodies(self._client) if opengl else BulletBodies(self._client)
        names = self._client.constants
        self._number = names.ER_BULLET_HARDWARE_OPENGL if opengl else names.ER_TINY_RENDERER
        self._lens = CameraIntrinsics()

    def prepare(self, snapshot: WorldSnapshot, camera: Camera) -> None:
        self._bodies.show(snapshot.contents)
        self._bodies.place(snapshot, camera.camera_from_world)
        self._lens = camera.intrinsics

    def draw(self) -> None:
        lens = self._lens
        projection = self._client.constants.computeProjectionMatrixFOV(
            lens.vertical_fov_deg, lens.width / lens.height, lens.near_m, lens.far_m
        )
        self._client.getCameraImage(
            lens.width,
            lens.height,
            viewMatrix=(1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1),
            projectionMatrix=projection,
            renderer=self._number,
            shadow=0,
        )

    def close(self) -> None:
        self._client.close()
        if isinstance(self._bodies, _FileBodies):
            self._bodies.close()


class _Mujoco:
    """MuJoCo's renderer: colour with shadows, depth and segmentation, one after another.

    Materials have their colours but no textures. Bodies are driven; no physics is simulated.
    """

    def __init__(self) -> None:
        os.environ.setdefault("MUJOCO_GL", "egl")
        os.environ.setdefault("PYOPENGL_PLATFORM", "egl")
        self._mujoco = need("mujoco", "MuJoCo's renderer")
        self._contents: SceneContents | None = None
        self._renderer: Any = None

    def prepare(self, snapshot: WorldSnapshot, camera: Camera) -> None:
        if snapshot.contents is not self._contents:
            self._build(snapshot, camera.intrinsics)
        rotations = Rotation.from_matrix(snapshot.world_from_body[:, :3, :3])
        self._data.mocap_pos[:] = snapshot.world_from_body[:, :3, 3]
        self._data.mocap_quat[:] = rotations.as_quat(scalar_first=True)
        # MuJoCo's cameras look along -z with y up.
        turn = camera.world_from_camera[:3, :3] @ np.diag([1.0, -1.0, -1.0])
        self._model.cam_pos[0] = camera.world_from_camera[:3, 3]
        self._model.cam_quat[0] = Rotation.from_matrix(turn).as_quat(scalar_first=True)
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_camlight(self._model, self._data)

    def draw(self) -> None:
        renderer = self._renderer
        renderer.update_scene(self._data, camera=0)
        renderer.render()
        renderer.enable_depth_rendering()
        renderer.render()
        renderer.disable_depth_rendering()
        renderer.enable_segmentation_rendering()
        renderer.render()
        renderer.disable_segmentation_rendering()

    def close(self) -> None:
        if self._renderer is not None:
            self._renderer.close()

    def _build(self, snapshot: WorldSnapshot, lens: CameraIntrinsics) -> None:
        mujoco = self._mujoco
        spec = mujoco.MjSpec()
        spec.visual.global_.offwidth, spec.visual.global_.offheight = lens.width, lens.height
        spec.visual.map.znear, spec.visual.map.zfar = lens.near_m, lens.far_m
        spec.stat.extent = 1.0
        spec.worldbody.add_camera(name="eye", fovy=lens.vertical_fov_deg)
        spec.worldbody.add_light(pos=[0, 0, 6], dir=[0.3, 0.2, -1])
        known: dict[tuple[int, tuple[float, ...]], list[tuple[str, list[float]]]] = {}
        for number, drawn in enumerate(snapshot.contents.instances):
            key = (id(drawn.model), tuple(drawn.scale))
            if key not in known:
                known[key] = [
                    (
                        self._mesh(spec, f"{number}_{n}", part.mesh, drawn.scale),
                        _rgba(part.material),
                    )
                    for n, part in enumerate(drawn.model.parts)
                    if part.material.alpha != "blend" and len(part.mesh.positions) >= 4
                ]
            body = spec.worldbody.add_body(name=f"body_{number}", mocap=True)
            for name, rgba in known[key]:
                body.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_MESH,
                    meshname=name,
                    rgba=rgba,
                    contype=0,
                    conaffinity=0,
                )
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._renderer = mujoco.Renderer(
            self._model, lens.height, lens.width, max_geom=4 * self._model.ngeom + 100
        )
        self._contents = snapshot.contents

    def _mesh(self, spec: Any, name: str, mesh: Any, scale: tuple[float, float, float]) -> str:
        made = spec.add_mesh(name=name)
        made.uservert = (mesh.positions * np.asarray(scale, np.float32)).reshape(-1)
        made.userface = mesh.triangles.astype(np.int32).reshape(-1)
        made.inertia = self._mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        return name


def _rgba(material: Material) -> list[float]:
    linear = np.clip(np.asarray(material.base_colour[:3]), 0.0, 1.0)
    return [*(linear ** (1 / 2.2)).tolist(), 1.0]


BASELINES: Mapping[str, tuple[str, Callable[[], Picture]]] = MappingProxyType(
    {
        "sailenv_ros": (
            "picture with light and shadows, depth, instance",
            lambda: _Ours(COMMON),
        ),
        "sailenv_ros, five views": (
            "and category and flow",
            lambda: _Ours(FIVE_VIEWS),
        ),
        "PyBullet TinyRenderer": (
            "picture without shadows, depth, segmentation; on the CPU",
            lambda: _Bullet(opengl=False),
        ),
        "PyBullet OpenGL": (
            "picture without shadows, depth, segmentation",
            lambda: _Bullet(opengl=True),
        ),
        "MuJoCo": (
            "picture with shadows, without textures, depth, segmentation",
            _Mujoco,
        ),
    }
)
"""Description and constructor of each baseline, by name."""
