"""Labels, frames, agents and errors: what they refuse and what they promise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sailenv_ros.errors as errors
from sailenv_ros.errors import InvalidRequest, NameTaken, SceneDiagnostic, SceneError, UnknownName
from sailenv_ros.frame.frame import Frame
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.instance_states import InstanceStates
from sailenv_ros.types.labels import Category, CategoryTable, colour_instances, instance_colours
from sailenv_ros.types.lights import Light
from sailenv_ros.types.views import FIVE_VIEWS, VIEWS, checked_views
from tests.support.small_frame import small_frame


def test_no_two_instances_share_a_colour_and_the_background_is_black() -> None:
    """65536 ids, 65536 colours."""
    colours = instance_colours()
    packed = colours.astype(np.uint32) @ np.array([1, 256, 65536], np.uint32)
    assert len(np.unique(packed)) == 65536
    assert not colours[0].any()


def test_neighbouring_ids_look_different() -> None:
    """Ids that follow each other differ by a lot in some channel."""
    colours = instance_colours()[1:200].astype(int)
    assert np.abs(np.diff(colours, axis=0)).max(axis=1).min() > 30


def test_a_picture_of_ids_is_coloured_pixel_by_pixel() -> None:
    """colour_instances gives each pixel its id's colour."""
    ids = np.array([[0, 1], [65535, 1]], np.uint16)
    picture = colour_instances(ids)
    assert picture.shape == (2, 2, 3)
    np.testing.assert_array_equal(picture[0, 1], picture[1, 1])
    assert not picture[0, 0].any()


def test_categories_are_found_by_id_and_name() -> None:
    """Background and unlabelled are always there; unknown names suggest the nearest."""
    table = CategoryTable([Category(id=7, name="chair", colour=(1, 2, 3))])
    assert table.named("chair") is table[7]
    assert [table[0].name, table[255].name] == ["background", "unlabelled"]
    np.testing.assert_array_equal(table.palette[7], (1, 2, 3))
    with pytest.raises(UnknownName, match="did you mean 'chair'"):
        table.named("chiar")
    with pytest.raises(NameTaken):
        CategoryTable([table[7], Category(id=7, name="table", colour=(0, 0, 0))])
    with pytest.raises(NameTaken):
        CategoryTable([table[7], Category(id=8, name="chair", colour=(0, 0, 0))])


def test_views_are_checked_by_name() -> None:
    """Known names come back in one order, once each; others are refused with all known ones."""
    assert checked_views(["flow", "rgb", "flow"]) == ("rgb", "flow")
    with pytest.raises(UnknownName, match="did you mean 'depth'"):
        checked_views(["dept"])
    with pytest.raises(InvalidRequest, match="at least one of: rgb, depth"):
        checked_views([])
    with pytest.raises(InvalidRequest, match="this renderer makes: rgb, depth, got"):
        checked_views(["normals", "rgb"], supported=("depth", "rgb"))
    assert checked_views(["rgb"], supported=("depth", "rgb")) == ("rgb",)


def frame_of(**views: np.ndarray) -> Frame:  # type: ignore[type-arg]  # any view
    return small_frame(views, width=16)


def test_a_frame_checks_its_views_and_freezes_them() -> None:
    """Shapes and types are those of VIEWS, and nobody can write into them."""
    frame = frame_of(depth=np.ones((8, 16), np.float32))
    with pytest.raises(ValueError, match="read-only"):
        frame["depth"][0, 0] = 2.0
    with pytest.raises(UnknownName, match="view must be one of: depth"):
        frame["rgb"]
    with pytest.raises(ValueError, match=r"view depth must be \(8, 16\) float32"):
        frame_of(depth=np.ones((16, 8), np.float32))
    with pytest.raises(ValueError, match="view instance must be"):
        frame_of(instance=np.ones((8, 16), np.int32))
    with pytest.raises(UnknownName, match="view must be one of: rgb, depth"):
        frame_of(heat=np.ones((8, 16), np.float32))


def test_every_view_says_what_it_is() -> None:
    """Shape, type and encoding belong together."""
    assert FIVE_VIEWS == ("rgb", "depth", "category", "instance", "flow")
    bytes_of = {
        "rgb8": 3,
        "8UC1": 1,
        "16UC1": 2,
        "bayer_rggb16": 2,
        "32FC1": 4,
        "32FC2": 8,
        "32FC3": 12,
    }
    for spec in VIEWS.values():
        assert spec.dtype.itemsize * spec.channels == bytes_of[spec.encoding], spec.name
        assert spec.meaning
        # What one view says of another holds for a view that there is.
        assert spec.validity_of in ("", *VIEWS)
        assert spec.needs_past or not spec.needs_past_depth
        # Labels must arrive as they were sent.
        assert not (spec.is_label and spec.compressed_topic == "jpeg"), spec.name


