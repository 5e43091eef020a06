"""The models of a scene file become the data types that the other stages take."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sailenv_ros.scene.serialisation import agent_entry
from sailenv_ros.scene.spec import (
    AgentSpecModel,
    BehaviourSpec,
    CategorySpec,
    EnvironmentSpec,
    MoverSpec,
    ObjectSpec,
    SceneSpec,
    SpotLightSpec,
    WaypointSpec,
)
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.colour import linear_from_hex
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.labels import Category
from sailenv_ros.types.lights import Environment, Light
from tests.unit.scene.strategies import unhurried


def test_an_empty_environment_is_the_noun_s_default() -> None:
    assert EnvironmentSpec().to_environment() == Environment()


def test_every_field_of_a_light_arrives() -> None:
    spec = SpotLightSpec(
        name="spot",
        type="spot",
        colour=(1.0, 0.5, 0.25),
        intensity=3.0,
        indirect_multiplier=0.5,
        position=(1.0, 2.0, 3.0),
        direction=(0.0, 3.0, -4.0),
        range=7.0,
        inner_cone=11.0,
        outer_cone=22.0,
    )
    assert spec.to_light() == Light(
        name="spot",
        type="spot",
        colour=(1.0, 0.5, 0.25),
        intensity=3.0,
        indirect_multiplier=0.5,
        position_m=(1.0, 2.0, 3.0),
        direction=(0.0, 0.6, -0.8),
        range_m=7.0,
        inner_cone_deg=11.0,
        outer_cone_deg=22.0,
    )


@pytest.mark.parametrize("kind", ["directional", "point", "spot", "area"])
def test_a_light_with_a_name_alone_has_the_noun_s_defaults(kind: str) -> None:
    scene = SceneSpec.model_validate({"version": 1, "lights": [{"name": "a", "type": kind}]})
    assert scene.lights[0].to_light() == Light(name="a", type=kind)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("hexadecimal", "linear"),
    [("#000000", 0.0), ("#ffffff", 1.0), ("#0a0a0a", 10 / 255 / 12.92), ("#bcbcbc", 0.50289)],
)
def test_hexadecimal_colours_are_srgb(hexadecimal: str, linear: float) -> None:
    """0xbc is the encoded value of half the light (IEC 61966-2-1)."""
    assert linear_from_hex(hexadecimal) == pytest.approx((linear,) * 3, abs=1e-5)


@unhurried
@given(st.integers(0, 254))
def test_the_srgb_curve_rises(value: int) -> None:
    low, high = (linear_from_hex(f"#{v:02x}0000")[0] for v in (value, value + 1))
    assert low < high


def test_numbers_of_a_colour_are_linear_already() -> None:
    spec = EnvironmentSpec.model_validate({"ambient": [0.5, 1, 2.5]})
    assert spec.ambient == (0.5, 1.0, 2.5)


def test_rotation_is_roll_pitch_yaw_about_fixed_axes() -> None:
    spec = ObjectSpec(name="a", asset="cube", position=(1.0, 2.0, 3.0), rotation=(0.0, 0.0, 90.0))
    expected = [[0, -1, 0, 1], [1, 0, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]
    np.testing.assert_allclose(spec.pose.matrix(), expected, atol=1e-15)


def test_an_orientation_is_a_quaternion_xyzw() -> None:
    half = math.sqrt(0.5)
    spec = ObjectSpec(name="a", asset="cube", orientation=(0.0, 0.0, half, half))
    assert spec.pose.rpy_deg == pytest.approx((0.0, 0.0, 90.0))


def test_one_number_scales_all_axes() -> None:
    spec = ObjectSpec.model_validate({"name": "a", "asset": "cube", "scale": 2})
    assert spec.scale == (2.0, 2.0, 2.0)


def test_the_keys_beside_type_are_the_behaviour_s_parameters() -> None:
    spec = BehaviourSpec.model_validate({"type": "spin", "rate": [1, 2], "parameters": 3})
    assert spec.type == "spin"
    assert dict(spec.parameters) == {"rate": [1, 2], "parameters": 3}
    with pytest.raises(TypeError):
        spec.parameters["rate"] = 1  # type: ignore[index]


def test_waypoints_look_at_points() -> None:
    spec = WaypointSpec(position=(3.0, 0.0, 1.0), look_at=(0.0, 0.0, 1.0))
    assert spec.pose == look_at((3, 0, 1), (0, 0, 1))
    assert spec.pose.rpy_deg == pytest.approx((0.0, 0.0, 180.0))


def test_a_scene_without_movers_has_one_at_a_metre_s_height() -> None:
    (mover,) = SceneSpec(version=1).all_movers
    assert (mover.name, mover.pose, mover.waypoint_poses) == ("mover", Pose((0.0, 0.0, 1.0)), ())


def test_a_mover_starts_at_its_first_waypoint_unless_it_is_put_elsewhere() -> None:
    waypoint = WaypointSpec(position=(1.0, 2.0, 3.0), rotation=(0.0, 0.0, 5.0))
    assert MoverSpec(waypoints=(waypoint,)).pose == waypoint.pose
    placed = MoverSpec(position=(9.0, 0.0, 0.0), waypoints=(waypoint,))
    assert placed.pose == Pose((9.0, 0.0, 0.0))
    aimed = MoverSpec(position=(9.0, 0.0, 0.0), look_at=(0.0, 0.0, 0.0))
    assert aimed.pose.rpy_deg == pytest.approx((0.0, 0.0, 180.0))


def test_several_movers_keep_their_order() -> None:
    scene = SceneSpec(version=1, movers=(MoverSpec(name="b"), MoverSpec(name="a")))
    assert [mover.name for mover in scene.all_movers] == ["b", "a"]


def test_an_agent_with_a_name_alone_has_the_noun_s_defaults() -> None:
    assert AgentSpecModel(name="eye").to_agent_spec() == AgentSpec(name="eye")


def test_every_field_of_an_agent_arrives() -> None:
    spec = AgentSpecModel(
        name="eye",
        width=320,
        height=240,
        vertical_fov=45.0,
        near=0.1,
        far=50.0,
        cx_offset=-12.5,
        cy_offset=7.0,
        depth_range=8.0,
        rate=0.0,
        views=("depth", "rgb"),
        following=False,
        mover="rail",
        position=(1.0, 2.0, 3.0),
        rotation=(0.0, 10.0, 0.0),
    )
    assert spec.to_agent_spec() == AgentSpec(
        name="eye",
        intrinsics=CameraIntrinsics(
            width=320,
            height=240,
            vertical_fov_deg=45.0,
            near_m=0.1,
            far_m=50.0,
            cx_offset_px=-12.5,
            cy_offset_px=7.0,
        ),
        depth_range_m=8.0,
        rate_hz=0.0,
        views=("depth", "rgb"),
        following=False,
        mover="rail",
        pose=Pose.from_rpy_deg((1.0, 2.0, 3.0), (0.0, 10.0, 0.0)),
    )


def test_an_axis_off_the_centre_is_written_and_read_again() -> None:
    """And where it is in the centre an entry says nothing of it."""
    lens = CameraIntrinsics(width=320, cx_offset_px=-12.5, cy_offset_px=7.25)
    given = AgentSpec(name="eye", intrinsics=lens)
    entry = agent_entry(given, None)
    assert entry == {"name": "eye", "width": 320, "cx_offset": -12.5, "cy_offset": 7.25}
    assert AgentSpecModel(**entry).to_agent_spec() == given
    centred = AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=320))
    assert agent_entry(centred, None) == {"name": "eye", "width": 320}


def test_a_lens_is_written_and_read_again() -> None:
    """With its model, coefficients, focal lengths and image circle."""
    lens = CameraIntrinsics(
        fx_px=400.5,
        fy_px=410.25,
        cx_offset_px=3.5,
        max_angle_deg=70.0,
        distortion_model="equidistant",
        distortion=(0.01, -0.002, 0.0, 0.0001),
    )
    given = AgentSpec(name="eye", intrinsics=lens)
    entry = agent_entry(given, None)
    assert entry == {
        "name": "eye",
        "cx_offset": 3.5,
        "fx": 400.5,
        "fy": 410.25,
        "max_angle": 70.0,
        "distortion_model": "equidistant",
        "distortion": [0.01, -0.002, 0.0, 0.0001],
    }
    assert AgentSpecModel(**entry).to_agent_spec() == given


def test_a_category_keeps_its_colour_byte_for_byte() -> None:
    spec = CategorySpec(name="rocket", id=200, colour="#01fe80")
    assert spec.to_category() == Category(id=200, name="rocket", colour=(1, 254, 128))


def test_categories_without_a_colour_get_different_ones() -> None:
    colours = {CategorySpec(name="a", id=i).to_category().colour for i in range(200, 255)}
    assert len(colours) == 55


def test_rules_between_keys_hold_for_models_made_in_code() -> None:
    with pytest.raises(ValidationError, match="behaviours cannot be given to an object that never"):
        ObjectSpec(name="a", asset="cube", static=True, behaviours=(BehaviourSpec(type="spin"),))
    twice = (ObjectSpec(name="a", asset="cube"), ObjectSpec(name="a", asset="cube"))
    with pytest.raises(ValidationError, match="must be unique among objects"):
        SceneSpec(version=1, objects=twice)


def test_specs_are_immutable() -> None:
    scene = SceneSpec(version=1)
    with pytest.raises(ValidationError, match="frozen"):
        setattr(scene, "title", "x")  # noqa: B010
