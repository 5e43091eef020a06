"""The script that counts imports finds circles however they are imported."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "import_graph.py"


def printed(root: Path, *options: str) -> tuple[int, str]:
    """Run the script on a tree; return its status and what it printed."""
    command = [sys.executable, str(SCRIPT), *options, str(root)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert not done.stderr
    return done.returncode, done.stdout


def write(root: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)


@pytest.mark.parametrize(
    "back",
    [
        "from sailenv_ros.one.first import Thing\n",
        "import sailenv_ros.one.first\n",
        "from sailenv_ros.one import first\n",
        "from ..one import first\n",
        "def late():\n    from sailenv_ros.one.first import Thing\n",
        "import typing\nif typing.TYPE_CHECKING:\n    from sailenv_ros.one import first\n",
    ],
)
def test_a_circle_is_found(tmp_path: Path, back: str) -> None:
    """At the top, within a function, for types alone, relative: each is an arrow back."""
    files = {
        "sailenv_ros/__init__.py": "",
        "sailenv_ros/one/__init__.py": "",
        "sailenv_ros/one/first.py": "from sailenv_ros.two.second import Other\n",
        "sailenv_ros/two/__init__.py": "",
        "sailenv_ros/two/second.py": back,
        "sailenv_msgs_py/__init__.py": "from sailenv_ros.two import second\n",
    }
    write(tmp_path, files)
    status, text = printed(tmp_path)
    assert status == 1
    assert "circles between modules: 1" in text
    assert "sailenv_ros.two.second -> sailenv_ros.one.first" in text
    assert printed(tmp_path, "--check")[0] == 1


def test_rooms_and_arrows_are_counted(tmp_path: Path) -> None:
    """Modules of one room count once; a front that names its own makes no circle."""
    files = {
        "sailenv_ros/__init__.py": "",
        "sailenv_ros/low.py": "x = 1\n" * 351,
        "sailenv_ros/one/__init__.py": "from sailenv_ros.one.first import Thing\n",
        "sailenv_ros/one/first.py": "from sailenv_ros import low\nimport sailenv_ros.one.more\n",
        "sailenv_ros/one/more.py": "from sailenv_ros.low import x\n",
        "sailenv_msgs_py/__init__.py": "from sailenv_ros.one import Thing\n",
    }
    write(tmp_path, files)
    status, text = printed(tmp_path)
    lines = text.splitlines()
    assert "rooms: 3 (at most 30)" in lines
    assert "arrows between rooms: 2 (at most 210)" in lines
    assert "modules of more than 350 lines: 1" in lines
    assert status == 1
    assert printed(tmp_path, "--check") == (
        1,
        "modules of more than 350 lines: 1\n   351 sailenv_ros.low\n",
    )
    (tmp_path / "sailenv_ros/low.py").write_text("x = 1\n" * 350)
    assert printed(tmp_path, "--check") == (0, "")
