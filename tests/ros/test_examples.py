"""Every example runs as it stands, prints what it promises and writes the picture it names."""

from __future__ import annotations

import itertools
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.ros

EXAMPLES = Path(__file__).parents[2] / "examples"


def run(example: str, *arguments: str) -> str:
    """Run an example as a program of its own; return what it prints."""
    command = [sys.executable, str(EXAMPLES / f"{example}.py"), *arguments]
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    finished = subprocess.run(
        command, env=environment, capture_output=True, text=True, timeout=110, check=False
    )
    assert finished.returncode == 0, finished.stderr
    return finished.stdout


def run_for_a_picture(example: str, folder: Path) -> str:
    """Run one that writes a picture to the file that the command line names."""
    path = folder / "picture.png"
    out = run(example, str(path))
    assert str(path) in out
    assert path.stat().st_size > 2_000
    return out


def test_boxes_are_drawn(tmp_path: Path) -> None:
    """Into the picture whose name is on the command line."""
    run_for_a_picture("02_bounding_boxes", tmp_path)


def test_the_camera_s_way_is_in_the_flow(tmp_path: Path) -> None:
    """The first frame has no past; all later ones have flow nearly everywhere."""
    out = run_for_a_picture("01_moving_camera", tmp_path)
    valid = [int(share) for share in re.findall(r"(\d+)% valid", out)]
    assert len(valid) == 10
    assert valid[0] == 0
    assert min(valid[1:]) > 80


def test_estimated_flow_is_near_the_exact(tmp_path: Path) -> None:
    """Direction and sign agree: the estimate's error is less than the motion's length."""
    out = run_for_a_picture("03_flow_against_opencv", tmp_path)
    length = float(re.search(r"exact flow: ([\d.]+) px", out)[1])  # type: ignore[index]  # it is there
    error = float(re.search(r"the estimate: ([\d.]+) px", out)[1])  # type: ignore[index]  # it is there
    assert 0.0 < error < length


def test_spawned_objects_fall_move_and_go() -> None:
    """The ball comes to rest on the shelf's height or below, the shelf moves up, all go."""
    out = run("04_spawn_objects")
    heights = [float(height) for height in re.findall(r"ball is at (-?[\d.]+) m", out)]
    assert len(heights) == 4
    assert heights[-1] < heights[0]
    assert float(re.search(r"moves up: (-?\d+) px/s", out)[1]) > 0  # type: ignore[index]  # it is there
    assert "gone: True" in out


def test_lights_change_the_picture(tmp_path: Path) -> None:
    """An evening sun is red, a fifth of it darker, blue light makes it bluer."""
    rows = re.findall(
        r"^(.+?) +red +([\d.]+) +green +([\d.]+) +blue +([\d.]+)$",
        run_for_a_picture("06_lights", tmp_path),
        re.MULTILINE,
    )
    seen = {what.strip(): tuple(map(float, colour)) for what, *colour in rows}
    assert len(seen) == 6
    evening, dark = seen["an evening sun"], seen["a fifth of it"]
    blue = seen["with blue light from everywhere"]
    assert evening[0] - evening[2] > seen["as the scene is"][0] - seen["as the scene is"][2]
    assert sum(dark) < sum(evening)
    assert blue[2] > dark[2]


def test_a_scenario_moves_as_it_says() -> None:
    """Both cubes turn at their rates, the ball falls, and a reset brings all back."""
    out = run("07_scenario")
    yaw = dict(re.findall(r"0\.25 s: (slow|fast) +at .* yaw +(-?[\d.]+) deg", out))
    assert float(yaw["slow"]) == pytest.approx(7.5, abs=0.1)
    assert float(yaw["fast"]) == pytest.approx(45.0, abs=0.3)
    assert "after a reset: ['slow', 'fast', 'sphere_1']" in out


def test_many_agents_see_one_instant() -> None:
    """Four agents, three instants."""
    out = run("08_many_agents")
    assert len(re.findall(r"ids are seen", out)) == 12


def test_the_training_loop_learns() -> None:
    """It gets more right at the end than at the beginning."""
    shares = re.search(r"first five frames: (\d+)%, the last five: (\d+)%", run("09_training_loop"))
    assert shares is not None
    assert int(shares[2]) > int(shares[1])


