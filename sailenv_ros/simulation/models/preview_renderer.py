"""Renders pictures of single assets: thumbnails and previews of the catalogue.

An `Asset` in, a picture out. Uses a back end of its own, in the thread that made it.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
from numpy.typing import NDArray

from sailenv_ros.assets.categories import load_categories
from sailenv_ros.assets.paint import painted
from sailenv_ros.assets.primitives import Primitives
from sailenv_ros.render.contract import BackendName, RenderRequest
from sailenv_ros.render.selection import make_backend
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose, look_at
from sailenv_ros.types.lights import Environment, Light
from sailenv_ros.types.model import Asset
from sailenv_ros.world.bodies import Placement
from sailenv_ros.world.mover import Mover
from sailenv_ros.world.world import World

__all__ = ["PreviewRenderer"]

VERTICAL_FOV_DEG = 28.0
FLOOR_SCALE = 4.0
"""The floor reaches beyond the picture's edges."""

LIFT_M = 0.001
"""Height above the floor at which flat objects are shown [m]."""

FLOOR_COLOUR = (0.30, 0.30, 0.31)

_SURROUNDINGS = Environment(
    background="colour",
    background_colour=(0.22, 0.22, 0.23),
    sky_zenith=(0.42, 0.44, 0.48),
    sky_horizon=(0.48, 0.48, 0.48),
    sky_ground=(0.22, 0.21, 0.20),
    exposure=0.0,
)


class PreviewRenderer:
    """Takes pictures; close it, or use it in a ``with`` block.

    Parameters
    ----------
    backend : {'auto', 'native', 'gl'}
    device : int or None
        Number of the EGL device.
    """

    def __init__(self, backend: BackendName = "auto", device: int | None = None) -> None:
        self._backend = make_backend(backend, device)
        self._categories = load_categories()
        self._numbers = itertools.count(1)
        floor = Primitives().load("plane")
        self._floor = Asset(
            name="floor",
            display_name="Floor",
            category="floor",
            model=painted(floor.model, colour=FLOOR_COLOUR, roughness=0.9),
            collision=(),
        )

    def thumbnail(
        self,
        asset: Asset,
        *,
        width: int = 320,
        height: int = 240,
        azimuth_deg: float = 32.0,
        elevation_deg: float = 22.0,
    ) -> NDArray[np.uint8]:
        """Take a picture of an asset on a floor.

        Parameters
        ----------
        azimuth_deg : float
            From the asset's front (+x) towards its left [deg].
        elevation_deg : float
            Above the horizon [deg].

        Returns
        -------
        picture : (height, width, 3) uint8
            RGB.
        """
        low, high = asset.model.bounds()
        size = float(np.linalg.norm(high - low))
        # Everything is seen from about the same distance in its own size, whatever that is.
        scale = 1.0 / max(size, 1e-6)
        world = self._world(asset, scale, float(low[2]))
        try:
            target = (low + high) / 2.0 * scale
            target[2] -= low[2] * scale
            camera = self._camera(target, width, height, azimuth_deg, elevation_deg)
            rendered = self._backend.render(RenderRequest(world.snapshot(), camera, ("rgb",)))
        finally:
            world.close()
        return np.asarray(rendered.views["rgb"])

    def close(self) -> None:
        """Free the back end."""
        self._backend.close()

    def __enter__(self) -> PreviewRenderer:
        """Return the renderer itself."""
        return self

    def __exit__(self, *_: object) -> None:
        """Close it."""
        self.close()

    def _world(self, asset: Asset, scale: float, low_z: float) -> World:
        number = next(self._numbers)
        lights = (
            Light(
                name="key",
                type="directional",
                direction=(-0.75, 0.25, -0.9),
                colour=(1.0, 0.96, 0.9),
                intensity=1.7,
            ),
            Light(name="fill", type="directional", direction=(0.2, -0.9, -0.4), intensity=0.35),
        )
        return World(
            scene="thumbnail",
            epoch=number,
            next_revision=lambda: number,
            placements=[
                self._placement("floor", self._floor, FLOOR_SCALE, 0.0),
                self._placement("object", asset, scale, LIFT_M - low_z * scale),
            ],
            movers=[Mover(name="mover", start=Pose(), track=None, controller="waypoint")],
            categories=self._categories,
            lights=lights,
            environment=_SURROUNDINGS,
        )

    def _placement(self, name: str, asset: Asset, scale: float, z: float) -> Placement:
        return Placement(
            name=name,
            asset=Asset(
                name=asset.name,
                display_name=asset.display_name,
                category=asset.category,
                model=asset.model,
                collision=(),
            ),
            category_id=self._categories.named("floor").id,
            pose=Pose(position_m=(0.0, 0.0, z)),
            scale=(scale, scale, scale),
            static=True,
        )

    def _camera(
        self,
        target: NDArray[np.float64],
        width: int,
        height: int,
        azimuth_deg: float,
        elevation_deg: float,
    ) -> Camera:
        half_angle = math.radians(VERTICAL_FOV_DEG / 2.0) * min(1.0, width / height)
        distance = 0.47 / math.sin(half_angle)
        azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
        offset = distance * np.array(
            [
                math.cos(azimuth) * math.cos(elevation),
                math.sin(azimuth) * math.cos(elevation),
                math.sin(elevation),
            ]
        )
        intrinsics = CameraIntrinsics(width=width, height=height, vertical_fov_deg=VERTICAL_FOV_DEG)
        return Camera(intrinsics=intrinsics, pose=look_at(target + offset, target))
