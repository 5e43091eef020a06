"""See-through surfaces: in the picture by their formula, in the ground truth not at all."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.types.colour import LINEAR_OF_SRGB8, srgb_from_linear
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment
from sailenv_ros.types.model import Mesh
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.views import LIT_VIEWS, RENDERED_VIEWS
from tests.render.conftest import Render
from tests.support.tiny_scenes import (
    FRAME_NS,
    Thing,
    box_mesh,
    camera_at,
    contents_of,
    mesh_of,
    model_of,
    moved,
    snapshot_of,
    two_instants,
    wall_mesh,
)

PANE = 2 * 0.04 / 1.04  # of two faces, with all that goes to and fro
LEVEL = 0.3
GREY = (LEVEL, LEVEL, LEVEL)
UNIFORM = Environment(sky_zenith=GREY, sky_horizon=GREY, sky_ground=GREY)
PLAIN = PictureSettings(tone_curve="linear", occlusion_strength=0.0, smooth_edges=False)
EYE = replace(camera_at(), picture=PLAIN)
WALL = wall_mesh(30.0, 30.0)
ATTRIBUTES = "positions", "normals", "uvs"


def glass(rgba: tuple[float, float, float, float], distance_m: float, **material: object) -> Thing:
    """A sheet at right angles to the view that fills the picture."""
    sheet = model_of(WALL, base_colour=rgba, alpha="blend", roughness=0.05, **material)
    return Thing(sheet, Pose((distance_m, 0, 0)))


def test_ground_truth_is_of_what_lies_behind(render: Render) -> None:
    """With panes that move before everything, all other views are the same bytes as without."""
    before, after, past, now = two_instants()
    drawn = before.contents.instances
    pane = glass((0.2, 0.5, 0.3, 0.7), 0.0, double_sided=True)
    # Their ids follow the others'.
    (first, second) = contents_of([pane, pane], first_id=len(drawn) + 1).instances
    contents = replace(before.contents, instances=(*drawn, first, second))
    glazed = [
        replace(
            snapshot,
            contents=contents,
            world_from_body=np.concatenate([snapshot.world_from_body, panes]),
            histories=np.ones(len(drawn) + 2, np.int64),
        )
        for snapshot, panes in (
            (before, [Pose((1.0, 0, 0)).matrix(), Pose((2.0, 0, 0)).matrix()]),
            (after, [Pose((1.5, 0, 0)).matrix(), Pose((2.5, 0, 0)).matrix()]),
        )
    ]
    names = list(RENDERED_VIEWS)
    plain = render(after, now, *names, past=(before, past))
    seen = render(glazed[1], now, *names, past=(glazed[0], past))
    assert len(np.unique(plain["instance"])) > 5
    for name in set(names) - LIT_VIEWS:
        assert seen[name].tobytes() == plain[name].tobytes(), name
    assert (seen["rgb"] != plain["rgb"]).any(axis=-1).mean() > 0.9


@pytest.mark.parametrize("alpha", [0.0, 0.25, 0.8])
def test_what_comes_through_and_what_is_added(render: Render, alpha: float) -> None:
    """Head-on: (1 - F)(1 - a)(1 - a + a hue) of what lies behind, F mirrored, (1 - F) a lit."""
    colour, behind = np.array([0.1, 0.4, 0.2]), np.array([0.6, 0.5, 0.05])
    environment = replace(UNIFORM, background="colour", background_colour=tuple(behind))
    pane = glass((*colour, alpha), 2.0)
    rgb = render(snapshot_of([pane], lights=(), environment=environment), EYE, "rgb")["rgb"]
    fresnel, hue = PANE, colour / colour.max()
    expected = (1 - fresnel) * (1 - alpha) * (1 - alpha + alpha * hue) * behind
    expected += fresnel * LEVEL + (1 - fresnel) * alpha * colour * LEVEL
    assert np.abs(rgb[35:37, 47:49] - 255 * srgb_from_linear(expected)).max() <= 1.0


def test_clear_glass_in_uniform_light_is_invisible(render: Render) -> None:
    """What it mirrors is what it keeps back, at every angle."""
    box = model_of(box_mesh(1.2), base_colour=(1, 1, 1, 0), alpha="blend", double_sided=True)
    scene = snapshot_of(
        [Thing(box, Pose.from_rpy_deg((2.0, 0, 0), (10, 20, 30)))], lights=(), environment=UNIFORM
    )
    assert np.ptp(render(scene, EYE, "rgb")["rgb"].astype(int)) <= 1


def test_the_nearest_pane_comes_last(render: Render) -> None:
    """The order in which a scene names its panes does not matter; where they are does."""
    red, blue = (0.9, 0.05, 0.05, 0.6), (0.05, 0.05, 0.9, 0.6)

    def seen(*panes: Thing) -> np.ndarray:
        scene = snapshot_of(list(panes), lights=(), environment=UNIFORM)
        return render(scene, EYE, "rgb")["rgb"].astype(int)

    red_first = seen(glass(red, 2.0), glass(blue, 3.0))
    np.testing.assert_array_equal(red_first, seen(glass(blue, 3.0), glass(red, 2.0)))
    blue_first = seen(glass(blue, 2.0), glass(red, 3.0))
    assert (red_first[..., 0] - red_first[..., 2] > 40).all()
    assert (blue_first[..., 2] - blue_first[..., 0] > 40).all()


def test_glass_behind_a_wall_is_not_seen(render: Render) -> None:
    """And a wall that moves out of the way shows it."""
    wall = Thing(model_of(wall_mesh(60, 60)), Pose((2.0, 0, 0)))
    pane = glass((0.2, 0.9, 0.2, 0.8), 3.0)
    bare = render(snapshot_of([wall]), EYE, "rgb")["rgb"]
    both = [wall, pane]
    contents = contents_of(both)
    hidden = render(snapshot_of(both, contents=contents), EYE, "rgb")["rgb"]
    np.testing.assert_array_equal(hidden, bare)
    aside = moved(both, Pose((4.0, 0, 0)), pane.pose)
    shown = render(snapshot_of(aside, contents=contents, time_ns=FRAME_NS), EYE, "rgb")["rgb"]
    assert (shown[..., 1].astype(int) - shown[..., 0] > 30).all()


def test_a_map_colours_glass(render: Render) -> None:
    """Texels of alpha 0 are clear, others dense: stained glass."""
    texture = np.zeros((8, 8, 4), np.uint8)
    texture[:, :4] = (255, 0, 0, 255)
    pane = glass((1, 1, 1, 1), 2.0, base_colour_texture=np.repeat(np.repeat(texture, 16, 0), 16, 1))
    black = replace(UNIFORM, background="colour", background_colour=(0.5, 0.5, 0.5))
    narrow = replace(EYE, intrinsics=replace(EYE.intrinsics, vertical_fov_deg=100.0))
    rgb = render(snapshot_of([pane], lights=(), environment=black), narrow, "rgb")["rgb"]
    left, right = rgb[36, 46].astype(int), rgb[36, 50].astype(int)
    assert left[0] > left[1] + 40
    assert np.ptp(right) <= 1


@pytest.mark.parametrize(("facing", "matt", "mirrored"), [("up", 0.54, 0.9), ("aside", 0.1, 0.1)])
def test_panes_are_lit_by_the_sky_as_other_surfaces_are(
    facing: str, matt: float, mirrored: float, render: Render
) -> None:
    """A white pane that lets nothing through shows the law's irradiance, and 4 % of a mirror."""
    sheet = model_of(
        WALL, base_colour=(1, 1, 1, 1), alpha="blend", roughness=0.05, double_sided=True
    )
    low, high = (0.1, 0.1, 0.1), (0.9, 0.9, 0.9)
    sky = Environment(sky_zenith=high, sky_horizon=low, sky_ground=low)
    pose, eye = Pose((2.0, 0.0, 0.0)), EYE
    if facing == "up":
        pose = Pose.from_rpy_deg((0.0, 0.0, 0.0), (0, 90, 0))
        eye = replace(EYE, pose=look_at((0.0, 0.0, 2.0), (1e-3, 0.0, 0.0)))
    scene = snapshot_of([Thing(sheet, pose)], lights=(), environment=sky)
    seen = render(scene, eye, "rgb")["rgb"][36, 48].astype(float)
    wanted = PANE * mirrored + (1 - PANE) * matt
    np.testing.assert_allclose(seen, 255.0 * srgb_from_linear(wanted), atol=1.0)


