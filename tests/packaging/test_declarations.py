"""What the project says about itself in several places says the same."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
from importlib.metadata import requires, version
from pathlib import Path
from xml.etree import ElementTree

import pytest
from packaging.requirements import Requirement

import sailenv_ros
from tests.packaging.project import ROOT

PYTHONS = ("3.10", "3.11", "3.12", "3.13")


def test_the_version_is_one() -> None:
    """The package, its two manifests and the interface package carry the same version."""
    found = {
        "sailenv_ros": sailenv_ros.__version__,
        "setup.py": re.findall(r'version="(.*)"', (ROOT / "setup.py").read_text())[0],
        "package.xml": _manifest(ROOT).findtext("version"),
        "sailenv_msgs/package.xml": _manifest(ROOT / "sailenv_msgs").findtext("version"),
        "sailenv_msgs/pyproject.toml": re.findall(
            r'^version = "(.*)"', (ROOT / "sailenv_msgs/pyproject.toml").read_text(), re.MULTILINE
        )[0],
    }
    assert len(set(found.values())) == 1, found


def test_every_ros_package_that_is_imported_is_declared() -> None:
    """What the code imports of ROS stands in package.xml, so that rosdep can bring it."""
    declared = {element.text for element in _manifest(ROOT).iter("depend")}
    imported = _imported_ros_packages()
    assert "rclpy" in imported
    assert imported <= declared


def test_messages_declare_what_they_use() -> None:
    """Each package that a field's type is of stands in sailenv_msgs/package.xml."""
    declared = {element.text for element in _manifest(ROOT / "sailenv_msgs").iter("depend")}
    text = "\n".join(path.read_text() for path in _definitions())
    assert set(re.findall(r"^(\w+)/\w+", text, re.MULTILINE)) - {"sailenv_msgs"} <= declared


@pytest.mark.parametrize("python", PYTHONS)
def test_every_requirement_is_pinned(python: str) -> None:
    """Set-up installs the same versions everywhere, for each Python that is supported."""
    environment = {"python_version": python, "python_full_version": f"{python}.0", "extra": ""}
    pinned = {
        pin.name.lower()
        for pin in map(Requirement, _lines(ROOT / "constraints.txt"))
        if pin.marker is None or pin.marker.evaluate(environment)
    }
    wanted = {
        requirement.name.lower()
        for requirement in map(Requirement, requires("sailenv_ros") or [])
        if requirement.marker is None
        or any(
            requirement.marker.evaluate(environment | {"extra": extra})
            for extra in ("", "ros", "assets", "bake", "bench", "eval", "notebook", "all", "dev")
        )
    }
    assert len(wanted) > 20
    assert wanted - pinned == {"sailenv-msgs"}


def test_every_field_of_an_interface_is_explained() -> None:
    """Unit, frame and special values stand on the field's own line."""
    bare = [
        f"{path.name}: {line}"
        for path in _definitions()
        for line in _lines(path, keep_comments=True)
        if not line.startswith(("#", "---")) and "#" not in line
    ]
    assert bare == []


def test_every_service_answers_in_the_same_way() -> None:
    """A client may look at success, code, message and revision whatever it asked."""
    services = [path for path in _definitions() if path.suffix == ".srv"]
    assert len(services) > 20
    for path in services:
        answer = path.read_text().split("---\n")[1].splitlines()
        assert [line.split()[:2] for line in answer[:4]] == [
            ["bool", "success"],
            ["uint8", "code"],
            ["string", "message"],
            ["uint32", "revision"],
        ], path.name


def _manifest(folder: Path) -> ElementTree.Element:
    return ElementTree.parse(folder / "package.xml").getroot()


def _definitions() -> list[Path]:
    return sorted((ROOT / "sailenv_msgs").glob("*/*.*"))


def _lines(path: Path, *, keep_comments: bool = False) -> list[str]:
    lines = [line.strip() for line in path.read_text().splitlines()]
    return [line for line in lines if line and (keep_comments or not line.startswith("#"))]


def _imported_ros_packages() -> set[str]:
    names: set[str] = set()
    for path in [*ROOT.glob("sailenv_ros/**/*.py"), *ROOT.glob("sailenv_msgs_py/*.py")]:
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module.partition(".")[0])
    return {name for name in names if re.fullmatch(r"rclpy|\w+_(msgs|srvs|interfaces)", name)}


@pytest.mark.parametrize("name", ["constraints", "constraints-jazzy"])
def test_every_pin_has_hashes(name: str) -> None:
    """The file that uv reads pins what the file that pip reads does, and holds it to hashes."""
    hashed = (ROOT / f"{name}-hashes.txt").read_text().replace(" \\\n    --hash=", " --hash=")
    pins = [line for line in hashed.splitlines() if not line.startswith("#")]
    assert all(re.search(r" --hash=sha256:[0-9a-f]{64}$", pin) for pin in pins)
    assert [pin.partition(" --hash=")[0] for pin in pins] == _lines(ROOT / f"{name}.txt")


def test_the_bill_of_materials_lists_what_is_installed() -> None:
    """Each package once, those that were fetched with hashes; the same bytes each time."""
    words = [sys.executable, str(ROOT / "scripts" / "sbom.py")]
    told, again = (subprocess.run(words, capture_output=True, check=True).stdout for _ in "ab")
    assert told == again
    document = json.loads(told)
    assert (document["bomFormat"], document["specVersion"]) == ("CycloneDX", "1.6")
    assert document["metadata"]["component"]["name"] == "sailenv-ros"
    by_name = {one["name"]: one for one in document["components"]}
    assert len(by_name) == len(document["components"])
    assert by_name["numpy"]["version"] == version("numpy")
    assert by_name["numpy"]["purl"] == f"pkg:pypi/numpy@{version('numpy')}"
    assert by_name["numpy"]["externalReferences"][0]["hashes"]
