"""The table of channels: which topics there are, of which types, and their messages in CDR.

`Frame` and `SceneInfo` → serialized messages, and serialized messages → ROS messages. The one
module of recording that knows ROS; images pass through it without being looked at byte by byte.
"""

from __future__ import annotations

import struct
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Any

from builtin_interfaces.msg import Time
from rclpy.serialization import deserialize_message, serialize_message
from sensor_msgs.msg import Image
from std_msgs.msg import Header, String

from sailenv_msgs_py.camera_info import camera_info_of_frame
from sailenv_msgs_py.frame_info import WORLD_FRAME_ID, frame_info_to_msg, header_of_frame
from sailenv_msgs_py.images import image_from_view
from sailenv_msgs_py.object_truth_msgs import objects_to_msg
from sailenv_msgs_py.scene_msgs import scene_info_to_msg
from sailenv_msgs_py.transforms import pose_stamped_to_msg
from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.frame import Frame
from sailenv_ros.frame.language.facts_text import facts_of_text, text_of_facts
from sailenv_ros.frame.language.scene_facts import SceneFacts
from sailenv_ros.recording.cdr_padding import without_padding_garbage
from sailenv_ros.recording.mcap.chunks import Buffer
from sailenv_ros.recording.schemas import message_class, schema_text, type_hash
from sailenv_ros.recording.topics import OfferedQos, RecordedTopic
from sailenv_ros.types.scene_info import SceneInfo
from sailenv_ros.types.views import VIEWS

__all__ = [
    "AGENT_TOPICS",
    "CLOCK",
    "FACTS",
    "FACTS_NAME",
    "FRAME_INFO",
    "IMAGE",
    "OBJECTS",
    "ON_REQUEST",
    "SCENE_INFO",
    "agent_topics",
    "clock_message",
    "facts_message",
    "facts_of_message",
    "frame_messages",
    "is_present_form",
    "message_of",
    "present_form",
    "scene_info_message",
    "stamp_of",
    "topic",
]

IMAGE = "sensor_msgs/msg/Image"
FRAME_INFO = "sailenv_msgs/msg/FrameInfo"
SCENE_INFO = "sailenv_msgs/msg/SceneInfo"
OBJECTS = "sailenv_msgs/msg/Objects"
CLOCK = "rosgraph_msgs/msg/Clock"
FACTS = "std_msgs/msg/String"

FACTS_NAME = "facts"
"""Topic, below an agent's, of what is known of the scene at the instant of its next frame."""

AGENT_TOPICS = {
    **dict.fromkeys(VIEWS, IMAGE),
    "camera_info": "sensor_msgs/msg/CameraInfo",
    "frame_info": FRAME_INFO,
    "pose": "geometry_msgs/msg/PoseStamped",
    "objects/amodal": OBJECTS,
}
"""Type of each topic of an agent, by its name below the agent's."""

ON_REQUEST = ("objects/amodal",)
"""Topics that are recorded only if it is asked for."""

_QOS = {
    SCENE_INFO: OfferedQos(depth=1, durability="transient_local"),
    CLOCK: OfferedQos(depth=1, reliability="best_effort"),
}
_BULKY = (IMAGE, "sensor_msgs/msg/CompressedImage", "sensor_msgs/msg/PointCloud2")

_STAMPED = frozenset(AGENT_TOPICS.values())
"""Types that begin with a header, and so with their stamp."""

_LITTLE_ENDIAN_CDR = b"\x00\x01"

_NEWER_FIELD = "Skeleton[] skeletons"
"""The newest field of `FrameInfo`; version 0.2.0 lacked it and the four fields before it."""

_NEWER_PART_OF_SCENES = "float64 auto_exposure_s"
"""The newest field within the parts of `SceneInfo`; version 0.2.0 lacked it."""

_LONGEST_APPENDIX = 64
"""Bytes that all newer fields take where they are empty, and more [B]."""

Parts = tuple[Buffer, ...]


def topic(name: str, type_name: str, qos: OfferedQos | None = None) -> RecordedTopic:
    """Return the topic of that name with everything a recording says of it."""
    return RecordedTopic(
        name=name,
        type=type_name,
        schema=schema_text(type_name),
        qos=qos or _QOS.get(type_name, OfferedQos()),
        type_hash=type_hash(type_name),
        bulky=type_name in _BULKY,
    )


def agent_topics(namespace: str, agent: str, views: Iterable[str]) -> list[RecordedTopic]:
    """Return the topics that an agent's frames are recorded on.

    Parameters
    ----------
    namespace, agent : str
    views : iterable of str
        Views, and what else is recorded of `ON_REQUEST`.
    """
    wanted = set(views)
    return [
        topic(f"{namespace}/{agent}/{name}", type_name)
        for name, type_name in AGENT_TOPICS.items()
        if name in wanted or name not in (*VIEWS, *ON_REQUEST)
    ]


def frame_messages(
    frame: Frame, depth_range_m: float, *, amodal: bool = False
) -> Iterator[tuple[str, Parts]]:
    """Return everything that is recorded of a frame, by topics' names below the agent's.

    With `amodal` its objects are drawn alone.

    The images' bytes are the frame's own; the info closes the frame, as it does on DDS.
    """
    header = header_of_frame(frame)
    views = [view for view in VIEWS if view in frame.views]
    for view in views:
        yield view, _image_parts(image_from_view(view, frame[view], header, copy=False))
    yield "camera_info", (_serialized(camera_info_of_frame(frame, header)),)
    pose = pose_stamped_to_msg(frame.camera.pose, header.stamp, WORLD_FRAME_ID)
    yield "pose", (_serialized(pose),)
    if amodal:
        objects = objects_to_msg(frame, header, frame.amodal)
        yield "objects/amodal", (_serialized(objects),)
    info = frame_info_to_msg(frame, header, views=views, depth_range_m=depth_range_m)
    yield "frame_info", (_serialized(info),)


