"""Provenance of a figure: the machine, versions, the commit, the command, the load.

The running system in, a JSON-able dict out. Knows no experiment.
"""

from __future__ import annotations

import os
import platform
import subprocess
from collections.abc import Sequence
from datetime import datetime, timezone
from importlib import metadata
from pathlib import Path
from typing import Any

from sailenv_ros import __version__

__all__ = ["cpu_name", "provenance"]

PACKAGES = (
    "numpy", "opencv-python-headless", "pybullet", "pybullet-arm64", "moderngl", "mujoco",
    "onnxruntime", "torch", "rclpy",
)  # fmt: skip

CHANGES = ("status", "--porcelain", "-uno", "--", ":/", ":(top,exclude)docs", ":(top,exclude)*.md")
"""Words of git that list what differs from the commit, without the pages and their figures."""


def provenance(command: Sequence[str]) -> dict[str, Any]:
    """Return where and how a measurement is being made.

    Parameters
    ----------
    command : sequence of str
        The words that started it.

    Returns
    -------
    origin : dict
        ``machine``, ``cpu``, ``cpus`` (that this process may use), ``memory_gib``, ``system``,
        ``python``, ``versions`` by package, ``commit`` (empty outside a checkout; ``+`` at its end
        if files other than pages differ from it), ``command``, ``began`` (UTC, ISO 8601),
        ``load`` (of the last 1, 5 and 15 minutes, before the measurement).
    """
    return {
        "machine": platform.node(),
        "cpu": cpu_name(),
        "cpus": len(os.sched_getaffinity(0)),
        "memory_gib": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 2**30, 1),
        "system": platform.platform(),
        "python": platform.python_version(),
        "versions": {"sailenv_ros": __version__, **_versions()},
        "commit": _commit(Path(__file__).parent),
        "command": " ".join(command),
        "began": datetime.now(timezone.utc).isoformat(timespec="seconds"),
        "load": [round(value, 2) for value in os.getloadavg()],
    }


def cpu_name(cpuinfo: Path = Path("/proc/cpuinfo")) -> str:
    """Return the processor's name as the system tells it."""
    try:
        lines = cpuinfo.read_text(encoding="utf-8", errors="replace").splitlines()
    except OSError:
        lines = []
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or platform.machine())


def _versions() -> dict[str, str]:
    found = {}
    for package in PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return found


def _commit(folder: Path) -> str:
    try:
        commit = _git(folder, "rev-parse", "--short=12", "HEAD").strip()
        # A package that is installed inside a checkout is not that checkout's code.
        if not _git(folder, "ls-files", str(Path(__file__))).strip():
            return ""
        return commit + ("+" if _git(folder, *CHANGES).strip() else "")
    except (OSError, subprocess.SubprocessError):
        return ""


def _git(folder: Path, *words: str) -> str:
    done = subprocess.run(
        ["git", "-C", str(folder), *words],
        capture_output=True,
        text=True,
        check=True,
        timeout=10.0,
    )
    return done.stdout
