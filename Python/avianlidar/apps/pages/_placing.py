# SPDX-License-Identifier: BSD-3-Clause
"""Labels of a picture, placed so that no label covers another label or leaves the axes."""
from __future__ import annotations

from typing import Any, List, NamedTuple, Sequence

import numpy as np

AWAY = (4.0, 12.0, 22.0, 34.0, 50.0, 70.0, 95.0, 125.0, 160.0)  # distances of a label from its place, points
DIRECTIONS = 16
GAP = 2.0  # least gap between labels, points
LINE = 12.0  # distance from which a line leads from the label to the place, points


class Label(NamedTuple):
    """Words beside a place (m east and north), with the direction (m) in which the label moves first, and a style."""

    words: str
    place: Any
    first: Any = (1.0, 1.0)
    style: Any = {}


def place_labels(axes, labels: Sequence[Label], keep_free: Any = (), lines: Any = ()) -> List[str]:
    """Writes labels beside their places: each at the nearest free position, in the given order. Limits and size of the
    axes must not change later. @param keep_free places of marks, m, that labels do not cover @param lines places on
    lines, m, that labels cover only if there is no other room @return words of the
    labels without a free position, which are not written"""
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox
    for _ in range(2):  # the layout needs two passes to fix axes of equal scales
        axes.figure.draw_without_rendering()
    scale = axes.figure.dpi / 72.0  # pixels in a point
    inside = axes.get_window_extent()
    marks, drawn = (axes.transData.transform(np.reshape(of, (-1, 2))) for of in (keep_free, lines))
    taken = [Bbox.from_bounds(*(mark - 6.0 * scale), 12.0 * scale, 12.0 * scale) for mark in marks]
    if axes.get_legend():
        taken.append(axes.get_legend().get_window_extent())
    anchors = axes.transData.transform([label.place for label in labels]) if labels else np.empty((0, 2))
    left_out = []
    for label, anchor in zip(labels, anchors):
        text = axes.annotate(
            label.words, label.place, (0.0, 0.0), textcoords="offset points", ha="center", va="center", zorder=6,
            bbox={"facecolor": "white", "alpha": 0.8, "pad": 1, "linewidth": 0},
            arrowprops={"arrowstyle": "-", "linewidth": 0.6, "color": "0.3", "shrinkA": 0, "shrinkB": 0},
            **{"fontsize": 9, "color": "0.1", **label.style})
        text.set_in_layout(False)
        box = Text.get_window_extent(text)  # without the line
        half = 0.5 * np.array([box.width, box.height]) + 1.0 * scale
        start = np.arctan2(*np.subtract(axes.transData.transform(np.add(label.place, label.first)), anchor)[::-1])
        turns = sorted(np.arange(DIRECTIONS) * 2.0 * np.pi / DIRECTIONS, key=lambda turn: min(turn, 2.0 * np.pi - turn))
        places = [(away, start + turn) for away in AWAY for turn in turns]

        def offset(away: float, angle: float) -> np.ndarray:
            """The middle of the label from its place, pixels. The side of the label keeps the distance."""
            way = np.array([np.cos(angle), np.sin(angle)])
            return way * away * scale + np.clip(way * 1.5, -1.0, 1.0) * half

        def fits(away: float, angle: float, nearest: bool, clear: bool) -> bool:
            middle = anchor + offset(away, angle)
            here = Bbox([middle - half - GAP * scale, middle + half + GAP * scale])
            apart = np.linalg.norm(anchors - middle, axis=1)
            return bool((middle - half >= inside.min).all() and (middle + half <= inside.max).all()
                        and not here.count_overlaps(taken)
                        and not (clear and (np.abs(drawn - middle) <= half).all(axis=1).any())
                        and (not nearest or np.hypot(*(anchor - middle)) <= apart.min() + 1e-6))
        # If possible, the label covers no line, and no place of another label is nearer.
        found = next((one for clear in (True, False) for nearest in (True, False) for one in places
                      if fits(*one, nearest, clear)), None)
        if found is None:
            text.remove()
            left_out.append(label.words)
            continue
        off = offset(*found)
        text.set_position(off / scale)
        if found[0] < LINE:
            text.arrow_patch.set_visible(False)
        taken.append(Bbox([anchor + off - half, anchor + off + half]))
    return left_out

