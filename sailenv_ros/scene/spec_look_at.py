"""Look-at target of an agent or a mover of a scene file."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import ClassVar

from sailenv_ros.scene.field_types import optional
from sailenv_ros.scene.fields import Name, Position, Rule, SceneModel
from sailenv_ros.scene.messages import suggestion
from sailenv_ros.scene.rules import Entry, Faults, listed, named_objects
from sailenv_ros.types.look_at import LookAt

__all__ = ["LookAtSpec", "faced_objects_exist"]


def _looks_at_something(entry: Entry) -> Faults:
    if entry.get("object") is None and entry.get("point") is None:
        yield ("object",), "or a point is needed: what is faced"


class LookAtSpec(SceneModel):
    """Target that an agent or a mover keeps facing, wherever both of them go."""

    rules: ClassVar[tuple[Rule, ...]] = (_looks_at_something,)

    object: Name | None = optional("an object of the scene, or its last place")
    point: Position | None = optional(
        "the point that is faced [m]: in the world or, with object, in its scaled "
        "frame; default: the object's origin"
    )

    def to_look_at(self) -> LookAt:
        """Return the data type that the simulation takes."""
        return LookAt(obj=self.object or "", point_m=self.point or (0.0, 0.0, 0.0))


def faced_objects_exist(scene: Entry) -> Faults:
    """Refuse agents and movers that face an object which the scene lacks."""
    names = named_objects(scene)
    for place, entry in _onlookers(scene):
        look_at = entry.get("keep_looking_at")
        name = look_at.get("object") if isinstance(look_at, Mapping) else None
        if isinstance(name, str) and name not in names:
            known = suggestion(name, names, listing="its objects")
            where = (*place, "keep_looking_at", "object")
            yield where, f"the scene has no object {name!r}; {known}"


def _onlookers(scene: Entry) -> Iterator[tuple[tuple[str | int, ...], Entry]]:
    if isinstance(scene.get("mover"), Mapping):
        yield ("mover",), scene["mover"]
    for key in ("movers", "agents"):
        for index, entry in enumerate(listed(scene, key)):
            if isinstance(entry, Mapping):
                yield (key, index), entry
