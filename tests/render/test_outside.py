"""What lies outside a room, seen through its window: exact truth, and nothing changed inside."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.assets.outside.kinds.street import HOUSES_M
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import WorldSnapshot
from tests.render.conftest import Render
from tests.support.built_world import built_snapshot

VIEWS = ("depth", "instance", "category", "normals", "flow")
LENS = CameraIntrinsics(width=320, height=240)
OUTSIDE_CATEGORY = 151
EYE = (0.3, 0.1, 1.4)
FRONT_M = 1.8 + 0.2 + HOUSES_M - EYE[1]
"""Depth of the houses' fronts: half the room, its wall, the street, less where the eye is."""


def snapshot_of(outside: Any, **room: Any) -> WorldSnapshot:
    keys = {
        "size": [4.4, 3.6, 2.6],
        "openings": [
            {"type": "window", "wall": "north", "at": 0.4, "width": 2.4, "height": 1.5},
            {"type": "door", "wall": "east", "at": -0.8},
        ],
        **({} if outside is None else {"outside": outside}),
        **room,
    }
    sun = {"name": "sun", "type": "directional", "direction": [0.3, 0.7, -0.8], "intensity": 6}
    return built_snapshot({"room": keys, "lights": [sun]})


@pytest.fixture(scope="module")
def street() -> WorldSnapshot:
    """A room with a window onto a street to the north."""
    return snapshot_of("street")


def outside_id(snapshot: WorldSnapshot) -> int:
    (found,) = (d.instance.id for d in snapshot.contents.instances if d.outside is not None)
    return found


def north(eye: tuple[float, float, float] = EYE) -> Camera:
    """Look straight to the north: depth is the distance along y."""
    return Camera(intrinsics=LENS, pose=look_at(eye, (eye[0], eye[1] + 5.0, eye[2])))


def on_fronts(views: dict[str, NDArray[Any]]) -> NDArray[np.bool_]:
    near: NDArray[np.bool_] = np.isclose(views["depth"], FRONT_M, rtol=1e-6)
    return near


def test_the_houses_opposite_have_their_exact_depth(render: Render, street: WorldSnapshot) -> None:
    views = render(street, north(), *VIEWS[:4])
    seen = views["instance"] == outside_id(street)
    assert (views["category"][seen] == OUTSIDE_CATEGORY).all()
    assert seen.mean() > 0.15
    assert (on_fronts(views) & seen).sum() > 0.2 * seen.sum()
    assert np.isfinite(views["depth"][seen]).all()
    facing = views["normals"][on_fronts(views) & seen]
    np.testing.assert_allclose(facing, np.broadcast_to((0.0, 0.0, -1.0), facing.shape), atol=1e-3)


def test_it_moves_by_as_much_as_its_distance_says(render: Render, street: WorldSnapshot) -> None:
    """A step aside of 0.2 m: what is 15 m away moves by fx * 0.2 / 15, the wall by far more."""
    aside = (EYE[0] + 0.2, EYE[1], EYE[2])
    before, now = north(), north(aside)
    views = render(street, now, *VIEWS, past=(street, before))
    fronts = on_fronts(views) & (views["instance"] == outside_id(street))
    moved = views["flow"][fronts]
    np.testing.assert_allclose(moved[:, 0], -LENS.fx * 0.2 / FRONT_M, rtol=1e-4)
    np.testing.assert_allclose(moved[:, 1], 0.0, atol=1e-3)
    inner = np.isclose(views["depth"], 1.8 - EYE[1], rtol=1e-6)
    assert np.abs(views["flow"][inner, 0]).min() > 8.0 * np.abs(moved[:, 0]).max()


def test_none_is_what_a_room_without_the_field_is(render: Render) -> None:
    first = render(snapshot_of(None), north(), "rgb", *VIEWS[:4])
    second = render(snapshot_of("none"), north(), "rgb", *VIEWS[:4])
    for name, view in first.items():
        np.testing.assert_array_equal(view, second[name])


