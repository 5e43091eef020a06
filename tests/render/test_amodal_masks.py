"""Objects drawn alone: against their visible pixels, larger pictures and rays."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pytest

from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import Mesh
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.support.ray_cast import cast
from tests.support.small_frame import small_frame
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    checker,
    disc_mesh,
    mesh_of,
    model_of,
    snapshot_of,
    wall_mesh,
)


@pytest.fixture
def native() -> Iterator[NativeRenderer]:
    """A renderer of the test's own."""
    made = NativeRenderer()
    yield made
    made.close()


@pytest.fixture
def alone(native: NativeRenderer) -> Iterator[AmodalRenderer]:
    """What draws objects alone, with the renderer's meshes."""
    made = AmodalRenderer(native.part_table)
    yield made
    made.close()


def crowd(count: int = 12) -> list[Thing]:
    """Boxes at any poses and scales, some of them hidden, cut by the border, behind the camera."""
    rng = np.random.default_rng(5)
    box = model_of(box_mesh(1.0))
    things = []
    for _ in range(count):
        place = (rng.uniform(-1.0, 6.0), rng.uniform(-3.0, 3.0), rng.uniform(-2.0, 2.0))
        turn = tuple(rng.uniform(-180.0, 180.0, 3))
        scale = tuple(float(s) for s in rng.uniform(0.2, 1.5, 3))
        things.append(Thing(box, Pose.from_rpy_deg(place, turn), scale=scale))
    return things


def ring_mesh() -> Mesh:
    """A square plate in the plane x = 0 with a square hole, facing -x."""
    outer = [(0, 1, -1), (0, -1, -1), (0, -1, 1), (0, 1, 1)]
    inner = [(0, 0.5, -0.5), (0, -0.5, -0.5), (0, -0.5, 0.5), (0, 0.5, 0.5)]
    triangles = []
    for k in range(4):
        n = (k + 1) % 4
        triangles += [(k, n, 4 + n), (k, 4 + n, 4 + k)]
    return mesh_of(outer + inner, [(-1, 0, 0)] * 8, [(0, 0)] * 8, triangles)


@pytest.mark.parametrize("size", [(8, 8), (97, 61), (160, 120)])
def test_what_nothing_hides_covers_its_visible_pixels(
    native: NativeRenderer, alone: AmodalRenderer, size: tuple[int, int]
) -> None:
    """Each of many objects, drawn in a scene of its own, has the mask and depth of that scene."""
    camera = camera_at(width=size[0], height=size[1])
    things = crowd()
    masks = alone.draw(snapshot_of(things), camera)
    covered = 0
    for row, thing in enumerate(things):
        single = snapshot_of([thing], first_id=row + 1)
        views = native.render(RenderRequest(single, camera, ("instance", "depth"))).views
        seen = views["instance"] == row + 1
        assert (masks.mask(row + 1) == seen).all()
        depth = np.where(seen, views["depth"], np.float32(np.inf))
        np.testing.assert_array_equal(masks.depth(row + 1), depth)
        assert masks.pixels[row] == seen.sum()
        covered += int(seen.sum())
    assert covered > 0


def test_the_canvas_is_a_picture_of_three_times_the_size(
    native: NativeRenderer, alone: AmodalRenderer
) -> None:
    """Pixels and boxes beside the picture are those that a larger picture shows."""
    camera = camera_at(width=64, height=48, vertical_fov_deg=50.0)
    lens = camera.intrinsics
    wide_fov = 2.0 * np.degrees(np.arctan(3.0 * np.tan(np.radians(lens.vertical_fov_deg) / 2.0)))
    wide = Camera(
        intrinsics=CameraIntrinsics(width=192, height=144, vertical_fov_deg=float(wide_fov)),
        pose=camera.pose,
    )
    assert wide.intrinsics.fx == pytest.approx(lens.fx, rel=1e-12)
    things = crowd(30)
    masks = alone.draw(snapshot_of(things), camera)
    beside = 0
    for row, thing in enumerate(things):
        single = snapshot_of([thing], first_id=row + 1)
        seen = (
            native.render(RenderRequest(single, wide, ("instance",))).views["instance"] == row + 1
        )
        # Rounding of another picture's numbers may decide a pixel on an edge otherwise.
        assert abs(int(seen.sum()) - int(masks.whole_pixels[row])) <= 2
        if seen.sum() > 20:
            rows, columns = np.nonzero(seen)
            box = [columns.min() - 64, rows.min() - 48, columns.max() - 64, rows.max() - 48]
            assert np.abs(masks.whole_boxes[row] - box).max() <= 1
        beside += int(masks.whole_pixels[row] > masks.pixels[row] > 0)
    assert beside > 3, "some objects should be cut by the border"


