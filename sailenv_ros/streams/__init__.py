"""Streams without an end: any frame by its number, in a world that changes slowly and says how.

>>> import sailenv_ros.streams as streams
>>> stream = streams.open("home", seed=3)  # doctest: +SKIP
>>> stream[900_000].drift["daylight"].values  # doctest: +SKIP
"""

from sailenv_ros.streams.course import Course, courses, load_course
from sailenv_ros.streams.labels import PixelLabel, pixel_labels
from sailenv_ros.streams.online import (
    Checkpoint,
    LabelledPixels,
    Learner,
    OnlineProtocol,
    Score,
    evaluate,
)
from sailenv_ros.streams.prequential import Prequential
from sailenv_ros.streams.state import DriftRecord
from sailenv_ros.streams.stream import VIEWS, Stream, StreamFrame, open

__all__ = [
    "VIEWS",
    "Checkpoint",
    "Course",
    "DriftRecord",
    "LabelledPixels",
    "Learner",
    "OnlineProtocol",
    "PixelLabel",
    "Prequential",
    "Score",
    "Stream",
    "StreamFrame",
    "courses",
    "evaluate",
    "load_course",
    "open",
    "pixel_labels",
]
