"""Passes log records of the ROS-free part, made with `logging`, to a ROS node's logger."""

from __future__ import annotations

import logging

from rclpy.impl.implementation_singleton import rclpy_implementation as rcutils
from rclpy.impl.logging_severity import LoggingSeverity
from rclpy.impl.rcutils_logger import RcutilsLogger

__all__ = ["LogBridge"]

_PACKAGE = "sailenv_ros"

_SEVERITIES = (
    (logging.CRITICAL, LoggingSeverity.FATAL),
    (logging.ERROR, LoggingSeverity.ERROR),
    (logging.WARNING, LoggingSeverity.WARN),
    (logging.NOTSET, LoggingSeverity.INFO),
)


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
        """Log one record at the severity that it has, as from where it was made.

        Not by the logger's own methods: these look for their caller among the sources of all
        modules, which takes 0.1 s at the first line.
        """
        severity = next(own for least, own in _SEVERITIES if record.levelno >= least)
        if self._logger.is_enabled_for(severity):
            rcutils.rclpy_logging_rcutils_log(
                severity, self._logger.name, self.format(record),
                record.funcName, record.pathname, record.lineno,
            )  # fmt: skip

    def close(self) -> None:
        """Stop passing records on."""
        self._source.removeHandler(self)
        self._source.setLevel(self._level_before)
        super().close()
