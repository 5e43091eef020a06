"""A recorder or player of a test's own: started with parameters, awaited, ended, read."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading

from tests.support.waiting import until


class ToolProcess:
    """A node of this package as a child process; a context manager that ends it."""

    def __init__(self, node: str, namespace: str, ready: str, **parameters: object) -> None:
        words = [sys.executable, "-m", f"sailenv_ros.ros.nodes.{node}", "--ros-args"]
        words += ["-r", f"__ns:={namespace}"]
        for name, value in parameters.items():
            words += ["-p", f"{name}:={json.dumps(value)}"]
        self._process = subprocess.Popen(
            words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True
        )
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        if ready:
            until(lambda: self.said(ready) or not self.alive, f"{node} to say {ready!r}", 60.0)
            assert self.alive or self.said(ready), self.log

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def alive(self) -> bool:
        return self._process.poll() is None

    @property
    def log(self) -> str:
        return "\n".join(self.lines)

    def said(self, text: str) -> bool:
        return any(text in line for line in self.lines)

    def status(self, timeout_s: float = 30.0) -> int:
        """Wait for the end; return the exit status."""
        status = self._process.wait(timeout_s)
        self._reader.join(5.0)
        return status

    def end(self, number: int = signal.SIGINT) -> int:
        """Ask for the end; return the exit status."""
        self._process.send_signal(number)
        return self.status()

    def __enter__(self) -> ToolProcess:
        return self

    def __exit__(self, *exc: object) -> None:
        if self.alive:
            self._process.kill()
            self._process.wait(10.0)
        self._reader.join(5.0)
        if self._process.stderr is not None:
            self._process.stderr.close()

    def _read(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self.lines.append(line.rstrip("\n"))
