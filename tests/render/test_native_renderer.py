"""What only the native renderer promises: equal bytes everywhere, no holes, no crash."""

from __future__ import annotations

import gc
import weakref
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.errors import UnknownName
from sailenv_ros.native.drawing import structure_sizes
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.frame_light import _texels_in_use
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.digests import appearance_digest
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment, Light, SkyMap
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation
from tests.render.test_picture import gallery
from tests.support.allocator import allocations
from tests.support.hostile_scenes import hostile_scenes
from tests.support.ray_cast import cast
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    checker,
    contents_of,
    mesh_of,
    model_of,
    snapshot_of,
    wall_mesh,
)

GREY = (1.0, 1.0, 1.0)

FISHEYE = CameraIntrinsics(
    width=120,
    height=90,
    fx_px=40.0,
    fy_px=40.0,
    distortion_model="equidistant",
    distortion=(0.02, -0.004, 0.001, 0.0),
)

VIEWS = ("rgb", "depth", "category", "instance", "normals", "flow", "flow_valid", "occlusion")


@pytest.fixture
def native() -> Iterator[NativeRenderer]:
    """A native renderer of the test's own."""
    made = NativeRenderer()
    yield made
    made.close()


def bytes_of(renderer: NativeRenderer, width: int, height: int) -> dict[str, bytes]:
    """Render every view of a scene with every kind of material and light."""
    scene, camera = gallery(), camera_at(width=width, height=height)
    past = Observation(snapshot=scene, camera=camera_at(Pose((0.1, 0.02, 0.0))))
    past = replace(past, camera=replace(past.camera, intrinsics=camera.intrinsics))
    views = renderer.render(RenderRequest(scene, camera, VIEWS, past)).views
    return {name: views[name].tobytes() for name in VIEWS}


def test_what_was_forgotten_is_freed_and_looks_the_same_again(native: NativeRenderer) -> None:
    """Also what is worked out of models and skies, which goes with them."""
    plain = bytes_of(native, 64, 48)
    model = model_of(wall_mesh(), base_colour_texture=checker())
    digest, left = appearance_digest(model), weakref.ref(model)
    sky = SkyMap(radiance=np.ones((60, 120, 3), np.float16), zenith=GREY, horizon=GREY, ground=GREY)
    scene = snapshot_of(
        [Thing(model, Pose((2.0, 0.0, 0.0)))],
        environment=Environment(sky=sky, sky_map="grey", sky_blend=False),
    )
    native.render(RenderRequest(scene, camera_at(), ("rgb",)))
    assert (sky, None) in _texels_in_use
    del model, scene
    native.forget()
    gc.collect()
    assert left() is None
    assert (sky, None) not in _texels_in_use
    assert native.part_table.contents is None
    assert bytes_of(native, 64, 48) == plain
    assert appearance_digest(model_of(wall_mesh(), base_colour_texture=checker())) == digest


def test_what_a_large_scene_was_drawn_in_is_freed_with_it(native: NativeRenderer) -> None:
    """Kernels keep room for all triangles that they drew: 17 MB after this scene."""
    bytes_of(native, 64, 48)
    native.forget()
    gc.collect()
    before = _bytes_in_use()
    draw_net(native)
    drawn = _bytes_in_use() - before
    native.forget()
    gc.collect()
    assert drawn > 10 * 2**20
    assert _bytes_in_use() - before < 2**20


def draw_net(renderer: NativeRenderer) -> None:
    """Render a floor of 180,000 triangles, which throws a shadow."""
    across = np.linspace(-1.0, 1.0, 301)
    plane = np.stack(np.meshgrid(across, across), axis=-1).reshape(-1, 2)
    corners = (np.arange(300)[:, None] * 301 + np.arange(300)).reshape(-1, 1)
    halves = [np.add(corners, half) for half in ((0, 1, 301), (1, 302, 301))]
    net = mesh_of(
        np.pad(plane, ((0, 0), (0, 1))),
        np.tile((0.0, 0.0, 1.0), (len(plane), 1)),
        plane,
        np.concatenate(halves),
    )
    sun = Light(name="sun", type="directional", intensity=2.0)
    scene = snapshot_of([Thing(model_of(net), Pose((2.0, 0.0, -0.5)))], lights=(sun,))
    renderer.render(RenderRequest(scene, camera_at(), ("rgb",)))


