"""Views of cameras with parallel rays, against rays and arithmetic of the tests' own.

`ray_cast` and `embree_cast` place the rays by fx, fy, cx, cy alone, and share no code with the
rasteriser. Rolling shutters are in `test_shutters`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from sailenv_ros.errors import InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.motion.between import motion
from sailenv_ros.frame.motion.tracks import ObjectPoints, track
from sailenv_ros.native.library import load_library, using_instruction_set
from sailenv_ros.rays.scene_geometry import SceneGeometry
from sailenv_ros.render.contract import RenderRequest
from sailenv_ros.render.cpu.amodal_renderer import AmodalRenderer
from sailenv_ros.render.cpu.renderer import NativeRenderer
from sailenv_ros.render.gl.renderer import Renderer
from sailenv_ros.simulation.simulation import Simulation
from sailenv_ros.simulation.view_planes import view_planes
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import Observation, WorldSnapshot
from tests.render.test_picture import gallery
from tests.support.embree_cast import RayCast
from tests.support.picture_edges import grown
from tests.support.ray_cast import cast, flow_by_arithmetic, points_met
from tests.support.room_of_things import (
    CAMERA_PATHS,
    SKIN,
    room_of_things,
    room_that_moves,
    seen,
)
from tests.support.tiny_scenes import (
    FORWARD,
    FRAME_NS,
    SUN,
    Thing,
    box_mesh,
    contents_of,
    model_of,
    snapshot_of,
    wall_mesh,
)

WIDTH, HEIGHT = 203, 151
DOWN = (0.0, 90.0, 0.0)


def lens_of(scale: float = 40.0, **more: Any) -> CameraIntrinsics:
    """Of so many pixels a metre; pixels are a little wider than high."""
    numbers: dict[str, Any] = {"width": WIDTH, "height": HEIGHT, "fx_px": scale}
    numbers |= {"fy_px": 1.1 * scale, "cx_offset_px": 4.5, "cy_offset_px": -3.25, **more}
    return CameraIntrinsics(distortion_model="orthographic", **numbers)


def camera_at(pose: Pose = FORWARD, scale: float = 40.0, **more: Any) -> Camera:
    """A camera of parallel rays."""
    return Camera(intrinsics=lens_of(scale, **more), pose=pose)


SLANTED = Pose.from_rpy_deg((0.1, 0.2, 0.1), (3.0, 8.0, 20.0))
PLAN = Pose.from_rpy_deg((0.1, -0.2, 2.2), DOWN)
ACROSS = look_at((0.9, 0.0, 1.5), (-1.9, -0.3, 1.1))


def test_ids_depth_and_normals_are_what_rays_meet(native: NativeRenderer) -> None:
    """At every pixel away from edges; range is depth, and the lens sees everywhere."""
    scene = snapshot_of(room_of_things())
    views = ("instance", "depth", "range", "normals", "lens_valid", "object_coords")
    for pose in (SLANTED, FORWARD, Pose.from_rpy_deg((0.0, 0.0, 0.4), DOWN)):
        camera = camera_at(pose)
        made = seen(native, scene, camera, *views)
        hits = cast(scene, camera)
        away = hits.away_from_edges()
        ids = np.where(hits.row >= 0, hits.row + 1, 0)
        assert away.sum() > 0.5 * away.size
        assert (made["instance"][away] == ids[away]).all()
        assert (made["instance"] != ids).sum() <= 1e-4 * ids.size
        met = away & np.isfinite(hits.depth) & (hits.depth >= 0.05)
        np.testing.assert_allclose(made["depth"][met], hits.depth[met], rtol=1e-5)
        np.testing.assert_allclose(made["normals"][met], hits.normal[met], atol=1e-5)
        assert np.isposinf(made["depth"][away & ~np.isfinite(hits.depth)]).all()
        np.testing.assert_array_equal(made["range"], made["depth"])
        assert made["lens_valid"].all()
        eye = points_met(camera, hits.depth)[met]
        world = eye @ camera.world_from_camera[:3, :3].T + camera.world_from_camera[:3, 3]
        stands = scene.world_from_body[hits.row[met]]
        own = np.einsum("nji,nj->ni", stands[:, :3, :3], world - stands[:, :3, 3])
        np.testing.assert_allclose(made["object_coords"][met], own, atol=2e-5)


@pytest.mark.parametrize("pose", [PLAN, ACROSS], ids=["plan", "across"])
def test_a_furnished_room_is_what_rays_meet(
    native: NativeRenderer, room_01: WorldSnapshot, pose: Pose
) -> None:
    """All ids and depths away from edges; walls that the camera's plane cuts are open there."""
    camera = camera_at(pose, 33.0)
    views = seen(native, room_01, camera, "instance", "depth")
    ids, depth, masked = RayCast(room_01).look(camera)
    inside = ~_near_edges(ids, depth) & ~grown(masked)
    assert inside.sum() > 0.5 * inside.size
    assert (views["instance"][inside] == ids[inside]).all()
    np.testing.assert_allclose(views["depth"][inside], depth[inside], rtol=1e-4)


