"""Files of calibrators: the lens that they describe; what is wrong with them, with its place."""

from __future__ import annotations

import contextlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sailenv_ros.cli.main import main
from sailenv_ros.errors import SailenvError, SceneError, UnknownName
from sailenv_ros.scene.calibration_files import load_calibration, load_rig
from sailenv_ros.scene.loader import load_scene
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.geometry import Pose

CAMERA_INFO = """\
image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [520.5, 0, 311.25, 0, 521.5, 236.75, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.28, 0.09, 0.001, -0.0005, -0.012]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
projection_matrix:
  rows: 3
  cols: 4
  data: [500, 0, 311, 0, 0, 510, 236, 0, 0, 0, 1, 0]
"""

CAMCHAIN = """\
cam0:
  cam_overlaps: [1]
  camera_model: pinhole
  distortion_coeffs: [0.0034, 0.0007, -0.002, 0.0002]
  distortion_model: equidistant
  intrinsics: [190.9, 190.8, 254.9, 256.8]
  resolution: [512, 512]
  rostopic: /cam0/image_raw
cam1:
  camera_model: omni
  distortion_coeffs: [-0.2, 0.04, 0.0004, -0.0003]
  distortion_model: radtan
  intrinsics: [1.04, 420.0, 421.0, 255.0, 250.0]
  resolution: [512, 512]
cam2:
  camera_model: ds
  distortion_coeffs: []
  distortion_model: none
  intrinsics: [-0.17, 0.59, 160.0, 161.0, 255.0, 250.0]
  resolution: [512, 512]
cam3:
  camera_model: pinhole
  distortion_coeffs: [-0.28, 0.07, 0.0002, 0.00002]
  distortion_model: radtan
  intrinsics: [458.6, 457.3, 367.2, 248.4]
  resolution: [752, 480]
"""

BESIDE = """\
  T_cn_cnm1:
  - [0.99999, 0.0, 0.0044721, -0.11]
  - [0.0, 1.0, 0.0, 0.0]
  - [-0.0044721, 0.0, 0.99999, 0.0002]
  - [0.0, 0.0, 0.0, 1.0]
"""
BEHIND = """\
  T_cn_cnm1:
  - [-1.0, 0.0, 0.0, 0.0]
  - [0.0, 1.0, 0.0, 0.02]
  - [0.0, 0.0, -1.0, -0.3]
  - [0.0, 0.0, 0.0, 1.0]
"""

COLMAP = """\
# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
1 SIMPLE_PINHOLE 640 480 500 320 240
2 PINHOLE 640 480 500 510 320 240
3 OPENCV 640 480 500 510 321 239 -0.2 0.05 0.001 -0.001
4 OPENCV_FISHEYE 640 480 300 301 320 240 0.01 0.002 -0.001 0.0001
5 FULL_OPENCV 640 480 500 510 320 240 0.6 -0.03 0 0.001 0.001 0.95 0.03 -0.004
6 SIMPLE_RADIAL 640 480 500 320 240 -0.05
7 RADIAL 640 480 500 320 240 -0.05 0.01
"""


def _written(folder: Path, name: str, text: str) -> Path:
    path = folder / name
    path.write_text(text)
    return path


def test_a_camera_info_is_read(tmp_path: Path) -> None:
    """Its camera_matrix is that of the distorted picture; the projection is of no concern."""
    lens = load_calibration(_written(tmp_path, "head.yaml", CAMERA_INFO), far_m=30.0)
    assert (lens.width, lens.height, lens.far_m) == (640, 480, 30.0)
    np.testing.assert_allclose(lens.K, [[520.5, 0, 311.25], [0, 521.5, 236.75], [0, 0, 1]])
    assert lens.distortion_model == "plumb_bob"
    assert lens.distortion == (-0.28, 0.09, 0.001, -0.0005, -0.012)


def test_a_camera_info_without_distortion_is_a_pinhole(tmp_path: Path) -> None:
    """As drivers of rectified cameras write it."""
    text = CAMERA_INFO.replace("[-0.28, 0.09, 0.001, -0.0005, -0.012]", "[0, 0, 0, 0, 0]")
    lens = load_calibration(_written(tmp_path, "head.yaml", text))
    assert lens.is_pinhole
    assert (lens.fx, lens.fy) == (520.5, 521.5)


