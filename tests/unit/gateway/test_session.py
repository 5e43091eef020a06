"""A conversation without sockets: every command has an answer, whatever its fields hold."""

from __future__ import annotations

import itertools
import json
import struct
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import sailenv_ros.simulation.simulation as module
from sailenv_ros.errors import InvalidRequest, ProtocolError, SailenvError
from sailenv_ros.gateway.codec import Message, MessageReader
from sailenv_ros.gateway.light_answers import LightAnswers
from sailenv_ros.gateway.object_answers import ObjectAnswers
from sailenv_ros.gateway.protocol_commands import commands_of
from sailenv_ros.gateway.session import Session
from sailenv_ros.gateway.steps import Request
from sailenv_ros.simulation import Simulation
from sailenv_ros.types.agents import AgentSpec
from tests.support.blank_renderer import BlankRenderer
from tests.unit.gateway.wire import hello, messages

IDS = itertools.count(1)
TOLD_IN_WORDS = ("set_", "change_scene", "toggle_follow", "despawn_object", "move_object")


@pytest.fixture(scope="module")
def simulation() -> Iterator[Simulation]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "make_backend", lambda *_: BlankRenderer())
        with Simulation("optical", mode="lockstep") as started:
            yield started


@pytest.fixture
def session(simulation: Simulation) -> Iterator[Session]:
    begun = registered(simulation)
    yield begun
    if begun.agent:
        simulation.delete_agent(begun.agent)


def registered(simulation: Simulation) -> Session:
    session = Session(lambda: simulation.info, lambda: next(IDS))
    answered(session, simulation, hello(16, 12))
    return session


def driven(session: Session, simulation: Simulation, message: Message) -> bytes:
    """Carry an answer out at once; the pieces as they would be sent."""
    answer = session.answer(message)
    result: Any = None
    error: SailenvError | None = None
    while True:
        try:
            step = answer.send(result) if error is None else answer.throw(error)
        except StopIteration as done:
            return b"".join(done.value)
        result = error = None
        try:
            if isinstance(step, Request):
                result = step.operation.submit_to(simulation, *step.args, **step.kwargs).result(
                    60.0
                )
            else:
                result = step.function()
        except SailenvError as problem:
            error = problem


def answered(session: Session, simulation: Simulation, *sent: bytes) -> list[bytes]:
    """Feed bytes after a registration, or a registration; return the answers."""
    reader = MessageReader("0.6")
    if not sent[0].startswith(hello(16, 12)):
        reader.feed(hello())
        reader.take()
    reader.feed(b"".join(sent))
    answers = []
    while (message := reader.take()) is not None:
        answers.append(driven(session, simulation, message))
    assert reader.is_idle
    return answers


def text(value: str) -> bytes:
    return struct.pack("<i", len(value)) + value.encode()


def test_every_command_has_an_answer() -> None:
    """The tables name no command that a session has no method for."""
    for protocol in ("0.5", "0.6"):
        for kind in commands_of(protocol).values():
            groups = (Session, ObjectAnswers, LightAnswers)
            assert [callable(getattr(group, kind.name, None)) for group in groups].count(True) == 1


def test_registration_tells_a_number_and_the_scenes(simulation: Simulation) -> None:
    """Byte for byte: id, number of scenes, their names."""
    session = Session(lambda: simulation.info, lambda: 4242)
    (answer,) = answered(session, simulation, hello(16, 12))
    names = [f"{name}/scene" for name in simulation.info.scenes]
    assert answer == struct.pack("<ii", 4242, len(names)) + b"".join(map(text, names))
    assert session.agent == "client_4242"
    assert answered(session, simulation, b"\x01") == [b""]
    assert session.ended
    assert "client_4242" not in {agent.name for agent in simulation.info.agents}


def test_an_agents_name_that_is_taken_is_passed_over(simulation: Simulation) -> None:
    """A user's own agent of that name stays theirs."""
    simulation.register_agent(AgentSpec(name="client_7", rate_hz=0.0))
    numbers = iter((7, 8_000))
    session = Session(lambda: simulation.info, lambda: next(numbers))
    answered(session, simulation, hello(16, 12))
    assert session.agent == "client_8000"
    for name in ("client_7", "client_8000"):
        simulation.delete_agent(name)


def test_a_frame_of_bytes(session: Session, simulation: Simulation) -> None:
    """Category and depth of 16x12 black pixels: lengths, payloads, the time, nothing else."""
    (answer,) = answered(session, simulation, b"\x00\x24")
    category = struct.pack("<i", 16 * 12 * 3) + bytes(16 * 12 * 3)
    # Depth is 0 everywhere here: nearer than the near plane is white.
    picture = b"P5 16 12 255\n" + b"\xff" * (16 * 12)
    depth = struct.pack("<i", len(picture)) + picture
    assert answer == category + depth + struct.pack("<f", 0.0)


