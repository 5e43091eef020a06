"""The example of acting, run as its users do."""

from __future__ import annotations

import re
import runpy
import sys
from pathlib import Path

import gymnasium
import pytest

from sailenv_ros.gym.room_env import RoomEnv

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


def test_the_web_viewer_shows_where_eye_and_target_are(room: str) -> None:
    """Both are in the watched simulation where they are in the environment, after each step."""
    made = runpy.run_path(str(EXAMPLE))
    env = gymnasium.make("sailenv/Track-v0", rooms=[room], views="instance")
    env.reset(seed=0)
    inside = env.unwrapped
    assert isinstance(inside, RoomEnv)
    watched = made["Watched"](inside, 0)
    try:
        for _ in range(3):
            env.step(made["LEFT"])
            watched.show(inside)
            simulation = watched.simulation
            assert simulation.get_pose() == inside.eye_pose
            placed = simulation.get_object("target").pose.position_m
            assert placed == pytest.approx(inside.moved["target"].position_m, abs=1e-6)
    finally:
        watched.close()
        env.close()
