"""What the path tracer is given: cameras, lights, skies, shapes, materials, by arithmetic."""

from __future__ import annotations

import dataclasses
import io
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
import yaml
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.reference import scene_export as export
from benchmarks.reference import tracing
from benchmarks.reference.compare import VIEWS, _camera
from benchmarks.reference.parts import Parts, ply_bytes
from benchmarks.reference.surfaces import bsdf, emitter
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.native.compile import SOURCES
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.labels import CategoryTable, Instance
from sailenv_ros.types.lights import Environment, Light, SkyMap
from sailenv_ros.types.model import LEAST_CLOTH, Material, Model, ModelPart
from sailenv_ros.types.picture_settings import PictureSettings
from sailenv_ros.types.snapshot import DrawnInstance, SceneContents, WorldSnapshot

angles = st.floats(-180.0, 180.0)
metres = st.floats(-5.0, 5.0)


@pytest.fixture
def parts(tmp_path: Path) -> Parts:
    return Parts(tmp_path)


def world_of(
    material: Material, environment: Environment | None = None, lights: tuple[Light, ...] = ()
) -> WorldSnapshot:
    mesh = Primitives().load("cube").model.parts[0].mesh
    model = Model(name="cube", parts=(ModelPart(mesh=mesh, material=material),))
    instance = Instance(
        id=1, name="cube", asset="cube", category="cube", category_id=1, static=True
    )
    contents = SceneContents(
        scene="test",
        epoch=1,
        revision=1,
        instances=(DrawnInstance(instance=instance, model=model, scale=(1.0, 2.0, 3.0)),),
        categories=CategoryTable([]),
        lights=lights,
        environment=environment or Environment(),
    )
    return WorldSnapshot(
        sim_time_ns=0,
        step=0,
        contents=contents,
        world_from_body=Pose((1.0, 2.0, 3.0)).matrix()[None],
        histories=np.zeros(1, np.int64),
    )


# ---- cameras


@given(st.tuples(metres, metres, metres), st.tuples(angles, angles, angles), st.floats(20, 110))
def test_a_point_lies_in_the_same_place_of_both_pictures(
    position: tuple[float, float, float], rpy_deg: tuple[float, float, float], fov_deg: float
) -> None:
    """By Mitsuba's rule (x left, y up, full vertical angle) a point has the pixel that we say."""
    intrinsics = CameraIntrinsics(width=64, height=40, vertical_fov_deg=fov_deg)
    camera = Camera(intrinsics=intrinsics, pose=Pose.from_rpy_deg(position, rpy_deg))
    described = export.sensor(camera)
    in_optical = np.array([0.4, -0.3, 2.0])
    in_world = camera.world_from_camera @ [*in_optical, 1.0]
    x, y, z, _ = np.linalg.inv(np.array(described["to_world"])) @ in_world
    per_height = 1.0 / (2.0 * math.tan(math.radians(described["fov"]) / 2.0))
    column = 64 / 2 - x / z * per_height * 40
    row = 40 / 2 - y / z * per_height * 40
    # Mitsuba counts from the corner of the first pixel, we count from its centre.
    expected = intrinsics.project(in_optical) + 0.5
    assert [column, row] == pytest.approx(expected, abs=1e-6)
    assert np.linalg.det(np.array(described["to_world"])[:3, :3]) == pytest.approx(1.0)


def test_every_room_has_cameras_inside_it() -> None:
    """Each view of the comparison is a camera at eye height between the room's walls."""
    root = Path(__file__).resolve().parents[3]
    listed = yaml.safe_load(VIEWS.read_text(encoding="utf-8"))
    files = {name: root / name for name in listed if name.endswith(".yaml")}
    rooms = {name: root / "scenes" / f"{name}.yaml" for name in listed.keys() - files}
    for name, file in {**files, **rooms}.items():
        cameras = [_camera(view, (32, 24), PictureSettings()) for view in listed[name].values()]
        assert len(cameras) == (5 if name in rooms else 2)
        size = yaml.safe_load(file.read_text(encoding="utf-8"))["room"]["size"]
        for camera in cameras:
            x, y, z = camera.pose.position_m
            assert abs(x) < size[0] / 2
            assert abs(y) < size[1] / 2
            assert 1.4 <= z <= 1.8
    assert set(rooms) == {"room_01", "room_02", "room_03"}


