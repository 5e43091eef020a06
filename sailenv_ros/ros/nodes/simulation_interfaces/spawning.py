"""Handlers that spawn entities: names, namespaces, resources, places."""

from __future__ import annotations

from typing import Any

from rclpy.exceptions import InvalidNamespaceException
from rclpy.validate_namespace import validate_namespace
from simulation_interfaces.msg import Result, SpawnResult
from simulation_interfaces.srv import SpawnEntity

from sailenv_ros.errors import AssetError, InvalidEntry, NameTaken, SailenvError, UnknownName
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.frames import pose_in_world
from sailenv_ros.ros.nodes.simulation_interfaces.resources import Spawned, spawned_by
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, code_of, refused
from sailenv_ros.ros.nodes.simulation_interfaces.versions import resource_of
from sailenv_ros.scene.entries import free_name
from sailenv_ros.simulation.operations.entity_operations import EntityOperations

__all__ = ["spawn_entities", "spawn_entity"]

Code = SpawnEntity.Response


async def spawn_entity(desk: Desk, request: Any, response: Any) -> None:
    """Spawn one entity."""
    response.entity_name = await _spawn(desk, request)


async def spawn_entities(desk: Desk, request: Any, response: Any) -> None:
    """Spawn several, each as if it were alone."""
    for one in request.spawn_requests:
        told = SpawnResult()
        try:
            told.entity_name = await _spawn(desk, one)
            told.result.result = Result.RESULT_OK
        except SailenvError as problem:
            told.result = Result(result=code_of(problem), error_message=str(problem))
        response.results.append(told)
    failed = [one for one in response.results if one.result.result != Result.RESULT_OK]
    if failed:
        response.result.result = response.ENTITIES_SPAWN_FAILED
        response.result.error_message = (
            f"{len(failed)} of {len(response.results)} could not be spawned: see results"
        )


async def _spawn(desk: Desk, request: Any) -> str:
    spawned = await spawned_by(desk, *resource_of(request, "entity_resource"))
    name = _name(desk, request, spawned)
    pose = await pose_in_world(
        desk, request.initial_pose.header.frame_id, request.initial_pose.pose, Code.INVALID_POSE
    )
    # Slashes separate namespaces in names of entities; the scene's own names have none.
    own = desk.plain_names
    plain = name.replace("/", ".")
    plain = free_name(plain, own) if plain in own else plain
    spawn = EntityOperations.spawn_robot_entry if spawned.is_robot else EntityOperations.spawn_entry
    try:
        number = await desk.do(spawn, {**spawned.entry, "name": plain}, pose)
    except InvalidEntry as problem:
        wrong_name = any(field.endswith("name") for field, _ in problem.diagnostics)
        code = Code.NAME_INVALID if wrong_name else Code.RESOURCE_PARSE_ERROR
        raise Refusal(code, str(problem)) from None
    except SailenvError as problem:
        codes: dict[type[SailenvError], int] = {
            NameTaken: Code.NAME_NOT_UNIQUE,
            UnknownName: Result.RESULT_NOT_FOUND,
            AssetError: Code.MISSING_ASSETS,
        }
        raise refused(problem, codes) from None
    if plain != name:
        desk.rename(number, plain, name)
    return name


def _name(desk: Desk, request: Any, spawned: Spawned) -> str:
    """Return the name with its namespace that the entity shall have."""
    space = request.entity_namespace.strip("/")
    if space:
        try:
            validate_namespace(f"/{space}")
        except InvalidNamespaceException as problem:
            raise Refusal(Code.NAMESPACE_INVALID, " ".join(str(problem).split())) from None
    name = request.name or spawned.name
    if "/" in name:
        sentence = f"name must have no '/', which separates namespaces, got {name!r}"
        raise Refusal(Code.NAME_INVALID, sentence)
    prefix = f"{space}/" if space else ""
    taken = desk.ids
    if name and prefix + name not in taken:
        return prefix + name
    if not request.allow_renaming:
        if not name:
            sentence = "name must not be empty, unless allow_renaming is true"
            raise Refusal(Code.NAME_INVALID, sentence)
        sentence = f"an entity {prefix + name!r} is there already; see allow_renaming"
        raise Refusal(Code.NAME_NOT_UNIQUE, sentence)
    base = name or spawned.kind
    there = {one.removeprefix(prefix) for one in taken if one.startswith(prefix)}
    return prefix + free_name(base, there)