def test_visible_shares_are_those_of_rays(native: NativeRenderer, alone: AmodalRenderer) -> None:
    """Two rays for each pixel: through the whole scene, and through each object alone."""
    camera = camera_at(width=80, height=60)
    things = crowd(10)
    snapshot = snapshot_of(things)
    seen = native.render(RenderRequest(snapshot, camera, ("instance",))).views["instance"]
    masks = alone.draw(snapshot, camera)
    hits = cast(snapshot, camera)
    for row, thing in enumerate(things):
        single = cast(snapshot_of([thing], first_id=row + 1), camera)
        covered = int((single.row == 0).sum())
        visible = int((hits.row == row).sum())
        assert abs(covered - int(masks.pixels[row])) <= 2
        if covered > 200:
            share = (seen == row + 1).sum() / masks.pixels[row]
            assert share == pytest.approx(visible / covered, abs=0.01)


def test_what_is_seen_through_a_hole_belongs_to_what_lies_behind(
    native: NativeRenderer, alone: AmodalRenderer
) -> None:
    """The mask of a plate with a hole has the hole, and what lies behind is seen in it."""
    ring = Thing(model_of(ring_mesh()), Pose((3.0, 0.0, 0.0)))
    wall = Thing(model_of(wall_mesh(20.0, 20.0)), Pose((5.0, 0.0, 0.0)))
    camera = camera_at(width=81, height=61)
    masks = alone.draw(snapshot_of([ring, wall]), camera)
    seen = native.render(RenderRequest(snapshot_of([ring, wall]), camera, ("instance",))).views[
        "instance"
    ]
    assert not masks.mask(1)[30, 40]
    assert seen[30, 40] == 2
    assert (masks.mask(1) == (seen == 1)).all()
    assert masks.mask(2).all(), "the wall fills the picture"
    assert masks.whole_pixels[1] > masks.pixels[1] == 81 * 61


def test_an_object_that_hides_itself_is_covered_once(alone: AmodalRenderer) -> None:
    """Depth is that of its nearest surface."""
    two = mesh_of(
        [(x, y, z) for x in (0, 1) for y, z in ((1, -1), (-1, -1), (-1, 1), (1, 1))],
        [(-1, 0, 0)] * 8,
        [(0, 0)] * 8,
        [(4, 5, 6), (4, 6, 7), (0, 1, 2), (0, 2, 3)],
    )  # fmt: skip
    masks = alone.draw(snapshot_of([Thing(model_of(two), Pose((2.0, 0.0, 0.0)))]), camera_at())
    depth = masks.depth(1)
    assert np.isfinite(depth).any()
    np.testing.assert_allclose(depth[np.isfinite(depth)], 2.0, rtol=1e-6)


def test_glass_covers_nothing_and_hides_nothing(alone: AmodalRenderer) -> None:
    """As in all labels; what has opaque parts is covered by those."""
    glass = Thing(model_of(box_mesh(1.0), alpha="blend"), Pose((2.0, 0.0, 0.0)))
    behind = Thing(model_of(box_mesh(1.0)), Pose((4.0, 0.0, 0.0)))
    masks = alone.draw(snapshot_of([glass, behind]), camera_at())
    assert masks.pixels[0] == masks.whole_pixels[0] == 0
    assert masks.boxes[0].tolist() == masks.whole_boxes[0].tolist() == [-1, -1, -1, -1]
    assert not masks.mask(1).any()
    assert masks.pixels[1] > 0


