"""`sailenv doctor`: honest about what renders, quick about what hangs."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sailenv_ros.cli import doctor
from sailenv_ros.cli.doctor import CheckResult, diagnose
from sailenv_ros.cli.doctor_probes import probe_ros, try_probe
from sailenv_ros.cli.main import main
from sailenv_ros.errors import NativeLibraryError

Answer = tuple[dict[str, Any] | None, str]

HARDWARE = {"index": 0, "renderer": "A Card", "version": "4.6", "refused": "", "software": False}
SOFTWARE = {"index": 1, "renderer": "llvmpipe", "version": "4.5", "refused": "", "software": True}
REFUSED = {"index": 2, "renderer": "", "version": "", "refused": "no driver", "software": False}
FRAME = {"scene": "optical", "renderer": "a renderer", "ms": 20.0, "instances": 7}
HEALTHY: dict[str, Answer] = {
    "ros": ({"missing": [], "rclpy": f"{sys.prefix}/rclpy.py", "rmw": "rmw_fastrtps_cpp"}, ""),
    "scenes": ({"scenes": {"optical": ""}, "assets": 5}, ""),
    "graphics": ({"devices": [HARDWARE, REFUSED]}, ""),
    "frame by auto": (FRAME, ""),
}


def results(**changes: Answer) -> list[CheckResult]:
    """Diagnose a healthy machine with some answers replaced, `_` for a blank in their names."""
    answers = HEALTHY | {name.replace("_", " "): answer for name, answer in changes.items()}
    return list(diagnose(timeout_s=1.0, probe=lambda name, _: answers[name]))


def about(topic: str, found: list[CheckResult], level: str) -> str:
    return "\n".join(one.text for one in found if one.topic == topic and one.level == level)


def test_a_machine_that_renders_is_well(capsys: pytest.CaptureFixture[str]) -> None:
    """Status 0, with the device, the renderer and the scenes in the table."""
    assert main(["doctor"]) == 0
    shown = capsys.readouterr().out
    for word in ("EGL device 0", "renderer", "optical", "/dev/shm", "Python"):
        assert word in shown
    assert "Frames can be rendered" in shown


def test_graphics_hardware_leaves_nothing_to_warn_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """No warning about OpenGL; the refused device is told with its reason."""
    for name in doctor.GRAPHICS_VARIABLES:
        monkeypatch.delenv(name, raising=False)
    found = results()
    assert about("EGL device 0", found, "ok") == "A Card, OpenGL 4.6"
    assert about("EGL device 2", found, "note") == "refused: no driver"
    assert not about("OpenGL", found, "warning")


def without_library() -> None:
    raise NativeLibraryError("there is no library")


def test_without_graphics_hardware_the_native_renderer_draws() -> None:
    """That is no error: a note says what draws."""
    for devices in ([SOFTWARE, REFUSED], [REFUSED], []):
        found = results(graphics=({"devices": devices}, ""))
        assert "native renderer draws" in about("OpenGL", found, "note")
        assert not about("OpenGL", found, "warning")
        assert about("native library", found, "ok")


def test_without_the_native_library_nothing_can_be_drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is required, whatever the graphics hardware: the remedy stands in the finding."""
    monkeypatch.setattr(doctor, "native_library", without_library)
    found = results()
    assert "there is no library" in about("native library", found, "FAILED")
    assert "apt-get install g++" in about("native library", found, "FAILED")


def test_where_opengl_crashes_the_native_renderer_is_enough() -> None:
    """OpenGL's error is told with the packages that mend it; the native renderer's frame counts."""
    found = results(
        graphics=({"devices": [REFUSED]}, ""),
        frame_by_auto=(None, "no OpenGL context"),
        frame_by_native=(FRAME, ""),
    )
    assert "apt-get install libegl1" in about("OpenGL", found, "note")
    assert "no OpenGL context" in about("renderer", found, "warning")
    assert "FALLBACK" in about("renderer", found, "warning")
    assert "FAILED" not in {one.level for one in found}


@pytest.mark.parametrize(
    "changes",
    [
        {
            "frame_by_auto": (None, "crashed"),
            "frame_by_native": (None, "crashed too"),
        },
        {"frame_by_auto": ({**FRAME, "instances": 0}, "")},
        {"scenes": (None, "crashed")},
    ],
)
def test_what_keeps_a_simulator_from_rendering_fails(
    changes: dict[str, Answer],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """No renderer, an empty picture or no scene: said in words, and status 1."""
    found = results(**changes)
    monkeypatch.setattr(doctor, "diagnose", lambda **_: iter(found))
    assert main(["doctor"]) == 1
    assert "cannot render here" in capsys.readouterr().out


def test_without_ros_the_simulator_still_renders() -> None:
    """Missing ROS is a warning that names what is missing and what brings it."""
    missing = {"missing": ["rclpy (No module named 'rclpy')"]}
    found = results(ros=(missing, ""))
    assert "rclpy" in about("ROS", found, "warning")
    assert "scripts/setup" in about("ROS", found, "warning")
    assert "FAILED" not in {one.level for one in found}


def test_a_folder_of_definitions_is_no_package(monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in a checkout, Python takes its `sailenv_msgs/` for a package; doctor does not."""
    monkeypatch.setitem(sys.modules, "sailenv_msgs.msg", ModuleType("sailenv_msgs.msg"))
    monkeypatch.setattr(sys.modules["sailenv_msgs.msg"], "__file__", None, raising=False)
    assert [text for text in probe_ros()["missing"] if text.startswith("sailenv_msgs")] != []


def test_two_ros_at_once_are_warned_of(monkeypatch: pytest.MonkeyPatch) -> None:
    """A sourced ROS and another one from PyPI do not go together."""
    monkeypatch.setenv("ROS_DISTRO", "jazzy")
    assert "must not be mixed" in about("ROS", results(), "warning")


@pytest.mark.parametrize("domain", ["twelve", ""])
def test_a_domain_that_is_no_number_is_told(domain: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Doctor survives the settings that keep others from starting."""
    monkeypatch.setenv("ROS_DOMAIN_ID", domain)
    found = results()
    if domain:
        assert "twelve" in about("domain", found, "warning")
    else:
        assert about("domain", found, "ok").startswith("0,")


@pytest.mark.parametrize(
    ("script", "why_not"),
    [
        ("import time; time.sleep(60)", "did not come back within 0.5 s, and was ended"),
        ("import os; os.abort()", "crashed (SIGABRT)"),
        ("import sys; sys.exit('libEGL is broken')", "libEGL is broken"),
        ("print('{}')", "ended with status 0 and said nothing"),
    ],
)
def test_a_driver_that_hangs_or_crashes_is_reported(
    script: str, why_not: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The probing process may do what it wants; doctor comes back in time with the reason."""
    monkeypatch.setattr(sys, "executable", _python_that_runs(script, tmp_path))
    assert try_probe("graphics", 0.5 if "sleep" in script else 30.0) == (None, why_not)


def test_a_chatty_driver_does_not_spoil_the_answer(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What libraries print beside the answer is passed over."""
    answer = json.dumps({"devices": []})
    script = f"print('MESA: hello'); print('sailenv-probe:' + {answer!r}); print('bye')"
    monkeypatch.setattr(sys, "executable", _python_that_runs(script, tmp_path))
    assert try_probe("graphics", 30.0) == ({"devices": []}, "")


def _python_that_runs(script: str, folder: Path) -> str:
    (folder / "script.py").write_text(script)
    fake = folder / "python"
    fake.write_text(f'#!/bin/sh\nexec "{sys.executable}" "{folder}/script.py"\n')
    fake.chmod(0o755)
    return str(fake)