# ---- light


def mitsuba_place(direction: np.ndarray[Any, Any]) -> tuple[float, float]:
    """Where Mitsuba looks a direction up in a sky's map, as shares of its width and height."""
    x, y, z = np.linalg.inv(export.WORLD_FROM_SKY)[:3, :3] @ direction
    return (math.atan2(x, -z) / (2.0 * math.pi)) % 1.0, math.acos(y) / math.pi


@given(st.floats(-179.0, 179.0), st.floats(-89.0, 89.0))
def test_a_sky_map_is_hung_up_as_the_renderer_reads_it(azimuth: float, elevation: float) -> None:
    """Row 0 is the zenith, the middle column towards +x, columns clockwise from above."""
    a, e = math.radians(azimuth), math.radians(elevation)
    towards = np.array([math.cos(a) * math.cos(e), math.sin(a) * math.cos(e), math.sin(e)])
    column, row = mitsuba_place(towards)
    assert column == pytest.approx((0.5 - azimuth / 360.0) % 1.0, abs=1e-9)
    assert row == pytest.approx((90.0 - elevation) / 180.0, abs=1e-9)


def test_the_map_of_an_analytic_sky_has_its_three_colours() -> None:
    """Zenith above, horizon at its height, ground from 0.12 below on; the formula between."""
    sky = Environment(
        sky_zenith=(0.1, 0.2, 0.9), sky_horizon=(0.8, 0.7, 0.6), sky_ground=(0.3,) * 3
    )
    drawn = export.analytic_sky(sky, rows=512)
    assert drawn.shape == (512, 1024, 3)
    assert drawn[0, 0] == pytest.approx(sky.sky_zenith, abs=1e-4)
    assert drawn[-1, 500] == pytest.approx(sky.sky_ground, abs=1e-6)
    row = 100
    up = math.cos((row + 0.5) / 512 * math.pi)
    share = math.sqrt(up)
    expected = [h + share * (z - h) for h, z in zip(sky.sky_horizon, sky.sky_zenith, strict=True)]
    assert drawn[row, 3] == pytest.approx(expected, abs=1e-5)
    steepest = math.acos(-0.13) / math.pi * 512
    assert drawn[math.ceil(steepest), 0] == pytest.approx(sky.sky_ground, abs=1e-6)


def test_a_plain_background_shines_evenly(parts: Parts) -> None:
    """A background of one colour is light of that radiance from everywhere."""
    plain = Environment(background="colour", background_colour=(0.1, 0.2, 0.3))
    described = export.surroundings(plain, parts)
    assert described["type"] == "constant"
    assert described["radiance"]["value"] == [0.1, 0.2, 0.3]


def test_a_photographed_sky_is_handed_on_unchanged(parts: Parts) -> None:
    """The map's radiance is the tracer's."""
    radiance = np.random.default_rng(1).random((8, 16, 3)).astype(np.float16)
    grey = (0.5, 0.5, 0.5)
    sky = SkyMap(radiance=radiance, zenith=grey, horizon=grey, ground=grey)
    described = export.surroundings(Environment(sky=sky, sky_share=0.1), parts)
    assert np.array_equal(np.load(parts.folder / described["array"]), radiance.astype(np.float32))


