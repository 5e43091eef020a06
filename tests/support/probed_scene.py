"""A lockstep simulator of a scene file, in a process of its own, and a participant beside it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess


@contextmanager
def probed_scene(folder: Path, text: str, namespace: str) -> Iterator[Probe]:
    """Write the scene file into a folder and start its simulator; yield the participant."""
    path = folder / "probed.yaml"
    path.write_text(text, encoding="utf-8")
    process = NodeProcess(namespace, mode="lockstep", scene=str(path))
    with process, Probe(namespace) as probe:
        yield probe
