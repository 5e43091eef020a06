"""The law of a lens: rays of the optical frame to places of the normalised plane, and back.

Place (x, y) is pixel (fx x + cx, fy y + cy). The models are the native library's; what users give
of them is checked here, in words.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.native.lens_models import (
    LensModel,
    LensReach,
    lens_models,
    lens_reach,
    padded_coefficients,
    project_points,
    unproject_places,
)
from sailenv_ros.system.threads import thread_count
from sailenv_ros.types.validation import Bounds, is_finite_number, shown_number

__all__ = ["PINHOLE", "LensLaw", "checked_coefficients", "law_of_lens"]

PINHOLE = "pinhole"
"""Name of the model without distortion."""


@dataclass(frozen=True)
class LensLaw:
    """A model with its coefficients, and how far it is used.

    Attributes
    ----------
    model : LensModel
    coefficients : tuple of float
        As many as were given.
    reach : LensReach
        How far the law goes.
    limit_rad : float
        Largest angle from the axis that is seen [rad], at most ``reach.angle_rad``.
    """

    model: LensModel
    coefficients: tuple[float, ...]
    reach: LensReach
    limit_rad: float

    @cached_property
    def padded(self) -> NDArray[np.float64]:
        """(12,) float64 read-only: the coefficients as kernels take them."""
        padded = padded_coefficients(self.coefficients)
        padded.flags.writeable = False
        return padded

    def project(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return the places (..., 2) of points (..., 3) of the optical frame; nan for unseen."""
        p = np.asarray(points, np.float64)
        flat = np.ascontiguousarray(p.reshape(-1, 3))
        places = project_points(
            self.model.number, self.padded, self.limit_rad, flat, threads=thread_count()
        )
        return places.reshape(*p.shape[:-1], 2)

    def unproject(self, places: ArrayLike) -> NDArray[np.float64]:
        """Return the unit rays (..., 3) that lead to places (..., 2); nan where none does."""
        p = np.asarray(places, np.float64)
        flat = np.ascontiguousarray(p.reshape(-1, 2))
        rays = unproject_places(
            self.model.number, self.padded, self.limit_rad, flat, threads=thread_count()
        )
        return rays.reshape(*p.shape[:-1], 3)

    def height_of_fov(self, vertical_fov_deg: float) -> float:
        """Return how far below the axis a picture of a vertical angle of view ends in the plane.

        Raises
        ------
        InvalidRequest
            If the law does not go so far.
        """
        if self.model.parallel:
            raise InvalidRequest("fx_px", 0.0, "above 0 [px/m], since all rays are parallel")
        most = _rounded_down(2.0 * self.reach.vertical_rad)
        bounds = Bounds(least=1.0, most=most, unit="deg")
        half = 0.5 * math.radians(bounds.number("vertical_fov_deg", vertical_fov_deg))
        angle = min(half, (1.0 - 1e-12) * self.reach.vertical_rad)
        whole = LensLaw(self.model, self.coefficients, self.reach, self.reach.angle_rad)
        return float(whole.project((0.0, math.sin(angle), math.cos(angle)))[1])

    def fov_of_height(self, height: float) -> float:
        """Return the vertical angle of view [deg] of a picture that ends there in the plane."""
        if self.model.parallel:
            return 0.0
        x, y, z = self.unproject((0.0, height)).tolist()
        angle = math.atan2(math.hypot(x, y), z)
        return 2.0 * math.degrees(self.limit_rad if math.isnan(angle) else angle)

    def slope(self) -> float:
        """Return how fast places move from the axis, per length at depth 1 m."""
        small = 1e-6
        return float(self.project((0.0, small, 1.0))[1] - self.project((0.0, 0.0, 1.0))[1]) / small

    def require_unfolded(self, corners: ArrayLike) -> None:
        """Refuse a law that folds within a picture with these corners (N, 2) in the plane.

        Where the image circle ends before, the picture's corners may lie beyond the fold.

        Raises
        ------
        InvalidRequest
        """
        if not self.reach.folds or self.limit_rad < self.reach.angle_rad:
            return
        if np.isnan(self.unproject(corners)).any():
            accepted = (
                "coefficients that do not fold within the picture, or max_angle_deg must be less "
                f"than {shown_number(_rounded_down(self.reach.angle_rad))} [deg], where these fold"
            )
            raise InvalidRequest("distortion", [*self.coefficients], accepted)

    def mirrored_coefficients(self) -> tuple[float, ...]:
        """Return the coefficients of the law with left and right exchanged."""
        named = zip(self.model.coefficients, self.coefficients, strict=False)
        return tuple(-value if name in self.model.odd else value for name, value in named)


def checked_coefficients(name: str, given: object) -> tuple[float, ...]:
    """Return the coefficients of a model as numbers.

    Raises
    ------
    UnknownName, InvalidRequest
        If there is no such model, or it has another number of coefficients.
    """
    model = lens_models().get(name) if isinstance(name, str) else None
    if model is None:
        raise UnknownName("distortion_model", name, lens_models())
    accepted = _coefficients_in_words(model)
    if not isinstance(given, Iterable) or isinstance(given, str | bytes):
        raise InvalidRequest("distortion", given, accepted)
    values = tuple(given)
    if len(values) not in model.counts or not all(map(is_finite_number, values)):
        raise InvalidRequest("distortion", [*values], accepted)
    return tuple(map(float, values))


@lru_cache(maxsize=256)
def law_of_lens(name: str, coefficients: tuple[float, ...], max_angle_deg: float) -> LensLaw:
    """Return the law of a lens.

    Parameters
    ----------
    name : str
        Of the model.
    coefficients : tuple of float
        Of `checked_coefficients`.
    max_angle_deg : float
        Angle from the axis at which the image circle ends [deg]; 0: where the law does.

    Raises
    ------
    InvalidRequest
        If the coefficients make no law, or it ends before that angle.
    """
    model = lens_models()[name]
    reach = lens_reach(model.number, coefficients)
    if not reach.angle_rad > 0.0:
        accepted = f"coefficients of {name} with {model.accepted}"
        raise InvalidRequest("distortion", [*coefficients], accepted)
    if not max_angle_deg:
        return LensLaw(model, coefficients, reach, reach.angle_rad)
    if model.parallel:
        raise InvalidRequest("max_angle_deg", max_angle_deg, "0, since all rays are parallel")
    limit_rad = math.radians(max_angle_deg)
    if limit_rad > (1.0 + 1e-12) * reach.angle_rad:
        why = "folds" if reach.folds else "ends"
        most = shown_number(_rounded_down(reach.angle_rad))
        accepted = f"at most {most} [deg], where the law of {name} {why}"
        raise InvalidRequest("max_angle_deg", max_angle_deg, accepted)
    return LensLaw(model, coefficients, reach, min(limit_rad, reach.angle_rad))


def _coefficients_in_words(model: LensModel) -> str:
    if not model.coefficients:
        return f"empty, since {model.name} has no coefficients"
    names = " ".join(model.coefficients)
    counts = " or ".join(map(str, model.counts))
    return f"{counts} finite numbers, the coefficients {names} of {model.name}"


def _rounded_down(angle_rad: float) -> float:
    """Return an angle in degrees, with digits to show."""
    return math.floor(1e4 * math.degrees(angle_rad) + 1e-6) / 1e4
