"""Speed of writing and reading recordings: five views at 640 x 480, frames of a real scene.

Run `python benchmarks/recording.py [--frames N] [--folder DIR]`. Measures, for each compression,
the writer in process; the recorder node behind DDS at 30 frames a second with a publisher that
renders nothing, so that the recorder is what is measured; and reading back.
"""

from __future__ import annotations

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from sailenv_bench.experiments.worker import cpu_s
from sailenv_bench.suite.measurement import Measurement
from sailenv_ros.frame.frame import Frame
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.topics import RecordingOptions
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec

COMPRESSIONS = ("zstd", "lz4", "none")
RATE_HZ = 30.0
SOURCE_FRAMES = 30


def main() -> None:
    """Print a table of each measurement."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--frames", type=int, default=150)
    parser.add_argument("--folder", type=Path, default=None, help="where to write (default: tmp)")
    parser.add_argument("--scene", default="optical")
    parser.add_argument("--publish", type=int, default=0, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.publish:
        _publish(args.scene, args.publish)
        return
    folder = Path(tempfile.mkdtemp(prefix="recording_", dir=args.folder))
    try:
        print(f"disk: {_disk_speed(folder):.0f} MB/s written and synced, one stream")
        frames = _frames(args.scene)
        for compression in COMPRESSIONS:
            made = _in_process(folder / compression, frames, args.frames, compression)
            print(
                f"in process  {compression:5} {made.speed:6.0f} MB/s {made.rate:6.1f} fps "
                f"{100 * made.busy:4.0f} % CPU  size {made.size:.2f}  read {made.read:6.1f} fps"
            )
        for compression in COMPRESSIONS:
            _node(folder / f"node_{compression}", args, compression)
    finally:
        shutil.rmtree(folder, ignore_errors=True)


def _frames(scene: str) -> list[Frame]:
    """Render a second of the scene, in which things move."""
    with Simulation(scene, mode="lockstep") as simulation:
        if not simulation.info.agents:
            simulation.register_agent(AgentSpec(name="agent"))
        name = simulation.info.agents[0].name
        frames = []
        for _ in range(SOURCE_FRAMES):
            simulation.step(8)
            frames.append(simulation.capture(agent=name))
        return frames


def _renumbered(frame: Frame, number: int) -> Frame:
    stamp_ns = round(number * 1e9 / RATE_HZ)
    return Frame(
        agent=frame.agent,
        scene=frame.scene,
        epoch=frame.epoch,
        revision=frame.revision,
        sequence=number + 1,
        stamp_ns=stamp_ns,
        dt_ns=frame.dt_ns,
        camera=frame.camera,
        views=frame.views,
    )


class Written(NamedTuple):
    """MB/s, frames/s, share of a processor, file's share of the bytes, and frames/s of reading."""

    speed: float
    rate: float
    busy: float
    size: float
    read: float


def measurements(quick: bool) -> Iterator[Measurement]:
    """Measure for `sailenv bench all`."""
    frames = _frames("optical")
    with tempfile.TemporaryDirectory(prefix="recording_") as name:
        made = {
            compression: _in_process(
                Path(name) / compression, frames, 20 if quick else 150, compression
            )
            for compression in COMPRESSIONS
        }
    for compression, one in made.items():
        none = compression == "none"
        yield Measurement(
            name=f"optical, five views 640×480, {'no compression' if none else compression}",
            value=one.rate,
            unit="frames/s",
            other="" if none else "no compression",
            other_value=None if none else made["none"].rate,
        )


def _in_process(folder: Path, frames: list[Frame], count: int, compression: str) -> Written:
    began, used = time.perf_counter(), time.process_time()
    with RecordingWriter(folder, RecordingOptions(compression=compression)) as writer:  # type: ignore[arg-type]  # one of COMPRESSIONS
        recorder = FrameRecorder(writer)
        for number in range(count):
            recorder.write_frame(_renumbered(frames[number % len(frames)], number), 10.0)
    seconds, cpu = time.perf_counter() - began, time.process_time() - used
    statistics = writer.statistics
    speed = statistics.message_bytes / seconds * 1e-6
    ratio = statistics.file_bytes / statistics.message_bytes
    began = time.perf_counter()
    with RecordingReader(folder) as reader:
        read = sum(frame["rgb"].shape[0] > 0 for frame in RecordedFrames(reader))
    back = read / (time.perf_counter() - began)
    shutil.rmtree(folder)
    return Written(speed, count / seconds, cpu / seconds, ratio, back)


