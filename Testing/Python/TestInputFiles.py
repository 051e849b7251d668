# SPDX-License-Identifier: BSD-3-Clause
"""What scenes and clouds are read from: regular files of any folder, and nothing else. No pipe, which would wait for
ever, no device, which would not end, and never the network."""
import ctypes
import gzip
import json
import multiprocessing
import os
import pathlib
import socket
import subprocess
import sys
import tempfile
import threading
import unittest

import scenetools as st
from avianlidar import _suffixes, vtkAvianLidar as wrapped
from cloudtools import cloud

SQUARE = [[0, 0], [0.001, 0], [0.001, 0.001], [0, 0.001], [0, 0]]
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
GROUND = {"ground": {"size": 10}}


def plan(crs=None):
    features = [{"type": "Feature", "properties": {}, "geometry": {"type": "Polygon", "coordinates": [SQUARE]}}]
    return json.dumps({"type": "FeatureCollection", "features": features, **({"crs": crs} if crs else {})})


def gml(encoding, doctype, url, inside, name):
    return (f'<?xml version="1.0" encoding="{encoding}"?>{doctype}<ogr:FeatureCollection '
            'xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance" xmlns:ogr="http://ogr.maptools.org/" '
            f'xsi:schemaLocation="http://ogr.maptools.org/ {url}/x.xsd" xmlns:gml="http://www.opengis.net/gml" '
            f'xmlns:xlink="http://www.w3.org/1999/xlink"><gml:featureMember><ogr:x fid="1"><ogr:geometryProperty {inside}>'
            f'<gml:Polygon srsName="{name}"><gml:outerBoundaryIs><gml:LinearRing><gml:coordinates>0,0 0.001,0 0.001,0.001 '
            '0,0</gml:coordinates></gml:LinearRing></gml:outerBoundaryIs></gml:Polygon></ogr:geometryProperty></ogr:x>'
            '</gml:featureMember></ogr:FeatureCollection>')


