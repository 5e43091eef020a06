"""A SAILenv client in a process of its own, which looks at what stands still, to be killed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

__all__ = ["ClientProcess"]

ROOT = Path(__file__).resolve().parents[2]

_LOOK = """
import hashlib, sys
from tests.support.sailenv_client import original_client

with original_client(int(sys.argv[1]), width=320, height=240) as client:
    client.set_position((0.0, -4.0, 2.0))
    digest = hashlib.sha256()
    for _ in range(int(sys.argv[2])):
        frame = client.get_frame()
        digest.update(frame["depth"].tobytes() + frame["category"].tobytes())
        print("frame", flush=True)
print(digest.hexdigest(), flush=True)
"""


class ClientProcess:
    """A client that registers, takes frames and says good-bye; a context manager that ends it."""

    def __init__(self, port: int, frames: int) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-c", _LOOK, str(port), str(frames)],
            stdout=subprocess.PIPE,
            text=True,
            env={
                **os.environ,
                "PYTHONPATH": f"{ROOT}{os.pathsep}{os.environ.get('PYTHONPATH', '')}",
            },
        )

    @property
    def ended(self) -> bool:
        return self._process.poll() is not None

    def await_frame(self) -> None:
        """Wait until it has got another frame."""
        assert self._process.stdout is not None
        assert self._process.stdout.readline() == "frame\n"

    def digest(self) -> str:
        """Wait for a good end; return the digest of all that it got."""
        told, _ = self._process.communicate(timeout=120.0)
        assert self._process.returncode == 0
        return str(told).split()[-1]

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()

    def __enter__(self) -> ClientProcess:
        return self

    def __exit__(self, *exc: object) -> None:
        self.kill()
        if self._process.stdout is not None:
            self._process.stdout.close()
