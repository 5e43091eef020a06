"""What the distribution is and what it installs, for pip and for colcon alike."""

import sys
from glob import glob
from pathlib import Path

from setuptools import find_packages, setup

PACKAGE = "sailenv_ros"

# No ROS here: the packages are ROS 2's own where it is installed, else the extra "ros".
REQUIREMENTS = [
    "aiohttp>=3.9",
    "coacd>=1.0.7",
    "embreex>=4.4.0",
    "glcontext>=3.0",
    # Compresses what clients of the gateway want gzipped, many times faster than zlib.
    "isal>=1.6",
    "lz4>=4.3",
    "mapbox-earcut>=1.0.3",
    "OpenEXR>=3.3",
    # Has no final release yet; compiled where it is installed, in some seconds.
    "meshoptimizer>=0.2.30a0",
    "mcap>=1.2",
    "moderngl>=5.10",
    "numba>=0.59",
    "numpy>=1.26",
    "opencv-python-headless>=4.8",
    "pillow>=10.1",
    # The module pybullet: the original has wheels up to Python 3.11, its fork those from 3.12 on.
    'pybullet>=3.2.6; python_version < "3.12"',
    'pybullet-arm64>=3.2.8; python_version >= "3.12"',
    "pydantic>=2.7",
    "PyYAML>=6.0",
    "rich>=13.0",
    "scipy>=1.11",
    "trimesh>=4.5",
    "xatlas>=0.0.9",
    "zstandard>=0.22",
]
# The names with "jazzy" pin the others; the names without have newer versions of other releases.
ROS = [
    "sailenv-msgs",
    "ros-jazzy-builtin-interfaces",
    "ros-jazzy-diagnostic-msgs",
    "ros-jazzy-geometry-msgs",
    "ros-jazzy-rcl-interfaces",
    "ros-jazzy-rclpy",
    "ros-jazzy-rmw-fastrtps-cpp",
    "ros-jazzy-rosgraph-msgs",
    "ros-jazzy-sensor-msgs",
    "ros-jazzy-std-msgs",
    "ros-jazzy-std-srvs",
]
# What the experiments compare with and draw with: `sailenv bench`, `report`, and `sailenv eval`.
# The original's client, which is timed at the gateway and tested there, declares no dependencies.
BENCH = ["matplotlib>=3.8", "mujoco>=3.3", "PyOpenGL>=3.1", "sailenv==0.5b0"]
EVAL = ["matplotlib>=3.8", "onnxruntime>=1.17"]
DEV = [
    "colcon-common-extensions",
    "hypothesis",
    "import-linter",
    "jsonschema",
    "matplotlib>=3.8",
    "mcap-ros2-support",
    "mypy",
    "onnxruntime>=1.17",
    # Drives Debian's Chromium, for the tests of the window.
    "playwright>=1.40",
    "pycocotools",
    "pytest>=8.0",
    "pytest-timeout",
    "pytest-xdist",
    "rosbags",
    "ruff",
    # The original's client, which the gateway's tests drive; it declares no dependencies.
    "sailenv==0.5b0",
    "types-jsonschema",
    "types-PyYAML",
]
CONFIG = ["yaml", "xml", "json", "rviz"]


def data_files() -> list[tuple[str, list[str]]]:
    """List what lies beside the code, by folder of the prefix."""
    share = f"share/{PACKAGE}"
    files = [
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (share, ["package.xml"]),
        (f"{share}/config", sorted(path for kind in CONFIG for path in glob(f"config/*.{kind}"))),
        (f"{share}/launch", sorted(glob("launch/*.launch.py"))),
        (f"{share}/scenes", sorted(glob("scenes/*.yaml") + glob("scenes/*.json"))),
    ]
    # pip ignores setup.cfg's install_scripts, colcon does not.
    if "bdist_wheel" in sys.argv:
        programs = ["resource/sim_node", "resource/recorder", "resource/player"]
        files.append((f"lib/{PACKAGE}", programs))
    return files


setup(
    name=PACKAGE,
    version="0.1.0",
    description="A virtual visual environment: simulated rooms with exact per-pixel ground truth",
    long_description=Path("README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    license="Apache-2.0",
    maintainer="sailenv_ros maintainers",
    maintainer_email="maintainers@users.noreply.github.com",
    packages=find_packages(include=["sailenv_ros", "sailenv_ros.*", "sailenv_msgs_py"]),
    package_data={
        "sailenv_ros": ["py.typed"],
        "sailenv_ros.render": ["shaders/*"],
        "sailenv_ros.viewer": ["page/*"],
        "sailenv_msgs_py": ["py.typed"],
    },
    data_files=data_files(),
    python_requires=">=3.10",
    install_requires=REQUIREMENTS,
    extras_require={"ros": ROS, "bench": BENCH, "eval": EVAL, "dev": DEV},
    entry_points={
        "console_scripts": [
            "sailenv = sailenv_ros.cli.main:main",
            "sim_node = sailenv_ros.nodes.sim_node:main",
            "recorder = sailenv_ros.nodes.recorder:main",
            "player = sailenv_ros.nodes.player:main",
        ]
    },
    zip_safe=False,
)
