"""The player as a ROS 2 node: `ros2 run sailenv_ros player --ros-args -p input:=BAG`.

An MCAP bag in, its messages on the topics they came from, with their own stamps, and /clock.
Services pause and resume it. Exit status: 0 at the end or when asked to end, 2 where a parameter
is wrong or the recording cannot be read.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterable, Sequence
from typing import Any, cast

from rclpy.duration import Duration
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.publisher import Publisher
from std_srvs.srv import Trigger

from sailenv_ros.errors import InvalidRequest, RecordingError
from sailenv_ros.recording.channels import CLOCK, clock_message, present_form, stamp_of
from sailenv_ros.recording.playback import PlaybackClock, Programme, programme
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.schemas import message_class
from sailenv_ros.recording.topics import RecordedTopic
from sailenv_ros.ros.executor_thread import ExecutorThread
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.parameter_table import Parameter
from sailenv_ros.ros.nodes.parameters import declare_table
from sailenv_ros.ros.nodes.qos import clock_qos, no_events, recorded_qos
from sailenv_ros.ros.nodes.running import run_node
from sailenv_ros.types.validation import Bounds

__all__ = ["PARAMETERS", "Player", "await_acknowledged", "main", "recorded_publisher"]

NODE_NAME = "player"
LOOK_INTERVAL_S = 0.05
"""Interval at which a wait checks for a requested end or pause [s]."""

ACKNOWLEDGE_S = 2.0
"""Time that subscribers may take to acknowledge the last messages [s]."""

_CLOCK_NAME = "/clock"

PARAMETERS = {
    "input": Parameter("", "The bag's folder, or one MCAP file."),
    "topics": Parameter([""], "Names of the topics that are played; empty: all."),
    "rate": Parameter(1.0, "Recorded seconds per second.", Bounds(least=1e-3, most=1000.0)),
    "loop": Parameter(False, "True: begin anew at the end."),
    "start_s": Parameter(
        0.0, "Where to start, from the beginning [s].", Bounds(least=0.0, most=1e9)
    ),
    "paused": Parameter(False, "True: wait for the service resume."),
    "clock": Parameter(True, "True: publish /clock."),
    "delay_s": Parameter(
        0.5, "Time for subscribers to be found before it begins [s].", Bounds(least=0.0, most=60.0)
    ),
}
"""Every parameter of the node by its name."""


class Player:
    """Publishes a recording.

    Parameters
    ----------
    node : Node
    reader : RecordingReader
    clock : PlaybackClock
        Standing.
    chosen : Programme
    publish_clock : bool
        False leaves /clock to somebody else.
    """

    def __init__(
        self,
        node: Node,
        reader: RecordingReader,
        clock: PlaybackClock,
        chosen: Programme,
        topics: Sequence[RecordedTopic],
        *,
        publish_clock: bool,
    ) -> None:
        self._reader = reader
        self._clock = clock
        self._programme = chosen
        self._changed = threading.Condition()
        self._publishers = {
            t.name: recorded_publisher(node, t)
            for t in topics
            if t.name != _CLOCK_NAME or publish_clock
        }
        # Where no clock was recorded, the stamps of what is played tell the time.
        self._own_clock: Publisher | None = None
        if publish_clock and _CLOCK_NAME not in self._publishers:
            self._own_clock = node.create_publisher(
                message_class(CLOCK), _CLOCK_NAME, clock_qos(), event_callbacks=no_events()
            )
        self._stamped = any(
            stamp_of(t.type, b"\0\1" + bytes(10)) is not None for t in reader.topics
        )
        self._published_ns: int | None = None
        self.played = 0
        node.create_service(Trigger, "~/pause", self._pause)
        node.create_service(Trigger, "~/resume", self._resume)

    def resume(self) -> None:
        """Run, or run on."""
        with self._changed:
            self._clock.resume(time.monotonic())
            self._changed.notify_all()

    def pause(self) -> None:
        """Hold everything, /clock too."""
        with self._changed:
            self._clock.pause(time.monotonic())
            self._changed.notify_all()

    def play(self, stop: StopRequest) -> bool:
        """Play once, from the start; False if the end was asked for before."""
        with self._changed:
            self._clock.rewind(time.monotonic())
        for row in self._programme.before:
            self._publish(row)
        for row in self._programme.rows:
            if not self._await(int(self._reader.log_ns(row)), stop):
                return False
            self._publish(row)
        return True

    def await_acknowledged(self) -> None:
        """Wait a little until reliable subscribers have the last messages."""
        await_acknowledged(self._publishers.values())

    # -- inside ----------------------------------------------------------------------------

    def _await(self, log_ns: int, stop: StopRequest) -> bool:
        while not stop.is_set:
            with self._changed:
                left_s = self._clock.wait_s(log_ns, time.monotonic())
                if left_s <= 0.0:
                    return True
                self._changed.wait(min(left_s, LOOK_INTERVAL_S))
        return False

    def _publish(self, row: int) -> None:
        topic, raw = self._reader.message(row)
        publisher = self._publishers.get(topic.name)
        if publisher is None:
            return
        data = bytes(present_form(topic, raw.data))
        if self._own_clock is not None:
            self._publish_time(topic, data, raw.log_ns)
        publisher.publish(data)
        self.played += 1

    def _publish_time(self, topic: RecordedTopic, data: bytes, log_ns: int) -> None:
        time_ns = stamp_of(topic.type, data) if self._stamped else log_ns
        if time_ns is not None and time_ns != self._published_ns and self._own_clock is not None:
            self._published_ns = time_ns
            self._own_clock.publish(cast(Any, clock_message(time_ns)))

    def _pause(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.pause()
        response.success, response.message = True, "paused"
        return response

    def _resume(self, request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        self.resume()
        response.success, response.message = True, "playing"
        return response


def main(argv: Sequence[str] | None = None) -> int:
    """Play until the end or until asked to end; return the exit status."""
    return run_node(NODE_NAME, _play, argv)


def _play(node: Node, stop: StopRequest) -> int:
    values = declare_table(node, PARAMETERS)
    if not values["input"]:
        raise InvalidRequest("parameter input", "", "a bag's folder or an MCAP file")
    with RecordingReader(values["input"]) as reader:
        topics = _playable(node, reader, [name for name in values["topics"] if name])
        chosen = programme(reader, [t.name for t in topics], values["start_s"])
        clock = PlaybackClock(rate=values["rate"], start_ns=chosen.start_ns)
        player = Player(node, reader, clock, chosen, topics, publish_clock=values["clock"])
        executor = SingleThreadedExecutor(context=node.context)
        executor.add_node(node)
        spinning = ExecutorThread(executor)
        spinning.start()
        try:
            stop.wait(values["delay_s"])
            seconds = (chosen.end_ns - chosen.start_ns) * 1e-9
            state = "paused" if values["paused"] else "playing"
            node.get_logger().info(
                f"{state} {values['input']}: {len(topics)} topics, {seconds:.3f} s; Ctrl-C ends it,"
                f" services {node.get_fully_qualified_name()}/pause and /resume hold it"
            )
            if not values["paused"]:
                player.resume()
            while player.play(stop) and values["loop"]:
                node.get_logger().info(f"played {player.played} messages; once more")
            player.await_acknowledged()
        finally:
            spinning.stop(1.0)
            executor.shutdown(0.0)
    node.get_logger().info(f"played {player.played} messages")
    return 0


def _playable(node: Node, reader: RecordingReader, names: Sequence[str]) -> list[RecordedTopic]:
    """Choose topics; those whose type is not installed are named and left out."""
    wanted = [reader.topic(name) for name in names] if names else list(reader.topics)
    playable = []
    for topic in wanted:
        try:
            message_class(topic.type)
        except RecordingError as problem:
            node.get_logger().warning(f"{topic.name} is not played: {problem}")
        else:
            playable.append(topic)
    if not playable:
        raise RecordingError(f"{reader.path} has no topic that can be played")
    return playable


def await_acknowledged(publishers: Iterable[Publisher]) -> None:
    """Wait a little until reliable subscribers have the last messages."""
    deadline = time.monotonic() + ACKNOWLEDGE_S
    for publisher in publishers:
        left_s = max(0.0, deadline - time.monotonic())
        publisher.wait_for_all_acked(Duration(nanoseconds=round(left_s * 1e9)))


def recorded_publisher(node: Node, topic: RecordedTopic) -> Publisher:
    """Make the publisher of a recorded topic, with the quality that it was offered with."""
    latched = topic.qos.durability == "transient_local"
    # A little more than was offered: what was recorded late may follow closely.
    depth = topic.qos.depth if latched else max(topic.qos.depth, 10)
    return node.create_publisher(
        message_class(topic.type),
        topic.name,
        recorded_qos(topic.qos, depth),
        event_callbacks=no_events(),
    )


if __name__ == "__main__":
    sys.exit(main())