def test_depth_of_tilted_planes_to_the_border(native: NativeRenderer) -> None:
    """To 1e-5 of the depth at each pixel, also the outermost; beyond far there is nothing."""
    wall = model_of(wall_mesh(400.0, 400.0))
    for tilt, far_m in ((0.0, 14.0), (10.0, 12.1), (45.0, 14.0), (70.0, 60.0), (-70.0, 60.0)):
        pose = Pose.from_rpy_deg((12.0, 0.0, 0.0), (5.0, tilt, 0.5 * tilt))
        scene = snapshot_of([Thing(wall, pose)])
        camera = camera_at(far_m=far_m)
        depth = seen(native, scene, camera, "depth")["depth"]
        optical = camera.camera_from_world @ pose.matrix()
        normal, point = optical[:3, 0], optical[:3, 3]
        grid = points_met(camera, np.zeros(depth.shape))
        expected = ((point - grid) @ normal) / normal[2]
        there = (expected > 0.0) & (expected < far_m)
        sure = np.minimum(expected, np.abs(expected - far_m)) > 1e-3
        assert there[0].any() or there[-1].any()
        assert there[:, 0].any() or there[:, -1].any()
        np.testing.assert_allclose(depth[there & sure], expected[there & sure], rtol=1e-5)
        assert np.isposinf(depth[~there & sure]).all()


def test_rays_begin_at_the_cameras_plane(native: NativeRenderer) -> None:
    """What lies behind it is not there; what is nearer than near keeps its label without depth."""
    wall = model_of(wall_mesh(1.0, 1.0), double_sided=True)
    places = [(-0.2, 1.2, 0.0), (0.03, 0.0, 0.0), (0.3, -1.2, 0.0), (4.0, 0.0, 0.0)]
    things = [Thing(wall, Pose(place)) for place in places]
    things[3] = replace(things[3], model=model_of(wall_mesh(20.0, 20.0)))
    made = seen(native, snapshot_of(things), camera_at(near_m=0.05), "instance", "depth")
    row = 75
    columns = np.rint(lens_of().cx + 40.0 * np.array([-1.2, 0.0, 1.2])).astype(int)
    np.testing.assert_array_equal(made["instance"][row, columns], [4, 2, 3])
    np.testing.assert_allclose(made["depth"][row, columns], [4.0, np.nan, 0.3], rtol=1e-6)


@pytest.mark.parametrize("kind", ["turn", "shift", "things", "still"])
def test_flow_is_what_arithmetic_says(native: NativeRenderer, kind: str) -> None:
    """To 0.01 px away from edges; exactly 0 where nothing has moved."""
    before, after = room_that_moves(kind == "things", walls=5)
    then = camera_at(CAMERA_PATHS["still"])
    now = replace(then, pose=CAMERA_PATHS.get(kind, then.pose))
    past = Observation(snapshot=before, camera=then)
    views = dict(
        native.render(RenderRequest(after, now, ("flow", "flow_valid", "occlusion"), past)).views
    )
    hits = cast(after, now)
    expected = flow_by_arithmetic(hits, after, now, before, then)
    away = hits.away_from_edges()
    near = hits.depth < now.intrinsics.near_m
    exists = away & np.isfinite(expected[..., 0]) & ~near
    assert exists.sum() > 5000
    assert (away & (hits.row < 0)).sum() > 500
    np.testing.assert_array_equal(views["flow_valid"][away], exists[away])
    off_px = (views["flow"][exists] - expected[exists]) * FRAME_NS * 1e-9
    assert np.abs(off_px).max() < 0.01
    if kind == "still":
        assert not views["flow"][exists].any()
        assert not views["occlusion"][exists].any()
    else:
        assert np.abs(expected[exists]).max() * FRAME_NS * 1e-9 > 1.0


