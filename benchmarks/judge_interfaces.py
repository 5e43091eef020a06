"""Build ROS's own definitions, compare their type hashes with ours, and serve a version of them.

    python benchmarks/judge_interfaces.py FOLDER [--tests]

FOLDER has clones of packages whose definitions are in `sailenv_msgs/ros_interfaces`, at whichever
version: ros-simulation/simulation_interfaces, `tf2_msgs` of ros2/geometry2, `vision_msgs` of
ros-perception/vision_msgs. With `--tests` those of the standard interfaces run against that version
of `simulation_interfaces`: 2.1 has other fields than 1.5, which is built here.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
OURS = ROOT / "sailenv_msgs" / "ros_interfaces"
KINDS = ("msg", "srv", "action")
SMALL = "int8 one\n"


def main() -> None:
    """Print which types differ; exit with 1 if one does and no tests are asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--tests", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        wheel = built(options.folder, Path(work))
        theirs, ours = dict(hashes_of_wheel(wheel)), dict(installed_hashes())
        differing = sorted(name for name in theirs if theirs[name] != ours.get(name))
        print(f"{len(theirs)} types, {len(theirs) - len(differing)} with our hash")
        print(*(f"  differs: {name}" for name in differing), sep="\n")
        if not options.tests:
            sys.exit(bool(differing))
        sys.exit(tested(wheel, Path(work)))


def built(folder: Path, work: Path) -> Path:
    """Return a wheel of the packages of a folder, made as ours is."""
    sources = work / "sailenv_msgs"
    shutil.copytree(ROOT / "sailenv_msgs", sources)
    for kind in ("msg", "srv"):
        shutil.rmtree(sources / kind)
    (sources / "msg").mkdir()
    (sources / "msg" / "Small.msg").write_text(SMALL)
    for package in sources.glob("ros_interfaces/*"):
        found = [path.parent for path in folder.rglob("package.xml") if named(path, package.name)]
        if not found:
            shutil.rmtree(package)
            continue
        for kind in KINDS:
            shutil.rmtree(package / kind, ignore_errors=True)
            if (found[0] / kind).is_dir():
                shutil.copytree(found[0] / kind, package / kind)
    pip = (sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation")
    environment = {**os.environ, "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}"}
    subprocess.run([*pip, "--wheel-dir", work, sources], check=True, env=environment)
    return next(work.glob("*.whl"))


def named(manifest: Path, name: str) -> bool:
    """Return whether a package.xml is that of a package."""
    return f"<name>{name}</name>" in manifest.read_text(encoding="utf-8")


def hashes_of_wheel(wheel: Path) -> Iterator[tuple[str, str]]:
    """Yield names and hashes of all types in a wheel but that of the small message."""
    with zipfile.ZipFile(wheel) as held:
        for name in held.namelist():
            if "/share/" in name and name.endswith(".json") and "sailenv_msgs/msg" not in name:
                yield from hashes_of(held.read(name))


def installed_hashes() -> Iterator[tuple[str, str]]:
    """Yield names and hashes of all types that are installed here."""
    for package in OURS.iterdir():
        for path in Path(sys.prefix, "share", package.name).rglob("*.json"):
            yield from hashes_of(path.read_bytes())


def hashes_of(description: bytes) -> Iterator[tuple[str, str]]:
    """Yield names and hashes of the types that a description of one is made of."""
    for entry in json.loads(description).get("type_hashes", ()):
        if entry["type_name"].partition("/")[0] in {path.name for path in OURS.iterdir()}:
            yield entry["type_name"], entry["hash_string"]


def tested(wheel: Path, work: Path) -> int:
    """Run the tests of the standard interfaces with the packages of a wheel before ours."""
    with zipfile.ZipFile(wheel) as held:
        wanted = (name for name in held.namelist() if "/libsailenv_msgs" not in name)
        held.extractall(work / "packages", wanted)
    libraries = next((work / "packages").glob("*.data/data/lib"))
    ours = [Path(sys.prefix, "lib"), *Path(sys.prefix).glob("lib/python*/site-packages/ros_*.libs")]
    environment = {
        **os.environ,
        "LD_LIBRARY_PATH": os.pathsep.join(map(str, (libraries, *ours))),
        # It has told the ROS 2 wheels that the path above is as they need it.
        "_ROS_WHEELS_BOOTSTRAP_COMPLETE": "1",
        "PYTHONPATH": os.pathsep.join(map(str, (work / "packages", ROOT))),
    }
    shutil.rmtree(work / "packages" / "sailenv_msgs")
    words = ("-q", "-n0", "tests/ros/test_simulation_interfaces.py")
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *words], cwd=ROOT, env=environment, check=False
    )
    return done.returncode


if __name__ == "__main__":
    main()
