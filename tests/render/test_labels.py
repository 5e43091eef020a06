"""Category and instance: exact at every pixel, and one id space for everything."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.model import Material, Model, ModelPart
from tests.render.conftest import Render
from tests.support.ray_cast import cast
from tests.support.tiny_scenes import (
    Thing,
    box_mesh,
    camera_at,
    contents_of,
    disc_mesh,
    mesh_of,
    model_of,
    snapshot_of,
    wall_mesh,
)

BOX = model_of(box_mesh(0.6))


def clutter(seed: int, count: int = 14) -> list[Thing]:
    """Boxes strewn in front of a camera at the origin, some cut by its picture's edge."""
    rng = np.random.default_rng(seed)
    things = []
    for _ in range(count):
        position = (rng.uniform(1.5, 6.0), rng.uniform(-2.0, 2.0), rng.uniform(-1.5, 1.5))
        pose = Pose.from_rpy_deg(position, rng.uniform(-180, 180, 3))
        scale = tuple(rng.uniform(0.3, 2.0, 3))
        things.append(Thing(BOX, pose, scale, category_id=int(rng.integers(1, 60))))  # type: ignore[arg-type]  # three floats
    return things


@pytest.mark.parametrize("seed", range(6))
def test_labels_agree_with_rays_away_from_edges(render: Render, seed: int) -> None:
    """Every pixel whose neighbourhood sees one face has the id that its ray meets: 100 %."""
    camera = camera_at(width=120, height=90)
    scene = snapshot_of(clutter(seed))
    views = render(scene, camera, "instance", "category", "depth")
    hits = cast(scene, camera)
    sure = hits.away_from_edges()
    assert sure.mean() > 0.3
    ids = np.concatenate([scene.contents.instance_ids, [0]])
    np.testing.assert_array_equal(views["instance"][sure], ids[hits.row[sure]])
    np.testing.assert_allclose(views["depth"][sure], hits.depth[sure], rtol=1e-5)
    assert (views["instance"] != ids[hits.row]).mean() < 0.002


def test_the_category_of_a_pixel_is_that_of_its_instance(render: Render) -> None:
    """Everywhere, edges included, also for ids beyond 8 bits."""
    things = clutter(7, 20)
    contents = contents_of(things, first_id=60_000)
    views = render(snapshot_of(things, contents=contents), camera_at(), "instance", "category")
    table = {drawn.instance.id: drawn.instance.category_id for drawn in contents.instances}
    table[0] = 0
    assert views["instance"].max() >= 60_000
    expected = np.vectorize(table.__getitem__)(views["instance"])
    np.testing.assert_array_equal(views["category"], expected)


@pytest.mark.parametrize("place", [(3.0, 0.0, 0.0), (4.0, 1.1, -0.6), (2.5, -0.7, 0.4)])
def test_a_body_s_centre_projects_onto_its_id(
    render: Render, place: tuple[float, float, float]
) -> None:
    """A disc's pixels carry its id at the projected centre, and their centroid is it to 0.05 px."""
    camera = camera_at(width=640, height=480)
    views = render(snapshot_of([Thing(model_of(disc_mesh(0.4)), Pose(place))]), camera, "instance")
    centre = camera.camera_from_world @ [*place, 1.0]
    u, v = camera.intrinsics.project(centre[:3])
    assert views["instance"][round(v), round(u)] == 1
    rows, columns = np.nonzero(views["instance"] == 1)
    assert abs(columns.mean() - u) < 0.05
    assert abs(rows.mean() - v) < 0.05


def test_the_picture_is_not_mirrored(render: Render) -> None:
    """World left (y) is the picture's left, world up (z) its top."""
    things = [Thing(BOX, Pose((5.0, 1.5, 0.0))), Thing(BOX, Pose((5.0, 0.0, 1.2)))]
    instance = render(snapshot_of(things), camera_at(), "instance")["instance"]
    rows, columns = np.nonzero(instance == 1)
    assert columns.max() < 48
    assert abs(rows.mean() - 35.5) < 1.0
    rows, columns = np.nonzero(instance == 2)
    assert rows.max() < 36
    assert abs(columns.mean() - 47.5) < 1.0


