"""Pages beside a running node: every topic, service and parameter, and no other."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from sailenv_ros.ros.nodes.parameter_table import LIVE, PARAMETERS
from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess
from tests.support.waiting import until

pytestmark = pytest.mark.ros

ROOT = Path(__file__).parents[2]
PAGES = {"Topics": "interfaces.md", "Services": "services.md", "Parameters": "parameters.md"}
NAMESPACE = "/page"

OF_ROS = re.compile(r".*/sim_node/|/parameter_events$|/rosout$")
"""What every ROS node has."""


def table(heading: str) -> list[list[str]]:
    """Return the cells of the first table below a heading of the page, without its head."""
    text = (ROOT / "docs" / PAGES[heading]).read_text()
    section = text.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in row[1:-1].split("|")] for row in rows[2:]]


def full_name(name: str) -> str:
    """Return a name of a table as the node has it."""
    name = name.strip("`").replace("<agent>", "agent")
    return name if name.startswith("/") else f"{NAMESPACE}/{name}"


def topics_of_the_page() -> dict[str, str]:
    """Return the topics with their types, as ROS spells them."""
    found: dict[str, str] = {}
    for names, type_, about in table("Topics"):
        if "of a rectified [rig]" in about:
            continue  # this simulator has none
        package, _, word = type_.strip("`").partition("/")
        found |= {full_name(name): f"{package}/msg/{word}" for name in names.split(", ")}
    return found


def services_of_the_page() -> dict[str, str]:
    """Return the services with their types, which follow from the names but for one."""
    found = {}
    names = [name for _, names, _ in table("Services") for name in names.split(", ")]
    for name in names:
        word = name.strip("`").rpartition("/")[2].title().replace("_", "")
        word = "GetDisplayNames" if word == "SpawnableDisplayNames" else word
        found[full_name(name)] = f"sailenv_msgs/srv/{word}"
    assert len(found) == len(names)
    return found


@pytest.fixture(scope="module")
def probe() -> Iterator[Probe]:
    """A participant beside a simulator as it starts by itself."""
    with NodeProcess(NAMESPACE, publish_clock=True), Probe(NAMESPACE) as probe:
        yield probe


def offered(ask: Callable[[str, str], Any], expected: dict[str, str]) -> dict[str, str]:
    """Ask the graph until it has everything that is expected; return all that is there."""
    found: dict[str, str] = {}

    def all_there() -> bool:
        try:
            pairs = ask("sim_node", NAMESPACE)
        except Exception:  # the node is not known yet
            return False
        found.update({name: types[0] for name, types in pairs if not OF_ROS.match(name)})
        return expected.keys() <= found.keys()

    until(all_there, f"all of {sorted(expected)}")
    return found


def test_the_page_has_every_topic_and_service(probe: Probe) -> None:
    """Names and types are those of the node."""
    topics, services = topics_of_the_page(), services_of_the_page()
    assert offered(probe.node.get_publisher_names_and_types_by_node, topics) == topics
    found = offered(probe.node.get_service_names_and_types_by_node, services)
    assert {name: type_ for name, type_ in found.items() if "sim_node" not in name} == services


def shown_range(entry: Any) -> str:
    if entry.choices and not isinstance(entry.default, list):
        return ", ".join(f"`{choice}`" for choice in entry.choices)
    if entry.bounds is None:
        return ""
    low, high = entry.bounds.least, entry.bounds.most
    return f"{low:g} … {'2⁶³ − 1' if high == 2**63 - 1 else f'{high:g}'}"


def shown_default(value: object) -> str:
    if isinstance(value, list | str):
        parts = [value] if isinstance(value, str) else value
        return ", ".join(f"`{part}`" for part in parts if part)
    return str(value).lower()


def test_the_page_has_every_parameter() -> None:
    """Type, default, range and whether it is live are those that the node declares."""
    types = {bool: "bool", int: "integer", float: "double", str: "string", list: "string_array"}
    expected = {
        name: (types[type(entry.default)], shown_default(entry.default), shown_range(entry))
        for name, entry in PARAMETERS.items()
    }
    rows = {name.strip("`"): tuple(cells) for name, *cells in table("Parameters")}
    assert {name: row[:3] for name, row in rows.items()} == expected
    assert {name for name, row in rows.items() if "*live*" in row[3]} == set(LIVE)


def flattened(entries: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Return a tree of parameters by their full names, as ROS reads it from a file."""
    flat: dict[str, Any] = {}
    for name, value in entries.items():
        flat |= (
            flattened(value, f"{prefix}{name}.")
            if isinstance(value, dict)
            else {prefix + name: value}
        )
    return flat


def test_the_file_of_parameters_has_every_one_with_its_default() -> None:
    """`config/sim_node.yaml`, where an empty list has to be written as one empty text."""
    file = yaml.safe_load((ROOT / "config" / "sim_node.yaml").read_text())
    found = flattened(file["/**"]["ros__parameters"])
    declared = {name: entry.default for name, entry in PARAMETERS.items()}
    assert {name: [] if value == [""] else value for name, value in found.items()} == {
        name: [] if default == [""] else default for name, default in declared.items()
    }
