"""The requests that write the present world as a scene file.

Part of `SimulationCore`; each method does all of it or raises and leaves everything as it was.
Knows no thread and no renderer.
"""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

from sailenv_ros.errors import InvalidEntry, InvalidRequest
from sailenv_ros.scene.dumper import dump_scene
from sailenv_ros.scene.entries import checked_scene
from sailenv_ros.scene.loader import MAX_BYTES
from sailenv_ros.scene.places import checked_scene_name, write_scene
from sailenv_ros.simulation.agent_table import AgentTable
from sailenv_ros.simulation.saving import described_world, unsaid, uploaded_models
from sailenv_ros.simulation.scenes import SceneLibrary
from sailenv_ros.world.world import World

__all__ = ["SaveRequests"]


class SaveRequests:
    """What clients may ask to have written; `SimulationCore` has the world and the agents."""

    _agents: AgentTable
    _library: SceneLibrary
    _world: World

    def scene_text(self, *, title: str | None = None, cameras: Collection[str] = ()) -> str:
        """Give the YAML text that `save_scene` would write; uploaded models are named as they are.

        See `save_scene` for the arguments and the errors.
        """
        return self._written(self._world.scene, title, cameras)

    def save_scene(
        self,
        name: str,
        *,
        overwrite: bool = False,
        title: str | None = None,
        cameras: Collection[str] = (),
        keep_models: bool = False,
    ) -> str:
        """Write the present world into the folder of one's own scenes; give the file's path.

        `change_scene` takes the name from then on.
        """
        path = self._own_path(name)
        text = self._written(name, title, cameras)
        models = uploaded_models(self._world, self._library.is_uploaded)
        if models and not keep_models:
            accepted = "true, so that uploaded models are put into your own pack: no scene file "
            raise InvalidRequest(
                "keep_models", keep_models, f"{accepted}can name {_listed(models)} otherwise"
            )
        if path.exists() and not overwrite:
            accepted = "one that no file has yet, unless it shall be overwritten"
            raise InvalidRequest("scene name", name, accepted)
        for model in models:
            self._library.keep_model(model)
        write_scene(path.parent, name, text, overwrite=bool(overwrite))
        self._announce()
        return str(path)

    # -- inside ----------------------------------------------------------------------------

    def _own_path(self, name: str) -> Path:
        """Give the file of a scene of one's own; no other scene may have its name."""
        path = self._library.own_folder.absolute() / f"{checked_scene_name(name)}.yaml"
        if name in self._library.scene_names:
            other = self._library.path(name).absolute()
            if other != path:
                accepted = f"another than that of the scene {other}, which would be hidden"
                raise InvalidRequest("scene name", name, accepted)
        return path

    def _written(self, name: str, title: str | None, cameras: Collection[str]) -> str:
        what = f"scene {name!r}"
        data: dict[str, Any] = described_world(self._world, self._agents, cameras=cameras)
        if title is not None:
            data["title"] = title
        lost = list(unsaid(self._world))
        if lost:
            raise InvalidEntry(what, name, lost)
        text = dump_scene(checked_scene(data, self._library.knowledge, what=what))
        if len(text.encode()) > MAX_BYTES:
            raise InvalidRequest("size of the scene", len(text), f"at most {MAX_BYTES} bytes")
        return text

    # -- of the simulation -----------------------------------------------------------------

    def _announce(self) -> None:
        raise NotImplementedError


def _listed(names: Collection[str]) -> str:
    return ", ".join(repr(name) for name in names)
