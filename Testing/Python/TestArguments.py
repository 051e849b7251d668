# SPDX-License-Identifier: BSD-3-Clause
"""Every array, every field and every property that an algorithm reads: what it cannot use is one error that names it, and
the next good input gives what it gave before. An abort at the first event of progress is heard by every algorithm."""
import os
import pathlib
import tempfile
import unittest

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from avianlidar import _properties, vtkAvianLidar as al
from cloudtools import WRITERS, add_field, cloud, echoes
from echotools import Messages, box, scan, sensor

NAN, INF = float("nan"), float("inf")


def beams():
    source = sensor(36, 2)
    source.SetSwayAmplitude(0.01)
    source.Update()
    return source.GetOutput()


def surfaces():
    surface = box((50, 0, 0), (1, 60, 10), "Wall", "wall")
    add_field(surface, "object_classes", ["fence"])
    return surface


def report():
    filter_ = scan(surfaces(), beams())
    filter_.Update()
    return filter_


def copy(data):
    result = data.NewInstance()
    result.DeepCopy(data)
    return result


def attributes(data, where):
    return {"point": data.GetPointData, "cell": data.GetCellData, "field": data.GetFieldData}[where]()


def replace(data, where, name, values):
    """The array with other values: text for a list, else numbers."""
    if isinstance(values, list):
        array = vtk.vtkStringArray()
        for value in values:
            array.InsertNextValue(value)
    else:
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
    array.SetName(name)
    holder = attributes(data, where)
    holder.RemoveArray(name)
    holder.AddArray(array)


def with_value(value):
    def spoil(values):
        values = values.astype(float)
        values.flat[0] = value
        return values

    return spoil


