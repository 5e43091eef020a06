"""BVH files: joints and channels as they are written, and refusals that name the line."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from sailenv_ros.assets.motions import add_motion, clip_names, find_clip
from sailenv_ros.assets.motions.bvh import MOST_FRAMES, read_bvh
from sailenv_ros.assets.motions.clip_files import MOST_BYTES, read_clip
from sailenv_ros.errors import AssetError
from sailenv_ros.postures.skeleton import turn_about
from tests.support.bvh_files import bvh_text

SMALL = """HIERARCHY
ROOT Hips
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Chest
  {
    OFFSET 0 10 0
    CHANNELS 3 Yrotation Xrotation Zrotation
    End Site
    {
      OFFSET 0 5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.01
1 2 3 90 0 0 0 0 0
1 2 4 0 90 0 0 0 90
"""


def refused(text: str) -> str:
    with pytest.raises(AssetError) as caught:
        read_bvh("walk.bvh", text.encode())
    return str(caught.value)


def test_joints_and_frames_are_those_of_the_file() -> None:
    clip = read_bvh("small.bvh", SMALL.encode())
    assert clip.joint_names == ("Hips", "Chest", "Chest end")
    assert clip.parents.tolist() == [-1, 0, 1]
    assert clip.rest.tolist() == [[0, 0, 0], [0, 10, 0], [0, 15, 0]]
    assert clip.duration_s == pytest.approx(0.01)
    _, places = clip.in_world()
    # Turned by 90 degrees about z, up is along -x.
    assert places[0] == pytest.approx(np.array([[1, 2, 3], [-9, 2, 3], [-14, 2, 3]]))
    # About x, up is along z; then the chest about its own z, so along -x.
    assert places[1] == pytest.approx(np.array([[1, 2, 4], [1, 2, 14], [-4, 2, 14]]))


@pytest.mark.parametrize("order", ["".join(axes) for axes in itertools.permutations("XYZ")])
def test_rotations_follow_the_order_of_their_channels(order: str) -> None:
    turn = turn_about("z", 20.0) @ turn_about("y", -35.0) @ turn_about("x", 50.0)
    clip = read_bvh("a.bvh", bvh_text([{"chest": turn}], order=order).encode())
    assert clip.turns[0, clip.joint_names.index("Spine1")] == pytest.approx(turn, abs=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("HIERARCHY", "HIERARCHIES", "'walk.bvh:1'.*HIERARCHY is expected"),
        ("JOINT Chest", "JOINT Hips", "'walk.bvh:6'.*'Hips' is there already, in line 2"),
        ("OFFSET 0 10 0", "OFFSET 0 nan 0", "'walk.bvh:8'.*finite number, got 'nan'"),
        ("    OFFSET 0 10 0\n", "", "'walk.bvh:13'.*'Chest' has no offset"),
        ("CHANNELS 3 Y", "CHANNELS 3 W", "'walk.bvh:9'.*'Wrotation' stands there"),
        ("CHANNELS 3 Y", "CHANNELS 9 Y", "'walk.bvh:9'.*must be 0 to 6, got '9'"),
        ("Yrotation Xrotation Z", "Yrotation Xrotation Y", "channel Yrotation of .* twice"),
        ("}\nMOTION", "}\n}\nMOTION", "'walk.bvh:16'.*MOTION or ROOT is expected"),
        ("}\nMOTION", "}\nROOT Other\n{\nMOTION", "'walk.bvh:16'.*second ROOT"),
        ("}\nMOTION", "MOTION", "'walk.bvh:15'.*'MOTION' stands there"),
        ("Frames: 2", "Frames: 1000000", f"'walk.bvh:17'.*must be 1 to {MOST_FRAMES}"),
        ("Frames: 2", "Frames: -1", "'walk.bvh:17'.*got '-1'"),
        ("Frames: 2", "Frames: 3", "'walk.bvh:21'.*ends after 2 of 3 frames"),
        ("Time: 0.01", "Time: 0", "'walk.bvh:18'.*above 0 and at most 1 s"),
        ("1 2 4 0 90 0", "1 2 inf 0 90 0", "'walk.bvh:20'.*finite number, got 'inf'"),
        ("1 2 4 0 90 0", "1 2 4 0 90", "'walk.bvh:20'.*a frame has 9 numbers, and this line has 8"),
        ("1 2 4 0 90 0", "1 2 4 0 90 x", "'walk.bvh:20'.*got 'x'"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_with_its_line(old: str, new: str, says: str) -> None:
    assert old in SMALL
    with pytest.raises(AssetError, match=says):
        read_bvh("walk.bvh", SMALL.replace(old, new, 1).encode())


def test_hierarchies_without_end_are_refused() -> None:
    deep = "".join(f"JOINT j{n}\n{{\nOFFSET 0 1 0\n" for n in range(5000))
    assert "too many joints" in refused("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + deep)
    wide = "".join(f"JOINT j{n}\n{{\nOFFSET 0 1 0\n}}\n" for n in range(500))
    assert "too many joints" in refused("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n" + wide)
    assert "it ends where" in refused(SMALL[:120])


def test_clips_are_found_in_their_folders_and_nowhere_else(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    home = tmp_path / "motions"
    home.mkdir()
    (home / "small.bvh").write_text(SMALL)
    (tmp_path / "outside.bvh").write_text(SMALL)
    (home / "link.bvh").symlink_to(tmp_path / "outside.bvh")
    monkeypatch.setenv("SAILENV_MOTIONS", str(home))
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path / "data"))
    assert find_clip("small") is find_clip("small.bvh")
    assert "small" in clip_names()
    for name in (
        "../outside",
        "../outside.bvh",
        "/etc/passwd",
        "link",
        "a/b",
        "",
        "pybullet_data:../x",
    ):
        with pytest.raises(AssetError):
            find_clip(name)
    name, clip = add_motion(tmp_path / "outside.bvh")
    assert name == "outside"
    assert find_clip("outside").joint_names == clip.joint_names
    with pytest.raises(AssetError, match="no name of a clip"):
        add_motion(tmp_path / "outside.bvh", "../x")
    with pytest.raises(AssetError, match=r"must end in \.bvh"):
        add_motion(tmp_path / "outside.txt")


def test_files_that_are_too_large_are_refused_unread(tmp_path: Path) -> None:
    file = tmp_path / "large.bvh"
    with file.open("wb") as out:
        out.truncate(MOST_BYTES + 1)
    with pytest.raises(AssetError, match="larger than 64 MB"):
        read_clip(file)


def test_motion_of_pybullet_data_is_read_where_it_lies() -> None:
    clip = find_clip("pybullet_data:data/motions/humanoid3d_walk.txt")
    assert clip.frame_s == pytest.approx(0.0333, abs=1e-4)
    assert clip.duration_s == pytest.approx(38 * clip.frame_s)
    assert 0.7 < clip.roots[:, 1].min() < clip.roots[:, 1].max() < 1.0
    with pytest.raises(AssetError, match="of a humanoid, are accepted"):
        find_clip("pybullet_data:data/motions/laikago_walk.txt")
    with pytest.raises(AssetError, match="no motion file"):
        find_clip("pybullet_data:r2d2.urdf")