def _bytes_in_use() -> int:
    found = allocations()
    return found.uordblks + found.hblkhd


def test_what_is_preloaded_before_looks_the_same(native: NativeRenderer) -> None:
    """By another thread, as a simulation does beside the light of its first frame."""
    plain = bytes_of(native, 64, 48)
    renderer = NativeRenderer()
    with ThreadPoolExecutor(1) as beside:
        beside.submit(renderer.preload, gallery().contents).result()
    assert bytes_of(renderer, 64, 48) == plain
    renderer.close()


@pytest.mark.parametrize("size", [(64, 48), (203, 151)])
def test_bytes_do_not_depend_on_threads(size: tuple[int, int]) -> None:
    """One, two, three and seven threads make equal frames."""
    made = []
    for threads in (1, 2, 3, 7):
        renderer = NativeRenderer(threads=threads)
        made.append(bytes_of(renderer, *size))
        renderer.close()
    for other in made[1:]:
        assert {name for name in VIEWS if other[name] != made[0][name]} == set()


@pytest.mark.parametrize("threads", [2, 4])
def test_cameras_side_by_side_see_what_each_sees_alone(threads: int) -> None:
    scene = gallery()
    settings = PictureSettings(supersampling=2)
    sensor = PictureSettings(
        auto_exposure_s=0.5,
        bloom=0.1,
        full_well=9000.0,
        read_noise=4.0,
        depth_sensor="realsense_d435",
        vignetting=0.4,
        lateral_colour=0.002,
        dirt=0.3,
        jpeg_quality=60,
    )
    cameras = [
        camera_at(width=160, height=120),
        camera_at(Pose((0.3, 0.1, 0.0)), width=200, height=90),
        replace(camera_at(Pose((0.2, 0.0, 0.1))), intrinsics=FISHEYE),
        replace(camera_at(Pose((0.1, 0.1, 0.1)), width=96, height=80), picture=settings),
        replace(camera_at(Pose((0.0, 0.1, 0.1)), width=96, height=80), picture=sensor),
    ]
    measured = ("rgb", "raw", "measured_depth", "occlusion")
    asked = ("rgb", "depth"), ("normals", "instance"), VIEWS, VIEWS, measured
    alone, together = NativeRenderer(threads=1), NativeRenderer(threads=threads)
    try:
        moved = [replace(camera, pose=Pose((0.15, 0.0, 0.02))) for camera in cameras]
        pasts = [
            Observation(
                snapshot=scene,
                camera=camera,
                depth=alone.render(RenderRequest(scene, camera, ("occlusion",))).depth,
            )
            for camera in moved
        ]
        requests = [
            RenderRequest(snapshot=scene, camera=camera, views=views, previous=past)
            for camera, views, past in zip(cameras, asked, pasts, strict=True)
        ]
        made = together.render_all(requests)
        for rendered, request in zip(made, requests, strict=True):
            expected = alone.render(
                RenderRequest(scene, request.camera, request.views, request.previous)
            )
            assert rendered.views.keys() == expected.views.keys() == set(request.views)
            for view, array in expected.views.items():
                assert rendered.views[view].tobytes() == array.tobytes(), view
            assert (rendered.depth is None) == (expected.depth is None)
            if rendered.depth is not None and expected.depth is not None:
                assert rendered.depth.tobytes() == expected.depth.tobytes()
        refused = replace(requests[0], views=("no_such_view",))
        with pytest.raises(UnknownName, match="no_such_view"):
            together.render_all([requests[1], refused])
        again = together.render_all(requests[:2])
        assert again[0].views["rgb"].tobytes() == made[0].views["rgb"].tobytes()
    finally:
        alone.close()
        together.close()


