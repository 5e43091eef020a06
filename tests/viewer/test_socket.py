"""The web viewer's socket: frames at the pace of who looks, wishes, and what the hostile get."""

from __future__ import annotations

import asyncio
import json
from typing import Any

import aiohttp
import numpy as np
import pytest

from sailenv_ros.errors import AddressInUse, InvalidRequest
from sailenv_ros.frame.frame import Frame
from sailenv_ros.simulation import Simulation
from sailenv_ros.simulation.frame_stream import FrameStream
from sailenv_ros.types.camera import Camera, CameraIntrinsics
from sailenv_ros.types.geometry import Pose
from sailenv_ros.types.lights import light_named
from sailenv_ros.types.picture_settings import NAMES, PictureSettings
from sailenv_ros.viewer import ViewerServer
from sailenv_ros.viewer.access_control import SECURITY_HEADERS
from sailenv_ros.viewer.frame_overlay import seen_points
from sailenv_ros.viewer.view_subscription import IN_FLIGHT
from sailenv_ros.viewer.viewer_limits import ViewerLimits
from tests.support.viewer_socket import DEADLINE_S, ViewerSocket, connected, in_a_loop
from tests.support.waiting import until
from tests.viewer.conftest import SMALL

VIEWS = ["rgb", "depth", "category", "instance", "flow"]


def agents_of(simulation: Simulation) -> list[str]:
    """Names of the agents that there are now."""
    return [agent.name for agent in simulation.info.agents]


def test_frames_come_while_somebody_looks(server: ViewerServer, simulation: Simulation) -> None:
    """The debug agent is there as long as it is watched; a frame has all that was asked for."""

    async def look() -> list[dict[str, Any]]:
        async with connected(server) as client:
            await client.ask("watch", agent="debug_agent", views=VIEWS)
            heads = [await client.frame() for _ in range(4)]
            assert "debug_agent" in agents_of(simulation)
        return heads

    assert "debug_agent" not in agents_of(simulation)
    heads = asyncio.run(look())
    assert [view["name"] for view in heads[0]["views"]] == VIEWS
    assert [head["number"] for head in heads] == [1, 2, 3, 4]
    assert heads[0]["time_s"] < heads[-1]["time_s"]
    until(lambda: "debug_agent" not in agents_of(simulation), "the debug agent to go")


@in_a_loop
async def test_who_shows_nothing_holds_nobody_up(
    server: ViewerServer, simulation: Simulation
) -> None:
    """A stalled page is sent two frames; two others go on, and alone it lets nothing be drawn."""
    async with connected(server) as stalled, connected(server) as one, connected(server) as two:
        for client in (stalled, one, two):
            await client.ask("watch", agent="debug_agent", views=["rgb"])
        for _ in range(IN_FLIGHT):
            await stalled.frame(shown=False)
        for _ in range(6):
            await one.frame()
            await two.frame()
        assert server.clients == 3
        # All that was sent lies before the answer.
        await stalled.ask("select", obj=0)
        assert len(stalled.heads) == IN_FLIGHT
        await stalled.socket.send_json({"do": "shown", "number": 1})
        head = await stalled.frame()
        assert head["number"] == IN_FLIGHT + 1
        assert head["dropped"] > 0


@in_a_loop
async def test_nothing_is_drawn_for_a_page_that_stalls(server: ViewerServer) -> None:
    """Its stream asks for no views until the page has shown what it has."""
    async with connected(server) as client:
        await client.ask("watch", agent="debug_agent", views=["rgb"])
        for _ in range(IN_FLIGHT):
            await client.frame(shown=False)
        await asyncio.to_thread(
            until, lambda: not server.rendered_views, "the stalled page to be given up"
        )
        await client.socket.send_json({"do": "shown", "number": IN_FLIGHT})
        await client.frame()
        assert "rgb" in server.rendered_views