SPOILERS = {
    "text": lambda values: ["no number"] * len(values),
    "wide": lambda values: np.stack([values, values], axis=-1).reshape(len(values), -1),
    "short": lambda values: values[:-1],
    "two": lambda values: np.concatenate([values, values]),
    "fraction": with_value(0.5),
    "nan": with_value(NAN),
    "infinite": with_value(INF),
    "huge": with_value(1e300),
    "numbers": lambda values: np.zeros(1),
}
ARRAY = ("text", "wide", "short")
FINITE = ARRAY + ("nan", "infinite")
WHOLE = FINITE + ("fraction", "huge")
ONE = ("text", "two", "nan", "infinite")
SENSOR = """half_beamwidth half_beamwidth_across beam_outline beam_rotation beam_profile gaussian_truncation pulse_energy pulse_width frequency sampling_interval range_gate noise_photon_rate
lower_energy_limit upper_energy_limit receiver_aperture display_length""".split()
OF_BEAMS = [("point", "direction", FINITE), ("point", "reported_direction", FINITE), ("point", "beam_id", WHOLE), ("point", "laser_id", WHOLE),
            ("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE), ("point", "timestamp", FINITE),
            ("field", "revolution", ONE + ("fraction", "huge"))] + [("field", name, ONE) for name in SENSOR]
OF_SURFACES = [("cell", "object_id", WHOLE), ("cell", "material_id", WHOLE), ("cell", "kd", FINITE), ("cell", "ks", FINITE),
               ("cell", "kp", FINITE), ("field", "object_classes", ("numbers",)),
               ("field", "object_names", ("numbers",)), ("field", "material_names", ("numbers",))]
OF_REPORT = [("point", name, ("text", "wide", "short", "fraction", "nan")) for name in (
    "beam_id", "laser_id", "status", "skipped", "candidates", "nodes_visited", "rays_traced")]
ORIGIN = ("field", "geodetic_origin", ("text", "two", "short", "nan"))
PLACE = [("field", "position", ("text", "two", "nan")), ("field", "orientation", ("text", "two", "nan"))]
CLASSES = ("field", "object_classes", ("numbers",))


def make(name, **properties):
    algorithm = getattr(al, "vtkAvianLidar" + name)()
    for key, value in properties.items():
        getattr(algorithm, "Set" + key)(value)
    return algorithm


class Arguments(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)

    def writer(self, name, **properties):
        writer = make(name + "Writer", **properties)
        writer.SetFileName(str(self.folder / ("echoes" + WRITERS[name])))
        return writer

    def algorithms(self):
        """Each algorithm with good inputs, and what it reads of each."""
        done = report()
        everything = echoes()
        enu = echoes()
        yield make("EchoFilter"), [beams(), surfaces()], [OF_BEAMS, OF_SURFACES]
        yield make("CollisionTree"), [surfaces()], [OF_SURFACES]
        yield make("Material"), [surfaces()], [OF_SURFACES[-2:]]
        yield make("RangeImage", Columns=36, Rows=2), [done.GetOutput(0), done.GetOutput(1)], [
            [("point", "beam_id", WHOLE), ("point", "energy_received", FINITE), ("point", "distance_m", FINITE),
             ("point", "energy", FINITE), ("point", "object_id", WHOLE)],
            OF_REPORT + [("point", "azimuth", FINITE), ("point", "vertical_angle", FINITE),
                         ("point", "skipped_bound", ARRAY)]]
        yield make("HSBColorMap"), [done.GetOutput(0)], [
            [("point", "energy", ARRAY), ("field", "lower_energy_limit", ONE), ("field", "upper_energy_limit", ONE)]]
        yield make("GeodeticTransform"), [enu], [[ORIGIN]]
        yield make("CloudComparison"), [done.GetOutput(0), everything], [[], []]
        yield make("ClutterFilter"), [everything], [[PLACE[0]]]
        yield make("UnitNames"), [everything], [[]]
        yield self.writer("LAS"), [everything], [[
            ("point", "intensity", FINITE), ("point", "return_number", WHOLE), ("point", "number_of_returns", WHOLE),
            ("point", "timestamp", FINITE), ("point", "vertical_angle", FINITE), ("point", "object_id", WHOLE),
            ("point", "energy", ARRAY), CLASSES, ORIGIN]]
        yield self.writer("KITTI"), [everything], [
            [("point", "intensity", FINITE), ("point", "object_id", WHOLE), CLASSES] + PLACE]
        yield self.writer("KITTI", LabelSource=1), [everything], [[("point", "material_id", WHOLE)]]
        yield self.writer("PCD", Organisation=1), [everything], [
            [("point", "beam_id", WHOLE), ("point", "laser_id", WHOLE), ("point", "energy_received", FINITE),
             ("point", "intensity", ARRAY)] + PLACE + [("field", name, ONE) for name in (
                 "number_of_channels", "azimuth_step", "minimum_elevation", "elevation_step")]
            + [("field", "azimuth_range", ("text", "two"))]]
        yield self.writer("GeoJSON"), [everything], [
            [("point", "energy", FINITE), ("point", "object_id", WHOLE), ("point", "material_id", WHOLE), ORIGIN,
             ("field", "lower_energy_limit", ONE), ("field", "object_names", ("numbers",)), CLASSES,
             ("field", "material_names", ("numbers",))]]

    def run_one(self, algorithm, inputs):
        """What it says, and what comes out: the points or the bytes of the file."""
        for port, data in enumerate(inputs):
            algorithm.SetInputData(port, data)
        heard = Messages(algorithm)
        if isinstance(algorithm, al.vtkAvianLidarCloudWriter):
            written = algorithm.Write()
            self.assertEqual(written, 0 if heard.errors else 1)
            files = sorted(self.folder.iterdir())
            content = [(file.name, file.read_bytes()) for file in files]
            for file in files:
                file.unlink()
            return heard.errors, content
        algorithm.Update()
        output = algorithm.GetOutputDataObject(1 if algorithm.IsA("vtkAvianLidarTracks") else 0)
        names = [output.GetPointData().GetArrayName(i) for i in range(output.GetPointData().GetNumberOfArrays())]
        arrays = [(name, vtk_to_numpy(output.GetPointData().GetArray(name)).tobytes()) for name in names
                  if output.GetPointData().GetArray(name)]
        return heard.errors, (output.GetNumberOfPoints(), output.GetNumberOfCells(), arrays)

    def test_every_array_and_field(self):
        tried = 0
        for algorithm, inputs, reads in self.algorithms():
            errors, good = self.run_one(algorithm, inputs)
            self.assertEqual(errors, [], algorithm.GetClassName())
            nothing = [] if isinstance(good, list) else (0, 0, [])
            for port, wanted in enumerate(reads):
                for where, name, spoilers in wanted:
                    there = attributes(inputs[port], where).GetAbstractArray(name)
                    self.assertIsNotNone(there, (algorithm.GetClassName(), port, name))
                    for spoiler in spoilers:
                        with self.subTest(algorithm.GetClassName(), port=port, array=name, spoiler=spoiler):
                            values = None if there.IsA("vtkStringArray") else vtk_to_numpy(there)
                            bad = list(map(copy, inputs))
                            replace(bad[port], where, name, SPOILERS[spoiler](values))
                            errors, out = self.run_one(algorithm, bad)
                            self.assertEqual(len(errors), 1, errors)
                            self.assertIn(name, errors[0])
                            self.assertEqual(out[:2], nothing[:2])
                            tried += 1
            errors, again = self.run_one(algorithm, inputs)
            self.assertEqual(errors, [])
            if not isinstance(algorithm, al.vtkAvianLidarLASWriter):  # has the day in its header
                self.assertEqual(again, good, algorithm.GetClassName())
        self.assertGreater(tried, 300)

    def test_far_away(self):
        """Clouds to compare: squares of what is beyond are no numbers."""
        near = cloud([(0, 0, 0), (1, 0, 0)])
        for far in (1e31, 1e151, 1e200, -1e308):
            for port in (0, 1):
                inputs = [near, near]
                inputs[port] = cloud([(0, 0, 0), (0, far, 0)])
                comparison = make("CloudComparison")
                errors, _ = self.run_one(comparison, inputs)
                self.assertEqual(len(errors), 1)
                self.assertIn(f"input port {port}", errors[0])
                self.assertIn("point 1", errors[0])
                self.assertIn("1e30", errors[0])
                self.assertEqual(self.run_one(comparison, [near, near])[0], [])
        comparison = make("CloudComparison")
        self.assertEqual(self.run_one(comparison, [near, cloud([(1e30, 0, 0), (0, 0, 0)])])[0], [])
        self.assertEqual(comparison.GetHausdorffDistance(), 1e30)

    # Any value of these means something.
    ANY = {("EchoFilter", "Seed"), ("BeamSource", "MotionSeed"), ("EchoFilter", "NumberOfThreads"), ("EchoFilter", "MaximumCacheSize"),
           ("CollisionTree", "DisplayLevel"), ("CollisionTree", "MaximumLeafSize"),
           ("Material", "ObjectId"), ("BeamSource", "AzimuthStep"), ("BeamSource", "Orientation"), ("GeoJSONWriter", "MinimumEnergy"),
           ("EchoFilter", "NumberOfConnections"),
           ("HSBColorMap", "EnergyRange"), ("Tracks", "Seed")}

    def test_every_property(self):
        """NaN is refused by each; beyond its range, each says its own name."""
        setups = {
            "BeamSource": ({}, []), "EchoFilter": ({"Preset": 0}, [beams(), surfaces()]),
            "CollisionTree": ({}, [surfaces()]),
            "Material": ({"Material": 4}, [surfaces()]), "HSBColorMap": ({"UseFieldDataRange": False}, [report().GetOutput(0)]),
            "GeodeticTransform": ({"UseFieldDataOrigin": False}, [echoes()]),
            "GeoJSONWriter": ({"UseFieldDataLimit": False}, [echoes()]),
            "Tracks": ({}, []), "CloudComparison": ({}, [report().GetOutput(0), echoes()]), "ClutterFilter": ({}, [echoes()])}
        tried = 0
        for name, (settings, inputs) in setups.items():
            wrapped = getattr(al, "vtkAvianLidar" + name)
            for property_ in _properties.property_names(wrapped).values():
                if property_ in ("ChannelElevations", "FileName", "GivenFileName"):
                    continue
                value = getattr(wrapped(), "Get" + property_)()
                for bad in (NAN, INF, -INF, 1e300, -1e300, -(1 << 31), (1 << 31) - 1):
                    first = value[0] if isinstance(value, tuple) else value
                    if isinstance(first, (bool, str)) or type(first) is not type(bad):
                        continue
                    algorithm = make(name, **settings)
                    if isinstance(algorithm, al.vtkAvianLidarCloudWriter):
                        algorithm.SetFileName(str(self.folder / "x"))
                    getattr(algorithm, "Set" + property_)((bad,) * len(value) if isinstance(value, tuple) else bad)
                    with self.subTest(name, property=property_, value=bad):
                        errors, _ = self.run_one(algorithm, inputs)
                        if errors or bad != bad or (name, property_) not in self.ANY:
                            self.assertEqual(len(errors), 1, errors)
                            self.assertIn(property_, errors[0])
                        tried += 1
        self.assertGreater(tried, 150)

    def test_messages_name_what_was_set(self):
        source = make("BeamSource", NumberOfChannelElevations=2)
        source.SetChannelElevation(1, 93)
        self.assertIn("channel 1 (its ChannelElevation) is 93", self.run_one(source, [])[0][0])
        source = make("BeamSource", NumberOfChannels=2, MinimumElevation=80, ElevationStep=11)
        error = self.run_one(source, [])[0][0]
        self.assertIn("(MinimumElevation + ElevationStep * (NumberOfChannels - 1)) is 91", error)
        for name, value in (("Kd", -1), ("Ks", 2), ("Kp", -1)):
            error = self.run_one(make("Material", Material=4, **{name: value}), [surfaces()])[0][0]
            self.assertIn(f": {name} is" if name != "Ks" else "Kd + Ks is", error)
        many = scan(surfaces(), beams(), Preset=0, RaysPerBeam=1000000, NumberOfReflections=2, NumberOfConnections=1000)
        error = self.run_one(many, [])[0][0]
        self.assertIn("RaysPerBeam is 1000000", error)

    def test_bad_arguments_of_methods(self):
        cover, colours = make("Coverage"), make("HSBColorMap")
        for algorithm, words, call in ((cover, "there is no entry 1000, expected 0 to", lambda: cover.GetHeightLimit(1000)),
                                       (cover, "there is no entry -1", lambda: cover.GetHeightLimit(-1)),
                                       (colours, "no table given", lambda: colours.FillLookupTable(None))):
            heard = Messages(algorithm)
            call()
            self.assertEqual(len(heard.errors), 1)
            self.assertIn(words, heard.errors[0])

    def test_partitions_are_chosen_by_the_name_of_their_set(self):
        sets = vtk.vtkPartitionedDataSetCollection()
        for i, name in enumerate(("fence", "wall")):
            for k in range(2):
                sets.SetPartition(i, k, surfaces())
            sets.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), name)
        material = make("Material", Material=2, BlockNamePattern="fen*")
        material.SetInputData(sets)
        material.Update()
        output = material.GetOutputDataObject(0)
        ids = [{int(i) for i in vtk_to_numpy(output.GetPartition(i, k).GetCellData().GetArray("material_id"))}
               for i in range(2) for k in range(2)]
        self.assertEqual(ids[0], ids[1])
        self.assertEqual(ids[2], ids[3])
        self.assertNotEqual(ids[0], ids[2])

    def test_an_abort_at_the_first_progress(self):
        cases = [(make("BeamSource"), []), (make("Tracks"), [])] + [(algorithm, inputs) for algorithm, inputs, _ in self.algorithms()]
        cases += [(self.writer("PCD"), [cloud([])]), (self.writer("KITTI", WriteLabels=False), [cloud([])]),
                  (self.writer("LAS", CoordinateSystem=2), [cloud([])])]
        good = str(self.folder / "good.pcd")
        writer = make("PCDWriter")
        writer.SetFileName(good)
        writer.SetInputData(cloud([(1, 2, 3)]))
        self.assertEqual(writer.Write(), 1)
        content = pathlib.Path(good).read_bytes()
        source = os.environ["AVIANLIDAR_SOURCE_DIR"]
        scene = os.path.join(source, "Examples", "airport", "scene", "hongqiao.lidarscene.json")
        cases += [(make("PointCloudReader", FileName=good), []), (make("SceneReader", FileName=scene), [])]
        for algorithm, inputs in cases:
            for port, data in enumerate(inputs):
                algorithm.SetInputData(port, data)
            seen = []

            def stop(caller, _):
                seen.append(caller.GetProgress())  # noqa: B023
                caller.SetAbortExecute(1)

            tag = algorithm.AddObserver("ProgressEvent", stop)
            heard = Messages(algorithm)
            with self.subTest(algorithm.GetClassName()):
                if isinstance(algorithm, al.vtkAvianLidarCloudWriter):
                    algorithm.SetFileName(good)
                    self.assertEqual(algorithm.Write(), 0)
                    self.assertEqual(pathlib.Path(good).read_bytes(), content)
                    self.assertEqual(os.listdir(self.folder), ["good.pcd"])
                else:
                    algorithm.Update()
                    for port in range(algorithm.GetNumberOfOutputPorts()):
                        output = algorithm.GetOutputDataObject(port)
                        self.assertEqual(output.GetNumberOfElements(0), 0)
                        self.assertEqual(output.GetNumberOfElements(1), 0)
                self.assertEqual(heard.errors, [])
                self.assertEqual(seen[0], 0)
                algorithm.RemoveObserver(tag)
                algorithm.SetAbortExecute(0)
                algorithm.Modified()
                if isinstance(algorithm, al.vtkAvianLidarCloudWriter):
                    self.assertEqual(algorithm.Write(), 1)
                    for file in self.folder.iterdir():
                        file.unlink()
                    pathlib.Path(good).write_bytes(content)
                else:
                    algorithm.Update()
                    self.assertGreater(algorithm.GetOutputDataObject(0).GetNumberOfElements(0), 0)
                self.assertEqual(heard.errors, [])


if __name__ == "__main__":
    unittest.main()
