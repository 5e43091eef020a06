"""Answers about objects and models; part of `Session`."""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator
from typing import Any

from sailenv_ros.errors import SailenvError
from sailenv_ros.gateway.codec import pack_string, pack_strings
from sailenv_ros.gateway.steps import Answer, Ask, Step, in_words, one_line
from sailenv_ros.gateway.unity import pose_from_unity, scale_from_unity
from sailenv_ros.scene_info import SceneInfo

__all__ = ["ObjectAnswers"]

_log = logging.getLogger(__name__)

Vector3 = tuple[float, float, float]


class ObjectAnswers:
    """Answers about objects; the method's name is the command's."""

    _info: Callable[[], SceneInfo]

    def get_spawnables(self) -> Answer:
        """Tell the names of what can be spawned, as people write them: ``Chair 01``."""
        names = yield Ask("spawnable_display_names")
        return [pack_strings(names)]

    def spawn_object(
        self,
        name: str,
        position: Vector3,
        rotation: Vector3,
        remove_dynamics: bool,
        scale: Vector3,
        use_parent: bool,
    ) -> Answer:
        """Put an object into the scene; tell its instance id, or nothing if it was refused.

        Objects have no parents here, so `use_parent` has no effect.
        """
        try:
            settings = {
                "pose": pose_from_unity(position, rotation),
                "scale": scale_from_unity("scale", scale),
                "static": remove_dynamics,
            }
            instance_id = yield Ask("spawn_object", (name,), settings)
        except SailenvError as error:
            # The client knows no more than "not spawned"; the reason is for the terminal.
            _log.warning("%r was not spawned: %s", name, one_line(error))
            return [pack_string("")]
        return [pack_string(str(instance_id))]

    def despawn_object(self, id: int) -> Answer:
        """Take an object out of the scene."""
        return (yield from in_words(_despawned(id)))

    def send_obj_zip(self, filename: str, data: bytes) -> Answer:
        """Import a model; tell the name that spawns it, or what is wrong after ``error:``."""
        try:
            name = yield Ask("upload_model", (data,), {"name": "", "filename": filename})
        except SailenvError as error:
            _log.warning("the model %r was refused: %s", filename, one_line(error))
            return [pack_string(f"error: {one_line(error)}")]
        return [pack_string(name)]


def _despawned(instance_id: int) -> Generator[Step, Any, None]:
    yield Ask("despawn_object", (instance_id,))
