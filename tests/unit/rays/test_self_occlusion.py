"""How much models hide of their own surface, by arithmetic."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.rays import self_occlusion
from sailenv_ros.rays.self_occlusion import vertex_occlusion
from sailenv_ros.types.model import Material, Mesh, Model, ModelPart
from tests.support.curved_meshes import bowl, sheet
from tests.support.tiny_scenes import box_mesh


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SAILENV_CACHE", str(tmp_path))


def model_of(*meshes: Mesh, **material: object) -> Model:
    look = Material(**material)  # type: ignore[arg-type]
    return Model(name="m", parts=tuple(ModelPart(mesh=m, material=look) for m in meshes))


def board(width: int, steep: bool) -> Mesh:
    """Make one of two boards that meet at the y axis at a right angle, 40 m long and 20 m wide."""
    along, across = np.meshgrid(
        np.linspace(-20.0, 20.0, 9), np.linspace(0.0, 20.0, width), indexing="ij"
    )
    zero = np.zeros_like(along)
    points = np.stack([zero, along, across] if steep else [across, along, zero], axis=-1)
    normal = (1.0, 0.0, 0.0) if steep else (0.0, 0.0, 1.0)
    return sheet(points, np.broadcast_to(normal, points.shape).copy())


def test_what_bulges_hides_nothing() -> None:
    """Of a cube and a ball all light arrives."""
    for name in ("cube", "sphere"):
        assert all((part == 0.0).all() for part in vertex_occlusion(Primitives().load(name).model))


def test_half_of_the_light_arrives_in_half_a_sphere() -> None:
    """Inside of a sphere each part is seen by its share of the area, from everywhere."""
    (hidden,) = vertex_occlusion(model_of(bowl()))
    assert np.abs(hidden.mean() - 0.5) < 0.01
    assert np.abs(hidden - 0.5).max() < 0.08


@pytest.mark.parametrize("width", [2, 30])
def test_a_board_at_a_right_angle_takes_half_beside_it(width: int) -> None:
    """Near the corner an endless board takes half; of large triangles the corners say the rest."""
    lying, standing = vertex_occlusion(model_of(board(width, False), board(width, True)))
    middle = lying.reshape(9, width)[4]
    assert abs(middle[0] - 0.5) < 0.1
    assert middle[-1] < 0.25
    assert np.allclose(lying, standing, atol=0.08)


def test_winding_and_emptiness_do_not_matter() -> None:
    """A mirrored model's triangles run the other way round; some parts have none."""
    mesh = bowl()
    turned = replace(mesh, triangles=mesh.triangles[:, [0, 2, 1]].copy())
    nothing = replace(mesh, triangles=mesh.triangles[:0])
    plain, (_, other) = (
        vertex_occlusion(model_of(mesh)),
        vertex_occlusion(model_of(nothing, turned)),
    )
    assert abs(plain[0].mean() - other.mean()) < 0.01
    assert np.abs(plain[0] - other).max() < 0.1
    assert vertex_occlusion(Model(name="empty", parts=())) == ()


@pytest.mark.parametrize("alpha", [0.0, 0.4])
def test_glass_hides_what_it_does_not_let_through(alpha: float) -> None:
    """A cube in a closed glass case gets what comes through it; what lies outside gets all."""
    glass = {"alpha": "blend", "base_colour": (1.0, 1.0, 1.0, alpha)}
    case = model_of(box_mesh(1.0), **glass).parts[0]
    held = model_of(box_mesh(0.02)).parts[0]
    outer, inner = vertex_occlusion(Model(name="m", parts=(case, held)))
    # From the middle rays in all directions of a half space meet faces of a cube.
    turns = np.random.default_rng(3).normal(size=(100_000, 3))
    cosines = np.abs(turns).max(axis=1) / np.linalg.norm(turns, axis=1)
    up = np.maximum(turns[:, 2] / np.linalg.norm(turns, axis=1), 0.0)
    through = (1.0 - alpha) * (glazing(cosines) * up).sum() / up.sum()
    if alpha == 0.0:
        assert not inner.any()  # as clear as that is left out
    else:
        assert np.abs(inner - (1.0 - through)).max() < 0.03
    assert not outer.any()


def glazing(cosine: NDArray[np.float64]) -> NDArray[np.float64]:
    """Share that double glazing lets through, by Fresnel's equations for an index of 1.5."""
    inside = np.sqrt(1.0 - (1.0 - cosine**2) / 2.25)
    across = (cosine - 1.5 * inside) / (cosine + 1.5 * inside)
    along = (1.5 * cosine - inside) / (1.5 * cosine + inside)
    mirrored = 0.5 * (across**2 + along**2)
    return ((1.0 - mirrored) / (1.0 + mirrored)) ** 2


def test_what_was_found_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another process, and a model in another paint, read what the first one found."""
    (made,) = vertex_occlusion(model_of(bowl()))
    monkeypatch.setattr(self_occlusion, "light_share", None)
    (kept,) = vertex_occlusion(model_of(bowl(), base_colour=(1.0, 0.0, 0.0, 1.0)))
    assert made.tobytes() == kept.tobytes()