def test_bytes_do_not_depend_on_the_instruction_set() -> None:
    """Each instruction set that this processor has makes equal frames."""
    sets = load_library().instruction_sets
    made = {}
    for name in sets:
        with using_instruction_set(name):
            renderer = NativeRenderer()
            made[name] = bytes_of(renderer, 203, 151)
            renderer.close()
    for name in sets:
        assert {view for view in VIEWS if made[name][view] != made[sets[0]][view]} == set(), name


def test_structures_are_as_the_library_has_them() -> None:
    """Python's structures are as long as the library's."""
    for name, (theirs, ours) in structure_sizes().items():
        assert theirs == ours, name


def sphere(steps: int) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """Return a closed ball of radius 1 whose triangles share their corners."""
    across, up = np.meshgrid(np.arange(steps), np.arange(1, steps))
    turn, lift = 2.0 * np.pi * across / steps, np.pi * up / steps - 0.5 * np.pi
    ring = np.stack([np.cos(lift) * np.cos(turn), np.cos(lift) * np.sin(turn), np.sin(lift)], -1)
    points = np.concatenate([ring.reshape(-1, 3), [[0, 0, -1], [0, 0, 1]]]).astype(np.float32)
    triangles = []
    south, north = len(points) - 2, len(points) - 1
    for row in range(steps - 2):
        for k in range(steps):
            a, b = row * steps + k, row * steps + (k + 1) % steps
            triangles += [(a, b, b + steps), (a, b + steps, a + steps)]
    last = (steps - 2) * steps
    for k in range(steps):
        j = (k + 1) % steps
        triangles += [(south, j, k), (north, last + k, last + j)]
    return points, np.array(triangles, np.uint32)


def test_closed_surfaces_have_no_hole(native: NativeRenderer) -> None:
    """From 1,000 random places in and around a ball no pixel inside its outline is missed."""
    points, triangles = sphere(24)
    mesh = mesh_of(points, points, np.zeros((len(points), 2), np.float32), triangles)
    ball = snapshot_of([Thing(model_of(mesh, double_sided=True), Pose((0.3, -0.2, 0.1)))])
    random = np.random.default_rng(7)
    intrinsics = CameraIntrinsics(width=64, height=48, vertical_fov_deg=75.0, near_m=0.001)
    centre = np.array([0.3, -0.2, 0.1])
    for number in range(1000):
        inside = number % 2 == 0
        away = random.normal(size=3)
        reach = random.uniform(0.0, 0.9) if inside else random.uniform(1.05, 4.0)
        eye = centre + reach * away / np.linalg.norm(away)
        towards = centre + 0.3 * random.normal(size=3)
        camera = Camera(intrinsics=intrinsics, pose=look_at(tuple(eye), tuple(towards)))
        seen = native.render(RenderRequest(ball, camera, ["instance"])).views["instance"] > 0
        if inside:
            assert seen.all(), number
            continue
        # The ball that fits into the polyhedron: rays that meet it must meet a triangle.
        rays = intrinsics.rays() @ camera.world_from_camera[:3, :3].T
        rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
        along = rays @ (centre - eye)
        inner = np.cos(np.pi / 24) ** 2 * 0.999
        misses = (along < 0) | (((centre - eye) ** 2).sum() - along**2 > inner**2)
        assert (seen | misses).all(), number


