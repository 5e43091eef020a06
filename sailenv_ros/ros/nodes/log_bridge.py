"""Passes log records of the ROS-free part, made with `logging`, to a ROS node's logger."""

from __future__ import annotations

import logging

from rclpy.impl.rcutils_logger import RcutilsLogger

__all__ = ["LogBridge"]

_PACKAGE = "sailenv_ros"


class LogBridge(logging.Handler):
    """Passes records of this package on; attached while it is open.

    Parameters
    ----------
    logger : RcutilsLogger
        A node's.
    """

    def __init__(self, logger: RcutilsLogger) -> None:
        super().__init__(logging.INFO)
        self.setFormatter(logging.Formatter("%(message)s"))
        self._logger = logger
        self._source = logging.getLogger(_PACKAGE)
        self._level_before = self._source.level
        if self._source.getEffectiveLevel() > logging.INFO:
            self._source.setLevel(logging.INFO)
        self._source.addHandler(self)

    def emit(self, record: logging.LogRecord) -> None:
        """Log one record at the severity that it has."""
        text = self.format(record)
        # rclpy knows a call by its place in the source and wants one severity for each place.
        if record.levelno >= logging.ERROR:
            self._logger.error(text)
        elif record.levelno >= logging.WARNING:
            self._logger.warning(text)
        else:
            self._logger.info(text)

    def close(self) -> None:
        """Stop passing records on."""
        self._source.removeHandler(self)
        self._source.setLevel(self._level_before)
        super().close()
