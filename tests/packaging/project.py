"""The project's folder, and copies of what of it is needed to build it elsewhere."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

ROS_IS_SOURCED = bool(os.environ.get("AMENT_PREFIX_PATH") and os.environ.get("ROS_DISTRO"))

BUILT_FROM = (
    "setup.py",
    "setup.cfg",
    "package.xml",
    "pyproject.toml",
    "README.md",
    "LICENSE",
    "colcon_defaults.yaml",
    "config",
    "launch",
    "resource",
    "sailenv_bench",
    "sailenv_content",
    "sailenv_msgs",
    "sailenv_msgs_py",
    "sailenv_ros",
    "scenes",
)


def copy_sources(folder: Path, *, compiled: bool = False) -> Path:
    """Copy the sources of a build, so that no build leaves anything in the project's folder.

    With `compiled` the native library comes along, if there is one: setup.py takes it where it fits
    the sources, and compiles otherwise.
    """
    folder.mkdir(parents=True)
    left_out = ("__pycache__",) if compiled else ("__pycache__", "*.so")
    for name in BUILT_FROM:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=shutil.ignore_patterns(*left_out))
        else:
            shutil.copy2(source, folder / name)
    return folder
