"""Handlers of time: state, steps, reset."""

from __future__ import annotations

from typing import Any

from rclpy.action.server import CancelResponse
from simulation_interfaces.action import SimulateSteps
from simulation_interfaces.msg import Result, SimulationState
from simulation_interfaces.srv import ResetSimulation, SetSimulationState

from sailenv_ros.errors import InternalFault, InvalidState, SailenvError
from sailenv_ros.ros.nodes.simulation_interfaces.desk import Desk
from sailenv_ros.ros.nodes.simulation_interfaces.results import Refusal, code_of, unsupported
from sailenv_ros.simulation.operations import Operations
from sailenv_ros.simulation.operations.entity_operations import EntityOperations

__all__ = [
    "accept_cancel",
    "get_simulation_state",
    "pause_for",
    "reset_simulation",
    "set_simulation_state",
    "simulate_steps",
    "step_simulation",
]

Code = SetSimulationState.Response
Scope = ResetSimulation.Request
EVERY_SCOPE = Scope.SCOPE_TIME | Scope.SCOPE_STATE | Scope.SCOPE_SPAWNED


async def get_simulation_state(desk: Desk, request: Any, response: Any) -> None:
    """Tell the state."""
    response.state.state = desk.state


async def set_simulation_state(desk: Desk, request: Any, response: Any) -> None:
    """Play, pause, stop or quit."""
    target, state = request.state.state, desk.state
    if target == state:
        raise Refusal(Code.ALREADY_IN_TARGET_STATE, f"the simulation is in state {state} already")
    if target == SimulationState.STATE_QUITTING:
        await pause_for(desk)
        desk.quit_soon()
        return
    reachable = (
        SimulationState.STATE_STOPPED,
        SimulationState.STATE_PLAYING,
        SimulationState.STATE_PAUSED,
    )
    if target not in reachable:
        sentence = f"the target must be stopped, playing, paused or quitting, got {target}"
        raise Refusal(Code.INCORRECT_TRANSITION, sentence)
    desk.require_world()
    if target == SimulationState.STATE_STOPPED:
        await pause_for(desk)
        await desk.do(Operations.reset)
        desk.notes.stopped = True
        return
    try:
        if target == SimulationState.STATE_PLAYING:
            await desk.do(Operations.resume)
        else:
            await pause_for(desk)
    except InvalidState as problem:
        raise Refusal(Code.STATE_TRANSITION_ERROR, str(problem)) from None
    desk.notes.stopped = False


async def reset_simulation(desk: Desk, request: Any, response: Any) -> None:
    """Begin again, or put back what was there, or remove what was spawned."""
    scope = request.scope
    if scope in (Scope.SCOPE_DEFAULT, EVERY_SCOPE, Scope.SCOPE_ALL):
        stopped = desk.notes.stopped
        await desk.do(Operations.reset)
        desk.notes.stopped = stopped
        return
    if scope & ~(Scope.SCOPE_STATE | Scope.SCOPE_SPAWNED):
        raise unsupported("time goes back with all the rest alone: scope 0 or 255")
    if scope & Scope.SCOPE_SPAWNED:
        await desk.do(EntityOperations.remove_added)
    if scope & Scope.SCOPE_STATE:
        await desk.do(EntityOperations.put_entities_back)


async def step_simulation(desk: Desk, request: Any, response: Any) -> None:
    """Advance by so many steps."""
    _require_paused(desk)
    await desk.do(Operations.step, request.steps)


async def simulate_steps(desk: Desk, goal: Any) -> Any:
    """Advance step by step, telling of each; the callback of an action."""
    result = SimulateSteps.Result()
    try:
        desk.require_world()
        _require_paused(desk)
        wanted = goal.request.steps
        if not wanted:
            raise Refusal(Result.RESULT_OPERATION_FAILED, "steps must be at least 1, got 0")
        for completed in range(1, wanted + 1):
            if goal.is_cancel_requested:
                goal.canceled()
                sentence = f"cancelled after {completed - 1} of {wanted} steps"
                result.result = Result(
                    result=Result.RESULT_OPERATION_FAILED, error_message=sentence
                )
                return result
            await desk.do(Operations.step, 1)
            told = SimulateSteps.Feedback(
                completed_steps=completed, remaining_steps=wanted - completed
            )
            goal.publish_feedback(told)
    except Exception as error:
        problem = error if isinstance(error, SailenvError) else InternalFault.of(error)
        result.result = Result(result=code_of(problem), error_message=str(problem))
        goal.abort()
        return result
    result.result.result = Result.RESULT_OK
    goal.succeed()
    return result


def accept_cancel(goal: Any) -> CancelResponse:
    """Accept that steps are cancelled: they end after the present one."""
    return CancelResponse.ACCEPT


async def pause_for(desk: Desk) -> bool:
    """Stop time where it runs by itself; return whether it did."""
    runs = not desk.lockstep and not desk.info.paused
    if runs:
        await desk.do(Operations.pause)
    return runs


def _require_paused(desk: Desk) -> None:
    if desk.state != SimulationState.STATE_PAUSED:
        sentence = f"the simulation must be paused to be stepped; its state is {desk.state}"
        raise Refusal(Result.RESULT_OPERATION_FAILED, sentence)
