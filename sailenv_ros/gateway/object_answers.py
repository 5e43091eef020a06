"""Answers about objects and models."""

from __future__ import annotations

import logging
from collections.abc import Callable

from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_string, pack_strings
from sailenv_ros.gateway.scenario_json import (
    behaviours_of_dynamic,
    entries_of_scenario,
    mapping_of_json,
)
from sailenv_ros.gateway.scene_names import scene_of_wire
from sailenv_ros.gateway.steps import Request, Response, errors_as_text, one_line
from sailenv_ros.gateway.unity import pose_from_unity, scale_from_unity
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["ObjectAnswers"]

_log = logging.getLogger(__name__)

Vector3 = tuple[float, float, float]


class ObjectAnswers:
    """Answers about objects; the method's name is the command's.

    Parameters
    ----------
    info : callable
        Returns the scene as it was announced last.
    agent : callable
        Returns the name of the session's agent.
    """

    def __init__(self, info: Callable[[], SceneInfo], agent: Callable[[], str]) -> None:
        self._info = info
        self._agent = agent

    def get_spawnables(self) -> Response:
        """Return the names of what can be spawned, as people write them: ``Chair 01``."""
        names = yield Request(Operations.spawnable_display_names)
        return [pack_strings(names)]

    def spawn_object(
        self,
        name: str,
        position: Vector3,
        rotation: Vector3,
        remove_dynamics: bool,
        scale: Vector3,
        use_parent: bool,
        frustum_limited: bool = False,
        has_dynamic: bool = False,
        dynamic_type: str = "",
        dynamic: str = "{}",
    ) -> Response:
        """Put an object into the scene; tell its instance id, or nothing if it was refused.

        Objects have no parents here, so `use_parent` has no effect. What has a dynamic has a
        body; what is limited to the frustum and bounces stays in this agent's view.
        """
        try:
            description = mapping_of_json("description of the dynamic", dynamic)
            instance_id = yield Request(
                Operations.spawn_object,
                name,
                pose=pose_from_unity(position, rotation),
                scale=scale_from_unity("scale", scale),
                remove_dynamics=remove_dynamics and not has_dynamic,
                behaviours=behaviours_of_dynamic(
                    dynamic_type, description, keep_in_view=self._agent() if frustum_limited else ""
                ),
            )
        except SailenvError as error:
            # The client knows no more than "not spawned"; the reason is for the terminal.
            _log.warning("%r was not spawned: %s", name, one_line(error))
            return [pack_string("")]
        return [pack_string(str(instance_id))]

    def despawn_object(self, id: int) -> Response:
        """Take an object out of the scene."""
        return errors_as_text(lambda: Request(Operations.despawn_object, id))

    def move_object(self, id: int, position: Vector3, rotation: Vector3) -> Response:
        """Move an object."""
        return errors_as_text(
            lambda: Request(Operations.move_object, id, pose=pose_from_unity(position, rotation))
        )

    def spawn_view_frustum(self) -> Response:
        """Do nothing: what stays in a view needs no body around it. Nothing is answered."""
        yield from ()
        return []

    def load_scenario(self, scenario: str) -> Response:
        """Begin a scene with more objects; tell their ids, or nothing for each if refused.

        Raises
        ------
        InvalidRequest
            If nobody can know how many answers the client waits for.
        """
        wanted = mapping_of_json("scenario", scenario)
        objects = wanted.get("objects", [])
        count = len(objects) if isinstance(objects, list) else 0
        try:
            scene = scene_of_wire(str(wanted.get("scene_name")), self._info())
            entries = entries_of_scenario(wanted, self._agent())
            described = {"scene": scene, "objects": entries}
            if wanted.get("timings") is not None:
                described["timings"] = wanted["timings"]
            ids = yield Request(Operations.load_scenario, described)
        except SailenvError as error:
            _log.warning("a scenario was refused: %s", one_line(error))
            return [pack_string("")] * count
        return [pack_string(str(instance_id)) for instance_id in ids]

    def send_obj_zip(self, filename: str, data: bytes) -> Response:
        """Import a model; tell the name that spawns it, or what is wrong after ``error:``."""
        try:
            name = yield Request(Operations.upload_model, data, filename)
        except SailenvError as error:
            _log.warning("the model %r was refused: %s", filename, one_line(error))
            return [pack_string(f"error: {one_line(error)}")]
        return [pack_string(name)]
