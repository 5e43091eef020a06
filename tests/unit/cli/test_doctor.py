"""`sailenv doctor`: honest about what renders, quick about what hangs."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest

from sailenv_ros.cli import doctor
from sailenv_ros.cli.main import main


def test_a_machine_that_renders_is_well(capsys: pytest.CaptureFixture[str]) -> None:
    """Status 0, with the device, the renderer and the scenes in the table."""
    assert main(["doctor"]) == 0
    shown = capsys.readouterr().out
    for word in ("EGL device 0", "OpenGL", "optical", "/dev/shm", "Python"):
        assert word in shown


def test_without_opengl_the_fallback_is_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """OpenGL's fault is told with the packages that mend it; the fallback's frame counts."""
    real = doctor._probe

    def probe(backend: str, timeout_s: float) -> dict[str, Any]:
        return {"fault": "no driver"} if backend == "gl" else real(backend, timeout_s)

    monkeypatch.setattr(doctor, "_probe", probe)
    findings, rendered = doctor.examine(60.0)
    assert rendered
    told = {what: (grade, found) for grade, what, found in findings}
    assert told["OpenGL"][0] == "bad"
    assert "apt-get install libegl1" in told["OpenGL"][1]
    assert told["fallback renderer"][0] == "note"


def test_without_any_renderer_the_status_is_1(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Nothing renders: said in words, and the status says so."""
    monkeypatch.setattr(doctor, "_probe", lambda *_: {"fault": "no driver"})
    assert main(["doctor"]) == 1
    assert "No frame could be rendered" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("script", "fault"),
    [
        ("import time; time.sleep(60)", "hangs: no answer within 0.5 s"),
        ("import os; os.abort()", "ended with status -6"),
        ("import sys; sys.exit('libEGL is broken')", "ended with status 1 libEGL is broken"),
        ("print('not json')", "ended with status 0"),
    ],
)
def test_a_driver_that_hangs_or_crashes_is_reported(
    script: str, fault: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The probing process may do what it wants; doctor comes back in time with the reason."""
    fake = tmp_path / "python"
    body = script.replace('"', '\\"')
    fake.write_text(f'#!/bin/sh\nexec {sys.executable} -c "{body}"\n')
    fake.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(fake))
    assert doctor._probe("gl", 0.5 if "sleep" in script else 30.0) == {"fault": fault}