@pytest.mark.parametrize("direction", [(0.3, -0.8, -0.2), (0.0, 0.0, -1.0), (0.0, 0.0, 1.0)])
def test_an_area_light_is_a_rectangle_of_its_size_that_faces_its_way(
    direction: tuple[float, float, float],
) -> None:
    """Its power is radiance; its sides are at right angles to its direction, its width is level."""
    light = Light(
        name="pane",
        type="area",
        colour=(1.0, 0.5, 0.25),
        intensity=4.0,
        direction=direction,
        width_m=1.5,
        height_m=0.8,
    )
    described = export.lamp(light)
    across, up = np.array(described["half_width"]), np.array(described["half_height"])
    assert described["power"] == [4.0, 2.0, 1.0]
    assert described["area"] == pytest.approx(1.2)
    assert np.linalg.norm(across) == pytest.approx(0.75)
    assert np.linalg.norm(up) == pytest.approx(0.4)
    assert across[2] == pytest.approx(0.0)
    assert np.cross(up, across) @ np.array(light.direction) == pytest.approx(-0.3)


def test_lamps_keep_their_units() -> None:
    """Power is colour times intensity, cones are half angles, the sun is as wide as the sun."""
    light = Light(
        name="spot",
        type="spot",
        colour=(0.5, 1.0, 2.0),
        intensity=3.0,
        inner_cone_deg=10.0,
        outer_cone_deg=30.0,
        range_m=7.0,
    )
    described = export.lamp(light)
    assert described["power"] == [1.5, 3.0, 6.0]
    assert described["cos_inner"] == pytest.approx(math.cos(math.pi / 18))
    assert described["cos_outer"] == pytest.approx(math.sqrt(3) / 2)
    assert described["range"] == 7.0
    sun = export.lamp(dataclasses.replace(light, type="directional"))
    width_deg = 2.0 * math.degrees(math.acos(sun["cos_radius"]))
    assert width_deg == pytest.approx(0.533, abs=1e-3)


def test_what_stands_for_bounced_light_is_left_out(parts: Parts) -> None:
    """Ambient light and the sky's share change nothing; lamps do, unlit ones are not there."""
    material = Material(name="paint")
    lamp = Light(name="lamp", type="point", intensity=1.0)
    off = dataclasses.replace(lamp, name="off", intensity=0.0)

    def scene(environment: Environment, *lights: Light) -> str:
        return json.dumps(export.scene_of(world_of(material, environment, lights), parts))

    first = scene(Environment(ambient=(0.2, 0.2, 0.2), sky_share=0.3), lamp)
    assert scene(Environment(), lamp, off) == first
    assert scene(Environment(), dataclasses.replace(lamp, intensity=2.0)) != first
    assert scene(Environment(sky_zenith=(1.0, 0.0, 0.0)), lamp) != first


def test_what_a_kind_of_light_does_not_use_is_not_told() -> None:
    """Two lights that shine alike are described alike, so that nothing is traced twice."""
    point = Light(name="a", type="point")
    other = Light(name="b", type="point", direction=(1.0, 0.0, 0.0), width_m=3.0)
    assert export.lamp(point) == export.lamp(other)
    sun = Light(name="sun", type="directional", direction=(0.0, 1.0, -1.0))
    moved = dataclasses.replace(sun, position_m=(5.0, 5.0, 5.0), range_m=1.0)
    assert export.lamp(sun) == export.lamp(moved)


# ---- shapes


def test_meshes_stand_where_their_objects_stand() -> None:
    """Scale comes before the pose, normals stay at right angles, v runs downwards."""
    mesh = Primitives().load("sphere").model.parts[0].mesh
    pose = Pose.from_rpy_deg((1.0, -2.0, 0.5), (20.0, 30.0, 40.0))
    scale = (1.0, 2.0, 0.5)
    positions, normals, uvs = export.world_mesh(mesh, pose.matrix(), scale)
    homogeneous = np.c_[mesh.positions * np.array(scale), np.ones(len(mesh.positions))]
    assert positions == pytest.approx((homogeneous @ pose.matrix().T)[:, :3], abs=1e-9)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1.0)
    # Of an ellipsoid the normal is the gradient of its equation.
    local = (positions - pose.position_m) @ pose.matrix()[:3, :3]
    gradient = local / np.square(scale)
    gradient /= np.linalg.norm(gradient, axis=1, keepdims=True)
    assert normals @ pose.matrix()[:3, :3] == pytest.approx(gradient, abs=1e-3)
    assert uvs[:, 0] == pytest.approx(mesh.uvs[:, 0])
    assert uvs[:, 1] == pytest.approx(1.0 - mesh.uvs[:, 1])


