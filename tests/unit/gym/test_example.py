"""The example of acting, run as its users do."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "18_acting.py"


def test_the_scripted_agent_keeps_the_object_centred(
    room: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "last.png"
    arguments = ["--rooms", room, "--episodes", "1", "--picture", str(picture)]
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE), *arguments])
    runpy.run_path(str(EXAMPLE), run_name="__main__")
    said = re.search(r"reward (-?\d+), centred in (\d+)%", capsys.readouterr().out)
    assert said
    assert int(said[1]) > 100
    assert picture.stat().st_size > 500