KALIBR = [
    ("cam0", "equidistant", (0.0034, 0.0007, -0.002, 0.0002), (190.9, 190.8, 254.9, 256.8)),
    ("cam1", "mei", (1.04, -0.2, 0.04, 0.0004, -0.0003), (420.0, 421.0, 255.0, 250.0)),
    ("cam2", "double_sphere", (-0.17, 0.59), (160.0, 161.0, 255.0, 250.0)),
    ("cam3", "plumb_bob", (-0.28, 0.07, 0.0002, 0.00002), (458.6, 457.3, 367.2, 248.4)),
]


@pytest.mark.parametrize(("camera", "model", "coefficients", "matrix"), KALIBR)
def test_each_camera_of_kalibr_is_read(
    tmp_path: Path,
    camera: str,
    model: str,
    coefficients: tuple[float, ...],
    matrix: tuple[float, ...],
) -> None:
    """Kalibr's models under our names; what belongs to the lens comes first in its intrinsics."""
    lens = load_calibration(_written(tmp_path, "camchain.yaml", CAMCHAIN), camera=camera)
    assert (lens.distortion_model, lens.distortion) == (model, coefficients)
    np.testing.assert_allclose((lens.fx, lens.fy, lens.cx, lens.cy), matrix)


def _chain(tmp_path: Path) -> Path:
    first, second, third = (CAMCHAIN.index(f"cam{number}") for number in (1, 2, 3))
    text = CAMCHAIN[:second] + BESIDE + CAMCHAIN[second:third] + BEHIND
    assert first < second
    return _written(tmp_path, "camchain.yaml", text)


