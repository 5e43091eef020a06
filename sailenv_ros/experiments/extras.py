"""Packages that only experiments need: imported where they are used, missed in one sentence."""

from __future__ import annotations

import importlib
from typing import Any

from sailenv_ros.errors import MissingPackage

__all__ = ["need"]

_INSTALL = {
    "matplotlib": "pip install 'sailenv_ros[bench]'",
    "onnxruntime": "pip install 'sailenv_ros[eval]'",
    "mujoco": "pip install 'sailenv_ros[bench]'",
    "torch": "pip install torch",
    "sailenv": "pip install 'sailenv_ros[bench]'",
}


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
        raise MissingPackage(purpose, package, _INSTALL[package]) from problem
