# SPDX-License-Identifier: BSD-3-Clause
"""Documentation/reference/arrays.md is the table of vtkAvianLidarNames.h and has every array of the echo filter's
outputs with its unit; what Documentation/reference/glossary.md names exists."""
import os
import pathlib
import re
import sys
import unittest

from vtkmodules.vtkCommonCore import vtkDataArray

import avianlidar as al
from avianlidar import vtkAvianLidar as wrapped
from avianlidar._paraview import Advisor
from avianlidar._scene import COEFFICIENTS
from helpertools import WALL

SOURCE = pathlib.Path(os.environ["AVIANLIDAR_SOURCE_DIR"])
sys.path.insert(0, str(SOURCE / "CMake"))
import arrays_page  # noqa: E402

ROWS = [[cell.strip() for cell in row.split("|")]
        for row in re.findall(r"^\| (?!paper|-)(.*) \|$",
                              (SOURCE / "Documentation" / "reference" / "glossary.md").read_text("utf-8"), re.M)]
UNITS = {name: unit for name, unit, _, _ in arrays_page.rows()}
# Names of the glossary; those that are not in the header have their units there.
GLOSSARY = {name for row in ROWS for name in re.findall(r"`([^`]+)`", row[2])}
NAMED = {name: unit.replace("–", "") for row in ROWS if len(row) > 3
         for names in [re.findall(r"`([^`]+)`", row[2])]
         for name, unit in zip(names, row[3].split(", ") * (1 if "," in row[3] else len(names)))}
CLASSES = [getattr(wrapped, name) for name in dir(wrapped) if name.startswith("vtkAvianLidar")]


def outputs():
    """Clouds of the three outputs, with either receiver."""
    bird = wrapped.vtkAvianLidarBirdSource()
    bird.Update()
    for name in ("Airport16", "Search905"):
        sensor = al.Sensor(name, azimuth_step=5)
        scan = al.Scan(al.Scene(WALL), sensor, movers=[al.mover(bird.GetOutput(), [(9, 9, 1)])])
        scan.update()
        for port in range(3):
            yield al.Cloud(scan.algorithm.GetOutputDataObject(port))


def of_advisor():
    """Names and units of the table that ParaView's button Advise makes, and its field data."""
    advisor = Advisor()
    scan = al.Scan(al.Scene(WALL), al.Sensor("Airport16", azimuth_step=5))
    for port in (0, 1):
        advisor.SetInputConnection(port, scan.algorithm.GetInputConnection(port, 0))
    advisor.SetSampleBeams(50)
    advisor.Update()
    table = advisor.GetOutputDataObject(0)
    asked = {"energy_error_most": 0.02, "range_error_most": 0.05, "missed_share_most": 0.01}
    for row in range(table.GetNumberOfRows()):  # a setting meets what is asked if its bounds do
        met = all(table.GetValueByName(row, name).ToDouble() <= most for name, most in asked.items())
        assert (table.GetValueByName(row, "verdict").ToInt() == 2) == met, row
    assert table.GetNumberOfRows() == 37
    arrays = [*map(table.GetColumn, range(table.GetNumberOfColumns())),
              *map(table.GetFieldData().GetAbstractArray, ("advised", "advice"))]
    return {array.GetName(): array.GetInformation().Get(vtkDataArray.UNITS_LABEL()) or "" for array in arrays}


class Glossary(unittest.TestCase):
    def test_names_and_units_of_lidarview(self):
        """Frozen from LidarView's source, IO/Lidar/Velodyne/vtkVelodynePacketInterpreter.cxx (Apache-2.0). Its other
        arrays have no counterpart."""
        wanted = {"azimuth": "0.01 deg", "vertical_angle": "deg", "distance_m": "m", "timestamp": "us",
                  "intensity": "1", "laser_id": ""}
        echoes, beams = next(outputs()), al.Sensor("Airport16", azimuth_step=5).beams
        for name, unit in wanted.items():
            self.assertEqual(echoes.units.get(name, ""), unit, name)
            if name in beams:
                self.assertEqual(beams.units.get(name, ""), unit, name)
        self.assertTrue(echoes["intensity"].max() <= 255 and beams["laser_id"].min() == 0
                        and 1e5 < beams["timestamp"].max() < 2e6)

    def test_the_table_of_arrays_is_current(self):
        """Else run CMake/arrays_page.py."""
        page = arrays_page.PAGE.read_text("utf-8")
        self.assertEqual(arrays_page.with_table(page), page)
        declared = re.findall(r'\bName \w+\{ "', arrays_page.HEADER.read_text("utf-8"))
        self.assertEqual(len(arrays_page.rows()), len(declared))
        self.assertEqual(len(UNITS), len(declared))

    def test_every_array_and_every_name(self):
        """Arrays have the unit of the page; field data are there, or are properties; what the page names exists."""
        clouds, advised = list(outputs()), of_advisor()
        units = {**NAMED, **UNITS}
        for name, unit in [*advised.items(),
                           *((name, cloud.units.get(name, "")) for cloud in clouds for name in cloud)]:
            self.assertEqual(units.get(name), unit, name)
        for name, unit in ((name, unit) for cloud in clouds for name, unit in cloud.field_units.items()):
            prop = "".join(word.title() for word in name.split("_"))
            self.assertTrue(name in units or any(hasattr(one, "Set" + prop) for one in CLASSES), name)
            self.assertEqual(units.get(name, unit), unit, name)
        there = {**UNITS, **advised, "semantic_label": ""}  # the last: by the reader
        others = set(COEFFICIENTS).union({"in clutter"}, *(cloud.fields for cloud in clouds))
        self.assertGreater(len(GLOSSARY), 90)
        for name, unit in NAMED.items():
            self.assertEqual(unit, there.get(name, unit), name)
        for name in GLOSSARY:
            self.assertTrue(name in there or name in others
                            or any(hasattr(one, "Set" + name) or hasattr(one, name) for one in CLASSES), name)
