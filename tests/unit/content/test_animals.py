"""Cats and dogs that rules make: meshes, weights, names, truth in a frame."""

from __future__ import annotations

import numpy as np
import pytest

from sailenv_content.animals.anatomy import anatomy_of
from sailenv_content.animals.looks import animals
from sailenv_content.animals.making import animal_arrays
from sailenv_content.animals.shape import body_of, grid_of
from sailenv_content.animals.source import AnimalSource
from sailenv_content.animals.surface import surface_of
from sailenv_ros import AgentSpec, CameraIntrinsics, Simulation
from sailenv_ros.assets.asset_library import AssetLibrary
from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.sources import installed_sources
from sailenv_ros.cli.main import main
from sailenv_ros.dataset.formats.coco import _keypoints
from sailenv_ros.errors import UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.rays.opaque_models import deformed_model
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.model import Asset

SCENE = """
version: 1
objects:
  - {name: ground, asset: plane, static: true, scale: [6, 6, 1]}
  - {name: tom, asset: cat_01, position: [-0.4, 0, 0], behaviours: [{type: walk_around}]}
  - {name: rex, asset: dog_03, position: [0.4, 0.3, 0], rotation: [0, 0, -90]}
"""


@pytest.fixture(scope="module")
def assets() -> dict[str, Asset]:
    library = AssetLibrary(installed_sources())
    return {name: library.get(name) for name in ("cat_01", "dog_03")}


@pytest.fixture(scope="module")
def frames(tmp_path_factory: pytest.TempPathFactory) -> list[Frame]:
    """Two frames of a cat that walks and a dog that stands."""
    path = tmp_path_factory.mktemp("animals") / "scene.yaml"
    path.write_text(SCENE)
    lens = CameraIntrinsics(width=320, height=240, vertical_fov_deg=50.0)
    eye = AgentSpec(name="eye", intrinsics=lens, following=False)
    found = []
    with Simulation(path, mode="lockstep", agent=eye, light="plain") as simulation:
        simulation.set_pose(look_at((0.0, -1.5, 0.6), (0.0, 0.1, 0.15)), teleport=True)
        simulation.step(120)
        views = ["depth", "instance", "category", "flow"]
        for _ in range(2):
            simulation.step(8)
            found.append(simulation.capture(views))
    return found


def id_of(frame: Frame, name: str) -> int:
    assert frame.info is not None
    return next(one.id for one in frame.info.instances if one.name == name)


def test_an_animal_is_the_same_bytes() -> None:
    anatomy = anatomy_of(animals()["cat_02"])
    first, second = animal_arrays(anatomy), animal_arrays(anatomy)
    assert first.keys() == second.keys()
    assert all(first[key].tobytes() == second[key].tobytes() for key in first)


@pytest.mark.parametrize("name", list(animals()))
def test_a_body_is_one_closed_surface_that_stands_on_the_floor(name: str) -> None:
    anatomy = anatomy_of(animals()[name])
    body = body_of(anatomy)
    vertices, normals, triangles = surface_of(body, grid_of(anatomy, body), 0.004 * anatomy.unit)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    there, back = (np.sort(edges @ step) for step in ([len(vertices), 1], [1, len(vertices)]))
    assert (there == back).all()
    corners = vertices[triangles]
    areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.linalg.norm(areas, axis=1).min() > 1e-10
    assert np.einsum("tk,tk->", corners[:, 0], areas) > 0.0  # it faces outwards
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    # In one piece.
    piece = np.arange(len(vertices))
    while True:
        before = piece.copy()
        np.minimum.at(piece, edges[:, 0], piece[edges[:, 1]])
        piece = piece[piece]
        if (piece == before).all():
            break
    assert (piece == 0).all()
    assert vertices[:, 2].min() == 0.0
    for leg in ("forepaw.L", "forepaw.R", "hindpaw.L", "hindpaw.R"):
        near = np.abs(vertices[:, :2] - anatomy[leg][:2]).max(axis=1) < 0.1 * anatomy.unit
        assert vertices[near, 2].min() < 0.002


def test_weights_sum_to_one_and_categories_have_coco_names(assets: dict[str, Asset]) -> None:
    names = {category.name for category in load_categories().values()}
    for asset in assets.values():
        assert asset.category in {"cat", "dog"} <= names
        assert asset.rig is not None
        assert asset.rig.legs == 4
        assert asset.model.triangle_count < 20000
        for bones, weights in zip(asset.rig.bones, asset.rig.weights, strict=True):
            assert np.allclose(weights.sum(axis=1), 1.0, atol=1e-5)
            assert (weights >= 0.0).all()
            assert int(bones.max()) < len(asset.rig.names)
    assert assets["cat_01"].category == "cat"
    assert assets["dog_03"].category == "dog"


def test_animals_have_names_of_their_own() -> None:
    source = AnimalSource()
    assert source.speaks_of("cat_99")
    assert not source.speaks_of("cat")
    with pytest.raises(UnknownName, match="animal must be one of: cat_01, "):
        source.load("dog_99")
    assert {look.kind for look in animals().values()} == {"cat", "dog"}


