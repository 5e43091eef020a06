"""Optional packages: imported where they are used, so that all the rest works without them.

Each belongs to an extra of the distribution (see setup.py). A missing one is one sentence, which
names the command that installs it.
"""

from __future__ import annotations

import importlib
from typing import Any

from sailenv_ros.errors import MissingPackage

__all__ = ["need"]

_EXTRA_OF = {
    "OpenEXR": "assets",
    "fsspec": "dataset",
    "gymnasium": "gym",
    "h5py": "dataset",
    "pettingzoo": "gym",
    "pxr": "import",
    "pyarrow": "dataset",
    "ray": "ray",
    "coacd": "assets",
    "matplotlib": "bench",
    "mujoco": "import",
    "onnxruntime": "eval",
    "sailenv": "bench",
    "xatlas": "bake",
}
"""Extra of the distribution that brings each package; others are installed by their own name."""

_DISTRIBUTION_OF = {"pxr": "usd-core"}
"""Distributions that are not named as the packages in them."""


def need(module: str, purpose: str) -> Any:
    """Import a module of an optional package.

    Parameters
    ----------
    module : str
        E.g. ``matplotlib.figure``.
    purpose : str
        What needs it, e.g. ``a plot``; begins the error's sentence.

    Raises
    ------
    MissingPackage
        If it is not installed; says how to install it.
    """
    package = module.partition(".")[0]
    try:
        return importlib.import_module(module)
    except ImportError as problem:
        name = _DISTRIBUTION_OF.get(package, package)
        wanted = f"'sailenv_ros[{_EXTRA_OF[package]}]'" if package in _EXTRA_OF else name
        raise MissingPackage(purpose, name, f"pip install {wanted}") from problem
