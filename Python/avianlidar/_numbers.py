# SPDX-License-Identifier: BSD-3-Clause
"""Numbers in sentences and tables."""
from typing import SupportsFloat


def figures(value: SupportsFloat, digits: int = 6) -> str:
    """A number with up to `digits` significant digits. Numbers from 1e-6 to 1e15 have no exponent: 100, not 1e+02."""
    text = f"{float(value):.{digits}g}"
    if "e" not in text or not 1e-6 <= abs(float(text)) < 1e15:
        return text
    return f"{float(text):.0f}" if abs(float(text)) >= 1.0 else f"{float(text):.{5 + digits}f}".rstrip("0")
