"""A process that makes frames when it is told to, and says what they cost.

A `Setting` as JSON in the arguments, numbers of frames on standard input; a JSON line for each on
standard output. `Worker` is the other end, for the process that started it.
"""

from __future__ import annotations

import json
import os
import selectors
import subprocess
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Any

from sailenv_bench.experiments.workloads import Setting, Workload, environment_of, make_workload
from sailenv_ros.errors import DeadlineExceeded, ProtocolError, SailenvError

__all__ = ["Worker", "main"]

START_S = 180.0
"""Time that a worker may take to report that it is ready [s]: it builds a scene, perhaps twice."""

ROUND_S = 300.0
END_S = 30.0


class Worker:
    """A worker process; a context manager.

    Not reached by Ctrl-C in the terminal: it is ended by its owner.
    """

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self._process = subprocess.Popen(
            [sys.executable, "-m", __spec__.name, json.dumps(asdict(setting))],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env={**os.environ, **environment_of(setting.kind)},
            start_new_session=True,
        )
        self._rest = b""

    def ready(self) -> dict[str, Any]:
        """Wait until it is; return ``renderer``, or ``problem`` if it cannot be."""
        return self._answer(START_S)

    def take(self, frames: int) -> dict[str, Any]:
        """Have frames made; see `_measured` for what is given."""
        assert self._process.stdin is not None
        with suppress(BrokenPipeError):  # it has ended, which its answer says
            self._process.stdin.write(f"{frames}\n".encode())
            self._process.stdin.flush()
        return self._answer(ROUND_S)

    def close(self) -> None:
        """End the process, by force if it does not listen."""
        with suppress(BrokenPipeError):
            if self._process.stdin is not None:
                self._process.stdin.close()
        try:
            self._process.wait(END_S)
        except subprocess.TimeoutExpired:
            os.killpg(self._process.pid, 9)
            self._process.wait(END_S)
        finally:
            if self._process.stdout is not None:
                self._process.stdout.close()

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    def _answer(self, timeout_s: float) -> dict[str, Any]:
        pipe = self._process.stdout
        assert pipe is not None
        deadline = time.monotonic() + timeout_s
        with selectors.DefaultSelector() as selector:
            selector.register(pipe, selectors.EVENT_READ)
            while b"\n" not in self._rest:
                if not selector.select(max(0.0, deadline - time.monotonic())):
                    raise DeadlineExceeded(f"the measurement of {self.setting.kind}", timeout_s)
                some = os.read(pipe.fileno(), 65536)
                if not some:
                    return {"problem": f"its process ended with status {self._process.wait()}"}
                self._rest += some
        line, _, self._rest = self._rest.partition(b"\n")
        answer = json.loads(line)
        if not isinstance(answer, dict):
            raise ProtocolError(f"a worker answered {line!r}")
        return answer


def main(words: Sequence[str] | None = None) -> None:
    """Work until standard input ends."""
    (text,) = sys.argv[1:] if words is None else words
    # What libraries print shall not be taken for an answer.
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    fields = json.loads(text)
    try:
        workload = make_workload(Setting(**{**fields, "views": tuple(fields["views"])}))
    except (SailenvError, ImportError) as problem:
        answers.write(json.dumps({"problem": str(problem)}) + "\n")
        return
    try:
        answers.write(json.dumps({"renderer": workload.renderer}) + "\n")
        for line in sys.stdin:
            answers.write(json.dumps(_measured(workload, int(line))) + "\n")
    except (SailenvError, OSError) as problem:
        answers.write(json.dumps({"problem": str(problem)}) + "\n")
    finally:
        workload.close()


def _measured(workload: Workload, frames: int) -> dict[str, Any]:
    """Make frames of every camera.

    Returns
    -------
    fields : dict
        ``physics`` and ``frame``: wall times of each round, of the latter of all cameras together
        [s]; ``stages``: a dict for each frame whose stages are known [s]; ``cpu_s``: processor time
        of simulator and client in all; ``memory_mib``: what they have in memory now; ``repeated``:
        how many frames had to be asked for again so far, because images were lost.
    """
    pids = (os.getpid(), *workload.pids)
    physics, frame, stages = [], [], []
    before = sum(map(cpu_s, pids))
    for _ in range(frames):
        began = time.perf_counter()
        workload.step()
        stepped = time.perf_counter()
        stages += workload.frames()
        frame.append(time.perf_counter() - stepped)
        physics.append(stepped - began)
    return {
        "physics": physics,
        "frame": frame,
        "stages": stages,
        "cpu_s": sum(map(cpu_s, pids)) - before,
        "memory_mib": sum(map(_resident_mib, pids)),
        "repeated": workload.repeated,
    }


def cpu_s(pid: int) -> float:
    """Return the processor time that a process has used, all threads, user and system [s]."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _resident_mib(pid: int) -> float:
    lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    return int(next(line for line in lines if line.startswith("VmRSS")).split()[1]) / 1024


if __name__ == "__main__":
    main()
