# SPDX-License-Identifier: BSD-3-Clause
"""What each class reads and each of its properties, with wrong values: one error that names the input and the quantity,
empty outputs, and the next good input gives what it gave before. What is legal but suspicious is a warning, once."""
import os
from xml.etree import ElementTree

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy

from avianlidar import _cloud, _properties, vtkAvianLidar as al
from avianlidar._scene import COEFFICIENTS
from cloudtools import WRITERS, add_array, cloud
from echotools import InFolder, Messages, assert_same_bits, box, given, output, sensor, town
from faulttools import CLASSES, INF, NAN, PLACE_OF_VALUE, algorithms, beams, copy_of, make, spoil, surfaces

NOTHING = (0, 0)


class Faults(InFolder):
    def run_one(self, algorithm, inputs):
        """What it says, and what comes out: points, cells and arrays, or the bytes of its files."""
        for port, data in enumerate(inputs):
            algorithm.SetInputData(port, data)
        heard = Messages(algorithm)
        if isinstance(algorithm, al.vtkAvianLidarCloudWriter):
            self.assertEqual(algorithm.Write(), 0 if heard.errors else 1)
            content = []
            for name in sorted(os.listdir()):
                with open(name, "rb") as file:
                    content.append((name, file.read()))
                os.remove(name)
            return heard.errors, content or NOTHING
        algorithm.Update()
        output = algorithm.GetOutputDataObject(1 if algorithm.IsA("vtkAvianLidarTracks") else 0)
        data = output.GetPointData() if hasattr(output, "GetPointData") else None
        arrays = [(data.GetArrayName(i), vtk_to_numpy(data.GetArray(i)).tobytes())
                  for i in range(data.GetNumberOfArrays() if data else 0) if data.GetArray(i)]
        return heard.errors, (output.GetNumberOfElements(0), output.GetNumberOfElements(1), *arrays)

    def fails(self, algorithm, inputs, *words):
        errors, out = self.run_one(algorithm, inputs)
        self.assertEqual(len(errors), 1, errors)
        for word in words:
            self.assertRegex(errors[0], word)
        self.assertEqual(out, NOTHING)
        return errors[0]

    def warnings(self, algorithm, inputs, again=()):
        heard = Messages(algorithm)
        for data in (inputs, *again):
            for port, one in enumerate(data):
                algorithm.SetInputData(port, one)
            algorithm.Modified()
            algorithm.Update()
        self.assertEqual(heard.errors, [])
        return heard.warnings


