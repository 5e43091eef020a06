"""URDF and MJCF files become scenes: bodies where their joints put them, hostile files refused."""

from __future__ import annotations

import contextlib
from pathlib import Path

import numpy as np
import pytest
import trimesh
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailenv_content.scene_import.imported import Names
from sailenv_content.scene_import.importers import import_scene
from sailenv_content.scene_import.robot_scene import import_robot_scene
from sailenv_ros import Simulation
from sailenv_ros.assets.robots import read_apart
from sailenv_ros.errors import AssetError, SailenvError

KITCHEN = """
<mujoco model="kitchen">
  <worldbody>
    <light name="top" type="directional" pos="0 0 3" dir="0 0 -1" diffuse="0.8 0.8 0.4"/>
    <camera name="eye" pos="0 -3 1.5" xyaxes="1 0 0 0 0 1" fovy="50"/>
    <geom name="floor" type="plane" size="3 2 0.1"/>
    <body name="cabinet" pos="1 0 0.4" euler="0 0 90">
      <geom type="box" size="0.3 0.4 0.4" rgba="1 0 0 1"/>
      <body name="door" pos="-0.3 0.4 0">
        <joint name="hinge" type="hinge" axis="0 0 1"/>
        <geom type="box" pos="-0.02 -0.4 0" size="0.015 0.39 0.38"/>
      </body>
    </body>
    <body name="ball" pos="0 0 0.2">
      <freejoint/>
      <geom type="sphere" size="0.15" mass="0.4"/>
    </body>
  </worldbody>
</mujoco>
"""

CABINET = """
<robot name="cab">
  <link name="base">
    <visual><origin xyz="0 0 0.4"/><geometry><mesh filename="meshes/unit.stl" scale="0.6 0.8 0.8"/>
    </geometry></visual>
    <collision><origin xyz="0 0 0.5"/><geometry><box size="0.6 0.8 1.0"/></geometry></collision>
  </link>
  <link name="drawer">
    <inertial><mass value="1"/>
      <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.02 0.7 0.3"/></geometry></visual>
  </link>
  <joint name="slide" type="prismatic">
    <parent link="base"/><child link="drawer"/><origin xyz="0.32 0 0.5"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="0.4" effort="1" velocity="1"/>
  </joint>
</robot>
"""


def test_bodies_of_mjcf_become_objects(tmp_path: Path, packs: Path) -> None:
    """In their poses; free ones fall, the others are held, and joints are noted."""
    (tmp_path / "kitchen.xml").write_text(KITCHEN, encoding="utf-8")
    report = import_scene(tmp_path / "kitchen.xml", tmp_path / "kitchen.yaml", packs)
    held = "no friction in the file and gets enough to hold its weight"
    assert report.notes == (f"1 joint has {held}: hinge",)
    data = yaml.safe_load((tmp_path / "kitchen.yaml").read_text(encoding="utf-8"))
    found = {entry["name"]: entry for entry in data["objects"]}
    assert found["cabinet"]["rotation"] == pytest.approx([0, 0, 90])
    assert found["door"]["position"] == pytest.approx([-0.3, 0.4, 0.0])
    assert found["door"]["joint"]["parent"] == "cabinet"
    assert (found["ball"]["mass"], "static" in found["ball"]) == (pytest.approx(0.4), False)
    (light,), (eye,) = data["lights"], data["agents"]
    assert light["direction"] == pytest.approx([0, 0, -1])
    assert light["colour"] == pytest.approx([1, 1, 0.5])
    assert eye["rotation"] == pytest.approx([0, 0, 90], abs=1e-4)
    with Simulation(tmp_path / "kitchen.yaml", mode="lockstep") as simulation:
        ids = {i.name: i.id for i in simulation.info.instances}
        cast = simulation.cast_rays([(1, -2, 0.4), (1, 0, 2)], [(0, 1, 0), (0, 0, -1)])
        assert cast.instance_ids.tolist() == [ids["door"], ids["cabinet"]]
        # The door hangs before the cabinet's side, which is turned to the south.
        np.testing.assert_allclose(cast.distances_m, [1.665, 1.2], atol=1e-5)
        simulation.step(480)
        assert simulation.get_object("ball").pose.position_m[2] == pytest.approx(0.15, abs=0.01)
        # The door's origin, turned with the cabinet: (-0.3, 0.4) becomes (-0.4, -0.3).
        assert simulation.get_object("door").pose.position_m == pytest.approx((0.6, -0.3, 0.4))


