"""What is shipped works where it is installed: by pip in a new venv, by colcon in a workspace."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

from tests.packaging.project import ROOT, ROS_IS_SOURCED, copy_sources
from tests.packaging.started_node import assert_publishes

pytestmark = [pytest.mark.slow, pytest.mark.ros, pytest.mark.timeout(2400)]

SCRIPTS = Path(sys.prefix) / "bin"

OURS = ("PYTHONPATH", "VIRTUAL_ENV", "SAILENV_INSTALLED_PREFIX")
BOOTSTRAPPED = ("LD_LIBRARY_PATH", "_ROS_WHEELS_BOOTSTRAP_COMPLETE")
"""Set by the ROS 2 wheels for this interpreter; another one has to do it anew."""


FETCH = """
set -e
eval "$("$0" "$1/scripts/uv_settings.py")"
(cd "$1" && "$0" scripts/requirements.py ros) > needed.txt
"$(dirname "$0")/uv" pip install --python "$2" --constraint "$1/constraints.txt" -r needed.txt
"""
"""Fetches what is required as scripts/setup does, much faster than pip, which then finds it."""


def run(*command: str | Path, folder: Path, environment: dict[str, str]) -> str:
    """Run a step of a build; its output is shown if it fails."""
    done = subprocess.run(
        [str(word) for word in command],
        cwd=folder,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert done.returncode == 0, f"{command}:\n{done.stdout[-6000:]}"
    return done.stdout


def without(*names: str) -> dict[str, str]:
    """Return this process's environment without some variables."""
    return {name: value for name, value in os.environ.items() if name not in names}


