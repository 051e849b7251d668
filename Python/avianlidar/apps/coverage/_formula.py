# SPDX-License-Identifier: BSD-3-Clause
"""Formulas that a user writes as text: numbers, names, + - * / ** and some functions, and no other part of Python."""
from __future__ import annotations

import ast
import math
from typing import Any, Callable, Dict, Iterable, Mapping

LONGEST = 1000  # characters
FUNCTIONS: Dict[str, Callable[..., float]] = {
    "sqrt": math.sqrt, "exp": math.exp, "log": math.log, "log10": math.log10, "abs": abs, "min": min, "max": max,
    "ceil": lambda x: float(math.ceil(x)), "floor": lambda x: float(math.floor(x))}
OPERATORS = (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Pow, ast.UAdd, ast.USub)
Values = Mapping[str, float]


class Formula:
    """A formula of named numbers.

    >>> Formula("2 * x ** 2 + min(x, 1)", ["x"])({"x": 3.0})
    19.0
    >>> Formula("2 * y", ["x"])
    Traceback (most recent call last):
    ...
    ValueError: 2 * y: 'y' is not known, expected one of the numbers x
    """

    def __init__(self, text: str, names: Iterable[str]):
        """Checks the text; ValueError names the wrong part. @param names names of the numbers in the text"""
        self.text, self.names = text, list(names)
        if len(text) > LONGEST:
            raise ValueError(f"{text[:40]}...: has {len(text)} characters, expected a formula of at most {LONGEST}")
        try:
            tree = ast.parse(text.strip(), mode="eval")
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            raise ValueError(f"{text}: is not a formula "
                             f"({getattr(error, 'msg', error) or 'it is nested too deeply'})") from None
        called = [node.func for node in ast.walk(tree) if isinstance(node, ast.Call)]
        for node in ast.walk(tree):
            if not self._may_stand(node):
                raise ValueError(f"{text}: {ast.unparse(node)[:40]!r} may not stand in a formula, expected numbers, "
                                 "names, + - * / ** ( ) and functions")
            if isinstance(node, ast.Name) and node.id not in (FUNCTIONS if node in called else self.names):
                expected = (f"a function here, expected one of {', '.join(FUNCTIONS)}" if node in called else
                            f"known, expected one of the numbers {', '.join(self.names)}")
                raise ValueError(f"{text}: {node.id!r} is not {expected}")
            if isinstance(node, ast.Constant):
                try:
                    node.value = float(node.value)  # huge powers of floats overflow at once
                except OverflowError:
                    raise ValueError(f"{text[:40]}...: has a number of more than 308 digits") from None
        try:
            self._code = compile(tree, "formula", "eval")
        except RecursionError:
            raise ValueError(f"{text[:40]}...: is not a formula (it is nested too deeply)") from None

    @staticmethod
    def _may_stand(node: ast.AST) -> bool:
        if isinstance(node, ast.Constant):
            return type(node.value) in (int, float)
        if isinstance(node, (ast.BinOp, ast.UnaryOp)):
            return isinstance(node.op, OPERATORS)
        if isinstance(node, ast.Call):
            return isinstance(node.func, ast.Name) and not node.keywords
        return isinstance(node, (ast.Expression, ast.Name, ast.expr_context, *OPERATORS))

    def __call__(self, values: Values) -> float:
        """The value of the formula. ValueError gives the numbers for which the value is not finite."""
        problem: Any = "it is not finite"
        try:
            result = eval(self._code, {"__builtins__": {}, **FUNCTIONS}, {**values})
            if math.isfinite(result):
                return result
        except (ArithmeticError, ValueError, TypeError, RecursionError) as error:
            problem = error
        raise ValueError(f"{self.text}: cannot be calculated ({problem}) for "
                         + ", ".join(f"{name} {values[name]:g}" for name in self.names if name in values))
