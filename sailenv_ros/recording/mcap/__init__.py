"""MCAP files: chunks, index, writing, recovery. Knows no frame, no bag and no ROS.

The format is that of https://mcap.dev/spec.
"""

from typing import Literal

__all__ = ["Compression"]

Compression = Literal["zstd", "lz4", "none"]
"""Compression of chunks."""
