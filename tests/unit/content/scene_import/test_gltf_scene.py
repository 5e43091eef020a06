"""glTF files become scenes: nodes where they are, lights in our units, cameras as they look."""

from __future__ import annotations

import contextlib
import json
import math
import struct
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailenv_content.scene_import.gltf_scene import import_gltf
from sailenv_content.scene_import.imported import Names
from sailenv_content.scene_import.importers import import_scene
from sailenv_ros import Simulation
from sailenv_ros.errors import AssetError, SailenvError

HALF = math.sqrt(0.5)


def colours(rgb: tuple[float, float, float]) -> Any:
    material = trimesh.visual.material.PBRMaterial(baseColorFactor=[*rgb, 1.0], roughnessFactor=0.7)
    return trimesh.visual.TextureVisuals(material=material)


def box(size: tuple[float, float, float], rgb: tuple[float, float, float]) -> trimesh.Trimesh:
    mesh = trimesh.creation.box(size)
    mesh.visual = colours(rgb)
    return mesh


def scene_bytes() -> bytes:
    """A room in one mesh seen from inside, a table, two equal chairs, one of them turned."""
    scene = trimesh.Scene()
    room = box((6, 3, 6), (0.8, 0.8, 0.8))
    room.invert()
    scene.add_geometry(
        room, "room", transform=trimesh.transformations.translation_matrix((0, 1.5, 0))
    )
    scene.add_geometry(
        box((1.2, 0.8, 0.8), (0.5, 0.3, 0.1)),
        "DiningTable",
        transform=trimesh.transformations.translation_matrix((1.0, 0.4, -1.0)),
    )
    chair = box((0.4, 0.9, 0.4), (0.1, 0.3, 0.6))
    for number, x in enumerate((-1.0, -2.0)):
        place = trimesh.transformations.translation_matrix((x, 0.45, 1.0))
        scene.add_geometry(chair, f"Chair.{number}", geom_name="chair", transform=place)
    data: bytes = scene.export(file_type="glb")
    return data


def edited(data: bytes, change: Callable[[dict[str, Any]], None]) -> bytes:
    """A binary glTF with another JSON."""
    length = struct.unpack("<I", data[12:16])[0]
    tree = json.loads(data[20 : 20 + length])
    change(tree)
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest


