"""Handlers of worlds: the scenes, and those that are generated."""

from __future__ import annotations

from typing import Any
from urllib.parse import quote, unquote

from simulation_interfaces.msg import Result, WorldResource
from simulation_interfaces.srv import GetAvailableWorlds, GetCurrentWorld, LoadWorld, UnloadWorld

from sailenv_ros.authoring.room_rules.names import MAX_SEED, PREFIX, asked_for
from sailenv_ros.authoring.room_rules.rule_files import room_kinds
from sailenv_ros.errors import AssetError, InvalidRequest, SailenvError, SceneError, UnknownName
from sailenv_ros.ros.nodes.simulation_interfaces.clock import pause_for
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.filters import tags_filter
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, refused, unsupported
from sailenv_ros.ros.nodes.simulation_interfaces.versions import resource_of
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.entity_operations import EntityOperations

__all__ = ["get_available_worlds", "get_current_world", "load_world", "unload_world"]

SCENE_SCHEME = "sailenv://scene/"
"""Begin of the URI of a scene."""

EMPTY = "void"
"""Name of the scene that there is while no world is loaded."""

GENERATED_TAG = "generated"


async def load_world(desk: Desk, request: Any, response: Any) -> None:
    """Load a scene; it is stopped then. If it cannot be loaded, the present one continues."""
    code = LoadWorld.Response
    uri, text = resource_of(request, "world_resource")
    if not uri:
        if text:
            raise unsupported("worlds are loaded by uri alone; see get_available_worlds")
        raise Refusal(code.NO_RESOURCE, "a uri must be given; see get_available_worlds")
    scene = _scene(uri)
    try:
        await _change(desk, scene)
    except SailenvError as problem:
        codes: dict[type[SailenvError], int] = {
            UnknownName: Result.RESULT_NOT_FOUND,
            SceneError: code.RESOURCE_PARSE_ERROR,
            AssetError: code.MISSING_ASSETS,
            InvalidRequest: Result.RESULT_NOT_FOUND,
        }
        raise refused(problem, codes) from None
    response.world = await _world(desk, desk.info.scene)


async def unload_world(desk: Desk, request: Any, response: Any) -> None:
    """Leave the present scene for none."""
    if desk.notes.unloaded:
        raise Refusal(UnloadWorld.Response.NO_WORLD_LOADED, "no world is loaded")
    desk.require_world()
    await _change(desk, EMPTY)
    desk.notes.unloaded = True


async def get_current_world(desk: Desk, request: Any, response: Any) -> None:
    """Tell the present scene."""
    if desk.notes.unloaded:
        raise Refusal(GetCurrentWorld.Response.NO_WORLD_LOADED, "no world is loaded")
    desk.require_world()
    response.world = await _world(desk, desk.info.scene)


async def get_available_worlds(desk: Desk, request: Any, response: Any) -> None:
    """Tell the scenes, and one generated scene of each kind, whose seed may be another."""
    wanted = tags_filter(request.filter)
    sources = ", ".join(request.additional_sources)
    problems = [f"these sources are not searched: {sources}"] if sources else []
    if problems and not request.continue_on_error:
        raise Refusal(Result.RESULT_OPERATION_FAILED, problems[0])
    worlds = []
    for scene in desk.info.scenes:
        try:
            worlds.append(await _world(desk, scene))
        except SailenvError as problem:
            if not request.continue_on_error:
                code = GetAvailableWorlds.Response.DEFAULT_SOURCES_FAILED
                raise Refusal(code, str(problem)) from None
            problems.append(str(problem))
    told = {world.name for world in worlds}
    generated = {f"{PREFIX}{kind}:0": kind for kind in room_kinds()}
    worlds += [
        _resource(name, f"a generated {kind}; seeds 0 to {MAX_SEED}", kind)
        for name, kind in generated.items()
        if name not in told
    ]
    response.worlds = [world for world in worlds if wanted(world.tags)]
    response.result.error_message = "; ".join(problems)


async def _change(desk: Desk, scene: str) -> None:
    if desk.loading:
        raise Refusal(Result.RESULT_INCORRECT_STATE, "another world is being loaded; wait for it")
    desk.loading += 1
    try:
        ran = await pause_for(desk)
        try:
            await desk.do(Operations.change_scene, scene)
        except BaseException:
            if ran:
                await desk.do(Operations.resume)
            raise
    finally:
        desk.loading -= 1
    desk.notes.stopped = True


async def _world(desk: Desk, scene: str) -> Any:
    title, tags = await desk.do(EntityOperations.scene_words, scene)
    name = asked_for(scene)
    kind = (name.split(":")[1],) if name.startswith(PREFIX) else ()
    return _resource(name, title, *tags, *kind)


def _resource(scene: str, title: str, *tags: str) -> Any:
    world = WorldResource(name=scene, description=title)
    world.world_resource.uri = SCENE_SCHEME + quote(scene, safe=":")
    world.tags = [*((GENERATED_TAG,) if scene.startswith(PREFIX) else ()), *tags]
    return world


def _scene(uri: str) -> str:
    if uri.startswith(SCENE_SCHEME):
        return unquote(uri.removeprefix(SCENE_SCHEME))
    if "://" in uri:
        code = LoadWorld.Response.UNSUPPORTED_FORMAT
        sentence = f"uri must be {SCENE_SCHEME}NAME, or the name of a scene, got {uri!r}"
        raise Refusal(code, sentence)
    return uri
