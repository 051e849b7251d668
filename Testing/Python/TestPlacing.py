# SPDX-License-Identifier: BSD-3-Clause
"""Labels of the map on a report's first page: none covers another or leaves the axes, and runways are named by their
ends."""
import itertools
import math
import types
import unittest

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Annotation, Text

from avianlidar import siting
from avianlidar.apps.coverage import _pictures
from avianlidar.apps.pages import _drawing
from avianlidar.apps.pages._placing import Label, place_labels


def runway(name, x, y, degrees, length=3000.0):
    """A runway by its middle and the direction from its start to its end, clockwise from north."""
    half = 0.5 * length * np.array([math.sin(math.radians(degrees)), math.cos(math.radians(degrees))])
    return siting.Runway(name, tuple((x, y) - half), tuple((x, y) + half), 45.0)


LAYOUTS = {
    "one": [runway("08/26", 0, 0, 80)],
    "two parallel": [runway("18L/36R", 0, 0, 180), runway("18R/36L", -365, 0, 180)],
    "close parallel": [runway("09L/27R", 0, 210, 90, 2000), runway("09R/27L", 0, 0, 90, 2000)],
    "crossing": [runway("05/23", 0, 0, 50), runway("14/32", 100, 200, 140)],
    "three": [runway("08L/26R", 0, 900, 80), runway("08R/26L", 300, -500, 80), runway("17/35", -900, 200, 170, 2000)],
}


def plan(runways, kinds):
    """Regions of some kinds, and a lidar at the first runway's end."""
    names = siting.region_names(runways)
    return types.SimpleNamespace(runways=runways, ends={name: [] for kind in kinds for name in names[kind]},
                                 name="Search905", extent=(-1, 1, -1, 1),
                                 sensor=types.SimpleNamespace(
                                     position=(runways[0].end[0] + 150.0, runways[0].end[1] + 200.0, 10.0)))


class Labels(unittest.TestCase):
    def written(self, extent, labels, marks=(), lines=()):
        """Labels on a map of an extent. @return axes, labels that are left out, and the boxes of the others in
        pixels"""
        figure = Figure(_drawing.map_size(extent, 5.9, 0.0, 0.5), dpi=_drawing.PIXELS, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        axes.set(xlim=extent[:2], ylim=extent[2:], aspect="equal", xlabel="m east", ylabel="m north")
        left_out = place_labels(axes, labels, marks, lines)
        figure.canvas.draw()  # as the picture is written
        found = [one for one in axes.texts if isinstance(one, Annotation)]
        return axes, left_out, {one.get_text(): Text.get_window_extent(one) for one in found}

    def test_covers_no_line_if_there_is_other_room(self):
        a = np.linspace(0.0, 2.0 * np.pi, 400)
        for radius in (150.0, 400.0, 900.0):
            ring = radius * np.column_stack([np.cos(a), np.sin(a)])
            axes, left_out, boxes = self.written(
                (-1000, 1000, -1000, 1000), [Label("a lidar", (0.0, 0.0)), Label("on the ring", ring[7])], [], ring)
            self.assertEqual(left_out, [])
            pixels = axes.transData.transform(ring)
            for words, box in boxes.items():
                self.assertFalse(((pixels > box.min) & (pixels < box.max)).all(axis=1).any(), (radius, words))

    def test_labels_neither_overlap_nor_leave_the_map(self):
        for (name, runways), kinds in itertools.product(LAYOUTS.items(),
                                                        (["strips"], ["approaches"], ["strips", "approaches"])):
            with self.subTest(name, kinds=kinds):
                wanted = plan(runways, kinds)
                extent = _pictures.answer_extent(wanted, 700.0)
                shares = dict.fromkeys(wanted.ends, "11.3 ± 0.3 %")
                place = wanted.sensor.position[:2]
                axes, left_out, boxes = self.written(extent, _pictures.labels_of(wanted, shares), [place])
                self.assertEqual(left_out, [])
                ends = {end for pair in siting.end_names(runways) for end in pair}
                self.assertEqual(set(boxes),
                                 {"Search905", *ends, *(f"{region}\n11.3 ± 0.3 %" for region in wanted.ends)})
                inside = axes.get_window_extent()
                mark = axes.transData.transform(place)
                for words, box in boxes.items():
                    self.assertTrue((box.min >= inside.min).all() and (box.max <= inside.max).all(), words)
                    self.assertFalse(box.contains(*mark), words)
                for (one, first), (other, second) in itertools.combinations(boxes.items(), 2):
                    self.assertFalse(first.overlaps(second), (one, other))
                for pair, one in zip(siting.end_names(runways), runways):  # each end is named where it is
                    for end, here, there in zip(pair, (one.start, one.end), (one.end, one.start)):
                        middle = axes.transData.inverted().transform(boxes[end].get_points().mean(axis=0))
                        self.assertLess(math.dist(middle, here), 0.5 * math.dist(middle, there), end)

    def test_the_map_has_the_runways_and_the_circle(self):
        for name, runways in LAYOUTS.items():
            wanted = plan(runways, [])
            wanted.ends = {siting.region_names(runways)["approaches"][0]: []}
            x0, x1, y0, y1 = _pictures.answer_extent(wanted, 700.0)
            x, y, _ = wanted.sensor.position
            places = [*(end for one in runways for end in (one.start, one.end)), (x - 700, y), (x + 700, y),
                      (x, y - 700), (x, y + 700), *_pictures._near(wanted)[next(iter(wanted.ends))]]
            for at in places:
                self.assertTrue(x0 < at[0] < x1 and y0 < at[1] < y1, (name, at))

    def test_labels_without_room_are_named(self):
        crowd = [Label(f"number {number}", (0.0, 0.0)) for number in range(400)]
        _, left_out, boxes = self.written((-100.0, 100.0, -100.0, 100.0), crowd)
        self.assertEqual(sorted([*boxes, *left_out]), sorted(label.words for label in crowd))
        self.assertGreater(min(len(boxes), len(left_out)), 20)
