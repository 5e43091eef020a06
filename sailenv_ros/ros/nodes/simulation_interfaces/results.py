"""Result codes: what went wrong in a handler becomes the response's `result`."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Coroutine
from typing import Any

from simulation_interfaces.msg import Result

from sailenv_ros.errors import SailenvError, UnknownName
from sailenv_ros.ros.nodes import requests

__all__ = ["Refusal", "answered", "code_of", "refused", "unsupported"]


class Refusal(SailenvError):
    """A request that is refused with a code of its own."""

    def __init__(self, code: int, sentence: str) -> None:
        self.code = code
        super().__init__(sentence)


def unsupported(sentence: str) -> Refusal:
    """Return the refusal of what `GetSimulatorFeatures` does not announce."""
    return Refusal(Result.RESULT_FEATURE_UNSUPPORTED, sentence)


def refused(problem: SailenvError, codes: dict[type[SailenvError], int]) -> Refusal:
    """Return the refusal that an error is, by the first type in a table that fits."""
    for kind, code in codes.items():
        if isinstance(problem, kind):
            return Refusal(code, str(problem))
    return Refusal(code_of(problem), str(problem))


def code_of(problem: SailenvError) -> int:
    """Return the code of an error that no handler has named a better one for."""
    if isinstance(problem, Refusal):
        return problem.code
    if isinstance(problem, UnknownName):
        return int(Result.RESULT_NOT_FOUND)
    return int(Result.RESULT_OPERATION_FAILED)


def answered(
    handler: Callable[[Any, Any], Awaitable[None]],
) -> Callable[[Any, Any], Coroutine[Any, Any, Any]]:
    """Make a service callback of a handler that fills a response or raises; see `requests`."""

    async def begun(request: Any, response: Any) -> None:
        if hasattr(response, "result"):
            response.result.result = Result.RESULT_OK
        await handler(request, response)

    return requests.answered(begun, _tell)


def _tell(problem: SailenvError, response: Any) -> None:
    response.result = Result(result=code_of(problem), error_message=str(problem))
