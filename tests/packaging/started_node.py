"""A simulator that was started the way its users start it: from a prefix, outside the sources."""

from __future__ import annotations

import contextlib
import signal
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from sensor_msgs.msg import Image

from sailenv_msgs.msg import SceneInfo
from tests.support.ros_probe import LATCHED, Probe
from tests.support.waiting import until

START_TIMEOUT_S = 240.0
END_TIMEOUT_S = 20.0


def assert_publishes(
    command: Sequence[str], *, environment: Mapping[str, str], folder: Path, namespace: str
) -> None:
    """Start a node, see the scene and pictures of its agent arrive, end it by SIGTERM.

    The middleware is that of the test's own process, so both have to be on one ROS domain.
    """
    with _running([*command, "--ros-args", "-r", f"__ns:={namespace}"], environment, folder) as log:
        with Probe(namespace) as probe:
            scene = probe.listen(SceneInfo, "scene_info", LATCHED)
            images = [probe.listen(Image, f"agent/{view}") for view in ("rgb", "instance")]
            until(
                lambda: all(topic.messages for topic in (scene, *images)) or log.ended(),
                f"scene_info and images of {command[0]}; it says:\n{log.text()}",
                START_TIMEOUT_S,
            )
            assert not log.ended(), log.text()
        assert scene.last.scene in ("room_01", "optical")  # with or without the furniture
        rgb, instance = (topic.last for topic in images)
        assert (rgb.width, rgb.height, rgb.encoding) == (640, 480, "rgb8")
        assert instance.encoding == "16UC1"
        assert any(instance.data)


class _Log:
    def __init__(self, process: subprocess.Popen[bytes], path: Path) -> None:
        self._process, self._path = process, path

    def ended(self) -> bool:
        return self._process.poll() is not None

    def text(self) -> str:
        return self._path.read_text(errors="replace")


@contextlib.contextmanager
def _running(
    command: Sequence[str], environment: Mapping[str, str], folder: Path
) -> Iterator[_Log]:
    path = folder / "node.log"
    with path.open("wb") as file:
        process = subprocess.Popen(
            command, env=dict(environment), cwd=folder, stdout=file, stderr=subprocess.STDOUT
        )
    log = _Log(process, path)
    try:
        yield log
        process.send_signal(signal.SIGTERM)
        assert process.wait(END_TIMEOUT_S) == 0, log.text()
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()
