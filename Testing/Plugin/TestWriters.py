# SPDX-License-Identifier: BSD-3-Clause
"""Save Data and Open File: every format is written and read through its proxies, and says what the class says.

Run by pvpython in one process and by pvbatch on two ranks (the argument), where the first rank gathers and writes."""

import os
import sys
import unittest

import avianlidar.vtkAvianLidar as module
import numpy
from avianlidar._suffixes import WRITERS
from paraview import servermanager, simple

from plugin_testing import OUTPUT_DIR, airport, fetch, load_plugin

RANKS = int(sys.argv.pop()) if len(sys.argv) > 1 and sys.argv[-1].isdigit() else 1
# Properties of each class: (unit that the help says, choices).
CONTRACT = {
    "LASWriter": {
        "CoordinateSystem": ("metres", ["UTM", "Geocentric", "Local"]), "UTMZone": ("", None), "SourceId": ("", None),
        "WriteAllArrays": ("", None),
    },
    "PCDWriter": {
        "FileType": ("", ["Binary", "ASCII"]), "Organisation": ("", ["Automatic", "Organised", "List"]),
        "Precision": ("metres", ["Single", "Double"]),
    },
    "PLYWriter": {"FileType": ("", ["Binary", "ASCII"]), "Precision": ("metres", ["Single", "Double"])},
    "KITTIWriter": {"WriteLabels": ("", None), "LabelSource": ("", ["ObjectClass", "Material"])},
    "GeoJSONWriter": {"UseFieldDataLimit": ("joules", None), "MinimumEnergy": ("joules", None)},
}
ENDINGS = {name[len("vtkAvianLidar"):]: suffix[1:] for suffix, name in reversed(WRITERS.items())}  # the first of each


def path(ending):
    return os.path.join(OUTPUT_DIR, f"TestWriters-{RANKS}.{ending}")


def words(name):
    special = {"UTMZone": "UTM Zone"}
    return special.get(name) or "".join(" " + c if c.isupper() else c for c in name).strip()


def domain_of(smproperty, kind):
    iterator = smproperty.NewDomainIterator()
    iterator.UnRegister(None)
    iterator.Begin()
    while not iterator.IsAtEnd():
        if iterator.GetDomain().IsA(kind):
            return iterator.GetDomain()
        iterator.Next()
    return None


