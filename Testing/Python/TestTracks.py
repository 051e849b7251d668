# SPDX-License-Identifier: BSD-3-Clause
"""Tracks: movers as the contract has them, trails, tracks of files and of lines, the bird that they are, and errors
that name what is wrong. How birds fly is TestFlight's, what they are made of TestBird's (kernel); numbers out of range
are TestBadInput's."""
import itertools
import re

import numpy as np
import vtk
from scipy.spatial.transform import Rotation
from vtkmodules.util.numpy_support import vtk_to_numpy

from avianlidar import Error, _cloud, _scene
from avianlidar._pipeline import update
from avianlidar.vtkAvianLidar import vtkAvianLidarTracks
from cloudtools import add_array, cloud, field as text
from echotools import InFolder, Messages, bird, given

NAN = float("nan")
PATTERNS = ("Crossings", "Circles", "Flock", "Approach")
HEADER = "id,species,time,x,y,z\n"
GEODETIC = "id,species,time,longitude,latitude,height\n"
ROWS = "17,herring gull,0,0,0,20\nb,crow,1,0,0,30\n17,herring gull,4,0,50,20\nb,crow,3,26,0,30\n"
SHARED = {*_scene.COEFFICIENTS, "material_id", "object_id"}
POSES = {"object_classes", "pose_time", "pose_position", "pose_orientation", "object_names", "material_names",
         "species"}
FLAPS = {"flap_hinge", "flap_axis", "flap_amplitude", "flap_frequency", "flap_phase"}


def tracks(**properties):
    return given(vtkAvianLidarTracks(), **properties)


def pattern(name):
    return getattr(vtkAvianLidarTracks, "PATTERN_" + name.upper())


def movers(source):
    update(source)
    output = source.GetOutputDataObject(0)
    return [output.GetBlock(i) for i in range(output.GetNumberOfBlocks())]


def field(block, name):
    return vtk_to_numpy(block.GetFieldData().GetArray(name))


def names_of(attributes):
    return {attributes.GetAbstractArray(i).GetName() for i in range(attributes.GetNumberOfArrays())}


def rotated(q, points):
    """By a unit quaternion w, x, y, z."""
    return Rotation.from_quat(np.roll(q, -1)).apply(points)


def placed(block, time):
    """Points of a mover in the scene at the time of its first pose, as the contract says."""
    points = vtk_to_numpy(block.GetPoints().GetData()).copy()
    if block.GetFieldData().GetArray("flap_hinge"):
        cells = vtk_to_numpy(block.GetPolys().GetConnectivityArray()).reshape(-1, 3)
        part = vtk_to_numpy(block.GetCellData().GetArray("part"))
        for row in range(2):
            which = np.unique(cells[part == row + 1])
            turns = field(block, "flap_frequency")[row] * time + field(block, "flap_phase")[row]
            angle = field(block, "flap_amplitude")[row] * np.sin(2 * np.pi * turns)
            hinge = field(block, "flap_hinge")[row]
            q = (np.cos(angle / 2), *np.sin(angle / 2) * field(block, "flap_axis")[row])
            points[which] = hinge + rotated(q, points[which] - hinge)
    return field(block, "pose_position")[0] + rotated(field(block, "pose_orientation")[0], points)


def polyline(points, times=None, species=None, where="cell"):
    """One line for each list of points."""
    data, cells, ids = cloud(np.concatenate(points)), vtk.vtkCellArray(), itertools.count()
    for line in points:
        cells.InsertNextCell(len(line), [next(ids) for _ in line])
    data.SetLines(cells)
    if times is not None:
        add_array(data, "time", np.array(times, dtype=float))
    if species is not None:
        _cloud.add_array(data.GetCellData() if where == "cell" else data.GetFieldData(), "species", species)
    return data


TWO_LINES = [[(0, 0, 5), (10, 0, 5), (20, 0, 5)], [(0, 0, 9), (0, 30, 9)]]
TIMES = [0, 1, 2, 5, 7]


