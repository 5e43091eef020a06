"""Files of calibrations by other programs → `CameraIntrinsics`, a rig, or a `SceneError`.

The `camera_info` YAML of camera_calibration and camera_info_manager, Kalibr's `camchain.yaml`,
COLMAP's `cameras.txt`. They are data: nothing in them is run.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.scene.calibration_document import SIZE, CalibrationDocument
from sailenv_ros.scene.documents import text_of_file
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.yaml_nodes import Mark, compose
from sailenv_ros.types.camera import CameraIntrinsics
from sailenv_ros.types.geometry import BODY_FROM_OPTICAL, Pose, invert
from sailenv_ros.types.rigs import RigCamera, checked_cameras

__all__ = ["COLMAP_CORNER_PX", "colmap_camera", "load_calibration", "load_rig"]

_MATRIX_NUMBERS = 9
_PLUMB_BOB = "plumb_bob"

_KALIBR_CAMERAS = {
    "pinhole": ("fx", "fy", "cx", "cy"),
    "omni": ("xi", "fx", "fy", "cx", "cy"),
    "ds": ("xi", "alpha", "fx", "fy", "cx", "cy"),
}
"""Order of `intrinsics` of each `camera_model` of Kalibr."""

_KALIBR_MODELS = {
    ("pinhole", "none"): "pinhole",
    ("pinhole", "radtan"): _PLUMB_BOB,
    ("pinhole", "equidistant"): "equidistant",
    ("omni", "none"): "mei",
    ("omni", "radtan"): "mei",
    ("ds", "none"): "double_sphere",
}
"""Our model of each `camera_model` and `distortion_model` of Kalibr."""

_KALIBR_COEFFICIENTS = 4

_COLMAP_MODELS: Mapping[str, tuple[str, str]] = {
    "SIMPLE_PINHOLE": ("pinhole", "f cx cy"),
    "PINHOLE": ("pinhole", "fx fy cx cy"),
    "SIMPLE_RADIAL": (_PLUMB_BOB, "f cx cy k1"),
    "RADIAL": (_PLUMB_BOB, "f cx cy k1 k2"),
    "OPENCV": (_PLUMB_BOB, "fx fy cx cy k1 k2 p1 p2"),
    "OPENCV_FISHEYE": ("equidistant", "fx fy cx cy k1 k2 k3 k4"),
    "FULL_OPENCV": ("rational_polynomial", "fx fy cx cy k1 k2 p1 p2 k3 k4 k5 k6"),
}
"""Our model of each of COLMAP's, and its parameters in order."""

COLMAP_CORNER_PX = 0.5
"""COLMAP's (0, 0) is the corner of the picture, ours the centre of the first pixel."""


def load_calibration(
    path: str | Path,
    *,
    camera: str | int | None = None,
    near_m: float = 0.05,
    far_m: float = 100.0,
    max_angle_deg: float = 0.0,
) -> CameraIntrinsics:
    """Read the intrinsics of a real camera from a file of a calibrator.

    Parameters
    ----------
    path : str or Path
        A `camera_info` YAML, Kalibr's `camchain.yaml`, or COLMAP's `cameras.txt`, which ends in
        ``.txt``.
    camera : str, int or None
        Which, of a file with several: ``"cam1"`` of Kalibr, a number of COLMAP.
    near_m, far_m : float
        Clip distances [m].
    max_angle_deg : float
        Where the image circle ends [deg]; 0 if it ends where the model does.

    Raises
    ------
    SceneError
        If the file cannot be read, or is no calibration that makes a lens; with line and column.
    UnknownName
        If there is no such camera in it.
    """
    others = {"near_m": near_m, "far_m": far_m, "max_angle_deg": max_angle_deg}
    if Path(path).suffix.lower() == ".txt":
        file = CalibrationDocument(Path(path))
        return _of_colmap(file, text_of_file(file.path, "a calibration"), camera, others)
    file = _yaml_document(Path(path))
    if "camera_matrix" in file.node.value:
        return _of_camera_info(file, camera, others)
    return _of_kalibr(file, camera, others)


