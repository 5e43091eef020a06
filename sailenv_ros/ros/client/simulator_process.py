"""A simulator as a child process of this one, for an `Agent` that found none.

Starts `sim_node` and ends it. The child also ends by itself when this process dies, whatever it
dies of: it watches a pipe whose other end is open here alone. Knows no ROS.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from sailenv_ros.errors import InvalidRequest, SimulationClosed
from sailenv_ros.system.transport import remove_abandoned_segments, stay_local

__all__ = ["SimulatorProcess"]

END_TIMEOUT_S = 5.0
"""Time that the child process may take to end before it is killed [s]."""


class SimulatorProcess:
    """A running `sim_node`.

    Parameters
    ----------
    domain_id : int
        ROS domain.
    namespace : str
        Its namespace, e.g. ``"/sailenv"``.
    parameters : mapping of str to bool, int, float, str or a list of them
        Parameters of the node, e.g. ``{"scene": "optical"}``.
    """

    def __init__(self, domain_id: int, namespace: str, parameters: Mapping[str, object]) -> None:
        settings = [f"{name}:={_yaml(name, value)}" for name, value in parameters.items()]
        ros_arguments = ["--ros-args", "-r", f"__ns:={namespace}"]
        for setting in settings:
            ros_arguments += ["-p", setting]
        read_end, self._write_end = os.pipe()
        self._log = tempfile.TemporaryFile(prefix="sailenv_sim_node_")  # noqa: SIM115 - kept open
        arguments = ["--end-with-fd", str(read_end), *ros_arguments]
        try:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "sailenv_ros.ros.nodes.sim_node", *arguments],
                env=_environment(domain_id),
                pass_fds=(read_end,),
                stdin=subprocess.DEVNULL,
                stdout=self._log,
                stderr=subprocess.STDOUT,
                # A Ctrl-C at the terminal is for the user's program, which then closes this.
                start_new_session=True,
            )
        except OSError:
            os.close(self._write_end)
            self._log.close()
            raise
        finally:
            os.close(read_end)

    @property
    def pid(self) -> int:
        """The child's process id."""
        return self._process.pid

    def is_alive(self) -> bool:
        """Return whether the child runs."""
        return self._process.poll() is None

    def log(self) -> str:
        """Return what the child wrote so far."""
        return os.pread(self._log.fileno(), 1 << 20, 0).decode(errors="replace")

    def failure(self) -> SimulationClosed:
        """Return why a child that has ended did so, in its own last words."""
        lines = [line for line in self.log().splitlines() if line.strip()]
        status = self._process.poll()
        last = lines[-1] if lines else "it said nothing"
        return SimulationClosed(f"sim_node ended with status {status}: {last}")

    def close(self) -> None:
        """End the child, by force if need be; a second call does nothing."""
        if self._write_end < 0:
            return
        os.close(self._write_end)
        self._write_end = -1
        if self.is_alive():
            self._process.terminate()
        try:
            self._process.wait(END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait(END_TIMEOUT_S)
        if self._process.returncode < 0:
            remove_abandoned_segments()  # a killed process could not do it
        self._log.close()


def _environment(domain_id: int) -> dict[str, str]:
    package_parent = str(Path(__file__).resolve().parents[3])
    path = os.environ.get("PYTHONPATH", "")
    inherited = dict(os.environ)
    stay_local(inherited)
    return {
        **inherited,
        "ROS_DOMAIN_ID": str(domain_id),
        "PYTHONPATH": os.pathsep.join([package_parent, *([path] if path else [])]),
        "PYTHONSAFEPATH": "1",  # not a package of this name that lies in the current folder
        "PYTHONUNBUFFERED": "1",
    }


def _yaml(name: str, value: object) -> str:
    if not isinstance(value, bool | int | float | str | list | tuple):
        raise InvalidRequest(f"parameter {name}", value, "a truth value, number, text or list")
    return json.dumps(value)  # JSON is YAML, and its quotes keep texts texts
