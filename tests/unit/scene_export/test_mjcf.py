"""MJCF: MuJoCo finds bodies, joints, masses and shapes where they are, and lets things rest."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
import yaml
from numpy.typing import NDArray

from sailenv_content.scene_import.importers import import_scene
from sailenv_ros import export_asset
from sailenv_ros.assets.pack import AssetPack
from sailenv_ros.scene_export.contents import BodyJoint, ExportedScene
from sailenv_ros.scene_export.mjcf import write_mjcf
from sailenv_ros.scene_export.saving import save
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.model import BoxShape
from sailenv_ros.world.kinematics import link_pose
from sailenv_ros.world.world import World

Doubles = NDArray[np.float64]


@pytest.fixture(scope="module")
def file(scene: ExportedScene, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("mjcf")
    save(write_mjcf(scene, "little_xml"), folder / "little.xml", folder / "little_xml")
    return folder / "little.xml"


@pytest.fixture(scope="module")
def model(file: Path) -> Any:
    return mujoco.MjModel.from_xml_path(str(file))


@pytest.fixture
def data(model: Any) -> Any:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    return data


def test_every_body_is_where_it_is(model: Any, data: Any, world: World) -> None:
    """In the first keyframe, with the doors as they stand."""
    assert model.nbody == 1 + len(world.bodies)
    for body in world.bodies:
        number = model.body(body.placement.name).id
        matrix = body.world_from_body()
        assert np.abs(data.xpos[number] - matrix[:3, 3]).max() < 1e-9, body.placement.name
        assert np.abs(data.xmat[number].reshape(3, 3) - matrix[:3, :3]).max() < 1e-9


def test_joints_have_our_axes_limits_and_ways(model: Any, data: Any, world: World) -> None:
    """Poses agree at both limits and between them."""
    joints = {joint.name: joint for joint in world.joints()}
    assert {model.joint(n).name for n in range(model.njnt) if model.jnt_type[n] > 1} == set(joints)
    for body in world.bodies:
        name = body.placement.name
        if name not in joints:
            continue
        placed = body.placement.joint
        assert placed is not None
        joint = model.joint(name)
        assert joint.range.tolist() == pytest.approx([joints[name].low, joints[name].high])
        axis = body.world_from_body()[:3, :3] @ np.array(placed.spec.unit_axis)
        assert np.abs(data.xaxis[joint.id] - axis).max() < 1e-6
        for share in (0.0, 0.3, 1.0):
            position = joints[name].low + share * (joints[name].high - joints[name].low)
            data.qpos[joint.qposadr[0]] = position
            mujoco.mj_kinematics(model, data)
            expected = link_pose(body.rest_pose(), placed, position).matrix()  # type: ignore[attr-defined]  # on a joint
            number = model.body(name).id
            assert np.abs(data.xpos[number] - expected[:3, 3]).max() < 1e-6
            assert np.abs(data.xmat[number].reshape(3, 3) - expected[:3, :3]).max() < 1e-6


def test_masses_and_centres_are_ours(model: Any, scene: ExportedScene) -> None:
    """Also moments of inertia, about our axes."""
    for body in scene.bodies:
        held = model.body(body.name)
        assert held.mass[0] == pytest.approx(body.mass_kg)
        if body.mass_kg:
            assert held.ipos == pytest.approx(body.centre_m)
            turn = np.zeros(9)
            mujoco.mju_quat2Mat(turn, held.iquat)
            axes = turn.reshape(3, 3)
            moments = axes @ np.diag(held.inertia) @ axes.T
            assert moments == pytest.approx(np.diag(body.inertia_kg_m2), abs=1e-9)


def test_shapes_and_labels_of_geometries(model: Any, scene: ExportedScene) -> None:
    """Solids are solids of our sizes; what is drawn has its ids and collides with nothing."""
    for body in scene.bodies:
        for number, shape in enumerate(body.shapes):
            geom = model.geom(f"shape {number} of {body.name}")
            assert model.geom_contype[geom.id] == 1
            if isinstance(shape, BoxShape):
                assert geom.size == pytest.approx(shape.half_extents_m)
                assert geom.pos == pytest.approx(shape.centre_m)
        for piece in body.pieces:
            geom = model.geom(f"drawn 0 of {piece.instance.name}")
            assert geom.user.tolist() == [piece.instance.id, piece.instance.category_id]
            assert (model.geom_contype[geom.id], model.geom_group[geom.id]) == (0, 2)


def test_what_is_drawn_is_there(model: Any, data: Any, scene: ExportedScene) -> None:
    """Vertices of scaled meshes are where ours are."""
    body = scene.by_name["can"]
    geom = model.geom("drawn 0 of can").id
    mesh = model.geom_dataid[geom]
    first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    local = model.mesh_vert[first : first + count]
    found = local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    own = body.pieces[0].parts[0].mesh.positions * body.scale
    own = own @ body.pose.matrix()[:3, :3].T + body.pose.position_m
    assert np.abs(found.min(axis=0) - own.min(axis=0)).max() < 1e-6
    assert np.abs(found.max(axis=0) - own.max(axis=0)).max() < 1e-6


def test_things_rest_and_doors_stay(model: Any, data: Any) -> None:
    """After a second nothing has moved by 5 mm."""
    before = data.xpos.copy()
    while data.time < 1.0:
        mujoco.mj_step(model, data)
    assert np.abs(data.xpos - before).max() < 0.005


def test_doors_open_to_their_limits(model: Any, data: Any) -> None:
    """Nothing of the piece is in their way, and their friction gives in."""
    joint = model.joint("wardrobe door 1")
    low, high = joint.range
    far = high if abs(high) > abs(low) else low
    while data.time < 3.0:
        data.qfrc_applied[joint.dofadr[0]] = np.sign(far) * 8.0
        mujoco.mj_step(model, data)
    assert abs(data.qpos[joint.qposadr[0]] - far) < 0.05 * abs(far)


def test_the_importer_reads_it_back(file: Path, scene: ExportedScene, tmp_path: Path) -> None:
    """The same names, categories, poses, joints and masses."""
    import_scene(file, tmp_path / "again.yaml", tmp_path / "pack")
    found = yaml.safe_load((tmp_path / "again.yaml").read_text(encoding="utf-8"))
    objects = {entry["name"]: entry for entry in found["objects"]}
    assert set(objects) == set(scene.by_name)
    pack = AssetPack(tmp_path / "pack")
    for name, body in scene.by_name.items():
        entry = objects[name]
        assert pack.load(entry["asset"]).category == body.instance.category, name
        pose = body.pose if body.joint is None else body.joint.parent_from_rest
        read = Pose.from_rpy_deg(entry["position"], entry.get("rotation", [0.0] * 3))
        assert np.abs(read.matrix() - pose.matrix()).max() < 1e-6, name
        if not body.static:
            assert entry["mass"] == pytest.approx(body.mass_kg, abs=2e-6)
        if body.joint is not None:
            _assert_joint(entry["joint"], body.joint)


def _assert_joint(entry: dict[str, Any], joint: BodyJoint) -> None:
    assert (entry["type"], entry["parent"]) == (joint.type, joint.parent)
    assert entry["axis"] == pytest.approx(joint.axis, abs=1e-6)
    assert entry["limits"] == pytest.approx(joint.limits, abs=1e-6)
    assert entry.get("position", 0.0) == pytest.approx(joint.position, abs=1e-6)
    if joint.type == "hinge":
        assert entry.get("origin", [0.0] * 3) == pytest.approx(joint.origin_m, abs=1e-6)


def test_one_piece_of_furniture_in_two_formats(tmp_path: Path) -> None:
    """By MuJoCo its doors have equal masses, axes, limits and, opened, equal places."""
    mjcf, urdf = (_opened(tmp_path / f"wardrobe{suffix}") for suffix in (".xml", ".urdf"))
    for first, second in zip(mjcf, urdf, strict=True):
        assert first == pytest.approx(second, abs=1e-6)
    centres, axes, ranges, _ = mjcf
    assert len(centres) == 4
    assert np.abs(np.abs(axes) - (0.0, 0.0, 1.0)).max() < 1e-6
    assert (ranges[:, 0] < ranges[:, 1]).all()


def _opened(file: Path) -> tuple[Doubles, Doubles, Doubles, Doubles]:
    """Centres of mass of doors that are 70 % open, axes, limits, and masses of all bodies."""
    report = export_asset("wardrobe~hinged:7", file)
    assert report.folder is not None
    assets = {path.name: path.read_bytes() for path in report.folder.iterdir()}
    text = file.read_text(encoding="utf-8").replace(f"{report.folder.name}/", "")
    text = text.replace(f'dir="{report.folder.name}"', 'dir=""')
    if file.suffix == ".urdf":
        settings = '<mujoco><compiler discardvisual="false" fusestatic="false"/></mujoco>'
        text = text.replace("</robot>", f"{settings}</robot>")
    model = mujoco.MjModel.from_xml_string(text, assets)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    low, high = model.jnt_range.T
    axes = data.xaxis.copy()
    data.qpos[:] = low + 0.7 * (high - low)
    mujoco.mj_forward(model, data)
    masses = model.body_mass[1:].copy()
    return data.xipos[model.jnt_bodyid].copy(), axes, model.jnt_range.copy(), masses


@pytest.mark.parametrize(("suffix", "name"), [(".xml", "MJCF"), (".urdf", "URDF")])
def test_what_joints_do_by_themselves_is_told_as_lost(
    tmp_path: Path, suffix: str, name: str
) -> None:
    """Of four doors with magnets."""
    lost = export_asset("wardrobe~hinged:7", tmp_path / f"wardrobe{suffix}").losses
    assert f"soft close and detents of 4 joints have no equal in {name}" in lost


def test_names_of_urdf_are_identifiers(tmp_path: Path) -> None:
    """ROS wants no spaces in names of links and joints."""
    export_asset("wardrobe~hinged:7", tmp_path / "wardrobe.urdf")
    root = ElementTree.parse(tmp_path / "wardrobe.urdf").getroot()
    names = [node.get("name", "") for node in root.iter() if node.tag in ("link", "joint")]
    assert len(names) == len(set(names)) == 5 + 4
    assert all(name.isidentifier() for name in names)