def test_links_of_urdf_become_objects(tmp_path: Path, packs: Path) -> None:
    """Their visuals are drawn, with meshes from a folder beside the file."""
    (tmp_path / "meshes").mkdir()
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "meshes" / "unit.stl")
    (tmp_path / "cab.urdf").write_text(CABINET, encoding="utf-8")
    import_scene(tmp_path / "cab.urdf", tmp_path / "cab.yaml", packs)
    with Simulation(tmp_path / "cab.yaml", mode="lockstep") as simulation:
        ids = {i.name: i.id for i in simulation.info.instances}
        cast = simulation.cast_rays(
            [(0, 0, 3), (3, 0, 0.5), (-3, 0, 0.5)], [(0, 0, -1), (-1, 0, 0), (1, 0, 0)]
        )
        assert cast.instance_ids.tolist() == [ids["base"], ids["drawer"], ids["base"]]
        np.testing.assert_allclose(cast.distances_m, [2.2, 2.67, 2.7], atol=1e-5)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<!DOCTYPE mujoco [<!ENTITY a 'x'>]><mujoco/>", "document type or entities"),
        ("<sdf/>", "must begin with <robot> or <mujoco>"),
        ("<mujoco><include file='../../etc/passwd'/></mujoco>", "not beside it"),
        ("<mujoco><compiler meshdir='/etc'/></mujoco>", "not beside it"),
        ("<mujoco><asset><mesh file='/etc/passwd'/></asset></mujoco>", "not beside it"),
        ("<robot><x filename='package://other/mesh.stl'/></robot>", "not beside it"),
        ("<mujoco><worldbody><replicate count='1000000000'/></worldbody></mujoco>", "<replicate>"),
        ("<mujoco><extension><plugin plugin='x'/></extension></mujoco>", "<plugin>"),
        ("<mujoco><worldbody><geom size='a'/></worldbody></mujoco>", "MuJoCo cannot read it"),
        ("<mujoco><asset><mesh name='m' file='no.stl'/></asset></mujoco>", "MuJoCo cannot read it"),
        ("<mujoco/>", "nothing that a scene could show"),
    ],
)
def test_malformed_files_are_refused_and_leave_nothing(
    tmp_path: Path, packs: Path, text: str, sentence: str
) -> None:
    """One sentence, no scene, no pack."""
    (tmp_path / "bad.xml").write_text(text, encoding="utf-8")
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(AssetError, match=sentence) as caught:
        import_scene(tmp_path / "bad.xml", tmp_path / "bad.yaml", packs)
    assert "\n" not in str(caught.value)
    assert sorted(tmp_path.rglob("*")) == before


def test_a_reader_without_memory_or_time_is_ended(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """And said to be, in our words."""
    path = tmp_path / "kitchen.xml"
    path.write_text(KITCHEN, encoding="utf-8")
    monkeypatch.setattr(read_apart, "MEMORY_BYTES", 64 * 2**20)
    with pytest.raises(AssetError, match="its reader ended"):
        import_robot_scene(path, Names("x"), {})
    monkeypatch.setattr(read_apart, "LIMIT_S", 0.01)
    with pytest.raises(AssetError, match="took longer"):
        import_robot_scene(path, Names("x"), {})


@settings(
    max_examples=4, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    places=st.lists(
        st.tuples(st.integers(0, len(KITCHEN) - 1), st.sampled_from(list('0-9e<>/" 1'))),
        min_size=1,
        max_size=3,
    )
)
def test_whatever_is_in_the_file_is_read_or_refused(
    tmp_path: Path, places: list[tuple[int, str]]
) -> None:
    """Letters exchanged: a scene, or one of our own errors."""
    text = list(KITCHEN)
    for at, letter in places:
        text[at] = letter
    path = tmp_path / "fuzz.xml"
    path.write_text("".join(text), encoding="utf-8")
    with contextlib.suppress(SailenvError):
        assert len(import_robot_scene(path, Names("fuzz"), {}).objects) <= 10
