"""What the distribution is and what it installs, for pip and for colcon alike."""

import importlib.util
import os
import shutil
import sys
from glob import glob
from pathlib import Path

from setuptools import Extension, find_packages, setup
from setuptools.command.build_ext import build_ext

try:
    from setuptools.command.bdist_wheel import bdist_wheel
except ImportError:  # setuptools before 70.1, with which colcon installs and nobody makes wheels
    bdist_wheel = object

PACKAGE = "sailenv_ros"
PACKAGES = (PACKAGE, "sailenv_msgs_py", "sailenv_content", "sailenv_bench")

# No ROS here: the packages are ROS 2's own where it is installed, else the extra "ros".
REQUIREMENTS = [
    "aiohttp>=3.9",
    "glcontext>=3.0",
    # Compresses what clients of the gateway want gzipped, many times faster than zlib.
    "isal>=1.6",
    "lz4>=4.3",
    "mapbox-earcut>=1.0.3",
    "mcap>=1.2",
    "moderngl>=5.10",
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
    # Keywords of operations as typed dictionaries, for Python 3.10.
    "typing-extensions>=4.6",
    "zstandard>=0.22",
]
# The names with "jazzy" pin the others; the names without have newer versions of other releases.
ROS = [
    "sailenv-msgs",
    "ros-jazzy-action-msgs",
    "ros-jazzy-builtin-interfaces",
    "ros-jazzy-diagnostic-msgs",
    "ros-jazzy-geometry-msgs",
    "ros-jazzy-nav-msgs",
    "ros-jazzy-rcl-interfaces",
    "ros-jazzy-rclpy",
    "ros-jazzy-rmw-fastrtps-cpp",
    "ros-jazzy-rosgraph-msgs",
    "ros-jazzy-sensor-msgs",
    "ros-jazzy-std-msgs",
    "ros-jazzy-std-srvs",
    "ros-jazzy-stereo-msgs",
    "ros-jazzy-visualization-msgs",
]
# What only importing models and building the furniture pack need; reading packs does without.
ASSETS = [
    "coacd>=1.0.7",
    "OpenEXR>=3.3",
]
# What only baking light needs; light that was baked before is read without.
BAKE = ["xatlas>=0.0.9"]
# What only importing URDF, MJCF and USD scenes needs.
IMPORT = ["mujoco>=3.3", "usd-core>=25.5"]
# What the experiments compare with and draw with: `sailenv bench`, `report`, and `sailenv eval`.
# The SAILenv client, which is timed at the gateway and tested there, declares no dependencies.
BENCH = ["matplotlib>=3.8", "mujoco>=3.3", "PyOpenGL>=3.1", "sailenv==0.5b0"]
EVAL = ["matplotlib>=3.8", "onnxruntime>=1.17"]
# What some formats of data sets and remote places for them need, and the engine of many machines.
DATASET = ["fsspec>=2024.2", "h5py>=3.10", "pyarrow>=15"]
# What environments for agents need; several agents in one room need pettingzoo, too.
GYM = ["gymnasium>=1.0", "pettingzoo>=1.25"]
NOTEBOOK = ["ipykernel>=6.29", "jupyterlab>=4.2"]
RAY = ["fsspec>=2024.2", "pyarrow>=15", "ray>=2.40"]
DEV = [
    # The notebook among the examples is executed by a test.
    "ipykernel>=6.29",
    "nbclient>=0.10",
    "nbformat>=5.10",
    # The documentation, with an API reference from the docstrings.
    "mkdocs-material>=9.5",
    "mkdocstrings[python]>=0.26",
    "clang-format>=18",
    "clang-tidy>=18",
    "colcon-common-extensions",
    # Another ray tracer, which tests hold what is seen against.
    "embreex>=4.4.0",
    "hypothesis",
    "import-linter",
    "jsonschema",
    "matplotlib>=3.8",
    "mcap-ros2-support",
    # A server of S3's protocol on this machine, for the tests of data sets at remote places.
    "flask>=3.0",
    "flask-cors>=5.0",
    "fsspec>=2024.2",
    "gymnasium>=1.0",
    "h5py>=3.10",
    "moto[s3]>=5",
    "mujoco>=3.3",
    "mypy",
    "onnxruntime>=1.17",
    "pettingzoo>=1.25",
    # Drives Debian's Chromium, for the tests of the web viewer.
    "playwright>=1.40",
    "pyarrow>=15",
    "pycocotools",
    "pytest>=8.0",
    "pytest-timeout",
    "pytest-xdist",
    "ray>=2.40",
    "rosbags",
    "ruff",
    "s3fs>=2024.2",
    # The SAILenv client, which the gateway's tests drive; it declares no dependencies.
    "sailenv==0.5b0",
    "types-jsonschema",
    "types-PyYAML",
    "usd-core>=25.5",
]
CONFIG = ["yaml", "xml", "json", "rviz"]


