"""Names of the environments for `gymnasium.make`, with their time limits."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import MappingProxyType
from typing import Any

import gymnasium

__all__ = ["ENVIRONMENTS", "register_environments"]

ENVIRONMENTS: Mapping[str, tuple[str, int]] = MappingProxyType(
    {
        "sailenv/Track-v0": ("track:TrackEnv", 300),
        "sailenv/Search-v0": ("search:SearchEnv", 200),
        "sailenv/Explore-v0": ("explore:ExploreEnv", 200),
        "sailenv/Fixate-v0": ("fixate:FixateEnv", 100),
        "sailenv/Open-v0": ("open_door:OpenEnv", 200),
        "sailenv/PointNav-v0": ("point_nav:PointNavEnv", 200),
        "sailenv/Rearrange-v0": ("rearrange:RearrangeEnv", 200),
    }
)
"""Module and class of each environment, and the steps after which an episode is cut off."""


def register_environments() -> None:
    """Make the environments known to Gymnasium; a second call does nothing."""
    for name, (place, most_steps) in ENVIRONMENTS.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                name,
                entry_point=f"sailenv_ros.gym.{place}",
                vector_entry_point=partial(_make_vector, place),
                max_episode_steps=most_steps,
            )


def _make_vector(task: str, **settings: Any) -> Any:
    from sailenv_ros.gym.process_vector import make_vector  # needs all that draws

    return make_vector(task, **settings)
