"""The web viewer of sim_node: what keys do in the browser is what ROS tells."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser

from sailenv_msgs.srv import GetPose
from tests.support.browser import OpenPage, chromium
from tests.support.ports import free_port
from tests.support.ros_probe import Probe
from tests.support.sim_node_process import NodeProcess

pytestmark = [pytest.mark.ros, pytest.mark.slow]

NAMESPACE = "/window"


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """The browser of this module's tests."""
    with chromium() as browser:
        yield browser


def test_keys_in_the_browser_move_what_ros_agents_see_from(browser: Browser) -> None:
    """The log says where the page is; Tab and W there move the agent that follows the mover."""
    port = free_port()
    small = {"agent__width": 64, "agent__height": 48}
    with NodeProcess(NAMESPACE, viewer__port=port, **small) as node, Probe(NAMESPACE) as probe:
        url = f"http://127.0.0.1:{port}/"
        assert url in node.log
        opened = OpenPage(browser, url)
        opened.wait_for_frames(1)
        opened.until(lambda: opened.data("controller"), "the scene to be told")
        if opened.data("controller") == "waypoint":
            opened.page.keyboard.press("Tab")
        opened.until(lambda: opened.data("controller") == "rigidbody", "the keys to drive")

        def height_m() -> float:
            return float(probe.done(GetPose, "agent/get_pose").pose.pose.position.z)

        before = height_m()
        opened.page.keyboard.down("e")
        opened.until(lambda: height_m() > before + 0.2, "the agent to rise")
        opened.page.keyboard.up("e")
        opened.close()
        node.close()
        assert node.status() == 0
        assert "Traceback" not in node.log
