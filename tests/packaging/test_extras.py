"""What only baking and importing need may be missing: scenes and packs are rendered without it."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from sailenv_ros.extras import _DISTRIBUTION_OF, _EXTRA_OF
from tests.packaging.project import ROOT

OPTIONAL = sorted(package for package, extra in _EXTRA_OF.items() if extra in ("assets", "bake"))

WITHOUT = f"""
import sys
for name in {OPTIONAL!r}:
    sys.modules[name] = None  # importing it fails, as where it is not installed
sys.path.append({str(ROOT)!r})  # for tests.support
"""


def run(code: str, *arguments: str | Path) -> str:
    """Run a program of its own in a Python without the optional packages; return its output."""
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT + code, *map(str, arguments)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def declared() -> dict[str, set[str]]:
    """Return the packages of each extra, as setup.py declares them."""
    lists = {
        node.targets[0].id: ast.literal_eval(node.value)  # type: ignore[attr-defined]  # a name
        for node in ast.parse((ROOT / "setup.py").read_text()).body
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.List)
    }
    return {
        name.lower(): {Requirement(line).name for line in lines} for name, lines in lists.items()
    }


def test_every_optional_package_is_in_the_extra_that_its_error_names() -> None:
    """The command in the sentence installs what is missing; nothing optional is required."""
    extras = declared()
    for package, extra in _EXTRA_OF.items():
        assert _DISTRIBUTION_OF.get(package, package) in extras[extra], package
    assert not set(OPTIONAL) & extras["requirements"]
    assert len(OPTIONAL) == 3


@pytest.mark.gl
def test_built_in_scenes_are_rendered_without_them() -> None:
    """A simulation in process: something is seen, and it has an id."""
    out = run(
        """
from sailenv_ros import Simulation
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics
for scene in ("optical", "solid_benchmark"):
    with Simulation(scene, mode="lockstep") as simulation:
        agents = simulation.info.agents or (simulation.register_agent(
            AgentSpec(name="eye", intrinsics=CameraIntrinsics(width=64, height=48))
        ),)
        views = simulation.capture(["rgb", "instance"], agent=agents[0].name).views
        print(scene, views["rgb"].std() > 1, views["instance"].max() > 0)
"""
    )
    assert out.splitlines() == ["optical True True", "solid_benchmark True True"]


def test_a_pack_is_read_without_them(tmp_path: Path) -> None:
    """A model that was written as a pack stores it is read, with its collision pieces."""
    out = run(
        """
from pathlib import Path
import numpy as np
from sailenv_ros.assets.glb import glb_bytes, read_glb
from sailenv_ros.types.model import ConvexShape
from tests.support.bake_scenes import ground
file = Path(sys.argv[1]) / "one.glb"
corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
file.write_bytes(glb_bytes(ground(1.0).parts, [ConvexShape(points=corners)]))
parts, hulls = read_glb(file)
print(len(parts), len(hulls))
""",
        tmp_path,
    )
    assert out.split() == ["1", "1"]


SENTENCES = {
    "baking light needs xatlas, which is not installed: pip install 'sailenv_ros[bake]'": """
from sailenv_ros.light.bake.pipeline import bake
from tests.support.bake_scenes import ground, still
from tests.support.tiny_scenes import Thing
bake(still([Thing(ground(1.0))]))
""",
    "importing a model needs coacd, which is not installed: pip install 'sailenv_ros[assets]'": """
from sailenv_ros.assets.hulls import convex_parts
from sailenv_ros.assets.meshes import RawMesh
from tests.support.bake_scenes import ground
mesh = ground(1.0).parts[0].mesh
convex_parts(RawMesh(positions=mesh.positions, uvs=mesh.uvs, triangles=mesh.triangles))
""",
    "building the furniture pack needs coacd, which is not installed: "
    "pip install 'sailenv_ros[assets]'": """
from sailenv_content.standard.pack_build import build_standard_pack
build_standard_pack()
""",
}


def test_who_needs_one_is_told_in_a_sentence() -> None:
    """What needs it, what it is, how to install it."""
    code = f"""
from sailenv_ros.errors import MissingPackage
for attempt in {list(SENTENCES.values())!r}:
    try:
        exec(attempt)
    except MissingPackage as missing:
        print(missing)
"""
    assert run(code).splitlines() == list(SENTENCES)
