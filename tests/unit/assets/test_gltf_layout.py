"""What a glTF file's description points at is there, or the file is refused in words."""

from __future__ import annotations

import base64
import json
import struct
from pathlib import Path
from typing import Any

import pytest

from sailenv_ros.assets.glb import glb_bytes
from sailenv_ros.assets.importing import import_asset
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import AssetError
from sailenv_ros.types.model import Asset


def _cube() -> tuple[dict[str, Any], bytes]:
    """Return the description and the buffer of a cube."""
    data = glb_bytes(Primitives().load("cube").model.parts, ())
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def _glb(tree: object, buffer: bytes) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    size = 28 + len(text) + len(buffer)
    head = struct.pack("<5I", 0x46546C67, 2, size, len(text), 0x4E4F534A)
    return head + text + struct.pack("<2I", len(buffer), 0x004E4942) + buffer


def _with(place: str, value: object) -> dict[str, Any]:
    """Return the cube's description with another value in a place; None removes it."""
    tree, _ = _cube()
    *above, last = place.split("/")
    table: Any = tree
    for key in above:
        table = table[int(key) if key.isdigit() else key]
    key = int(last) if last.isdigit() else last
    if value is None:
        del table[key]
    else:
        table[key] = value
    return tree


def _read(path: Path) -> Asset:
    return import_asset(path, name="cube", category="box", convex=False)


@pytest.mark.parametrize(
    ("place", "value", "sentence"),
    [
        ("accessors", None, "meshes/0/primitives/0/indices is 0, of 0 accessors"),
        ("accessors", {"0": {}}, 'accessors is {"0": {}}, and no list'),
        ("accessors/1/count", 25, "accessors/1 ends at byte 300, and bufferViews/1 has 288"),
        ("accessors/1/count", 2**60, f"accessors/1 ends at byte {12 * 2**60}, and bufferViews/1"),
        ("accessors/1/count", -1, "accessors/1/count is -1, and an integer from 0 on is"),
        ("accessors/1/count", 1.5, "accessors/1/count is 1.5, and an integer from 0 on is"),
        ("accessors/1/byteOffset", 4, "accessors/1 ends at byte 292, and bufferViews/1 has 288"),
        ("accessors/1/bufferView", 4, "accessors/1/bufferView is 4, of 4 bufferViews"),
        ("accessors/1/bufferView", -1, "accessors/1/bufferView is -1, of 4 bufferViews"),
        ("accessors/1/componentType", 7, "accessors/1/componentType is 7, of 5120, 5121"),
        ("accessors/1/type", "VEC5", 'accessors/1/type is "VEC5", of SCALAR, VEC2'),
        ("bufferViews/1/byteStride", 16, "accessors/1 ends at byte 380, and bufferViews/1 has 288"),
        ("bufferViews/1/byteStride", 8, "accessors/1 has elements of 12 bytes every 8 bytes"),
        ("bufferViews/1/byteLength", 10**9, "bufferViews/1 ends at byte 1000000144, and buffer 0"),
        ("bufferViews/1/buffer", 1, "bufferViews/1/buffer is 1, of 1 buffers"),
        ("buffers/0/byteLength", 10, "bufferViews/0 ends at byte 144, and buffer 0 has 10"),
        ("buffers/0/uri", "no such file.bin", '"no such file.bin", of buffers/0, is not there'),
        ("buffers/0/uri", 3, "buffers/0/uri is 3, and a text is accepted"),
        ("meshes/0/primitives/0/attributes/NORMAL", 9, "attributes/NORMAL is 9, of 4 accessors"),
        ("meshes/0/primitives", "none", 'meshes/0/primitives is "none", and no list'),
        ("meshes/0", 3, "meshes/0 is 3, and no JSON object"),
        ("materials", None, "meshes/0/primitives/0/material is 0, of 0 materials"),
        ("nodes/0/mesh", 5, "nodes/0/mesh is 5, of 1 meshes"),
        ("nodes/0/children", [0, 8], "nodes/0/children/1 is 8, of 1 nodes"),
        ("scene", "first", 'scene is "first", of 1 scenes'),
    ],
)
def test_what_points_beyond_the_file_is_named(
    tmp_path: Path, place: str, value: object, sentence: str
) -> None:
    """The place in the description, what stands there, and what there is."""
    path = tmp_path / "cube.glb"
    path.write_bytes(_glb(_with(place, value), _cube()[1]))
    with pytest.raises(AssetError) as refused:
        _read(path)
    assert sentence in str(refused.value)


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"glTF", "it has 4 bytes, and no header"),
        (b"x" * 100, "it does not begin as a binary glTF 2 file does"),
        (_glb([1], b""), "its description is no JSON object"),
        (_glb({}, b"")[:-8], "it holds no triangles"),
        (_glb({}, b"").replace(b"{}", b"{{"), "its description is no JSON"),
    ],
)
def test_what_is_no_description_is_told(tmp_path: Path, data: bytes, sentence: str) -> None:
    """A file that ends too early, or is something else."""
    (tmp_path / "a.glb").write_bytes(data)
    with pytest.raises(AssetError, match=sentence):
        _read(tmp_path / "a.glb")


def test_buffers_beside_the_description_and_in_it(tmp_path: Path) -> None:
    """A file, and text in base 64, are read; cut ones are refused."""
    tree, buffer = _cube()
    inside = "data:application/octet-stream;base64,"
    for uri, kept in (("a b.bin", None), (inside, None), ("a b.bin", 700), (inside, 700)):
        (tmp_path / "a b.bin").write_bytes(buffer[:kept])
        given = uri + base64.b64encode(buffer[:kept]).decode() if uri == inside else uri
        tree["buffers"][0]["uri"] = given
        path = tmp_path / "cube.gltf"
        path.write_text(json.dumps(tree))
        if kept is None:
            (part,) = _read(path).model.parts
            assert len(part.mesh.positions) == 24
        else:
            with pytest.raises(AssetError, match="bufferViews/3 ends at byte 912, and buffer 0"):
                _read(path)


def test_a_cut_file_is_refused(tmp_path: Path) -> None:
    """Buffers that end before their views do."""
    path = tmp_path / "cube.glb"
    path.write_bytes(_glb(*_cube())[:-100])
    with pytest.raises(AssetError, match="bufferViews/3 ends at byte 912, and buffer 0 has 812"):
        _read(path)
