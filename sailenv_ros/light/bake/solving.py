"""The light at points that stand for all surfaces. From points and lights to irradiance.

The points are the texels of a light map, or few of them for a draft. Knows no map.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter, minimum_filter

from sailenv_ros.light.bake.bounces import Patches, bounced_radiance
from sailenv_ros.light.bake.denoise import stand_ins
from sailenv_ros.light.bake.direct import Points, arriving, squared_distances, visible_range
from sailenv_ros.light.bake.gather import BACK, Seen, Surroundings, seen_from
from sailenv_ros.light.bake.sampling import pass_shift
from sailenv_ros.light.bake.settings import INSIDE_SHARE, BakeSettings
from sailenv_ros.light.bake.texels import Texels
from sailenv_ros.light.bake.worker_pool import in_chunks
from sailenv_ros.rays.ray_patterns import in_turns, low_discrepancy_points
from sailenv_ros.types.lights import LAMP_TYPES, Light

__all__ = ["Samples", "SolvedLight", "Solver", "Stages"]

Floats = NDArray[np.float32]

SURELY_INSIDE = 0.5
"""Share of back faces in the first pass above which a texel is not traced any further."""

CHUNK_RAYS = 131_072
"""Cast at a time by one thread: few enough to stay in its cache."""

EDGE_SHARE = 0.03
"""Least difference between neighbours' shares of a light at which a shadow edge is assumed."""

CLOSE_M = 0.15
"""Surfaces nearer to the middle of a lamp are close to it [m]."""

EDGE_TEXELS = 5
"""Side of the squares of neighbours."""