@pytest.mark.parametrize("turn", [0.0, 17.0])
def test_borders_of_glass_are_smooth(native: NativeRenderer, turn: float) -> None:
    """Dense cloth, which mirrors nothing, dims each pixel by the share of it that it covers."""
    size = 0.8
    sheet = model_of(
        wall_mesh(size, size), base_colour=(0, 0, 0, 0.8), alpha="blend", roughness=1.0
    )
    thing = Thing(sheet, Pose.from_rpy_deg((2.0, 0.003, 0.001), (turn, 0, 0)))
    environment = replace(UNIFORM, background="colour", background_colour=GREY)
    scene = snapshot_of([thing], lights=(), environment=environment)
    eye = replace(camera_at(), picture=replace(PLAIN, smooth_edges=True))
    rgb = native.render(RenderRequest(scene, eye, ("rgb",))).views["rgb"]
    light = LINEAR_OF_SRGB8[rgb[..., 1]] / LINEAR_OF_SRGB8[rgb[0, 0, 1]]
    covered = (1.0 - light) / (1.0 - 0.2 * 0.2)
    # Of 16 by 16 points of each pixel: where rays through them meet the sheet.
    lens, steps = eye.intrinsics, (np.arange(16) + 0.5) / 16 - 0.5
    u = (np.arange(lens.width)[:, None] + steps).ravel()
    v = (np.arange(lens.height)[:, None] + steps).ravel()
    y = -(u - lens.cx) / lens.fx * 2.0 - 0.003
    z = -(v - lens.cy) / lens.fy * 2.0 - 0.001
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    along, up = c * y[None] + s * z[:, None], c * z[:, None] - s * y[None]
    inside = np.maximum(np.abs(along), np.abs(up)) < 0.5 * size
    shares = inside.reshape(lens.height, 16, lens.width, 16).mean(axis=(1, 3))
    border = (shares > 0.0) & (shares < 1.0)
    assert border.sum() > 50
    error = covered - shares
    assert np.abs(error).max() < 0.25
    assert np.abs(error)[border].mean() < 0.08
    assert abs(error.sum()) < 0.01 * shares.sum()
    inner = shares == np.roll(shares, 1, 0)
    for step, axis in ((-1, 0), (1, 1), (-1, 1)):
        inner &= shares == np.roll(shares, step, axis)
    assert np.abs(error[inner]).max() < 0.02