def test_objects_alone_cover_the_pixels_that_they_have(native: NativeRenderer) -> None:
    """Masks contain what is visible, and are those of the thing without the others."""
    things = room_of_things()
    camera = camera_at(SLANTED)
    renderer = AmodalRenderer()
    scene = snapshot_of(things)
    masks = renderer.draw(scene, camera)
    visible = seen(native, scene, camera, "instance")["instance"]
    drawn = [int(number) for number in masks.ids[masks.pixels > 20] if number > 6]
    assert len(drawn) >= 6
    hidden = 0
    for number in drawn:
        alone = seen(native, snapshot_of([things[number - 1]]), camera, "instance", "depth")
        covered = alone["instance"] > 0
        np.testing.assert_array_equal(masks.mask(number), covered)
        np.testing.assert_array_equal(masks.depth(number)[covered], alone["depth"][covered])
        assert covered[visible == number].all()
        hidden += int((covered & (visible != number)).sum())
    assert hidden > 200
    # Beside the picture, too: a box of 0.5 m covers as many pixels wherever it is.
    cube = model_of(box_mesh(0.5))
    row = snapshot_of([Thing(cube, Pose((2.0, y, 0.0))) for y in (0.0, 2.6, 4.0)])
    whole = renderer.draw(row, camera_at()).whole_pixels
    renderer.close()
    np.testing.assert_allclose(whole, 0.5**2 * 40.0 * 44.0, rtol=0.06)


def test_the_picture_is_that_of_a_pin_hole_far_away(native: NativeRenderer) -> None:
    """Colours, with smooth edges and without.

    A pin-hole D behind the plane with the focal length D + d shows a point at depth z and x pixels
    from the middle (d - z) / (D + z) x beside: at most 0.04 px here, D = 5000 m. So no colour is
    off by more than 4 % of the range and a step of rounding, but where the centre of a pixel lies
    so near to an edge; and their mean by far less.
    """
    things = [replace(thing, model=thing.model) for thing in room_of_things()[6:]]
    shiny = model_of(box_mesh((0.1, 1.5, 1.5)), metallic=1.0, roughness=0.5)
    things += [
        Thing(model_of(wall_mesh(12.0, 12.0), **SKIN), Pose((2.8, 0.0, 0.0))),
        Thing(shiny, Pose.from_rpy_deg((1.4, 0.4, 0.3), (10.0, 25.0, 15.0))),
    ]
    things = [replace(one, pose=replace(one.pose)) for one in things]
    start = Pose((-2.5, 0.0, 0.0))
    scene = snapshot_of(things, contents=contents_of(things, lights=[SUN]))
    away_m, middle_m = 5000.0, 3.0
    parallel = camera_at(start)
    far = replace(
        parallel,
        intrinsics=CameraIntrinsics(
            width=WIDTH,
            height=HEIGHT,
            fx_px=40.0 * (away_m + middle_m),
            fy_px=44.0 * (away_m + middle_m),
            cx_offset_px=4.5,
            cy_offset_px=-3.25,
            far_m=9000.0,
        ),
        pose=Pose((-2.5 - away_m, 0.0, 0.0)),
    )
    for smooth in (False, True):
        # Ambient occlusion takes surfaces for one by a share of their depth.
        picture = PictureSettings(smooth_edges=smooth, occlusion_strength=0.0)
        one, other = (
            seen(native, scene, replace(camera, picture=picture), "rgb", "instance")
            for camera in (parallel, far)
        )
        assert len(np.unique(one["instance"])) > 12
        assert (one["instance"] != other["instance"]).mean() < 2e-3
        steps = np.abs(one["rgb"].astype(int) - other["rgb"])
        assert (steps > 0.04 * 255 + 1).mean() < 3e-3
        assert steps.mean() < 0.2
        assert one["rgb"].std() > 20.0


def test_a_plan_of_a_room_is_lit(native: NativeRenderer, room_01: WorldSnapshot) -> None:
    """From below the ceiling; smooth edges come nearer to 4 x 4 samples than one sample does."""
    camera = camera_at(PLAN, 33.0)
    plain = PictureSettings(smooth_edges=False)
    made = [
        seen(native, room_01, replace(camera, picture=picture), "rgb", "instance")
        for picture in (plain, PictureSettings(), replace(plain, supersampling=4))
    ]
    for other in made[1:]:
        np.testing.assert_array_equal(other["instance"], made[0]["instance"])
    best = made[2]["rgb"].astype(float)
    off = [np.abs(views["rgb"] - best).mean() for views in made[:2]]
    assert off[1] < 0.75 * off[0] < 4.0
    assert (best.max(axis=-1) > 40.0).mean() > 0.8