def scene_info_message(info: SceneInfo) -> Parts:
    """Return the message that tells of the scene."""
    return (_serialized(scene_info_to_msg(info)),)


def facts_message(facts: SceneFacts) -> Parts:
    """Return the message that tells of facts: a line of JSON."""
    return (_serialized(String(data=text_of_facts(facts))),)


def facts_of_message(message: Any) -> SceneFacts:
    """Read the facts that a message tells of."""
    return facts_of_text(message.data)


def _serialized(message: Any) -> bytes:
    """Serialize a message to bytes that depend on nothing but the message."""
    return without_padding_garbage(serialize_message(message), type(message))


def message_of(type_name: str, data: Buffer) -> Any:
    """Read a serialized message.

    Raises
    ------
    RecordingError
        If the type is not installed or the bytes are not such a message.
    """
    try:
        if type_name == IMAGE and bytes(data[:2]) == _LITTLE_ENDIAN_CDR:
            return _image(memoryview(data))
        return _deserialize(type_name, data)
    except (struct.error, ValueError, UnicodeDecodeError) as problem:
        raise RecordingError(f"a message of {type_name} cannot be read: {problem}") from None


def present_form(topic: RecordedTopic, data: Buffer) -> Buffer:
    """Return a recorded message as its type is now.

    Fields are only ever appended to `FrameInfo`; in the recordings of a version that did not know
    them they are 0 and empty, which is zeros in CDR.
    """
    if topic.type == FRAME_INFO and _NEWER_FIELD not in topic.schema:
        return bytes(data) + bytes(_LONGEST_APPENDIX)
    return data


def is_present_form(topic: RecordedTopic) -> bool:
    """Return whether a topic's messages can be read: `SceneInfo` has changed since 0.2.0."""
    return topic.type != SCENE_INFO or _NEWER_PART_OF_SCENES in topic.schema


def _deserialize(type_name: str, data: Buffer) -> Any:
    kind = message_class(type_name)
    try:
        return deserialize_message(bytes(data), kind)
    except Exception as problem:  # rclpy raises its own, by the middleware
        raise RecordingError(f"a message of {type_name} cannot be read: {problem}") from None


def _image_parts(image: Image) -> Parts:
    """Serialize an image around its bytes: all fields before them, then the bytes themselves."""
    pixels = memoryview(image.data)
    stamp = image.header.stamp
    head = bytearray(_LITTLE_ENDIAN_CDR + b"\0\0")
    _put(head, "<i", stamp.sec)
    _put(head, "<I", stamp.nanosec)
    _put_text(head, image.header.frame_id)
    _put(head, "<I", image.height)
    _put(head, "<I", image.width)
    _put_text(head, image.encoding)
    _put(head, "<B", image.is_bigendian)
    _put(head, "<I", image.step)
    _put(head, "<I", len(pixels))
    return bytes(head), pixels


def _put(head: bytearray, code: str, value: int) -> None:
    """Append a number at a multiple of its size, counted from behind the four bytes of CDR."""
    head += bytes(-(len(head) - 4) % struct.calcsize(code))
    head += struct.pack(code, value)


def _put_text(head: bytearray, text: str) -> None:
    raw = text.encode() + b"\0"
    _put(head, "<I", len(raw))
    head += raw


def _image(data: memoryview) -> Image:
    """Read an image; its bytes are copied once and nobody else has them."""
    reader = _CdrReader(data)
    fields = _image_fields(reader)
    size = reader.number("<I")
    if reader.at + size > len(data):
        raise ValueError(f"{size} bytes of pixels are said, {len(data) - reader.at} are there")
    image = Image(**fields)
    # The attribute's setter would look at every byte.
    image._data = bytearray(data[reader.at : reader.at + size])
    return image


def _image_fields(reader: _CdrReader) -> dict[str, Any]:
    stamp = Time(sec=reader.number("<i"), nanosec=reader.number("<I"))
    return {
        "header": Header(stamp=stamp, frame_id=reader.text()),
        "height": reader.number("<I"),
        "width": reader.number("<I"),
        "encoding": reader.text(),
        "is_bigendian": reader.number("<B"),
        "step": reader.number("<I"),
    }


@dataclass(slots=True)
class _CdrReader:
    """Reads plain CDR of little-endian byte order, where numbers lie at multiples of their size."""

    data: memoryview
    at: int = 4

    def number(self, code: str) -> int:
        size = struct.calcsize(code)
        self.at += -(self.at - 4) % size
        (value,) = struct.unpack_from(code, self.data, self.at)
        self.at += size
        return int(value)

    def text(self) -> str:
        length = self.number("<I")
        raw = bytes(self.data[self.at : self.at + length])
        if len(raw) != length or not raw.endswith(b"\0"):
            raise ValueError("a text does not end where it says")
        self.at += length
        return raw[:-1].decode()


def stamp_of(type_name: str, data: Buffer) -> int | None:
    """Return the simulated time of a serialized message of an agent [ns]; None of other types."""
    if type_name not in _STAMPED or bytes(data[:2]) != _LITTLE_ENDIAN_CDR or len(data) < 12:
        return None
    seconds, rest = struct.unpack_from("<iI", data, 4)
    return int(seconds) * 1_000_000_000 + int(rest)


def clock_message(time_ns: int) -> bytes:
    """Return a serialized message that says what time it is [ns]."""
    seconds, rest = divmod(time_ns, 1_000_000_000)
    return _LITTLE_ENDIAN_CDR + b"\0\0" + struct.pack("<iI", seconds, rest)