class Arrays(Faults):
    def test_every_array_and_field(self):
        tried = 0
        for algorithm, inputs, reads in algorithms():
            errors, good = self.run_one(algorithm, inputs)
            self.assertEqual(errors, [], algorithm.GetClassName())
            for port, wanted in enumerate(reads):
                for where, name, ways in wanted:
                    for how in ways:
                        with self.subTest(algorithm.GetClassName(), port=port, array=name, how=how):
                            bad = list(inputs)
                            bad[port] = spoil(inputs[port], where, name, how)
                            words = [name]
                            if isinstance(how, (float, tuple)) and where != "field":
                                words.append(rf"\b{PLACE_OF_VALUE}\b")
                            if isinstance(algorithm, (al.vtkAvianLidarEchoFilter, al.vtkAvianLidarCollisionTree)):
                                words.append(f"nput port {port}")
                            self.fails(algorithm, bad, *words)
                            tried += 1
            errors, again = self.run_one(algorithm, inputs)
            self.assertEqual(errors, [])
            if not isinstance(algorithm, al.vtkAvianLidarLASWriter):  # has the day in its header
                self.assertEqual(again, good, algorithm.GetClassName())
        self.assertGreater(tried, 400)

    def test_inputs_of_another_kind(self):
        """None, the other's, or blocks of other data."""
        for name in ("EchoFilter", "Coverage"):
            for port, what in enumerate(("beams", "surfaces")):
                algorithm, good = make(name), (beams(), surfaces())
                algorithm.SetInputData(1 - port, good[1 - port])
                heard = Messages(algorithm)
                algorithm.Update()
                self.assertRegex("".join(heard.errors), rf"Input port {port} \({what}\) is not connected")
                self.assertEqual(len(heard.errors), 1)
                algorithm.SetInputData(port, good[port])
                algorithm.Update()
                self.assertEqual(len(heard.errors), 1)
                self.assertGreater(algorithm.GetOutputDataObject(0).GetNumberOfElements(0), 0)
            self.fails(make(name), [beams(), beams()], "Input port 1, surfaces: these are beams")
        self.fails(make("CollisionTree"), [beams()], "Input port 0, surfaces: these are beams")
        self.fails(make("EchoFilter"), [surfaces(), surfaces()], r"Input port 0 \(beams\).*'direction' is missing")
        blocks = town(count=2)
        blocks.SetBlock(2, vtk.vtkUnstructuredGrid())
        blocks.GetMetaData(2).Set(vtk.vtkCompositeDataSet.NAME(), "tetrahedra")
        for algorithm, inputs in ((make("CollisionTree"), [blocks]), (make("EchoFilter"), [beams(), blocks])):
            self.fails(algorithm, inputs, "nput port", "tetrahedra", "vtkPolyData")
        for name in WRITERS:
            writer = make(name + "Writer", FileName="x")
            heard = Messages(writer)
            self.assertEqual((writer.Write(), len(heard.errors), os.listdir()), (0, 1, []))

    def test_far_away(self):
        """Clouds to compare: squares of larger coordinates are not finite."""
        near = cloud([(0, 0, 0), (1, 0, 0)])
        comparison = make("CloudComparison")
        for port, far in ((0, 1e31), (1, -1e308)):
            inputs = [near, near]
            inputs[port] = cloud([(0, 0, 0), (0, far, 0)])
            self.fails(comparison, inputs, f"input port {port}.*point 1.*1e30")
        self.assertEqual(self.run_one(comparison, [near, cloud([(1e30, 0, 0), (0, 0, 0)])])[0], [])
        self.assertEqual(comparison.GetHausdorffDistance(), 1e30)

    def test_clouds_that_formats_cannot_hold(self):
        data = cloud(np.zeros((5, 3)))
        for colours, words in ((np.zeros((5, 4), "u1"), "4 components"), (np.zeros((5, 3)), "double"),
                               (np.zeros((2, 3), "u1"), "2")):
            bad = copy_of(data)
            add_array(bad, "rgb", colours)
            for name in ("LAS", "PCD"):
                self.fails(make(name + "Writer", FileName="x"), [bad], "'rgb'.*" + words)
        data.GetPointData().AddArray(numpy_to_vtk(np.ones(5), deep=True))
        writer = make("LASWriter", FileName="x.las")
        heard = Messages(writer)
        self.run_one(writer, [data])
        self.assertIn("x.las is without the point arrays 'point array 0' (it has no name)", "".join(heard.warnings))


def of_panel(name):
    """{property: values beside the choices, or below the least number, of ParaView's panel}"""
    found = {}
    for prop in ElementTree.parse(os.path.join(os.environ["AVIANLIDAR_SOURCE_DIR"], "Plugin", "Filters",
                                               f"AvianLidar{name}.xml")).iter():
        ends, entries = prop.get("range", "").split(), prop.get("entries", "").split()
        if ends or entries:
            least = int(ends[0] if ends else 0) - 1 if prop.tag.startswith("Int") else float(ends[0]) - 1e-9
            found[prop.get("command", "Set" + prop.get("name"))[3:]] = (least, *([len(entries)] if entries else []))
    return found


