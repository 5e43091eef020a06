"""A lockstep simulator of a scene file, in a process of its own, and who is beside it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sailenv_ros import Agent
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


@contextmanager
def agent_in_scene(
    folder: Path, text: str, namespace: str, **parameters: object
) -> Iterator[Agent]:
    """Write `yard.yaml` into a folder and start its simulator; yield the agent that holds it."""
    (folder / "yard.yaml").write_text(text, encoding="utf-8")
    started: dict[str, object] = {"scene": "yard", "scene_paths": [str(folder)], **parameters}
    started |= {"mode": "lockstep", "agent.name": "", "gateway.port": 0, "viewer.port": 0}
    with Agent(
        width=64, height=48, following=False, namespace=namespace, simulator=started
    ) as agent:
        yield agent
