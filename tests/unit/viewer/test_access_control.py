"""Who may see the page and open its socket."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sailenv_ros.viewer.access_control import SECURITY_HEADERS, AccessControl, is_loopback

HERE = AccessControl(loopback=True)
ELSEWHERE = AccessControl(loopback=False, token="abc123")


@pytest.mark.parametrize(
    "host", ["localhost:8090", "127.0.0.1:8090", "[::1]:8090", "127.0.0.1", "localhost:9000"]
)
def test_names_of_this_machine_are_accepted_on_any_port(host: str) -> None:
    """The page may come through a tunnel, from another port."""
    assert HERE.refusal_of_request({"Host": host}) == ""


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8090", "127.0.0.1.evil.example", "", "[::1", "10.0.0.2"]
)
def test_another_host_is_refused_on_loopback(host: str) -> None:
    """A name that was rebound to this machine's address gives itself away."""
    assert "not this machine's" in HERE.refusal_of_request({"Host": host})


def test_a_socket_of_another_site_is_refused() -> None:
    """Only the page that came from the same host and port may open a socket."""
    host = {"Host": "localhost:8090"}
    assert HERE.refusal_of_socket({**host, "Origin": "http://localhost:8090"}, "") == ""
    for origin in (
        "http://evil.example",
        "http://localhost:3000",
        "null",
        "file://",
        "",
        "http://[",
    ):
        assert "origin" in HERE.refusal_of_socket({**host, "Origin": origin}, "")
    assert "origin" in HERE.refusal_of_socket(host, "")


@given(st.text())
def test_no_other_token_opens_the_page_from_elsewhere(token: str) -> None:
    """Whatever is tried, only the token that was printed is accepted."""
    assert (ELSEWHERE.refusal_of_token(token) == "") == (token == "abc123")


def test_which_addresses_are_of_this_machine_alone() -> None:
    """All of 127/8 and ::1; not what listens on the network."""
    assert all(map(is_loopback, ("127.0.0.1", "127.8.8.8", "::1", "localhost")))
    assert not any(map(is_loopback, ("0.0.0.0", "::", "192.168.1.5", "example.com")))


def test_scripts_come_from_here_alone() -> None:
    """The policy lets the page load and reach nothing outside, and nobody frame it."""
    policy = SECURITY_HEADERS["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert "http" not in policy