def test_holes_of_a_masked_material_are_holes(
    native: NativeRenderer, alone: AmodalRenderer
) -> None:
    """Foliage is not covered where its texture is clear."""
    skin = checker(4, 64)
    skin[..., 3] = np.where(np.indices((64, 64)).sum(axis=0) // 16 % 2, 255, 0)
    leaf = model_of(wall_mesh(2.0, 2.0), base_colour_texture=skin, alpha="mask")
    snapshot = snapshot_of([Thing(leaf, Pose((3.0, 0.0, 0.0)))])
    camera = camera_at()
    seen = native.render(RenderRequest(snapshot, camera, ("instance",))).views["instance"] == 1
    mask = alone.draw(snapshot, camera).mask(1)
    assert (mask == seen).all()
    assert 0 < mask.sum() < 0.8 * (cast(snapshot, camera).row == 0).sum()


def test_what_lies_behind_the_camera_is_nowhere(alone: AmodalRenderer) -> None:
    """It has no pixel, and a box that says so."""
    things = [Thing(model_of(box_mesh(1.0)), Pose((-3.0, 0.0, 0.0)))]
    masks = alone.draw(snapshot_of(things), camera_at())
    assert (masks.pixels[0], masks.whole_pixels[0]) == (0, 0)
    assert masks.crops[0].shape == (0, 0)
    assert np.isposinf(masks.depth(1)).all()


def test_clip_distances_are_those_of_the_views(
    native: NativeRenderer, alone: AmodalRenderer
) -> None:
    """What is nearer than near is covered without a depth; what is beyond far is not covered."""
    near = Thing(model_of(wall_mesh(0.2, 0.2)), Pose((0.5, 0.0, 0.0)))
    slanted = Thing(model_of(wall_mesh(9.0, 9.0)), Pose.from_rpy_deg((6.0, 0.0, 0.0), (0, 40, 0)))
    camera = camera_at(near_m=1.0, far_m=6.0)
    masks = alone.draw(snapshot_of([near, slanted]), camera)
    assert masks.pixels[0] > 0
    assert np.isnan(masks.depth(1)[masks.mask(1)]).all()
    seen = native.render(RenderRequest(snapshot_of([slanted], first_id=2), camera, ("instance",)))
    assert (masks.mask(2) == (seen.views["instance"] == 2)).all()
    assert 0 < masks.pixels[1] < 96 * 72


def test_an_object_of_one_pixel(native: NativeRenderer, alone: AmodalRenderer) -> None:
    """A disc so far away that one pixel's centre lies on it has one pixel, here and there."""
    disc = Thing(model_of(disc_mesh(0.02)), Pose((2.5, 0.0, 0.0)))
    camera = camera_at(width=33, height=33)
    masks = alone.draw(snapshot_of([disc]), camera)
    assert masks.pixels[0] == masks.whole_pixels[0] == 1
    assert masks.boxes[0].tolist() == [16, 16, 16, 16]
    seen = native.render(RenderRequest(snapshot_of([disc]), camera, ("instance",))).views[
        "instance"
    ]
    assert np.argwhere(seen == 1).tolist() == [[16, 16]]


def bytes_of(snapshot: WorldSnapshot, camera: Camera, threads: int) -> Sequence[bytes]:
    drawing = AmodalRenderer(threads=threads)
    masks = drawing.draw(snapshot, camera)
    drawing.close()
    assert masks.depths is not None
    arrays = (masks.ids, masks.pixels, masks.whole_pixels, masks.boxes, masks.whole_boxes)
    return [array.tobytes() for array in (*arrays, *masks.depths)]


def test_masks_do_not_depend_on_threads_or_instruction_set() -> None:
    """Every number of every object."""
    snapshot, camera = snapshot_of(crowd(20)), camera_at(width=203, height=151)
    wanted = bytes_of(snapshot, camera, 1)
    for threads in (2, 5):
        assert bytes_of(snapshot, camera, threads) == wanted
    for name in load_library().instruction_sets:
        with using_instruction_set(name):
            assert bytes_of(snapshot, camera, 3) == wanted


def test_an_empty_scene_has_no_masks(alone: AmodalRenderer) -> None:
    """And that is no error."""
    assert len(alone.draw(snapshot_of([]), camera_at())) == 0


def test_points_of_a_cloud_lie_on_the_meshes(native: NativeRenderer) -> None:
    """Within a tenth of a millimetre, by the distance to the nearest side of each box."""
    snapshot, camera = snapshot_of(crowd()), camera_at(width=160, height=120)
    views = native.render(RenderRequest(snapshot, camera, ("depth", "instance"))).views
    frame = small_frame(dict(views), camera=camera)
    cloud = frame.points()
    assert len(cloud) > 1000
    for row, drawn in enumerate(snapshot.contents.instances):
        own = cloud.xyz[cloud.instance == drawn.instance.id].astype(np.float64)
        pose = snapshot.world_from_body[row]
        places = np.abs((own - pose[:3, 3]) @ pose[:3, :3])
        half = 0.5 * np.asarray(drawn.scale)
        # Outside of no side by more than that, and on at least one of them.
        assert (places - half).max(initial=0.0) <= 1e-4
        assert np.abs(places - half).min(axis=1).max(initial=0.0) <= 1e-4
