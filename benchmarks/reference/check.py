"""Check that the renderer, the path tracer and arithmetic agree where light is known exactly.

    python -m benchmarks.reference.check

A square of one material under one light each, and a painted sky: prints linear radiance of the
picture's middle as the renderer drew it, as it was traced, and as a formula says where there is
one. Returns 1 if two of them differ by more than the case allows.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from benchmarks.reference.curve import radiance_of
from benchmarks.reference.parts import Parts
from benchmarks.reference.scene_export import scene_of, sensor
from benchmarks.reference.tracing import HOME, ToolMissing, traced_views
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.labels import CategoryTable, Instance
from sailenv_ros.types.lights import Environment, Light, SkyMap
from sailenv_ros.types.model import Material, Model, ModelPart
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents, WorldSnapshot

SAMPLES = 256
ALBEDO = 0.5
RADIANCE = 0.6
DARK = Environment(background="colour", background_colour=(0.0, 0.0, 0.0), sky_share=0.0)
UNIFORM = Environment(
    sky_zenith=(RADIANCE,) * 3, sky_horizon=(RADIANCE,) * 3, sky_ground=(RADIANCE,) * 3
)
WHITE = (1.0, 1.0, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One light on one square.

    Attributes
    ----------
    expected : float or None
        Radiance of an ideally diffuse square [W/(m² sr)]; None where no formula is at hand.
    tolerance : float
        Largest relative difference between any two of the figures.
    """

    material: Material
    lights: tuple[Light, ...] = ()
    environment: Environment = DARK
    expected: float | None = None
    tolerance: float = 0.06


def cases() -> Mapping[str, Case]:
    """Return all cases by name."""
    grey = Material(base_colour=(ALBEDO, ALBEDO, ALBEDO, 1.0), roughness=1.0)
    white = Material(base_colour=(1.0, 1.0, 1.0, 1.0), roughness=1.0)
    metal = Material(base_colour=(0.7, 0.7, 0.7, 1.0), metallic=1.0, roughness=0.3)
    silver = replace(metal, roughness=0.02)
    diffuse = ALBEDO / math.pi
    slanted, above = np.array([0.3, 0.2, -1.0]), (0.5, 0.3, 2.0)
    sun_cos = 1.0 / float(np.linalg.norm(slanted))
    d2 = float(np.square(above).sum())
    point_cos = above[2] / math.sqrt(d2)
    down = (0.0, 0.0, -1.0)
    sun = Light(name="sun", type="directional", direction=_triple(slanted), intensity=2.0)
    point = Light(name="point", type="point", position_m=above, intensity=5.0)
    spot = Light(
        name="spot", type="spot", position_m=(0.0, 0.0, 2.0), direction=down, intensity=5.0
    )
    area = Light(
        name="area",
        type="area",
        position_m=(0.0, 0.0, 3.0),
        direction=down,
        width_m=0.5,
        height_m=0.4,
        intensity=20.0,
    )
    return {
        "sun": Case(material=grey, lights=(sun,), expected=2.0 * sun_cos * diffuse),
        "point": Case(material=grey, lights=(point,), expected=5.0 * point_cos / d2 * diffuse),
        "spot": Case(material=grey, lights=(spot,), expected=5.0 / 4.0 * diffuse),
        "area": Case(material=grey, lights=(area,), expected=20.0 * 0.2 / 9.0 * diffuse),
        "uniform sky": Case(material=grey, environment=UNIFORM, expected=RADIANCE * ALBEDO),
        "white furnace": Case(
            material=white, environment=UNIFORM, expected=RADIANCE, tolerance=0.08
        ),
        "metal in sky": Case(material=metal, environment=UNIFORM, tolerance=0.08),
        "mirror in sky": Case(material=silver, environment=UNIFORM, expected=0.7 * RADIANCE),
        "bump to x": Case(material=_tilted(0), lights=(sun,), expected=_tilted_light(0, diffuse)),
        "bump to y": Case(material=_tilted(1), lights=(sun,), expected=_tilted_light(1, diffuse)),
    }


def main() -> int:
    """Check all; 0 if they agree."""
    renderer = Renderer()
    wrong = 0
    try:
        print(f"{'':16}{'formula':>9}{'traced':>9}{'ours':>9}")
        for name, case in cases().items():
            wrong += not _agrees(name, case, renderer)
        wrong += not _sky_agrees(renderer)
    except ToolMissing as problem:
        print(problem, file=sys.stderr)
        return 1
    finally:
        renderer.close()
    return 1 if wrong else 0