def test_backs_of_one_sided_triangles_are_not_there(render: Render) -> None:
    """A wall seen from behind hides nothing, unless its material is double-sided."""
    behind = Pose.from_rpy_deg((3.0, 0.0, 0.0), (0.0, 0.0, 180.0))
    one = snapshot_of([Thing(model_of(wall_mesh(9, 9)), behind)])
    two = snapshot_of([Thing(model_of(wall_mesh(9, 9), double_sided=True), behind)])
    assert not render(one, camera_at(), "instance")["instance"].any()
    assert render(two, camera_at(), "instance")["instance"].all()


@pytest.mark.parametrize("views", [("instance", "depth"), ("instance", "depth", "rgb")])
def test_holes_of_a_masked_material_show_what_is_behind(
    render: Render, views: tuple[str, ...]
) -> None:
    """Left half transparent: its pixels carry the wall behind, with and without a picture."""
    texture = np.full((64, 64, 4), 255, np.uint8)
    texture[:, :32, 3] = 0
    leaf = model_of(wall_mesh(20, 20), base_colour_texture=texture, alpha="mask")
    wall = model_of(wall_mesh(99, 99))
    scene = snapshot_of([Thing(leaf, Pose((2.0, 0, 0))), Thing(wall, Pose((4.0, 0, 0)))])
    result = render(scene, camera_at(), *views)
    assert (result["instance"][:, :47] == 2).all()
    assert (result["instance"][:, 49:] == 1).all()
    np.testing.assert_allclose(result["depth"][:, :47], 4.0, rtol=1e-6)


def test_a_pane_of_glass_is_not_labelled(render: Render) -> None:
    """What a see-through material covers keeps its own id and depth."""
    pane = model_of(wall_mesh(20, 20), alpha="blend", base_colour=(0.8, 0.9, 1.0, 0.2))
    scene = snapshot_of([Thing(pane, Pose((2.0, 0, 0))), Thing(BOX, Pose((4.0, 0, 0)))])
    views = render(scene, camera_at(), "instance", "depth")
    assert set(np.unique(views["instance"])) == {0, 2}


def test_all_parts_of_a_model_carry_one_id(render: Render) -> None:
    """Two parts with two materials are one instance."""
    left = mesh_of(
        wall_mesh().positions + np.array([0, 0.5, 0]),
        wall_mesh().normals,
        wall_mesh().uvs,
        wall_mesh().triangles,
    )
    model = Model(
        name="pair",
        parts=(
            ModelPart(mesh=left, material=Material(base_colour=(1, 0, 0, 1))),
            ModelPart(mesh=wall_mesh(), material=Material(double_sided=True)),
        ),
    )
    views = render(snapshot_of([Thing(model, Pose((2.0, 0, 0)))]), camera_at(), "instance", "rgb")
    assert set(np.unique(views["instance"])) == {0, 1}


def test_a_scene_that_changes_is_drawn_as_it_is_now(render: Render) -> None:
    """New contents with new models, fewer and more of them, in any order."""
    ball = Thing(model_of(disc_mesh(0.3)), Pose((2.0, 0, 0)))
    box = Thing(BOX, Pose((4.0, 0.8, 0)))
    for things in ([box], [box, ball], [ball], [], [ball, box, Thing(BOX, Pose((4.0, -0.8, 0)))]):
        views = render(snapshot_of(things), camera_at(), "instance")
        assert set(np.unique(views["instance"])) == set(range(len(things) + 1))


def test_an_empty_scene_is_all_background(render: Render) -> None:
    """Nothing to draw gives id 0, depth inf, and a sky."""
    views = render(
        snapshot_of([]), camera_at(), "instance", "category", "depth", "rgb", "flow_valid"
    )
    assert not views["instance"].any()
    assert np.isinf(views["depth"]).all()
    assert views["rgb"].min() > 0


def test_normals_follow_unequal_scale(render: Render) -> None:
    """On a stretched, turned box normals are those of its faces: unit, towards the camera."""
    pose = Pose.from_rpy_deg((4.0, 0, 0), (10.0, 25.0, 40.0))
    scene = snapshot_of([Thing(BOX, pose, (3.0, 0.7, 1.5))])
    camera = camera_at(look_at((0.2, 0.3, 0.5), (4.0, 0.0, 0.0)))
    views = render(scene, camera, "normals", "instance")
    hits = cast(scene, camera)
    sure = hits.away_from_edges() & (views["instance"] == 1)
    expected = (
        -np.sign((hits.normal * camera.intrinsics.rays()).sum(-1, keepdims=True)) * hits.normal
    )
    np.testing.assert_allclose(views["normals"][sure], expected[sure], atol=1e-6)
    assert not views["normals"][views["instance"] == 0].any()
