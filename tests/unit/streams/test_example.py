"""The example that offers a stream as an agent; without UNaIVERSE it is asked here."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[3] / "examples" / "22_unaiverse.py"


def test_the_world_answers_with_a_picture_and_a_label(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Three times; the label is of a pixel of the picture, and its category has a name."""
    monkeypatch.setattr(sys, "argv", [str(EXAMPLE)])
    world = runpy.run_path(str(EXAMPLE), run_name="__main__")["world"]
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 3
    for line in lines:
        size, _, label = line.partition("; ")
        assert size == "256 × 256 pixels"
        row, column, category = label.split(maxsplit=2)
        assert 0 <= int(row) < 256
        assert 0 <= int(column) < 256
        assert category
    picture, text = world.forward("what is there?")
    assert picture.size == (256, 256)
    assert f"256 × 256 pixels; {text}" not in lines
