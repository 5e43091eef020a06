"""`sailenv doctor`: what the simulator would run on here, what is wrong, and what to do about it.

Asks the system and the probes, gives a table of findings. Exit status 0 only if a frame can be
rendered. Never hangs: whatever could, runs in a process of its own with a deadline.
"""

from __future__ import annotations

import argparse
import os
import platform
import shutil
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from rich.console import Console
from rich.table import Table

from sailenv_ros import __version__
from sailenv_ros.cli.doctor_probes import try_probe
from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.system.presence import simulator_is_present
from sailenv_ros.system.transport import NEEDED_BYTES, SHARED_MEMORY, remove_abandoned_segments

if TYPE_CHECKING:
    from sailenv_ros.native.library import NativeLibrary

__all__ = ["CheckResult", "add_parser", "diagnose", "run"]

Level = Literal["ok", "note", "warning", "FAILED"]
Probe = Callable[[str, float], "tuple[dict[str, Any] | None, str]"]

_STYLES: dict[Level, str] = {"ok": "green", "note": "cyan", "warning": "yellow", "FAILED": "red"}

LIBRARIES = ("numpy", "scipy", "moderngl", "pydantic", "opencv-python-headless")
GRAPHICS_PACKAGES = "libegl1 libegl-mesa0 libgl1 libgl1-mesa-dri"
GRAPHICS_VARIABLES = (
    "EGL_PLATFORM",
    "LIBGL_ALWAYS_SOFTWARE",
    "GALLIUM_DRIVER",
    "MESA_LOADER_DRIVER_OVERRIDE",
    "__EGL_VENDOR_LIBRARY_FILENAMES",
)


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckResult:
    """One line of the report.

    Attributes
    ----------
    topic : str
    text : str
        What was found, and where it is bad, what to do.
    level : {'ok', 'note', 'warning', 'FAILED'}
        ``FAILED`` alone changes the exit status.
    """

    topic: str
    text: str
    level: Level = "ok"


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "doctor", help="examine this machine: Python, ROS, OpenGL devices, scenes, shared memory"
    )
    parser.add_argument(
        "--timeout",
        type=float,
        default=60.0,
        metavar="SECONDS",
        help="how long each probe may take (default: %(default)g)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Print the table; 0 if a frame can be rendered, else 1."""
    console = Console(highlight=False)
    table = Table(show_header=False, box=None, padding=(0, 2, 0, 0))
    table.add_column()
    table.add_column()
    table.add_column(overflow="fold")  # paths are told whole
    failed = False
    with console.status("looking around"):
        for result in diagnose(timeout_s=args.timeout):
            failed |= result.level == "FAILED"
            style = _STYLES[result.level]
            table.add_row(f"[{style}]{result.level}[/]", result.topic, _plain(result.text))
    console.print(table)
    console.print(
        "[red]The simulator cannot render here.[/]"
        if failed
        else "[green]Frames can be rendered.[/]"
    )
    return int(failed)


def diagnose(*, timeout_s: float, probe: Probe = try_probe) -> Iterator[CheckResult]:
    """Look at everything, one after the other.

    Parameters
    ----------
    timeout_s : float
        How long each probe may take [s].
    probe : callable
        Runs a probe by its name, as `try_probe` does.
    """
    yield from _python()
    yield from _ros(*probe("ros", timeout_s))
    yield from _shared_memory()
    yield from _scenes(*probe("scenes", timeout_s))
    yield _native()
    yield from _graphics(*probe("graphics", timeout_s))
    yield from _frame(probe, timeout_s)


def _python() -> Iterator[CheckResult]:
    yield CheckResult(
        topic="Python",
        text=f"{platform.python_version()} at {sys.executable}, {platform.platform()}",
    )
    yield CheckResult(topic="package", text=f"sailenv_ros {__version__} at {_own_folder()}")
    bullet = "pybullet" if sys.version_info < (3, 12) else "pybullet-arm64"
    yield CheckResult(
        topic="libraries",
        text=", ".join(f"{name} {_version(name)}" for name in (*LIBRARIES, bullet)),
    )


def _ros(found: dict[str, Any] | None, why_not: str) -> Iterator[CheckResult]:
    if found is None:
        yield CheckResult(topic="ROS", text=why_not, level="warning")
        return
    if found["missing"]:
        yield CheckResult(
            topic="ROS",
            text=f"missing: {'; '.join(found['missing'])}. The simulator runs without it, its node "
            "and Agent do not: scripts/setup brings it. Beside your own ROS 2 Jazzy, source that, "
            "then .venv/bin/activate",
            level="warning",
        )
    if "rclpy" not in found:
        return
    of_pypi = Path(found["rclpy"]).is_relative_to(sys.prefix)
    distro = os.environ.get("ROS_DISTRO", "")
    source = "from PyPI" if of_pypi else f"installed ({found['rclpy']})"
    yield CheckResult(topic="ROS", text=f"{distro or 'jazzy'}, {source}, {found['rmw']}")
    if of_pypi and distro:
        yield CheckResult(
            topic="ROS",
            text=f"ROS 2 {distro} is sourced, and this Python has another one from PyPI: the two "
            "must not be mixed. Use a shell without the first, or run scripts/setup in this one",
            level="warning",
        )
    yield _domain()


def _domain() -> CheckResult:
    reach = os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") or "SUBNET"
    try:
        domain = int(os.environ.get("ROS_DOMAIN_ID") or 0)
    except ValueError:
        text = f"ROS_DOMAIN_ID={os.environ['ROS_DOMAIN_ID']} is no number from 0 to 232"
        return CheckResult(topic="domain", text=text, level="warning")
    running = "a simulator runs" if simulator_is_present(domain, "/sailenv") else "no simulator"
    text = f"{domain}, discovery range {reach}; {running} as /sailenv"
    return CheckResult(topic="domain", text=text)


def _shared_memory() -> Iterator[CheckResult]:
    freed = remove_abandoned_segments()
    if freed:
        yield CheckResult(
            topic="/dev/shm",
            text=f"removed {freed >> 20} MiB that processes left behind when they were killed",
            level="note",
        )
    try:
        usage = shutil.disk_usage(SHARED_MEMORY)
    except OSError as problem:
        yield CheckResult(
            topic="/dev/shm", text=f"{problem.strerror}: images go the slow way", level="warning"
        )
        return
    in_use = sum(1 for _ in SHARED_MEMORY.glob("fastrtps_*[0-9a-f]"))
    text = (
        f"{usage.free >> 20} of {usage.total >> 20} MiB free, {in_use} segments of Fast DDS in use"
    )
    if usage.free >= NEEDED_BYTES:
        yield CheckResult(topic="/dev/shm", text=text)
    else:
        yield CheckResult(
            topic="/dev/shm",
            text=f"{text}; images want {NEEDED_BYTES >> 20} MiB, else they go the slow way "
            "(docker run --shm-size=1g)",
            level="warning",
        )


def _scenes(found: dict[str, Any] | None, why_not: str) -> Iterator[CheckResult]:
    if found is None:
        yield CheckResult(topic="scenes", text=why_not, level="FAILED")
        return
    yield CheckResult(
        topic="scenes",
        text=f"{', '.join(found['scenes']) or 'none'}; {found['assets']} assets to put into them",
        level="ok" if found["scenes"] else "FAILED",
    )
    for error in found["scenes"].values():
        if error:
            yield CheckResult(topic="scenes", text=error, level="warning")


def _graphics(found: dict[str, Any] | None, why_not: str) -> Iterator[CheckResult]:
    for name in GRAPHICS_VARIABLES:
        if name in os.environ:
            yield CheckResult(
                topic="OpenGL", text=f"{name}={os.environ[name]} is set", level="note"
            )
    remedy = f"If there is no driver: sudo apt-get install {GRAPHICS_PACKAGES}"
    if found is None:
        yield CheckResult(topic="OpenGL", text=f"{why_not}. {remedy}", level="note")
        return
    for device in found["devices"]:
        topic = f"EGL device {device['index']}"
        if device["refused"]:
            yield CheckResult(topic=topic, text=f"refused: {device['refused']}", level="note")
        else:
            yield CheckResult(topic=topic, text=f"{device['renderer']}, OpenGL {device['version']}")
    if not any(not each["refused"] and not each["software"] for each in found["devices"]):
        yield CheckResult(
            topic="OpenGL",
            text="no device is graphics hardware: the native renderer draws, on the CPU; where "
            f"there is a graphics card, its driver lacks EGL. {remedy}",
            level="note",
        )


def _frame(probe: Probe, timeout_s: float) -> Iterator[CheckResult]:
    found, why_not = probe("frame by auto", timeout_s)
    if found is None:
        yield CheckResult(topic="renderer", text=f"no frame: {why_not}", level="warning")
        found, why_not = probe("frame by native", timeout_s)
        if found is None:
            text = f"nor by the native renderer: {why_not}"
            yield CheckResult(topic="a frame", text=text, level="FAILED")
            return
        text = f"FALLBACK, on the CPU, with backend:=native: {found['renderer']}"
        yield CheckResult(topic="renderer", text=text, level="warning")
    else:
        yield CheckResult(topic="renderer", text=found["renderer"])
    yield CheckResult(
        topic="a frame",
        text=f"{found['scene']} at 640x480 with five views in {found['ms']:.0f} ms, "
        f"{found['instances']} objects seen",
        level="ok" if found["instances"] else "FAILED",
    )


def native_library() -> NativeLibrary:
    """Load the native library; imported here, so that ``--help`` is there at once."""
    from sailenv_ros.native import library

    return library.native_library()


def _native() -> CheckResult:
    try:
        library = native_library()
    except NativeLibraryError as problem:
        return CheckResult(
            topic="native library",
            text=f"{problem}. Nothing is drawn without it. If there is no compiler: sudo apt-get "
            "install g++",
            level="FAILED",
        )
    return CheckResult(topic="native library", text=f"{library.instruction_set}, {library.path}")


def _version(distribution: str) -> str:
    try:
        return version(distribution)
    except PackageNotFoundError:
        return "(missing)"


def _own_folder() -> Path:
    return Path(__file__).resolve().parents[1]


def _plain(text: str) -> str:
    """Keep rich from reading brackets as its markup."""
    return text.replace("[", r"\[")
