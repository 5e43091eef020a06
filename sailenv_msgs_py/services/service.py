"""An operation as a ROS service: its type, its name, and both directions of its messages.

Node and client use the same object: the client writes requests and reads responses, the node reads
requests and writes responses. Knows no node.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

from sailenv_msgs_py.error_codes import error_from_response
from sailenv_msgs_py.services.message_fields import field_types, read_fields, write_field
from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.simulation.operations import Operation
from sailenv_ros.types.labels import MAX_INSTANCE_ID
from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["Arguments", "Service"]

Arguments = dict[str, Any]
"""Values of an operation's parameters by their names; those of ``**changes`` under that name."""


class Service:
    """One operation's service.

    Parameters
    ----------
    operation : Operation
    type_ : type
        Of the service; its request's fields have the names of the operation's parameters.
    name : str
        Within the simulator's or the agent's namespace; empty is the operation's own.
    names : mapping of str to str
        Names of parameters whose fields are named otherwise.
    none : mapping of str to object
        Values of a field that stand for None, by parameter.
    write, read : callable or None
        ``write(arguments)`` changes the arguments before they are written to a request,
        ``read(arguments)`` after they were read from one; for messages of another form.
    fill, result : callable or None
        ``fill(response, result, info)`` writes a response, ``result(response)`` reads one; None
        means that the response has one field for the result, one for each of several, or none.
    """

    def __init__(
        self,
        operation: Operation[..., Any],
        type_: Any,
        *,
        name: str = "",
        names: Mapping[str, str] | None = None,
        none: Mapping[str, Any] | None = None,
        write: Callable[[Arguments], Arguments] | None = None,
        read: Callable[[Arguments], Arguments] | None = None,
        fill: Callable[[Any, Any, SceneInfo], None] | None = None,
        result: Callable[[Any], Any] | None = None,
    ) -> None:
        self.operation = operation
        self.type = type_
        self.name = name or operation.name
        self._names = {"obj": "id", **(names or {})}
        self._parameters = {field: parameter for parameter, field in self._names.items()}
        self._none = dict(none or {})
        self._write, self._read, self._fill, self._result = write, read, fill, result
        self._request_types = field_types(type_.Request)
        self._response_types = field_types(type_.Response)

    @property
    def of_agent(self) -> bool:
        """True if it is a service of each agent, not of the simulator."""
        return "agent" in self.operation.signature.parameters

    # -- the client's part -----------------------------------------------------------------

    def request(self, bound: inspect.BoundArguments, info: SceneInfo) -> Any:
        """Return the request of a call.

        Parameters
        ----------
        bound : inspect.BoundArguments
            Of the operation, checked.
        info : SceneInfo
            The scene as it was announced last, in which objects are looked up by name.

        Raises
        ------
        InvalidRequest
            If a value cannot be sent, or there is no such object.
        """
        bound.apply_defaults()
        given: Arguments = dict(bound.arguments)
        given.pop("agent", None)
        either = "mover" in self._request_types and "mover" not in given
        if either and _is_mover(given.get("obj"), info):
            given.update(mover=given["obj"], obj=0)
        elif "obj" in given:
            given["obj"] = _object_id(given["obj"], info)
        if self._write is not None:
            given = self._write(given)
        request = self.type.Request()
        for parameter, value in given.items():
            field = self._names.get(parameter, parameter)
            if value is None:
                value = self._none.get(parameter)
            if value is not None and field in self._request_types:
                self._write_request(request, parameter, field, value)
        return request

    def result(self, response: Any) -> Any:
        """Return the result that a response has, or raise the error that it tells."""
        if not response.success:
            raise error_from_response(response)
        if self._result is not None:
            return self._result(response)
        values = tuple(read_fields(response, self._response_types).values())
        return values if len(values) > 1 else next(iter(values), None)

    def _write_request(self, request: Any, parameter: str, field: str, value: Any) -> None:
        type_ = self._request_types[field]
        try:
            write_field(request, field, type_, value)
        except (AssertionError, OverflowError, TypeError, ValueError) as problem:
            if isinstance(problem, InvalidRequest):
                raise
            # The messages' code tells a wrong type or size in these ways.
            raise InvalidRequest(parameter, value, f"what a field of {type_} can hold") from None

    # -- the node's part -------------------------------------------------------------------

    def arguments(self, request: Any) -> tuple[tuple[Any, ...], Arguments]:
        """Return positional and named arguments of the operation that a request asks for.

        Raises
        ------
        InvalidRequest
            If a field cannot be what it is said to be.
        """
        values = read_fields(request, self._request_types)
        given = {self._parameters.get(field, field): value for field, value in values.items()}
        for parameter, value in self._none.items():
            if given.get(parameter) == value:
                given[parameter] = None
        if self._read is not None:
            given = self._read(given)
        return self.operation.arguments(given)

    def respond(self, response: Any, result: Any, info: SceneInfo) -> None:
        """Fill the response of an operation that succeeded.

        Parameters
        ----------
        response : message
        result : object
            Of the operation.
        info : SceneInfo
            The scene as it was announced last.
        """
        response.success = True
        response.revision = info.revision
        if self._fill is not None:
            self._fill(response, result, info)
            return
        results = result if len(self._response_types) > 1 else (result,)
        for (field, type_), value in zip(self._response_types.items(), results, strict=False):
            write_field(response, field, type_, value)


def _is_mover(obj: object, info: SceneInfo) -> bool:
    """Return whether a name is that of a mover, and of no object."""
    named = any(mover.name == obj for mover in info.movers)
    return named and all(instance.name != obj for instance in info.instances)


def _object_id(obj: int | str, info: SceneInfo) -> int:
    """Return the id of an object, which scripts of the SAILenv client hold as a decimal text."""
    if not isinstance(obj, str):
        return obj
    ids = {instance.name: instance.id for instance in info.instances}
    if obj in ids:
        return ids[obj]
    if not obj.isdecimal():
        raise UnknownName("object", obj, ids)
    if not 0 < int(obj) <= MAX_INSTANCE_ID:
        raise InvalidRequest("object", obj, f"an id from 1 to {MAX_INSTANCE_ID}")
    return int(obj)
