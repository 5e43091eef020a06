"""URDF files: what is read of them, and what is refused in words."""

from __future__ import annotations

import re
import time
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.assets.robots import RobotStore, robot_path
from sailenv_ros.errors import AssetError
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import BoxShape
from tests.support.robot_files import ARM, CART, link

MOVES = '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>{}</joint>'
BOX = '<box size="1 1 1"/>'
BARE = f'<link name="a"><visual><geometry>{BOX}</geometry></visual></link>'
LIMIT = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'


def written(tmp_path: Path, text: str, name: str = "robot.urdf") -> Path:
    path = tmp_path / name
    path.write_text(text, encoding="utf-8")
    return path


def test_links_joints_and_frames_are_those_of_the_file(tmp_path: Path) -> None:
    model = RobotStore().read(written(tmp_path, ARM))
    assert [one.name for one in model.links] == ["base", "upper", "lower", "left", "right"]
    assert [one.joint.name for one in model.moving] == ["shoulder", "elbow", "grip", "grip 2"]
    assert [(one.name, one.link) for one in model.frames] == [("tip", "lower")]
    upper = model.links[1]
    assert upper.joint.limits == (-2.0, 2.0)
    assert (upper.joint.effort, upper.joint.speed) == (80.0, 3.0)
    assert upper.asset.mass_kg == 1.0
    assert upper.asset.centre_of_mass_m == (0.0, 0.0, 0.2)
    (shape,) = upper.asset.collision
    assert isinstance(shape, BoxShape)
    np.testing.assert_allclose(upper.asset.model.bounds(), [[-0.05, -0.05, 0], [0.05, 0.05, 0.4]])
    mimic = model.links[4].joint.mimic
    assert mimic is not None
    assert mimic.joint == "grip"


def test_principal_axes_give_the_tensor_back(tmp_path: Path) -> None:
    text = ARM.replace('ixy="0"', 'ixy="0.002"', 1)
    inertia = RobotStore().read(written(tmp_path, text)).links[0].asset.inertia
    assert inertia is not None
    turn = Pose(orientation_xyzw=inertia.axes_xyzw).matrix()[:3, :3]
    tensor = turn @ np.diag(inertia.moments_kg_m2) @ turn.T
    expected = np.diag([5 * 0.13 / 12, 5 * 0.13 / 12, 5 * 0.18 / 12])
    expected[0, 1] = expected[1, 0] = 0.002
    np.testing.assert_allclose(tensor, expected, atol=1e-12)


def test_a_first_link_that_is_only_a_place_becomes_a_frame(tmp_path: Path) -> None:
    text = '<robot name="r"><link name="footprint"/>' + link("body")
    text += '<joint name="j" type="fixed"><parent link="footprint"/><child link="body"/>'
    text += '<origin xyz="0 0 0.5"/></joint></robot>'
    model = RobotStore().read(written(tmp_path, text))
    assert [one.name for one in model.links] == ["body"]
    (frame,) = model.frames
    assert (frame.name, frame.link, frame.pose.position_m) == ("footprint", "body", (0, 0, -0.5))


def test_meshes_have_the_colours_of_their_files(tmp_path: Path) -> None:
    """Which the description tints: red of red and blue is red."""
    (tmp_path / "part.mtl").write_text("newmtl red\nKd 1 0 0\n", encoding="utf-8")
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "part.obj").write_text(f"mtllib part.mtl\n{corners}usemtl red\n{faces}", "utf-8")
    (tmp_path / "bare.obj").write_text(corners + faces, encoding="utf-8")
    text = '<robot name="r"><link name="a">'
    for name in ("part", "bare"):
        text += f'<visual><geometry><mesh filename="{name}.obj" scale="1 2 3"/></geometry>'
        text += '<material name="m"><color rgba="1 0 1 1"/></material></visual>'
    model = RobotStore().read(written(tmp_path, text + "</link></robot>")).links[0].asset.model
    assert [part.material.base_colour for part in model.parts] == [(1, 0, 0, 1), (1, 0, 1, 1)]
    # The axes of the file are those of the link.
    np.testing.assert_allclose(model.bounds(), [[0, 0, 0], [1, 2, 3]])


@pytest.mark.parametrize(
    ("plugin", "mount"),
    [
        ("libgazebo_ros_diff_drive.so", "differential"),
        ("gz-sim-diff-drive-system", "differential"),
        ("libgazebo_ros_skid_steer_drive.so", "differential"),
        ("gz-sim-mecanum-drive-system", "mecanum"),
        ("gz-sim-ackermann-steering-system", "ackermann"),
        ("gz-sim-imu-system", "fixed"),
    ],
)
def test_a_plugin_of_gazebo_puts_a_robot_on_wheels(plugin: str, mount: str, tmp_path: Path) -> None:
    drive = f'<gazebo><plugin name="drive" filename="{plugin}"/></gazebo></robot>'
    read = RobotStore().read
    assert read(written(tmp_path, CART.replace("</robot>", drive))).mount == mount
    # An arm has no wheels, whatever is said of it.
    assert read(written(tmp_path, ARM.replace("</robot>", drive), "arm.urdf")).mount == "fixed"


