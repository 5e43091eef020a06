"""A shadow map of the main directional light: depth as the light sees some of the scene.

A snapshot, a light and the choice of what casts come in; a depth texture and the matrix into it go
out. It is drawn again only when something that it depends on has changed; then what has not moved
is copied from a second map, where it was drawn once.
"""

from __future__ import annotations

from dataclasses import replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from sailenv_ros.lights import Light
from sailenv_ros.render.draw_list import ROWS, DrawList, casts
from sailenv_ros.render.geometry_buffers import GeometryBuffers
from sailenv_ros.render.geometry_pass import bound, issue
from sailenv_ros.render.programs import ProgramCache
from sailenv_ros.snapshot import SceneContents, WorldSnapshot

__all__ = ["ShadowPass"]

SIZE_PX = 1024

STEADY_TEXELS = 0.125
"""A caster that has moved by less since the map was drawn is taken to stand where it stood: what
comes to rest creeps for seconds, by less than can be seen, and needs no new map."""


class ShadowPass:
    """The shadow map of one renderer."""

    def __init__(self, context: moderngl.Context, programs: ProgramCache) -> None:
        self._context = context
        self._program = programs.get("shadow.vert", "shadow.frag", ROWS=ROWS)
        self.texture = context.depth_texture((SIZE_PX, SIZE_PX))
        self.texture.compare_func = "<="
        self.texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
        self.texture.repeat_x = self.texture.repeat_y = False
        self._framebuffer = _with_colour(context, self.texture)
        self._resting = _with_colour(context, context.depth_texture((SIZE_PX, SIZE_PX)))
        self._drawn: tuple[object, ...] = ()
        self._poses: NDArray[np.float64] | None = None
        self._frame: tuple[object, ...] = ()
        self._at_rest = np.zeros(0, bool)
        self._rest_poses = np.zeros((0, 4, 4))
        self._rest_drawn = False
        self._spheres = _Spheres()
        self._clip_from_light, self._light_from_world = np.eye(4), np.eye(4)
        self.map_from_world: NDArray[np.float64] = np.eye(4)
        self.texel_m = 0.0

    def draw(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        draws: DrawList,
        geometry: GeometryBuffers,
        *,
        casting: NDArray[np.bool_] | None = None,
        framed: NDArray[np.bool_] | None = None,
    ) -> None:
        """Bring the map up to date; leaves the rows of `draws` placed for the light if it drew.

        Parameters
        ----------
        casting : (N,) bool or None
            Which instances cast; None for all.
        framed : (N,) bool or None
            Which instances the map encloses; None for all. Things that move are better left out:
            a map that follows them changes its texels' places, and so every shadow's edge.
        """
        poses = self._steady(snapshot)
        snapshot = replace(snapshot, world_from_body=poses)
        everything = np.ones(len(poses), bool)
        casting = everything if casting is None else casting
        framed = everything if framed is None else framed
        key = (snapshot.contents, light.direction, casting.tobytes(), framed.tobytes())
        before = self._poses if self._drawn == key else None
        concerned = casting | framed
        if before is not None and np.array_equal(before[concerned], poses[concerned]):
            return
        self._drawn, self._poses = key, poses
        self._fit(light, snapshot, framed, key)
        draws.place(snapshot, self._clip_from_light, self._light_from_world)
        moved = np.zeros(len(poses), bool)
        if before is not None:
            moved = (poses != before).any(axis=(1, 2))
        if self._is_stale(poses):
            # Drawn apart only when it is needed a second time: what goes on moving never is.
            self._at_rest, self._rest_poses, self._rest_drawn = casting & ~moved, poses, False
            self._framebuffer.use()
            self._framebuffer.clear(depth=1.0)
            self._issue(draws, geometry, casting)
            return
        if not self._rest_drawn:
            self._rest_drawn = True
            self._resting.use()
            self._resting.clear(depth=1.0)
            self._issue(draws, geometry, self._at_rest)
        self._context.copy_framebuffer(self._framebuffer, self._resting)
        self._framebuffer.use()
        self._issue(draws, geometry, casting & ~self._at_rest)

    def _steady(self, snapshot: WorldSnapshot) -> NDArray[np.float64]:
        """Give the poses of casters, as they were drawn last where that is near enough."""
        poses = snapshot.world_from_body
        known = bool(self._drawn) and self._drawn[0] is snapshot.contents
        if not known or self._poses is None:
            return poses
        off = np.abs(poses - self._poses)
        # No point of it has moved by more.
        reach = self._spheres.reaches(snapshot.contents)
        most = off[:, :3, 3].sum(axis=1) + reach * off[:, :3, :3].sum(axis=(1, 2))
        near = most <= STEADY_TEXELS * self.texel_m
        return np.where(near[:, None, None], self._poses, poses)

    def _fit(
        self,
        light: Light,
        snapshot: WorldSnapshot,
        framed: NDArray[np.bool_],
        key: tuple[object, ...],
    ) -> None:
        """Enclose the framed instances, if that is not done yet."""
        frame = (key, snapshot.world_from_body[framed].tobytes())
        if self._frame == frame:
            return
        self._frame = frame
        self._at_rest = np.zeros(0, bool)
        self._clip_from_light, self._light_from_world, width_m = _frustum(
            light, self._spheres.of(snapshot), framed
        )
        self.texel_m = width_m / SIZE_PX
        # From clip space, -1 to 1, to texture space, 0 to 1.
        half = np.diag([0.5, 0.5, 0.5, 1.0])
        half[:3, 3] = 0.5
        self.map_from_world = half @ self._clip_from_light @ self._light_from_world

    def _is_stale(self, poses: NDArray[np.float64]) -> bool:
        """Tell if something has left the place at which it was drawn as resting."""
        if len(self._at_rest) != len(poses):
            return True
        return not np.array_equal(poses[self._at_rest], self._rest_poses[self._at_rest])

    def _issue(
        self, draws: DrawList, geometry: GeometryBuffers, casting: NDArray[np.bool_]
    ) -> None:
        """Draw some casters into the framebuffer in use."""
        draws.choose_casters(casting)
        self._context.enable_only(moderngl.DEPTH_TEST)
        self._context.polygon_offset = 1.5, 2.0
        if draws.casters.chosen:
            array = bound(
                self._context,
                self._program,
                geometry,
                geometry.corner_index_buffer,
                by_corner=True,
            )
            issue(self._program, array, draws, draws.casters, draws.lies)
        self._context.polygon_offset = 0.0, 0.0

    def close(self) -> None:
        """Free the map."""
        for framebuffer in (self._framebuffer, self._resting):
            attached = (*framebuffer.color_attachments, framebuffer.depth_attachment)
            framebuffer.release()
            for texture in attached:
                texture.release()