@pytest.mark.gl
def test_opengl_leaves_them_to_the_native_renderer(native: NativeRenderer) -> None:
    """Equal bytes of all views."""
    scene = gallery()
    camera = camera_at(Pose((-0.5, 0.0, 0.0)), 60.0)
    views = ("rgb", "depth", "instance", "normals", "albedo")
    renderer = Renderer()
    made = dict(renderer.render(RenderRequest(scene, camera, views)).views)
    renderer.close()
    for view, values in seen(native, scene, camera, *views).items():
        np.testing.assert_array_equal(made[view], values, err_msg=view)


def test_bytes_do_not_depend_on_threads_or_the_instruction_set() -> None:
    """Every view of a scene with every kind of material and light, glass and masks too."""
    scene = gallery()
    start = Pose((-0.5, 0.0, 0.0))
    past = Observation(snapshot=scene, camera=camera_at(start, 60.0))
    now = replace(past.camera, pose=Pose((-0.4, 0.02, 0.01)))
    kept: dict[str, bytes] = {}
    for name in load_library().instruction_sets:
        for threads in (1, 3):
            with using_instruction_set(name):
                renderer = NativeRenderer(threads=threads)
                views = renderer.render(
                    RenderRequest(scene, now, renderer.supported_views, past)
                ).views
                renderer.close()
            assert len(np.unique(views["instance"])) > 3
            for view, values in views.items():
                made = values.tobytes()
                assert kept.setdefault(view, made) == made, (name, threads, view)


def test_surfaces_darken_where_they_meet(native: NativeRenderer) -> None:
    """Ambient occlusion: in the corner of two walls as a pin-hole at that scale has it."""
    wall = model_of(wall_mesh(12.0, 12.0), base_colour=(0.5, 0.5, 0.5, 1.0), double_sided=True)
    turned = Pose.from_rpy_deg((2.0, 0.0, 0.0), (0.0, 0.0, 90.0))
    scene = snapshot_of([Thing(wall, Pose((3.0, 0.0, 0.0))), Thing(wall, turned)])
    eye = look_at((0.0, -3.0, 0.0), (3.0, 0.0, 0.0))
    shares = []
    pinhole = CameraIntrinsics(width=WIDTH, height=HEIGHT, fx_px=170.0, fy_px=187.0)
    for lens in (lens_of(40.0, cx_offset_px=0.0, cy_offset_px=0.0), pinhole):
        camera = Camera(intrinsics=lens, pose=eye)
        pictures = []
        for strength in (0.0, 1.0):
            picture = PictureSettings(occlusion_strength=strength)
            rgb = seen(native, scene, replace(camera, picture=picture), "rgb")["rgb"]
            pictures.append(rgb[60:90].astype(float))
        shares.append((pictures[1] / pictures[0]).mean(axis=(0, 2)))
    for share in shares:
        assert share[95:108].min() < 0.85
        assert share[10:40].min() > 0.97
    assert abs(shares[0][95:108].min() - shares[1][95:108].min()) < 0.06


def test_a_mirror_shows_what_stands_before_it(native: NativeRenderer) -> None:
    """As the camera would see it from behind the mirror, left and right exchanged."""
    wall = Thing(
        model_of(wall_mesh(60.0, 60.0), **SKIN), Pose.from_rpy_deg((-3.0, 0, 0), (0, 0, 180))
    )
    # Before the wall, and behind the camera.
    box = Thing(model_of(box_mesh(0.9)), Pose.from_rpy_deg((-1.5, 0.5, 0.3), (20.0, 10.0, 30.0)))
    glass = Thing(
        model_of(
            wall_mesh(2.0, 2.0), metallic=1.0, roughness=0.0, base_colour=(1.0, 1.0, 1.0, 1.0)
        ),
        Pose((2.0, 0.0, 0.0)),
    )
    camera = camera_at(cx_offset_px=0.0, cy_offset_px=0.0)
    behind = replace(camera, pose=Pose.from_rpy_deg((4.0, 0.0, 0.0), (0.0, 0.0, 180.0)))
    shown = snapshot_of([wall, box, glass], contents=contents_of([wall, box, glass], lights=[SUN]))
    plain = snapshot_of([wall, box], contents=contents_of([wall, box], lights=[SUN]))
    mirrored = seen(native, shown, camera, "rgb", "instance")
    direct = seen(native, plain, behind, "rgb")["rgb"][:, ::-1]
    inside = mirrored["instance"] == 3
    inside &= ~grown(~inside)
    assert inside.sum() > 5000
    off = np.abs(mirrored["rgb"][inside].astype(int) - direct[inside])
    assert direct[inside].std() > 20.0
    assert (off > 2).mean() < 3e-3


