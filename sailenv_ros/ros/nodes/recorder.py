"""The recorder as a ROS 2 node: `ros2 run sailenv_ros recorder`.

Topics of a simulator in, an MCAP bag out. Finds agents as they come, takes messages as bytes, and
counts what it loses. In snapshot mode it keeps the last seconds in memory and writes them when the
service `~/snapshot` is called or the process gets SIGUSR1.

Exit status: 0 if everything was kept; 1 if something was lost, if no simulator was heard, or if the
simulator was killed; 2 where a parameter is wrong or nothing can be written.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import Any

from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_srvs.srv import Trigger

from sailenv_ros.errors import RecordingError
from sailenv_ros.recording.progress import progress_line
from sailenv_ros.recording.queue_writer import QueueWriter
from sailenv_ros.recording.snapshot_buffer import SnapshotBuffer
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.ros.executor_thread import ExecutorThread
from sailenv_ros.ros.nodes.bag_recorder import Recorder
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.parameter_table import Parameter
from sailenv_ros.ros.nodes.parameters import declare_table
from sailenv_ros.ros.nodes.running import run_node
from sailenv_ros.types.validation import Bounds
from sailenv_ros.types.views import FIVE_VIEWS, checked_views

__all__ = ["PARAMETERS", "main"]

NODE_NAME = "recorder"

LOOK_INTERVAL_S = 0.1
"""Interval at which new agents and topics are looked for [s]."""


PARAMETERS = {
    "output": Parameter("", "Folder of the bag, which must not exist; empty: by the time."),
    "agents": Parameter([""], "Names of the agents; empty: all, also those that come later."),
    "views": Parameter([""], "Views that are recorded, and so rendered; empty: the five."),
    "amodal": Parameter(False, "True: draw each object alone and record amodal masks too."),
    "clock": Parameter(True, "True: record /clock."),
    "compression": Parameter(
        "zstd", "Of the file's chunks.", choices=("zstd", "lz4", "none")
    ),
    "split_bytes": Parameter(
        0,
        "A new file begins at this size; 0: one file [B].",
        Bounds(least=0, most=2**62, whole=True),
    ),
    "split_s": Parameter(
        0.0, "A new file begins after this time; 0: one file [s].", Bounds(least=0.0, most=1e9)
    ),
    "queue_bytes": Parameter(
        512 * 2**20,
        "How much may wait for the disk before it is dropped, or is kept for a snapshot [B].",
        Bounds(least=2**20, most=2**40, whole=True),
    ),
    "snapshot_s": Parameter(
        0.0,
        "Keep the last so many seconds in memory and write them when ~/snapshot is called; 0: "
        "write everything at once [s].",
        Bounds(least=0.0, most=1e6),
    ),
    "progress": Parameter(True, "True: log a line of progress every few seconds."),
    "progress_interval_s": Parameter(
        2.0, "Time between two such lines [s].", Bounds(least=0.1, most=3600.0)
    ),
}  # fmt: skip
"""Every parameter of the node by its name."""


def main(argv: Sequence[str] | None = None) -> int:
    """Record until asked to end; return the exit status."""
    return run_node(NODE_NAME, _record, argv)


def _record(node: Node, stop: StopRequest) -> int:
    values = declare_table(node, PARAMETERS)
    options = RecordingOptions(
        compression=values["compression"],
        split_bytes=values["split_bytes"],
        split_s=values["split_s"],
    )
    views = checked_views([view for view in values["views"] if view] or FIVE_VIEWS)
    output = values["output"] or datetime.now().strftime("recording_%Y_%m_%d-%H_%M_%S")
    writer: QueueWriter | SnapshotBuffer
    if values["snapshot_s"]:
        writer = SnapshotBuffer(
            Path(output),
            options,
            keep_s=values["snapshot_s"],
            limit_bytes=values["queue_bytes"],
        )
        how = _offer_snapshots(node, writer, values["snapshot_s"])
    else:
        writer = QueueWriter(RecordingWriter(output, options), values["queue_bytes"])
        how = f"recording {node.get_namespace()} to {output}"
    executor = SingleThreadedExecutor(context=node.context)
    try:
        recorder = Recorder(
            node,
            writer,
            agents=[agent for agent in values["agents"] if agent],
            views=views,
            amodal=values["amodal"],
            clock=values["clock"],
        )
        executor.add_node(node)
        spinning = ExecutorThread(executor)
        spinning.start()
        node.get_logger().info(f"{how}; Ctrl-C ends it")
        reported_s = began_s = time.monotonic()
        while not stop.wait(LOOK_INTERVAL_S) and writer.failure is None:
            recorder.look()
            if (
                values["progress"]
                and time.monotonic() - reported_s >= values["progress_interval_s"]
            ):
                reported_s = time.monotonic()
                node.get_logger().info(_progress(recorder, writer, reported_s - began_s))
        ended_s = time.monotonic()
        spinning.stop(2.0)
        recorder.finish()
    finally:
        executor.shutdown(0.0)
        problem = _closed(writer)
    line = _progress(recorder, writer, ended_s - began_s)
    done = f"recorded {output}"
    if isinstance(writer, SnapshotBuffer):
        done = f"wrote {len(writer.written)} bags"
    node.get_logger().info(f"{done}: {line}")
    if problem is not None:
        raise problem
    if not recorder.heard:
        node.get_logger().error(
            f"no simulator was heard in {node.get_namespace()} of ROS domain "
            f"{node.context.get_domain_id()}; nothing is recorded"
        )
    return int(bool(recorder.lost) or not recorder.heard or recorder.simulator_was_killed)


def _offer_snapshots(node: Node, writer: SnapshotBuffer, keep_s: float) -> str:
    """Have the service and SIGUSR1 write what is kept; return a sentence on how to ask."""
    asked = threading.Lock()  # one bag at a time

    def write() -> tuple[bool, str]:
        with asked:
            try:
                folder = writer.write()
            except RecordingError as problem:
                node.get_logger().error(str(problem))
                return False, str(problem)
        node.get_logger().info(f"wrote {folder}")
        return True, str(folder)

    def answer(_: Any, response: Any) -> Any:
        response.success, response.message = write()
        return response

    def on_signal(*_: object) -> None:
        threading.Thread(target=write, name="snapshot", daemon=True).start()

    service = f"{node.get_fully_qualified_name()}/snapshot"
    node.create_service(Trigger, service, answer)
    signal.signal(signal.SIGUSR1, on_signal)
    return (
        f"keeping the last {keep_s:g} s of {node.get_namespace()}; to write them: the service "
        f"{service} (std_srvs/Trigger), or kill -USR1 {os.getpid()}"
    )


def _closed(writer: QueueWriter | SnapshotBuffer) -> RecordingError | None:
    try:
        writer.close()
    except RecordingError as problem:
        return problem
    return None


def _progress(recorder: Recorder, writer: QueueWriter | SnapshotBuffer, elapsed_s: float) -> str:
    statistics = writer.statistics
    return progress_line(
        frames=recorder.frames,
        message_bytes=statistics.message_bytes,
        file_bytes=statistics.file_bytes,
        elapsed_s=elapsed_s,
        dropped=recorder.lost,
    )


if __name__ == "__main__":
    sys.exit(main())
