"""Those who only look while others change everything: a recording, a web viewer, a SAILenv client.

Each checks what it can know for certain: the recording that every frame that was written is there
with its bytes and in order, the page that no frame's number is missing, the client that it stands
where it put itself.
"""

from __future__ import annotations

import asyncio
import contextlib
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from sailenv_ros.errors import DeadlineExceeded
from sailenv_ros.gateway import GatewayServer
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.lockstep import FrameRecorder
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.recording.writer import RecordingWriter
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.viewer import ViewerServer
from tests.support.sailenv_client import original_client
from tests.support.viewer_socket import connected

__all__ = ["bystanders"]

SMALL = CameraIntrinsics(width=32, height=24)


@contextlib.contextmanager
def bystanders(simulation: Simulation, folder: Path) -> Iterator[dict[str, int]]:
    """Have them look until the end of the block, then hold what they saw against what was.

    Yields
    ------
    counts : dict of str to int
        How many frames each was given, filled in at the end.
    """
    counts: dict[str, int] = {}
    over = threading.Event()
    faults: list[BaseException] = []

    def begun(watch: Callable[[], None]) -> threading.Thread:
        def run() -> None:
            try:
                watch()
            except BaseException as fault:
                faults.append(fault)

        thread = threading.Thread(target=run, name=f"bystander-{watch.__name__}")
        thread.start()
        return thread

    def record() -> None:
        counts["recorded"] = _record(simulation, folder / "bag", over)

    def view() -> None:
        with ViewerServer(simulation, port=0) as server:
            server.set_intrinsics(SMALL)
            counts["viewed"] = asyncio.run(_view(server, over))

    def ask() -> None:
        with GatewayServer(simulation, port=0) as server:
            counts["asked for"] = _ask(server.port, over)

    threads = [begun(watch) for watch in (record, view, ask)]
    try:
        yield counts
    finally:
        over.set()
        for thread in threads:
            thread.join(60.0)
    if faults:
        raise faults[0]


def _record(simulation: Simulation, bag: Path, over: threading.Event) -> int:
    """Record a camera's frames, and read them again."""
    simulation.register_agent(AgentSpec(name="recorded", intrinsics=SMALL, following=False))
    simulation.set_pose(Pose((0.0, 0.0, 1.0)), agent="recorded")
    written = []
    with (
        RecordingWriter(bag) as writer,
        simulation.stream("recorded", ["rgb", "instance"]) as stream,
    ):
        recorder = FrameRecorder(writer)
        recorder.write_info(simulation.info)
        while not over.is_set():
            with contextlib.suppress(DeadlineExceeded):
                frame = stream.get(0.05)
                recorder.write_frame(frame, frame.depth_range_m)
                written.append((frame.sequence, frame.stamp_ns, frame["instance"].tobytes()))
    with RecordingReader(bag) as reader:
        frames = RecordedFrames(reader, "recorded") if written else ()
        read = [(f.sequence, f.stamp_ns, f["instance"].tobytes()) for f in frames]
    assert read == written
    assert [number for number, *_ in read] == sorted({number for number, *_ in read})
    return len(read)


async def _view(server: ViewerServer, over: threading.Event) -> int:
    """Look at the debug agent as the page does."""
    async with connected(server) as page:
        await page.ask("watch", agent="debug_agent", views=["rgb", "instance"])
        number = 0
        while not over.is_set():
            with contextlib.suppress(asyncio.TimeoutError):
                message = await asyncio.wait_for(page.read(), 0.1)
                if message["type"] == "frame":
                    number += 1
                    assert message["number"] == number
                    await page.socket.send_json({"do": "shown", "number": number})
        return number


def _ask(port: int, over: threading.Event) -> int:
    """Move, ask where that is, and look, as scripts for SAILenv do."""
    count = 0
    with original_client(port, width=32, height=24) as client:
        client.toggle_follow()
        while not over.is_set():
            place = (float(count % 7), 1.0, -2.0)
            client.set_position(place)
            np.testing.assert_allclose(client.get_position(), place, atol=1e-5)
            assert client.get_frame()["main"].shape == (24, 32, 3)
            count += 1
    return count
