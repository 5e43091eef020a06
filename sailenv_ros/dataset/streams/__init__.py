"""The streams of SAILab's published work, made from scenes of our own: scripts and bags."""

from sailenv_ros.dataset.streams.making import StreamJob, make_stream, stream_pairs
from sailenv_ros.dataset.streams.table import STREAMS, StreamKind, stream_named

__all__ = ["STREAMS", "StreamJob", "StreamKind", "make_stream", "stream_named", "stream_pairs"]