class Properties(Faults):
    # Any value of these means something.
    ANY = {("EchoFilter", "Seed"), ("BeamSource", "MotionSeed"), ("EchoFilter", "NumberOfThreads"),
           ("EchoFilter", "MaximumCacheSize"),
           ("CollisionTree", "DisplayLevel"), ("CollisionTree", "MaximumLeafSize"), ("Material", "ObjectId"),
           ("BeamSource", "AzimuthStep"),
           ("BeamSource", "Orientation"), ("GeoJSONWriter", "MinimumEnergy"), ("EchoFilter", "NumberOfConnections"),
           ("HSBColorMap", "EnergyRange"), ("Tracks", "Seed")}
    # The first value beyond the border of a choice or a number; above sliders, those that the class has.
    BORDERS = {"EchoFilter": {**of_panel("EchoFilter"), "RaysPerBeam": (0, 1000001), "NumberOfReflections": (0, 4),
                              "LightEnergyFraction": (-1e-9, 1.1e8)},
               "BeamSource": {"SwayAmplitude": (-1e-9, 10.1), "SwayFrequency": (0.0, 1e7),
                              "EncoderJitter": (-1e-9, 10.1)},
               "CollisionTree": {"Preset": (2,), "SplitRule": (4,), "BoundingVolume": (-1, 4), "MaximumLeafSize": (0,)},
               "Tracker": {"ClusterAngle": (30.0,), "RangeError": (0.0,), "MotionModel": (2,),
                           "GateProbability": (1.0,),
                           "ConfirmHits": (5,), "KeepTime": (-1.0,)},
               "ClutterFilter": {"Window": (0.5,), "WarmUp": (-1,)}, "CloudComparison": {"ChamferAlpha": (0.0, 2e6)},
               "GeodeticTransform": {"UTMZone": (61,)}, "Tracks": {"Pattern": (6,), "NumberOfBirds": (100001,),
                                                                   "Radius": (-1.0,)}}

    def test_every_property(self):
        """NaN is refused by each; beyond its range, each says its own name."""
        # Settings with which the properties are read.
        setups = {
            "BeamSource": {}, "EchoFilter": {"Preset": 0}, "CollisionTree": {}, "Material": {"Material": 4},
            "HSBColorMap": {"UseFieldDataRange": False},
            "GeodeticTransform": {"UseFieldDataOrigin": False}, "GeoJSONWriter": {"UseFieldDataLimit": False},
            "Tracks": {}, "Tracker": {},
            "CloudComparison": {}, "ClutterFilter": {}}
        given_inputs = {name: [produce().data() for produce, _ in inputs] for name, _, *inputs in CLASSES
                        if name in setups}
        tried = 0
        for name, settings in setups.items():
            inputs = given_inputs.get(name, []) if name != "Tracks" else []
            wrapped = getattr(al, "vtkAvianLidar" + name)
            for property_ in _properties.property_names(wrapped).values():
                if property_ in ("ChannelElevations", "FileName", "GivenFileName"):
                    continue
                value = getattr(wrapped(), "Get" + property_)()
                first = value[0] if isinstance(value, tuple) else value
                for bad in (NAN, INF, -INF, 1e300, -1e300, -(1 << 31), (1 << 31) - 1,
                            *self.BORDERS.get(name, {}).get(property_, ())):
                    if isinstance(first, (bool, str)) or type(first) is not type(bad):
                        continue
                    algorithm = make(name, **settings, **({"FileName": "x"} if name.endswith("Writer") else {}))
                    getattr(algorithm, "Set" + property_)((bad,) * len(value) if isinstance(value, tuple) else bad)
                    with self.subTest(name, property=property_, value=bad):
                        errors, out = self.run_one(algorithm, inputs)
                        borders = self.BORDERS.get(name, {}).get(property_, ())
                        legal = (name, property_) in self.ANY and bad == bad and bad not in borders
                        if errors or not legal:
                            self.assertEqual(len(errors), 1, errors)
                            self.assertRegex(errors[0], rf"{property_}[\s\S]*expected|{property_}.*\bis")
                            self.assertEqual(out, NOTHING)
                        tried += 1
        self.assertGreater(tried, 200)

    def test_messages_name_what_was_set(self):
        """Each of several that share a limit."""
        source = make("BeamSource", NumberOfChannelElevations=2)
        source.SetChannelElevation(1, 93)
        self.fails(source, [], r"channel 1 \(its ChannelElevation\) is 93")
        self.fails(make("BeamSource", NumberOfChannels=2, MinimumElevation=80, ElevationStep=11), [],
                   "MinimumElevation .* is 91")
        self.fails(make("EchoFilter", Preset=0, RaysPerBeam=1000000, NumberOfReflections=2, NumberOfConnections=1000),
                   [beams(), surfaces()], "RaysPerBeam is 1000000")
        self.fails(make("EchoFilter", RaysPerBeam=70000, NumberOfConnections=2000000000), [beams(), surfaces()],
                   "NumberOfConnections")

    def test_arguments_of_methods(self):
        cover, colours = make("Coverage"), make("HSBColorMap")
        for algorithm, words, call in ((cover, "no entry 1000", lambda: cover.GetHeightLimit(1000)),
                                       (cover, "no entry -1", lambda: cover.GetHeightLimit(-1)),
                                       (colours, "no table", lambda: colours.FillLookupTable(None))):
            heard = Messages(algorithm)
            call()
            self.assertRegex("".join(heard.errors), words)

    def test_more_than_there_is_memory_for(self):
        """Noise that would drown the scan, and range units without number, are refused before they fill the memory."""
        loud, units = sensor(36, 2), sensor(36, 2)
        for source, values in ((loud, {"NoisePhotonRate": 1e15, "SamplingInterval": 1e-11, "PulseWidth": 0,
                                       "LowerEnergyLimit": 1e-18}),
                               (units, {"SamplingInterval": 1e-12, "PulseWidth": 1e-9, "RangeGate": 1e5})):
            given(source, **values).Update()
        self.fails(make("EchoFilter"), [loud.GetOutput(), surfaces()], "false alarms")
        echo = make("EchoFilter", RaysPerBeam=100000)
        self.fails(echo, [units.GetOutput(), surfaces()], "pulse_width", "RaysPerBeam", "range units")
        self.assertEqual(echo.GetNumberOfTreeBuilds(), 0)


