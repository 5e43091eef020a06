"""Packages of ROS 2 that PyPI lacks, built of definitions of our own."""

from __future__ import annotations

import importlib.util
import json
import sys
from pathlib import Path

import pytest

from tests.packaging.project import ROOT, ROS_IS_SOURCED

pytestmark = pytest.mark.ros

DEFINITIONS = ROOT / "sailenv_msgs" / "ros_interfaces"
HASHES = ROOT / "tests" / "data" / "ros_interface_hashes.json"
"""Of tf2_msgs 0.36.4, vision_msgs 4.1.1 and simulation_interfaces 1.5.1, built of their sources."""


@pytest.mark.skipif(
    ROS_IS_SOURCED, reason="the packages of an installed ROS 2 are used as they are"
)
def test_their_types_are_those_of_ros_2() -> None:
    """Each type hash (REP 2016) is that of the original, so that both ends of a topic match."""
    found = {}
    for path in DEFINITIONS.glob("*/*/*.*"):
        package, kind, file = path.parts[-3:]
        name = f"{package}/{kind}/{Path(file).stem}"
        described = Path(sys.prefix, "share", name).with_suffix(".json")
        assert importlib.util.find_spec(package) is not None
        hashes = json.loads(described.read_text(encoding="utf-8"))["type_hashes"]
        (found[name],) = (one["hash_string"] for one in hashes if one["type_name"] == name)
    assert found == json.loads(HASHES.read_text(encoding="utf-8"))
