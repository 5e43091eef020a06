"""Description of the simulated scene for clients: live scene in, `SceneInfo` out."""

from __future__ import annotations

from sailenv_ros.simulation.clock import Clock
from sailenv_ros.simulation.live_scene import LiveScene
from sailenv_ros.types.scene_info import MoverInfo, SceneInfo
from sailenv_ros.world.mover import Mover

__all__ = ["scene_info_of"]


def scene_info_of(
    scene: LiveScene, clock: Clock, *, epoch: int, revision: int, renderer: str
) -> SceneInfo:
    """Return the scene as clients see it.

    Parameters
    ----------
    scene : LiveScene
    clock : Clock
    epoch : int
    revision : int
        That clients know it by.
    renderer : str
        In words.
    """
    world, contents = scene.world, scene.world.contents
    return SceneInfo(
        scene=world.scene,
        scenes=scene.library.scene_names,
        epoch=epoch,
        revision=revision,
        sim_time_ns=world.sim_time_ns,
        mode=clock.mode,
        paused=clock.paused,
        real_time_factor=clock.real_time_factor,
        seed=scene.seed,
        categories=contents.categories,
        instances=tuple(drawn.instance for drawn in contents.instances),
        moving=world.moving_ids,
        spawnables=scene.library.spawnables,
        lights=contents.lights,
        environment=contents.environment,
        agents=scene.agents.specs,
        movers=tuple(_mover_info(mover) for mover in world.movers.values()),
        renderer=renderer,
    )


def _mover_info(mover: Mover) -> MoverInfo:
    return MoverInfo(
        name=mover.name,
        controller=mover.controller,
        waypoints=mover.waypoints,
        total_time_s=mover.total_time_s,
        loop=mover.loop,
        body=None if mover.body is None else mover.body.rigid,
        look_at=mover.look_at,
    )
