"""Place keys for a scene file, from where an object has come to rest on its carrier.

The file keeps naming the carrier, so that the object goes along when that is moved by hand.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sailenv_ros.assets.arranging import arranged
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.scene.serialisation import LENGTH_DECIMALS, pose_entry, rounded
from sailenv_ros.scene.spec import ObjectSpec
from sailenv_ros.types.geometry import Pose
from sailenv_ros.world.bodies import Body

__all__ = ["settled_place"]


def settled_place(body: Body, carrier: Body) -> dict[str, Any]:
    """Return the place keys of an object that stands upon another, as both stand now.

    Parameters
    ----------
    body : Body
        What is carried; has an entry, whose `on` is the carrier's name.
    carrier : Body
        Has an entry.

    Returns
    -------
    dict
        `on`, its `level` if any, `position` [m] and what turns it; without `on`, in the world
        frame, if there is nothing of the carrier under it.
    """
    entry, below = body.placement.entry, carrier.placement.entry
    assert entry is not None
    assert below is not None
    relative = np.linalg.inv(carrier.pose().matrix()) @ body.pose().matrix()
    surface = entry.model_dump(mode="json", include={"on", "level"}, exclude_none=True)
    keys = {**surface, **pose_entry(Pose.from_matrix(relative))}
    plain = entry.model_dump(mode="json", include={"name", "asset", "scale"})
    # The height in the file counts from what lies under the object: that of 0 tells how high.
    x, y, _ = keys["position"]
    lowered = ObjectSpec.model_validate({**plain, **keys, "position": [x, y, 0.0]})
    at_origin = below.model_dump(mode="json", include={"name", "asset", "scale"})
    assets = {entry.name: body.placement.asset, below.name: carrier.placement.asset}
    try:
        poses = arranged([ObjectSpec.model_validate(at_origin), lowered], assets, None)
    except InvalidRequest:
        return pose_entry(body.pose())
    height = float(relative[2, 3]) - poses[entry.name].position_m[2]
    return {**keys, "position": rounded((x, y, height), LENGTH_DECIMALS)}
