"""Files of calibrations by other programs → `CameraIntrinsics`, or a `SceneError` with its place.

The `camera_info` YAML of camera_calibration and camera_info_manager, Kalibr's `camchain.yaml`,
COLMAP's `cameras.txt`. They are data: nothing in them is run.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from sailenv_ros.errors import InvalidRequest, SceneDiagnostic, SceneError, UnknownName
from sailenv_ros.scene.documents import text_of_file
from sailenv_ros.scene.messages import shown
from sailenv_ros.scene.yaml_nodes import Loc, Mark, Node, compose
from sailenv_ros.types.camera import INTRINSICS_LIMITS, CameraIntrinsics
from sailenv_ros.types.validation import is_finite_number

__all__ = ["load_calibration"]

_SIZE = INTRINSICS_LIMITS["width"]
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

_COLMAP_CORNER_PX = 0.5
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
    file = _File(Path(path))
    others = {"near_m": near_m, "far_m": far_m, "max_angle_deg": max_angle_deg}
    text = text_of_file(file.path, "a calibration")
    if file.path.suffix.lower() == ".txt":
        return _of_colmap(file, text, camera, others)
    node, found = compose(text)
    if found:
        file.refuse(found[0].mark, found[0].message)
    if node is None or not isinstance(node.value, dict):
        file.refuse(Mark(1, 1), "must be a mapping: camera_info or Kalibr's camchain")
    file.node = node
    if "camera_matrix" in node.value:
        return _of_camera_info(file, camera, others)
    return _of_kalibr(file, camera, others)


@dataclass
class _File:
    """A file, and the place of its parts."""

    path: Path
    node: Node = field(default_factory=lambda: Node(Mark(1, 1), {}))

    def refuse(self, mark: Mark, message: str, name: str = "") -> NoReturn:
        """Raise the error of a place."""
        raise SceneError(
            [
                SceneDiagnostic(
                    path=str(self.path),
                    line=mark.line,
                    column=mark.column,
                    field=name,
                    message=message,
                )
            ]
        )

    def at(self, *loc: str | int) -> Node:
        """Return a part that must be there."""
        found: Node | None = self.node
        for depth, part in enumerate(loc):
            inner = None if found is None else found.child(part)
            if inner is None:
                self.refuse(self.node.place(loc[:depth]), "is missing", _dotted(loc))
            found = inner
        assert found is not None
        return found

    def numbers(self, loc: Loc, accepted: str, counts: Sequence[int] = ()) -> list[float]:
        """Return a list of finite numbers."""
        node = self.at(*loc)
        values = node.plain()
        fits = isinstance(values, list) and all(map(is_finite_number, values))
        if not fits or (counts and len(values) not in counts):
            self.refuse(node.mark, f"must be {accepted}, got {shown(values)}", _dotted(loc))
        return [float(value) for value in values]

    def size(self, loc: Loc) -> int:
        """Return a width or a height."""
        node = self.at(*loc)
        accepted = _SIZE.refused(node.value)
        if accepted:
            self.refuse(node.mark, f"must be {accepted}, got {shown(node.plain())}", _dotted(loc))
        return int(node.value)

    def word(self, loc: Loc, known: Sequence[str]) -> str:
        """Return a text that is one of those known."""
        node = self.at(*loc)
        if node.value not in known:
            accepted = f"must be one of: {', '.join(known)}; got {shown(node.plain())}"
            self.refuse(node.mark, accepted, _dotted(loc))
        return str(node.value)

    def lens(
        self, mark: Mark, size: Sequence[int], matrix: Mapping[str, float], others: dict[str, Any]
    ) -> CameraIntrinsics:
        """Return what the numbers make, or refuse it at a place."""
        width, height = size
        if not (matrix["fx"] > 0.0 and matrix["fy"] > 0.0):
            got = f"{matrix['fx']:g} and {matrix['fy']:g}"
            self.refuse(mark, f"makes no lens: focal lengths must be above 0 [px], got {got}")
        try:
            return CameraIntrinsics(
                width=width,
                height=height,
                fx_px=matrix["fx"],
                fy_px=matrix["fy"],
                cx_offset_px=matrix["cx"] - 0.5 * (width - 1),
                cy_offset_px=matrix["cy"] - 0.5 * (height - 1),
                **others,
            )
        except InvalidRequest as problem:
            self.refuse(mark, f"makes no lens: {problem}")


def _dotted(loc: Loc) -> str:
    return ".".join(map(str, loc))


def _of_camera_info(
    file: _File, camera: str | int | None, others: dict[str, Any]
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


def _of_kalibr(file: _File, camera: str | int | None, others: dict[str, Any]) -> CameraIntrinsics:
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
    file: _File, text: str, camera: str | int | None, others: dict[str, Any]
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
        accepted = _SIZE.refused(int(side) if side.is_integer() else side)
        if accepted:
            file.refuse(mark(index), f"must be {accepted}, got {shown(words[index])}")
    told = dict(zip(names, parameters, strict=True))
    focal = {"fx": told["f"], "fy": told["f"]} if "f" in told else told
    matrix = {
        "fx": focal["fx"],
        "fy": focal["fy"],
        "cx": told["cx"] - _COLMAP_CORNER_PX,
        "cy": told["cy"] - _COLMAP_CORNER_PX,
    }
    coefficients = parameters[names.index("cy") + 1 :]
    if model == _PLUMB_BOB:
        coefficients += [0.0] * (4 - len(coefficients))
    lens = {**others, "distortion_model": model, "distortion": tuple(coefficients)}
    return file.lens(mark(1), (int(width), int(height)), matrix, lens)
