"""Errors in the responses of services: a code for the type, a sentence for people."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from sailenv_msgs.msg import ErrorCode
from sailenv_ros.errors import (
    AddressInUse,
    AssetError,
    DeadlineExceeded,
    InternalFault,
    InvalidEntry,
    InvalidRequest,
    InvalidState,
    NameTaken,
    PhysicsError,
    RenderError,
    SailenvError,
    SceneError,
    SimulationClosed,
    UnknownName,
)

__all__ = ["ERROR_TYPES", "error_from_response", "error_to_response"]

ERROR_TYPES: Mapping[int, type[SailenvError]] = MappingProxyType(
    {
        ErrorCode.INTERNAL_FAULT: InternalFault,
        ErrorCode.UNKNOWN_NAME: UnknownName,
        ErrorCode.NAME_TAKEN: NameTaken,
        ErrorCode.INVALID_ENTRY: InvalidEntry,
        ErrorCode.INVALID_REQUEST: InvalidRequest,
        ErrorCode.INVALID_STATE: InvalidState,
        ErrorCode.DEADLINE_EXCEEDED: DeadlineExceeded,
        ErrorCode.ADDRESS_IN_USE: AddressInUse,
        ErrorCode.SIMULATION_CLOSED: SimulationClosed,
        ErrorCode.SCENE_ERROR: SceneError,
        ErrorCode.ASSET_ERROR: AssetError,
        ErrorCode.PHYSICS_ERROR: PhysicsError,
        ErrorCode.RENDER_ERROR: RenderError,
        ErrorCode.OTHER: SailenvError,
    }
)
"""Type of each code's error, a subclass before its base."""


def error_to_response(error: SailenvError, response: Any) -> None:
    """Say in a service's response what went wrong; nothing else of it is filled then."""
    response.success = False
    response.code = next(
        code for code, error_type in ERROR_TYPES.items() if isinstance(error, error_type)
    )
    # Some errors list several faults, each on a line of its own.
    response.message = "; ".join(line.strip() for line in str(error).splitlines() if line.strip())


def error_from_response(response: Any) -> SailenvError:
    """Return the error that a service's response tells, of the simulator's type and sentence."""
    error_type = ERROR_TYPES.get(response.code, SailenvError)
    return error_type.from_sentence(response.message)
