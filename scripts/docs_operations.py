"""Shows operations in the API reference as callers see them: without the core that they run on."""

from __future__ import annotations

import ast
from typing import Any

import griffe

_DECORATORS = ("operation", "background_operation")


class OperationSignatures(griffe.Extension):
    """Removes the first parameter of every function that `operation` decorates."""

    def on_function_instance(
        self, *, node: ast.AST | griffe.ObjectNode, func: griffe.Function, **kwargs: Any
    ) -> None:
        """Change a function that has just been read."""
        names = [decorator.callable_path.rpartition(".")[2] for decorator in func.decorators]
        if not set(names) & set(_DECORATORS):
            return
        func.parameters = griffe.Parameters(*list(func.parameters)[1:])
        func.decorators = []
        func.labels.discard("staticmethod")
