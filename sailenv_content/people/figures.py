"""From a person's build to the vertices of the body: the sum of MakeHuman's macro targets."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np
from numpy.typing import NDArray

from sailenv_content.people.makehuman import BODY_VERTICES, BodyData

__all__ = ["Build", "figure"]

Doubles = NDArray[np.float64]
Shares = dict[str, float]

_AGES = ("baby", "child", "young", "old")
_AGE_YEARS = (1.0, 12.0, 25.0, 90.0)
_LEAST_SHARE = 1e-6
_HALVINGS = 24


@dataclass(frozen=True, slots=True, kw_only=True)
class Build:
    """Measures of a body.

    Attributes
    ----------
    female : float
        0 to 1.
    age_years : float
        1 to 90.
    stature_m : float
        From the soles to the top of the head [m].
    muscle, weight, proportions : float
        0 to 1; 0.5 is the average of that age.
    african, asian, caucasian : float
        Shares of the three shapes of faces and bodies that the data has.
    """

    female: float
    age_years: float
    stature_m: float
    muscle: float = 0.5
    weight: float = 0.5
    proportions: float = 0.2
    african: float = 1.0
    asian: float = 1.0
    caucasian: float = 1.0


def figure(data: BodyData, build: Build) -> Doubles:
    """Return the (V, 3) vertices of a body and its helpers [m]; the soles are at z = 0."""
    short = _moved(data, data.base, _targets(build))
    taller = _moved(data, np.zeros_like(short), _height_targets(build))
    least, most = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (least + most)
        column = short[:BODY_VERTICES, 2] + middle * taller[:BODY_VERTICES, 2]
        least, most = (middle, most) if np.ptp(column) < build.stature_m else (least, middle)
    vertices = short + 0.5 * (least + most) * taller
    vertices[:, 2] -= vertices[:BODY_VERTICES, 2].min()
    return vertices


def _moved(data: BodyData, vertices: Doubles, targets: Iterable[tuple[str, float]]) -> Doubles:
    """Return vertices that shares of targets have moved."""
    found = vertices.copy()
    for name, share in targets:
        if abs(share) > _LEAST_SHARE:
            found += share * data.target(name)
    return found


def _height_targets(build: Build) -> Iterator[tuple[str, float]]:
    """Yield what takes the smallest body of an age to the tallest one."""
    for kind, share in _kinds(build):
        yield f"macrodetails/height/{kind}-maxheight", share
        yield f"macrodetails/height/{kind}-minheight", -share


def _kinds(build: Build) -> Iterator[tuple[str, float]]:
    muscles = _between(build.muscle, (0.0, 0.5, 1.0), ("minmuscle", "averagemuscle", "maxmuscle"))
    weights = _between(build.weight, (0.0, 0.5, 1.0), ("minweight", "averageweight", "maxweight"))
    genders, ages = _genders_and_ages(build)
    for gender, age, muscle, weight in product(genders, ages, muscles, weights):
        share = genders[gender] * ages[age] * muscles[muscle] * weights[weight]
        yield f"{gender}-{age}-{muscle}-{weight}", share


def _genders_and_ages(build: Build) -> tuple[Shares, Shares]:
    genders = {"male": 1.0 - build.female, "female": build.female}
    return genders, _between(build.age_years, _AGE_YEARS, _AGES)


def _targets(build: Build) -> Iterator[tuple[str, float]]:
    """Yield the targets of the smallest body, and their shares."""
    genders, ages = _genders_and_ages(build)
    whole = build.african + build.asian + build.caucasian
    races = {
        "african": build.african / whole,
        "asian": build.asian / whole,
        "caucasian": build.caucasian / whole,
    }
    for race, gender, age in product(races, genders, ages):
        share = races[race] * genders[gender] * ages[age]
        yield f"macrodetails/{race}-{gender}-{age}", share
    for kind, share in _kinds(build):
        yield f"macrodetails/universal-{kind}", share
        yield f"macrodetails/height/{kind}-minheight", share
        if "-baby-" not in kind:
            ideal = share * build.proportions
            yield f"macrodetails/proportions/{kind}-idealproportions", ideal


def _between(value: float, anchors: tuple[float, ...], names: tuple[str, ...]) -> Shares:
    """Return the shares of the two anchors that a value lies between."""
    place = int(np.clip(np.searchsorted(anchors, value) - 1, 0, len(anchors) - 2))
    share = (value - anchors[place]) / (anchors[place + 1] - anchors[place])
    share = min(max(share, 0.0), 1.0)
    found = {names[place]: 1.0 - share, names[place + 1]: share}
    return {name: part for name, part in found.items() if part > 0.0}
