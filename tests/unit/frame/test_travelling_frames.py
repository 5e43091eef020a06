"""Frames can be copied, pickled and sent to other processes; read-only arrays stay read-only."""

from __future__ import annotations

import copy
import dataclasses
import multiprocessing
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from sailenv_ros.errors import InvalidState
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.truth.amodal_masks import AmodalMasks
from sailenv_ros.types.lessons import LessonState
from sailenv_ros.types.views import RENDERED_VIEWS
from tests.support.recordings import noise_frame


def by_buffers(frame: Frame) -> Frame:
    """Send a frame as Ray does: its arrays beside the pickle."""
    buffers: list[pickle.PickleBuffer] = []
    data = pickle.dumps(frame, protocol=5, buffer_callback=buffers.append)
    assert len(buffers) >= len(frame)
    assert len(data) < sum(array.nbytes for array in frame.values())
    sent: Frame = pickle.loads(data, buffers=[bytearray(one) for one in buffers])
    return sent


WAYS: dict[str, Callable[[Frame], Frame]] = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "buffers": by_buffers,
    **{
        f"pickle {protocol}": lambda frame, protocol=protocol: pickle.loads(
            pickle.dumps(frame, protocol)
        )
        for protocol in range(2, pickle.HIGHEST_PROTOCOL + 1)
    },
}


@pytest.fixture
def frame() -> Frame:
    """Return a frame with everything that one may have, its tables used already."""
    made = dataclasses.replace(
        noise_frame(2, views=RENDERED_VIEWS),
        randomised={"seed": 3, "drawn": [{"name": "lamp", "value": 0.25}]},
        lesson=LessonState(
            phase="lesson",
            lap=1,
            laps=2,
            number=1,
            count=3,
            name="first",
            objects=("lamp",),
            begins_ns=5,
            ends_ns=0,
        ),
    )
    assert made.objects.ids.tolist() == [1, 2]
    assert made.info is not None
    assert made.info.categories.palette.shape == (65536, 3)
    return made


def require_equal(one: Any, other: Any, what: str = "frame") -> None:
    """Compare everything in two values, the types and flags of arrays too."""
    if isinstance(one, np.ndarray):
        assert one.dtype == other.dtype, what
        assert one.flags.writeable == other.flags.writeable, what
        assert one.tobytes() == other.tobytes(), what
    elif dataclasses.is_dataclass(one):
        assert type(one) is type(other), what
        for field in dataclasses.fields(one):
            require_equal(
                getattr(one, field.name), getattr(other, field.name), f"{what}.{field.name}"
            )
    elif hasattr(one, "keys"):
        assert dict(one).keys() == dict(other).keys(), what
        for name in one:
            require_equal(one[name], other[name], f"{what}[{name!r}]")
    else:
        assert one == other, what


@pytest.mark.parametrize("way", WAYS)
def test_a_frame_travels_as_it_is(frame: Frame, way: str) -> None:
    """Values, types, read-only arrays, mappings, and what is computed of them."""
    sent = WAYS[way](frame)
    assert sent is not frame
    require_equal(frame, sent)
    assert sent.info is not None
    assert frame.info is not None
    for name in ("world_from_camera", "camera_from_world"):
        require_equal(getattr(frame.camera, name), getattr(sent.camera, name), name)
    require_equal(frame.info.categories.palette, sent.info.categories.palette, "palette")
    require_equal(frame.info.instance_columns, sent.info.instance_columns, "instance_columns")
    require_equal(frame.objects, sent.objects, "objects")
    with pytest.raises(ValueError, match="read-only"):
        sent["depth"][0, 0] = 1.0
    with pytest.raises(TypeError):
        sent.views["depth"] = sent["depth"]  # type: ignore[index]


def test_a_deep_copy_has_pixels_of_its_own_and_a_copy_the_same(frame: Frame) -> None:
    assert copy.copy(frame)["rgb"] is frame["rgb"]
    assert not np.shares_memory(copy.deepcopy(frame)["rgb"], frame["rgb"])


def test_what_can_be_computed_again_is_not_sent(frame: Frame) -> None:
    """A palette is as large as a picture, and every frame has one."""
    pixels = sum(array.nbytes for array in frame.values())
    assert len(pickle.dumps(frame)) < pixels + 10_000


def masks_of(frame: Frame) -> AmodalMasks:
    """Return masks of no object."""
    height, width = frame["depth"].shape
    none = np.zeros(0, np.int64)
    return AmodalMasks(
        height=height,
        width=width,
        ids=np.zeros(0, np.uint16),
        pixels=none,
        whole_pixels=none,
        boxes=np.zeros((0, 4), np.int32),
        whole_boxes=np.zeros((0, 4), np.int32),
        crops=(),
    )


def test_amodal_masks_travel_once_they_are_drawn(frame: Frame) -> None:
    """What draws them is the simulator's, so only copies in this process can ask for it."""
    drawn: list[int] = []

    def draw(only: int = 0) -> AmodalMasks:
        drawn.append(only)
        return masks_of(frame)

    frame = dataclasses.replace(frame, draw_amodal=draw)
    with pytest.raises(InvalidState, match="before it is sent to another process"):
        _ = pickle.loads(pickle.dumps(frame)).amodal
    assert copy.copy(frame).amodal_of(2).height == 24
    assert copy.deepcopy(frame).amodal_of(1).height == 24
    assert drawn == [2, 1]
    require_equal(frame.amodal, pickle.loads(pickle.dumps(frame)).amodal)
    require_equal(frame.amodal, copy.deepcopy(frame).amodal)
    assert copy.copy(frame).amodal is frame.amodal
    assert drawn == [2, 1, 0]


def sent_back(frame: Frame) -> tuple[Frame, bool]:
    """Return a frame from a worker process, and whether it could be written to there."""
    return frame, any(array.flags.writeable for array in frame.values())


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_a_frame_goes_to_a_worker_process_and_back(frame: Frame, method: str) -> None:
    """By a fork and by a new process."""
    with multiprocessing.get_context(method).Pool(1) as pool:
        back, writable = pool.apply_async(sent_back, (frame,)).get(60)
    assert not writable
    require_equal(frame, back)


def test_a_frame_shows_itself_in_two_lines(frame: Frame) -> None:
    """Not with all of its pixels, nor with all that is known of the scene."""
    assert repr(frame) == (
        "<Frame eye in noise: frame 2, t = 0.033 s, Δt = 0.033 s, 32 × 24 px\n"
        " views: rgb, depth, category, instance, flow, flow_valid, occlusion, range, lens_valid, "
        "normals, albedo, uv, metallic_roughness, measured_depth, raw, object_coords>"
    )
    assert repr(dataclasses.replace(frame, views={})).endswith("\n views: none>")