class Legal(Faults):
    """What is odd, and no error."""

    def test_nothing(self):
        """Silence, and empty outputs; without surfaces each beam says so."""
        for data in (vtk.vtkPolyData(), vtk.vtkMultiBlockDataSet()):
            echo, tree = make("EchoFilter"), make("CollisionTree")
            self.assertEqual(self.warnings(echo, [beams(), data]) + self.warnings(tree, [data]), [])
            self.assertEqual((echo.GetOutput().GetNumberOfPoints(), tree.GetOutput().GetNumberOfCells()), NOTHING)
            self.assertEqual(echo.GetOutput(1).GetNumberOfPoints(), 72)
        none, echo = vtk.vtkPolyData(), make("EchoFilter")
        none.GetFieldData().PassData(spoil(beams(), "field", "lower_energy_limit", -1.0).GetFieldData())
        self.assertEqual((self.warnings(echo, [none, surfaces()]), echo.GetOutput().GetNumberOfPoints()), ([], 0))

    def test_suspicious_surfaces_are_a_warning_once(self):
        """And the same echoes as without what is suspicious."""
        lines = vtk.vtkLineSource()
        lines.Update()
        astray = vtk.vtkAppendPolyData()
        for part in (surfaces(), box((1e16, 0, 0), (1, 10, 10), "Wall")):
            astray.AddInputData(part)
        astray.Update()
        plain = surfaces()
        for name in COEFFICIENTS:
            plain.GetCellData().RemoveArray(name)
        for data, words, same in ((lines.GetOutput(), "Input port 1, surfaces: 2 points without a polygon",
                                   vtk.vtkPolyData()),
                                  (astray.GetOutput(), r"Input port 1, surfaces: points lie 1e\+16 m apart",
                                   surfaces()),
                                  (plain, "Wall.*Group Datasets", surfaces())):
            echo, usual = make("EchoFilter"), make("EchoFilter")
            said = self.warnings(echo, [beams(), data], [[beams(), data]])
            self.assertEqual(len(said), 1, said)
            self.assertRegex(said[0], words)
            self.warnings(usual, [beams(), same])
            self.assertEqual(echo.GetOutput().GetNumberOfPoints(), usual.GetOutput().GetNumberOfPoints())
        # Said again when a scene that had a material loses it.
        for algorithm, before in ((make("CollisionTree"), []), (make("EchoFilter"), [beams()])):
            self.assertEqual(self.warnings(algorithm, [*before, surfaces()]), [])
            self.assertRegex("".join(self.warnings(algorithm, [*before, plain])), "Wall")

    def test_single_precision_far_away(self):
        """Said once per scene, with what the points are rounded to."""
        def far(kind, distance):
            data, points = surfaces(), vtk.vtkPoints()
            points.SetDataType(kind)
            for i in range(data.GetNumberOfPoints()):
                points.InsertNextPoint(np.add(data.GetPoint(i), (0, distance, 0)))
            data.SetPoints(points)
            return data

        for algorithm, before in ((make("CollisionTree"), []), (make("EchoFilter"), [beams()])):
            near = [[*before, far(vtk.VTK_DOUBLE, 5e6)], [*before, far(vtk.VTK_FLOAT, 3e4)]]
            self.assertEqual(self.warnings(algorithm, *near[:1], near[1:]), [])
            bad = [*before, far(vtk.VTK_FLOAT, 5e6)]
            said = self.warnings(algorithm, bad, [bad])
            self.assertEqual(len(said), 1, said)
            self.assertRegex(said[0], r"single precision[\s\S]*5000000 m[\s\S]*0.5 m")

    def test_beams_of_anyones_making(self):
        """Points, directions of any length and type, and the sensor's field data are enough; azimuths lie in [0,
        36000)."""
        for kind, directions, count in (("f4", ((5, 0, 0), (0, 0.1, 0)), 1),
                                        ("f8", ((1e-307, 0, 0), (1.5e308, 1e307, 0)), 2)):
            own = cloud(np.zeros((2, 3)))
            add_array(own, "direction", np.array(directions, kind))
            own.GetFieldData().PassData(beams().GetFieldData())
            echo = make("EchoFilter")
            self.assertEqual(self.warnings(echo, [own, surfaces()]), [])
            self.assertEqual(echo.GetOutput().GetNumberOfPoints(), count)
            self.assertAlmostEqual(echo.GetOutput().GetPoint(0)[0], 49, delta=0.01)
            self.assertAlmostEqual(echo.GetOutput().GetPointData().GetArray("azimuth").GetValue(0), 9000, delta=1e-9)
        own.GetPointData().GetArray("direction").SetTuple3(0, -1e-17, 1, 0)
        echo = make("EchoFilter")
        self.warnings(echo, [own, box((0, 50, 0), (10, 1, 10), "Wall")])
        self.assertEqual(echo.GetOutput().GetPointData().GetArray("azimuth").GetValue(0), 0.0)

    def test_orientation_without_numbers(self):
        slits, text = copy_of(output(make("BeamSource", BeamOutline=1))), vtk.vtkStringArray()
        text.SetName("orientation")
        text.InsertNextValue("north")
        slits.GetFieldData().AddArray(text)
        self.fails(make("EchoFilter"), [slits, surfaces()],
                   r"port 0 \(beams\), field data 'orientation' holds no numbers")

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
        ids = [output.GetPartition(i, k).GetCellData().GetArray("material_id").GetValue(0) for i in range(2)
               for k in range(2)]
        self.assertEqual((ids[0], ids[2]), (ids[1], ids[3]))
        self.assertNotEqual(ids[0], ids[2])


