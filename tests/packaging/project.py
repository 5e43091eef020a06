"""The project's folder, and copies of what of it is needed to build it elsewhere."""

from __future__ import annotations

import shutil
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]

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
    "sailenv_msgs",
    "sailenv_msgs_py",
    "sailenv_ros",
    "scenes",
)


def copy_sources(folder: Path) -> Path:
    """Copy what is built from; so that no build leaves anything in the project's folder."""
    folder.mkdir(parents=True)
    for name in BUILT_FROM:
        source = ROOT / name
        if source.is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.so")
            shutil.copytree(source, folder / name, ignore=ignored)
        else:
            shutil.copy2(source, folder / name)
    return folder
