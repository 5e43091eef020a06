"""Cameras that a scene has placed by rules: what was drawn in, places in the same words out.

A record holds the place, so a frame is made again without the rule.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from sailenv_ros.authoring.viewpoints import ViewScene, sample_cameras
from sailenv_ros.scene.randomise.randomisation import Values
from sailenv_ros.types.agents import AgentSpec
from sailenv_ros.types.camera import CameraIntrinsics

__all__ = ["look_lens", "placed_by_rules"]

LOOK_PX = 160
"""Longer side of the pictures that rules look at."""


def placed_by_rules(
    values: Values,
    specs: Mapping[str, AgentSpec],
    view_scene: Callable[[CameraIntrinsics], ViewScene],
) -> Values:
    """Return drawn values with a position and a rotation instead of each rule.

    A camera for which its rule finds no place keeps the one that it has.

    Parameters
    ----------
    values : mapping
        As `random_values.sampled` draws them.
    specs : mapping of str to AgentSpec
        The agents by name.
    view_scene : callable
        Returns the scene as it stands now, as a lens sees it.

    Raises
    ------
    UnknownName, InvalidEntry, InvalidRequest
        If a rule is asked for what the scene does not have.
    """
    agents: Mapping[str, Mapping[str, Any]] = values.get("agents", {})
    if not any("rule" in keys for keys in agents.values()):
        return values
    placed: dict[str, Any] = {}
    for name, given in agents.items():
        keys = dict(given)
        rule = keys.pop("rule", None)
        if rule is not None and name in specs:
            lens = look_lens(specs[name].intrinsics, keys.get("vertical_fov"))
            views = sample_cameras(
                view_scene(lens), rule["name"], seed=rule["seed"], settings=rule["settings"]
            )
            for view in views:
                keys["position"] = list(view.pose.position_m)
                keys["rotation"] = list(view.pose.rpy_deg)
        placed[name] = keys
    return {**values, "agents": placed}


def look_lens(lens: CameraIntrinsics, fov_deg: float | None = None) -> CameraIntrinsics:
    """Return a lens of the same angles with few pixels."""
    share = min(1.0, LOOK_PX / max(lens.width, lens.height))
    width, height = (max(16, round(share * size)) for size in (lens.width, lens.height))
    small = lens.resized(width, height)
    return small if fov_deg is None else small.with_vertical_fov(fov_deg)