def test_narrow_folds_of_a_net_are_not_dashed(native: NativeRenderer) -> None:
    """A strip of a third of a pixel before a sheet of the same cloth, a little out of plumb."""
    look = {"base_colour": (0, 0, 0, 0.4), "alpha": "blend", "roughness": 1.0}
    sheet = Thing(model_of(WALL, **look), Pose((2.2, 0, 0)))
    eye = replace(camera_at(), picture=replace(PLAIN, smooth_edges=True))
    pixel = 2.0 / eye.intrinsics.fx
    strip = Thing(
        model_of(wall_mesh(pixel / 3.0, 30.0), **look),
        Pose.from_rpy_deg((2.0, 0.0, 0.0), (2.0, 0, 0)),
    )
    environment = replace(UNIFORM, background="colour", background_colour=GREY)
    scene = snapshot_of([sheet, strip], lights=(), environment=environment)
    rgb = native.render(RenderRequest(scene, eye, ("rgb",))).views["rgb"]
    light = LINEAR_OF_SRGB8[rgb[8:-8, :, 1]]
    taken = (light[:, :10].mean() - light).clip(0.0).sum(axis=1)
    # Black cloth lets (1 - a)(1 - a) through; it covers a third of a pixel.
    whole = light[:, :10].mean() * (1.0 - 0.6 * 0.6) / 3.0
    assert taken.mean() == pytest.approx(whole, rel=0.1)
    assert taken.min() > 0.5 * whole
    assert taken.max() < 1.6 * whole


def test_the_far_wall_of_a_vessel_comes_first(native: NativeRenderer) -> None:
    """Triangles of one part are drawn by their distance, not in the order of the mesh."""
    near, far = wall_mesh(30.0, 30.0), wall_mesh(30.0, 30.0)
    near = replace(near, positions=near.positions + np.float32([2.0, 0.0, 0.0]))
    far = replace(far, positions=far.positions + np.float32([3.0, 0.0, 0.0]))

    def seen(*walls: Mesh) -> NDArray[np.uint8]:
        joined = mesh_of(
            *(np.concatenate([getattr(one, name) for one in walls]) for name in ATTRIBUTES),
            np.concatenate([one.triangles + 4 * k for k, one in enumerate(walls)]),
        )
        look = {"base_colour": (0.2, 0.8, 0.3, 0.6), "alpha": "blend", "roughness": 0.05}
        scene = snapshot_of([Thing(model_of(joined, **look))], lights=(), environment=UNIFORM)
        rgb: NDArray[np.uint8] = native.render(RenderRequest(scene, EYE, ("rgb",))).views["rgb"]
        return rgb

    pictures = seen(near, far), seen(far, near)
    assert (pictures[0][36, 48] != seen(near)[36, 48]).any()
    np.testing.assert_array_equal(*pictures)