def with_lights(tree: dict[str, Any]) -> None:
    nodes = tree["nodes"]
    first = len(nodes)
    tree["extensionsUsed"] = ["KHR_lights_punctual"]
    tree["extensions"] = {
        "KHR_lights_punctual": {
            "lights": [
                {"type": "point", "name": "bulb", "intensity": 683.0, "color": [1, 0.5, 0.25]},
                {"type": "spot", "intensity": 1366.0, "range": 7.0,
                 "spot": {"innerConeAngle": 0.2, "outerConeAngle": 0.5}},
                {"type": "directional", "intensity": 6830.0},
            ]
        }
    }  # fmt: skip
    tree["cameras"] = [{"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}}]

    def lamp(number: int, **pose: Any) -> dict[str, Any]:
        return {**pose, "extensions": {"KHR_lights_punctual": {"light": number}}}

    nodes += [
        lamp(0, name="lamp", translation=[1, 2, 3]),
        lamp(1, translation=[0, 2, 0], rotation=[-HALF, 0, 0, HALF]),  # down
        lamp(2),
        {"name": "Eye", "camera": 0, "translation": [0, 1.5, 2.5]},
    ]
    tree["scenes"][0]["nodes"] += [first, first + 1, first + 2, first + 3]


def test_nodes_become_objects(tmp_path: Path, packs: Path) -> None:
    """Where the file has them: (x, y, z) there is (z, x, y) here; equal ones share a model."""
    (tmp_path / "room.glb").write_bytes(scene_bytes())
    report = import_scene(tmp_path / "room.glb", tmp_path / "room.yaml", packs)
    assert (report.objects, report.models) == (4, 3)
    data = yaml.safe_load((tmp_path / "room.yaml").read_text(encoding="utf-8"))
    found = {entry["name"]: entry for entry in data["objects"]}
    assert found["DiningTable"]["position"] == pytest.approx([-1.0, 1.0, 0.0])
    assert found["Chair.0"]["position"] == pytest.approx([1.0, -1.0, 0.0])
    assert found["Chair.0"]["asset"] == found["Chair.1"]["asset"]
    with Simulation(tmp_path / "room.yaml", mode="lockstep") as simulation:
        names = {i.id: (i.name, i.category) for i in simulation.info.instances}
        cast = simulation.cast_rays(
            (0.0, 0.0, 0.5), [(1, -1, 0), (-1, 1, 0), (1, 1, 0), (0, 0, -1), (0, 0, 1)]
        )
        hit = [names[int(i)] for i in cast.instance_ids]
        assert hit[0] == ("Chair.0", "chair")
        assert hit[1] == ("DiningTable", "dining table")
        assert [name for name, _ in hit[2:]] == ["room"] * 3
        np.testing.assert_allclose(cast.distances_m[3:], [0.5, 2.5], atol=1e-5)
        # The room is hollow: a body stands in it, and not in the table or in the walls.
        space = simulation.free_space(1.0, 0.2)
        assert space.is_free((0.0, 0.0))
        assert not space.is_free((-1.0, 1.0))
        assert not space.is_free((2.9, 0.0))


def test_lights_and_cameras_are_those_of_the_file(tmp_path: Path, packs: Path) -> None:
    """Candela / 683 are W/sr, lux / 683 are W/m²; what looks along -z there looks along -x here."""
    (tmp_path / "lit.glb").write_bytes(edited(scene_bytes(), with_lights))
    import_scene(tmp_path / "lit.glb", tmp_path / "lit.yaml", packs)
    data = yaml.safe_load((tmp_path / "lit.yaml").read_text(encoding="utf-8"))
    bulb, spot, sun = data["lights"]
    assert (bulb["type"], bulb["intensity"]) == ("point", pytest.approx(1.0))
    assert bulb["position"] == pytest.approx([3, 1, 2])
    assert bulb["colour"] == pytest.approx([1, 0.5, 0.25])
    assert (spot["intensity"], spot["range"]) == (pytest.approx(2.0), 7)
    assert spot["direction"] == pytest.approx([0, 0, -1], abs=1e-6)
    assert spot["outer_cone"] == pytest.approx(math.degrees(0.5), abs=1e-3)
    assert sun["direction"] == pytest.approx([-1, 0, 0], abs=1e-6)
    assert sun["intensity"] == pytest.approx(10.0)
    (eye,) = data["agents"]
    assert eye["position"] == pytest.approx([2.5, 0, 1.5])
    assert abs(eye["rotation"][2]) == pytest.approx(180.0)
    assert eye["rotation"][:2] == pytest.approx([0, 0], abs=1e-6)
    assert eye["vertical_fov"] == pytest.approx(math.degrees(1.0), abs=1e-3)


def shared_child(tree: dict[str, Any]) -> None:
    tree["nodes"] += [{"children": [0]}, {"children": [0]}]
    tree["scenes"][0]["nodes"] += [len(tree["nodes"]) - 2, len(tree["nodes"]) - 1]


def own_parent(tree: dict[str, Any]) -> None:
    tree["nodes"].append({"children": [len(tree["nodes"])]})
    tree["scenes"][0]["nodes"].append(len(tree["nodes"]) - 1)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda tree: tree["buffers"].append({"uri": "../../secret", "byteLength": 1}), "beside"),
        (lambda tree: tree["buffers"].append({"uri": "/etc/passwd", "byteLength": 1}), "beside"),
        (shared_child, "two parents"),
        (own_parent, "two parents, or is its own"),
        (lambda tree: tree["scenes"][0]["nodes"].append(99), "not there"),
        (lambda tree: tree["nodes"][0].update(matrix=[1, 2]), "no pose"),
        (lambda tree: tree.update(nodes=3), "no list"),
    ],
)
def test_malformed_trees_are_refused_and_leave_nothing(
    tmp_path: Path, packs: Path, change: Callable[[dict[str, Any]], None], sentence: str
) -> None:
    """In one sentence, without a trace."""
    (tmp_path / "bad.glb").write_bytes(edited(scene_bytes(), change))
    before = sorted(tmp_path.rglob("*"))
    with pytest.raises(AssetError, match=sentence):
        import_scene(tmp_path / "bad.glb", tmp_path / "bad.yaml", packs)
    assert sorted(tmp_path.rglob("*")) == before


DATA = scene_bytes()


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    places=st.lists(
        st.tuples(st.integers(0, len(DATA) - 1), st.binary(min_size=1, max_size=5)),
        min_size=1,
        max_size=5,
    ),
    end=st.integers(0, len(DATA)),
)
def test_whatever_is_in_the_file_is_read_or_refused(
    tmp_path: Path, places: list[tuple[int, bytes]], end: int
) -> None:
    """Bytes exchanged and cut off: a scene, or one of our own errors."""
    data = bytearray(DATA)
    for at, given_bytes in places:
        data[at : at + len(given_bytes)] = given_bytes
    path = tmp_path / "fuzz.glb"
    path.write_bytes(bytes(data) if end % 2 else bytes(data[:end]))
    with contextlib.suppress(SailenvError):
        assert len(import_gltf(path, Names("fuzz"), {}).objects) <= 20
