"""Messages of the socket and their declarations: the page's types are those of the program."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_origin

import pytest
from typing_extensions import NotRequired, get_type_hints

from sailenv_ros.simulation import Simulation
from sailenv_ros.viewer import ViewerServer, stats_news
from sailenv_ros.viewer.messages import (
    FrameHead,
    HelloMessage,
    ObjectMessage,
    ObjectValues,
    StatsMessage,
)
from sailenv_ros.viewer.scene_messages import SceneMessage
from tests.support.viewer_socket import ViewerSocket, in_a_loop, page_of

WRITER = Path(__file__).resolve().parents[2] / "scripts" / "page_messages.py"

DECLARED: dict[str, Any] = {
    "hello": HelloMessage,
    "scene": SceneMessage,
    "stats": StatsMessage,
    "frame": FrameHead,
    "object": ObjectMessage,
}


def keys(declared: Any, needed: bool) -> set[str]:
    """Return the keys of a typed dictionary, or those that every message has."""
    hints = get_type_hints(declared, include_extras=True).items()
    return {key for key, hint in hints if not needed or get_origin(hint) is not NotRequired}


def test_the_types_of_the_page_are_those_of_the_program() -> None:
    """The committed file is what the declarations say."""
    done = subprocess.run(
        [sys.executable, str(WRITER), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


@in_a_loop
async def test_messages_have_the_keys_that_are_declared(
    server: ViewerServer, simulation: Simulation
) -> None:
    """All that is needed and no other; of each kind of news that comes by itself."""
    async with page_of(server) as page:
        await page.ask("select", obj=simulation.info.instances[0].id)
        for kind in ("stats", "object"):
            if kind not in {message["type"] for message in page.told}:
                await page.until(lambda message, kind=kind: message["type"] == kind)
        for message in [*page.told, *page.heads]:
            declared = DECLARED.get(message["type"])
            if declared is not None:
                assert keys(declared, True) <= message.keys() <= keys(declared, False)
        kinds = {message["type"] for message in [*page.told, *page.heads]}
        assert kinds >= DECLARED.keys()
        (first,) = (one for one in page.told if one["type"] == "object")
        assert first["object"].keys() == keys(ObjectValues, False)


async def told(page: ViewerSocket, number: int, fits: Callable[[Any], bool]) -> None:
    """Read until the last that was told of an object fits."""

    def last_fits(_: object = None) -> bool:
        of_it = [one for one in page.told if one["type"] == "object" and one["id"] == number]
        return bool(of_it) and fits(of_it[-1]["object"])

    if not last_fits():
        await page.until(last_fits)


@in_a_loop
async def test_a_selected_object_is_told_when_it_changes(
    server: ViewerServer, simulation: Simulation
) -> None:
    """By this page or by a program, also while time stands still; and that it is gone."""
    simulation.pause()
    try:
        number = simulation.spawn_object("cube", position=(0.0, 0.0, 3.0), remove_dynamics=False)
        async with page_of(server) as page:
            await page.ask("select", obj=number)
            await told(page, number, lambda one: one["position"][2] == pytest.approx(3.0))
            await page.ask("change_object", obj=number, changes={"scale": 0.5})
            await told(page, number, lambda one: one["scale"] == [0.5, 0.5, 0.5])
            simulation.move_object(number, position=(0.0, 0.0, 4.0), teleport=True)
            await told(page, number, lambda one: one["position"][2] == pytest.approx(4.0))
            simulation.resume()
            await told(page, number, lambda one: one["position"][2] < 3.5)
            simulation.despawn_object(number)
            await told(page, number, lambda one: one is None)
    finally:
        simulation.resume()


@in_a_loop
async def test_what_does_not_change_is_not_told_again(
    server: ViewerServer, simulation: Simulation
) -> None:
    """A static object is told once, however long time runs."""
    number = next(one.id for one in simulation.info.instances if one.static)
    async with page_of(server) as page:
        await page.ask("select", obj=number)
        await told(page, number, lambda one: one["static"])
        end_s = simulation.sim_time_ns * 1e-9 + 2.5
        await page.until(lambda one: one["type"] == "stats" and one["time_s"] > end_s)
        assert sum(one["type"] == "object" for one in page.told) == 1


async def until_undoable(page: ViewerSocket, what: str) -> None:
    """Read until the last report tells of a change to undo, or to do again."""

    def tells(_: object = None) -> bool:
        reports = [one for one in page.told if one["type"] == "stats"]
        return bool(reports) and reports[-1][what] == "changing the surroundings"

    if not tells():
        await page.until(tells)


def test_what_can_be_undone_is_told_at_once(
    simulation: Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not with the next report of how fast time runs."""
    monkeypatch.setattr(stats_news, "STATS_S", 3600.0)

    async def change(server: ViewerServer) -> None:
        async with page_of(server) as page:
            await page.ask("set_environment", changes={"exposure": 0.5})
            for what in ("undo", "redo"):
                await until_undoable(page, what)
                await page.ask(what)

    with ViewerServer(simulation, port=0) as server:
        asyncio.run(change(server))


@in_a_loop
async def test_values_of_other_names_are_refused(server: ViewerServer) -> None:
    """As those of operations are, so that a page's typing errors are told."""
    async with page_of(server) as page:
        assert "colunm" in await page.refusal("probe", u=1, v=1, colunm=3)
        assert "must be" in await page.refusal("watch", agent="debug_agent", views=[3])


@in_a_loop
async def test_lights_without_a_name_are_numbered_in_turn(
    server: ViewerServer, simulation: Simulation
) -> None:
    """Two that are asked for at once get two names, and the history tells them."""
    async with page_of(server) as page:
        for number in (1, 2):
            await page.socket.send_json({"do": "add_light", "id": -number, "light_type": "point"})
        answers = [await page.until(lambda one, n=n: one.get("id") == -n) for n in (1, 2)]
        assert [one["result"] for one in answers] == ["point 1", "point 2"]
        undone = [(await page.ask("undo"))["what"] for _ in answers]
        assert undone == ["adding the light point 2", "adding the light point 1"]
        assert not {"point 1", "point 2"} & {light.name for light in simulation.info.lights}
