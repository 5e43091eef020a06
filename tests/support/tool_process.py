"""A recorder or player of a test's own: started with parameters, awaited, ended, read."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from typing import Any, Self

from tests.support.waiting import until

SEVERAL = """
import importlib, json, sys
main = importlib.import_module(sys.argv[1]).main
for arguments in json.loads(sys.argv[2]):
    print("status", main([sys.argv[1], *arguments]), file=sys.stderr, flush=True)
"""
"""Runs a node's `main` with one list of arguments after the other."""


def run_several(
    node: str,
    namespace: str,
    *settings: Mapping[str, object] | Sequence[str],
    timeout_s: float = 60.0,
) -> list[tuple[int, str]]:
    """Run a node with one set of parameters after the other; return status and log of each.

    All in one process, since to start one takes longer than to refuse parameters. A sequence has
    arguments for ROS instead.
    """
    arguments = [
        _arguments(namespace, one)
        if isinstance(one, Mapping)
        else [*_arguments(namespace, {}), *one]
        for one in settings
    ]
    done = subprocess.run(
        [sys.executable, "-c", SEVERAL, f"sailenv_ros.ros.nodes.{node}", json.dumps(arguments)],
        capture_output=True,
        text=True,
        timeout=timeout_s,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    parts = re.split(r"^status (\d+)\n", done.stderr, flags=re.MULTILINE)
    return [(int(status), log) for log, status in zip(parts[::2], parts[1::2], strict=False)]


def _arguments(namespace: str, parameters: Mapping[str, object]) -> list[str]:
    """Return the words that give a node its namespace and parameters."""
    words = ["--ros-args", "-r", f"__ns:={namespace}"]
    for name, value in parameters.items():
        words += ["-p", f"{name}:={json.dumps(value)}"]
    return words


class LoggedProcess:
    """A node of this package as a child process, whose log is read as it comes."""

    def __init__(self, node: str, words: Sequence[str], **settings: Any) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", f"sailenv_ros.ros.nodes.{node}", *words],
            stderr=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            text=True,
            **settings,
        )
        self.lines: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

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

    def close(self) -> None:
        """End it, whatever it does."""
        if self.alive:
            self._process.send_signal(signal.SIGTERM)
            try:
                self.status(20.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self.status()
        self._reader.join(5.0)
        if self._process.stderr is not None:
            self._process.stderr.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _read(self) -> None:
        assert self._process.stderr is not None
        for line in self._process.stderr:
            self.lines.append(line.rstrip("\n"))


class ToolProcess(LoggedProcess):
    """A recorder or player; a context manager that ends it."""

    def __init__(self, node: str, namespace: str, ready: str, **parameters: object) -> None:
        super().__init__(node, _arguments(namespace, parameters))
        if ready:
            until(lambda: self.said(ready) or not self.alive, f"{node} to say {ready!r}", 60.0)
            assert self.alive or self.said(ready), self.log

    def end(self, number: int = signal.SIGINT) -> int:
        """Ask for the end; return the exit status."""
        self._process.send_signal(number)
        return self.status()