@pytest.mark.parametrize("seed", range(4))
def test_labels_and_depth_are_those_of_rays(native: NativeRenderer, seed: int) -> None:
    """Away from edges every id equals a ray cast's, and depth to 1e-5 at 99.9 %."""
    random = np.random.default_rng(seed)
    things = [
        Thing(
            model_of(box_mesh(random.uniform(0.2, 1.0))),
            Pose.from_rpy_deg(
                (random.uniform(2, 6), random.uniform(-2, 2), random.uniform(-1.5, 1.5)),
                tuple(random.uniform(-180, 180, 3)),
            ),
        )
        for _ in range(30)
    ]
    snapshot, camera = snapshot_of(things), camera_at(width=320, height=240)
    hits = cast(snapshot, camera)
    views = native.render(RenderRequest(snapshot, camera, ["instance", "depth"])).views
    sure = hits.away_from_edges()
    ids = np.concatenate([snapshot.contents.instance_ids, [0]])
    np.testing.assert_array_equal(views["instance"][sure], ids[hits.row[sure]])
    hit = sure & np.isfinite(hits.depth)
    error = np.abs(views["depth"][hit] / hits.depth[hit] - 1.0)
    assert np.quantile(error, 0.999) < 1e-5


HOLES = checker(4).copy()
HOLES[..., 3] = np.where(np.indices(HOLES.shape[:2]).sum(axis=0) // 32 % 2, 255, 0)
BUMPS = np.full((256, 256, 4), 128, np.uint8)
BUMPS[..., 0] = 128 + 40 * np.sin(np.arange(256) / 32 * np.pi)
BUMPS[..., 1] = (128 + 40 * np.cos(np.arange(256) / 64 * np.pi))[:, None]

KINDS = {
    "matt": {"roughness": 1.0},
    "glossy": {"roughness": 0.2},
    "metal": {"roughness": 0.3, "metallic": 1.0, "base_colour": (0.9, 0.7, 0.4, 1.0)},
    "glowing": {"emission": (1.0, 2.0, 4.0)},
    "textured": {"base_colour_texture": checker(4), "roughness": 0.7},
    "with holes": {"base_colour_texture": HOLES, "alpha": "mask", "double_sided": True},
    "rough in places": {"metallic_roughness_texture": BUMPS, "roughness": 0.9, "metallic": 0.8},
    "in relief": {"normal_texture": BUMPS, "roughness": 0.4},
    "glass": {"alpha": "blend", "base_colour": (0.7, 0.9, 0.8, 0.3)},
    "stained glass": {"alpha": "blend", "base_colour_texture": checker(4)},
    "two-sided glass": {"alpha": "blend", "double_sided": True, "roughness": 0.1},
}
SUN = Light(name="l", type="directional", direction=(0.5, 0.3, -0.8), intensity=2.0)
LAMPS = {
    "sun": SUN,
    "point": Light(name="l", type="point", intensity=6.0, position_m=(2.0, 0.5, 1.0)),
    "spot": Light(
        name="l", type="spot", intensity=20.0, position_m=(1.0, 0.5, 1.5), direction=(1, 0, -0.5)
    ),
    "area": Light(
        name="l", type="area", intensity=8.0, position_m=(3, 0, 1.9), direction=(0, 0, -1)
    ),
    "none": None,
}


@pytest.mark.parametrize("lamp", LAMPS)
@pytest.mark.parametrize("kind", KINDS)
def test_pictures_are_those_of_opengl(
    kind: str, lamp: str, pair: tuple[NativeRenderer, Renderer]
) -> None:
    """Within 2 of 255 at 95 % of the pixels and more, for every material under every light.

    At pixels' centres: samples of smooth edges lie elsewhere.
    """
    things = [
        Thing(
            model_of(box_mesh(0.9), **KINDS[kind]), Pose.from_rpy_deg((3.0, 0.1, 0), (10, 20, 30))
        ),
        Thing(model_of(box_mesh(0.4)), Pose((2.2, 0.5, -0.4))),
        Thing(model_of(wall_mesh(6, 6)), Pose.from_rpy_deg((4, 0, -0.9), (0, 90, 0))),
    ]
    light = LAMPS[lamp]
    lights = () if light is None else (light,)
    contents = contents_of(things, lights=lights, environment=Environment(sky_share=0.5))
    snapshot = snapshot_of(things, contents=contents)
    camera = camera_at(look_at((0, 0, 0.6), (3.2, 0, -0.2)), width=200, height=150)
    camera = replace(camera, picture=PictureSettings(smooth_edges=False))
    first, second = (
        made.render(RenderRequest(snapshot, camera, ["rgb", "instance"])).views for made in pair
    )
    same = first["instance"] == second["instance"]
    assert (~same).mean() <= 2e-4
    off = np.abs(first["rgb"].astype(int) - second["rgb"].astype(int)).max(axis=-1)
    assert (off <= 2).mean() >= 0.95


def test_a_cone_without_width_ends_at_once(native: NativeRenderer) -> None:
    """Where the angle is that of both cones all light arrives: 0 / 0 is no darkness."""
    beam = Light(
        name="beam",
        type="spot",
        intensity=20.0,
        position_m=(1.0, 0.0, 0.0),
        direction=(1.0, 0.0, 0.0),
        inner_cone_deg=0.0,
        outer_cone_deg=0.0,
    )
    scene = snapshot_of([Thing(model_of(wall_mesh(6, 6)), Pose((3.0, 0, 0)))], lights=(beam,))
    dark = snapshot_of([Thing(model_of(wall_mesh(6, 6)), Pose((3.0, 0, 0)))], lights=())
    camera = camera_at(width=97, height=73)
    lit, unlit = (
        native.render(RenderRequest(snapshot, camera, ["rgb"])).views["rgb"].astype(int)
        for snapshot in (scene, dark)
    )
    assert (lit - unlit)[36, 48].min() > 20
    assert (lit != unlit).any(axis=-1).sum() < 10


def test_textures_are_as_bright_as_those_of_opengl(pair: tuple[NativeRenderer, Renderer]) -> None:
    """Fine grain that is smaller than a pixel is averaged without rounding down."""
    grain = np.random.default_rng(3).integers(110, 146, (256, 256, 4)).astype(np.uint8)
    grain[..., 3] = 255
    things = [Thing(model_of(wall_mesh(6, 6), base_colour_texture=grain), Pose((3.0, 0, 0)))]
    contents = contents_of(things, lights=(SUN,), environment=Environment(sky_share=0.5))
    snapshot = snapshot_of(things, contents=contents)
    camera = camera_at(width=200, height=150)
    first, second = (
        made.render(RenderRequest(snapshot, camera, ["rgb"])).views["rgb"].astype(int)
        for made in pair
    )
    assert abs((first - second).mean()) < 0.1
    assert (np.abs(first - second).max(axis=-1) <= 2).mean() > 0.98


@pytest.fixture(scope="module")
def pair() -> Iterator[tuple[NativeRenderer, Renderer]]:
    """A native renderer and one with OpenGL."""
    made = NativeRenderer(), Renderer()
    yield made
    for renderer in made:
        renderer.close()


@pytest.mark.parametrize("name", hostile_scenes())
@pytest.mark.parametrize("size", [(8, 8), (97, 61)])
def test_hostile_scenes_are_drawn_as_far_as_they_can_be(
    name: str, size: tuple[int, int], native: NativeRenderer
) -> None:
    """Nothing crashes, and what comes back are views."""
    camera = camera_at(width=size[0], height=size[1])
    with np.errstate(all="ignore"):
        views = native.render(RenderRequest(hostile_scenes()[name](), camera, VIEWS)).views
    assert views["rgb"].shape == (size[1], size[0], 3)
    assert set(np.unique(views["instance"])) <= {0, 1}


def test_the_largest_picture(native: NativeRenderer) -> None:
    """4096 x 4096 is drawn, and shows the same as a small one."""
    scene = gallery()
    large = camera_at(width=4096, height=4096)
    small = camera_at(width=64, height=64)
    big = native.render(RenderRequest(scene, large, ["instance"])).views["instance"]
    little = native.render(RenderRequest(scene, small, ["instance"])).views["instance"]
    assert (big[32::64, 32::64] == little).mean() > 0.95