@pytest.mark.parametrize("flags", [2, 64, 255])
def test_flags_of_no_view_end_the_conversation(
    session: Session, simulation: Simulation, flags: int
) -> None:
    """The client would wait for a view that nobody knows."""
    with pytest.raises(ProtocolError, match="flags of a frame"):
        answered(session, simulation, bytes([0, flags]))


@pytest.mark.parametrize(("width", "height"), [(0, 0), (-1, 12), (2**31 - 1, 2**31 - 1), (16, 7)])
def test_sizes_that_cannot_be_are_refused(
    simulation: Simulation, width: int, height: int
) -> None:  # fmt: skip
    """No agent comes of it."""
    before = simulation.info.agents
    session = Session(lambda: simulation.info, lambda: next(IDS))
    message = Message(
        name="register", fields={"width": width, "height": height, "use_gzip": False}
    )  # fmt: skip
    with pytest.raises(InvalidRequest, match="must be an integer from 8 to 4096"):
        driven(session, simulation, message)
    assert session.agent == ""
    assert simulation.info.agents == before


def test_the_later_revision_moves_objects_and_loads_scenarios(
    session: Session, simulation: Simulation
) -> None:
    """Ids of a scenario in order, an object moved by Unity's axes, refusals told as such."""
    bounce = {"start_direction": {"z": 1}, "speed": 0.5, "angular_speed": 10, "seed": 3}
    dynamic = {"type": "uniform_movement_random_bounce", "description": bounce}
    objects = [
        {"prefab": "Cube"},
        {"prefab": "Sphere", "position": {"y": 3}, "dynamic": dynamic, "frustum_limited": True},
    ]
    wanted = {"scene_name": "optical/scene", "objects": objects}
    (answer,) = answered(session, simulation, b"\x1d" + text(json.dumps(wanted)))
    first = int.from_bytes(answer[:4], "little")
    ids = [answer[4 : 4 + first].decode(), answer[8 + first :].decode()]
    assert [simulation.get_object(int(number)).asset for number in ids] == ["cube", "sphere"]
    (behaviour,) = simulation.get_object(int(ids[1])).behaviours
    assert behaviour["keep_in_view"] == session.agent
    assert behaviour["start_direction"] == pytest.approx((1.0, 0.0, 0.0))
    move = b"\x1e" + struct.pack("<i6f", int(ids[0]), 1.0, 2.0, 3.0, 0.0, 90.0, 0.0)
    assert answered(session, simulation, move) == [text("ok")]
    assert simulation.get_object(int(ids[0])).pose.position_m == (3.0, -1.0, 2.0)
    assert answered(session, simulation, b"\x1c") == [b""]
    wrong = {**wanted, "scene_name": "nowhere/scene"}
    assert answered(session, simulation, b"\x1d" + text(json.dumps(wrong))) == [text("") * 2]


def test_the_later_revision_spawns_what_moves(session: Session, simulation: Simulation) -> None:
    """A dynamic becomes a behaviour; one that is unknown is refused, an empty id told."""
    head = b"\x09" + text("Cube") + struct.pack("<6fB3fBBB", *[0.0] * 6, 1, 1.0, 1.0, 1.0, 1, 0, 1)
    turning = text("rotate_rigidbody") + text('{"angular_velocity": [0, 0, 40]}')
    (answer,) = answered(session, simulation, head + turning)
    state = simulation.get_object(int(answer[4:]))
    assert not state.static
    assert [behaviour["type"] for behaviour in state.behaviours] == ["rotate_rigidbody"]
    unknown = head + text("swim") + text("{}")
    assert answered(session, simulation, unknown) == [text("")]


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(sent=st.lists(messages(dict(commands_of("0.6"))), max_size=5))
def test_any_commands_are_answered_or_end_the_conversation(
    simulation: Simulation, sent: list[tuple[bytes, str, dict[str, Any]]]
) -> None:
    """Nothing but our errors; what is told in words is one text; the simulator goes on."""
    session = registered(simulation)
    try:
        for _, name, fields in sent:
            if session.ended:
                break
            try:
                answer = driven(session, simulation, Message(name=name, fields=fields))
            except SailenvError:
                continue
            if name.startswith(TOLD_IN_WORDS):
                assert len(answer) == 4 + int.from_bytes(answer[:4], "little")
    finally:
        if session.agent:
            simulation.delete_agent(session.agent)
    assert simulation.lights == simulation.info.lights
