"""What is shipped in config/ for recordings: layouts with topics that exist, all parameters."""

from __future__ import annotations

import json
import re

import pytest
import yaml

from sailenv_ros.recording.channels import AGENT_TOPICS
from sailenv_ros.ros.nodes.parameter_table import Parameter
from sailenv_ros.ros.nodes.player import PARAMETERS as PLAYER
from sailenv_ros.ros.nodes.recorder import PARAMETERS as RECORDER
from sailenv_ros.ros.nodes.streamer import PARAMETERS as STREAMER
from sailenv_ros.system.resources import resource_path

pytestmark = pytest.mark.ros

KNOWN = {f"/sailenv/agent/{name}" for name in AGENT_TOPICS} | {"/sailenv/scene_info"}


def panels(layout: object) -> set[str]:
    """Return the names of the panels that a layout places."""
    if isinstance(layout, str):
        return {layout}
    assert isinstance(layout, dict)
    return panels(layout["first"]) | panels(layout["second"])


def test_the_foxglove_layout_fits_our_topics() -> None:
    """Every panel is placed, and every topic exists."""
    text = (resource_path("config") / "foxglove_layout.json").read_text()
    layout = json.loads(text)
    assert panels(layout["layout"]) == set(layout["configById"])
    topics = set(re.findall(r"/sailenv/[a-z_/]+", text))
    assert topics <= KNOWN
    assert {f"/sailenv/agent/{view}" for view in ("rgb", "depth", "category", "instance")} <= topics


def test_the_rviz_configuration_fits_our_topics() -> None:
    """It is YAML, its displays have our topics, and its fixed frame is the world."""
    config = yaml.safe_load((resource_path("config") / "sailenv.rviz").read_text())
    manager = config["Visualization Manager"]
    topics = {d["Topic"]["Value"] for d in manager["Displays"] if "Topic" in d}
    assert topics <= {*KNOWN, "/sailenv/agent/points"}
    assert len(topics) == 6
    assert manager["Global Options"]["Fixed Frame"] == "world"


@pytest.mark.parametrize(
    ("file", "table"),
    [("recorder.yaml", RECORDER), ("player.yaml", PLAYER), ("streamer.yaml", STREAMER)],
)
def test_the_parameter_files_have_every_default(file: str, table: dict[str, Parameter]) -> None:
    """The shipped files name every parameter of their node, with the value that it has."""
    shipped = yaml.safe_load((resource_path("config") / file).read_text())
    defaults = {name: entry.default for name, entry in table.items()}
    assert shipped == {"/**": {"ros__parameters": defaults}}