@in_a_loop
async def test_the_probe_tells_the_arrays_values(
    server: ViewerServer, simulation: Simulation
) -> None:
    """While time stands still a capture of the same agent has the very same numbers."""
    async with connected(server) as client:
        await client.ask("watch", agent="debug_agent", views=["rgb"])
        await client.frame()
        await client.ask("pause")
        try:
            head = await client.until(lambda m: m.get("type") == "frame")
            while head["time_s"] < simulation.sim_time_ns * 1e-9 - 1e-9:
                await client.socket.send_json({"do": "shown", "number": head["number"]})
                head = await client.until(lambda m: m.get("type") == "frame")
            frame = await asyncio.to_thread(simulation.capture, VIEWS, agent="debug_agent")
            for u, v in ((80, 60), (20, 100), (150, 5)):
                told = await client.ask("probe", frame=head["number"], u=u, v=v)
                assert told["instance_id"] == frame["instance"][v, u]
                assert told["category_id"] == frame["category"][v, u]
                depth = frame["depth"][v, u]
                assert (told["depth"] is None) == (not np.isfinite(depth))
                if told["depth"] is not None:
                    assert np.float32(told["depth"]) == depth
        finally:
            await client.ask("resume")


@in_a_loop
async def test_a_paused_scene_is_drawn_again_when_it_changes(server: ViewerServer) -> None:
    """Who edits while time stands still sees what has changed."""
    async with connected(server) as client:
        await client.ask("watch", agent="debug_agent", views=["rgb"])
        await client.frame()
        await client.ask("pause")
        try:
            made = await client.ask("spawn", asset="cube", u=80, v=60)
            await client.ask("select", obj=made["id"])
            while not (head := await client.frame()).get("outline"):
                pass
            assert made["id"] in dict(head["visible"])
            await client.ask("despawn_object", obj=made["id"])
            while made["id"] in dict((await client.frame())["visible"]):
                pass
        finally:
            await client.ask("resume")


