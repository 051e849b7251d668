# SPDX-License-Identifier: BSD-3-Clause
"""Formulas that a user writes as text: numbers, names, + - * / ** and some functions, and nothing else of Python."""
from __future__ import annotations

import ast
import math
import operator
from typing import Any, Callable, Dict, Iterable, Mapping

LONGEST = 1000  # characters
FUNCTIONS: Dict[str, Callable[..., float]] = {"sqrt": math.sqrt, "exp": math.exp, "log": math.log, "log10": math.log10, "abs": abs, "min": min,
                                              "max": max, "ceil": lambda x: float(math.ceil(x)), "floor": lambda x: float(math.floor(x))}
# math.pow, as ** gives complex numbers of negative ones. All numbers are floats: huge powers overflow at once.
BINARY: Dict[type, Callable[[float, float], float]] = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul,
                                                       ast.Div: operator.truediv, ast.Pow: math.pow}
UNARY: Dict[type, Callable[[float], float]] = {ast.UAdd: operator.pos, ast.USub: operator.neg}
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
        """ValueError says what is wrong with the text. @param names that may stand in it"""
        self.text, self.names = text, list(names)
        if len(text) > LONGEST:
            raise ValueError(f"{text[:40]}...: has {len(text)} characters, expected a formula of at most {LONGEST}")
        try:
            body = ast.parse(text.strip(), mode="eval").body
        except (SyntaxError, ValueError, MemoryError, RecursionError) as error:
            raise ValueError(f"{text}: is no formula ({getattr(error, 'msg', error) or 'it is nested too deeply'})") from None
        try:
            self._work = self._compiled(body)
        except RecursionError:
            raise ValueError(f"{text[:40]}...: is no formula (it is nested too deeply)") from None

    def _compiled(self, node: ast.AST) -> Callable[[Values], float]:
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            number = self._float(node.value)
            return lambda _: number
        if isinstance(node, ast.Name):
            name = node.id
            if name not in self.names:
                raise ValueError(f"{self.text}: {name!r} is not known, expected one of the numbers {', '.join(self.names)}")
            return lambda values: float(values[name])
        if isinstance(node, ast.BinOp) and type(node.op) in BINARY:
            work, left, right = BINARY[type(node.op)], self._compiled(node.left), self._compiled(node.right)
            return lambda values: work(left(values), right(values))
        if isinstance(node, ast.UnaryOp) and type(node.op) in UNARY:
            one, operand = UNARY[type(node.op)], self._compiled(node.operand)
            return lambda values: one(operand(values))
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            if node.func.id not in FUNCTIONS:
                raise ValueError(f"{self.text}: {node.func.id!r} is no function here, expected one of {', '.join(FUNCTIONS)}")
            function, arguments = FUNCTIONS[node.func.id], [self._compiled(argument) for argument in node.args]
            return lambda values: function(*(argument(values) for argument in arguments))
        raise ValueError(f"{self.text}: {ast.unparse(node)[:40]!r} may not stand in a formula, expected numbers, names, + - * / ** ( ) and functions")

    def _float(self, number: Any) -> float:
        try:
            return float(number)
        except OverflowError:
            raise ValueError(f"{self.text[:40]}...: has a number of more than 308 digits") from None

    def __call__(self, values: Values) -> float:
        """What it gives, a finite number. ValueError says for which values it gives none."""
        problem: Any = "it is not finite"
        try:
            result = self._work(values)
            if math.isfinite(result):
                return result
        except (ArithmeticError, ValueError, TypeError, RecursionError) as error:
            problem = error
        raise ValueError(f"{self.text}: cannot be calculated ({problem}) for " + ", ".join(f"{name} {values[name]:g}" for name in self.names if name in values))