def test_the_wheel_holds_all_that_is_needed(tmp_path: Path) -> None:
    """Every module, shader, scene and configuration file, and an executable for ros2 run."""
    sources = copy_sources(tmp_path / "sources", compiled=True)
    pip = (sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation")
    run(*pip, "--wheel-dir", tmp_path, sources, folder=tmp_path, environment=without(*OURS))
    (path,) = tmp_path.glob("*.whl")
    with zipfile.ZipFile(path) as wheel:
        held = {info.filename: info for info in wheel.infolist()}
    data = f"{path.name.rsplit('-', 3)[0]}.data/data"
    for folder in ("sailenv_ros", "sailenv_msgs_py"):
        for source in (ROOT / folder).rglob("*"):
            left_out = (
                "__pycache__" in source.parts
                or source.suffix in (".txt", ".cpp", ".h")
                or source.name == "tsconfig.json"  # for editors and scripts/page-types
            )
            if source.is_file() and not left_out:
                assert str(source.relative_to(ROOT)) in held
    # Shaders include them.
    assert "sailenv_ros/native/src/kernels/lens.h" in held
    assert "sailenv_ros/native/src/kernels/light_law.h" in held
    for pattern in (
        "scenes/*.yaml",
        "scenes/*.json",
        "config/**/*.yaml",
        "config/*.xml",
        "config/*.json",
        "config/*.rviz",
        "launch/*.py",
    ):
        for source in ROOT.glob(pattern):
            assert f"{data}/share/sailenv_ros/{source.relative_to(ROOT)}" in held
    assert f"{data}/share/ament_index/resource_index/packages/sailenv_ros" in held
    assert f"{data}/share/sailenv_ros/package.xml" in held
    for program in ("sim_node", "recorder", "player", "streamer"):
        assert held[f"{data}/lib/sailenv_ros/{program}"].external_attr >> 16 & 0o111 == 0o111
    assert not any(name.startswith("tests/") for name in held)
    # One wheel for all Pythons of this machine, with the compiled kernels in it.
    assert path.name.rsplit("-", 3)[1:3] == ["py3", "none"]
    assert "sailenv_ros/native/libsailenv_native.so" in held


def test_without_a_compiler_the_build_says_what_is_missing(tmp_path: Path) -> None:
    """The native library is required: there is no wheel without it."""
    sources = copy_sources(tmp_path / "sources")
    pip = (sys.executable, "-m", "pip", "wheel", "-v", "--no-deps", "--no-build-isolation")
    done = subprocess.run(
        [*pip, "--wheel-dir", tmp_path, sources],
        cwd=tmp_path,
        env=without(*OURS) | {"CXX": "there-is-no-such-compiler"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    assert done.returncode != 0
    assert "there is no C++ compiler (there-is-no-such-compiler)" in done.stdout
    assert not [*tmp_path.glob("*.whl")]


def test_colcon_builds_a_workspace_whose_node_runs(tmp_path: Path) -> None:
    """Both packages are found by the defaults file; the node runs from where ros2 run looks.

    The messages are those that scripts/setup has built by the same CMakeLists.txt: one minute of
    generators, which would say nothing new.
    """
    copy_sources(tmp_path / "src" / "sailenv_ros", compiled=True)
    environment = without(*OURS) | {
        "COLCON_DEFAULTS_FILE": "src/sailenv_ros/colcon_defaults.yaml",
        "PATH": f"{SCRIPTS}{os.pathsep}{os.environ['PATH']}",
    }
    if not ROS_IS_SOURCED:
        # The wheels are a prefix like any other, only that nothing was sourced.
        environment |= {"AMENT_PREFIX_PATH": sys.prefix, "CMAKE_PREFIX_PATH": sys.prefix}
    listed = run(SCRIPTS / "colcon", "list", "-n", folder=tmp_path, environment=environment)
    assert listed.split() == ["sailenv_msgs", "sailenv_ros"]
    run(
        *(SCRIPTS / "colcon", "build", "--event-handlers", "console_direct+"),
        *("--packages-ignore", "sailenv_msgs"),
        folder=tmp_path,
        environment=environment,
    )
    install = tmp_path / "install"
    node = install / "sailenv_ros" / "lib" / "sailenv_ros" / "sim_node"
    index = install / "sailenv_ros" / "share" / "ament_index" / "resource_index" / "packages"
    assert (index / "sailenv_ros").is_file()
    in_workspace = ["bash", "-c", f'source "{install}/local_setup.bash"; exec "$0" "$@"']
    where = "import sailenv_ros; print(sailenv_ros.__file__)"
    imported = run(
        *in_workspace, sys.executable, "-c", where, folder=tmp_path, environment=environment
    )
    assert Path(imported.strip()).is_relative_to(install), imported
    assert_publishes(
        [*in_workspace, str(node)], environment=environment, folder=tmp_path, namespace="/colcon"
    )


@pytest.mark.skipif(ROS_IS_SOURCED, reason="the packages of an installed ROS 2 are not pip's")
def test_pip_installs_into_a_new_venv_where_the_node_runs(tmp_path: Path) -> None:
    """`pip install` of both folders is all that is needed; the node runs from both its places."""
    sources = copy_sources(tmp_path / "sources", compiled=True)
    environment = without(*OURS, *BOOTSTRAPPED, "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH")
    venv = tmp_path / "venv"
    python = venv / "bin" / "python"
    run(
        sys.executable,
        "-m",
        "venv",
        "--without-pip",
        venv,
        folder=tmp_path,
        environment=environment,
    )
    run("bash", "-c", FETCH, sys.executable, ROOT, python, folder=tmp_path, environment=environment)
    # The wheel that scripts/setup built; pip would fetch all that building it needs anew.
    run(ROOT / "scripts" / "build-messages", tmp_path, folder=tmp_path, environment=environment)
    (messages,) = tmp_path.glob("sailenv_msgs-*.whl")
    pip = (sys.executable, "-m", "pip", "--python", python)
    run(
        *(*pip, "install", "--no-compile"),
        *("--constraint", ROOT / "constraints.txt", messages, f"{sources}[ros]"),
        folder=tmp_path,
        environment=environment,
    )
    run(*pip, "check", folder=tmp_path, environment=environment)
    for place in ("bin", "lib/sailenv_ros"):
        assert_publishes(
            [str(venv / place / "sim_node")],
            environment=environment,
            folder=tmp_path,
            namespace=f"/pip_{place.partition('/')[0]}",
        )
    doctor = run(venv / "bin" / "sailenv", "doctor", folder=tmp_path, environment=environment)
    assert "Frames can be rendered" in doctor
