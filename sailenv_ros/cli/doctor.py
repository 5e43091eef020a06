"""`sailenv doctor`: what this machine has of what the simulator needs, and what is missing.

Whatever might hang or crash (drivers do) happens in a process of its own with a deadline. The exit
status is 0 only if a frame could be rendered.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import importlib.util
import json
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.table import Table

from sailenv_ros import __version__
from sailenv_ros.errors import SailenvError
from sailenv_ros.transport import NEEDED_BYTES, SHARED_MEMORY

__all__ = ["add_parser", "examine", "run"]

PROBE_TIMEOUT_S = 60.0

SYSTEM_PACKAGES = "libegl1 libegl-mesa0 libgl1-mesa-dri libgl1"

Finding = tuple[str, str, str]
"""'ok', 'note' or 'bad'; what was examined; what was found."""

_COLOURS = {"ok": "green", "note": "yellow", "bad": "red"}


def add_parser(subparsers: Any) -> None:
    """Add the command to those of `sailenv`."""
    parser: argparse.ArgumentParser = subparsers.add_parser(
        "doctor", help="examine this machine: Python, ROS, OpenGL devices, scenes, shared memory"
    )
    parser.add_argument(
        "--timeout",
        type=float,
        default=PROBE_TIMEOUT_S,
        metavar="S",
        help="wall time after which a driver counts as hanging (default: %(default)s)",
    )
    parser.set_defaults(run=run)


def run(args: argparse.Namespace) -> int:
    """Show the findings; 0 if a frame could be rendered, else 1."""
    console = Console(highlight=False)
    findings, rendered = examine(args.timeout)
    table = Table(show_header=False, box=None, pad_edge=False)
    for grade, what, found in findings:
        table.add_row(f"[{_COLOURS[grade]}]{grade}[/]", what, found)
    console.print(table)
    if not rendered:
        console.print("[red]No frame could be rendered[/], so the simulator will not run here.")
    return 0 if rendered else 1


def examine(timeout_s: float) -> tuple[list[Finding], bool]:
    """Examine everything; say also whether a frame could be rendered.

    Parameters
    ----------
    timeout_s : float
        Deadline of each process that tries a renderer [s].
    """
    findings = [*_python(), *_ros(), *_scenes(), *_shared_memory()]
    opengl, devices = _opengl(timeout_s)
    findings += devices
    if opengl:
        return findings, True
    probe = _probe("tiny", timeout_s)
    if "rendered" in probe:
        findings.append(("note", "fallback renderer", f"works, slowly: {probe['rendered']}"))
        return findings, True
    findings.append(("bad", "fallback renderer", probe["fault"]))
    return findings, False


def _python() -> Iterator[Finding]:
    version = platform.python_version()
    fits = (3, 10) <= sys.version_info[:2] <= (3, 13)
    yield "ok" if fits else "note", "Python", f"{version}, {platform.machine()}, {sys.prefix}"
    yield "ok", "sailenv_ros", f"{__version__}, {Path(__file__).parents[1]}"


def _ros() -> Iterator[Finding]:
    if importlib.util.find_spec("rclpy") is None:
        yield (
            "note",
            "ROS 2",
            "not here: Simulation works, nodes and Agent do not (see scripts/run)",
        )
        return
    try:
        importlib.metadata.version("ros-rclpy")
        source = f"wheels in {sys.prefix}"
    except importlib.metadata.PackageNotFoundError:
        source = os.environ.get("AMENT_PREFIX_PATH", "a prefix that is not named").split(":")[-1]
    yield "ok", "ROS 2", f"{os.environ.get('ROS_DISTRO', 'jazzy')}, {source}"
    messages = importlib.util.find_spec("sailenv_msgs") is not None
    found = "installed" if messages else "not installed: run scripts/setup, or colcon build"
    yield "ok" if messages else "bad", "sailenv_msgs", found
    domain = os.environ.get("ROS_DOMAIN_ID", "0")
    rmw = os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp (default)")
    yield "ok", "middleware", f"{rmw}, ROS_DOMAIN_ID {domain}"


def _scenes() -> Iterator[Finding]:
    # Imported here: it reads the asset catalogue, and the rest must be told even if that fails.
    from sailenv_ros.simulation.scenes import SceneLibrary

    try:
        library = SceneLibrary()
        for name in library.scene_names:
            library.load(name)
    except SailenvError as fault:
        yield "bad", "scenes", str(fault)
        return
    yield "ok", "scenes", ", ".join(library.scene_names)
    yield "ok", "assets", f"{len(library.spawnables)}: {', '.join(library.spawnables[:8])} …"


def _shared_memory() -> Iterator[Finding]:
    if not SHARED_MEMORY.is_dir():
        yield "note", str(SHARED_MEMORY), "not here: big images will be slow between processes"
        return
    usage = shutil.disk_usage(SHARED_MEMORY)
    left = sum(1 for _ in SHARED_MEMORY.glob("fastrtps_*"))
    found = f"{usage.free >> 20} MiB free of {usage.total >> 20}, {left} files of Fast DDS"
    enough = usage.free >= NEEDED_BYTES
    hint = "" if enough else f"; under {NEEDED_BYTES >> 20} MiB images go the slow way"
    yield "ok" if enough else "note", str(SHARED_MEMORY), found + hint


def _opengl(timeout_s: float) -> tuple[bool, list[Finding]]:
    probe = _probe("gl", timeout_s)
    findings: list[Finding] = [
        ("note" if device["refused"] else "ok", f"EGL device {device['index']}", device["text"])
        for device in probe.get("devices", ())
    ]
    if "rendered" not in probe:
        hint = f"; on Debian and Ubuntu: apt-get install {SYSTEM_PACKAGES}"
        return False, [*findings, ("bad", "OpenGL", probe["fault"] + hint)]
    if probe["software"]:
        found = f"SOFTWARE, on the CPU: {probe['rendered']}"
        return True, [*findings, ("note", "OpenGL", found)]
    return True, [*findings, ("ok", "OpenGL", probe["rendered"])]


def _probe(backend: str, timeout_s: float) -> dict[str, Any]:
    """Try a renderer in a process of its own; 'fault' in its answer says why it failed."""
    command = [sys.executable, "-m", "sailenv_ros.cli.probe_renderer", backend]
    try:
        done = subprocess.run(command, capture_output=True, timeout=timeout_s, check=False)
    except subprocess.TimeoutExpired:
        return {"fault": f"hangs: no answer within {timeout_s:g} s"}
    try:
        answer: dict[str, Any] = json.loads(done.stdout.decode().strip().splitlines()[-1])
    except (ValueError, IndexError):
        last = done.stderr.decode(errors="replace").strip().splitlines()[-1:]
        return {"fault": f"ended with status {done.returncode} {' '.join(last)}".strip()}
    return answer