def gltf(uri):
    return json.dumps({
        "asset": {"version": "2.0"}, "buffers": [{"uri": uri, "byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}]})


def multiblock(file):
    return ('<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>'
            f'<DataSet index="0" file="{file}"/></vtkMultiBlockDataSet></VTKFile>')


def scene(*objects):
    return json.dumps({"version": 1, "origin": {"latitude": 0, "longitude": 0, "height": 0}, "material_map": {"*": "Wall"},
                       "objects": list(objects)})


# Reads one file in a process of its own, with little memory: what is to be shown may wait for ever, or never end.
CHILD = """
import resource, sys
resource.setrlimit(resource.RLIMIT_AS, (4 << 30, 4 << 30))
from avianlidar import vtkAvianLidar as wrapped
from echotools import Messages
kind = wrapped.vtkAvianLidarSceneReader if sys.argv[1].endswith(".json") else wrapped.vtkAvianLidarPointCloudReader
reader = kind()
heard = Messages(reader)
reader.SetFileName(sys.argv[1])
reader.Update()
print(len(heard.errors), " ".join(heard.errors))
"""


def serve(listener, requests):
    """Answers that nothing is there, and counts."""
    while True:
        connection, _ = listener.accept()
        with requests.get_lock():
            requests.value += 1
        connection.recv(1000)
        connection.sendall(b"HTTP/1.0 404 none\r\n\r\n")
        connection.close()


class InputFiles(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)
        (self.folder / "plan.geojson").write_text(plan())
        (self.folder / "m.obj").write_text(TRIANGLE)

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return str(self.folder / name)

    def child(self, file, **options):
        path = os.pathsep.join([os.path.dirname(os.path.abspath(__file__)), os.environ.get("PYTHONPATH", "")])
        ended = subprocess.run([sys.executable, "-c", CHILD, file], env={**os.environ, "PYTHONPATH": path}, timeout=20,
                               capture_output=True, text=True, check=False, **options)
        self.assertEqual(ended.returncode, 0, ended.stderr)
        return ended.stdout

    def assert_refused(self, file, words="no regular file"):
        with self.subTest(file=file):
            try:
                said = self.child(file)
            except subprocess.TimeoutExpired:
                self.fail("it waits for ever")
            self.assertEqual(said.split()[0], "1", said)
            self.assertIn(words, said)

    def make(self, kind, name):
        """A pipe, a device without an end, or a folder of that name."""
        if kind == "pipe":
            os.mkfifo(name)
        elif kind == "device":
            os.symlink("/dev/zero", name)
        else:
            os.mkdir(name)

    def test_neither_pipes_nor_devices(self):
        for kind in ("pipe", "device"):
            self.make(kind, kind + ".lidarscene.json")
            self.assert_refused(str(self.folder / (kind + ".lidarscene.json")))
            for ending in _suffixes.READERS:
                self.make(kind, kind + ending)
                self.assert_refused(str(self.folder / (kind + ending)))
                self.assertEqual(wrapped.vtkAvianLidarPointCloudReader().CanReadFile(kind + ending), 0)
            for ending in (".obj", ".obj.gz", ".vtp", ".vtk"):
                self.make(kind, kind + ending)
                self.assert_refused(self.write("s.lidarscene.json", scene({"file": kind + ending})))
            for ending in (".geojson", ".shp", ".osm"):
                self.make(kind, kind + ending)
                self.assert_refused(self.write("s.lidarscene.json", scene({"footprints": kind + ending, "height": 3})))

    def test_what_a_file_names(self):
        """Materials, buffers, parts and neighbours."""
        for kind in ("pipe", "device"):
            for ending in (".mtl", ".bin", ".vtp"):
                self.make(kind, kind + ending)
            self.write("n.obj", f"mtllib {kind}.mtl\n" + TRIANGLE)
            said = self.child(self.write("s.lidarscene.json", scene({"file": "n.obj"})))
            self.assertEqual(said.split()[0], "0", said)  # a mesh without its materials
            self.write("n.gltf", gltf(kind + ".bin"))
            self.assert_refused(self.write("s.lidarscene.json", scene({"file": "n.gltf"})), "could not open")
            self.write("n.vtm", multiblock(kind + ".vtp"))
            self.assert_refused(self.write("s.lidarscene.json", scene({"file": "n.vtm"})))
            self.write("n.vtm", multiblock("n.vtm"))
            self.assert_refused(self.write("s.lidarscene.json", scene({"file": "n.vtm"})), "expected .vtp")
            self.write(kind + "2.geojson", plan())
            self.make(kind, kind + "2.prj")
            self.assert_refused(self.write("s.lidarscene.json", scene({"footprints": kind + "2.geojson", "height": 3})))

    def test_a_folder_that_cannot_be_listed(self):
        """Its files can be opened by name, so they are read; neighbours are still looked at."""
        nobody = {"user": 65534, "group": 65534, "extra_groups": ()} if os.geteuid() == 0 else {}
        if nobody and subprocess.run([sys.executable, "-c", "from avianlidar import vtkAvianLidar"], check=False,
                                     capture_output=True, **nobody).returncode:
            self.skipTest("another user cannot load the library")
        file = self.write("s.lidarscene.json", scene({"footprints": "plan.geojson", "height": 3}))
        self.folder.chmod(0o711 if nobody else 0o311)
        self.addCleanup(self.folder.chmod, 0o700)
        said = self.child(file, **nobody)
        self.assertEqual(said.split()[0], "0", said)
        os.mkfifo("plan.prj")
        said = self.child(file, **nobody)
        self.assertIn("belongs together with plan.prj, and it is no regular file", said)

    def test_grids_of_a_reference_system(self):
        os.mkfifo("grid")
        for crs in (f"+proj=longlat +nadgrids={self.folder}/grid", f"+proj=longlat +nadgrids=@{self.folder}/grid +type=crs",
                    f"+proj=longlat +geoidgrids={self.folder}/grid"):
            for thing in ({"footprints": "plan.geojson", "height": 3}, {"file": "m.obj"}):
                self.assert_refused(self.write("s.lidarscene.json", scene({**thing, "crs": crs})), "grid")

    def test_regular_files_of_any_folder(self):
        """Links to them, too."""
        with tempfile.TemporaryDirectory() as elsewhere:
            pathlib.Path(elsewhere, "far.obj").write_text(TRIANGLE)
            os.symlink(os.path.join(elsewhere, "far.obj"), "link.obj")
            os.symlink("plan.geojson", "link.geojson")
            file = self.write("s.lidarscene.json", scene(
                {"file": os.path.join(elsewhere, "far.obj")}, {"file": os.path.relpath(os.path.join(elsewhere, "far.obj"))},
                {"file": "link.obj"}, {"footprints": "link.geojson", "height": 3}, {"file": "m.obj", "crs": "EPSG:3857"}))
            os.symlink(file, "link.lidarscene.json")
            for name in (file, "link.lidarscene.json"):
                read = st.Read(name)
                self.assertEqual(read.errors, [])
                self.assertEqual(len(read.names), 5)
        writer = wrapped.vtkAvianLidarPCDWriter()
        writer.SetInputData(cloud([(1, 2, 3)]))
        writer.SetFileName("a.pcd")
        self.assertEqual(writer.Write(), 1)
        os.symlink("a.pcd", "b.pcd")
        reader = wrapped.vtkAvianLidarPointCloudReader()
        reader.SetFileName("b.pcd")
        reader.Update()
        self.assertEqual(reader.GetOutput().GetNumberOfPoints(), 1)

    def test_compressed_files_as_they_are_now(self):
        """Damaged, mended, and edited, all under one name; nothing is written beside them."""
        far_plan = plan().replace("0.001", "0.002")
        # More than one block of GDAL's, and a format whose reader looks for the end of the file.
        comments = "# nothing\n" * 30000
        cases = (("m.obj.gz", "file", comments + TRIANGLE, comments + TRIANGLE.replace("1", "2", 1)),
                 ("plan.geojson.gz", "footprints", plan(), far_plan),
                 ("plan.csv.gz", "footprints", 'WKT,a\n"POLYGON((0 0,0 1,1 1,0 0))",1\n',
                  'WKT,a\n"POLYGON((0 0,0 2,2 2,0 0))",1\n'))
        for name, key, text, edited in cases:
            self.assertEqual(len(text), len(edited))
            more = {"height": 3, "crs": "EPSG:4326"} if key == "footprints" else {}
            file = self.write("s.lidarscene.json", scene({key: name, **more}))
            good = gzip.compress(text.encode(), 0)  # stored, so that the damage is where it is wanted

            def read(content):
                (self.folder / name).write_bytes(content)
                return st.Read(file)

            with self.subTest(name):
                want = read(good)
                self.assertEqual(want.errors, [])
                broken_block, broken_sum = bytearray(good), bytearray(good)
                broken_block[11] ^= 0xFF  # its length
                broken_sum[-6] ^= 0xFF
                for damaged in (broken_block, broken_sum, good[:-20], good[:30]):
                    self.assertIn(name, read(damaged).errors[0])
                    again = read(good)
                    self.assertEqual(again.errors, [])
                    self.assertEqual(again.blocks[0].GetBounds(), want.blocks[0].GetBounds())
                for level in (0, 9):  # the same size, another
                    other = read(gzip.compress(edited.encode(), level))
                    self.assertEqual(other.errors, [])
                    ends, ends_before = other.blocks[0].GetBounds()[1], want.blocks[0].GetBounds()[1]
                    self.assertAlmostEqual(ends, 2 * ends_before, delta=1e-3 * ends)
                    self.assertEqual(read(good).errors, [])
        self.assertEqual([one for one in os.listdir() if one.endswith(".properties")], [])

    def files_that_ask(self, url):
        """Files by name, and the object of a scene that uses each."""
        link = {"type": "link", "properties": {"href": url + "/crs", "type": "proj4"}}
        doctype = f'<!DOCTYPE x SYSTEM "{url}/x.dtd">'
        inside = f'xlink:href="{url}/x.xml#1"'
        vrt = "<OGRVRTDataSource><OGRVRTLayer name='plan'><SrcDataSource>{}</SrcDataSource>{}</OGRVRTLayer></OGRVRTDataSource>"
        plans = {
            "link.geojson": plan(link),
            "name.geojson": plan({"type": "name", "properties": {"name": url + "/crs"}}),
            "next.geojson": json.dumps({"type": "FeatureCollection", "features": [], "links": [{"rel": "next", "href": url}]}),
            "source.vrt": vrt.format(f"/vsicurl/{url}/x.geojson", ""),
            "system.vrt": vrt.format("plan.geojson", f"<LayerSRS>{url}/crs</LayerSRS>"),
            "wfs.xml": f"<OGRWFSDataSource><URL>{url}/wfs</URL></OGRWFSDataSource>",
            "wms.xml": f"<GDAL_WMS><Service name='TMS'><ServerUrl>{url}</ServerUrl></Service></GDAL_WMS>",
            "plain.gml": gml("utf-8", "", url, "", "EPSG:4326"),
            "system.gml": gml("utf-8", "", url, "", url + "/crs"),
            "types.gml": gml("ISO-8859-15", doctype, url, inside, "EPSG:4326"),
            "cards.gml": gml("EBCDIC-CP-US", doctype, url, inside, "EPSG:4326"),
            "link.kml": f'<kml xmlns="http://www.opengis.net/kml/2.2"><Document><NetworkLink><Link><href>{url}/x.kml</href>'
                        f"</Link></NetworkLink><Placemark><styleUrl>{url}/s.kml#s</styleUrl><Polygon><outerBoundaryIs>"
                        "<LinearRing><coordinates>0,0 0.001,0 0.001,0.001 0,0</coordinates></LinearRing></outerBoundaryIs>"
                        "</Polygon></Placemark></Document></kml>"}
        meshes = {
            "m1.obj": f"mtllib /vsicurl/{url}/x.mtl\nmtllib {url}/x.mtl\n" + TRIANGLE,
            "m2.gltf": gltf(url + "/b.bin"), "m3.gltf": gltf(f"/vsicurl/{url}/b.bin"),
            "m4.vtm": multiblock(url + "/x.vtp"),
            "m5.dae": f'<?xml version="1.0"?>{doctype}<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" '
                      f'version="1.4.1"><scene><instance_visual_scene url="{url}/x"/></scene></COLLADA>',
            "m6.x3d": f'<X3D><Scene><Inline url="{url}/x.x3d"/></Scene></X3D>'}
        for name, text in {**plans, **meshes}.items():
            self.write(name, text)
        objects = [{"footprints": name, "height": 3} for name in plans] + [{"file": name} for name in meshes]
        for place in (url + "/crs", "/vsicurl/" + url, "/vsicurl/" + url + "/crs.prj"):
            objects += [{"file": place}, {"footprints": place, "height": 3}]
        for crs in (url + "/crs", "/vsicurl/" + url, f"+proj=longlat +nadgrids={url}/g.tif",
                    f"+proj=longlat +nadgrids=@{url}/g.tif", "+init=" + url, "urn:ogc:def:crs:" + url, "OGC:" + url):
            objects += [{"footprints": "plan.geojson", "height": 3, "crs": crs}, {"file": "m.obj", "crs": crs}]
        return objects

    def test_nobody_is_asked_over_the_network(self):
        # Even where users want PROJ to fetch its grids for other programs.
        for name, value in (("PROJ_NETWORK", "ON"), ("GDAL_HTTP_TIMEOUT", "5"), ("GDAL_HTTP_MAX_RETRY", "0")):
            os.environ[name] = value
        requests = multiprocessing.Value("i", 0)
        with socket.create_server(("127.0.0.1", 0)) as listener:
            server = multiprocessing.Process(target=serve, args=(listener, requests), daemon=True)
            server.start()
            url = f"http://127.0.0.1:{listener.getsockname()[1]}"
            for asking in self.files_that_ask(url):
                with self.subTest(asking):
                    before = requests.value
                    st.Read(self.write("s.lidarscene.json", scene(asking)))
                    self.assertEqual(requests.value - before, 0)
            # The server hears whoever asks.
            before = requests.value
            with socket.create_connection(listener.getsockname()) as connection:
                connection.sendall(b"GET / HTTP/1.0\r\n\r\n")
                self.assertIn(b"404", connection.recv(100))
            self.assertEqual(requests.value - before, 1)
            server.terminate()

    def test_settings_of_gdal_are_as_before(self):
        """PROJ's switch is of the whole process: off until the last of two readings at the same time has ended."""
        file = self.write("s.lidarscene.json", scene({"file": "m.obj"}, {"file": "m.obj", "crs": "EPSG:3857"}))
        st.Read(file)
        with open("/proc/self/maps", encoding="utf-8") as maps:
            gdal = ctypes.CDLL(next(line.split()[-1] for line in maps if "libgdal" in line))
        option = gdal.CPLGetThreadLocalConfigOption
        option.restype = ctypes.c_char_p
        options = {b"CPL_VSIL_CURL_ALLOWED_FILENAME": b"mine", b"CPL_VSIL_GZIP_SAVE_INFO": None,
                   b"CPL_VSIL_GZIP_WRITE_PROPERTIES": b"YES"}
        for name, value in options.items():
            gdal.CPLSetThreadLocalConfigOption(name, value)
            self.addCleanup(gdal.CPLSetThreadLocalConfigOption, name, None)
        self.addCleanup(gdal.OSRSetPROJEnableNetwork, gdal.OSRGetPROJEnableNetwork())
        gdal.OSRSetPROJEnableNetwork(1)
        second_reads, first_ended, seen = threading.Event(), threading.Event(), []

        def read(within):
            reader = wrapped.vtkAvianLidarSceneReader()
            reader.SetFileName(file)
            waits = []

            def progress(*_):
                if not waits and option(b"CPL_VSIL_CURL_ALLOWED_FILENAME", None) == b"none":  # within the reading
                    waits.append(True)
                    within()

            reader.AddObserver("ProgressEvent", progress)
            reader.Update()
            self.assertEqual(waits, [True])

        def second():
            second_reads.set()
            first_ended.wait(20)
            seen.append(gdal.OSRGetPROJEnableNetwork())

        other = threading.Thread(target=read, args=(second,))
        read(lambda: (other.start(), second_reads.wait(20)))
        seen.append(gdal.OSRGetPROJEnableNetwork())
        first_ended.set()
        other.join()
        self.assertEqual(seen, [0, 0])
        self.assertEqual(gdal.OSRGetPROJEnableNetwork(), 1)
        self.assertEqual({name: option(name, None) for name in options}, options)

    def test_reasons(self):
        """What was not fetched, and which formats are not read, is said."""
        url = "http://127.0.0.1:9/crs"
        self.write("link.geojson", plan({"type": "link", "properties": {"href": url, "type": "proj4"}}))
        self.write("plan.vrt", "<OGRVRTDataSource><OGRVRTLayer name='plan'><SrcDataSource>plan.geojson</SrcDataSource>"
                               "</OGRVRTLayer></OGRVRTDataSource>")
        for asking, words in (({"footprints": "link.geojson", "height": 3}, url + " is not fetched"),
                              ({"footprints": "plan.vrt", "height": 3}, "GDAL cannot read it"),
                              ({"file": "m.obj", "crs": url}, "unknown coordinate reference system")):
            read = st.Read(self.write("s.lidarscene.json", scene(asking)))
            self.assertEqual(len(read.errors), 1)
            self.assertIn(words, read.errors[0])


if __name__ == "__main__":
    unittest.main()