def load_rig(
    path: str | Path,
    *,
    near_m: float = 0.05,
    far_m: float = 100.0,
    max_angle_deg: float = 0.0,
) -> dict[str, RigCamera]:
    """Read all cameras of Kalibr's `camchain.yaml` as a rig.

    Its body is that of the first camera. The others are where their ``T_cn_cnm1`` say: (4, 4), what
    the camera before has at a place, this one has at that place transformed, in optical axes.

    Parameters
    ----------
    path : str or Path
    near_m, far_m : float
        Clip distances [m].
    max_angle_deg : float
        Where the image circles end [deg]; 0 if they end where the models do.

    Returns
    -------
    cameras : dict of str to RigCamera
        By the names in the file, in its order.

    Raises
    ------
    SceneError
        If the file cannot be read, or is no calibration that makes a rig; with line and column.
    """
    file = _yaml_document(Path(path))
    others = {"near_m": near_m, "far_m": far_m, "max_angle_deg": max_angle_deg}
    cameras: dict[str, RigCamera] = {}
    first_from_camera = np.eye(4)
    for name in _kalibr_names(file):
        if cameras:
            before_from_camera = invert(file.rigid((name, "T_cn_cnm1")))
            first_from_camera = first_from_camera @ before_from_camera
        pose = BODY_FROM_OPTICAL @ first_from_camera @ invert(BODY_FROM_OPTICAL)
        cameras[name] = RigCamera(
            intrinsics=_of_kalibr(file, name, others), extrinsics=Pose.from_matrix(pose)
        )
    try:
        return dict(checked_cameras(cameras))
    except InvalidRequest as problem:
        file.refuse(file.node.mark, f"makes no rig: {problem}")


def _yaml_document(path: Path) -> CalibrationDocument:
    file = CalibrationDocument(path)
    node, found = compose(text_of_file(path, "a calibration"))
    if found:
        file.refuse(found[0].mark, found[0].message)
    if node is None or not isinstance(node.value, dict):
        file.refuse(Mark(1, 1), "must be a mapping: camera_info or Kalibr's camchain")
    file.node = node
    return file


def _of_camera_info(
    file: CalibrationDocument, camera: str | int | None, others: dict[str, Any]
) -> CameraIntrinsics:
    if camera is not None:
        name = file.node.child("camera_name")
        known = "camera" if name is None else str(name.value)
        if camera != known:
            raise UnknownName("camera", str(camera), [known])
    size = file.size(("image_width",)), file.size(("image_height",))
    accepted = "nine numbers [fx, 0, cx, 0, fy, cy, 0, 0, 1]"
    k = file.numbers(("camera_matrix", "data"), accepted, (_MATRIX_NUMBERS,))
    model_node = file.at("distortion_model")
    if not isinstance(model_node.value, str):
        got = shown(model_node.plain())
        file.refuse(model_node.mark, f"must be the name of a model, got {got}", "distortion_model")
    model = model_node.value
    coefficients = file.numbers(("distortion_coefficients", "data"), "numbers")
    if model == _PLUMB_BOB and not any(coefficients):
        model, coefficients = "pinhole", []
    lens = {**others, "distortion_model": model, "distortion": tuple(coefficients)}
    matrix = {"fx": k[0], "fy": k[4], "cx": k[2], "cy": k[5]}
    return file.lens(model_node.mark, size, matrix, lens)


def _kalibr_names(file: CalibrationDocument) -> list[str]:
    """Return the names of a camchain's cameras; it must have one."""
    cameras = [
        key
        for key, child in file.node.value.items()
        if isinstance(child.value, dict) and "camera_model" in child.value
    ]
    if not cameras:
        file.refuse(
            file.node.mark,
            "has neither camera_matrix (of a camera_info) nor a camera with camera_model (of "
            "Kalibr's camchain)",
        )
    return cameras


def _of_kalibr(
    file: CalibrationDocument, camera: str | int | None, others: dict[str, Any]
) -> CameraIntrinsics:
    cameras = _kalibr_names(file)
    chosen = cameras[0] if camera is None and len(cameras) == 1 else camera
    if chosen not in cameras:
        raise UnknownName("camera", "none" if chosen is None else str(chosen), cameras)
    name = str(chosen)
    kind = file.word((name, "camera_model"), tuple(_KALIBR_CAMERAS))
    names = _KALIBR_CAMERAS[kind]
    accepted = f"{len(names)} numbers {', '.join(names)}"
    values = file.numbers((name, "intrinsics"), accepted, (len(names),))
    matrix = dict(zip(names, values, strict=True))
    distortions = [distortion for one, distortion in _KALIBR_MODELS if one == kind]
    distortion = file.word((name, "distortion_model"), distortions)
    own = values[: -len(("fx", "fy", "cx", "cy"))]
    if distortion != "none":
        own += file.numbers((name, "distortion_coeffs"), "four numbers", (_KALIBR_COEFFICIENTS,))
    elif kind == "omni":
        own = [*own, 0.0, 0.0, 0.0, 0.0]
    place = (name, "resolution")
    file.numbers(place, "two integers [width, height]", (2,))
    size = file.size((*place, 0)), file.size((*place, 1))
    model = _KALIBR_MODELS[kind, distortion]
    lens = {**others, "distortion_model": model, "distortion": tuple(own)}
    return file.lens(file.at(name).mark, size, matrix, lens)


