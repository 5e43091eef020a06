"""The `sailenv` command: statuses, one line for an error, no heavy import for a little help."""

from __future__ import annotations

import importlib
import subprocess
import sys

import pytest

from sailenv_ros.cli.main import COMMANDS, main
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.native.library import raise_for_status


def test_every_command_has_help(capsys: pytest.CaptureFixture[str]) -> None:
    """Each command is listed, and explains itself."""
    with pytest.raises(SystemExit) as ended:
        main(["--help"])
    listed = capsys.readouterr().out
    assert ended.value.code == 0
    for command in COMMANDS:
        assert command in listed
        with pytest.raises(SystemExit) as ended:
            main([command, "--help"])
        assert ended.value.code == 0
        assert capsys.readouterr().out.startswith(f"usage: sailenv {command}")


def test_an_error_of_ours_is_one_line_and_status_2(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """No traceback for what the user can put right."""

    def refuse(_: object) -> int:
        raise InvalidRequest("speed", 3, "a warp factor")

    doctor = importlib.import_module("sailenv_ros.cli.doctor")
    monkeypatch.setattr(doctor, "run", refuse)
    assert main(["doctor"]) == 2
    assert capsys.readouterr().err == "sailenv doctor: speed must be a warp factor, got 3\n"


def test_ctrl_c_is_quiet(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Status 130 and no words."""

    def interrupt(_: object) -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr(importlib.import_module("sailenv_ros.cli.doctor"), "run", interrupt)
    assert main(["doctor"]) == 130
    assert capsys.readouterr().err == ""


def test_too_little_memory_is_one_line_and_status_2(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Also where a kernel of the native library is what finds none."""
    monkeypatch.setattr(
        importlib.import_module("sailenv_ros.cli.doctor"), "run", lambda _: raise_for_status("a", 2)
    )
    assert main(["doctor"]) == 2
    assert capsys.readouterr().err.startswith("sailenv doctor: there is not enough memory for this")


@pytest.mark.parametrize("arguments", [["doctor", "--help"], ["--help"], ["--version"]])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    """A little help needs neither OpenGL nor PyBullet nor ROS."""
    code = (
        "import sys\n"
        "from sailenv_ros.cli.main import main\n"
        f"try: main({arguments})\n"
        "except SystemExit: pass\n"
        "heavy = ('moderngl', 'pybullet', 'rclpy', 'numpy')\n"
        "print([m for m in heavy if m in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip().endswith("[]")


@pytest.mark.parametrize(
    ("words", "flag"),
    [
        (["--width", "2"], "--width"),
        (["--height", "99999"], "--height"),
        (["--fov", "200"], "--fov"),
        (["--views", "rbg"], "--views"),
        (["--time", "-1"], "--time"),
        (["--plain"], "--views NAME"),
        (["--columns", "0"], "--columns"),
        (["--look-at", "0", "0", "1.5"], "--position"),
        (["--output", "sheet.gif"], "--output"),
    ],
)
def test_what_a_picture_of_a_scene_lacks_is_named_by_its_flag(
    words: list[str], flag: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """In one sentence, before anything is loaded."""
    assert main(["scene", "render", "optical", "--output", "sheet.png", *words]) == 2
    assert flag in capsys.readouterr().err
