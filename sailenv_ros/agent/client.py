"""One user's line to a simulator: requests about the whole of it, and the scene's tables.

What `Agent` is beside its camera. Finds a running simulator or starts one, and lets go of it on
`close`. Raises typed errors; every wait has a deadline.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from std_srvs.srv import Trigger

from sailenv_msgs.srv import ChangeScene, Reset, Step
from sailenv_msgs_py.stamps import ns_from_stamp
from sailenv_ros.agent.edit_requests import EditRequests
from sailenv_ros.agent.light_requests import LightRequests
from sailenv_ros.agent.object_requests import ObjectRequests
from sailenv_ros.agent.shared import acquire, release
from sailenv_ros.errors import InvalidRequest
from sailenv_ros.labels import Instance as LabelledInstance
from sailenv_ros.scene_info import SceneInfo

__all__ = ["Instance", "SimulatorClient", "instance_of"]

MAX_DOMAIN_ID = 232
"""The largest ROS domain whose ports exist."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Instance:
    """One object of the scene.

    Attributes
    ----------
    name : str
        Its name in the scene, unique there.
    category_id : int
    category : str
    static : bool
        True if physics never moves it.
    moving : bool
        True if a behaviour moves it.
    """

    name: str
    category_id: int
    category: str
    static: bool
    moving: bool


class SimulatorClient(ObjectRequests, LightRequests, EditRequests):
    """Requests to a simulator, and what it announces.

    Parameters
    ----------
    namespace : str
        The simulator's ROS namespace.
    domain_id : int or None
        ROS domain; None means that of the environment.
    simulator : mapping or None
        Parameters of the simulator node if one has to be started.
    timeout_s, start_timeout_s : float
        Deadline of each request, and of the simulator's start [s].
    """

    def __init__(
        self,
        *,
        namespace: str,
        domain_id: int | None,
        simulator: Mapping[str, object] | None,
        timeout_s: float,
        start_timeout_s: float,
    ) -> None:
        name = "/" + namespace.strip("/")
        self._timeout_s = timeout_s
        self._acquire = partial(
            acquire, _domain(domain_id), name, dict(simulator or {}), start_timeout_s
        )
        self._link = self._acquire()
        self._connection = self._link.connection

    @property
    def simulator_pid(self) -> int | None:
        """Process id of the simulator if it was started here, else None."""
        return None if self._link.process is None else self._link.process.pid

    # -- the scene -------------------------------------------------------------------------

    @property
    def scene(self) -> str:
        """Name of the present scene."""
        return self._info.scene

    @property
    def scenes(self) -> list[str]:
        """Names that `change_scene` takes."""
        return list(self._info.scenes)

    @property
    def categories(self) -> dict[int, str]:
        """Names of the categories by their ids, the values of the category view."""
        return {category.id: category.name for category in self._info.categories.values()}

    @property
    def instances(self) -> dict[int, Instance]:
        """The objects of the scene by their ids, the values of the instance view."""
        info = self._info
        return {i.id: instance_of(i, i.id in info.moving) for i in info.instances}

    @property
    def category_colours(self) -> dict[int, tuple[int, int, int]]:
        """Red, green, blue of the categories' pictures by their ids."""
        return {category.id: category.colour for category in self._info.categories.values()}

    def get_categories(self) -> dict[int, str]:
        """Give `categories`, as the original's method of that name did."""
        return self.categories

    def change_scene(self, scene_name: str) -> None:
        """Leave the present scene for another one of `scenes`, for all agents."""
        before = self._info.epoch
        self._call(ChangeScene, "change_scene", ChangeScene.Request(scene=scene_name))
        self._await_info(lambda info: info.epoch > before, f"the scene {scene_name!r}")

    def reset(self, seed: int | None = None) -> None:
        """Begin the present scene anew, with another seed if one is given."""
        before = self._info.epoch
        request = Reset.Request(keep_seed=seed is None, seed=0 if seed is None else seed)
        self._call(Reset, "reset", request)
        self._await_info(lambda info: info.epoch > before, "the scene's new start")

    # -- time ------------------------------------------------------------------------------

    def pause(self) -> None:
        """Hold simulated time, for all agents."""
        self._call(Trigger, "pause", Trigger.Request())

    def resume(self) -> None:
        """Let simulated time run on."""
        self._call(Trigger, "resume", Trigger.Request())

    def step(self, count: int = 1) -> int:
        """Advance a paused or lockstep simulation by steps of 1/240 s; give its time [ns]."""
        return ns_from_stamp(self._call(Step, "step", Step.Request(steps=count)).stamp)

    # -- inside ----------------------------------------------------------------------------

    @property
    def _info(self) -> SceneInfo:
        return self._connection.info

    def _await_info(self, condition: Callable[[SceneInfo], bool], what: str) -> None:
        self._connection.await_info(condition, f"the announcement of {what}", self._timeout_s)

    def _call(
        self, srv_type: Any, service: str, request: Any, timeout_s: float | None = None
    ) -> Any:
        limit_s = self._timeout_s if timeout_s is None else timeout_s
        return self._connection.call(srv_type, service, request, limit_s)

    def _reconnect(self) -> None:
        old, self._link = self._link, self._acquire()
        self._connection = self._link.connection
        release(old)

    def _release(self) -> None:
        release(self._link)


def instance_of(instance: LabelledInstance, moving: bool) -> Instance:
    """Give an announced object as the facade shows it."""
    return Instance(
        name=instance.name,
        category_id=instance.category_id,
        category=instance.category,
        static=instance.static,
        moving=moving,
    )


def _domain(domain_id: int | None) -> int:
    """Give the ROS domain: the one asked for, else the environment's."""
    asked = os.environ.get("ROS_DOMAIN_ID", "") or "0" if domain_id is None else str(domain_id)
    if not asked.isdecimal() or int(asked) > MAX_DOMAIN_ID:
        raise InvalidRequest("ROS domain", asked, f"an integer from 0 to {MAX_DOMAIN_ID}")
    return int(asked)