class TestWriters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scene, cls.tree, cls.beams, cls.echoes = airport(columns=240, RaysPerBeam=20)
        cls.echoes.UpdatePipeline()
        cls.expected = fetch(cls.echoes)

    def save(self, ending, **options):
        simple.SaveData(path(ending), proxy=self.echoes, **options)
        self.assertTrue(os.path.exists(path(ending)))

    def open(self, ending):
        reader = simple.OpenDataFile(path(ending))
        self.assertEqual(reader.SMProxy.GetVTKClassName(), "vtkAvianLidarPointCloudReader")
        got = fetch(reader)
        simple.Delete(reader)
        os.remove(path(ending))
        return got

    def test_las(self):
        for system in ("UTM", "Geocentric", "Local"):
            self.save("las", CoordinateSystem=system)
            got = self.open("las")
            numpy.testing.assert_allclose(got["points"], self.expected["points"], rtol=0, atol=2e-6)
            for name in ("energy", "distance_m", "object_id", "beam_id"):
                numpy.testing.assert_array_equal(got[name], self.expected[name], name)

    def test_pcd(self):
        for kind in ("Binary", "ASCII"):
            self.save("pcd", FileType=kind, Precision="Double")
            got = self.open("pcd")
            numpy.testing.assert_array_equal(got["points"], self.expected["points"])
            numpy.testing.assert_array_equal(got["energy"], self.expected["energy"])

    def test_ply(self):
        for kind in ("Binary", "ASCII"):
            self.save("ply", FileType=kind, Precision="Double")
            got = self.open("ply")
            numpy.testing.assert_array_equal(got["points"], self.expected["points"])
            numpy.testing.assert_array_equal(got["energy"], self.expected["energy"])

    def test_a_mesh_stays_one(self):
        """ParaView takes our writer for it, by the name, and its own reader."""
        sphere = simple.Sphere()
        simple.SaveData(path("ply"), proxy=sphere)
        reader = simple.OpenDataFile(path("ply"))
        self.assertEqual(reader.SMProxy.GetXMLName(), "PLYReader")
        reader.UpdatePipeline()
        self.assertEqual(reader.GetDataInformation().GetNumberOfCells(), 96)
        for proxy in (reader, sphere):
            simple.Delete(proxy)
        os.remove(path("ply"))

    def test_field_data_come_through(self):
        """Of all ranks together: the organised grid, the sensor's frame and the origin are in field data."""
        self.save("pcd", Organisation="Organised")
        with open(path("pcd"), "rb") as file:
            lines = [next(file) for _ in range(12)]
        for line in (b"WIDTH 240\n", b"HEIGHT 16\n", b"VIEWPOINT 0 0 3 1 0 0 0\n"):
            self.assertIn(line, lines)
        os.remove(path("pcd"))

    def test_kitti(self):
        self.save("bin")
        self.assertTrue(os.path.exists(path("label")))
        points = numpy.fromfile(path("bin"), dtype="<f4").reshape(-1, 4)
        instances = numpy.fromfile(path("label"), dtype="<u4") >> 16
        reader = simple.OpenDataFile(path("bin"))
        reader.UpdatePipeline()
        self.assertEqual(reader.GetDataInformation().GetNumberOfPoints(), len(points))
        self.assertIsNotNone(reader.PointData["semantic_label"])
        simple.Delete(reader)
        os.remove(path("bin"))
        os.remove(path("label"))
        expected = self.expected["points"] - (0, 0, 3)
        self.assertEqual(len(points), len(expected))
        numpy.testing.assert_allclose(sorted(points[:, 0]), sorted(expected[:, 1]), rtol=1e-6)
        numpy.testing.assert_allclose(sorted(points[:, 1]), sorted(-expected[:, 0]), rtol=1e-6)
        self.assertEqual(sorted(instances), sorted(self.expected["object_id"] + 1))

    def test_geojson(self):
        limit = float(numpy.median(self.expected["energy"]))
        self.save("geojson", UseFieldDataLimit=0, MinimumEnergy=limit)
        with open(path("geojson"), encoding="utf-8") as file:
            count = file.read().count('"Feature"')
        os.remove(path("geojson"))
        self.assertEqual(count, (self.expected["energy"] >= limit).sum())

    def test_csv_with_units(self):
        named = simple.AvianLidarUnitNames(Input=self.echoes)
        name = path("csv")
        simple.SaveData(name, proxy=named, Precision=15)
        # On several ranks the CSV writer of ParaView, too, writes one file.
        with open(name, encoding="ascii") as file:
            header, *rows = file.read().splitlines()
        os.remove(name)
        columns = [one.strip('"') for one in header.split(",")]
        self.assertIn("energy [J]", columns)
        values = numpy.array([float(row.split(",")[columns.index("energy [J]")]) for row in rows])
        numpy.testing.assert_allclose(sorted(values), sorted(self.expected["energy"]), rtol=1e-14)
        simple.Delete(named)

    def test_series(self):
        """A file for every step, where the name says, with a folder or without; not in the root folder, say."""
        beams = simple.AvianLidarAirport16(Position=[0, 0, 3], AzimuthStep=6, StepsPerRevolution=2)
        echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=self.tree, RaysPerBeam=5)
        echoes.UpdatePipeline(0)
        folder = os.path.abspath(os.path.join(OUTPUT_DIR, f"TestWritersSeries-{RANKS}"))
        before = os.getcwd()
        os.makedirs(os.path.join(folder, "sub"), exist_ok=True)
        os.chdir(folder)
        self.addCleanup(os.chdir, before)
        for ending in (*ENDINGS.values(), *["laz"] * int(os.environ["AVIANLIDAR_LASZIP"])):
            for name in ("bare", "sub/inner", "./here", os.path.join(folder, "whole")):
                for steps in (True, False):
                    simple.SaveData(f"{name}.{ending}", proxy=echoes, WriteTimeSteps=steps)
                    files = [f"{name}_{step}.{ending}" for step in range(2)] if steps else [f"{name}.{ending}"]
                    sizes = [os.path.getsize(file) for file in files]
                    if steps:
                        self.assertGreater(sizes[1], sizes[0], files)  # the whole scan
                    for file in files:
                        os.remove(file)
        simple.Delete(echoes)
        simple.Delete(beams)

    def test_proxies(self):
        for name, properties in CONTRACT.items():
            writer = getattr(servermanager.writers, "AvianLidar" + name)(Input=self.echoes)
            instance = getattr(module, "vtkAvianLidar" + name)()
            smproxy = writer.SMProxy
            self.assertEqual(smproxy.GetXMLLabel().replace(" ", ""), "AvianLidar" + name)
            documentation = smproxy.GetDocumentation()
            for text in (documentation.GetDescription(), documentation.GetShortHelp(), documentation.GetLongHelp()):
                self.assertGreater(len(" ".join((text or "").split())), 20, name)
            factory = smproxy.GetHints().FindNestedElementByName("WriterFactory")
            self.assertEqual(factory.GetAttribute("extensions"), "las laz" if name == "LASWriter" else ENDINGS[name])
            for prop, (unit, choices) in properties.items():
                smproperty = smproxy.GetProperty(prop)
                self.assertIsNotNone(smproperty, prop)
                self.assertEqual(smproperty.GetXMLLabel(), words(prop))
                self.assertEqual(smproperty.GetElement(0), getattr(instance, "Get" + prop)(), prop)
                help_text = " ".join(smproperty.GetDocumentation().GetDescription().split())
                self.assertGreater(len(help_text), 20)
                self.assertIn(unit, help_text)
                enumeration = domain_of(smproperty, "vtkSMEnumerationDomain")
                if choices:
                    texts = [enumeration.GetEntryText(i) for i in range(enumeration.GetNumberOfEntries())]
                    self.assertEqual(texts, choices)
                    for i, text in enumerate(texts):
                        getattr(instance, f"Set{prop}To{text}")()
                        self.assertEqual(getattr(instance, "Get" + prop)(), enumeration.GetEntryValue(i))
                else:
                    self.assertIsNotNone(domain_of(smproperty, "vtkSMDomain"), prop)


if __name__ == "__main__":
    load_plugin()
    if RANKS == 1:
        unittest.main()
    else:
        # An exception on one of several ranks ends the job by itself; sys.exit() would not wait for the others.
        result = unittest.TextTestRunner().run(unittest.defaultTestLoader.loadTestsFromTestCase(TestWriters))
        assert result.wasSuccessful()
