"""Commands about data sets: one is captured of what an agent sees, or ended. Part of `commands`."""

from __future__ import annotations

from sailenv_ros.viewer.command_context import CommandContext, CommandTable
from sailenv_ros.viewer.messages import CapturedDataSet
from sailenv_ros.viewer.served_commands import served

__all__ = ["CAPTURE_COMMANDS"]

CAPTURE_COMMANDS = CommandTable()


@CAPTURE_COMMANDS.changes
@served
async def capture_data_set(
    context: CommandContext, format_name: str, agent: str, frames: int, rate_hz: float
) -> CapturedDataSet:
    """Capture a data set of what an agent sees from now on; tell where it can be downloaded."""
    return await context.captures.capture(format_name, agent, frames, rate_hz)


@CAPTURE_COMMANDS.changes
@served
async def stop_capture(context: CommandContext) -> None:
    """End the capture of any page, with what was seen until now."""
    context.captures.stop()