@in_a_loop
async def test_the_instant_of_a_pause_is_drawn_though_an_older_frame_came_late(
    server: ViewerServer, simulation: Simulation, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A busy machine hands on a frame of before the pause when time stands already."""
    wait_for_frame = FrameStream.get
    before: list[Frame] = []
    late: list[Frame] = []

    def get(stream: FrameStream, timeout_s: float) -> Frame:
        if simulation.info.paused and not late:
            late.append(before[0])
            return late[0]
        before.append(wait_for_frame(stream, timeout_s))
        return before[-1]

    monkeypatch.setattr(FrameStream, "get", get)
    async with connected(server) as client:
        await client.ask("watch", agent="debug_agent", views=["rgb"])
        await client.frame()
        await client.ask("pause")
        try:
            while (await client.frame())["time_s"] < simulation.sim_time_ns * 1e-9 - 1e-9:
                pass
            assert late
        finally:
            await client.ask("resume")


@in_a_loop
async def test_a_spawned_object_stands_where_it_was_pointed_at(server: ViewerServer) -> None:
    """Its foot lies on the point that the pixel shows, although a cube's origin is its middle."""
    async with connected(server) as client:
        await client.ask("pause")
        await client.ask("watch", agent="debug_agent", views=["rgb"])
        head = await client.frame()
        made = await client.ask("spawn", asset="cube", frame=head["number"], u=80, v=110)
        pose = Pose.from_rpy_deg(head["position"], head["rpy_deg"])
        foot = np.array(made["position"]) - (0.0, 0.0, 0.5 * made["size"][2])
        pixel = seen_points(Camera(intrinsics=SMALL, pose=pose), foot)
        assert pixel == pytest.approx([80, 110], abs=1)
        changed = await client.ask("change_object", obj=made["id"], changes={"scale": 0.5})
        assert changed["scale"] == [0.5, 0.5, 0.5]
        moved = await client.ask(
            "move_object",
            obj=made["id"],
            pose={"position": [1, 2, 3], "rotation": [0, 0, 90]},
            teleport=True,
        )
        assert moved["position"][:2] == pytest.approx([1, 2], abs=0.01)
        await client.ask("despawn_object", obj=made["id"])
        await client.ask("resume")


def test_pictures_and_lights_are_changed(server: ViewerServer, simulation: Simulation) -> None:
    """Some settings of an agent, which the debug agent keeps; a light comes where the camera is."""

    def picture(name: str) -> PictureSettings:
        (found,) = (agent.picture for agent in simulation.info.agents if agent.name == name)
        return found

    async def look() -> None:
        async with connected(server) as client:
            greeting = await client.until(lambda message: message["type"] == "hello")
            assert [setting["name"] for setting in greeting["picture_settings"]] == list(NAMES)
            await client.ask("watch", agent="debug_agent", views=["rgb"])
            await client.frame()
            changes = {"exposure": 1.0, "tone_curve": "linear"}
            await client.ask("set_picture", agent="debug_agent", changes=changes)
            assert picture("debug_agent") == PictureSettings(exposure=1.0, tone_curve="linear")
            words = await client.refusal(
                "set_picture", agent="debug_agent", changes={"exposure": 0.0, "bloom": 7}
            )
            assert words.startswith("bloom must be a number from 0 to 1")
            assert picture("debug_agent").exposure == 1.0
            while 1.0 not in [
                agent["picture"]["exposure"]
                for message in client.told
                if message["type"] == "scene"
                for agent in message["agents"]
            ]:
                await asyncio.wait_for(client.read(), DEADLINE_S)
            await client.ask("set_mover_controller", mover="", controller="rigidbody")
            # Frames that came between answers: only who has shown them gets more.
            last = client.heads[-1]["number"]
            await client.socket.send_json({"do": "shown", "number": last})
            for _ in range(IN_FLIGHT + 1):
                head = await client.frame()  # the last one at the latest is of a camera at rest
            await client.ask(
                "add_light", light_name="lamp", light_type="spot", attributes={"intensity": 2.0}
            )
            lamp = light_named("lamp", simulation.info.lights)
            assert (lamp.type, lamp.intensity) == ("spot", 2.0)
            assert lamp.position_m == pytest.approx(head["position"], abs=1e-6)
            ahead = Pose.from_rpy_deg((0.0, 0.0, 0.0), head["rpy_deg"]).matrix()[:3, 0]
            assert lamp.direction == pytest.approx(tuple(ahead), abs=1e-6)
            words = await client.refusal("add_light", light_name="lamp", light_type="point")
            assert "lamp" in words
            await client.ask("remove_light", light_name="lamp")
            assert "lamp" not in {light.name for light in simulation.info.lights}
            await client.ask("set_mover_controller", mover="", controller="waypoint")

    async def look_again() -> None:
        async with connected(server) as client:
            await client.ask("watch", agent="debug_agent", views=["rgb"])
            await client.frame()
            assert picture("debug_agent") == PictureSettings(exposure=1.0, tone_curve="linear")
            usual = {setting: getattr(PictureSettings(), setting) for setting in NAMES}
            await client.ask("set_picture", agent="debug_agent", changes=usual)
            assert picture("debug_agent") == PictureSettings()

    asyncio.run(look())
    until(lambda: "debug_agent" not in agents_of(simulation), "the debug agent to go")
    asyncio.run(look_again())


HOSTILE = [
    "",
    "x",
    "[]",
    '{"do": 3}',
    '{"do": "__class__"}',
    '{"do": "shown", "number": "many"}',
    '{"do": "shown", "number": 1e99}',
    '{"do": "watch", "agent": "nobody", "views": ["rgb"]}',
    '{"do": "watch", "agent": "debug_agent", "views": [{}]}',
    '{"do": "watch", "agent": "debug_agent", "views": ["everything"]}',
    '{"do": "probe", "u": 1e999, "v": null}',
    '{"do": "set_light", "light_name": "sun", "changes": {"name": "moon"}}',
    '{"do": "set_light", "light_name": "sun", "changes": {"timeout_s": 1}}',
    '{"do": "set_picture", "agent": "nobody", "changes": {}}',
    '{"do": "set_picture", "agent": "debug_agent", "changes": {"agent": "debug_agent"}}',
    '{"do": "set_picture", "agent": "debug_agent", "changes": {"settings": {}}}',
    '{"do": "set_picture", "agent": "debug_agent", "changes": {"exposure": "bright"}}',
    '{"do": "set_picture", "agent": "debug_agent", "changes": [1]}',
    '{"do": "add_light", "light_name": "", "light_type": "point"}',
    '{"do": "add_light", "light_name": "lamp", "light_type": "candle"}',
    '{"do": "add_light", "light_name": "lamp", "light_type": "spot", "attributes": {"name": "x"}}',
    '{"do": "add_light", "light_name": "x", "light_type": "spot", "attributes": {"colour": null}}',
    '{"do": "remove_light", "light_name": "nobody"}',
    '{"do": "set_environment", "changes": {"sky_map": "../../etc/passwd"}}',
    '{"do": "change_scene", "scene": "/etc/passwd"}',
    '{"do": "save_scene", "name": "../evil"}',
    '{"do": "change_object", "obj": 1, "changes": {"asset": "x"}}',
    '{"do": "add_behaviour", "obj": 1, "behaviour": {"type": "os:system"}}',
    '{"do": "lens", "width": 4096, "height": 4096, "fov_deg": 60}',
    '{"do": "step", "count": 1000000}',
    '{"do": "set_waypoints", "waypoints": [3], "mover": "", "total_time_s": 1}',
    '{"do": "spawn", "asset": "\\ud800", "u": 1, "v": 1}',
    '{"do": "drive_mover", "mover": "", "linear_m_s": [1e11, 0, 0]}',
    '{"do": "drive_mover", "mover": "", "linear": [1, 0, 0]}',
    '{"do": "turn_mover", "yaw_rad": 1e999}',
    '{"do": "turn_mover", "yaw_rad": 99999999999999999999999}',
    '{"do": "move_object"}',
    '{"do": "move_object", "obj": 1, "teleport": "no"}',
    '{"do": "move_object", "obj": 1, "pose": [0, 0, 0]}',
    '{"do": "save_scene", "name": "mine", "overwrite": 0}',
    '{"do": "set_look_at", "obj": {}}',
    '{"do": "start_lessons", "lessons": [1]}',
]


@pytest.mark.parametrize("message", HOSTILE)
def test_hostile_messages_are_answered_in_words(
    server: ViewerServer, simulation: Simulation, message: str, caplog: pytest.LogCaptureFixture
) -> None:
    """Nothing changes, no fault is logged, and the socket stays open."""
    before = simulation.info.scene

    async def send() -> None:
        async with connected(server) as client:
            await client.ask("watch", agent="debug_agent", views=["rgb"])
            await client.frame()
            await client.socket.send_str(message)
            answer = await client.until(lambda m: m["type"] in ("refused", "watch_ended"))
            assert len(answer.get("error", answer.get("why", ""))) > 10
            assert (await client.refusal("nonsense")).startswith("command must be")

    asyncio.run(send())
    assert simulation.info.scene == before
    assert "internal error" not in caplog.text


@in_a_loop
async def test_bytes_floods_and_giants_end_a_conversation(server: ViewerServer) -> None:
    """Bytes are refused in words; too much of anything closes the socket."""
    async with connected(server) as client:
        await client.socket.send_bytes(b"\x00" * 100)
        assert (await client.until(lambda m: m["type"] == "refused"))["error"]
        await client.socket.send_str("x" * (70 * 1024))
        assert await closing_code(client) in (aiohttp.WSCloseCode.MESSAGE_TOO_BIG, RESET)
    async with connected(server) as client:
        for _ in range(500):
            try:
                await client.socket.send_str(json.dumps({"do": "shown", "number": 0}))
            except ConnectionError:  # closed before the last of them
                break
        assert await closing_code(client) in (aiohttp.WSCloseCode.POLICY_VIOLATION, RESET)


RESET = aiohttp.WSCloseCode.ABNORMAL_CLOSURE
"""What a peer sees if it was still sending: the kernel drops the close message with the rest."""


async def closing_code(client: ViewerSocket) -> int | None:
    """Read to the end; return the code that the server closed with."""
    while (await asyncio.wait_for(client.socket.receive(), 20.0)).type in (
        aiohttp.WSMsgType.TEXT,
        aiohttp.WSMsgType.BINARY,
    ):
        pass
    return client.socket.close_code


def test_who_does_not_answer_is_gone(
    simulation: Simulation, caplog: pytest.LogCaptureFixture
) -> None:
    """As one whose machine was switched off; the debug agent goes with it."""

    async def fall_silent(server: ViewerServer) -> None:
        async with (
            aiohttp.ClientSession() as session,
            session.ws_connect(
                server.url + "socket",
                headers={"Origin": server.url.rstrip("/")},
                autoping=False,
            ) as socket,
        ):
            await socket.send_json({"do": "watch", "agent": "debug_agent", "views": ["rgb"]})
            await asyncio.to_thread(until, lambda: server.clients, "it to be greeted")
            await asyncio.to_thread(until, lambda: "debug_agent" in agents_of(simulation), "it")
            await asyncio.to_thread(until, lambda: not server.clients, "its end", 10.0)

    limits = ViewerLimits(silent_s=0.5)
    with ViewerServer(simulation, port=0, limits=limits) as server:
        server.set_intrinsics(CameraIntrinsics(width=160, height=120))
        asyncio.run(fall_silent(server))
        until(lambda: "debug_agent" not in agents_of(simulation), "the debug agent to go")
    assert "a viewer is disconnected: it does not answer" in caplog.text


def test_viewers_of_one_simulation_share_the_debug_agent(simulation: Simulation) -> None:
    """It stays while anybody watches it in either of them, and goes with the last."""

    async def look(first: ViewerServer, other: ViewerServer) -> None:
        async with connected(other) as stays:
            async with connected(first) as leaves:
                await leaves.ask("watch", agent="debug_agent", views=["rgb"])
                await leaves.frame()
                await stays.ask("watch", agent="debug_agent", views=["rgb"])
                await stays.frame()
            await asyncio.to_thread(first.close)
            for _ in range(3):
                await stays.frame()

    with ViewerServer(simulation, port=0) as other, ViewerServer(simulation, port=0) as first:
        asyncio.run(look(first, other))
    until(lambda: "debug_agent" not in agents_of(simulation), "the debug agent to go")


def test_other_sites_and_too_many_are_refused(simulation: Simulation) -> None:
    """A foreign Origin, a foreign Host and the ninth viewer get words instead of a socket."""
    limits = ViewerLimits(clients=1)

    async def knock(server: ViewerServer) -> None:
        for headers in ({"Origin": "http://evil.example"}, {"Host": "evil.example"}):
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                async with connected(server, **headers):
                    pass
            assert refused.value.status == 403
        async with connected(server) as client:
            await client.ask("select", obj=0)
            with pytest.raises(aiohttp.WSServerHandshakeError):
                async with connected(server):
                    pass

    with ViewerServer(simulation, port=0, limits=limits) as server:
        asyncio.run(knock(server))


def test_from_elsewhere_a_token_is_needed_and_only_looks(simulation: Simulation) -> None:
    """Without the token neither page nor socket; with it nothing can be changed unless allowed."""

    async def knock(server: ViewerServer, *, may: bool) -> None:
        token = server.url.partition("token=")[2]
        base = f"http://127.0.0.1:{server.port}/"
        async with aiohttp.ClientSession() as session:
            async with session.get(base) as page:
                assert page.status == 403
            async with session.get(base, params={"token": token}) as page:
                assert page.status == 200
        with pytest.raises(aiohttp.WSServerHandshakeError):
            async with connected(server, token="guess"):
                pass
        async with connected(server, token=token) as client:
            hello = await client.until(lambda m: m["type"] == "hello")
            assert hello["control"] is may
            if may:
                await client.ask("pause")
                await client.ask("resume")
            else:
                assert "--viewer-control" in await client.refusal("pause")

    for may in (False, True):
        with ViewerServer(simulation, host="0.0.0.0", port=0, control=may) as server:
            assert "token=" in server.url
            asyncio.run(knock(server, may=may))


@in_a_loop
async def test_every_answer_has_the_headers_that_protect_the_page(server: ViewerServer) -> None:
    """The page, its files, what does not exist, and refusals."""
    base = f"http://127.0.0.1:{server.port}/"
    async with aiohttp.ClientSession() as session:
        for path, status in (("", 200), ("main.js", 200), ("no.js", 404), ("a/b", 404)):
            async with session.get(base + path) as answer:
                assert answer.status == status
                for name, value in SECURITY_HEADERS.items():
                    assert answer.headers[name] == value
        for path in ("..%2f__init__.py", "%2e%2e/setup.py", "server.py"):
            async with session.get(base + path) as answer:
                assert answer.status == 404


def test_an_address_that_is_taken_is_refused(server: ViewerServer, simulation: Simulation) -> None:
    """In one sentence, and nothing is left running."""
    with pytest.raises(AddressInUse, match="the viewer cannot listen on"):
        ViewerServer(simulation, port=server.port)
    with pytest.raises(InvalidRequest, match="port"):
        ViewerServer(simulation, port=70_000)


def test_the_window_ends_with_people_before_it(simulation: Simulation) -> None:
    """Closing tells every page so; a second time does nothing."""

    async def look(server: ViewerServer) -> int | None:
        async with connected(server) as client:
            await client.ask("watch", agent="debug_agent", views=["rgb"])
            await client.frame()
            closing = asyncio.get_running_loop().run_in_executor(None, server.close)
            code = await closing_code(client)
            await closing
            return code

    server = ViewerServer(simulation, port=0)
    assert asyncio.run(look(server)) == aiohttp.WSCloseCode.GOING_AWAY
    server.close()
    until(lambda: "debug_agent" not in agents_of(simulation), "the debug agent to go")