def _node(folder: Path, args: argparse.Namespace, compression: str) -> None:
    words = [sys.executable, "-m", "sailenv_ros.ros.nodes.recorder", "--ros-args", "-p"]
    words += [f"output:={folder}", "-p", f"compression:={compression}", "-p", "clock:=false"]
    recorder = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
    assert recorder.stderr is not None
    lines: list[str] = []
    for line in recorder.stderr:
        lines.append(line)
        if "Ctrl-C ends it" in line:
            break
    # Read on, or the recorder would stand still once the pipe is full.
    drain = threading.Thread(target=lambda: lines.extend(recorder.stderr or ()), daemon=True)
    drain.start()
    publisher = [sys.executable, __file__, "--publish", str(args.frames), "--scene", args.scene]
    before, began = cpu_s(recorder.pid), time.perf_counter()
    told = subprocess.run(publisher, check=True, capture_output=True, text=True).stdout.strip()
    cpu = cpu_s(recorder.pid) - before
    recorder.send_signal(signal.SIGINT)
    status = recorder.wait(60.0)
    drain.join(5.0)
    summary = lines[-1].strip().rsplit("]: ", 1)[-1].rpartition(": ")[2]
    print(
        f"over DDS    {compression:5} {told}; recorder status {status}, {cpu:.1f} CPU s "
        f"of {time.perf_counter() - began:.1f} s: {summary}"
    )
    shutil.rmtree(folder)


def _publish(scene: str, count: int) -> None:
    """Publish so many frames at 30 Hz as the simulator does, without rendering them meanwhile."""
    import rclpy
    from sensor_msgs.msg import CameraInfo, Image

    from sailenv_msgs.msg import FrameInfo
    from sailenv_msgs_py.frame_info import frame_info_to_msg, header_of_frame
    from sailenv_msgs_py.images import image_from_view
    from sailenv_ros.ros.nodes.qos import frame_qos
    from sailenv_ros.system.transport import use_shared_memory_profile
    from sailenv_ros.types.views import FIVE_VIEWS

    frames = _frames(scene)
    use_shared_memory_profile()
    rclpy.init()
    node = rclpy.create_node("publisher", namespace="/sailenv")
    images = {v: node.create_publisher(Image, f"agent/{v}", frame_qos()) for v in FIVE_VIEWS}
    infos = node.create_publisher(FrameInfo, "agent/frame_info", frame_qos())
    node.create_publisher(CameraInfo, "agent/camera_info", frame_qos())
    everything = [*images.values(), infos]
    deadline = time.monotonic() + 30.0
    while not all(p.get_subscription_count() for p in everything):
        if time.monotonic() > deadline:
            raise SystemExit("timed out after 30 s while waiting for the recorder's subscriptions")
        time.sleep(0.05)
    began = time.monotonic()
    for number in range(count):
        frame = _renumbered(frames[number % len(frames)], number)
        header = header_of_frame(frame)
        for view, publisher in images.items():
            publisher.publish(image_from_view(view, frame[view], header, copy=False))
        infos.publish(frame_info_to_msg(frame, header, views=FIVE_VIEWS, depth_range_m=10.0))
        time.sleep(max(0.0, began + (number + 1) / RATE_HZ - time.monotonic()))
    seconds = time.monotonic() - began
    time.sleep(1.0)
    print(f"published {count} frames, {count / seconds:.1f} fps")
    rclpy.shutdown()


def _disk_speed(folder: Path) -> float:
    block = os.urandom(2**24)
    path = folder / "probe"
    began = time.perf_counter()
    with path.open("wb") as file:
        for _ in range(32):
            file.write(block)
        os.fsync(file.fileno())
    speed = 32 * len(block) / (time.perf_counter() - began) * 1e-6
    path.unlink()
    return speed


if __name__ == "__main__":
    main()