@pytest.mark.parametrize("name", ["", "Agent", "1st", "a b", "a/b", "a" * 64, "é", 7])
def test_names_of_agents_are_ros_names(name: object) -> None:
    """Anything that could not be a part of a topic is refused."""
    with pytest.raises(InvalidRequest, match="name of the agent must be a lower-case letter"):
        AgentSpec(name=name)  # type: ignore[arg-type]  # wrong on purpose


def test_agents_refuse_rates_and_ranges_that_make_no_sense() -> None:
    """Negative or NaN rates, a depth range inside the near plane."""
    for rate in (-1.0, float("nan"), 1000.0):
        with pytest.raises(InvalidRequest, match="rate_hz must be a number from 0 to 240"):
            AgentSpec(name="a", rate_hz=rate)
    with pytest.raises(InvalidRequest, match="depth_range_m must be a number above near_m"):
        AgentSpec(name="a", depth_range_m=0.01)


def test_lights_have_a_direction_and_are_not_negative() -> None:
    """Directions are made unit; zero ones and negative powers are refused."""
    assert Light(name="l", type="spot", direction=(0, 0, -5)).direction == (0, 0, -1)
    with pytest.raises(InvalidRequest, match="direction of light 'l' must be not all zero"):
        Light(name="l", type="spot", direction=(0, 0, 0))
    with pytest.raises(InvalidRequest, match="intensity of light 'l' must be a number from 0 to"):
        Light(name="l", type="point", intensity=-1)


def test_a_scene_error_tells_every_fault_with_its_place() -> None:
    """One line an error: file:line:column: field: message."""
    diagnostic = SceneDiagnostic(
        path="a.yaml", line=3, column=5, field="objects[0].mass", message="must be > 0"
    )
    error = SceneError([diagnostic, diagnostic])
    assert str(error) == "a.yaml:3:5: objects[0].mass: must be > 0\n" * 1 + str(diagnostic)
    assert len(error.diagnostics) == 2


def test_all_errors_are_ours_and_named_in_the_tree() -> None:
    """Each class is a SailenvError and stands in the module's drawing."""
    found = {name: thing for name, thing in vars(errors).items() if not name.startswith("_")}
    assert len(found) > 20
    for name, thing in found.items():
        if isinstance(thing, type) and issubclass(thing, Exception):
            assert issubclass(thing, errors.SailenvError)
            assert name in (errors.__doc__ or "")


@given(st.tuples(*[st.floats(-9.0, 9.0)] * 3).filter(lambda d: np.linalg.norm(d) > 1e-3))
def test_a_light_that_becomes_brighter_does_not_turn(
    direction: tuple[float, float, float],
) -> None:
    light = Light(name="sun", type="directional", direction=direction)
    assert replace(light, intensity=2.0).direction == light.direction
    np.testing.assert_allclose(light.direction, direction / np.linalg.norm(direction), atol=1e-12)


def states(**fields: object) -> InstanceStates:
    given: dict[str, object] = {
        "ids": [3, 9],
        "positions": np.zeros((2, 3)),
        "orientations": [[0, 0, 0, 1], [0, 0.6, 0, 0.8]],
        "linear_velocities": np.zeros((2, 3)),
        "angular_velocities": np.ones((2, 3)),
        **fields,
    }
    return InstanceStates(**given)  # type: ignore[arg-type]


def test_states_are_frozen_copies_with_rows_by_id() -> None:
    """What was given may change; matrices are those of `Pose`; equal numbers are equal states."""
    places = np.zeros((2, 3))
    made = states(positions=places)
    places[:] = 7.0
    assert not made.positions.any()
    with pytest.raises(ValueError, match="read-only"):
        made.positions[0] = 1.0
    assert [made.row(9), made.row_of_id[3], made.row_of_id[4]] == [1, 0, -1]
    expected = Pose((0, 0, 0), (0, 0.6, 0, 0.8)).matrix()
    assert made.matrices[1].tobytes() == expected.tobytes()
    assert made == states()
    assert made != states(positions=np.ones((2, 3)))
    assert (made.scales == 1.0).all()
    assert len(made) == 2
    for unknown in (4, -1, 70000):
        with pytest.raises(InvalidRequest, match="an instance that there was"):
            made.row(unknown)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("ids", [9, 3]),
        ("ids", [0, 3]),
        ("ids", [1, 2, 3]),
        ("positions", np.zeros((2, 4))),
        ("positions", np.full((2, 3), np.nan)),
        ("orientations", np.zeros((2, 4))),
        ("scales", np.ones(2)),
        ("histories", [1]),
    ],
)
def test_states_that_cannot_be_are_refused(field: str, value: object) -> None:
    """With what is accepted."""
    with pytest.raises(InvalidRequest, match="of instances"):
        states(**{field: value})
