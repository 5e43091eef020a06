"""An endless stream as a ROS 2 node: `ros2 run sailenv_ros streamer --ros-args -p course:=home`.

Frames by their numbers, drawn as they are due, on the topics of an agent called ``eye``, with their
own stamps, and /clock. None is left out: one that takes too long to draw is late. Exit status: 0 at
the end or when asked to end, 2 where a parameter is wrong.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Sequence
from typing import Any, cast

from rclpy.node import Node
from rclpy.publisher import Publisher

import sailenv_ros.streams as streams
from sailenv_ros.recording.channels import CLOCK, clock_message
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.schemas import message_class
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.parameter_table import Parameter
from sailenv_ros.ros.nodes.parameters import declare_table
from sailenv_ros.ros.nodes.player import await_acknowledged, recorded_publisher
from sailenv_ros.ros.nodes.qos import clock_qos, no_events
from sailenv_ros.ros.nodes.running import run_node
from sailenv_ros.streams.course import MOST_FRAMES
from sailenv_ros.types.validation import Bounds

__all__ = ["PARAMETERS", "main"]

NODE_NAME = "streamer"

LATE_S = 1.0
"""A stream that is later than before by so much says so [s]."""

PARAMETERS = {
    "course": Parameter("home", "One of the package's courses, or a file."),
    "seed": Parameter(0, "Of the stream.", Bounds(least=0, most=2**63 - 1, whole=True)),
    "begin": Parameter(
        0, "Number of the first frame.", Bounds(least=0, most=MOST_FRAMES - 1, whole=True)
    ),
    "frames": Parameter(
        0, "How many; 0: to the stream's end.", Bounds(least=0, most=MOST_FRAMES, whole=True)
    ),
    "views": Parameter([""], "Names of views; empty: picture, category, instance, flow."),
    "rate": Parameter(
        1.0, "Stream seconds per second; 0: as fast as it goes.", Bounds(least=0.0, most=1000.0)
    ),
    "clock": Parameter(True, "True: publish /clock."),
    "delay_s": Parameter(
        0.5, "Time for subscribers to be found before it begins [s].", Bounds(least=0.0, most=60.0)
    ),
}
"""Every parameter of the node by its name."""


class TopicSink:
    """Takes messages as a `RecordingWriter` does, and publishes them.

    Parameters
    ----------
    node : Node
    publish_clock : bool
        True publishes the time of each message on /clock, where it is another than before.
    """

    def __init__(self, node: Node, *, publish_clock: bool) -> None:
        self._node = node
        self._publishers: dict[str, Publisher] = {}
        self._now_ns = -1
        self._clock: Publisher | None = None
        if publish_clock:
            self._clock = node.create_publisher(
                message_class(CLOCK), "/clock", clock_qos(), event_callbacks=no_events()
            )

    def add_topic(self, topic: RecordedTopic) -> None:
        """Make a topic known."""
        if topic.name not in self._publishers:
            self._publishers[topic.name] = recorded_publisher(self._node, topic)

    def write(self, topic: str, parts: Sequence[Any], log_ns: int) -> None:
        """Publish one message."""
        if self._clock is not None and log_ns > self._now_ns:
            self._now_ns = log_ns
            self._clock.publish(cast(Any, clock_message(log_ns)))
        self._publishers[topic].publish(b"".join(parts))

    def await_acknowledged(self) -> None:
        """Wait a little until reliable subscribers have the last messages."""
        await_acknowledged(self._publishers.values())


def main(argv: Sequence[str] | None = None) -> int:
    """Publish until the end or until asked to end; return the exit status."""
    return run_node(NODE_NAME, _publish, argv)


def _publish(node: Node, stop: StopRequest) -> int:
    values = declare_table(node, PARAMETERS)
    views = tuple(name for name in values["views"] if name) or streams.VIEWS
    begin = values["begin"]
    end = min(MOST_FRAMES, begin + values["frames"]) if values["frames"] else MOST_FRAMES
    course = streams.load_course(values["course"])
    with streams.open(course, seed=values["seed"], views=views)[begin:end] as stream:
        sink = TopicSink(node, publish_clock=values["clock"])
        recorder = FrameRecorder(sink, node.get_namespace())
        recorder.announce(stream[0].frame)
        stop.wait(values["delay_s"])
        node.get_logger().info(f"frames {begin} to {end - 1} of {course.name}; Ctrl-C ends it")
        begun_s, told_s, count = time.monotonic(), LATE_S, 0
        for count, frame in enumerate(stream.as_frames(), start=1):
            if values["rate"]:
                due_s = begun_s + (count - 1) / (course.rate * values["rate"])
                late_s = time.monotonic() - due_s
                if late_s > told_s:
                    node.get_logger().warning(f"frame {frame.number} is {late_s:.1f} s late")
                    told_s = 2.0 * late_s
                stop.wait(max(0.0, -late_s))
            if stop.is_set:
                count -= 1
                break
            recorder.write_told(frame.frame)
        sink.await_acknowledged()
    node.get_logger().info(f"published {count} frames")
    return 0


if __name__ == "__main__":
    sys.exit(main())