def _with_colour(context: moderngl.Context, depth: moderngl.Texture) -> moderngl.Framebuffer:
    """Make a framebuffer for depth; only those that have colours can be copied with moderngl."""
    framebuffer = context.framebuffer([context.renderbuffer((SIZE_PX, SIZE_PX), 1)], depth)
    framebuffer.color_mask = False, False, False, False
    return framebuffer


def _frustum(
    light: Light,
    spheres: tuple[NDArray[np.float64], NDArray[np.float64]],
    framed: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.float64], float]:
    """Fit an orthographic box along the light around those instances that can cast."""
    forward = np.asarray(light.direction)
    helper = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.9 else np.array([1.0, 0.0, 0.0])
    right = np.cross(forward, helper)
    right /= np.linalg.norm(right)
    up = np.cross(right, forward)
    light_from_world = np.eye(4)
    light_from_world[:3, :3] = np.stack([right, up, forward])
    low, high = _caster_bounds(light_from_world, spheres, framed)
    width = float(max(high[0] - low[0], high[1] - low[1], 0.5)) * 1.05
    centre = 0.5 * (low + high)
    near, far = float(low[2]) - 0.5, float(high[2]) + 0.5
    clip = np.diag([2.0 / width, 2.0 / width, 2.0 / (far - near), 1.0])
    clip[:3, 3] = [
        -2.0 * centre[0] / width,
        -2.0 * centre[1] / width,
        -(far + near) / (far - near),
    ]
    return clip, light_from_world, width


class _Spheres:
    """Spheres around the instances of the contents seen last, in their own frames."""

    def __init__(self) -> None:
        self._contents: SceneContents | None = None
        self._middles = np.zeros((0, 3))
        self._radii = np.zeros(0)

    def of(self, snapshot: WorldSnapshot) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Give centres in the world (N, 3) and radii (N,) [m]; 0 for what casts no shadow."""
        self._know(snapshot.contents)
        poses = snapshot.world_from_body
        centres = (poses[:, :3, :3] @ self._middles[:, :, None])[:, :, 0] + poses[:, :3, 3]
        return centres, self._radii

    def reaches(self, contents: SceneContents) -> NDArray[np.float64]:
        """Give (N,): how far spheres reach from their bodies' origins [m]."""
        self._know(contents)
        reaches: NDArray[np.float64] = np.linalg.norm(self._middles, axis=1) + self._radii
        return reaches

    def _know(self, contents: SceneContents) -> None:
        if self._contents is contents:
            return
        self._contents = contents
        bounds = np.array(
            [drawn.model.bounds() * np.asarray(drawn.scale) for drawn in contents.instances]
        ).reshape(-1, 2, 3)
        casting = np.array([casts(drawn) for drawn in contents.instances], bool)
        self._middles = bounds.mean(axis=1)
        self._radii = np.where(
            casting, 0.5 * np.linalg.norm(bounds[:, 1] - bounds[:, 0], axis=1), 0.0
        )


def _caster_bounds(
    light_from_world: NDArray[np.float64],
    spheres: tuple[NDArray[np.float64], NDArray[np.float64]],
    framed: NDArray[np.bool_],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    centres, radii = spheres
    counts = framed & (radii > 0.0)
    if not counts.any():
        return np.full(3, -5.0), np.full(3, 5.0)
    seen, around = centres[counts] @ light_from_world[:3, :3].T, radii[counts, None]
    low, high = (seen - around).min(axis=0), (seen + around).max(axis=0)
    # What receives the shadow may lie behind the last caster.
    high[2] += 6.0
    return low, high
