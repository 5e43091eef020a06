"""Places in the light map: nothing overlaps, no look-up meets what belongs to others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sailenv_ros.light.bake.back_to_back import back_to_back_faces
from sailenv_ros.light.bake.layout import MOST_LIT, laid_out
from sailenv_ros.light.bake.packing import packed
from sailenv_ros.light.bake.texels import rasterised
from sailenv_ros.light.bake.unwrap import unwrapped
from sailenv_ros.rays.static_geometry import static_geometry_of
from sailenv_ros.types.geometry import Pose
from tests.support.bake_scenes import COARSE, ground, still
from tests.support.tiny_scenes import Thing, box_mesh, mesh_of, model_of, wall_mesh

sizes = st.lists(st.tuples(st.integers(1, 90), st.integers(1, 90)), max_size=25)


@settings(deadline=None)
@given(sizes)
def test_rectangles_lie_apart_and_inside(rectangles: list[tuple[int, int]]) -> None:
    """Each texel belongs to one rectangle at most."""
    found = packed(rectangles, 1024)
    assert found is not None
    side, places = found
    taken = np.zeros((side, side), dtype=int)
    for (width, height), (x, y) in zip(rectangles, places, strict=True):
        assert x + width <= side
        assert y + height <= side
        taken[y : y + height, x : x + width] += 1
    assert taken.max(initial=0) <= 1


def test_what_does_not_fit_is_not_packed() -> None:
    """None instead of an overlap."""
    assert packed([(100, 100)] * 5, 128) is None


def test_look_ups_meet_their_own_texels_alone() -> None:
    """The four texels around any point of a triangle belong to the same instance."""
    things = [Thing(ground(2.0))]
    things += [Thing(model_of(box_mesh((0.3, 0.4, 0.13))), Pose((i, 0, 1))) for i in range(5)]
    geometry = static_geometry_of(still(things))
    layout = laid_out(geometry, COARSE, np.ones(geometry.triangle_count, dtype=bool))
    texels = rasterised(geometry, layout)
    owner = geometry.owner[texels.triangle]
    shares = np.random.default_rng(1).dirichlet(np.ones(3), size=50)
    for triangle, corners in enumerate(layout.places):
        at = shares @ corners - 0.5
        for dx, dy in np.ndindex(2, 2):
            column, row = np.floor(at).astype(int).T + np.array([[dx], [dy]])
            index = texels.index[row, column]
            assert (index >= 0).all()
            assert (owner[index] == geometry.owner[triangle]).all()


def test_many_lights_make_texels_larger() -> None:
    """All layers together have a limit, which is passed only by what cannot be any smaller."""
    geometry = static_geometry_of(still([Thing(ground(8.0))]))
    seen = np.ones(geometry.triangle_count, dtype=bool)
    fine = replace(COARSE, texel_m=0.005)
    assert laid_out(geometry, fine, seen).side > 1600
    for layers in (9, 20):
        side = laid_out(geometry, fine, seen, layers=layers).side
        assert side * side * layers <= MOST_LIT
        assert 1.5 * side * side * layers > MOST_LIT
    assert laid_out(geometry, fine, seen, layers=MOST_LIT // 64).side > 64


def test_a_model_keeps_its_triangles() -> None:
    """Unwrapped vertices copy the mesh's: every triangle has its own corners, in its order."""
    model = model_of(box_mesh((0.3, 0.4, 0.5)))
    mesh = model.parts[0].mesh
    seen = np.arange(len(mesh.triangles)) % 3 > 0
    for visible_triangles in (None, seen, ~seen, np.zeros(len(seen), dtype=bool)):
        flat = unwrapped(model, (1.0, 1.0, 1.0), 0.05, visible_triangles).unwrapping
        np.testing.assert_array_equal(flat.vertices[0][flat.triangles[0]], mesh.triangles)
        assert flat.uvs[0].min() >= 0.0
        assert flat.uvs[0].max() <= 1.0


def test_what_nobody_sees_takes_few_texels() -> None:
    """A model that is not visible takes less than a tenth."""
    model = model_of(box_mesh(1.0))
    full = unwrapped(model, (1.0, 1.0, 1.0), 0.02)
    unseen = unwrapped(model, (1.0, 1.0, 1.0), 0.02, np.zeros(12, dtype=bool))
    assert 10 * unseen.width * unseen.height < full.width * full.height


def test_scale_makes_texels_more_not_larger() -> None:
    """Texels keep their size in the world."""
    model = model_of(box_mesh(0.5))
    small = unwrapped(model, (1.0, 1.0, 1.0), 0.02)
    large = unwrapped(model, (3.0, 3.0, 3.0), 0.02)
    assert 8 < large.width * large.height / (small.width * small.height) < 10


def test_texels_grow_until_all_fit() -> None:
    """A map is never larger than allowed."""
    from dataclasses import replace

    geometry = static_geometry_of(still([Thing(ground(20.0))]))
    everything = np.ones(geometry.triangle_count, dtype=bool)
    layout = laid_out(geometry, replace(COARSE, max_map=128), everything)
    assert layout.side <= 128


def test_layers_of_a_sheet_are_twins() -> None:
    """Each triangle of a sheet of two layers names the one behind it, corner by corner."""
    front = wall_mesh(2.0, 1.0)
    back = mesh_of(front.positions, -front.normals, front.uvs, front.triangles[:, [1, 0, 2]])
    sheets = [Thing(model_of(mesh), Pose((1.0, 2.0, 3.0))) for mesh in (front, back)]
    geometry = static_geometry_of(still([*sheets, Thing(ground(2.0))]))
    paired = back_to_back_faces(geometry)
    np.testing.assert_array_equal(paired.other, [2, 3, 0, 1, -1, -1])
    for triangle in range(4):
        there = geometry.corners[paired.other[triangle]][paired.corner[triangle]]
        np.testing.assert_array_equal(there, geometry.corners[triangle])
