"""From a lit picture to what an agent sees: occlusion, bloom, noise, tone curve.

Radiance and surfaces come in, an 8-bit sRGB picture goes out. Everything happens on the
processor, on copies: ground truth never passes through here. What is off costs nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.render.picture import ambient_occlusion, supersampling, tone_map
from sailenv_ros.render.picture.sensor import sensor_light
from sailenv_ros.render.picture.tone import code_table
from sailenv_ros.types.camera import Camera
from sailenv_ros.types.snapshot import WorldSnapshot

__all__ = ["PostPass"]


class PostPass:
    """Finishes pictures.

    Parameters
    ----------
    threads : int
        How many work on a picture; it does not depend on it.
    """

    def __init__(self, threads: int) -> None:
        self._threads = threads

    def finished(
        self,
        radiance: NDArray[np.float16],
        surface: NDArray[np.float32],
        snapshot: WorldSnapshot,
        camera: Camera,
        still: NDArray[np.bool_],
        samples: NDArray[np.float32] | None = None,
    ) -> NDArray[np.uint8]:
        """Return the picture of what was lit.

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

        Returns
        -------
        rgb : (H, W, 3) uint8
            sRGB; a fresh array.
        """
        settings = camera.picture
        shade: tone_map.AmbientShade | None = None
        if settings.occlusion_strength > 0.0:
            baked = np.zeros(65536, np.bool_)
            baked[snapshot.contents.instance_ids[still]] = True
            shade = ambient_occlusion.ambient_visibility(
                surface,
                camera.intrinsics,
                strength=settings.occlusion_strength,
                radius_m=settings.occlusion_radius_m,
                baked=baked,
                threads=self._threads,
            )
        if settings.supersampling > 1:
            times = settings.supersampling
            radiance = supersampling.mean_radiance(
                radiance, times, shade, samples, threads=self._threads
            )
            shade = None
        if settings.bloom > 0.0 or settings.full_well > 0.0:
            if shade is not None:
                # Light is spread and counted as it arrives at the sensor.
                radiance = tone_map.apply_visibility(
                    radiance, *shade, surface, threads=self._threads
                )
                shade = None
            radiance = sensor_light(
                radiance, settings, camera.name, snapshot.sim_time_ns, threads=self._threads
            )
        return tone_map.tone_map(
            radiance, code_table(settings), shade, surface, threads=self._threads
        )
