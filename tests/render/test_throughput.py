"""Frames counted in processes of their own: real workers, small pictures."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from sailenv_bench.experiments.throughput import Group, baseline_rows, measure_group, plan_of
from sailenv_bench.experiments.workloads import TRANSPORTS, Setting, environment_of
from sailenv_ros.cli.main import main
from sailenv_ros.errors import UnknownName
from sailenv_ros.types.views import FIVE_VIEWS

SMALL = Setting(kind="in process", scene="optical", width=32, height=24, views=FIVE_VIEWS)


def setting(kind: str, **changes: object) -> Setting:
    return Setting(**{**asdict(SMALL), "kind": kind, **changes})


def test_workers_make_frames_in_turn() -> None:
    """Ours in process with two cameras and through the gateway, and PyBullet's renderer."""
    kinds = ("gateway, raw", "PyBullet TinyRenderer")
    settings = {kind: setting(kind) for kind in kinds}
    settings["in process"] = setting("in process", agents=2)
    done: list[int] = []
    rows = measure_group(Group(vary="kind", settings=settings), 6, done.append)
    assert done == [5, 1]
    for row in rows:
        assert "problem" not in row
        assert row["frame"]["count"] == 6
        assert row["fps"] > 0.0
        assert row["memory_mib"] > 20.0
        assert row["repeated"] == 0
    by_label = {row["label"]: row for row in rows}
    assert by_label["in process"]["render"] > 0.0
    assert {"annotate", "render"} <= set(by_label["in process"]["stages"])
    assert by_label["gateway, raw"]["render"] is None
    assert by_label["gateway, raw"]["memory_mib"] > by_label["in process"]["memory_mib"]


def test_what_cannot_start_says_why_and_the_others_go_on() -> None:
    """Never silently left out."""
    settings = {"good": SMALL, "bad": setting("in process", scene="nowhere")}
    good, bad = measure_group(Group(vary="scene", settings=settings), 1)
    assert good["frame"]["count"] == 1
    assert "nowhere" in bad["problem"]
    assert "frame" not in bad


def test_renderers_are_set_in_proportion_to_ours() -> None:
    """Ratios of medians; who is missing has none and says why."""
    common = {"width": 32, "height": 24}
    rows = baseline_rows(
        [
            {"label": "sailenv_ros", "frame": {"median": 10.0}, **common},
            {"label": "PyBullet OpenGL", "frame": {"median": 25.0}, **common},
            {"label": "MuJoCo", "problem": "is not installed", **common},
        ]
    )
    assert [row["ratio"] for row in rows] == [1.0, 2.5, None]
    assert [row["ours"] for row in rows] == [True, False, False]
    assert rows[2]["problem"] == "is not installed"


def test_the_plan_varies_one_thing_at_a_time_or_everything() -> None:
    """Every size with every transport; with --full every combination."""
    common = {
        "sizes": [(64, 48), (640, 480)],
        "scenes": ["optical", "room_01"],
        "agents": [1, 2],
        "transports": list(TRANSPORTS),
        "baseline_sizes": [(64, 48)],
    }
    plan = plan_of(**common, full=False)
    assert (plan.base.width, plan.base.scene, plan.base.kind) == (640, "optical", "in process")
    assert [group.vary for group in plan.cases] == [
        "transport", "transport", "views", "agents", "scene"
    ]  # fmt: skip
    assert [len(group.settings) for group in plan.cases] == [6, 6, 5, 2, 2]
    assert len(plan.baselines[0].settings) == 5
    full = plan_of(**common, full=True)
    labels = [label for group in full.cases for label in group.settings]
    assert len(labels) == 2 * 2 * 5 * 2 * 6
    assert len(set(labels)) == len(labels)
    with pytest.raises(UnknownName, match="pigeon"):
        plan_of(**{**common, "transports": ["pigeon"]}, full=False)


def test_the_default_of_dds_is_left_alone_by_our_profile() -> None:
    """A variable says so to whoever would choose one."""
    default, ours = environment_of("DDS, default"), environment_of("DDS, our profile")
    assert default["FASTDDS_BUILTIN_TRANSPORTS"] == "DEFAULT"
    assert "FASTDDS_BUILTIN_TRANSPORTS" not in ours
    # Shared memory beside DDS is measured by itself.
    assert default["SAILENV_DIRECT_FRAMES"] == ours["SAILENV_DIRECT_FRAMES"] == "0"
    assert environment_of("shared memory") == {"SAILENV_DIRECT_FRAMES": "1"}


def test_a_command_measures_writes_and_reports(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """`bench flow-accuracy` and `report`, as a user runs them."""
    words = ["bench", "flow-accuracy", "--quick", "--scenario", "both", "-o", str(tmp_path)]
    monkeypatch.setattr("sys.argv", ["sailenv", *words])
    assert main(words) == 0
    shown = capsys.readouterr().out
    assert "camera and cube" in shown
    assert str(tmp_path / "flow_accuracy.json") in shown
    result = json.loads((tmp_path / "flow_accuracy.json").read_text())
    assert result["provenance"]["command"] == " ".join(["sailenv", *words])
    assert (tmp_path / "flow_both.png").exists()
    assert main(["report", str(tmp_path)]) == 0
    assert (tmp_path / "report.html").stat().st_size > 50_000
