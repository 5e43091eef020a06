"""Fields that differ between versions of `simulation_interfaces`: 1.5 (Jazzy) and 2.1 (Rolling)."""

from __future__ import annotations

from typing import Any

__all__ = ["is_set", "resource_of", "set_resource_uri"]


def resource_of(request: Any, field: str) -> tuple[str, str]:
    """Return the URI and the text of a request's resource, which 1.5 has among its own fields."""
    whole = getattr(request, field, request)
    return whole.uri, whole.resource_string


def set_resource_uri(message: Any, field: str, uri: str) -> None:
    """Set the URI of a message's resource, which 1.5 has among its own fields."""
    getattr(message, field, message).uri = uri


def is_set(request: Any, part: str) -> bool:
    """Return whether a part of a state is to be set; 1.5 has no flags and sets everything."""
    return bool(getattr(request, f"set_{part}", True))
