"""Places of a recipe's cameras that follow a rule, in a scene that has begun.

Places are chosen for all clips of a scene at once, which keeps them apart. What moves by itself is
somewhere else in the next clip: a camera that looks at it gets its place when its clip begins.
"""

from __future__ import annotations

from collections.abc import Sequence

from sailenv_ros.authoring.viewpoints import sample_cameras
from sailenv_ros.dataset.recipe_cameras import RuleCamera
from sailenv_ros.dataset.recipe_choices import choices_of_rule, fitting_settings
from sailenv_ros.dataset.scene_names import SceneNames
from sailenv_ros.dataset.shard_plan import Clip
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.simulation.script.rule_places import look_lens
from sailenv_ros.simulation.synchronous import SynchronousSimulation
from sailenv_ros.space.free_space import named_generator
from sailenv_ros.types.geometry import Pose

__all__ = ["aims_at_movers", "present_names", "rule_views"]


def present_names(core: SynchronousSimulation, library: SceneLibrary) -> SceneNames:
    """Return the names of a scene's file; cameras may look at whatever has come besides."""
    assert core.world.described is not None
    shown = [drawn.instance for drawn in core.world.contents.instances]
    names = SceneNames.of(core.world.described, library)
    return names.with_seen({one.name: one.category for one in shown})


def aims_at_movers(camera: RuleCamera, core: SynchronousSimulation, names: SceneNames) -> bool:
    """Return whether a rule names objects to look at, and one of them moves by itself."""
    movers = {body.placement.name for body in core.world.bodies if body.behaviours}
    return any(
        movers.intersection(names.meant(one.kind, selector))
        for one in choices_of_rule(camera.settings)
        for selector in one.selectors
    )


def rule_views(
    camera: RuleCamera,
    clips: Sequence[Clip],
    core: SynchronousSimulation,
    names: SceneNames,
    seed: int,
) -> list[Pose]:
    """Return the places that a rule finds for some clips, perhaps fewer.

    Parameters
    ----------
    camera : RuleCamera
    clips : sequence of Clip
        At least one; the first one's number chooses the random numbers.
    core : SynchronousSimulation
    names : SceneNames
        Of the scene as it is.
    seed : int
        Of the recipe.
    """
    random = named_generator(seed, "rule", camera.name, str(clips[0].number))
    settings = fitting_settings(camera.settings, names)
    if settings is None:
        return []
    found = sample_cameras(
        core.view_scene(look_lens(camera.intrinsics)),
        camera.rule,
        len(clips),
        seed=int(random.integers(2**63)),
        settings=settings,
    )
    return [one.pose for one in found]
