"""Readers of untrusted input, and inputs for them: samples that are cut, mixed and flipped.

Each target has samples that are right, and a function that must end without an error or with one of
the package's own. Everything is drawn from one seed, so that a failure comes again.
"""

from __future__ import annotations

import base64
import itertools
import json
import random
import struct
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from sailenv_ros.assets.glb import glb_bytes
from sailenv_ros.assets.importing import import_asset
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.errors import AssetError, SailenvError
from sailenv_ros.gateway.codec import MessageReader
from sailenv_ros.gateway.scenario_json import entries_of_scenario, mapping_of_json
from sailenv_ros.light.bake import light_files
from sailenv_ros.light.bake.array_coding import LEVEL
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic, RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.simulation.models.asset_file import read_asset, write_asset
from sailenv_ros.simulation.models.uploads import asset_from_upload
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.script.scenario import scenario_entries
from sailenv_ros.types.baked_light import BakedLight, LightLayer, ProbeGrid
from sailenv_ros.types.lights import Light
from sailenv_ros.types.validation import vector
from sailenv_ros.viewer.request_arguments import arguments_of_text
from tests.support.upload_files import box_zip

__all__ = ["TARGETS", "Target", "inputs", "keep", "kept", "replay", "run_target"]

CORPUS = Path(__file__).resolve().parents[1] / "data" / "fuzz"
"""Inputs that reached new code in `benchmarks/fuzz_coverage.py`, or were faults once."""

_NUMBERS = ("0", "-1", "1e999", "nan", "-0.0", "4294967296", "99999999999999999999", "1e-320")
_BYTES = (b"\0", b"\xff" * 4, b"\x7f\xff\xff\xff", b"\x80\0\0\0", b"{" * 60, b"[" * 60, b"&a *a")


@dataclass(frozen=True)
class Target:
    """One reader."""

    samples: Callable[[], tuple[bytes, ...]]
    read: Callable[[bytes, Path], object]


def inputs(samples: tuple[bytes, ...], seed: int) -> Iterator[bytes]:
    """Yield changed samples without end; the same ones for the same seed."""
    rng = random.Random(seed)
    yield from samples
    while True:
        data = bytearray(rng.choice(samples))
        for _ in range(rng.choice((1, 1, 2, 3, 8))):
            _change(data, samples, rng)
        yield bytes(data)


def run_target(name: str, *, seed: int, count: int, folder: Path) -> int:
    """Read so many inputs; return how many were accepted. What was wrong goes up with the input."""
    samples = (*TARGETS[name].samples(), *kept(name))
    given = itertools.islice(inputs(samples, seed), count)
    return sum(
        _is_accepted(name, data, folder, f"seed {seed}, input {number}")
        for number, data in enumerate(given)
    )


def replay(name: str, folder: Path) -> int:
    """Read all samples and all kept inputs; return how many were accepted."""
    known = (*TARGETS[name].samples(), *kept(name))
    return sum(
        _is_accepted(name, data, folder, f"kept input {number}")
        for number, data in enumerate(known)
    )


def kept(name: str) -> tuple[bytes, ...]:
    """Return the kept inputs of a target; in the file, 4 bytes of length precede each."""
    path, inputs = CORPUS / f"{name}.bin", []
    data = path.read_bytes() if path.exists() else b""
    while data:
        size = int.from_bytes(data[:4], "little")
        inputs.append(data[4 : 4 + size])
        data = data[4 + size :]
    return tuple(inputs)


def keep(name: str, inputs: Sequence[bytes]) -> None:
    """Keep these inputs of a target, and no others."""
    CORPUS.mkdir(parents=True, exist_ok=True)
    data = b"".join(len(data).to_bytes(4, "little") + data for data in inputs)
    (CORPUS / f"{name}.bin").write_bytes(data)


def _is_accepted(name: str, data: bytes, folder: Path, which: str) -> bool:
    try:
        TARGETS[name].read(data, folder)
    except SailenvError:
        return False
    except BaseException as problem:
        problem.add_note(f"{name}, {which}: {data[:2000]!r}")
        raise
    return True


def _change(data: bytearray, samples: tuple[bytes, ...], rng: random.Random) -> None:
    at = rng.randrange(len(data) + 1)
    kind = rng.randrange(8)
    if kind == 0 and data:
        data[at % len(data)] ^= 1 << rng.randrange(8)
    elif kind == 1 and data:
        data[at % len(data)] = rng.randrange(256)
    elif kind == 2:
        del data[at : at + rng.choice((1, 4, 40, 10**6))]
    elif kind == 3:
        data[at:at] = rng.choice(_BYTES)
    elif kind == 4:
        data[at:at] = rng.choice(_NUMBERS).encode()
    elif kind == 5 and len(data) >= 4:
        at = rng.randrange(len(data) - 3)
        data[at : at + 4] = struct.pack("<I", rng.choice((0, 1, 255, 2**31, 2**32 - 1, at)))
    elif kind == 6:
        other = rng.choice(samples)
        start = rng.randrange(len(other) + 1)
        data[at:at] = other[start : start + rng.choice((1, 8, 64, 512))]
    else:
        _change_number(data, rng)


