"""Environments of Gymnasium for agents that look. Importing this registers them.

>>> import gymnasium, sailenv_ros.gym  # doctest: +SKIP
>>> env = gymnasium.make("sailenv/Search-v0", views=("rgb", "depth"))  # doctest: +SKIP
"""

from sailenv_ros.extras import need

need("gymnasium", "an environment to act in")

from sailenv_ros.gym.registration import ENVIRONMENTS, register_environments  # noqa: E402
from sailenv_ros.gym.room_table import KINDS, SPLITS, room_names  # noqa: E402

__all__ = ["ENVIRONMENTS", "KINDS", "SPLITS", "room_names"]

register_environments()
