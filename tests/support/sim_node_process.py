"""A `sim_node` of a test's own: started with parameters, awaited, looked at, ended."""

from __future__ import annotations

import json
import os
from pathlib import Path

from tests.support.tool_process import LoggedProcess
from tests.support.waiting import until

SEGMENT_MARK = f"fastrtps_{'[0-9a-f]' * 16}_el"
"""Names of the files that mark a segment of Fast DDS; ports are shared with other processes."""

READY = "to see:"
"""Stands in the line that the node logs once everything is there."""


class NodeProcess(LoggedProcess):
    """A child process; a context manager that ends it.

    `arguments` go before ``--ros-args``, `remaps` after it, `parameters` as ``-p``.
    """

    def __init__(
        self,
        namespace: str,
        *,
        arguments: tuple[str, ...] = (),
        remaps: tuple[str, ...] = (),
        pass_fds: tuple[int, ...] = (),
        environment: dict[str, str] | None = None,
        ready: bool = True,
        **parameters: object,
    ) -> None:
        self.namespace = namespace
        ros = ["--ros-args", "-r", f"__ns:={namespace}", *remaps]
        defaults = {
            "publish_clock": False,
            "scene": "optical",
            "gateway__port": 0,
            "viewer__port": 0,
        }
        for name, value in {**defaults, **parameters}.items():
            # Keywords cannot hold dots: agent__width stands for agent.width.
            ros += ["-p", f"{name.replace('__', '.')}:={json.dumps(value)}"]
        super().__init__(
            "sim_node",
            (*arguments, *ros),
            pass_fds=pass_fds,
            start_new_session=True,
            env={**os.environ, **(environment or {})},
        )
        if ready:
            try:
                self.await_ready()
            except BaseException:
                self.close()  # nobody else could
                raise

    def await_ready(self) -> None:
        until(lambda: self.said(READY) or not self.alive, f"{self.namespace} to be ready", 60.0)
        assert self.alive, self.log

    def segments(self) -> set[Path]:
        """Segments that this process itself made (it maps those of its peers as well)."""
        locked = {
            int(fields[5].split(":")[2])
            for fields in map(str.split, Path("/proc/locks").read_text().splitlines())
            if fields[4] == str(self.pid)
        }
        # Whoever makes a segment holds a lock on the file beside it.
        marks = [p for p in Path("/dev/shm").glob(SEGMENT_MARK) if _inode(p) in locked]
        return {path for mark in marks for path in (mark, mark.with_name(mark.name[: -len("_el")]))}

    def signal(self, number: int) -> None:
        self._process.send_signal(number)


def _inode(path: Path) -> int:
    try:
        return path.stat().st_ino
    except FileNotFoundError:  # somebody else's, gone meanwhile
        return 0
