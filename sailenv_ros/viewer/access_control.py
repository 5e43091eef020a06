"""Access control of the page and its socket: addresses, origins and the token.

Headers of a request in, a reason to refuse out. Knows no socket. Pages of other sites can make a
browser send requests here; what gives them away is the Origin, and the Host after DNS rebinding.
"""

from __future__ import annotations

import hmac
import ipaddress
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from urllib.parse import urlsplit

__all__ = ["SECURITY_HEADERS", "AccessControl", "is_loopback"]

SECURITY_HEADERS: Mapping[str, str] = MappingProxyType(
    {
        "Content-Security-Policy": (
            "default-src 'none'; script-src 'self'; style-src 'self'; "
            "img-src 'self' blob: data:; connect-src 'self'; base-uri 'none'; "
            "form-action 'none'; frame-ancestors 'none'"
        ),
        "X-Content-Type-Options": "nosniff",
        # The token stands in the address.
        "Referrer-Policy": "no-referrer",
        "Cross-Origin-Opener-Policy": "same-origin",
        "Cross-Origin-Resource-Policy": "same-origin",
        "Cache-Control": "no-store",
    }
)
"""Sent with everything."""


def is_loopback(host: str) -> bool:
    """Return whether an address, or the name of one, can be reached from this machine alone."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


@dataclass(frozen=True, slots=True, kw_only=True)
class AccessControl:
    """The rules of one window.

    Attributes
    ----------
    loopback : bool
        True if only this machine can reach it: then names of this machine alone are accepted as
        Host. Any port is, for the page may come through a tunnel.
    token : str
        What the address must bring along as ``token``; empty for nothing.
    """

    loopback: bool
    token: str = ""

    def refusal_of_request(self, headers: Mapping[str, str]) -> str:
        """Return why a request is refused; empty if it is not."""
        host = headers.get("Host", "")
        if self.loopback and not is_loopback(_hostname(host)):
            return f"the host {host[:80]!r} is not this machine's: use localhost or 127.0.0.1"
        return ""

    def refusal_of_socket(self, headers: Mapping[str, str], token: str) -> str:
        """Return why a socket is refused; empty if it is not."""
        origin, host = headers.get("Origin", ""), headers.get("Host", "")
        if not _is_page_of(host, origin):
            return f"the origin {origin[:80]!r} is another than the page's own, {host[:80]!r}"
        return self.refusal_of_token(token)

    def refusal_of_token(self, token: str) -> str:
        """Return why a token is refused; empty if it is not."""
        if self.token and not hmac.compare_digest(token.encode(), self.token.encode()):
            return "the address needs the token that the simulator printed when it started"
        return ""


def _is_page_of(host: str, origin: str) -> bool:
    try:
        parts = urlsplit(origin)
    except ValueError:  # brackets that are not those of an address
        return False
    return parts.scheme in ("http", "https") and parts.netloc == host


def _hostname(host: str) -> str:
    try:
        return urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return ""