HOSTILE = {
    "a loop": (
        link("a") + link("b") + MOVES.format(LIMIT) + MOVES.format(LIMIT)
        .replace('"a"', '"x"').replace('"b"', '"a"').replace('"x"', '"b"').replace('"j"', '"k"'),
        "its joints form a loop",
    ),
    "two parents": (
        link("a") + link("b") + link("c") + MOVES.format(LIMIT)
        + MOVES.format(LIMIT).replace('"a"', '"c"').replace('"j"', '"k"'),
        "hangs on two joints",
    ),
    "two roots": (link("a") + link("b"), "2 links that hang on nothing"),
    "no inertia": (
        link("a") + BARE.replace('"a"', '"b"')
        + MOVES.format(LIMIT),
        "has no <inertial>",
    ),
    "NaN": (link("a").replace('value="1.0"', 'value="nan"'), "must be a number"),
    "an endless place": (
        link("a").replace('<origin xyz="0 0 0.2"/>', '<origin xyz="inf 0 0"/>'), "finite numbers"
    ),
    "a negative moment": (link("a").replace('izz="', 'izz="-'), "moments below 0"),
    "too many links": (
        "".join(f'<link name="a{n}"/>' for n in range(10_000)), "1 to 2000 are accepted"
    ),
    "too many bodies": (
        "".join(link(f"a{n}") for n in range(200))
        + "".join(
            MOVES.format(LIMIT).replace('"a"', '"a0"').replace('"b"', f'"a{n}"')
            .replace('"j"', f'"j{n}"') for n in range(1, 200)
        ),
        "120 are accepted",
    ),
    "no limits": (link("a") + link("b") + MOVES.format(""), "has no <limit>"),
    "limits in the wrong order": (
        link("a") + link("b") + MOVES.format(LIMIT.replace('"-1"', '"2"')), "the lower one first"
    ),
    "a mesh elsewhere": (
        '<link name="a"><visual><geometry><mesh filename="package://../../etc/passwd"/></geometry>'
        "</visual></link>",
        "is not there",
    ),
    "a mesh by a full path": (
        BARE.replace(BOX, '<mesh filename="/etc/passwd"/>'),
        "is not there",
    ),
    "a huge box": (link("a", size="1 1 1000", z=0.2), "from 1e-6 to 100 m"),
    "an unknown joint": (
        link("a") + link("b") + MOVES.format(LIMIT).replace("revolute", "planar"),
        "revolute, continuous, prismatic or fixed",
    ),
    "a follower of nothing": (
        link("a") + link("b") + MOVES.format(LIMIT + '<mimic joint="z"/>'), "follows 'z'"
    ),
    "xacro": ('<xacro:macro name="m"/>' + link("a"), "write the output of xacro"),
    "a name of a path": (link("../a"), "a link is called"),
    "the same name twice": (link("a") + link("a"), "two links have the name"),
    "nothing to be seen": ('<link name="a"/>', "nothing of it can be seen"),
}  # fmt: skip


@pytest.mark.parametrize("case", HOSTILE)
def test_what_cannot_be_a_robot_is_refused_in_words(case: str, tmp_path: Path) -> None:
    body, why = HOSTILE[case]
    header = '<robot name="r" xmlns:xacro="x">'
    began = time.process_time()
    with pytest.raises(AssetError, match=why) as caught:
        RobotStore().read(written(tmp_path, f"{header}{body}</robot>"))
    # What is wrong of the file as a whole has no line.
    whole = case in ("too many links", "nothing to be seen")
    assert bool(re.search(r":\d+:\d+$", caught.value.asset)) is not whole, caught.value
    assert time.process_time() - began < 20.0


@pytest.mark.parametrize(
    ("wrong", "mended", "at"),
    [
        ('lower="2"', 'lower="-1"', '<limit lower="2"'),
        ('value="x"', 'value="1.0"', '<mass value="x"'),
        ('link="nobody"', 'link="b"', '<joint name="j"'),
    ],
)
def test_a_refusal_says_where(wrong: str, mended: str, at: str, tmp_path: Path) -> None:
    """The file, the line and the column where the wrong element begins."""
    text = f"<robot name='r'>\n{link('a')}\n{link('b')}\n  {MOVES.format(LIMIT)}\n</robot>"
    text = text.replace("><", ">\n <")
    assert mended in text
    path = written(tmp_path, text.replace(mended, wrong, 1))
    with pytest.raises(AssetError) as caught:
        RobotStore().read(path)
    before = path.read_text("utf-8").split(at)[0]
    line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
    assert caught.value.asset == f"{path.name}:{line}:{column}"


def test_of_what_is_no_xml_the_place_is_told(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match=r"'robot.urdf:2:3': it is no XML.*mismatched tag"):
        RobotStore().read(written(tmp_path, "<robot name='r'>\n</robat>"))


def test_entities_are_refused(tmp_path: Path) -> None:
    bomb = '<!DOCTYPE r [<!ENTITY a "lol"><!ENTITY b "&a;&a;&a;&a;">]><robot name="&b;"/>'
    with pytest.raises(AssetError, match="entities"):
        RobotStore().read(written(tmp_path, bomb))


def test_files_are_found_beside_a_scene_and_in_packages(tmp_path: Path) -> None:
    path = written(tmp_path, ARM)
    assert robot_path("robot.urdf", tmp_path) == path
    assert robot_path("pybullet_data:r2d2.urdf").name == "r2d2.urdf"
    for file in ("nowhere.urdf", "pybullet_data:../../x.urdf", "no_such_package:a.urdf", "a\0b"):
        with pytest.raises(AssetError):
            robot_path(file, tmp_path)