def test_written_meshes_are_read_by_others(parts: Parts) -> None:
    """Another library finds the same triangles in the file; one material makes one shape."""
    scene = export.scene_of(world_of(Material()), parts)
    shapes = [entry for key, entry in scene.items() if key.startswith("shape")]
    read = trimesh.load(parts.folder / shapes[0]["filename"], process=False)
    assert len(shapes) == 1
    assert read.bounds == pytest.approx(np.array([[0.5, 1.0, 1.5], [1.5, 3.0, 4.5]]))
    assert read.volume == pytest.approx(6.0)


def test_equal_content_has_one_name(parts: Parts) -> None:
    """Arrays are named by values, shape and type, meshes by their bytes."""
    zeros = np.zeros((2, 3), np.float32)
    assert parts.array(zeros) == parts.array(zeros.copy())
    assert len({parts.array(a) for a in (zeros, zeros.reshape(3, 2), zeros.view(np.int32))}) == 3
    triangle = (np.eye(3), np.eye(3), np.zeros((3, 2)), np.array([[0, 1, 2]]))
    assert parts.mesh(ply_bytes(*triangle)) == parts.mesh(ply_bytes(*triangle))
    loaded = trimesh.load(io.BytesIO(ply_bytes(*triangle)), file_type="ply", process=False)
    assert loaded.vertices == pytest.approx(np.eye(3))


# ---- materials


def stored(described: dict[str, Any], parts: Parts) -> np.ndarray[Any, Any]:
    return np.asarray(np.load(parts.folder / described["array"]))


def test_maps_are_handed_on_with_their_factors(parts: Parts) -> None:
    """Colour stays sRGB, roughness is green, metal is blue, times the factors."""
    texture = np.random.default_rng(2).integers(0, 256, (4, 4, 4), np.uint8)
    material = Material(
        base_colour=(1.0, 1.0, 1.0, 1.0),
        base_colour_texture=texture,
        metallic_roughness_texture=texture,
        normal_texture=texture,
        metallic=0.5,
        roughness=1.0,
    )
    described = bsdf(material, parts)
    assert np.array_equal(stored(described["normalmap"], parts), texture[..., :3])
    inner = described["bsdf"]
    assert not inner["base_color"]["raw"]
    assert np.array_equal(stored(inner["base_color"], parts), texture[..., :3])
    rough = stored(inner["roughness"], parts)[..., 0]
    assert np.array_equal(rough, np.maximum(texture[..., 1], round(255 * 0.045)))
    metal = stored(inner["metallic"], parts)[..., 0]
    assert np.abs(metal - texture[..., 2] / 2.0).max() <= 0.5


def test_a_tint_multiplies_linear_colour(parts: Parts) -> None:
    """Half of white is sRGB 188, not 128."""
    white = np.full((2, 2, 4), 255, np.uint8)
    material = Material(base_colour=(0.5, 0.5, 0.5, 1.0), base_colour_texture=white)
    assert (stored(bsdf(material, parts)["base_color"], parts) == 188).all()


def test_leaves_are_cut_out_where_their_alpha_is_low(parts: Parts) -> None:
    """What is masked is there or not there, by the material's own limit."""
    leaf = np.full((1, 4, 4), 255, np.uint8)
    leaf[0, :, 3] = [0, 100, 150, 255]
    material = Material(alpha="mask", alpha_cutoff=0.5, base_colour_texture=leaf)
    described = bsdf(material, parts)
    assert described["type"] == "mask"
    assert stored(described["opacity"], parts)[0, :, 0].tolist() == [0, 0, 255, 255]


