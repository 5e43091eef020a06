"""One operation: its name, signature, documentation, deadline and argument checks, said once.

`operation` declares one in a class of operations. On an object of such a class, which is a
`Caller`, it is a method that blocks; its `submit` returns a future instead. How an operation
reaches the simulation is the caller's part.
"""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from types import MappingProxyType
from typing import (
    TYPE_CHECKING,
    Any,
    Concatenate,
    Generic,
    ParamSpec,
    TypeVar,
    get_args,
    get_origin,
    overload,
)

from typing_extensions import Unpack

from sailenv_ros.errors import InvalidRequest, UnknownName
from sailenv_ros.simulation.operations.argument_checks import declared_checks
from sailenv_ros.system.futures import wait_for
from sailenv_ros.system.own_process import StaysInProcess

if TYPE_CHECKING:
    from sailenv_ros.simulation.models.model_workers import ModelWorkers
    from sailenv_ros.simulation.operations.targets import OperationTarget
    from sailenv_ros.types.scene_info import SceneInfo

__all__ = ["BoundOperation", "Caller", "Check", "Operation", "background_operation", "operation"]

P = ParamSpec("P")
R = TypeVar("R", covariant=True)

Check = Callable[[str, Any], Any]
"""Takes the name of an argument and its value, returns the value to use or raises."""


class Caller(StaysInProcess, ABC):
    """Carries out operations: in the same thread, in another one, or in another process."""

    @property
    @abstractmethod
    def info(self) -> SceneInfo:
        """The scene as it was announced last; never blocks."""

    @property
    def own_agent(self) -> str | None:
        """The agent that operations on agents mean if none is named; None is the scene's first."""
        return None

    @abstractmethod
    def submit_operation(
        self, operation: Operation[..., Any], arguments: inspect.BoundArguments
    ) -> Future[Any]:
        """Begin an operation; operations of one caller are carried out in the order they came."""

    def call_operation(
        self,
        operation: Operation[..., Any],
        arguments: inspect.BoundArguments,
        timeout_s: float | None,
    ) -> Any:
        """Carry out an operation and return its result; None means the operation's own deadline."""
        limit_s = operation.deadline_s if timeout_s is None else timeout_s
        future = self.submit_operation(operation, arguments)
        return wait_for(future, f"the operation {operation.name!r}", limit_s)