def test_a_chain_of_kalibr_is_a_rig(tmp_path: Path) -> None:
    """A place in the room has the pixels that the chain's own arithmetic says, in each camera."""
    rig = load_rig(_chain(tmp_path), max_angle_deg=80.0, far_m=30.0)
    assert list(rig) == ["cam0", "cam1", "cam2"]
    assert rig["cam0"].extrinsics == Pose()
    body = Pose.from_rpy_deg((1.0, -2.0, 1.5), (3.0, -20.0, 70.0))
    cameras = [
        Camera(intrinsics=camera.intrinsics, pose=body.carried(camera.extrinsics))
        for camera in rig.values()
    ]
    in_first = np.array([0.4, -0.3, 2.0, 1.0])
    place = cameras[0].world_from_camera @ in_first
    turn = 0.0044721
    beside = np.array(
        [
            [np.cos(turn), 0.0, np.sin(turn), -0.11],
            [0.0, 1.0, 0.0, 0.0],
            [-np.sin(turn), 0.0, np.cos(turn), 0.0002],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
    behind = np.diag([-1.0, 1.0, -1.0, 1.0])
    behind[:3, 3] = 0.0, 0.02, -0.3
    for camera, expected in zip(
        cameras, (in_first, beside @ in_first, behind @ beside @ in_first), strict=True
    ):
        seen = np.linalg.inv(camera.world_from_camera) @ place
        np.testing.assert_allclose(seen, expected, atol=2e-5)
    for one in rig.values():
        assert (one.intrinsics.max_angle_deg, one.intrinsics.far_m) == (80.0, 30.0)


def test_the_command_prints_a_rig_for_scene_files(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """As keys of an agent, which a scene reads as the same rig."""
    chain = _chain(tmp_path)
    assert main(["scene", "lens", str(chain), "--rig"]) == 0
    keys = "".join(f"    {line}\n" for line in capsys.readouterr().out.splitlines())
    scene = _written(
        tmp_path, "room.yaml", f"version: 1\nname: room\nagents:\n  - name: eye\n{keys}"
    )
    (agent,) = load_scene(scene).agents
    cameras = agent.to_agent_spec().cameras
    assert cameras is not None
    for name, camera in load_rig(chain).items():
        assert cameras[name].intrinsics == camera.intrinsics
        read, told = cameras[name].extrinsics.matrix(), camera.extrinsics.matrix()
        np.testing.assert_allclose(read, told, atol=1e-5)


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("T_cn_cnm1", "T_other", "cam1.T_cn_cnm1.0: is missing"),
        ("[0.0, 1.0, 0.0, 0.0]", "[0.0, 1.0, 0.0]", "cam1.T_cn_cnm1.1: must be four numbers, got"),
        ("[0.0, 1.0, 0.0, 0.0]", "[0.0, -1.0, 0.0, 0.0]", "cam1.T_cn_cnm1: must be four rows of a"),
        ("[0.0, 1.0, 0.0, 0.0]", "[0.0, 1.1, 0.0, 0.0]", "cam1.T_cn_cnm1: must be four rows of a"),
        ("cam1:", "Cam 1:", "makes no rig: name of the camera must be"),
    ],
)
def test_what_is_no_rig_is_refused_at_its_place(
    tmp_path: Path, old: str, new: str, sentence: str
) -> None:
    """In one sentence, with line and column."""
    path = _chain(tmp_path)
    path.write_text(path.read_text().replace(old, new))
    with pytest.raises(SceneError, match=r"camchain\.yaml:\d+:\d+: ") as caught:
        load_rig(path)
    assert sentence in str(caught.value)


COLMAP_LENSES: list[tuple[int, str, tuple[float, ...], float]] = [
    (1, "pinhole", (), 500.0),
    (2, "pinhole", (), 510.0),
    (3, "plumb_bob", (-0.2, 0.05, 0.001, -0.001), 510.0),
    (4, "equidistant", (0.01, 0.002, -0.001, 0.0001), 301.0),
    (5, "rational_polynomial", (0.6, -0.03, 0.0, 0.001, 0.001, 0.95, 0.03, -0.004), 510.0),
    (6, "plumb_bob", (-0.05, 0.0, 0.0, 0.0), 500.0),
    (7, "plumb_bob", (-0.05, 0.01, 0.0, 0.0), 500.0),
]


@pytest.mark.parametrize(("camera", "model", "coefficients", "fy"), COLMAP_LENSES)
def test_each_camera_of_colmap_is_read(
    tmp_path: Path, camera: int, model: str, coefficients: tuple[float, ...], fy: float
) -> None:
    """Its places are half a pixel more than ours: (0, 0) is the corner of the picture."""
    lens = load_calibration(_written(tmp_path, "cameras.txt", COLMAP), camera=camera)
    assert (lens.distortion_model, lens.distortion, lens.fy) == (model, coefficients, fy)
    own_axis = "-0.2" in COLMAP.splitlines()[camera + 1]
    assert (lens.cx, lens.cy) == ((320.5, 238.5) if own_axis else (319.5, 239.5))


BAD = [
    ("a.yaml", CAMERA_INFO.replace("image_width: 640", ""), "2:1: image_width: is missing"),
    (
        "a.yaml",
        CAMERA_INFO.replace("521.5, 236.75, 0, 0, 1", "521.5"),
        "7:9: camera_matrix.data: must be nine numbers [fx, 0, cx, 0, fy, cy, 0, 0, 1], got",
    ),
    (
        "a.yaml",
        CAMERA_INFO.replace("plumb_bob", "plumbob"),
        "8:19: makes no lens: distortion_model must be one of: pinhole, plumb_bob",
    ),
    (
        "a.yaml",
        CAMERA_INFO.replace("-0.28, 0.09", "-3.5, 0.0"),
        "8:19: makes no lens: distortion must be coefficients that do not fold within the picture",
    ),
    (
        "a.yaml",
        CAMERA_INFO.replace("640", "wide"),
        "1:14: image_width: must be an integer from 8 to 4096 [px], got",
    ),
    ("a.yaml", "a: !!python/object:os.system [ls]\n", "1:4: tags such as"),
    ("a.yaml", "- 1\n", "1:1: must be a mapping: camera_info or Kalibr's camchain"),
    ("a.yaml", "a: 1\n", "1:1: has neither camera_matrix (of a camera_info) nor a camera"),
    (
        "a.yaml",
        "cam0: {camera_model: eucm}\n",
        "1:22: cam0.camera_model: must be one of: pinhole, omni, ds; got 'eucm'",
    ),
    ("cameras.txt", "# nothing\n", "1:1: has no cameras"),
    ("cameras.txt", "1 FOV 640 480 1 2 3\n", "1:3: must be one of: SIMPLE_PINHOLE, PINHOLE"),
    ("cameras.txt", "1 PINHOLE 640 480 1 2 x 4\n", "1:23: must be a number, got 'x'"),
    (
        "cameras.txt",
        "1 PINHOLE 640 480 500 320 240\n",
        "1:19: must be 4 parameters of PINHOLE: fx fy cx cy; got 3",
    ),
    ("cameras.txt", "1 PINHOLE 640\n", "1:14: must be CAMERA_ID MODEL WIDTH HEIGHT PARAMS..."),
    ("cameras.txt", "1 PINHOLE 64.5 48 9 9 3 3\n", "1:11: must be an integer from 8 to 4096 [px]"),
    (
        "cameras.txt",
        "1 PINHOLE 640 480 0 0 320 240\n",
        "1:3: makes no lens: focal lengths must be above 0 [px], got 0 and 0",
    ),
]


@pytest.mark.parametrize(("name", "text", "sentence"), BAD)
def test_what_is_no_calibration_is_refused_at_its_place(
    tmp_path: Path, name: str, text: str, sentence: str
) -> None:
    """Each with file, line and column; nothing of it is run."""
    path = _written(tmp_path, name, text)
    with pytest.raises(SceneError) as caught:
        load_calibration(path)
    assert str(caught.value).startswith(f"{path}:{sentence}")


PIECES = st.sampled_from(
    [
        "nan",
        "-1",
        "0",
        "1" + "0" * 400,
        ".inf",
        "[]",
        "{}",
        "&a",
        "*a",
        "\n",
        ":",
        "x",
        "1e-9",
        "\x00",
    ]
)


@settings(max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from([("a.yaml", CAMERA_INFO), ("a.yaml", CAMCHAIN), ("cameras.txt", COLMAP)]),
    st.lists(st.tuples(st.floats(0.0, 1.0), st.integers(0, 12), PIECES), min_size=1, max_size=4),
    st.sampled_from([None, "cam0", "cam1", "cam2", "1", "5"]),
)
def test_a_damaged_file_is_read_or_refused_in_words(
    tmp_path: Path,
    given_file: tuple[str, str],
    changes: list[tuple[float, int, str]],
    camera: str | None,
) -> None:
    """Whatever stands in it, no other error than ours comes of it."""
    name, text = given_file
    for share, length, piece in changes:
        at = int(share * len(text))
        text = text[:at] + piece + text[at + length :]
    path = _written(tmp_path, name, text)
    with contextlib.suppress(SailenvError):
        lens = load_calibration(path, camera=camera)
        assert lens.fx > 0.0


@pytest.mark.parametrize(
    ("name", "text", "camera"),
    [
        ("camchain.yaml", CAMCHAIN, None),
        ("camchain.yaml", CAMCHAIN, "cam9"),
        ("cameras.txt", COLMAP, None),
        ("cameras.txt", COLMAP, 9),
        ("head.yaml", CAMERA_INFO, "other"),
    ],
)
def test_which_camera_is_meant_must_be_said(
    tmp_path: Path, name: str, text: str, camera: Any
) -> None:
    """Where a file has several, and where it has no such one: those that there are are named."""
    with pytest.raises(UnknownName, match="camera must be one of: "):
        load_calibration(_written(tmp_path, name, text), camera=camera)


def test_a_calibration_becomes_keys_of_a_scene_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Printed by the command, read as a scene: the same lens, to the last bit."""
    path = _written(tmp_path, "camchain.yaml", CAMCHAIN)
    assert main(["scene", "lens", str(path), "--camera", "cam1", "--max-angle", "70"]) == 0
    keys = "".join(f"  {line}\n" for line in capsys.readouterr().out.splitlines())
    scene = f"version: 1\nagents:\n- name: eye\n{keys}"
    (agent,) = load_scene(_written(tmp_path, "room.yaml", scene)).agents
    expected = load_calibration(path, camera="cam1", max_angle_deg=70.0)
    assert agent.to_agent_spec().intrinsics == expected


def test_a_file_that_is_not_there_says_so(tmp_path: Path) -> None:
    """In one sentence, without a place."""
    with pytest.raises(SceneError, match="cannot be read: No such file"):
        load_calibration(tmp_path / "none.yaml")
