"""A recording as an agent: `get_frame()` gives what the live agent saw, frame after frame.

Made by `Agent.from_recording`. Reads through the same functions as a live agent, so that the dicts
are the same byte for byte. Needs no simulator.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from sailenv_ros.errors import RecordingError
from sailenv_ros.frame.pictures.contact_sheet import save_contact_sheet
from sailenv_ros.recording.frames import RecordedFrames
from sailenv_ros.recording.reader import RecordingReader
from sailenv_ros.simulation.operations.frame_pictures import frame_pictures
from sailenv_ros.system.memory import keep_freed_memory
from sailenv_ros.types.labels import CategoryTable
from sailenv_ros.types.scene_info import SceneInfo, SceneObject

__all__ = ["RecordedAgent"]


class RecordedAgent(Sequence[dict[str, Any]]):
    """The frames of one recorded agent; a sequence, and a context manager.

    Parameters and errors as `Agent.from_recording` has them.
    """

    def __init__(self, path: str | Path, agent: str = "") -> None:
        keep_freed_memory()  # that of frames that were let go, for those that follow
        self._reader = RecordingReader(path)
        try:
            self._frames = RecordedFrames(self._reader, agent)
        except BaseException:
            self._reader.close()
            raise
        self._next = 0
        self._current = 0

    @property
    def id(self) -> str:
        """Name of the agent."""
        return self._frames.agent

    @property
    def views(self) -> tuple[str, ...]:
        """The views that were recorded."""
        return self._frames.views

    @property
    def incomplete(self) -> int:
        """Number of frames skipped because one of their images was not recorded."""
        return self._frames.incomplete

    # -- frames ----------------------------------------------------------------------------

    def get_frame(self) -> dict[str, Any]:
        """Return the next frame, as the live agent's `get_frame` gave it.

        Raises
        ------
        RecordingError
            After the last one; `seek` goes back.
        """
        if self._next >= len(self._frames):
            raise RecordingError(
                f"{self._reader.path} has no frame after its {len(self)}; seek(0) begins anew"
            )
        frame = self[self._next]
        self._next += 1
        return frame

    def seek(self, index: int) -> None:
        """Have `get_frame` continue with the frame of that number, from 0."""
        self._next = self._frames.position(index)

    def frame_at(self, time_s: float) -> dict[str, Any]:
        """Return the last frame at or before a simulated time [s].

        Raises
        ------
        RecordingError
            If all frames are later.
        """
        return self[self._frames.index_at(time_s)]

    def __len__(self) -> int:
        return len(self._frames)

    def __getitem__(self, index: Any) -> Any:
        """Return the frame of that number, from 0, or a list of them; each call a new dict."""
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(len(self)))]
        self._current = self._frames.position(index)
        return self._frames[self._current].to_dict(copy=False)

    def __iter__(self) -> Iterator[dict[str, Any]]:
        return (self[number] for number in range(len(self)))

    def save_contact_sheet(self, path: str | Path, frame: Mapping[str, Any]) -> Path:
        """Write all views of a frame as one labelled PNG file; return its path."""
        info = self._info
        table = info.categories if info else CategoryTable([])
        return save_contact_sheet(path, frame_pictures(frame, table))

    # -- the scene, as it was at the frame that was given last ------------------------------

    @property
    def scene(self) -> str:
        """Name of the scene."""
        return self._info.scene if self._info else ""

    @property
    def scenes(self) -> list[str]:
        """Names of the scenes that there were."""
        return list(self._info.scenes) if self._info else []

    @property
    def categories(self) -> dict[int, str]:
        """Names of the categories by their ids, the values of the category view."""
        known = self._info.categories.values() if self._info else ()
        return {category.id: category.name for category in known}

    @property
    def instances(self) -> dict[int, SceneObject]:
        """The objects of the scene by their ids, the values of the instance view."""
        return {} if self._info is None else dict(self._info.objects)

    def close(self) -> None:
        """Close the files; a second call does nothing."""
        self._reader.close()

    def __enter__(self) -> RecordedAgent:
        return self

    def __exit__(self, *exc: object) -> None:
        self.close()

    @property
    def _info(self) -> SceneInfo | None:
        return self._frames.scene_info(self._current) if len(self._frames) else None
