"""Handlers of entities: what there is, where it is, what is known of it."""

from __future__ import annotations

from typing import Any

from simulation_interfaces.msg import EntityCategory, EntityInfo, Result
from simulation_interfaces.srv import SetEntityState

from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk, Told
from sailenv_ros.ros.nodes.simulation_interfaces.filters import (
    CATEGORIES,
    box_to_bounds,
    chosen_entities,
    told_of,
)
from sailenv_ros.ros.nodes.simulation_interfaces.frames import (
    pose_in_world,
    state_to_msg,
    velocities_in_world,
)
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, unsupported
from sailenv_ros.ros.nodes.simulation_interfaces.versions import is_set
from sailenv_ros.simulation.operations.entity_operations import EntityOperations
from sailenv_ros.types.entities import Entity

__all__ = [
    "delete_entity",
    "get_entities",
    "get_entities_states",
    "get_entity_bounds",
    "get_entity_info",
    "get_entity_state",
    "set_entity_info",
    "set_entity_state",
]

INVALID_POSE = SetEntityState.Response.INVALID_POSE

MOST_TAGS = 100
MOST_CHARACTERS = 10_000


async def get_entities(desk: Desk, request: Any, response: Any) -> None:
    """Tell the names of the entities that pass filters."""
    chosen = await chosen_entities(desk, request.filters)
    response.entities = [desk.name_of(entity) for entity in chosen]


async def get_entities_states(desk: Desk, request: Any, response: Any) -> None:
    """Tell the names and the states of the entities that pass filters, of one instant."""
    chosen = await chosen_entities(desk, request.filters)
    response.entities = [desk.name_of(entity) for entity in chosen]
    response.states = [state_to_msg(entity) for entity in chosen]


async def get_entity_state(desk: Desk, request: Any, response: Any) -> None:
    """Tell where an entity is and how it moves."""
    response.state = state_to_msg(await _entity(desk, request.entity))


async def set_entity_state(desk: Desk, request: Any, response: Any) -> None:
    """Put an entity somewhere at once, and let it move on.

    Accelerations follow from forces. 1.5 has no flag for them, and a state that was got must be one
    that can be set: there they are left alone.
    """
    number, state = desk.find(request.entity), request.state
    if getattr(request, "set_acceleration", False):
        raise unsupported("an acceleration cannot be set; a force can, by the service apply_wrench")
    frame = state.header.frame_id
    pose = velocities = None
    if is_set(request, "pose"):
        pose = await pose_in_world(desk, frame, state.pose, INVALID_POSE)
    if is_set(request, "twist"):
        failed = Result.RESULT_OPERATION_FAILED
        velocities = await velocities_in_world(desk, frame, state.twist, failed)
    await desk.do(EntityOperations.set_entity, number, pose, velocities)


async def get_entity_info(desk: Desk, request: Any, response: Any) -> None:
    """Tell category, description and tags of an entity."""
    told = told_of(desk, await _entity(desk, request.entity))
    response.info = EntityInfo(
        category=EntityCategory(category=told.category),
        description=told.description,
        tags=list(told.tags),
    )


async def set_entity_info(desk: Desk, request: Any, response: Any) -> None:
    """Replace category, description and tags of an entity, until the scene begins again."""
    number, info = desk.find(request.entity), request.info
    if info.category.category not in CATEGORIES:
        known = ", ".join(map(str, sorted(CATEGORIES)))
        sentence = f"category must be one of: {known}; got {info.category.category}"
        raise Refusal(Result.RESULT_OPERATION_FAILED, sentence)
    characters = sum(map(len, (info.description, *info.tags)))
    if len(info.tags) > MOST_TAGS or characters > MOST_CHARACTERS:
        sentence = f"at most {MOST_TAGS} tags and {MOST_CHARACTERS} characters are kept"
        raise Refusal(Result.RESULT_OPERATION_FAILED, sentence)
    told = Told(info.category.category, info.description, tuple(info.tags))
    desk.notes.told[number] = told


async def get_entity_bounds(desk: Desk, request: Any, response: Any) -> None:
    """Tell the box around an entity's collision shapes, in its own frame."""
    box = await desk.do(EntityOperations.entity_box, desk.find(request.entity))
    response.bounds = box_to_bounds(*box)


async def delete_entity(desk: Desk, request: Any, response: Any) -> None:
    """Remove an entity; a robot goes with its links."""
    await desk.do(EntityOperations.remove_entity, desk.find(request.entity))


async def _entity(desk: Desk, name: str) -> Entity:
    number = desk.find(name)
    found = await desk.do(EntityOperations.entities)
    entity = next((one for one in found if one.id == number), None)
    if entity is None:
        raise Refusal(Result.RESULT_NOT_FOUND, f"the entity {name!r} was removed just now")
    return entity
