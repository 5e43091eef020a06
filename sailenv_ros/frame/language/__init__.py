"""Truth in words: what stands in a frame and how, expressions for one object, questions, answers.

Data types and pure functions on a `Frame`. Every sentence comes with the numbers it follows from.
"""

from __future__ import annotations

from sailenv_ros.frame.language.balance import balanced
from sailenv_ros.frame.language.captions import Caption, caption
from sailenv_ros.frame.language.colour_words import COLOUR_WORDS
from sailenv_ros.frame.language.material_words import MATERIAL_WORDS
from sailenv_ros.frame.language.questions import QUESTION_KINDS, Question, questions
from sailenv_ros.frame.language.referring import Referring, referring_expressions
from sailenv_ros.frame.language.relation_laws import RELATIONS
from sailenv_ros.frame.language.scene_facts import Gap, Opening, SceneFacts
from sailenv_ros.frame.language.scene_graph import Relation, SceneGraph, scene_graph
from sailenv_ros.frame.language.seen_objects import SeenObject

__all__ = [
    "COLOUR_WORDS",
    "MATERIAL_WORDS",
    "QUESTION_KINDS",
    "RELATIONS",
    "Caption",
    "Gap",
    "Opening",
    "Question",
    "Referring",
    "Relation",
    "SceneFacts",
    "SceneGraph",
    "SeenObject",
    "balanced",
    "caption",
    "questions",
    "referring_expressions",
    "scene_graph",
]