def _agrees(name: str, case: Case, renderer: Renderer) -> bool:
    contents = _contents(case)
    camera = _camera((0.0, -2.0, 2.5), (0.0, 0.0, 0.0), 4.0)
    snapshot = WorldSnapshot(
        sim_time_ns=0,
        step=0,
        contents=contents,
        world_from_body=np.eye(4)[None],
        histories=np.zeros(1, np.int64),
    )
    drawn, traced = _both(f"check {name}", snapshot, {"middle": camera}, renderer)["middle"]
    figures = [float(drawn.mean()), float(traced.mean())]
    if case.expected is not None:
        figures.append(case.expected)
    spread = max(figures) / min(figures) - 1.0
    formula = "" if case.expected is None else f"{case.expected:.4f}"
    verdict = "ok" if spread <= case.tolerance else f"DIFFER by {spread:.1%}"
    print(f"{name:16}{formula:>9}{figures[1]:9.4f}{figures[0]:9.4f}  {verdict}")
    return spread <= case.tolerance


def _sky_agrees(renderer: Renderer) -> bool:
    """Compare what is seen of a painted sky along the axes, and upwards and downwards."""
    rows, columns = np.mgrid[0:64, 0:128]
    colours = np.stack([(columns + 0.5) / 128, (rows + 0.5) / 64, 0.5 + 0.0 * rows], axis=-1)
    sky = SkyMap(radiance=colours.astype(np.float16), zenith=WHITE, horizon=WHITE, ground=WHITE)
    contents = SceneContents(
        scene="sky",
        epoch=1,
        revision=1,
        instances=(),
        categories=CategoryTable([]),
        environment=Environment(sky=sky, sky_blend=False),
    )
    snapshot = WorldSnapshot(
        sim_time_ns=0,
        step=0,
        contents=contents,
        world_from_body=np.zeros((0, 4, 4)),
        histories=np.zeros(0, np.int64),
    )
    targets = {
        "east and up": (1.0, 0.2, 0.4),
        "north": (0.0, 1.0, 0.1),
        "west": (-1.0, 0.3, 0.0),
        "south and down": (-0.1, -1.0, -0.6),
    }
    cameras = {name: _camera((0.0, 0.0, 0.0), to, 10.0) for name, to in targets.items()}
    good = True
    for name, (drawn, traced) in _both("check sky", snapshot, cameras, renderer).items():
        error = float(np.abs(drawn - traced).max())
        good &= error < 0.02
        seen = [", ".join(f"{v:.2f}" for v in image.mean(axis=(0, 1))) for image in (traced, drawn)]
        verdict = "ok" if error < 0.02 else f"DIFFER by {error:.3f}"
        print(f"sky {name}: traced {seen[0]}; ours {seen[1]}  {verdict}")
    return good


def _both(
    name: str, snapshot: WorldSnapshot, cameras: Mapping[str, Camera], renderer: Renderer
) -> dict[str, tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Return linear radiance as it is drawn and as it is traced, by camera."""
    sensors = {view: sensor(camera) for view, camera in cameras.items()}
    scene = scene_of(snapshot, Parts(HOME / "parts"))
    traced = traced_views(name.replace(" ", "_"), scene, sensors, SAMPLES)
    stops = snapshot.contents.environment.exposure
    result = {}
    for view, camera in cameras.items():
        picture = renderer.render(RenderRequest(snapshot, camera, ("rgb",))).views["rgb"]
        result[view] = (radiance_of(picture, stops), traced[view].raw.astype(np.float64))
    return result


def _contents(case: Case) -> SceneContents:
    mesh = Primitives().load("plane").model.parts[0].mesh
    model = Model(name="square", parts=(ModelPart(mesh=mesh, material=case.material),))
    instance = Instance(
        id=1, name="square", asset="square", category="square", category_id=1, static=True
    )
    return SceneContents(
        scene="check",
        epoch=1,
        revision=1,
        instances=(DrawnInstance(instance=instance, model=model, scale=(100.0, 100.0, 1.0)),),
        categories=CategoryTable([]),
        lights=case.lights,
        environment=case.environment,
    )


def _camera(at: tuple[float, ...], to: tuple[float, ...], fov_deg: float) -> Camera:
    intrinsics = CameraIntrinsics(width=32, height=32, vertical_fov_deg=fov_deg, far_m=1000.0)
    return Camera(intrinsics=intrinsics, pose=look_at(at, to))


def _tilted(axis: int) -> Material:
    """Return a grey material whose normal map tilts it towards +u or +v everywhere."""
    texel = np.full((4, 4, 4), 128, np.uint8)
    texel[..., axis], texel[..., 2] = 204, 230
    return Material(base_colour=(ALBEDO, ALBEDO, ALBEDO, 1.0), roughness=1.0, normal_texture=texel)


def _tilted_light(axis: int, diffuse: float) -> float:
    """Light of the sun on it; the square's u runs along x and its v along y."""
    normal = np.array([0.0, 0.0, 230 / 255 * 2 - 1])
    normal[axis] = 204 / 255 * 2 - 1
    towards = -np.array([0.3, 0.2, -1.0])
    cosine = normal @ towards / np.linalg.norm(normal) / np.linalg.norm(towards)
    return float(2.0 * cosine * diffuse)


def _triple(vector: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


if __name__ == "__main__":
    sys.exit(main())