def test_the_room_itself_looks_as_it_did(render: Render, street: WorldSnapshot) -> None:
    """No light of it falls in, no shadow; pictures differ behind the panes and at their edges."""
    bare = snapshot_of(None)
    camera = replace(north(), picture=replace(north().picture, smooth_edges=False))
    without = render(bare, camera, "rgb", "instance")
    seen = render(street, camera, "rgb", "instance")
    inside = seen["instance"] != outside_id(street)
    np.testing.assert_array_equal(without["instance"][inside], seen["instance"][inside])
    assert (without["instance"][~inside] == 0).all()
    glass = [d.instance.id for d in bare.contents.instances if d.instance.name == "window 1"]
    still = inside & ~np.isin(seen["instance"], glass) & (without["instance"] != 0)
    np.testing.assert_array_equal(without["rgb"][still], seen["rgb"][still])


def test_it_is_bright_by_day_and_follows_the_exposure(
    render: Render, street: WorldSnapshot
) -> None:
    """Blended with the room it is light, neither black nor white, at any exposure.

    The panes mirror 15 % of the room, which the longest one makes nearly white.
    """
    at_id = outside_id(street)
    for exposure in (-1.0, 1.0, 3.0):
        contents = street.contents
        environment = replace(contents.environment, exposure=exposure)
        snapshot = replace(street, contents=replace(contents, environment=environment))
        views = render(snapshot, north(), "rgb", "instance")
        mean = views["rgb"][views["instance"] == at_id].mean()
        assert (60 if exposure < 0.0 else 110) < mean < 245, exposure


def test_both_renderers_show_the_same(street: WorldSnapshot, render: Render) -> None:
    """At pixels' centres: of leaves, samples of smooth edges see others."""
    camera = replace(north(), picture=PictureSettings(smooth_edges=False))
    native = NativeRenderer()
    ours = native.render(RenderRequest(street, camera, ("rgb", "instance", "depth"))).views
    native.close()
    theirs = render(street, camera, "rgb", "instance", "depth")
    same = ours["instance"] == theirs["instance"]
    assert same.mean() > 0.999
    seen = same & (ours["instance"] == outside_id(street))
    off = np.abs(ours["rgb"].astype(int) - theirs["rgb"])[seen].max(axis=-1)
    assert (off <= 2).mean() > 0.9
    close = np.isclose(ours["depth"], theirs["depth"], rtol=1e-5)
    # Leaves are there or not by a rounding of their textures.
    assert close[seen].mean() > 0.99


@pytest.mark.parametrize("smooth", [True, False])
def test_drawing_it_through_openings_alone_changes_no_pixel(
    street: WorldSnapshot, smooth: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From ten places in the room: towards the window, past it, and away from it."""
    names = ("rgb", "depth", "instance", "normals")
    rng = np.random.default_rng(5)
    cut, whole = NativeRenderer(), NativeRenderer()
    monkeypatch.setattr(whole._drawing._openings, "of", lambda *_: None)
    narrower = 0
    for _ in range(10):
        eye = tuple(rng.uniform((-2.0, -1.6, 0.3), (2.0, 1.7, 2.4)))
        target = rng.uniform((-2.2, -1.8, 0.0), (2.2, 3.0, 2.6))
        camera = Camera(
            intrinsics=CameraIntrinsics(
                width=160, height=120, vertical_fov_deg=float(rng.uniform(40, 110))
            ),
            pose=look_at(eye, target),
        )
        camera = replace(camera, picture=replace(camera.picture, smooth_edges=smooth))
        found = cut._drawing._openings.of(street, camera)
        assert found is not None
        narrower += found[1] != (0, 0, 159, 119)
        one = cut.render(RenderRequest(street, camera, names)).views
        other = whole.render(RenderRequest(street, camera, names)).views
        for name in names:
            np.testing.assert_array_equal(one[name], other[name])
    assert narrower >= 8
    cut.close()
    whole.close()


def test_a_room_that_is_open_shows_it_everywhere(street: WorldSnapshot) -> None:
    """Without a ceiling, from outside, and where a wall has been taken away."""
    renderer = NativeRenderer()
    openings = renderer._drawing._openings
    assert openings.of(street, north()) is not None
    assert openings.of(street, north((0.0, 6.0, 1.0))) is None
    assert openings.of(snapshot_of("street", ceiling=False), north()) is None
    kept = [drawn.instance.name != "south wall" for drawn in street.contents.instances]
    fewer = street.of_rows(np.array(kept))
    assert openings.of(fewer, north()) is None
    renderer.close()
