"""A command of `sailenv` that becomes a node: its options as ROS parameters."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from typing import NoReturn

from sailenv_ros.system.presence import checked_namespace

__all__ = ["become_node"]


def become_node(node: str, parameters: Mapping[str, object], *, namespace: str = "") -> NoReturn:
    """Replace this process by a node of this package.

    Parameters
    ----------
    node : str
        Name of its module.
    parameters : mapping
    namespace : str
        The node's; empty leaves its own.

    Raises
    ------
    InvalidRequest
        If ROS would not accept the namespace.
    """
    words = [sys.executable, "-m", f"sailenv_ros.ros.nodes.{node}", "--ros-args"]
    if namespace:
        words += ["-r", f"__ns:={checked_namespace(namespace)}"]
    for name, value in parameters.items():
        words += ["-p", f"{name}:={_yaml(value)}"]
    sys.stdout.flush()
    sys.stderr.flush()
    os.execv(sys.executable, words)


def _yaml(value: object) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    return f'"{value}"' if isinstance(value, str) else str(value)