class Operation(Generic[P, R]):
    """A declared operation; see `operation`.

    Parameters
    ----------
    run : callable
        ``run(core, ...)`` does it, or ``run(workers, ...)`` if it runs in the background.
    deadline_s : float
        How long a caller waits unless told otherwise [s].
    checks : mapping of str to Check
        Of arguments by their names, made before anything is sent, beside those that the
        declared types say; see `argument_checks.declared_checks`.
    background : bool
        True if it is done beside the simulation's loop; `run` returns a future then.

    Attributes
    ----------
    name : str
    signature : inspect.Signature
        As a caller sees it.
    keywords : mapping of str to str
        Types of the keywords that its ``**changes`` take, as their TypedDict declares them.
    """

    def __init__(
        self,
        run: Callable[..., Any],
        deadline_s: float,
        checks: Mapping[str, Check],
        *,
        background: bool = False,
    ) -> None:
        function = getattr(run, "__func__", run)
        self.run: Callable[..., Any] = function
        self.name: str = function.__name__
        self.deadline_s = deadline_s
        self.background = background
        whole = inspect.signature(function)
        self.signature = whole.replace(parameters=list(whole.parameters.values())[1:])
        self.checks = MappingProxyType({**declared_checks(self.signature), **checks})
        self.__doc__ = function.__doc__
        self.__name__ = self.name
        self.keywords = _keywords_of(function)
        self.__signature__ = _with_keywords(self.signature, self.keywords)
        self._positional = frozenset(
            parameter.name
            for parameter in self.signature.parameters.values()
            if parameter.kind is inspect.Parameter.POSITIONAL_ONLY
        )
        unknown = set(checks) - set(self.signature.parameters)
        if unknown:
            raise TypeError(f"operation {self.name} has no argument {sorted(unknown)}")

    @overload
    def __get__(self, caller: None, owner: type) -> Operation[P, R]: ...
    @overload
    def __get__(self, caller: Caller, owner: type) -> BoundOperation[P, R]: ...
    def __get__(self, caller: Caller | None, owner: type) -> Any:
        return self if caller is None else BoundOperation(self, caller)

    def __call__(self, caller: Caller, /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Call it as an unbound method."""
        return BoundOperation(self, caller)(*args, **kwargs)

    def submit_to(self, caller: Caller, /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Begin it for a caller; the future has its result, or the error that it raised."""
        return caller.submit_operation(self, self.bind(caller, args, kwargs))

    @property
    def variable(self) -> str:
        """Name of the parameter ``**changes``; empty if there is none."""
        kind = inspect.Parameter.VAR_KEYWORD
        return next((p.name for p in self.signature.parameters.values() if p.kind is kind), "")

    def arguments(self, given: Mapping[str, Any]) -> tuple[tuple[Any, ...], dict[str, Any]]:
        """Return positional and named arguments for values by the names of the parameters.

        Parameters
        ----------
        given : mapping of str to object
            As a message has them: those of ``**changes`` are a mapping under that name.

        Raises
        ------
        UnknownName, InvalidRequest
            If there is no such parameter, one that is needed is missing, or one of the changes
            has the name of another parameter.
        """
        values, parameters = dict(given), self.signature.parameters
        for name in values:
            if name not in parameters:
                raise UnknownName(f"argument of {self.name}", name, parameters)
        for name, parameter in parameters.items():
            if (
                name not in values
                and name != self.variable
                and parameter.default is parameter.empty
            ):
                raise InvalidRequest(name, None, f"given to {self.name}")
        changes = values.pop(self.variable, None) or {}
        if not isinstance(changes, Mapping):
            raise InvalidRequest(self.variable, changes, "values by their names")
        clash = sorted(set(changes) & set(parameters))
        if clash:
            raise InvalidRequest(self.variable, clash, "names of what can be changed")
        args = tuple(
            values.pop(name) for name in parameters if name in self._positional & set(values)
        )
        return args, {**values, **changes}

    def carry_out(self, target: OperationTarget, arguments: inspect.BoundArguments) -> Any:
        """Do it now, with arguments that were checked; return its result."""
        return self.run(target, *arguments.args, **arguments.kwargs)

    def bind(
        self, caller: Caller, args: tuple[Any, ...], kwargs: dict[str, Any]
    ) -> inspect.BoundArguments:
        """Match arguments to parameters and check those that are given.

        An `agent` that is not named is the caller's own.

        Raises
        ------
        TypeError
            If they do not fit the signature, as Python's own functions do.
        InvalidRequest
            If a value cannot be accepted.
        """
        for name in self._positional & kwargs.keys():
            raise InvalidRequest(f"argument {name!r}", kwargs[name], "given by its position")
        arguments = self.signature.bind(*args, **kwargs)
        for name, check in self.checks.items():
            if name in arguments.arguments:
                arguments.arguments[name] = check(name, arguments.arguments[name])
        if "agent" in self.signature.parameters and arguments.arguments.get("agent") is None:
            arguments.arguments["agent"] = caller.own_agent
        return arguments


class BoundOperation(Generic[P, R]):
    """An operation of one caller: call it, or `submit` it."""

    def __init__(
        self, operation: Operation[P, R], caller: Caller, timeout_s: float | None = None
    ) -> None:
        self._operation = operation
        self._caller = caller
        self._timeout_s = timeout_s
        self.__doc__ = operation.__doc__
        self.__name__ = operation.name
        self.__signature__ = operation.__signature__

    def __call__(self, /, *args: P.args, **kwargs: P.kwargs) -> R:
        """Do it and return its result, within its deadline."""
        arguments = self._operation.bind(self._caller, args, kwargs)
        result: R = self._caller.call_operation(self._operation, arguments, self._timeout_s)
        return result

    def submit(self, /, *args: P.args, **kwargs: P.kwargs) -> Future[R]:
        """Begin it; the future has its result, or the error that it raised."""
        return self._operation.submit_to(self._caller, *args, **kwargs)

    def within(self, timeout_s: float) -> BoundOperation[P, R]:
        """Return the same operation with another deadline [s]."""
        return BoundOperation(self._operation, self._caller, timeout_s)

    def __repr__(self) -> str:
        return f"<operation {self._operation.name}{self._operation.signature}>"


def _keywords_of(function: Callable[..., Any]) -> Mapping[str, str]:
    """Return what a function's ``**keywords: Unpack[...]`` may be, by their names."""
    for parameter in inspect.signature(function).parameters.values():
        if parameter.kind is inspect.Parameter.VAR_KEYWORD:
            declared = inspect.get_annotations(function, eval_str=True)[parameter.name]
            origin: Any = get_origin(declared)
            if origin is Unpack:
                (keys,) = get_args(declared)
                types = keys.__annotations__.items()
                return MappingProxyType({k: getattr(t, "__forward_arg__", t) for k, t in types})
    return MappingProxyType({})


def _with_keywords(signature: inspect.Signature, keywords: Mapping[str, str]) -> inspect.Signature:
    """Return a signature that shows each keyword instead of all of them as one."""
    if not keywords:
        return signature
    named = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=..., annotation=type_)
        for name, type_ in keywords.items()
    ]
    return signature.replace(parameters=[*list(signature.parameters.values())[:-1], *named])


def operation(
    deadline_s: float = 30.0, **checks: Check
) -> Callable[[Callable[Concatenate[OperationTarget, P], R]], Operation[P, R]]:
    """Declare an operation: decorate a static method whose first argument is what it works on.

    The method either does all of it or raises and leaves everything as it was.

    Parameters
    ----------
    deadline_s : float
        How long a caller waits unless told otherwise [s].
    **checks : Check
        Of arguments, by their names.
    """

    def declare(run: Callable[Concatenate[OperationTarget, P], R]) -> Operation[P, R]:
        return Operation(run, deadline_s, checks)

    return declare


def background_operation(
    deadline_s: float, **checks: Check
) -> Callable[[Callable[Concatenate[ModelWorkers, P], Future[R]]], Operation[P, R]]:
    """Declare an operation that runs beside the simulation's loop and needs no world."""

    def declare(run: Callable[Concatenate[ModelWorkers, P], Future[R]]) -> Operation[P, R]:
        return Operation(run, deadline_s, checks, background=True)

    return declare