def test_the_dataset_gives_every_frame() -> None:
    """Twelve frames, with PyTorch's workers or without."""
    assert "frames: 12" in run("10_pytorch_dataset")


def test_a_data_set_is_made_and_read() -> None:
    """All frames of the training split come out, by PyTorch or without it."""
    out = run("14_dataset")
    assert "16 frames, SHA-256 " in out
    assert "frames: 12" in out


def test_an_object_is_seen_on_white_from_all_around(tmp_path: Path) -> None:
    """All of it is in every picture, and nothing else."""
    sheet, arrays = tmp_path / "views.png", tmp_path / "views.npz"
    out = run("15_adversarial_views", str(sheet), str(arrays))
    assert "24 views" in out
    assert ", 0 pixels at borders" in out
    assert "around it all is 255 to 255" in out
    assert sheet.stat().st_size > 10_000
    with np.load(arrays) as views:
        mask, places = views["mask"], views["object_coords"]
        assert views["rgb"].shape == (24, 224, 224, 3)
    assert np.isfinite(places[mask]).all()
    assert np.ptp(places[mask][:, 2]) == pytest.approx(0.4, abs=0.02)
    # Each view is another one.
    assert len({view.tobytes() for view in places}) == 24


def test_attention_follows_what_moves(tmp_path: Path) -> None:
    """Far more often than chance, and labels are of what moves, one pixel each, far apart."""
    still = tmp_path / "still.foa"
    still.write_text("128,128,0,0,0\n" * 400)
    out = run("16_attention", str(tmp_path / "sheet.png"), str(still))
    covered = float(re.search(r"covers ([\d.]+) % of the pixels", out)[1])  # type: ignore[index]  # it is there
    ours, others = (float(share) for share in re.findall(r"moves in (\d+) %", out))
    assert ours > 5.0 * covered
    assert ours > 2.0 * others
    labels = re.findall(r"label: frame (\d+), row \d+, column \d+: (\w+)", out)
    frames = [int(number) for number, _ in labels]
    assert min(after - before for before, after in itertools.pairwise(frames)) >= 100
    assert {name for _, name in labels} == {"cylinder", "cube", "sphere"}


def test_a_rig_sees_one_instant(tmp_path: Path) -> None:
    """All cameras of it; they see much of what the others see, and not all."""
    out = run_for_a_picture("17_camera_rig", tmp_path)
    assert out.count("1 instant") == 5
    shares = [float(share) for share in re.findall(r"([\d.]+)%", out)]
    assert len(shares) == 10
    assert min(shares) > 40.0
    assert max(shares) < 100.0


def test_the_standard_interfaces_repeat_a_fall() -> None:
    """From another process, twice to the same byte; the simulator ends when it is asked to."""
    out = run("19_standard_interfaces")
    heights = re.findall(r"the ball is at z = ([\d.]+) m", out)
    assert len(set(heights)) == 1
    # Half a second of free fall from 3 m in steps of 1/240 s, each of which sets the speed first.
    fallen = 9.81 * 120 * 121 / 2 / 240**2
    assert float(heights[0]) == pytest.approx(3.0 - fallen, abs=1e-9)
    assert "equal bytes: True" in out
    assert "left after the reset: []" in out
    assert "ended with status 0" in out


def test_an_arm_puts_a_mug_on_a_shelf(tmp_path: Path) -> None:
    """By contact and friction; the camera in its hand sees it."""
    path = tmp_path / "picture.png"
    out = run("20_robot_arm", "1", str(path))
    assert "1 of 1 mugs stand on the shelf" in out
    assert path.stat().st_size > 2_000


def test_people_lie_sit_carry_and_move_as_recorded(tmp_path: Path) -> None:
    """All four, with keypoints that are seen."""
    out = run_for_a_picture("21_people", tmp_path)
    seen = dict(re.findall(r"(\w+): (\d+) of 17 keypoints are seen", out))
    assert set(seen) == {"anna", "ben", "cleo", "dan"}
    assert sum(int(count) for count in seen.values()) > 30
