# SPDX-License-Identifier: BSD-3-Clause
"""Pictures by Matplotlib, which only the functions import."""
from __future__ import annotations

import io
import warnings
from typing import Any, Callable, List, Sequence, Tuple

import numpy as np

from ..._disk import write_whole

PIXELS = 150  # pixels per inch
CJK = ("Noto Sans CJK JP", "WenQuanYi Micro Hei")  # fonts for letters that Matplotlib's own font lacks


def gradient() -> List[str]:
    """Colours of nine probabilities from 0 to 1."""
    from matplotlib import colormaps, colors
    return [colors.to_hex(colormaps["viridis"](share)) for share in np.linspace(0.0, 1.0, 9)]


def draw(file, size: Tuple[float, float], work: Callable[[Any], Any], columns: int = 1) -> None:
    """Writes a picture to a file; see `drawn`."""
    write_whole(file, drawn(size, work, columns))


def drawn(size: Tuple[float, float], work: Callable[[Any], Any], columns: int = 1) -> bytes:
    """A picture (PNG). @param size inches @param work function that draws into the given axes @param columns axes side
    by side"""
    from matplotlib import font_manager, rc_context
    from matplotlib.figure import Figure
    content = io.BytesIO()
    known = {font.name for font in font_manager.fontManager.ttflist}
    fonts = ["DejaVu Sans", *(name for name in CJK if name in known)]
    style = {"axes.labelsize": 9, "xtick.labelsize": 9, "ytick.labelsize": 9, "legend.fontsize": 8, "grid.alpha": 0.4,
             "font.family": fonts, "text.parse_math": False}  # names keep their $
    with rc_context(style), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from")  # boxes replace letters that no font has
        figure = Figure(figsize=size, dpi=PIXELS, layout="constrained")
        work(figure.subplots(1, columns))
        figure.draw_without_rendering()  # the layout needs two passes to fix axes of equal scales
        figure.savefig(content, format="png")
    return content.getvalue()


def finish(axes, **settings: Any) -> None:
    """Sets limits and labels of axes, a grid, and a legend if something has a label."""
    axes.set(**settings)
    axes.grid()
    if axes.get_legend_handles_labels()[0]:
        axes.legend()


def map_size(extent: Sequence[float], width: float, beside: float = 0.0, above: float = 0.0) -> Tuple[float, float]:
    """Size in inches of a picture filled by a map with labels. @param width width of the map @param beside, above
    inches for other contents"""
    x0, x1, y0, y1 = extent
    return width + beside, 0.5 + (width - 0.7) * float(np.clip((y1 - y0) / max(x1 - x0, 1e-9), 0.25, 3.0)) + above