def data_files() -> list[tuple[str, list[str]]]:
    """List what lies beside the code, by folder of the prefix."""
    share = f"share/{PACKAGE}"
    files = [
        ("share/ament_index/resource_index/packages", [f"resource/{PACKAGE}"]),
        (share, ["package.xml"]),
        (f"{share}/config", sorted(path for kind in CONFIG for path in glob(f"config/*.{kind}"))),
        (f"{share}/config/courses", sorted(glob("config/courses/*.yaml"))),
        (f"{share}/config/recipes", sorted(glob("config/recipes/*.yaml"))),
        (f"{share}/config/rooms", sorted(glob("config/rooms/*.yaml"))),
        (f"{share}/config/rooms/library", sorted(glob("config/rooms/library/*.yaml"))),
        (f"{share}/config/sensors", sorted(glob("config/sensors/*.yaml"))),
        (f"{share}/config/streams", sorted(glob("config/streams/*.yaml"))),
        (f"{share}/config/streams/pictures", sorted(glob("config/streams/pictures/*.png"))),
        (f"{share}/launch", sorted(glob("launch/*.launch.py"))),
        (f"{share}/scenes", sorted(glob("scenes/*.yaml") + glob("scenes/*.json"))),
    ]
    # pip ignores setup.cfg's install_scripts, colcon does not.
    if "bdist_wheel" in sys.argv:
        programs = [f"resource/{name}" for name in ("sim_node", "recorder", "player", "streamer")]
        files.append((f"lib/{PACKAGE}", programs))
    return files


def load_native_compile():
    """Load the module that compiles the native library, without importing the package."""
    path = Path(__file__).resolve().parent / PACKAGE / "native" / "compile.py"
    spec = importlib.util.spec_from_file_location("native_compile", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class BuildNativeLibrary(build_ext):
    """Compiles the native library where other packages compile modules for one Python.

    It is required: without a compiler nothing is built.
    """

    def get_ext_filename(self, fullname):
        # A plain library for ctypes: its name says nothing about a Python.
        return str(Path(*fullname.split(".")).with_suffix(".so"))

    def build_extension(self, extension):
        native_compile = load_native_compile()
        strict = bool(os.environ.get(native_compile.STRICT_VARIABLE))
        output = Path(self.get_ext_fullpath(extension.name))
        # scripts/setup has compiled it already, for this machine alone perhaps.
        compiled = Path(PACKAGE, "native", native_compile.LIBRARY_NAME)
        sets = {native_compile.own_instruction_set(compiled)} if self.editable_mode else None
        if native_compile.fits_sources(compiled, sets):
            if output.resolve() != compiled.resolve():
                output.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(compiled, output)
            return
        objects = Path(self.build_temp) / "native"
        native_compile.compile_library(output, objects=objects, strict=strict)


class BuildWheel(bdist_wheel):
    """Names the machine in the wheel's tag, and no Python: ctypes loads it in any of them."""

    def get_tag(self):
        return ("py3", "none", super().get_tag()[2])


setup(
    name=PACKAGE,
    version="0.2.0",
    description="A virtual visual environment: simulated rooms with exact per-pixel ground truth",
    long_description=Path("README.md").read_text(encoding="utf-8"),
    long_description_content_type="text/markdown",
    license="Apache-2.0",
    maintainer="sailenv_ros maintainers",
    maintainer_email="maintainers@users.noreply.github.com",
    packages=find_packages(include=[name for each in PACKAGES for name in (each, f"{each}.*")]),
    package_data={
        "sailenv_ros.dataset": ["preview/*"],
        # The lens and the law of light, which shaders include.
        "sailenv_ros.native": ["src/kernels/lens.h", "src/kernels/light_law.h"],
        "sailenv_ros.render.gl": ["shaders/*"],
        "sailenv_ros.viewer": ["page/*"],
        **{name: ["py.typed"] for name in PACKAGES},
    },
    ext_modules=[Extension("sailenv_ros.native.libsailenv_native", sources=[])],
    cmdclass={
        "build_ext": BuildNativeLibrary,
        **({} if bdist_wheel is object else {"bdist_wheel": BuildWheel}),
    },
    data_files=data_files(),
    python_requires=">=3.10",
    install_requires=REQUIREMENTS,
    extras_require={
        "ros": ROS,
        "assets": ASSETS,
        "bake": BAKE,
        "import": IMPORT,
        "bench": BENCH,
        "dataset": DATASET,
        "ray": RAY,
        "eval": EVAL,
        "gym": GYM,
        "notebook": NOTEBOOK,
        # Everything but ROS, which may be there already, and the tools for developers.
        "all": sorted({*ASSETS, *BAKE, *BENCH, *DATASET, *EVAL, *GYM, *IMPORT}),
        "dev": DEV,
    },
    entry_points={
        "console_scripts": [
            "sailenv = sailenv_ros.cli.main:main",
            "sim_node = sailenv_ros.ros.nodes.sim_node:main",
            "recorder = sailenv_ros.ros.nodes.recorder:main",
            "player = sailenv_ros.ros.nodes.player:main",
            "streamer = sailenv_ros.ros.nodes.streamer:main",
        ]
    },
    zip_safe=False,
)
