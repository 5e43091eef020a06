"""Drives every kernel with input that nobody should give; see test_hostile_input.py.

    python -m tests.unit.native.hostile_input INSTRUCTION_SET...

A sanitizer ends the process where a kernel reads or writes beyond its arrays or does what C++
does not define. What kernels compute is tested elsewhere. Add a function for each new kernel to
`DRIVERS`; sizes go from 8x8 (and less) to 4096x4096.
"""

from __future__ import annotations

import contextlib
import math
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.light.relight.baked_scene import BakedScene
from sailenv_ros.light.relight.quality import QUICK
from sailenv_ros.light.relight.relighting import relit
from sailenv_ros.light.relight.scene_changes import Change
from sailenv_ros.native.array_kernel import sum_steps
from sailenv_ros.native.lens import LENS
from sailenv_ros.native.lens_light import scale_light, weigh_light
from sailenv_ros.native.lens_models import (
    lens_models,
    lens_reach,
    padded_coefficients,
    project_points,
    unproject_places,
)
from sailenv_ros.native.library import using_instruction_set
from sailenv_ros.native.light_maps import blur_directions, sum_texels
from sailenv_ros.native.motion_kernels import (
    MOTION_OUTPUTS,
    BentLenses,
    move_points,
    transform_points,
)
from sailenv_ros.native.picture_kernels import (
    AmbientSettings,
    find_ambient_visibility,
    gather_light,
    make_picture,
    resolve_samples,
)
from sailenv_ros.native.png_kernel import png_data, png_rows
from sailenv_ros.native.ray_kernels import build_tree, cast_rays, light_hits, light_share
from sailenv_ros.native.self_test import run_self_test
from sailenv_ros.native.texel_kernels import cover_texels
from sailenv_ros.native.view_kernels import annotate_pixels, convert_views, measure_instances
from sailenv_ros.rays.triangle_tree import in_leaves, triangle_tree
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.picture.ambient_occlusion import PATTERN
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import Light
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.row_poses import RowPoses
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from tests.support.baked import baked, chart, layer
from tests.support.hostile_scenes import hostile_scenes
from tests.support.tiny_scenes import Thing, box_mesh, camera_at, model_of, snapshot_of
from tests.unit.native import hostile_bake, hostile_deformation
from tests.unit.native.hostile_numbers import NUMBERS, THREADS

__all__ = ["DRIVERS", "THREADS"]


def drive_png_data() -> None:
    """Rows of one byte, pixels wider than a row, noise that does not compress, one value."""
    random = np.random.default_rng(3)
    for height, width in ((1, 1), (1, 7), (5, 3), (64, 4096), (300, 999)):
        for rows in (
            random.integers(256, size=(height, width), dtype=np.uint8),
            np.zeros((height, width), np.uint8),
        ):
            for step in (1, 3, 8):
                for paeth in (False, True):
                    png_data(rows, step, paeth=paeth)


def drive_png_rows() -> None:
    """Rows of one pixel, of less than one, of many; filters that do not exist; noise."""
    random = np.random.default_rng(5)
    for height, width in ((1, 1), (1, 48), (8, 48), (40, 90), (41, 51), (3, 7)):
        for step in (1, 2, 3, 6, 8):
            for filters in ([4], [0, 1, 2, 3, 4], [5], [255]):
                filtered = random.integers(256, size=(height, 1 + width), dtype=np.uint8)
                filtered[:, 0] = random.choice(filters, size=height)
                png_rows(filtered, step)


def drive_sum_steps() -> None:
    """Noise as numbers of each size, no rows, rows of nothing; a size that does not exist."""
    random = np.random.default_rng(6)
    for kind in ("u1", "<f2", "<i4", "<f8", "<c16"):
        for rows in ((0, 5, 3), (4, 0, 1), (1, 1, 1), (3, 33, 3), (2, 7, 2)):
            size = math.prod(rows) * np.dtype(kind).itemsize
            planes = random.integers(256, size=size, dtype=np.uint8)
            with contextlib.suppress(NativeLibraryError):
                sum_steps(planes, rows, np.dtype(kind))