def test_the_command_lists_and_shows_animals(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["assets", "show", "cat_01"]) == 0
    told = capsys.readouterr().out
    assert told.startswith("cat_01 ")
    assert "4.2 kg" in told
    assert main(["assets", "list"]) == 0
    assert "Brown tabby cat" in capsys.readouterr().out


def test_frames_have_labels_and_joints_but_no_keypoints_of_people(frames: list[Frame]) -> None:
    frame = frames[0]
    tom, rex = (id_of(frame, name) for name in ("tom", "rex"))
    categories = load_categories()
    for one, kind in ((tom, "cat"), (rex, "dog")):
        seen = frame["instance"] == one
        assert seen.sum() > 500
        assert (frame["category"][seen] == categories.named(kind).id).all()
        assert _keypoints(frame, one) == {}
    joints = frame.joints(rex)
    number = joints.names.index("forepaw.L")
    assert joints.visible[number]
    u, v = np.rint(joints.pixels[number]).astype(int)
    assert frame["instance"][v, u] == rex
    # What is deeper in its body than flesh of its size is hidden by itself.
    camera = frame.camera.camera_from_world
    depths = joints.world @ camera[2, :3] + camera[2, 3]
    columns, rows = np.rint(joints.pixels).astype(int).T
    below = depths - frame["depth"][rows, columns]
    inside = frame["instance"][rows, columns] == rex
    assert (
        joints.visible[inside] == (below[inside] < 0.125 * np.ptp(joints.world, axis=0).max())
    ).all()
    assert joints.visible[inside].any()
    assert (joints.hidden_by[inside & ~joints.visible] == rex).all()
    paws = [n for n, name in enumerate(joints.names) if "paw" in name]
    assert len(paws) == 4
    assert joints.world[paws, 2] == pytest.approx(joints.world[paws[0], 2], abs=0.003)


def test_flow_on_skin_is_that_of_its_vertices(frames: list[Frame]) -> None:
    before, frame = frames[:2]
    assert frame.states is not None
    assert before.states is not None
    camera, checked = frame.camera, 0
    eye, turn = camera.world_from_camera[:3, 3], camera.world_from_camera[:3, :3]
    rng = np.random.default_rng(1)
    for name in ("tom", "rex"):
        one = id_of(frame, name)
        now, then = (deformed_model(f.states.deformations[one]) for f in (frame, before))  # type: ignore[union-attr]
        own, own_then = (f.states.matrices[f.states.row(one)] for f in (frame, before))  # type: ignore[union-attr]
        rows, columns = np.nonzero(frame["instance"] == one)
        for pick in rng.choice(len(rows), 60, replace=False):
            v, u = int(rows[pick]), int(columns[pick])
            ray = own[:3, :3].T @ turn @ camera.intrinsics.rays()[v, u]
            hit = nearest_hit(now.corners, own[:3, :3].T @ (eye - own[:3, 3]), ray)
            if hit is None:
                continue
            triangle, weights = hit
            place = own[:3, :3] @ (weights @ now.corners[triangle]) + own[:3, 3]
            depth = float((place - eye) @ turn[:, 2])
            if abs(depth - float(frame["depth"][v, u])) > 1e-4:
                continue
            world = own_then[:3, :3] @ (weights @ then.corners[triangle]) + own_then[:3, 3]
            matrix = before.camera.camera_from_world
            pixel = before.camera.intrinsics.project((matrix[:3, :3] @ world + matrix[:3, 3])[None])
            told = frame["flow"][v, u] * frame.dt_s
            assert np.abs(told - ([u, v] - pixel[0])).max() < 0.01
            checked += 1
    assert checked > 60


def nearest_hit(
    corners: np.ndarray, origin: np.ndarray, ray: np.ndarray
) -> tuple[int, np.ndarray] | None:
    """The nearest triangle that faces a ray, and the weights of its corners, by Möller-Trumbore."""
    first, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    p, q = np.cross(ray, ac), np.cross(origin - first, ab)
    with np.errstate(all="ignore"):
        determinant = (p * ab).sum(axis=1)
        u = (p * (origin - first)).sum(axis=1) / determinant
        v = (q @ ray) / determinant
        t = (q * ac).sum(axis=1) / determinant
    met = (np.minimum(u, v) > 0.01) & (u + v < 0.99) & (t > 0.0) & (determinant > 0.0)
    if not met.any():
        return None
    best = int(np.argmin(np.where(met, t, np.inf)))
    return best, np.array([1.0 - u[best] - v[best], u[best], v[best]])


def test_skin_at_rest_has_no_flow(frames: list[Frame]) -> None:
    moved = frames[1]
    # Paws of the dog that stands rest although it breathes and looks about.
    rex = id_of(moved, "rex")
    joints = moved.joints(rex)
    low = joints.pixels[joints.names.index("forepaw.L")]
    rows, columns = np.nonzero(moved["instance"] == rex)
    near = np.hypot(columns - low[0], rows - low[1]) < 3.0
    assert near.any()
    assert (moved["flow"][rows[near], columns[near]] == 0.0).all()
    assert (moved["flow"][rows, columns] != 0.0).any()