@pytest.mark.parametrize(
    ("roughness", "two_sided", "faces", "met"),
    [(0.05, False, 1.0, 2), (0.05, True, 2.0, 1), (0.95, False, 0.0, 2)],
)
def test_what_is_seen_through_covers_as_the_renderer_has_it(
    parts: Parts, roughness: float, two_sided: bool, faces: float, met: int
) -> None:
    """All faces that a ray meets have the material's opacity and hue; cloth mirrors nothing."""
    glass = Material(
        base_colour=(0.2, 0.4, 0.1, 0.36),
        roughness=roughness,
        alpha="blend",
        double_sided=two_sided,
    )
    described = bsdf(glass, parts)
    assert described["type"] == "sailenv_see_through"
    assert described["base_color"]["value"] == [0.2, 0.4, 0.1]
    assert (1.0 - described["opacity"]["value"][0]) ** met == pytest.approx(1.0 - 0.36)
    tint = np.array(described["tint"]["value"]) ** met
    assert tint == pytest.approx(1.0 + 0.36 * (np.array([0.5, 1.0, 0.25]) - 1.0))
    assert described["faces"]["value"][0] == faces


def test_cloth_is_as_rough_as_the_law_says() -> None:
    """Once in Python, and once in the law."""
    law = (SOURCES / "kernels" / "light_law.h").read_text()
    assert f"LEAST_CLOTH = {LEAST_CLOTH}f;" in law


def test_what_glows_emits_its_radiance(parts: Parts) -> None:
    """Emission is radiance; with a texture it has the texture's pattern; else nothing shines."""
    assert emitter(Material(), parts) is None
    plain = emitter(Material(emission=(2.0, 1.0, 0.0)), parts)
    assert plain is not None
    assert plain["radiance"]["value"] == [2.0, 1.0, 0.0]
    half = np.full((1, 1, 4), 188, np.uint8)
    patterned = emitter(Material(emission=(2.0, 1.0, 0.0), base_colour_texture=half), parts)
    assert patterned is not None
    assert stored(patterned["radiance"], parts)[0, 0] == pytest.approx([1.0, 0.5, 0.0], abs=0.01)


# ---- the cache


def test_without_the_tracer_one_is_told_how_to_get_it(
    parts: Parts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where nothing has been set up and nothing is cached, the error names the command."""
    monkeypatch.setattr(tracing, "HOME", tmp_path)
    scene = export.scene_of(world_of(Material()), parts)
    sensors = {"front": export.sensor(Camera())}
    assert tracing.traced_views("test", scene, sensors, 4, may_trace=False) == {}
    with pytest.raises(tracing.ToolMissing, match="setup"):
        tracing.traced_views("test", scene, sensors, 4)


def test_the_last_traced_picture_stands_in_where_that_is_wanted(
    parts: Parts, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a changed scene the newest picture of a camera's name and size is taken, if asked for.

    Files of before halves were kept are passed over.
    """
    monkeypatch.setattr(tracing, "HOME", tmp_path)
    (tmp_path / "traces").mkdir()
    for age, (number, height) in enumerate([(1, 480), (2, 480), (3, 480), (4, 48)]):
        file = tmp_path / "traces" / f"test-front-{number}.npz"
        image = np.full((height, height * 4 // 3, 3), number, np.float32)
        noise = {"noise": 0.1, "noise_denoised": 0.01, "seconds": 1.0}
        halves = {"halves": np.stack((image, image))} if number > 1 else {}
        np.savez(file, radiance=image, raw=image, **halves, **noise)  # type: ignore[arg-type]
        os.utime(file, (1000 - age, 1000 - age))
    scene = export.scene_of(world_of(Material()), parts)
    sensors = {"front": export.sensor(Camera())}
    taken = tracing.traced_views("test", scene, sensors, 4, may_trace=False, or_last=True)
    assert taken["front"].radiance.shape == (480, 640, 3)
    assert taken["front"].radiance[0, 0, 0] == 2.0
    assert tracing.traced_views("test", scene, sensors, 4, may_trace=False) == {}
