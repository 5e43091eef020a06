"""From a lit picture to what an agent sees: occlusion, bloom, noise, tone curve, smooth edges.

Radiance and surfaces come in, an 8-bit sRGB picture goes out. Everything happens on the
processor, on copies: ground truth never passes through here. What is off costs nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.camera import Camera
from sailenv_ros.render import ambient_occlusion, develop, smooth_edges, supersampling
from sailenv_ros.render.bands import Bands
from sailenv_ros.render.bloom import bloomed
from sailenv_ros.render.sensor_noise import noisy
from sailenv_ros.render.tone import code_table
from sailenv_ros.snapshot import WorldSnapshot

__all__ = ["PostPass", "warm_up"]


def warm_up() -> None:
    """Compile the walks now (or load them from numba's cache), not at the first frame."""
    ambient_occlusion.warm_up()
    develop.warm_up()
    smooth_edges.warm_up()
    supersampling.warm_up()


class PostPass:
    """Finishes pictures.

    Parameters
    ----------
    bands : Bands
        Runs walks over a picture.
    """

    def __init__(self, bands: Bands) -> None:
        self._bands = bands

    def developed(
        self,
        radiance: NDArray[np.float16],
        surface: NDArray[np.float32],
        snapshot: WorldSnapshot,
        camera: Camera,
        still: NDArray[np.bool_],
        samples: NDArray[np.float32] | None = None,
    ) -> NDArray[np.uint8]:
        """Give a picture whose edges are as they are.

        Parameters
        ----------
        radiance : (H, W, 4) float16
            See `develop.develop`; of a camera with supersampling, of its samples.
        surface : (H, W, 2) float32
            Depth [m] and instance id; not written to.
        still : (N,) bool
            Which instances have baked light where they are.
        samples : float32 array or None
            Like `surface`, of the samples; needed where there are any and occlusion is on.

        Returns
        -------
        picture : (H, W, 4) uint8
            sRGB and luma; a fresh array.
        """
        settings = camera.picture
        shade: develop.Shade | None = None
        if settings.occlusion_strength > 0.0:
            baked = np.zeros(65536, np.bool_)
            baked[snapshot.contents.instance_ids[still]] = True
            shade = ambient_occlusion.open_share(
                surface,
                camera.intrinsics,
                strength=settings.occlusion_strength,
                radius_m=settings.occlusion_radius_m,
                baked=baked,
                bands=self._bands,
            )
        if settings.supersampling > 1:
            times = settings.supersampling
            radiance = supersampling.mean_radiance(
                radiance, times, shade, samples, bands=self._bands
            )
            shade = None
        if shade is not None and (settings.bloom > 0.0 or settings.full_well > 0.0):
            # Light is spread and counted as it arrives at the sensor.
            radiance = develop.shaded(radiance, *shade, surface)
            shade = None
        if settings.bloom > 0.0:
            radiance = bloomed(radiance, settings.bloom)
        if settings.full_well > 0.0:
            radiance = noisy(radiance, settings, camera.name, snapshot.sim_time_ns)
        return develop.develop(radiance, code_table(settings), shade, surface, bands=self._bands)

    def finished(self, picture: NDArray[np.uint8], camera: Camera) -> NDArray[np.uint8]:
        """Give the (H, W, 3) uint8 picture, its edges smoothed if they are to be; fresh."""
        if camera.picture.smooth_edges and camera.picture.supersampling == 1:
            return smooth_edges.smooth_edges(picture)
        return np.ascontiguousarray(picture[..., :3])