TRIANGLES = ((0, 1, 2), (0, 2, 3))
KINDS = ("Verts", "Lines", "Polys", "Strips")
OFFSETS = "the offsets of its cells do not fit their points"


def cells_of(cells):
    array = vtk.vtkCellArray()
    for cell in cells:
        array.InsertNextCell(len(cell), cell)
    return array


def raw_cells(offsets, connectivity, kind):
    """Cells as a file or a script may give them, of 32 or 64 bits."""
    array = vtk.vtkCellArray()
    convert = numpy_to_vtkIdTypeArray if kind == np.int64 else numpy_to_vtk
    array.SetData(*(convert(np.array(values, dtype=kind), deep=True) for values in (offsets, connectivity)))
    return array


def wall(polys=TRIANGLES, points=((10, -5, -5), (10, 5, -5), (10, 5, 5), (10, -5, 5)), **others):
    """A wall 10 m away, of two triangles or with other cells."""
    data = vtk.vtkPolyData()
    if points:
        data.SetPoints(cloud(points).GetPoints())
    data.SetPolys(cells_of(polys))
    for kind, cells in others.items():
        getattr(data, "Set" + kind)(cells if isinstance(cells, vtk.vtkCellArray) else cells_of(cells))
    return data


def with_materials(data, **changes):
    """kd is a hundredth of the cell's number."""
    count = data.GetNumberOfCells()
    for name, values in {"kd": np.arange(count) / 100, "ks": np.full(count, 0.1), "kp": np.full(count, 50.0),
                         "object_id": np.arange(count, dtype=np.int32), **changes}.items():
        _cloud.add_array(data.GetCellData(), name, np.asarray(values))
    return data


