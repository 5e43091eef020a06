"""The Python of the pages: whole programs run as they stand, fragments fit what they call."""

from __future__ import annotations

import ast
import importlib
import inspect
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml
from pydantic import ValidationError

from sailenv_ros.ros.client.agent import Agent
from sailenv_ros.ros.client.recorded import RecordedAgent
from sailenv_ros.scene.fields import BROKEN_RULE
from sailenv_ros.scene.spec import SceneSpec
from sailenv_ros.scene.yaml_nodes import compose
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.operations import Operation
from tests.packaging.pages import blocks
from tests.support.faults import faults_of

PROGRAMS = dict(blocks("python"))
FRAGMENTS = dict(blocks("py"))

OF_ROS = {place: code for place, code in PROGRAMS.items() if "import Agent\n" in code}
MODULES = {place: code for place, code in PROGRAMS.items() if code.startswith("# my_")}
HERE = {place: code for place, code in PROGRAMS.items() if place not in OF_ROS | MODULES}

PRINTED = {
    "README.md": r"\(480, 640, 2\) 33333333\n",
    "docs/motion.md": r"(\(480, 640, 2\) \(480, 640, 3\) 0.267 s|\(3, 20, 2\))(?!.*False)",
}
"""What programs of some pages print, besides running to their end."""


@pytest.mark.gl
@pytest.mark.parametrize("place", HERE)
def test_a_program_runs(
    place: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """In this process, without ROS; it prints something or leaves a file."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["program"])
    capsys.readouterr()
    exec(compile(HERE[place], place, "exec"), {"__name__": "__main__"})
    out = capsys.readouterr().out
    assert out or any(tmp_path.iterdir()) or "sample_cameras" in HERE[place]
    assert re.match(PRINTED.get(place.partition(":")[0], ""), out, re.DOTALL)


def run(*command: str, folder: Path) -> str:
    """Run Python as a program of its own; return what it prints."""
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(folder), *filter(None, sys.path)]),
    }
    done = subprocess.run(
        [sys.executable, *command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=110,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.ros
@pytest.mark.parametrize("place", OF_ROS)
def test_a_program_with_an_agent_runs(place: str, tmp_path: Path) -> None:
    """It starts a simulator; the README's prints what the page says."""
    out = run("-c", OF_ROS[place], folder=tmp_path)
    assert "instance (" in out
    if place.startswith("README"):
        (shown,) = (text for where, text in blocks("text") if where.startswith("README"))
        assert out == shown


@pytest.mark.gl
def test_the_module_of_a_behaviour_moves_an_object(tmp_path: Path) -> None:
    """As the page names it in a scene file."""
    ((_, module),) = MODULES.items()
    (tmp_path / "my_moves.py").write_text(module)
    (behaviours,) = (
        yaml.safe_load(text)
        for place, text in blocks("yaml")
        if place.startswith("docs/behaviours.md") and "my_moves" in text
    )
    scene = {
        "version": 1,
        "objects": [{"name": "box", "asset": "cube", "gravity": False, **behaviours}],
    }
    (tmp_path / "bobbing.yaml").write_text(yaml.safe_dump(scene))
    program = """
from sailenv_ros import Simulation
with Simulation("bobbing.yaml", mode="lockstep", allow_modules=True) as simulation:
    simulation.step(60)
    print(simulation.get_object("box").linear_velocity[2])
"""
    assert float(run("-c", program, folder=tmp_path)) != 0.0


def test_fragments_fit_what_they_call() -> None:
    """Imports are there, and what is called of an agent or a simulation has these arguments."""
    assert faults_of(check_fragment, FRAGMENTS) == {}


def check_fragment(code: str) -> None:
    """Look up what it imports, and bind what it calls."""
    for node in ast.walk(ast.parse(code)):
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("sailenv_"):
            module = importlib.import_module(str(node.module))
            for alias in node.names:  # a name of the module, or a module below it
                if not hasattr(module, alias.name):
                    importlib.import_module(f"{node.module}.{alias.name}")
    for call, name, attribute in calls(code):
        for kind in CLASSES[name]:
            check(call, getattr(kind, attribute))


CLASSES: dict[str, tuple[type, ...]] = {
    "agent": (Agent,),
    "recording": (RecordedAgent,),
    "simulation": (Simulation,),
    "env": (Agent, Simulation),
}
"""Classes of the objects that have these names in fragments."""


def calls(code: str) -> Iterator[tuple[ast.Call, str, str]]:
    """Yield the calls of methods of such objects, with the names of both."""
    if "from sailenv." in code:  # the client of others
        return
    for node in ast.walk(ast.parse(code)):
        if not isinstance(node, ast.Call):
            continue
        called = node.func
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
            name = called.value.id
            yield from [(node, name, called.attr)] if name in CLASSES else ()


def check(call: ast.Call, member: Any) -> None:
    """Bind a call to the signature of what it calls; values are not looked at."""
    function = member.run if isinstance(member, Operation) else member
    core_or_self = None
    named = {str(keyword.arg): None for keyword in call.keywords}
    inspect.signature(function).bind(core_or_self, *call.args, **named)


PARTS = {
    place: text
    for place, text in blocks("yaml")
    if re.match(r"docs/(scene_|behaviours|joints|randomisation)", place)
    and "assets:" not in text
    and not text.startswith(" ")
}


def test_parts_of_scene_files_are_such() -> None:
    """Keys and values are those of the format; they may name what only a whole scene has."""
    assert faults_of(check_part, PARTS) == {}


def check_part(text: str) -> None:
    """Read it as a scene."""
    node, problems = compose(text)
    assert node is not None
    assert problems == []
    assert broken_keys({"version": 1, **node.plain()}) == []


def broken_keys(scene: dict[str, Any]) -> list[str]:
    """Return what is wrong with a scene, rules between its parts left out."""
    try:
        SceneSpec.model_validate(scene)
    except ValidationError as problem:
        return [str(error) for error in problem.errors() if error["type"] != BROKEN_RULE]
    return []


def test_there_is_python_of_each_kind() -> None:
    """The tests above have something to look at."""
    assert len(HERE) >= 12
    assert len(OF_ROS) >= 2
    assert len(FRAGMENTS) >= 12
    assert len(PARTS) >= 10
