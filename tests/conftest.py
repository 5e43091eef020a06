"""Settings of the whole test run; nothing here is imported by tests.

ROS reads its environment when it is first imported, so that is settled before anything else.
"""

from __future__ import annotations

import os
import re
import signal
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

BASE_DOMAIN_ID = 100
"""The workers take this one and those after it; 232 is the highest that there is."""

ROOT = Path(__file__).resolve().parents[1]


def _isolate_ros() -> None:
    """Assign each worker a domain of its own, on this machine alone."""
    worker = re.sub(r"\D", "", os.environ.get("PYTEST_XDIST_WORKER", "")) or "0"
    base = int(os.environ.get("SAILENV_TEST_DOMAIN_ID", BASE_DOMAIN_ID))
    os.environ["ROS_DOMAIN_ID"] = str(base + int(worker))
    os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
    os.environ.pop("ROS_LOCALHOST_ONLY", None)  # where it is set, it wins over the line above


_isolate_ros()
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # by a shell that runs them in the background
    signal.signal(signal.SIGINT, signal.default_int_handler)
# What its user has saved on this machine is no part of the tests.
os.environ["SAILENV_SCENES"] = str(ROOT / "build" / "no_scenes")

NOT_QUICK = (
    "gateway",
    "packaging",
    "render",
    "ros",
    "viewer",
    "unit/assets/test_damage.py",
    "unit/assets/test_standard_pack.py",
    "unit/simulation/models",
    "unit/dataset/test_engines.py",
    "unit/dataset/test_making.py",
    "unit/dataset/test_remote.py",
    "unit/dataset/test_samples.py",
    "unit/dataset/test_showing.py",
    "unit/content/generation/test_generated_rooms.py",
    "unit/reliability",
)
"""Folders and files whose tests are left out of the quick tier, which `scripts/check` runs.

All else is quick but for tests marked as slow: data, scenes, operations, validation, and kernels
beside their oracles. `scripts/test` runs everything.
"""

INSTALLED_PREFIX = os.environ.get("SAILENV_INSTALLED_PREFIX", "")
"""Set by scripts/test: where the package under test was installed to; else it is the sources'."""

settings.register_profile("dev", deadline=None)
# The same examples each time; a shared machine makes no promise about time.
settings.register_profile(
    "ci",
    deadline=None,
    derandomize=True,
    print_blob=True,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "dev"))


@pytest.fixture
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of the test's own."""
    folder = tmp_path / "cache"
    monkeypatch.setenv("SAILENV_CACHE", str(folder))
    return folder


@pytest.fixture
def packs(own_cache: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder of packs of the test's own, with a cache of its own."""
    folder = tmp_path / "pack"
    monkeypatch.setenv("SAILENV_PACKS", str(folder))
    return folder


@pytest.fixture
def own_folders(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Folders of the test's own for what processes tell each other; none of the session's."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "none"))
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))


@pytest.fixture
def cell(request: pytest.FixtureRequest, own_cache: Path, tmp_path: Path) -> Path:
    """The file of the room that the module describes as `ROOM`, with a cache of its own."""
    file = tmp_path / "cell.yaml"
    file.write_text(request.module.ROOM, encoding="utf-8")
    return file


@pytest.fixture
def memory_folder() -> Iterator[Path]:
    """An empty folder in memory, for tests that write and sync small files thousands of times.

    They are of calls and of names; on a disk they would mostly wait for it.
    """
    memory = Path("/dev/shm")
    with tempfile.TemporaryDirectory(
        prefix="sailenv-test-", dir=memory if os.access(memory, os.W_OK) else None
    ) as folder:
        yield Path(folder)


def _is_left_out(path: Path) -> bool:
    """Return whether a file or folder is left out of the quick tier."""
    return any(path.is_relative_to(ROOT / "tests" / name) for name in NOT_QUICK)


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Do not even import the other tests for ``-m quick``."""
    quick_alone = config.option.markexpr == "quick"
    return True if quick_alone and _is_left_out(collection_path) else None


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Mark by folder what needs OpenGL or ROS and what is quick; longest files first.

    So no test can forget its mark. Workers take a file after the other: a long one at the end
    would leave the others idle.
    """
    tests = ROOT / "tests"
    missing = [name for name in NOT_QUICK if not (tests / name).exists()]
    if missing:
        raise pytest.UsageError(
            f"NOT_QUICK of tests/conftest.py names what is not there: {missing}"
        )
    for item in items:
        path = item.path.relative_to(tests)
        if path.parts[0] == "ros":
            item.add_marker(pytest.mark.ros)
        elif path.parts[0] in ("render", "viewer"):
            item.add_marker(pytest.mark.gl)
        if not item.get_closest_marker("slow") and not _is_left_out(item.path):
            item.add_marker(pytest.mark.quick)
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: item.path not in slow)


def pytest_collection_finish() -> None:
    """Leave the sources' folder: programs started by `python -m` look there first.

    Not earlier, because pytest and its workers look up their arguments from the current folder.
    """
    if INSTALLED_PREFIX:
        os.chdir(INSTALLED_PREFIX)