def drive_self_test() -> None:
    """No rows, one row, more threads than rows."""
    for threads in THREADS:
        for rows in (0, 1, 2, 1000):
            run_self_test(rows, tile_rows=16, threads=threads)


SIZES = ((1, 1), (1, 2), (2, 1), (3, 3), (8, 8), (7, 33), (65, 19))
"""Of pictures; cameras have at least 8 pixels a side, kernels take what comes."""

LARGEST = (4096, 4096)
"""Of pictures that a camera may have: tried once a kernel, since sanitizers are slow."""


def surfaces(*sizes: tuple[int, int]) -> Iterator[NDArray[np.float32]]:
    """Make surfaces of hostile numbers, in patches and one by one."""
    rng = np.random.default_rng(0)
    for height, width in sizes:
        numbers = rng.choice(np.array(NUMBERS, np.float32), (height, width, 2))
        numbers[:, width // 2 :] = numbers[:, width // 2 : width // 2 + 1]
        yield numbers


PLAIN = np.array([(500.0, 500.0, 0.5, 0.5, 0.05, 60.0)], LENS)
WILD = np.array([(np.nan, 1e30, 1e30, -np.inf, np.nan, np.nan)], LENS)


def drive_lenses() -> None:
    """Coefficients, limits, points and places that are no numbers, for every model."""
    rng = np.random.default_rng(11)
    wild = np.array(NUMBERS)
    for model in (*lens_models().values(), None):
        number = -1 if model is None else model.number
        for count in (0, 1, 2000):
            for coefficients in (np.zeros(12), rng.choice(wild, 12), rng.normal(0.0, 0.3, 12)):
                for limit in (1.0, *NUMBERS):
                    with contextlib.suppress(NativeLibraryError):
                        lens_reach(number, tuple(coefficients))
                        points, places = rng.choice(wild, (count, 3)), rng.choice(wild, (count, 2))
                        project_points(number, coefficients, limit, points, threads=THREADS[1])
                        unproject_places(number, coefficients, limit, places, threads=THREADS[1])


def drive_annotate() -> None:
    """Ids that are none, lenses that are no numbers."""
    categories = np.zeros(65536, np.uint8)
    for surface in surfaces(*SIZES, LARGEST):
        size = surface.shape[:2]
        views = {
            "depth": np.empty(size, np.float32),
            "category": np.empty(size, np.uint8),
            "instance": np.empty(size, np.uint16),
        }
        for lens in (PLAIN,) if size == LARGEST else (PLAIN, WILD):
            annotate_pixels(surface, categories, lens, views, threads=THREADS[1])


def drive_motion() -> None:
    """Ids without rows, rows beyond the tables, lenses and motions that are no numbers."""
    rng = np.random.default_rng(2)
    rows = rng.integers(0, 6, 65536).astype(np.uint16)
    rows[::5] = 65535
    motions, displacements = rng.choice(np.array(NUMBERS), (2, 4, 3, 4))
    motions[1] = 0.0
    number = lens_models()["orthographic"].number
    side_by_side = BentLenses(None, True, number, padded_coefficients(()), 1.0, False)
    others = [(np.full(size, 0.3, np.float32), np.zeros(size, np.uint16)) for size in SIZES[:4]]
    others += [(others[2][0], None), (None, None), (np.zeros((0, 0), np.float32), None)]
    for surface in surfaces(*SIZES, LARGEST):
        depth = np.ascontiguousarray(surface[..., 0])
        ids = np.nan_to_num(surface[..., 1], posinf=9.0).clip(0, 65535).astype(np.uint16)
        large = depth.shape == LARGEST
        found = {
            name: np.empty((*depth.shape, *channels), dtype)
            for name, (dtype, channels) in MOTION_OUTPUTS.items()
        }
        for lens in (PLAIN,) if large else (PLAIN, WILD):
            for other in others[:1] if large else (*others, (depth, ids)):
                for to, bent in ((PLAIN, None), (WILD, None), (PLAIN, side_by_side)):
                    move_points(
                        *(depth, ids, rows, motions, displacements, lens, to, *other, np.nan),
                        found,
                        bent=bent,
                        duration_s=-1e-30,
                        threads=THREADS[1],
                    )
            for parallel in (False, True):
                transform_points(
                    depth, ids, rows, motions, lens, parallel=parallel, threads=THREADS[1]
                )


def drive_rays() -> None:
    """Triangles without area, rays without direction, transforms that are no numbers."""
    rng = np.random.default_rng(3)
    huge = rng.choice(np.array((0.0, 1e300, -1e300, 1e-300, 1.0)), (5000, 3, 3))
    wild = np.array(NUMBERS)
    for corners in (huge, huge[:1], np.zeros((9, 3, 3)), np.zeros((0, 3, 3))):
        tree = triangle_tree(corners, np.ones(len(corners), np.bool_))
        with np.errstate(over="ignore", invalid="ignore"):
            solid = triangle_tree(np.clip(corners, -3e38, 3e38).astype(np.float32))
        passes = in_leaves(np.ones(len(corners), np.float32), solid.order)
        for count in (0, 1, 500):
            rays = [rng.choice(wild, (count, 3)) for _ in range(2)]
            transforms = rng.choice(wild, (3, 3, 4))
            over = build_tree(rng.choice((-1e300, 0.0, 1e300), (3, 6)), 1)
            nearest = rng.choice(wild, count)
            instances = over, transforms, np.zeros(3, np.int32)
            cast_rays(tree.record, instances, *rays, nearest, threads=THREADS[1])
            with np.errstate(over="ignore"):
                floats = [np.asarray(array, np.float32) for array in (*rays, nearest)]
            light_hits(solid.record, *floats[:2], threads=THREADS[1])
            light_share(solid.record, (solid.record, passes), *floats, threads=THREADS[1])


def drive_ambient_visibility() -> None:
    """Radii that are endless or none, depths that are no depths."""
    known = np.zeros(65536, np.uint8)
    known[:2] = 1, 255
    plain = AmbientSettings(0.3, 1.5, 48.0, 0.08, 1.3, 0.03, 4)
    wild = AmbientSettings(np.inf, 1.5, 48.0, np.nan, 1e30, np.nan, 1)
    for surface in surfaces(*SIZES, LARGEST):
        large = surface.shape[:2] == LARGEST
        for lens, settings in ((PLAIN, plain),) if large else ((PLAIN, plain), (WILD, wild)):
            for parallel in (False, True):
                find_ambient_visibility(
                    *(surface, known, lens, settings, PATTERN),
                    parallel=parallel,
                    threads=THREADS[1],
                )


def drive_pictures() -> None:
    """Every half-precision number there is, also where radiance cannot be negative."""
    table = np.arange(65536).astype(np.uint8)
    for surface in surfaces(*SIZES, LARGEST):
        height, width = surface.shape[:2]
        large = surface.shape[:2] == LARGEST
        bits = np.resize(np.arange(65521, dtype=np.uint16), (height, width, 4))
        radiance = np.ascontiguousarray(bits).view(np.float16)
        half = (height + 1) // 2, (width + 1) // 2
        visibility, inverse = np.zeros(half, np.uint8), np.full(half, np.nan, np.float32)
        for shade in ((visibility, inverse),) if large else ((None, None), (visibility, inverse)):
            make_picture(radiance, table, *shade, surface, same_surface=0.04, threads=THREADS[1])
            resolve_samples(radiance, 1, *shade, surface, same_surface=0.04, threads=THREADS[1])


def drive_client_views() -> None:
    """Ids beyond the colours, depths that are no depths, a range of no length."""
    for surface in surfaces(*SIZES):
        height, width = surface.shape[:2]
        views = {
            "depth": surface[..., 0].copy(),
            "instance": np.resize(np.arange(65536, dtype=np.uint16), (height, width)),
            "flow": surface.copy(),
        }
        for colours in (np.zeros(1, np.uint32), np.zeros(65536, np.uint32)):
            for range_m in (10.0, 0.1 + 1e-12, 1e30):
                convert_views(
                    views, near_m=0.1, range_m=range_m, colours=colours, threads=THREADS[1]
                )


def other_lenses_of(width: int, height: int) -> list[CameraIntrinsics]:
    """Lenses that see little more than ahead, to the side, all around, and side by side."""
    size = {"width": width, "height": height}
    fisheye = {"distortion_model": "equidistant", "distortion": (0.0,) * 4, "max_angle_deg": 95.0}
    sphere = {"fx_px": width / 6.3, "fy_px": height / 3.15}
    return [
        CameraIntrinsics(distortion_model="plumb_bob", distortion=(-0.2, 0.05, 0.0, 0.0), **size),
        CameraIntrinsics(fx_px=0.3 * height, fy_px=0.3 * height, **fisheye, **size),
        CameraIntrinsics(distortion_model="equirectangular", **sphere, **size),
        CameraIntrinsics(distortion_model="orthographic", fx_px=30.0, fy_px=4e5, **size),
    ]


def drive_drawing() -> None:
    """Poses that are no numbers, triangles without extent, huge and far ones, the eye inside."""
    for threads in THREADS:
        renderer = NativeRenderer(threads=threads)
        for make in hostile_scenes().values():
            snapshot = make()
            for width, height in ((8, 8), (97, 61)):
                for times in (1, 2):
                    camera = camera_at(width=width, height=height)
                    camera = replace(camera, picture=PictureSettings(supersampling=times))
                    for lens in (camera.intrinsics, *other_lenses_of(width, height)):
                        seen = replace(camera, intrinsics=lens)
                        past = Observation(snapshot=snapshot, camera=seen)
                        with np.errstate(all="ignore"):
                            renderer.render(
                                RenderRequest(snapshot, seen, ("rgb", "flow", "normals"), past)
                            )
                            if width > 8 and (lens is not camera.intrinsics or times > 1):
                                continue
                            rows = _wild_rows(snapshot, seen)
                            past = replace(past, rows=rows)
                            views = ("rgb", "flow", "occlusion")
                            renderer.render(RenderRequest(snapshot, seen, views, past, rows=rows))
        renderer.close()
    renderer = NativeRenderer(threads=2)
    scene = snapshot_of([Thing(model_of(box_mesh(1.0), alpha="blend"), Pose((0.0, 0.0, 0.0)))])
    renderer.render(RenderRequest(scene, camera_at(width=4096, height=4096), ("instance",)))
    renderer.close()


def _wild_rows(snapshot: WorldSnapshot, camera: Camera) -> RowPoses:
    """Rows of which some stand nowhere, and so do things."""
    rng = np.random.default_rng(7)
    height = camera.intrinsics.height
    ids = snapshot.contents.instance_ids[::2].copy()
    poses = np.broadcast_to(snapshot.world_from_body[::2], (height, len(ids), 4, 4)).copy()
    cameras = np.broadcast_to(camera.world_from_camera, (height, 4, 4)).copy()
    poses[::3] = rng.choice(np.array(NUMBERS), poses[::3].shape)
    cameras[::4] = rng.choice(np.array(NUMBERS), cameras[::4].shape)
    return RowPoses(
        times_ns=np.arange(height),
        world_from_camera=cameras,
        ids=ids,
        world_from_instance=poses,
    )


def drive_light_maps() -> None:
    """Layers of any numbers and sizes; lobes that weigh nothing."""
    rng = np.random.default_rng(3)
    for shape in ((1, 1), (3, 5), (64, 65)):
        halves = rng.choice(np.array([0.0, 1e-7, 6e4, np.inf, np.nan], np.float16), (*shape, 3))
        shown = rng.integers(0, 256, shape).astype(np.uint8)
        factor = np.array([0.0, np.nan, 1e38], np.float32)
        sum_texels([(halves, factor)] * 3, factor, shown, threads=2)
    for numbers in (np.nan, 0.0, 1e38):
        light = np.full((8, 8, 3), numbers, np.float32)
        blur_directions(light, light, np.full((5, 4), numbers, np.float32), light, threads=2)


def drive_sensor() -> None:
    """Light of any numbers, pictures of one pixel and more."""
    rng = np.random.default_rng(4)
    normal = np.zeros(65536, np.float32)
    for shape in ((1, 1), (3, 5), (64, 65), (0, 4)):
        halves = rng.choice(np.array([0.0, 1e-7, 6e4, np.inf, np.nan], np.float16), (*shape, 4))
        gather_light(halves, 0.5, np.nan, 1e38, -1, normal, threads=2)
        gather_light(halves, 1.0, 0.0, 0.0, 0, None, threads=2)
        wild = rng.choice(np.array(NUMBERS, np.float32), shape)
        weigh_light(halves, wild, threads=2)
        scale_light(halves, wild, normal[:3], normal[:3], threads=2)
        scale_light(halves, None, np.full(3, np.nan, np.float32), normal[:3], threads=2)


def drive_relighting() -> None:
    """Things at places that are no places, triangles without area, lights within walls."""
    for boxes in (1, 5, 17, 300):
        build_tree(np.zeros((boxes, 6)), 1)
    rng = np.random.default_rng(4)
    for side in (1, 8, 65):
        wild = rng.choice(np.array(NUMBERS, np.float32), (40, 3, 2))
        cover_texels(wild, side, 1.5)
    model = model_of(box_mesh(2.0))
    sun = Light(name="sun", type="directional", direction=(0, 0, -1))
    panel = Light(name="panel", type="area", position_m=(1.0, 0.0, 0.0))
    spot = Light(name="spot", type="spot", inner_cone_deg=10, outer_cone_deg=10)
    light = baked(
        {1: chart(model, Pose()), 2: chart(model, Pose())},
        [layer(sun, visible=0.5), layer(panel), layer(spot)],
    )
    things = [Thing(model), Thing(model, Pose((0.5, 0.0, 0.0)))]
    scene = BakedScene(light, snapshot_of(things, baked=light).contents, 1)
    quality = replace(QUICK, first_rays=4, rays=4, probe_rays=4)
    for x in (0.0, 1e-30, 1e6, 1e30):
        pose = np.eye(4)
        pose[0, 3] = x
        for change in (
            Change(id=2, before=np.eye(4), after=pose),
            Change(id=2, before=np.eye(4), after=None),
            Change(id=3, before=None, after=pose, came=(model, (1e-9, 1.0, -1.0))),
        ):
            for threads in THREADS:
                relit(scene, [change], quality, threads=threads)


def drive_alone() -> None:
    """Hostile scenes, each object alone, and one that is larger than the canvas."""
    for threads in THREADS:
        for make in hostile_scenes().values():
            snapshot = make()
            for width, height in ((8, 8), (97, 61)):
                drawing = AmodalRenderer(threads=threads)
                camera = camera_at(width=width, height=height)
                for lens in (camera.intrinsics, *other_lenses_of(width, height)):
                    with np.errstate(all="ignore"):
                        drawing.draw(snapshot, replace(camera, intrinsics=lens))
                drawing.close()
    drawing = AmodalRenderer(threads=2)
    around = snapshot_of([Thing(model_of(box_mesh(4.0), double_sided=True), Pose())])
    drawing.draw(around, camera_at(width=1024, height=1024))
    drawing.close()


def drive_instance_measures() -> None:
    """Every id there is, rows of one pixel, flow of any numbers."""
    for surface in surfaces(*SIZES, LARGEST):
        height, width = surface.shape[:2]
        ids = np.resize(np.arange(65536, dtype=np.uint16), (height, width))
        measure_instances(ids, surface)
        measure_instances(ids, None)


DRIVERS: tuple[Callable[[], None], ...] = (
    drive_self_test,
    drive_png_data,
    drive_png_rows,
    drive_sum_steps,
    drive_lenses,
    drive_annotate,
    drive_motion,
    drive_rays,
    drive_ambient_visibility,
    drive_pictures,
    drive_client_views,
    drive_drawing,
    drive_light_maps,
    drive_sensor,
    drive_relighting,
    *hostile_bake.DRIVERS,
    *hostile_deformation.DRIVERS,
    drive_alone,
    drive_instance_measures,
)


def main(instruction_sets: list[str]) -> None:
    """Run all drivers on each of the instruction sets."""
    for name in instruction_sets:
        with using_instruction_set(name):
            for driver in DRIVERS:
                driver()


if __name__ == "__main__":
    main(sys.argv[1:])