class Cells(Faults):
    """Cells that are no area, lie where no points are, or begin where no cell is: what has no triangles counts for
    nothing, the rest is an error; and errors count the cells of the user's data."""

    def both_fail(self, data, *words):
        self.fails(make("CollisionTree"), [data], *words)
        self.fails(make("EchoFilter"), [beams(), data], *words)

    def assert_same_scene(self, data, expected):
        for name, inputs in (("EchoFilter", [sensor(8, 1)]), ("CollisionTree", [])):
            for source in inputs:
                source.Update()
            one, other = make(name), make(name)
            for algorithm, surface in ((one, data), (other, expected)):
                self.assertEqual(self.run_one(algorithm, [*(source.GetOutput() for source in inputs), surface])[0], [])
            if name == "EchoFilter":
                assert_same_bits(one.GetOutput(), other.GetOutput())
            self.assertEqual(one.GetOutput().GetNumberOfCells(), other.GetOutput().GetNumberOfCells())
        for array in ("kd", "object_id"):
            np.testing.assert_array_equal(*(vtk_to_numpy(a.GetOutput().GetCellData().GetArray(array))
                                            for a in (one, other)))

    def test_cells_of_few_points_have_no_triangles(self):
        for short in ((), (0,), (0, 1)):
            self.assert_same_scene(wall((short,) + TRIANGLES, Verts=[short], Lines=[short], Strips=[short]), wall())
            self.assert_same_scene(wall([short], Strips=[short]), wall([]))
        self.assert_same_scene(wall([()], None, Strips=[()]), wall([]))
        self.both_fail(wall(TRIANGLES, None), "its cells have points, and there are none")

    def test_numbers_of_cells_go_on_over_short_ones(self):
        short = with_materials(wall([(0,), (0, 1, 2), (), (0, 2, 3)], Strips=[(), (1, 2, 3), (0, 1)], Lines=[(0, 1)]))
        tree = make("CollisionTree")
        self.run_one(tree, [short])
        np.testing.assert_array_equal(vtk_to_numpy(tree.GetOutput().GetCellData().GetArray("kd")), np.array([2, 4, 6])
                                      / 100)

    def test_offsets_and_point_ids_that_are_none(self):
        """Of the Material filter, too: without offsets VTK counts -1 cells."""
        bad = {"beyond": [0, 3, 7], "down": [0, 5, 3, 6], "negative": [0, -3, 3, 6], "not from 0": [3, 6],
               "short": [0, 3], "none": []}
        for bits in (np.int32, np.int64):
            for kind in KINDS:
                for name, offsets in bad.items():
                    with self.subTest(kind=kind, bits=bits, offsets=name):
                        self.both_fail(wall(**{kind: raw_cells(offsets, [0, 1, 2, 0, 2, 3], bits)}), OFFSETS)
            for kind in ("Polys", "Strips"):
                for point in (-1, 4):
                    with self.subTest(kind=kind, bits=bits, point=point):
                        self.both_fail(wall(**{kind: raw_cells([0, 3], [0, 1, point], bits)}),
                                       "a cell has a point id outside 0 to 3")
        for kind in KINDS:
            self.fails(make("Material"), [wall(**{kind: raw_cells([], [0, 1, 2], np.int64)})], "Input port 0.*"
                       + OFFSETS)

    def test_arrays_of_other_layouts(self):
        """One array for each component, and single bits: the same scene as from arrays of the usual kind."""
        other = with_materials(wall())
        points = vtk.vtkSOADataArrayTemplate["float32"]()
        points.DeepCopy(other.GetPoints().GetData())
        other.GetPoints().SetData(points)
        for array, name in ((vtk.vtkSOADataArrayTemplate["float64"](), "kd"), (vtk.vtkBitArray(), "object_id")):
            array.DeepCopy(other.GetCellData().GetArray(name))
            array.SetName(name)
            other.GetCellData().AddArray(array)
        self.assert_same_scene(other, with_materials(wall()))

    def test_errors_count_cells_as_the_user_does(self):
        """Not the triangles that polygons and strips are made into, nor what is left without lines and ghosts."""
        quads = [(0, 1, 2, 3)] * 5
        for data, cell in ((wall(quads, Lines=[(0, 1)] * 3), 6), (wall(quads, Strips=[(0, 1, 3, 2)] * 2), 6),
                           (wall([(0,), (), (0, 1, 2, 3, 0), (0, 1, 2)]), 3)):
            for name, value in (("kd", -0.5), ("ks", 1.5), ("kp", NAN), ("object_id", 1e12)):
                values = np.full(data.GetNumberOfCells(), 0.0 if name == "object_id" else 0.1)
                values[cell] = value
                self.both_fail(with_materials(data, **{name: values}), f"surfaces: cell {cell}: .*{name}")

    def test_materials_of_what_is_not_there(self):
        """Ghosts, lines and cells without triangles may have any: nothing is made of them."""
        data = with_materials(wall(TRIANGLES + ((0, 1), (0, 1, 2)), Lines=[(0, 1)]))
        _cloud.add_array(data.GetCellData(), vtk.vtkDataSetAttributes.GhostArrayName(),
                         np.array([0, 0, 0, 0, 1], np.uint8))
        for cell in (0, 3, 4):
            data.GetCellData().GetArray("kd").SetValue(cell, -1.0)
        self.assertEqual(self.warnings(make("CollisionTree"), [data]), [])
        data.GetCellData().GetArray("kd").SetValue(2, -1.0)
        self.both_fail(data, "cell 2: kd")