def _near_edges(ids: NDArray[Any], depth: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which pixels are beside another instance, or where depths bend by a millimetre."""
    beside = np.zeros(ids.shape, bool)
    z = np.where(np.isfinite(depth), depth, 100.0)
    for axis in (0, 1):
        changes, bends = np.diff(ids, axis=axis) != 0, np.abs(np.diff(z, 2, axis=axis)) > 1e-3
        for mask in (changes, bends):
            for at in range(ids.shape[axis] - mask.shape[axis] + 1):
                place = [slice(None), slice(None)]
                place[axis] = slice(at, at + mask.shape[axis])
                beside[tuple(place)] |= mask
    return grown(beside)


# -- through a simulation ------------------------------------------------------------------


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    """The scene optical; the camera stands aside and looks down on it."""
    made = Simulation("optical", backend="native", mode="lockstep")
    spec = AgentSpec(name="plan", intrinsics=lens_of(30.0), following=False, rate_hz=0.0)
    made.register_agent(replace(spec, pose=look_at((1.5, -1.0, 2.2), (0.0, 0.0, 0.4))))
    eye = CameraIntrinsics(width=WIDTH, height=HEIGHT)
    spec = AgentSpec(name="eye", intrinsics=eye, following=False, rate_hz=0.0)
    made.register_agent(replace(spec, pose=look_at((2.5, -1.6, 1.8), (0.0, 0.0, 0.5))))
    yield made
    made.close()


def frame_of(made: Simulation, agent: str) -> Frame:
    """What a camera sees."""
    return made.capture(("rgb", "depth", "instance", "object_coords"), agent=agent)


def _matrices_of(frame: Frame, ids: NDArray[np.uint16]) -> NDArray[np.float64]:
    """(N, 4, 4): where instances stand in a frame."""
    assert frame.states is not None
    return frame.states.matrices[frame.states.row_of_id[ids]]


def test_points_are_where_rays_meet_things(simulation: Simulation) -> None:
    """Of the cloud; each is projected to its own pixel, at its own depth."""
    frame = frame_of(simulation, "plan")
    camera = frame.camera
    cloud = frame.points()
    assert len(cloud) > 10000
    v, u = np.divmod(cloud.pixels, WIDTH)
    matrix = camera.camera_from_world
    optical = cloud.xyz.astype(np.float64) @ matrix[:3, :3].T + matrix[:3, 3]
    np.testing.assert_allclose(optical[:, 0], (u - camera.intrinsics.cx) / 30.0, atol=2e-6)
    np.testing.assert_allclose(optical[:, 1], (v - camera.intrinsics.cy) / 33.0, atol=2e-6)
    np.testing.assert_allclose(optical[:, 2], frame["depth"][v, u], atol=2e-6)
    pixels = camera.intrinsics.project(optical)
    np.testing.assert_allclose(pixels, np.stack([u, v], axis=-1), atol=1e-4)
    np.testing.assert_allclose(
        camera.intrinsics.unproject(frame["depth"])[v, u], optical, atol=3e-6
    )


def test_boxes_and_corners_are_where_arithmetic_has_them(simulation: Simulation) -> None:
    """Corners lie at fx x + cx; the box around an object's pixels lies within theirs."""
    frame = frame_of(simulation, "plan")
    table = frame.objects
    matrix, lens = frame.camera.camera_from_world, frame.camera.intrinsics
    optical = table.corners @ matrix[:3, :3].T + matrix[:3, 3]
    expected = optical[..., :2] * (30.0, 33.0) + (lens.cx, lens.cy)
    ahead = optical[..., 2] > 0.0
    np.testing.assert_allclose(table.corner_pixels[ahead], expected[ahead], atol=1e-9)
    assert np.isnan(table.corner_pixels[~ahead]).all()
    seen_rows = np.flatnonzero((table.visible_pixels > 50) & ahead.all(axis=1))
    assert len(seen_rows) >= 3
    for row in seen_rows:
        left, top, right, bottom = table.visible_boxes[row]
        low, high = expected[row].min(axis=0), expected[row].max(axis=0)
        assert (np.array([left, top]) >= low - 0.5).all()
        assert (np.array([right, bottom]) <= high + 0.5).all()
    masks = simulation.get_amodal_masks(agent="plan")
    for number in table.ids[seen_rows].tolist():
        assert masks.mask(int(number))[frame["instance"] == number].all()


def test_motion_and_tracks_between_cameras(simulation: Simulation) -> None:
    """From and to a pin-hole, and to a parallel camera elsewhere: as project has the points."""
    first, eye = frame_of(simulation, "plan"), frame_of(simulation, "eye")
    simulation.step(24)
    simulation.set_pose(look_at((1.4, -1.1, 2.1), (0.1, 0.0, 0.3)), agent="plan")
    later = frame_of(simulation, "plan")
    geometry = SceneGeometry.of_contents(simulation.contents)
    for begin, end in ((first, later), (first, eye), (eye, first)):
        moved_by = motion(begin, end)
        v, u = np.nonzero(np.isfinite(begin["depth"]))
        cloud = begin.points()
        at = np.searchsorted(cloud.pixels, v * WIDTH + u)
        point = np.concatenate([cloud.xyz[at].astype(np.float64), np.ones((len(at), 1))], axis=1)
        stood, stands = (_matrices_of(frame, cloud.instance[at]) for frame in (begin, end))
        carried = end.camera.camera_from_world @ stands @ np.linalg.inv(stood)
        there = np.einsum("nij,nj->ni", carried, point)[:, :3]
        expected = end.camera.intrinsics.project(there) - np.stack([u, v], axis=-1)
        found = moved_by.flow[v, u]
        known = np.isfinite(expected[:, 0])
        assert known.sum() > 5000
        np.testing.assert_array_equal(moved_by.valid[v, u], known)
        # Points of the cloud are rounded to single precision: 1e-6 m.
        np.testing.assert_allclose(found[known], expected[known], atol=2e-3)
        # Points of the same pixels, by rays against the scene.
        some = np.flatnonzero(known)[::211]
        queries = np.column_stack([np.zeros(len(some)), u[some], v[some]])
        tracks = track(queries, [begin, end], geometry)
        np.testing.assert_array_equal(tracks.instances, begin["instance"][v[some], u[some]])
        np.testing.assert_allclose(tracks.pixels[:, 0], queries[:, 1:], atol=1e-6)
        np.testing.assert_allclose(
            tracks.pixels[:, 1] - tracks.pixels[:, 0], found[some], atol=5e-3
        )
        assert tracks.visible[:, 0].all()
        agree = tracks.visible[:, 1] == moved_by.visible[v[some], u[some]]
        # Motion asks the four pixels around, which are 3 cm wide, and near edges show others.
        assert agree.mean() > 0.95
        own = ObjectPoints(tracks.instances, tracks.coords)
        again = track(own, [begin], geometry)
        assert again.visible.all()
    # Of pixels that see nothing a turned camera of parallel rays knows no place.
    nothing = first["instance"] == 0
    if nothing.any():
        assert not motion(first, later).valid[nothing].any()


def test_planes_around_the_view_enclose_what_is_seen(simulation: Simulation) -> None:
    """All points of a frame lie within them, and places beside the picture do not."""
    frame = frame_of(simulation, "plan")
    planes = view_planes(frame.camera, 50.0)
    points = frame.points().xyz.astype(np.float64)
    assert ((points @ planes[:, :3].T + planes[:, 3]) > 0.0).all()
    lens = frame.camera.intrinsics
    beside = lens.points_at([(-2.0, 50.0), (WIDTH + 1.0, 50.0), (50.0, -2.0)], [2.0, 2.0, 2.0])
    world = (
        beside @ frame.camera.world_from_camera[:3, :3].T + frame.camera.world_from_camera[:3, 3]
    )
    assert ((world @ planes[:, :3].T + planes[:, 3]) < 0.0).any(axis=1).all()


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, r"fx_px must be above 0 \[px/m\], since all rays are parallel"),
        ({"fx_px": 9.0}, "fy_px must be above 0"),
        (
            {"fx_px": 9.0, "fy_px": 9.0, "max_angle_deg": 60.0},
            "max_angle_deg must be 0, since all rays are parallel",
        ),
        (
            {"fx_px": 9.0, "fy_px": 9.0, "distortion": (0.1,)},
            "distortion must be empty, since orthographic has no coefficients",
        ),
    ],
)
def test_bad_input_is_refused_in_words(given: dict[str, Any], words: str) -> None:
    """A scale that is missing, an angle or coefficients that mean nothing."""
    with pytest.raises(InvalidRequest, match=words):
        CameraIntrinsics(distortion_model="orthographic", **given)