class Tracks(InFolder):
    def file(self, content, name="own.csv"):
        path = self.folder / name
        path.write_text(content, "utf-8")
        return str(path)

    def from_lines(self, data, **properties):
        source = tracks(Pattern=pattern("Lines"), **properties)
        source.SetInputData(data)
        return source

    def test_movers_have_what_the_contract_says(self):
        for name in PATTERNS:
            with self.subTest(name):
                source = tracks(Pattern=pattern(name), NumberOfBirds=4, FirstObjectId=50, Reflectance=0.15,
                                TimeRange=(3, 9))
                blocks = movers(source)
                self.assertEqual(len(blocks), 4)
                species = "starling" if name == "Flock" else "herring gull"
                flapping = name != "Circles"
                for i, block in enumerate(blocks):
                    self.assertEqual(block.GetNumberOfCells(), 72)
                    self.assertEqual(names_of(block.GetCellData()), SHARED | ({"part"} if flapping else set()))
                    self.assertEqual(names_of(block.GetFieldData()), POSES | (FLAPS if flapping else set()))
                    self.assertEqual(set(vtk_to_numpy(block.GetCellData().GetArray("object_id"))), {50 + i})
                    self.assertEqual(set(vtk_to_numpy(block.GetCellData().GetArray("kd"))), {0.15})
                    self.assertEqual(text(block, "object_names"), [f"{species} {i + 1}"])
                    self.assertEqual(text(block, "species"), [species])
                    self.assertEqual(text(block, "material_names")[4], "Plumage")
                    times = field(block, "pose_time")
                    self.assertEqual((times[0], times[-1]), (3, 9))
                    self.assertTrue((np.diff(times) > 0).all())
                    self.assertEqual(field(block, "pose_position").shape, (len(times), 3))
                    orientation = field(block, "pose_orientation")
                    self.assertEqual(orientation.shape, (len(times), 4))
                    np.testing.assert_allclose(np.linalg.norm(orientation, axis=1), 1, atol=1e-12)
                    self.assertGreater((orientation[1:] * orientation[:-1]).sum(axis=1).min(), 0)
                    for array, unit in (("pose_time", "s"), ("pose_position", "m")):
                        information = block.GetFieldData().GetArray(array).GetInformation()
                        self.assertEqual(information.Get(vtk.vtkDataArray.UNITS_LABEL()), unit)

    def test_a_mover_is_the_bird_of_the_bird_source(self):
        for heading in (30, 200):
            velocity = np.array((np.sin(np.radians(heading)), np.cos(np.radians(heading)), 0))
            start = np.array((5.0, -3.0, 40.0))
            data = polyline([[start, start + 15 * velocity]], [2.25, 3.5])
            block = movers(self.from_lines(data, Species="crow"))[0]
            phase = field(block, "flap_frequency")[0] * 2.25 + field(block, "flap_phase")[0]
            crow = bird(Species="crow", Position=tuple(start), Heading=heading, WingPhase=phase)
            np.testing.assert_allclose(placed(block, 2.25), vtk_to_numpy(crow.GetPoints().GetData()), atol=1e-9)
            self.assertAlmostEqual(np.degrees(field(block, "flap_amplitude")[1]), 35)

    def test_trails(self):
        """A file with a comment and an empty line."""
        source = tracks(Pattern=pattern("File"), FileName=self.file("# radar\n" + HEADER + "\n" + ROWS))
        blocks = movers(source)
        self.assertNotEqual(*(field(block, "flap_phase")[0] for block in blocks))
        trails = source.GetOutputDataObject(1)
        self.assertEqual(trails.GetNumberOfLines(), 2)
        np.testing.assert_array_equal(vtk_to_numpy(trails.GetPoints().GetData()),
                                      np.concatenate([field(block, "pose_position") for block in blocks]))
        np.testing.assert_array_equal(vtk_to_numpy(trails.GetPointData().GetArray("time")), [0, 4, 1, 3])
        self.assertEqual(list(vtk_to_numpy(trails.GetCellData().GetArray("object_id"))), [10000, 10001])
        names = text(trails, "species_names")
        self.assertEqual([names[i] for i in vtk_to_numpy(trails.GetCellData().GetArray("species_id"))],
                         ["herring gull", "crow"])
        self.assertEqual([text(block, "object_names") for block in blocks], [["herring gull 17"], ["crow b"]])

    def test_longitudes_and_latitudes(self):
        file = self.file(GEODETIC + "1,crow,0,121.3,31.2,25\n1,crow,1,121.3,31.2001,25\n")
        block = movers(tracks(Pattern=pattern("File"), FileName=file, Origin=(31.2, 121.3, 5)))[0]
        np.testing.assert_allclose(field(block, "pose_position"), [(0, 0, 20), (0, 11.09, 20)], atol=0.01)

    def test_birds_of_a_file_that_are_far_away(self):
        """A forgotten origin, and projected coordinates, give one warning with the distance."""
        equator = 6371.0 * np.radians(np.hypot(31.2, 121.3))  # km, no more than a bound here
        for rows, far in ((GEODETIC + "1,crow,0,121.3,31.2,25\n1,crow,1,121.3,31.2001,25\n", True),
                          (HEADER + "1,crow,0,345000,3453000,9\n1,crow,1,345010,3453000,9\n", True),
                          (HEADER + "1,crow,0,50000,60000,9\n1,crow,1,50010,60000,9\n", False)):
            source = tracks(Pattern=pattern("File"), FileName=self.file(rows))
            heard = Messages(source)
            self.assertEqual(len(movers(source)), 1)
            self.assertEqual(len(heard.all()), far, heard.all())
            if far:
                distance = float(re.search(r"all birds are at least (\d+) km from the scene's origin",
                                           heard.warnings[0])[1])
                self.assertTrue(3000 < distance < equator, distance)

    def test_lines(self):
        blocks = movers(self.from_lines(polyline(TWO_LINES, TIMES), Species="pigeon"))
        self.assertEqual([text(block, "object_names")[0] for block in blocks], ["pigeon 1", "pigeon 2"])
        np.testing.assert_array_equal(field(blocks[0], "pose_position"), TWO_LINES[0])
        np.testing.assert_array_equal(field(blocks[1], "pose_time"), [5, 7])
        for where, species in (("cell", ["crow", "kestrel"]), ("field", ["crow", "kestrel"]), ("field", ["crow"])):
            blocks = movers(self.from_lines(polyline(TWO_LINES, TIMES, species, where), Species="not used"))
            self.assertEqual([text(block, "species")[0] for block in blocks], [species[0], species[-1]])

    def test_a_file_without_birds_is_not_an_error(self):
        empty = [tracks(Pattern=pattern(name), NumberOfBirds=0) for name in PATTERNS]
        empty.append(tracks(Pattern=pattern("File"), FileName=self.file(HEADER)))
        empty.append(self.from_lines(vtk.vtkPolyData()))
        for source in empty:
            heard = Messages(source)
            self.assertEqual(movers(source), [])
            self.assertEqual(source.GetOutputDataObject(1).GetNumberOfPoints(), 0)
            self.assertEqual(heard.all(), [])

    def assert_fails(self, source, words):
        """An error that says so, nothing comes out, and the next good input works."""
        with self.subTest(words):
            with self.assertRaisesRegex(Error, words):
                update(source)
            self.assertEqual((source.GetOutputDataObject(0).GetNumberOfBlocks(),
                              source.GetOutputDataObject(1).GetNumberOfPoints()), (0, 0))
            good = tracks()
            for name in ("NumberOfBirds", "TimeRange", "Radius", "Heights", "Species", "SpeciesFileName",
                         "FirstObjectId", "Origin", "Pattern"):
                getattr(source, "Set" + name)(getattr(good, "Get" + name)())
            self.assertEqual(len(movers(source)), good.GetNumberOfBirds())

    def test_bad_values_name_the_property(self):
        for properties, words in (({"TimeRange": (1, 1)}, "TimeRange is"), ({"Heights": (3, 2)}, "Heights is 3 to 2"),
                                  ({"Origin": (91, 0, 0)}, "Origin: "),
                                  ({"FirstObjectId": 2**31 - 5}, "FirstObjectId is"),
                                  ({"Species": "dodo"}, "Species is 'dodo'"),
                                  ({"SpeciesFileName": "/nowhere.csv"}, "SpeciesFileName /nowhere.csv"),
                                  ({"Pattern": pattern("Circles"), "NumberOfBirds": 100000, "TimeRange": (0, 1e9)},
                                   "NumberOfBirds, TimeRange")):
            self.assert_fails(tracks(**properties), words)

    def test_bad_files_are_named(self):
        """Each kind of bad line is TestFlight's (kernel)."""
        self.assert_fails(tracks(Pattern=pattern("File")), "FileName is empty")
        self.assert_fails(tracks(Pattern=pattern("File"), FileName="/nowhere.csv"), "FileName /nowhere.csv")
        self.assert_fails(tracks(Pattern=pattern("File"), FileName=self.file(HEADER + ROWS + "b,crow,3,0,0,0\n")),
                          "own.csv: line 6: time is '3'")

    def test_bad_lines_are_named(self):
        self.assert_fails(tracks(Pattern=pattern("Lines")), "port 0 has no connection")
        points, numbers = vtk.vtkPolyData(), polyline(TWO_LINES, TIMES)
        points.SetPoints(numbers.GetPoints())
        _cloud.add_array(numbers.GetCellData(), "species", np.zeros(2))
        for data, words in (
                (points, "has points but no lines"), (polyline(TWO_LINES), "no point array 'time'"),
                (polyline(TWO_LINES, TIMES[:4]), "'time' has 4 values"),
                (polyline(TWO_LINES, [0, 1, 2, 5, 5]), "line 1 has at point 4 a 'time'"),
                (polyline([[(0, 0, 0), (0, NAN, 0)]], [0, 1]), "line 0 has at point 1"),
                (polyline(TWO_LINES, TIMES, ["crow", "dodo"]), "line 1 has a species"),
                (polyline(TWO_LINES, TIMES, ["crow"]), "'species' has 1 values"),
                (numbers, "cell array 'species' does not have")):
            self.assert_fails(self.from_lines(data), words)