def _change_number(data: bytearray, rng: random.Random) -> None:
    """Replace a run of digits, which is a number in a text."""
    places = [at for at, byte in enumerate(data[:20_000]) if 48 <= byte <= 57]
    if places:
        start = end = rng.choice(places)
        while end < len(data) and 48 <= data[end] <= 57:
            end += 1
        data[start:end] = rng.choice(_NUMBERS).encode()


# -- samples and readers -------------------------------------------------------------------

_SCENE = b"""version: 1
title: A test
environment: {background: sky, ambient: [0.1, 0.1, 0.1]}
objects:
  - {name: a, asset: Cube, position: [0, 0, 1], mass: 2.0, scale: [1, 1, 1], static: false}
  - {name: b, asset: Sphere, behaviours: [{type: poltergeist, seed: 3}]}
lights:
  - {name: lamp, type: point, position: [0, 0, 2], intensity: 3.0, range: 5.0}
movers:
  - {name: walker, waypoints: [{position: [0, 0, 1]}, {position: [1, 0, 1]}]}
agents:
  - {name: eye, width: 64, height: 48, mover: walker}
"""

_STAGED_SCENE = b"""version: 1
title: Comes and goes
objects:
  - {name: chest, asset: Cube, static: true, position: [2, 0, 0.5]}
  - name: lid
    asset: Cube
    category: door
    position: [0, 0, 0.6]
    joint: {type: hinge, parent: chest, origin: [0, 0.5, 0], axis: [1, 0, 0], limits: [-1.5, 0]}
  - {name: ball, asset: Sphere, appear: 1, leave: 9, behaviours: [{type: poltergeist, seed: 3}]}
lessons: {laps: 3, pause: 1, after: loop, sequence: [{objects: [ball], duration: 10}]}
movers:
  - {name: walker, waypoints: [{position: [0, 0, 1]}, {position: [1, 0, 1]}]}
agents:
  - {name: eye, width: 64, height: 48, keep_looking_at: {object: ball, point: [0, 0, 0.1]}}
randomise:
  - {name: paint, type: material, of: chest, colour: {uniform: ["#202020", "#f0e0d0"]}}
  - {name: place, type: camera, of: eye, rule: room_view, settings: {attempts: 5}, every: frame}
"""

_SCENARIO = {
    "scene_name": "optical/scene",
    "objects": [
        {
            "prefab": "Cube",
            "position": {"x": 1, "y": 2, "z": 3},
            "rotation": {"x": 0, "y": 90, "z": 0},
            "dynamic": {"type": "uniform_movement_random_bounce", "description": {"speed": 1.0}},
        }
    ],
}


@cache
def _library() -> SceneLibrary:
    return SceneLibrary()


def _read_scene(data: bytes, folder: Path) -> object:
    path = folder / "fuzz.yaml"
    path.write_bytes(data)
    return load_scene(path, knowledge=_library().knowledge)


def _read_scenario(data: bytes, folder: Path) -> object:
    given = mapping_of_json("scenario", data.decode("utf-8", "replace"))
    entries = entries_of_scenario(given, "eye")
    return scenario_entries({**given, "objects": entries}, viewer="eye")


def _gateway_samples() -> tuple[bytes, ...]:
    hello = struct.pack("<iiB", 640, 480, False)
    name = b"optical/scene"
    text = struct.pack("<i", len(name)) + name
    return (
        hello + b"\0" + b"\x1f",
        hello + b"\x01" + text,
        b"".join([hello, *(bytes([number]) + text for number in range(24))]),
        hello + b"\x03" + struct.pack("<3f", 1.0, float("nan"), 1e38),
    )


def _read_gateway(data: bytes, folder: Path) -> object:
    messages = []
    for protocol in ("0.5", "0.6"):
        reader = MessageReader(protocol)
        for start in range(0, len(data), 7):
            reader.feed(data[start : start + 7])
            while (message := reader.take()) is not None:
                messages.append(message)
    return messages


def _read_viewer(data: bytes, folder: Path) -> object:
    given = arguments_of_text(data.decode("utf-8", "replace"))
    for read in (given.text, given.integer, given.number, given.flag, given.mapping, given.entries):
        try:
            read("value")
        except SailenvError:
            continue
    return vector("numbers", given.get("numbers"))


