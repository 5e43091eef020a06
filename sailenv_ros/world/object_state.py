"""State of a body, or of a part of one, at an instant, as clients are told it."""

from __future__ import annotations

import numpy as np

from sailenv_ros.types.labels import Instance
from sailenv_ros.types.model import Model
from sailenv_ros.types.objects import ObjectState
from sailenv_ros.world.bodies import Body, vector3

__all__ = ["object_state"]


def object_state(body: Body, instance: Instance, sim_time_ns: int, model: Model) -> ObjectState:
    """Return what clients may know now of a body, or of the part that is such an instance.

    Parameters
    ----------
    body : Body
    instance : Instance
    sim_time_ns : int
        Now [ns].
    model : Model
        What it looks like, with all its parts: for its size.
    """
    placement = body.placement
    low, high = model.bounds()
    linear, angular = body.velocity()
    return ObjectState(
        id=instance.id,
        name=instance.name,
        asset=instance.asset,
        category_id=instance.category_id,
        category=instance.category,
        pose=body.pose(),
        scale=placement.scale,
        size_m=vector3((high - low) * np.asarray(placement.scale)),
        bottom_m=float(low[2] * placement.scale[2]),
        static=placement.static,
        mass_kg=body.mass_kg,
        linear_velocity=vector3(linear),
        angular_velocity=vector3(angular),
        behaviours=tuple(
            {"type": running.kind.type, **running.parameters.to_json()}
            for running in body.behaviours
        ),
        sim_time_ns=sim_time_ns,
    )
