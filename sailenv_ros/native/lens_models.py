"""The models of lenses as the native library has them: names, coefficients, limits, kernels.

The laws are headers in src/kernels/lens_models; `table.h` lists them. Nothing of a model is told
twice: its name and its coefficients come from its header.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.errors import NativeLibraryError
from sailenv_ros.native.library import Kernel, checked
from sailenv_ros.native.records import RecordKernel

__all__ = [
    "MOST_COEFFICIENTS",
    "LensModel",
    "LensReach",
    "lens_models",
    "lens_reach",
    "padded_coefficients",
    "project_points",
    "unproject_places",
]

MOST_COEFFICIENTS = 12
"""`sailenv::MOST_COEFFICIENTS` of law.h."""

_TEXT_BYTES = 1024
_MOST_MODELS = 256

_TEXT = Kernel("lens_model_text", "iai")
_REACH = Kernel("lens_reach", "iaa")
_UNPROJECT = RecordKernel(
    "unproject_places",
    ("integer", "model"),
    ("array", "coefficients"),
    ("number", "limit"),
    ("array", "places rays"),
    ("integer", "count"),
)
_PROJECT = RecordKernel(
    "project_points",
    ("integer", "model"),
    ("array", "coefficients"),
    ("number", "limit"),
    ("array", "points places"),
    ("integer", "count"),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class LensModel:
    """A model of lenses: its names, and which coefficients it takes.

    Attributes
    ----------
    number : int
        Its place in the library's table.
    name : str
        As in ``CameraInfo.distortion_model``, where ROS has a name for it.
    coefficients : tuple of str
        Names of its coefficients, in order.
    counts : tuple of int
        How many of them may be given, from the first on; the others are 0.
    odd : frozenset of str
        Coefficients that change their signs where left and right are exchanged.
    parallel : bool
        True if all rays have one direction, and none the same origin.
    accepted : str
        Which coefficients make a law, in words.
    """

    number: int
    name: str
    coefficients: tuple[str, ...]
    counts: tuple[int, ...]
    odd: frozenset[str]
    parallel: bool
    accepted: str


@dataclass(frozen=True, slots=True)
class LensReach:
    """How far the law of a lens goes.

    Attributes
    ----------
    angle_rad : float
        Largest angle from the axis [rad]; 0 if there is no such law.
    vertical_rad : float
        The same straight up and down, where the model has less there [rad].
    folds : bool
        True if it ends because the distance in the picture would shrink again.
    """

    angle_rad: float
    vertical_rad: float
    folds: bool


def lens_models() -> Mapping[str, LensModel]:
    """Return all models by name, in the order of the library's table.

    Raises
    ------
    NativeLibraryError
        If there is no library.
    """
    return _models()


@lru_cache(maxsize=1)
def _models() -> Mapping[str, LensModel]:
    models: dict[str, LensModel] = {}
    for number in range(_MOST_MODELS):
        text = np.zeros(_TEXT_BYTES, np.uint8)
        try:
            _TEXT(number, text, len(text))
        except NativeLibraryError:
            if not models:
                raise
            break
        lines = text.tobytes().partition(b"\0")[0].decode().split("\n")
        name, coefficients, counts, odd, rays, accepted = lines
        models[name] = LensModel(
            number=number,
            name=name,
            coefficients=tuple(coefficients.split()),
            counts=tuple(map(int, counts.split())),
            odd=frozenset(odd.split()),
            parallel=rays == "parallel",
            accepted=accepted,
        )
    return MappingProxyType(models)


def padded_coefficients(coefficients: Sequence[float]) -> NDArray[np.float64]:
    """Return (MOST_COEFFICIENTS,) float64: coefficients as kernels take them."""
    padded = np.zeros(MOST_COEFFICIENTS)
    padded[: len(coefficients)] = coefficients
    return padded


@lru_cache(maxsize=256)
def lens_reach(model: int, coefficients: tuple[float, ...]) -> LensReach:
    """Return how far the law of a model goes with its coefficients.

    Parameters
    ----------
    model : int
        Its `LensModel.number`.
    coefficients : tuple of float
        Finite numbers.
    """
    found = np.zeros(3)
    _REACH(model, padded_coefficients(coefficients), found)
    angle, vertical, folds = found.tolist()
    return LensReach(angle, vertical, bool(folds))


def unproject_places(
    model: int,
    coefficients: NDArray[np.float64],
    limit_rad: float,
    places: NDArray[np.float64],
    *,
    threads: int,
) -> NDArray[np.float64]:
    """Return the rays that lead to places of the normalised plane.

    Parameters
    ----------
    model : int
        A `LensModel.number`.
    coefficients : (MOST_COEFFICIENTS,) float64
    limit_rad : float
        Largest angle from the axis [rad]; at most the law's own.
    places : (N, 2) float64
        The pixels less (cx, cy), over (fx, fy).
    threads : int

    Returns
    -------
    rays : (N, 3) float64
        Unit vectors in the optical frame; ``nan`` where no ray leads. A fresh array.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        If an array is not as said, or there is no such model.
    """
    checked("coefficients", coefficients, np.float64, (MOST_COEFFICIENTS,))
    checked("places", places, np.float64, (None, 2))
    rays = np.empty((len(places), 3))
    _UNPROJECT(
        threads,
        model=model,
        coefficients=coefficients,
        limit=limit_rad,
        places=places,
        rays=rays,
        count=len(places),
    )
    return rays


def project_points(
    model: int,
    coefficients: NDArray[np.float64],
    limit_rad: float,
    points: NDArray[np.float64],
    *,
    threads: int,
) -> NDArray[np.float64]:
    """Return where points of the optical frame lie in the normalised plane.

    Parameters
    ----------
    model, coefficients, limit_rad, threads
        As `unproject_places` takes them.
    points : (N, 3) float64
        In the optical frame [m].

    Returns
    -------
    places : (N, 2) float64
        ``nan`` where the lens does not see the point. A fresh array.

    Raises
    ------
    InvalidRequest, NativeLibraryError
        As `unproject_places`.
    """
    checked("coefficients", coefficients, np.float64, (MOST_COEFFICIENTS,))
    checked("points", points, np.float64, (None, 3))
    places = np.empty((len(points), 2))
    _PROJECT(
        threads,
        model=model,
        coefficients=coefficients,
        limit=limit_rad,
        points=points,
        places=places,
        count=len(points),
    )
    return places