@cache
def _model_samples(kind: str) -> tuple[bytes, ...]:
    parts = Primitives().load("cube").model.parts
    if kind == "glb":
        return (glb_bytes(parts, ()),)
    if kind == "gltf":
        # A text: numbers change here without what the binary form says of lengths.
        data = glb_bytes(parts, ())
        (length,) = struct.unpack_from("<I", data, 12)
        tree = json.loads(data[20 : 20 + length])
        buffer = base64.b64encode(data[28 + length :]).decode()
        tree["buffers"][0]["uri"] = f"data:application/octet-stream;base64,{buffer}"
        return (json.dumps(tree).encode(),)
    quads = "\n".join(["v 0 0 0", "v 1 0 0", "v 1 1 0", "v 0 1 1", "vt 0 0", "f 1/1 2/1 3/1 4/1"])
    return box_zip(), box_zip(quads), box_zip(quads + "\nusemtl red\nf -1 -2 -3\n")


def _importer(filename: str) -> Callable[[bytes, Path], object]:
    """Read with one hull: a decomposition is native code that may take forever, in its process."""

    def read(data: bytes, folder: Path) -> object:
        (folder / filename).write_bytes(data)
        return import_asset(folder / filename, name="a", category="box", convex=False)

    return read


@cache
def _bag() -> tuple[bytes, ...]:
    samples = []
    for compression in ("zstd", "lz4", "none"):
        with tempfile.TemporaryDirectory() as folder:
            bag = Path(folder) / "bag"
            with RecordingWriter(bag, RecordingOptions(compression=compression)) as writer:
                for name in ("/a", "/b"):
                    qos = OfferedQos()
                    kind = "std_msgs/msg/String"
                    writer.add_topic(RecordedTopic(name=name, type=kind, schema="x", qos=qos))
                for number in range(6):
                    writer.write("/ab"[:: 2 - number % 2][:2], (b"\0\1\0\0ab",), number)
            samples.append((bag / "bag_0.mcap").read_bytes())
    return tuple(samples)


def _read_bag(data: bytes, folder: Path) -> object:
    path = folder / "fuzz.mcap"
    path.write_bytes(data)
    with RecordingReader(path) as reader:
        return [bytes(raw.data) for _, raw in reader.messages()]


@cache
def _light_samples() -> tuple[bytes, ...]:
    texels = np.ones((2, 2), np.float16)
    probes = np.ones((1, 1, 1, 4, 3), np.float16)
    layer = LightLayer(
        light=Light(name="sun", type="directional"),
        direct=texels,
        bounced=np.ones((2, 2, 3), np.float16),
        probe_direct=probes,
        probe_bounced=probes,
        visibility=None,
        clear=1.0,
    )
    grid = ProbeGrid(origin_m=(0.0, 0.0, 0.0), spacing_m=(1.0, 1.0, 1.0), shape=(1, 1, 1))
    baked = BakedLight(fingerprint="b" * 32, charts={}, layers=(layer,), probes=grid)
    return (bytes(light_files._coded_arrays(baked, LEVEL)),)


def _read_light(data: bytes, folder: Path) -> object:
    """Return the changed bytes a checksum that is right: worse than any accident."""
    path = light_files.baked_file("b" * 32)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(light_files.MAGIC + light_files._digest(memoryview(data)) + data)
    baked = light_files.load_baked("b" * 32)
    if baked is None:
        raise AssetError("light", "it is baked anew")
    return baked


@cache
def _asset_samples() -> tuple[bytes, ...]:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "asset"
        write_asset(path, asset_from_upload(box_zip(), name="a", filename="a.zip"))
        return (path.read_bytes(),)


def _read_asset(data: bytes, folder: Path) -> object:
    path = folder / "fuzz.asset"
    path.write_bytes(data)
    return read_asset(path)


TARGETS = {
    "scene": Target(lambda: (_SCENE, _STAGED_SCENE), _read_scene),
    "scenario": Target(lambda: (json.dumps(_SCENARIO).encode(),), _read_scenario),
    "gateway": Target(_gateway_samples, _read_gateway),
    "viewer": Target(
        lambda: (b'{"id": 1, "value": "a", "numbers": [1, 2.5, -3e2], "more": {"b": [true]}}',),
        _read_viewer,
    ),
    "glb": Target(lambda: _model_samples("glb"), _importer("a.glb")),
    "gltf": Target(lambda: _model_samples("gltf"), _importer("a.gltf")),
    "zip": Target(lambda: _model_samples("zip"), _importer("a.zip")),
    "mcap": Target(_bag, _read_bag),
    "light": Target(_light_samples, _read_light),
    "asset": Target(_asset_samples, _read_asset),
}
