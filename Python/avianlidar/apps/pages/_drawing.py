# SPDX-License-Identifier: BSD-3-Clause
"""Pictures by Matplotlib, which only the functions import."""
from __future__ import annotations

import base64
import io
import pathlib
import warnings
from typing import Any, Callable, Dict, Sequence, Tuple

import numpy as np

from ..._disk import write_whole
from ..._look import SPECIES
from ..._plot import fonts

PIXELS = 150  # pixels per inch
WIDTH = 7.0  # width of the text on A4, inches
HEIGHT = 10.6  # height of the text on A4, inches
SMALLEST = 8  # size of letters, points


def require() -> None:
    """Raises an error without Matplotlib, before the work."""
    import matplotlib  # noqa: F401


def picture(file, size: Tuple[float, float], what: str, caption: str, work: Callable[[Any], Any],
            rows: int = 1, columns: int = 1) -> Dict[str, Any]:
    """Draws a picture of a page. @param what kind of the picture, for readers who do not see it @param size, rows,
    columns as for `drawn`"""
    draw(file, size, work, rows, columns)
    return shown(file, size[0], what, caption)


def shown(file, width: float, what: str, caption: str) -> Dict[str, Any]:
    """A picture (PNG) of a page, at its printed width in inches."""
    source = "data:image/png;base64," + base64.b64encode(pathlib.Path(file).read_bytes()).decode()
    return {"source": source, "alt": f"{what}. {caption}", "caption": caption, "width": width}


def series(axes) -> None:
    """Gives curves colours and markers that a grey printer can tell apart."""
    from cycler import cycler
    axes.set_prop_cycle(cycler(color=SPECIES) + cycler(marker="osD^vPX*"))


def draw(file, size: Tuple[float, float], work: Callable[[Any], Any], rows: int = 1, columns: int = 1) -> None:
    """Writes a picture to a file; see `drawn`."""
    write_whole(file, drawn(size, work, rows, columns))


def drawn(size: Tuple[float, float], work: Callable[[Any], Any], rows: int = 1, columns: int = 1) -> bytes:
    """A picture (PNG). @param size inches on paper @param work function that draws into the given axes; with several
    rows or columns, into a list of axes"""
    from cycler import cycler
    from matplotlib import rc_context
    from matplotlib.figure import Figure
    content = io.BytesIO()
    style = {"font.size": SMALLEST, **{f"{part}.labelsize": SMALLEST for part in ("axes", "xtick", "ytick")},
             "axes.titlesize": 9, "legend.fontsize": SMALLEST, "grid.alpha": 0.4, "lines.markersize": 4,
             "axes.prop_cycle": cycler(color=SPECIES), "font.family": fonts(),
             "text.parse_math": False}  # names keep their $
    with rc_context(style), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing from")  # boxes replace letters that no font has
        figure = Figure(figsize=size, dpi=PIXELS, layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False).ravel().tolist()
        work(axes if len(axes) > 1 else axes[0])
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
