"""What `import sailenv_ros` gives, and what it costs."""

from __future__ import annotations

import pytest

import sailenv_ros
from tests.support.programs import run


def test_the_public_names_are_these() -> None:
    """A name that users may rely on comes and goes on purpose only."""
    assert sailenv_ros.__all__ == [
        "Agent",
        "AgentSpec",
        "Camera",
        "CameraIntrinsics",
        "Frame",
        "Pose",
        "RigCamera",
        "Simulation",
        "__version__",
        "export_asset",
        "export_scene",
        "load_calibration",
        "load_rig",
        "load_scene",
        "look_at",
        "show",
    ]
    assert all(getattr(sailenv_ros, name) is not None for name in sailenv_ros.__all__)
    assert set(sailenv_ros.__all__) <= set(dir(sailenv_ros))


def test_importing_the_package_imports_nothing_heavy() -> None:
    """ROS, OpenGL, physics and NumPy are imported when they are needed."""
    code = "import sys, sailenv_ros; print([m for m in {!r} if m in sys.modules])"
    assert run(code.format(("rclpy", "moderngl", "pybullet", "numpy"))) == "[]"


def test_importing_the_simulation_leaves_out_what_few_need() -> None:
    """Libraries of geometry, of models and of notebooks are imported where they are used."""
    few = ("scipy", "trimesh", "numba", "moderngl", "xatlas", "IPython", "aiohttp")
    code = "import sys, sailenv_ros; sailenv_ros.Simulation; "
    assert run(code + f"print([m for m in {few!r} if m in sys.modules])") == "[]"


def test_a_first_frame_needs_no_scipy() -> None:
    """Nor does opening the assets, people among them: importing it takes as long as the frame."""
    code = "import sys; from sailenv_ros import Simulation\n"
    code += "with Simulation('optical', width=64, height=48) as made: made.capture('rgb')\n"
    assert run(code + "print('scipy' in sys.modules)") == "False"


def test_the_simulation_needs_no_ros() -> None:
    """Simulator and scene loader can be had where there is no ROS."""
    code = "import sys, sailenv_ros; sailenv_ros.Simulation; sailenv_ros.load_scene; "
    assert run(code + "print('rclpy' in sys.modules)") == "False"


def test_without_ros_the_agent_says_what_is_missing() -> None:
    """The error names what is missing and how to get it."""
    code = """
import sys
sys.modules["rclpy"] = None
import sailenv_ros
try:
    sailenv_ros.Agent
except ImportError as error:
    print(error)
"""
    assert "needs ROS 2" in run(code)
    assert "rclpy" in run(code)


def test_an_unknown_name_is_an_ordinary_error() -> None:
    """The package behaves as any module does."""
    with pytest.raises(AttributeError, match="no attribute 'Agnt'"):
        _ = sailenv_ros.Agnt
