"""Starts the simulator before ROS is installed, and joins it to ROS once that is there.

`scripts/run` runs it in a fresh clone: the room can be seen in the browser, and SAILenv clients can
connect, while ROS 2 is fetched and the messages are compiled in the background. Then this process
becomes that of `sim_node`, with the simulation as it is. Takes the arguments of `sim_node`.

    python -m sailenv_ros.ros.nodes.early_start --ros-setup COMMAND -- --ros-args -p scene:=room_01

The dynamic linker reads `LD_LIBRARY_PATH` once, when a process starts, and never looks again into a
folder that was not there. So this process has to be started with the folder `ROS_LIBRARIES` and the
environment's `lib` on that path; the libraries of the ROS 2 wheels are linked there when they come.

Exit status as that of `sim_node`.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import logging
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from sailenv_ros.errors import InvalidRequest, NameTaken, SailenvError
from sailenv_ros.ros.nodes.hosting import Hosted, load_simulation
from sailenv_ros.ros.nodes.lifecycle import StopRequest
from sailenv_ros.ros.nodes.parameter_table import NAMESPACE
from sailenv_ros.ros.nodes.plain_arguments import plain_parameters
from sailenv_ros.simulation.background_build import BuildStep
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.system.presence import SimulatorLock, checked_domain

__all__ = ["main"]

ROS_LIBRARIES = Path(sys.prefix, "opt", "ros_libraries")
"""Links to the libraries of the ROS 2 wheels."""

_FOLDERS = "ros_*.libs"
"""Folders in site-packages in which the ROS 2 wheels keep their libraries."""

_BOOTSTRAPPED = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"
"""Set, it tells the ROS 2 wheels that `LD_LIBRARY_PATH` is as they need it."""

_log = logging.getLogger(f"sailenv_ros.ros.nodes.{Path(__file__).stem}")  # __name__ may be __main__


def main(argv: Sequence[str] | None = None) -> int:
    """Run the simulator until it is asked to end; return the exit status."""
    arguments = list(sys.argv if argv is None else argv)
    shown = logging.StreamHandler()
    shown.setFormatter(logging.Formatter("[%(levelname)s] %(message)s"))
    logging.getLogger("sailenv_ros").addHandler(shown)
    logging.getLogger("sailenv_ros").setLevel(logging.INFO)
    stop = StopRequest()
    stop.install()
    try:
        return _run(arguments, stop, shown)
    except NameTaken as error:
        _log.critical("%s", error)
        return 3
    except SailenvError as error:
        _log.critical("%s", error)
        return 2
    except Exception:
        _log.exception("the simulator ends because of an internal error")
        return 1
    finally:
        stop.disarm()


def _run(arguments: list[str], stop: StopRequest, shown: logging.Handler) -> int:
    setup, for_node = _split(arguments)
    parameters = plain_parameters(for_node)
    if parameters is None:
        _log.info("ROS is installed first, because it has to read: %s", " ".join(for_node))
        status = subprocess.run([setup, "--environment"], check=False).returncode
        if status:
            return status
        _forget_libraries(os.environ)
        os.execv(
            sys.executable, [sys.executable, "-m", "sailenv_ros.ros.nodes.sim_node", *for_node]
        )
    keep_freed_memory()
    # After that ROS is there, and a program that waits for this simulator may find it.
    with SimulatorLock(checked_domain(os.environ.get("ROS_DOMAIN_ID") or 0), NAMESPACE):
        simulation = load_simulation(parameters, stop)
        if simulation is None:
            return 0
        installed = []
        environment = dict(os.environ)
        _forget_libraries(environment)
        ros = BuildStep(
            command=(setup, "--environment"),
            by_hand=f"{setup} --environment",
            environment=environment,
            done=lambda: installed.append(True),
        )
        hosted = Hosted(simulation, parameters, ros)
        try:
            _greet(hosted)
            while not installed:
                if stop.wait(0.1):
                    return 0
                if simulation.closed:
                    _log.critical("the simulation has ended because of an error, see above")
                    return 1
            return _join(["sim_node", *for_node], stop, hosted, shown)
        finally:
            hosted.close_servers()
            hosted.close_simulation(1.0)


def _split(arguments: Sequence[str]) -> tuple[str, list[str]]:
    """Return the command that installs ROS, and the arguments of the node."""
    if arguments[1:2] != ["--ros-setup"] or arguments[3:4] != ["--"]:
        accepted = "--ros-setup COMMAND -- and the arguments of sim_node"
        raise InvalidRequest("arguments", " ".join(arguments[1:]), accepted)
    return arguments[2], list(arguments[4:])


def _greet(hosted: Hosted) -> None:
    info = hosted.simulation.info
    window = f"; to see: {hosted.viewer_url} in a browser" if hosted.viewer_url else ""
    _log.info("scene %r; renderer: %s%s", info.scene, info.renderer, window)
    _log.info("ROS 2 is installed meanwhile; topics and services come when it is there")


def _join(arguments: list[str], stop: StopRequest, hosted: Hosted, shown: logging.Handler) -> int:
    """Become the node; where that cannot be, continue without ROS."""
    _link_libraries()
    importlib.invalidate_caches()
    sim_node = importlib.import_module("sailenv_ros.ros.nodes.sim_node")
    logger = logging.getLogger("sailenv_ros")
    logger.removeHandler(shown)  # ROS's own log takes its place
    status: int = sim_node.run(arguments, stop, hosted)
    logger.addHandler(shown)
    if status and not hosted.simulation.closed and not stop.is_set:
        _log.error("the simulator goes on without ROS; see above why")
        while not stop.wait(0.25) and not hosted.simulation.closed:
            pass
    return status


# -- libraries -------------------------------------------------------------------------------


def _link_libraries() -> None:
    """Show the linker the libraries of the ROS 2 wheels that have come."""
    found = importlib.util.find_spec("rclpy")
    if found is None or found.origin is None:
        return
    ROS_LIBRARIES.mkdir(parents=True, exist_ok=True)
    for library in Path(found.origin).parents[1].glob(f"{_FOLDERS}/*"):
        with contextlib.suppress(FileExistsError):
            (ROS_LIBRARIES / library.name).symlink_to(library)


def _forget_libraries(environment: dict[str, str] | os._Environ[str]) -> None:
    """Take out of an environment what only this process needs."""
    ours = {str(ROS_LIBRARIES), str(Path(sys.prefix, "lib"))}
    path = environment.get("LD_LIBRARY_PATH", "").split(os.pathsep)
    rest = os.pathsep.join(folder for folder in path if folder and folder not in ours)
    environment.pop("LD_LIBRARY_PATH", None)
    environment.pop(_BOOTSTRAPPED, None)
    if rest:
        environment["LD_LIBRARY_PATH"] = rest


if __name__ == "__main__":
    sys.exit(main())
