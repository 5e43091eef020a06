"""From a lit picture to what an agent sees: occlusion, glass, bloom, noise, tone curve, JPEG.

Radiance and surfaces come in, an 8-bit sRGB picture or RAW data go out. Everything happens on the
processor, on copies: ground truth never passes through here. What is off costs nothing.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.picture import ambient_occlusion, supersampling, tone_map
from sailenv_ros.render.picture.auto_exposure import followed, picture_exposure
from sailenv_ros.render.picture.optics import through_lens
from sailenv_ros.render.picture.raw_data import raw_data
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.render.picture.tone import code_table
from sailenv_ros.render.picture.white_balance import white_balanced
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import AdaptedExposure, WorldSnapshot

__all__ = ["Light", "PostPass"]

BESIDE_RAYS = 0.5
"""Share of the occlusion's strength where rays have found the light of what can move: they know
what stands near it, and leave to the picture what hides an object from itself."""


class Light(NamedTuple):
    """Light of a picture's pixels.

    Attributes
    ----------
    radiance : (H, W, 4) float16
        Linear, as the scene's exposure left it, and the share of it that came from around.
    shade : AmbientShade or None
        What occlusion takes away of it yet, at `surface`.
    surface : (H, W, 2) float32 or None
    """

    radiance: NDArray[np.float16]
    shade: tone_map.AmbientShade | None = None
    surface: NDArray[np.float32] | None = None


class PostPass:
    """Finishes pictures.

    Parameters
    ----------
    threads : int
        How many work on a picture; it does not depend on it.
    """

    def __init__(self, threads: int) -> None:
        self._threads = threads

    def gathered(
        self,
        radiance: NDArray[np.float16],
        surface: NDArray[np.float32],
        snapshot: WorldSnapshot,
        camera: Camera,
        still: NDArray[np.bool_],
        samples: NDArray[np.float32] | None = None,
    ) -> Light:
        """Return the light of what was lit, by pixels.

        Parameters
        ----------
        radiance : (H, W, 4) float16
            See `tone_map.tone_map`; of a camera with supersampling, of its samples.
        surface : (H, W, 2) float32
            Depth [m] and instance id; not written to.
        still : (N,) bool
            Which instances have baked light where they are.
        samples : float32 array or None
            Like `surface`, of the samples; needed where there are any and occlusion is on.
        """
        settings = camera.picture
        shade: tone_map.AmbientShade | None = None
        if settings.occlusion_strength > 0.0:
            strength = BESIDE_RAYS if snapshot.object_light else 1.0
            shade = ambient_occlusion.ambient_visibility(
                surface,
                camera.intrinsics,
                strength=strength * settings.occlusion_strength,
                radius_m=settings.occlusion_radius_m,
                known=_known(snapshot, still),
                threads=self._threads,
            )
        if settings.supersampling > 1:
            times = settings.supersampling
            radiance = supersampling.mean_radiance(
                radiance, times, shade, samples, threads=self._threads
            )
            shade = None
        return Light(radiance, shade, surface)

    def at_sensor(self, light: Light) -> NDArray[np.float16]:
        """Return (H, W, 4) float16: light with what occlusion takes away."""
        if light.shade is None or light.surface is None:
            return light.radiance
        return tone_map.apply_visibility(
            light.radiance, *light.shade, light.surface, threads=self._threads
        )

    def adapted(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        camera: Camera,
        surface: NDArray[np.float32],
        before: AdaptedExposure | None,
    ) -> AdaptedExposure:
        """Return the automatic exposure for light that has lost what occlusion takes away.

        Parameters
        ----------
        surface : (H, W, 2) float32
            What is seen through windows does not count.
        """
        wanted = picture_exposure(light.radiance, _inside(surface, snapshot))
        return followed(before, wanted, snapshot.sim_time_ns, camera.picture.auto_exposure_s)

    def developed(self, light: Light, snapshot: WorldSnapshot, camera: Camera) -> NDArray[np.uint8]:
        """Return (H, W, 3) uint8: the sRGB picture of light; a fresh array."""
        settings = camera.picture
        if settings.bloom > 0.0 or settings.full_well > 0.0:
            # Light is spread and counted as it arrives at the sensor.
            radiance = sensor_light(
                self.at_sensor(light),
                settings,
                camera.name,
                snapshot.sim_time_ns,
                threads=self._threads,
            )
            light = Light(radiance)
        if settings.white_balance:
            balanced = white_balanced(light.radiance, settings.white_balance, threads=self._threads)
            light = Light(balanced, light.shade, light.surface)
        rgb = tone_map.tone_map(
            light.radiance, code_table(settings), light.shade, light.surface, threads=self._threads
        )
        return _from_jpeg(rgb, settings.jpeg_quality) if settings.jpeg_quality else rgb

    def raw(self, light: Light, snapshot: WorldSnapshot, camera: Camera) -> NDArray[np.uint16]:
        """Return (H, W) uint16: what the sensor counts of light; a fresh array."""
        name, now_ns, settings = camera.name, snapshot.sim_time_ns, camera.picture
        arriving = self.at_sensor(light)
        if settings.bloom > 0.0:
            quiet = replace(settings, full_well=0.0)
            arriving = sensor_light(arriving, quiet, name, now_ns, threads=self._threads)
        return raw_data(arriving, settings, name, now_ns)

    def through_lens(self, light: Light, camera: Camera) -> Light:
        """Return light as the camera's lens leaves it."""
        settings = camera.picture
        if not (settings.lateral_colour or settings.vignetting or settings.dirt):
            return light
        arriving = self.at_sensor(light)
        return Light(through_lens(arriving, camera.intrinsics, settings, threads=self._threads))


def _known(snapshot: WorldSnapshot, still: NDArray[np.bool_]) -> NDArray[np.uint8]:
    """Return (65536,) uint8: 1 of instances whose light is known; see `ambient_visibility`.

    Of what rests, too, if its shadows were found: rays told what arrives there.
    """
    known = np.zeros(65536, np.uint8)
    baked = snapshot.contents.baked
    if baked is not None:
        known[list(baked.casters)] = 1
    known[snapshot.contents.instance_ids[still]] = 1
    return known


def _inside(surface: NDArray[np.float32], snapshot: WorldSnapshot) -> NDArray[np.bool_]:
    """Return (H, W) bool: where neither the sky is seen nor what lies outside of a room."""
    contents = snapshot.contents
    outside = np.zeros(65536, np.bool_)
    outside[contents.instance_ids[[one.outside is not None for one in contents.instances]]] = True
    inside: NDArray[np.bool_] = ~outside[surface[..., 1].astype(np.uint16)]
    return inside & np.isfinite(surface[..., 0])


def _from_jpeg(rgb: NDArray[np.uint8], quality: int) -> NDArray[np.uint8]:
    """Return (H, W, 3) uint8: a picture as a JPEG file of that quality keeps it."""
    from sailenv_ros.frame.pictures.codecs import decode_picture, encode_jpeg  # need OpenCV

    return decode_picture(encode_jpeg(rgb, quality))