class Stages:
    """Reports how far a bake is, and shares its work among threads.

    Parameters
    ----------
    report : callable
        Is told the name of the stage and which share of the whole is done, 0 to 1.
    workers : int
        Threads; 0 is one for each core.
    """

    def __init__(self, report: Callable[[str, float], None], workers: int) -> None:
        self._report, self.workers = report, workers or os.cpu_count() or 1
        self._done = 0.0

    def begin(self, stage: str, weight: float) -> Callable[[float], None]:
        """Begin a stage that takes this share of the whole time."""
        begun, self._done = self._done, min(self._done + weight, 1.0)
        self._report(stage, begun)
        return lambda share: self._report(stage, begun + weight * share)

    def run(
        self,
        work: Callable[[int, int], None],
        count: int,
        rays: int,
        report: Callable[[float], None] = lambda share: None,
    ) -> None:
        """Do ``work(first, end)`` for all of `count` points with so many rays each."""
        size = max(CHUNK_RAYS // max(rays, 1), 1)
        in_chunks(work, count, size, self.workers, report)


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Samples:
    """Points that stand for all surfaces.

    Attributes
    ----------
    around : Surroundings
        Its `index` holds numbers of the points.
    points : Points
    patches : Patches
        Groups of the points, among which light is handed on.
    albedo, emission : (N, 3) float32
    glows : mapping of str to (N, 3) float32
        What points emit besides by a light of intensity 1, by its name: shades of lamps.
    texels : Texels or None
        The points' places in a map; None if neighbours are not near to each other.
    owner : (N,) int32 or None
        The instance of each texel; None like `texels`.
    """

    around: Surroundings
    points: Points
    patches: Patches
    albedo: Floats
    emission: Floats
    glows: Mapping[str, Floats] = field(default_factory=dict)
    texels: Texels | None = None
    owner: NDArray[np.int32] | None = None

    @property
    def count(self) -> int:
        """Number of texels."""
        return len(self.albedo)


@dataclass(frozen=True, eq=False, slots=True)
class SolvedLight:
    """Direct light of one source, and the visible share of a directional one.

    `light` is None for the surroundings, of which nothing counts as straight; `mixed` are the
    points near which a shadow of a directional one ends.
    """

    light: Light | None
    direct: Floats
    visibility: Floats | None = None
    mixed: NDArray[np.intp] | None = None


class Solver:
    """Computes the light at samples, from what is needed first to what refines it.

    Attributes
    ----------
    valid : (N,) bool
        False for points inside of something.
    nearness : (N,) float32
        Harmonic mean of the distances of what each point sees [m].
    lights : list of SolvedLight
        The surroundings first.
    radiance : (N, 3 L) float32
        What rays to each point meet, light by light: what it sends out, or its stand-in does.
    bounced : (N, 3 L) float32
        Irradiance / pi from other surfaces and from the sky: the mean of all passes so far.
    """

    def __init__(
        self, samples: Samples, lights: Sequence[Light], settings: BakeSettings, stages: Stages
    ) -> None:
        self._samples, self._settings, self._stages = samples, settings, stages
        self._given = lights
        self._passes = 0
        self._closeness = np.zeros(samples.count, np.float32)
        self._backs = np.zeros(samples.count, np.float32)
        self.lights = [SolvedLight(None, np.zeros(samples.count, np.float32))]
        self.radiance = self.bounced = np.zeros((samples.count, 0), np.float32)

    @property
    def valid(self) -> NDArray[np.bool_]:
        """See the class."""
        return np.asarray(self._backs <= INSIDE_SHARE * self._passes)

    @property
    def nearness(self) -> Floats:
        """See the class."""
        return np.reciprocal(np.maximum(self._closeness / max(self._passes, 1), np.float32(1e-6)))

    def begin(self, weights: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> None:
        """Look around, find what arrives straight, and hand it on.

        Parameters
        ----------
        weights : three float
            Shares of the whole time.
        """
        samples, settings = self._samples, self._settings
        seen = np.empty((samples.count, settings.pass_rays), np.int32)
        sky = np.empty((samples.count, 3), np.float32)
        parts: dict[int, Seen] = {}

        def keep(chosen: slice, found: Seen) -> None:
            seen[chosen], sky[chosen] = found.texels, found.sky
            parts[chosen.start] = replace(found, texels=seen[chosen], sky=sky[chosen])

        self._look(keep, 0, self._stages.begin("surroundings", weights[0]))
        self._passes = 1
        valid = self.valid
        stands_in = self._stand_ins(valid)
        self._outside = self._backs <= SURELY_INSIDE
        for light in self._given:
            report = self._stages.begin(light.name, weights[1] / len(self._given))
            self.lights.append(self._straight(light, report))
        report = self._stages.begin("bounces", weights[2])
        albedo = samples.albedo
        first = np.concatenate(
            [
                samples.emission + albedo * sky,
                *(self._sent_straight(light) for light in self.lights[1:]),
            ],
            axis=1,
        )
        first[~valid] = 0.0
        self.radiance = bounced_radiance(
            samples.patches, seen, valid, stands_in, first, albedo, settings.bounces,
            self._stages.workers,
        )  # fmt: skip
        self.radiance[~valid] = 0.0
        self.radiance = self.radiance[stands_in]
        self.bounced = np.empty_like(first)

        def gather(start: int, end: int) -> None:
            self.bounced[start:end] = parts[start].light(self.radiance)

        self._stages.run(gather, samples.count, settings.pass_rays)

    def _stand_ins(self, valid: NDArray[np.bool_]) -> NDArray[np.int32]:
        texels, owner = self._samples.texels, self._samples.owner
        if texels is None or owner is None:
            return np.arange(self._samples.count, dtype=np.int32)
        return stand_ins(texels, owner, valid)

    def _sent_straight(self, solved: SolvedLight) -> Floats:
        """Return (N, 3): what points send out by what arrives straight, and as the light's lamp."""
        assert solved.light is not None
        sent: Floats = self._samples.albedo * solved.direct[:, None]
        glow = self._samples.glows.get(solved.light.name)
        return sent if glow is None else sent + glow

    def refine(self, report: Callable[[float], None]) -> None:
        """Cast rays once more, between those that were cast before."""
        self._passes += 1
        share = np.float32(1.0 / self._passes)

        def add(chosen: slice, found: Seen) -> None:
            light = found.light(self.radiance)
            self.bounced[chosen] += (light - self.bounced[chosen]) * share

        self._look(add, self._passes - 1, report)

    def _look(
        self,
        take: Callable[[slice, Seen], None],
        number: int,
        report: Callable[[float], None],
    ) -> None:
        """Cast the rays of a pass; hand over what they found."""
        samples, settings = self._samples, self._settings
        pattern = in_turns(low_discrepancy_points(settings.pass_rays))
        window_pattern = low_discrepancy_points(settings.window_rays)
        shift = pass_shift(number)

        def look(first: int, end: int) -> None:
            chosen = slice(first, end)
            points = samples.points.part(chosen).moved(shift)
            seen = seen_from(samples.around, points, pattern, window_pattern)
            self._closeness[chosen] += seen.closeness
            self._backs[chosen] += np.mean(seen.texels == BACK, axis=1)
            take(chosen, seen)

        self._stages.run(look, samples.count, settings.pass_rays, report)

    def _straight(self, light: Light, report: Callable[[float], None]) -> SolvedLight:
        count, settings = self._samples.count, self._settings
        direct, visibility = np.zeros(count, np.float32), np.zeros(count, np.float32)
        edge_rays = settings.light_rays * self._times_of_rays(light)
        known = self._known_shares(light, edge_rays // 4)
        scene = self._samples.around.scene

        def shine_on(lit: NDArray[np.intp], rays: int, given: Floats | None) -> None:
            pattern = low_discrepancy_points(rays)

            def shine(first: int, end: int) -> None:
                chosen = lit[first:end]
                direct[chosen], visibility[chosen] = arriving(
                    scene, light, self._samples.points.part(chosen), pattern,
                    None if given is None else given[chosen],
                )  # fmt: skip

            self._stages.run(shine, len(lit), rays, report)

        mixed = np.flatnonzero(self._outside & np.isnan(known))
        shine_on(mixed, edge_rays, None)
        shine_on(np.flatnonzero(self._outside & (known > 0.0)), settings.light_rays, known)
        if light.type != "directional":
            return SolvedLight(light, direct)
        return SolvedLight(light, direct, visibility, mixed)

    def _times_of_rays(self, light: Light) -> int:
        """Return how many times as many rays a light needs: more where surfaces are close to it."""
        if light.type not in LAMP_TYPES:
            return 1
        near = squared_distances(light, self._samples.points.positions) < CLOSE_M**2
        return 4 if near.any() else 1

    def _known_shares(self, light: Light, rays: int) -> Floats:
        """Return (N,) float32: how much of a light arrives where no shadow ends; else NaN."""
        texels, points = self._samples.texels, self._samples.points
        if texels is None:
            return np.full(self._samples.count, np.nan, np.float32)
        count, pattern = texels.count, low_discrepancy_points(rays)
        lowest, highest = np.empty((2, count), np.float32)
        scene = self._samples.around.scene

        def find(first: int, end: int) -> None:
            chosen = slice(first, end)
            lowest[chosen], highest[chosen] = visible_range(
                scene, light, points.part(chosen), pattern
            )

        self._stages.run(find, count, len(pattern))
        lowest[~self._outside], highest[~self._outside] = np.inf, -np.inf
        at = texels.rows, texels.columns
        least = np.full(texels.index.shape, np.inf, np.float32)
        most = np.full(texels.index.shape, -np.inf, np.float32)
        least[at], most[at] = lowest, highest
        least = minimum_filter(least, EDGE_TEXELS)[at]
        most = maximum_filter(most, EDGE_TEXELS)[at]
        with np.errstate(invalid="ignore"):
            alike = most - least < EDGE_SHARE
        # Where no ray leaves a texel none arrives, as long as its neighbours are alike, too.
        seen = np.isfinite(lowest)
        own = np.zeros(count, np.float32)
        own[seen] = 0.5 * (lowest[seen] + highest[seen])
        return np.where(alike, own, np.float32(np.nan)).astype(np.float32)