def _of_colmap(
    file: CalibrationDocument, text: str, camera: str | int | None, others: dict[str, Any]
) -> CameraIntrinsics:
    lines = {
        words[0]: (number, words)
        for number, line in enumerate(text.splitlines(), 1)
        if (words := line.split()) and not line.lstrip().startswith("#")
    }
    if not lines:
        file.refuse(Mark(1, 1), "has no cameras: lines CAMERA_ID MODEL WIDTH HEIGHT PARAMS...")
    chosen = next(iter(lines)) if camera is None and len(lines) == 1 else str(camera)
    if chosen not in lines:
        raise UnknownName("camera", chosen, lines)
    number, words = lines[chosen]
    line = text.splitlines()[number - 1]

    def mark(word: int) -> Mark:
        at = 0
        for one in words[:word]:
            at = line.index(one, at) + len(one)
        return Mark(number, line.index(words[word], at) + 1 if word < len(words) else len(line) + 1)

    if len(words) < len(("id", "model", "width", "height")):
        file.refuse(mark(len(words)), "must be CAMERA_ID MODEL WIDTH HEIGHT PARAMS...")
    if words[1] not in _COLMAP_MODELS:
        known = ", ".join(_COLMAP_MODELS)
        file.refuse(mark(1), f"must be one of: {known}; got {shown(words[1])}")
    model, order = _COLMAP_MODELS[words[1]]
    names = order.split()
    values = []
    for index, word in enumerate(words[2:], 2):
        try:
            values.append(float(word))
        except ValueError:
            file.refuse(mark(index), f"must be a number, got {shown(word)}")
    width, height, *parameters = values
    if len(parameters) != len(names):
        accepted = f"must be {len(names)} parameters of {words[1]}: {order}"
        file.refuse(mark(min(4, len(words))), f"{accepted}; got {len(parameters)}")
    for index, side in ((2, width), (3, height)):
        accepted = SIZE.refused(int(side) if side.is_integer() else side)
        if accepted:
            file.refuse(mark(index), f"must be {accepted}, got {shown(words[index])}")
    told = dict(zip(names, parameters, strict=True))
    focal = {"fx": told["f"], "fy": told["f"]} if "f" in told else told
    matrix = {
        "fx": focal["fx"],
        "fy": focal["fy"],
        "cx": told["cx"] - COLMAP_CORNER_PX,
        "cy": told["cy"] - COLMAP_CORNER_PX,
    }
    coefficients = parameters[names.index("cy") + 1 :]
    if model == _PLUMB_BOB:
        coefficients += [0.0] * (4 - len(coefficients))
    lens = {**others, "distortion_model": model, "distortion": tuple(coefficients)}
    return file.lens(mark(1), (int(width), int(height)), matrix, lens)


def colmap_camera(lens: CameraIntrinsics) -> tuple[str, tuple[float, ...]]:
    """Return COLMAP's name of a lens's model, and its parameters in COLMAP's order.

    Raises
    ------
    InvalidRequest
        If COLMAP has no such model.
    """
    given = tuple(lens.distortion)
    # A model that has all of the lens's coefficients; what it has besides is 0.
    for name, (model, order) in _COLMAP_MODELS.items():
        names = order.split()
        room = len(names) - names.index("cy") - 1
        if "fx" in names and model == lens.distortion_model and not any(given[room:]):
            own = (*given, *(0.0,) * room)[:room]
            corner = COLMAP_CORNER_PX
            return name, (lens.fx, lens.fy, lens.cx + corner, lens.cy + corner, *own)
    if lens.distortion_model == _PLUMB_BOB:  # with k3, which stands elsewhere
        k1, k2, p1, p2, k3 = given
        made = replace(
            lens,
            distortion_model="rational_polynomial",
            distortion=(k1, k2, p1, p2, k3, 0.0, 0.0, 0.0),
        )
        return colmap_camera(made)
    models = sorted({model for model, _ in _COLMAP_MODELS.values()})
    accepted = f"one of {', '.join(models)} without thin prism, the models that COLMAP has"
    raise InvalidRequest("distortion_model", lens.distortion_model, accepted)
