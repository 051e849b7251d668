# SPDX-License-Identifier: BSD-3-Clause
"""`avianlidar airport`: extracts and terrains that the tests write, areas and heights against closed forms, an
ellipsoid's curve, edits that stay, extracts that are wrong; extracts of real airports, where the data folder is
there."""
import itertools
import json
import os
import pathlib
import re
import shutil
import unittest
import unittest.mock
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
from osgeo import gdal

import avianlidar as al
import exampletools
import helpertools
import scenetools
from avianlidar import _look, siting
from avianlidar._cloud import field_values
from avianlidar._command import parser
from avianlidar.apps.airport import _ground, _pages as airport_pages, _write as airport
from avianlidar.apps.airport._map import AirportMap
from avianlidar.apps.inputs._json import packaged
from avianlidar.apps.places._gdal import coordinate_system

DATA = os.environ.get("AVIANLIDAR_DATA_DIR", "")
HERE = (53.6, 13.3, 0.0)  # latitude, longitude, height
FOLDER = pathlib.Path(exampletools.OUTPUT) / "TestAirport"
KNOWN = packaged("places/airport.json")
gdal.UseExceptions()


def fresh(name):
    folder = FOLDER / name
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    return folder


def run(*words):
    """The exit code of the command, and what it says on both streams."""
    code, *said = helpertools.run(*words)
    return code, "".join(said)


def made(name, file, *words):
    """The folder that the command makes of an extract, and what it says."""
    folder = fresh(name)
    code, said = run("airport", file, *words, "-o", folder)
    assert code == 0, said
    return folder, said


# What an eye without the cones of long, and of middle wavelengths sees of light in linear sRGB: Machado, Oliveira and
# Fernandes, IEEE TVCG 15(6), 2009, severity 1.
EYES = {"all": np.eye(3), "without long": np.array([(0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216),
                                                    (-0.003882, -0.048116, 1.051998)]),
        "without middle": np.array([(0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413),
                                    (-0.011820, 0.042940, 0.968881)])}


def lab(colour, eye):
    """CIELAB of a colour #rrggbb of sRGB, in the light D65 (CIE 15:2004; IEC 61966-2-1)."""
    levels = np.array([int(colour[i:i + 2], 16) / 255 for i in (1, 3, 5)])
    light = np.clip(EYES[eye] @ np.where(levels <= 0.04045, levels / 12.92, ((levels + 0.055) / 1.055) ** 2.4), 0, 1)
    xyz = [(0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505)] @ light / (0.9505, 1.0, 1.0890)
    x, y, z = np.where(xyz > (6 / 29) ** 3, np.cbrt(xyz), xyz / (3 * (6 / 29) ** 2) + 4 / 29)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


class Map:
    """Raw OSM of things in metres about a place."""

    def __init__(self, about=HERE):
        self.about, self.rows, self.ways, self.relations, self.count = about, [], [], [], 0

    def _number(self):
        self.count += 1
        return self.count

    @staticmethod
    def _tags(tags):
        return "".join(f"<tag k={quoteattr(key.replace('__', ':'))} v={quoteattr(value)}/>"
                       for key, value in tags.items())

    def point(self, x, y, **tags):
        lon, lat, _ = siting.to_geodetic([(x, y, 0.0)], self.about)[0]
        number = self._number()
        self.rows.append(f'<node id="{number}" version="1" lat="{lat:.9f}" lon="{lon:.9f}">{self._tags(tags)}</node>')
        return number

    def way(self, points, closed=False, **tags):
        nodes = [self.point(*point) for point in points]
        number = self._number()
        self.ways.append(f'<way id="{number}" version="1">'
                         + "".join(f'<nd ref="{node}"/>' for node in nodes + nodes[:1] * closed) + self._tags(tags)
                         + "</way>")
        return number

    def area(self, low, high, **tags):
        (a, b), (c, d) = low, high
        return self.way([(a, b), (c, b), (c, d), (a, d)], True, **tags)

    def relation(self, outer, inner, **tags):
        members = [f'<member type="way" ref="{way}" role="{role}"/>'
                   for ways, role in ((outer, "outer"), (inner, "inner")) for way in ways]
        self.relations.append(
            f'<relation id="{self._number()}" '
            f'version="1">{"".join(members)}{self._tags({"type": "multipolygon", **tags})}</relation>')

    def write(self, name):
        FOLDER.mkdir(parents=True, exist_ok=True)
        file = FOLDER / name
        file.write_text('<?xml version="1.0"?><osm version="0.6">' + "".join(self.rows + self.ways + self.relations)
                        + "</osm>", "utf-8")
        return file


def pbf(file):
    """A file of raw OSM as .osm.pbf beside it: https://wiki.openstreetmap.org/wiki/PBF_Format, nodes one by one,
    nothing compressed."""
    def number(value):
        out = bytearray()
        while value > 127:
            out.append(value & 127 | 128)
            value >>= 7
        return bytes([*out, value])

    def signed(value):
        return number(value << 1 if value >= 0 else (-value << 1) - 1)

    def field(key, value):
        return number(key << 3) + number(value) if isinstance(value, int) else number(
            key << 3 | 2) + number(len(value)) + value

    def steps(values):
        return b"".join(signed(b - a) for a, b in zip([0, *values], values))

    strings = [""]

    def index(word):
        if word not in strings:
            strings.append(word)
        return number(strings.index(word))

    def tags(of):
        found = [(index(tag.get("k")), index(tag.get("v"))) for tag in of.iter("tag")]
        return field(2, b"".join(key for key, _ in found)) + field(
            3, b"".join(value for _, value in found)) if found else b""

    groups = {"node": b"", "way": b"", "relation": b""}
    for one in ElementTree.parse(file).getroot():
        name = int(one.get("id"))
        if one.tag == "node":
            where = [round(float(one.get(key)) * 1e7) for key in ("lat", "lon")]
            groups["node"] += field(1, number(8) + signed(name) + tags(one) + number(8 << 3) + signed(where[0])
                                    + number(9 << 3) + signed(where[1]))
        elif one.tag == "way":
            groups["way"] += field(3, field(1, name) + tags(one)
                                   + field(8, steps([int(node.get("ref")) for node in one.iter("nd")])))
        else:
            members = list(one.iter("member"))
            kinds = b"".join(number(("node", "way", "relation").index(member.get("type"))) for member in members)
            groups["relation"] += field(
                4, field(1, name) + tags(one) + field(8, b"".join(index(member.get("role")) for member in members))
                + field(9, steps([int(member.get("ref")) for member in members])) + field(10, kinds))
    data = field(1, b"".join(field(1, word.encode()) for word in strings)) + b"".join(
        field(2, group) for group in groups.values() if group)
    header = b"".join(field(4, word) for word in (b"OsmSchema-V0.6",))
    out = file.with_suffix(".osm.pbf")
    with open(out, "wb") as stream:
        for kind, block in ((b"OSMHeader", header), (b"OSMData", data)):
            blob = field(1, block) + field(2, len(block))
            about = field(1, kind) + field(3, len(blob))
            stream.write(len(about).to_bytes(4, "big") + about + blob)
    return out


def crossing():
    """Two runways that cross, one of them in two ways, and what stands beside them."""
    plan = Map()
    plan.way([(-900, 0), (0, 0)], aeroway="runway", ref="09/27", width="45", surface="concrete")
    plan.way([(0, 0), (900, 0)], aeroway="runway", ref="09/27", width="45", surface="concrete")
    plan.way([(0, -700), (0, 700)], aeroway="runway", ref="18/36")
    plan.way([(100, 100), (400, 100), (400, 300), (100, 300)], True, aeroway="taxiway")
    plan.area((450, 250), (550, 350), aeroway="apron")
    plan.area((450, 400), (510, 440), aeroway="hangar", height="12.5 m", name="Hangar A")
    plan.area((600, 400), (640, 420), building="yes")
    plan.area((700, 400), (710, 410), building="garage", height="40 ft")
    plan.point(450, 380, man_made="mast", height="25")
    plan.way([(-900, -400), (900, -400)], barrier="fence")
    plan.point(-900, 0, aeroway="aerodrome", icao="XAAA", name="Crossing")
    return plan


def rows(folder):
    """The properties of the features of an airport."""
    whole = json.loads((folder / "airport.geojson").read_text("utf-8"))
    return [feature["properties"] for feature in whole["features"]]


def features(*several):
    """GeoJSON. @param several properties and geometries"""
    return {"type": "FeatureCollection", "features": [
        {"type": "Feature", "properties": properties, "geometry": shape} for properties, shape in several]}


def blocks(folder):
    """By name: class, triangles."""
    scene = al.load_scene(folder / "airport.lidarscene.json")
    return scene, {name: (word, triangles) for name, word, triangles in airport_pages.parts_of(scene)}


def plan_area(triangles):
    """Area of the sides that are seen from above, m2."""
    area = scenetools.normals(triangles)[:, 2]
    return area[area > 1e-9].sum()


def is_closed(triangles):
    """Whether each edge has two sides, of corners in whole millimetres."""
    return scenetools.is_closed(np.round(triangles, 3))


def write_heights(name, heights, low, spacing, driver="GTiff"):
    """A raster in metres about HERE, rows from south to north, pixels about posts."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows, columns = heights.shape
    image = gdal.GetDriverByName("MEM").Create("", columns, rows, 1, gdal.GDT_Float64)
    image.SetGeoTransform((low[0] - spacing / 2, spacing, 0, low[1] + (rows - 0.5) * spacing, 0, -spacing))
    image.SetProjection(coordinate_system(HERE).ExportToWkt())
    image.GetRasterBand(1).SetNoDataValue(-9999.0)
    image.GetRasterBand(1).WriteArray(np.where(np.isfinite(heights), heights, -9999.0)[::-1])
    gdal.GetDriverByName(driver).CreateCopy(str(FOLDER / name), image)
    return FOLDER / name


def slope(name):
    """A raster of heights that rise from 100 m at HERE by 4 % to the east."""
    x = np.arange(-3200, 3201, 50.0)
    return write_heights(name, np.broadcast_to(100 + 0.04 * x, (len(x), len(x))), (-3200, -3200), 50.0)


class Extracts(unittest.TestCase):
    def test_level_ground_lies_at_the_airports_elevation(self):
        """From --heights, else from the map, else at 0 m with a warning; heights above the sea then fit."""
        for name, tags, words, height, warned in (("level", {"ele": "228 ft"}, (), 69.494, False),
                                                  ("given", {"ele": "228 ft"}, ("--heights", "70.5"), 70.5, False),
                                                  ("unknown", {}, (), 0.0, True)):
            plan = Map()
            plan.area((-1500, -800), (1500, 800), aeroway="aerodrome", **tags)
            plan.way([(-900, 0), (900, 0)], aeroway="runway", ref="09/27")
            folder, said = made(f"elevation-{name}", plan.write(f"elevation-{name}.osm"), *words)
            origin = json.loads((folder / "airport.lidarscene.json").read_text())["origin"]
            self.assertAlmostEqual(origin["height"], height, places=3)
            self.assertEqual("does not say the aerodrome's elevation" in said, warned, said)
            self.assertIn(f"the ground is level at {height:g} m", (folder / "README.txt").read_text("utf-8"))
        code, said = run("airport", plan.write("elevation.osm"), "--heights", "30000", "-o", fresh("elevation-high"))
        self.assertEqual(code, 2, said)
        self.assertIn("--heights 30000: expected a raster, or the height of level ground", said)

    def test_runways_that_cross(self):
        folder, _ = made("crossing", crossing().write("crossing.osm"))
        self.assertEqual(sorted(path.name for path in folder.iterdir()), sorted([*airport.WHAT, airport.RECORD]))
        scene, found = blocks(folder)
        runways = {one.name: one for one in siting.read_runways(folder / "airport.geojson", scene.geodetic_origin)}
        self.assertEqual(set(runways), {"09/27", "18/36"})
        self.assertAlmostEqual(runways["09/27"].axis()[1], 1800.0, delta=0.01)
        self.assertAlmostEqual(runways["18/36"].axis()[1], 1400.0, delta=0.01)
        self.assertEqual((runways["09/27"].width, runways["18/36"].width), (45.0, 45.0))
        for name, area in (("09/27", 1800 * 45), ("18/36", 1400 * 45), ("Taxiway of asphalt", 1000 * 18),
                           ("Apron of concrete", 1e4), ("Hangar A", 2400), ("Building", 800), ("Garage", 100),
                           ("Mast", 0.25), ("Fence", 90)):
            self.assertAlmostEqual(plan_area(found[name][1]) / area, 1.0, delta=1e-4, msg=name)
        for name, height in (("Hangar A", 12.5), ("Building", 8), ("Garage", 40 * 0.3048), ("Mast", 25)):
            z = found[name][1][:, :, 2]
            self.assertAlmostEqual(z.max() - z.min(), height, delta=2e-3, msg=name)  # of coordinates in degrees
        for name in ("Hangar A", "Building", "Mast", "Fence"):
            self.assertTrue(is_closed(found[name][1]), name)
        # The ground curves: a point at the far end of the fence lies lower.
        low = found["Fence"][1][:, :, 2].min()
        self.assertAlmostEqual(low, -(900**2 + 400**2) / 2 / 6.37e6, delta=0.02)
        assumed = {(row[0], row[3]): row[4]
                   for row in (list(row.values()) for row in helpertools.rows_of(folder / "assumed.csv"))}
        self.assertEqual(assumed[("building", "height")], "8.0")
        self.assertEqual(assumed[("runway", "width")], "45.0")
        self.assertNotIn(("hangar", "height"), assumed)
        # The lidar stands beside the runways, and siting's candidates do.
        outlines = siting.read_outlines(folder / "exclusions.geojson", scene.geodetic_origin)
        self.assertFalse(any(siting.is_near([scene.lidar_position], outline)[0] for outline in outlines))
        self.assertEqual(sum(siting.is_near([(0.0, 0.0)], outline)[0] for outline in outlines), 2)
        # Its plan, with few places, and the lines of its README.
        plan = json.loads((folder / "siting.coverage.json").read_text())
        small = {**plan, "places": 50, "spacing": 800, "heights": [15],
                 "sensor": {"preset": "Search905", "azimuth_step": 6},
                 "coverage": {"species": "", "effective_area": 0.03, "clutter": False}}
        small.pop("mix", None)
        (folder / "small.coverage.json").write_text(json.dumps(small))
        code, words = run("coverage", folder / "small.coverage.json", "-o", folder / "maps")
        self.assertEqual(code, 0, words)
        lines = re.findall(r"avianlidar ((\w+) .*?)(?:;.*)?$", (folder / "README.txt").read_text("utf-8"), re.M)
        self.assertEqual([verb for _, verb in lines], ["coverage", "report", "sequence", "track"])
        for line, _ in lines:
            asked = vars(parser().parse_args(line.split()))
            self.assertTrue(any((folder / str(value)).is_file() for value in asked.values()) or "track " in line, line)

    def test_colours_are_told_apart(self):
        """Those of any two classes, the ground among them, and of any two species, by the distance of CIE 1976; also with
        two kinds of cones."""
        classes = {kind["class"] for kind in KNOWN["kinds"].values()}
        self.assertEqual(classes - set(_look.CLASSES), set())
        for eye, least in (("all", 14), ("without long", 7), ("without middle", 7)):
            classes = [*_look.CLASSES.values(), _look.class_colour("ground")]
            for colours, limit in ((classes, least), (_look.SPECIES, 17)):
                for one, other in itertools.combinations(colours, 2):
                    self.assertGreater(np.linalg.norm(lab(one, eye) - lab(other, eye)), limit, (eye, one, other))
        np.testing.assert_allclose(lab("#ff0000", "all"), (53.24, 80.09, 67.20), atol=0.05)

    def test_tags_as_they_are_found(self):
        """As in real maps: runways as areas and out of use, an aerodrome by relation and by point, tunnels, broken
        ways."""
        plan = Map()
        plan.area((-800, -22.5), (800, 22.5), aeroway="runway", ref="09/27")
        plan.way([(-400, -300), (400, -300)], aeroway="runway", ref="10/28", width="150 ft")
        plan.area((-400, -322.9), (400, -277.1), aeroway="runway", area="yes", ref="10/28")
        for tags in ({"aeroway": "runway", "disused": "yes"}, {"disused__aeroway": "runway"}):
            plan.way([(-800, 600), (800, 600)], ref="11/29", **tags)
        plan.relation([plan.area((-900, -450), (900, 450))], [plan.area((-100, -240), (100, -200))],
                      aeroway="aerodrome", icao="XREL")
        plan.point(0, -200, aeroway="aerodrome", icao="XREL")
        plan.point(0, 60, aeroway="aerodrome", icao="XHEL", aerodrome__type="heliport")
        plan.way([(0, 300), (300, 300)], highway="primary", tunnel="yes", layer="-1")
        plan.way([(0, 350), (300, 350)], natural="tree_row")
        plan.way([(-300, 200), (-280, 200), (-280, 200), (-280, 220), (-300, 220)], True, building="yes",
                 name="a node twice")
        plan.way([(-200, 240), (-180, 240)], True, building="yes", name="two nodes")
        plan.way([(-200, 260), (-200, 260)], barrier="wall")
        folder, _ = made("tags", plan.write("tags.osm"), "--icao", "XREL")
        kinds = [row["kind"] for row in rows(folder)]
        self.assertEqual([*map(kinds.count, ("runway", "road", "tree", "wall", "building"))], [3, 0, 1, 0, 1])
        scene, parts = blocks(folder)
        runways = {one.name: one for one in siting.read_runways(folder / "airport.geojson", scene.geodetic_origin)}
        self.assertEqual({name: (round(one.axis()[1], 1), round(one.width, 1)) for name, one in runways.items()},
                         {"09/27": (1600.0, 45.0), "10/28": (800.0, 45.7)})
        self.assertAlmostEqual(plan_area(parts["09/27"][1]), 1600 * 45, delta=160)  # of a width in decimetres

    def test_a_slope_with_a_wood(self):
        """Ground that rises by 4 % to the east, in a tilted plane that a few triangles hold."""
        plan = Map()
        plan.way([(-600, 0), (600, 0)], aeroway="runway", ref="09/27", width="30")
        plan.area((100, 300), (400, 500), natural="wood", height="15")
        plan.point(-300, 500, natural="tree", height="10")
        plan.area((-300, 300), (-200, 340), building="hangar", height="10")
        plan.way([(-500, -300), (500, -300)], barrier="fence", height="3")
        folder, _ = made("slope", plan.write("slope.osm"), "--heights", slope("slope.tif"))
        scene, found = blocks(folder)
        self.assertAlmostEqual(scene.geodetic_origin[2], 100.0, delta=0.01)
        error = KNOWN["terrain_error"]

        def above(name):
            places = found[name][1].reshape(-1, 3)
            return places[:, 2] - 0.04 * places[:, 0] + _ground.curvature(
                scene.geodetic_origin, places[:, 0], places[:, 1])

        runway, wood, fence = above("09/27"), above("Wood"), above("Fence")
        np.testing.assert_allclose(runway, 0.06, atol=error)
        self.assertLess(np.abs(wood[wood > 7] - 15).max(), error)
        self.assertLess(np.abs(wood[wood < 7]).max(), error)
        self.assertLess(np.abs(fence[fence > 1.5] - 3).max(), error)
        for name in ("Wood", "Fence"):
            self.assertTrue(is_closed(found[name][1]), name)
        crown = found["Tree"][1].reshape(-1, 3)
        np.testing.assert_allclose((crown.min(axis=0) + crown.max(axis=0)) / 2, (-300, 500, 5 - 12), atol=0.3)
        clutter = [json.loads((folder / name).read_text())["coverage"].get("clutter")
                   for name in ("airport.coverage.json", "siting.coverage.json")]
        self.assertEqual(clutter, [None, False])  # there are leaves
        # A hangar is level, and stands on its lowest corner.
        z = found["Hangar 1"][1][:, :, 2]
        self.assertAlmostEqual(z.min(), -0.04 * 300, delta=error)
        self.assertEqual(len(np.unique(np.round(z, 6))), 2)
        self.assertGreater(scene.lidar_position[2], -30)

    def test_edits_stay(self):
        file = crossing().write("edits.osm")
        folder, _ = made("edits", file)
        before = {path.name: path.read_bytes() for path in folder.iterdir()}
        scene = json.loads(before["airport.lidarscene.json"])
        scene["comment"] = "mine"
        (folder / "airport.lidarscene.json").write_text(json.dumps(scene))
        mapped = before["airport.geojson"].decode().replace('"height": 12.5, "height_from": "height"',
                                                            '"height": 17, "height_from": "survey"')
        self.assertNotEqual(mapped.encode(), before["airport.geojson"])
        (folder / "airport.geojson").write_text(mapped)
        (folder / "README.txt").unlink()
        code, words = run("airport", file, "-o", folder)
        self.assertEqual(code, 0)
        self.assertEqual(words.count("was edited and is kept"), 2)
        self.assertEqual(json.loads((folder / "airport.lidarscene.json").read_text())["comment"], "mine")
        self.assertEqual((folder / "airport.geojson").read_text(), mapped)
        self.assertEqual((folder / "README.txt").read_bytes(), before["README.txt"])
        _, found = blocks(folder)
        z = found["Hangar A"][1][:, :, 2]
        self.assertAlmostEqual(z.max() - z.min(), 17.0, delta=2e-3)
        # An edited terrain keeps the height of the origin.
        heights = write_heights("edited.tif", np.full((130, 130), 60.0), (-3225, -3225), 50.0)
        folder, _ = made("edited_terrain", file, "--heights", heights)
        terrain = folder / "terrain.vtp"
        terrain.write_text(terrain.read_text().replace("<VTKFile", "<!-- edited -->\n<VTKFile", 1))
        code, said = run("airport", file, "--heights", heights, "-o", folder)
        self.assertEqual((code, said.count("was edited and is kept")), (0, 1), said)
        self.assertEqual(json.loads((folder / "airport.lidarscene.json").read_text())["origin"]["height"], 60.0)
        # What others have left is not written over.
        other = fresh("others")
        other.mkdir()
        (other / "README.txt").write_text("mine")
        code, words = run("airport", file, "-o", other)
        self.assertEqual((code, (other / "README.txt").read_text()), (2, "mine"))
        self.assertIn("was not made by this command", words)

    def test_a_coast_and_the_outline_of_the_aerodrome(self):
        """Sea lies to the right of a coastline, islands are land, and lidars stand in the aerodrome off its roads."""
        plan = Map()
        plan.way([(-800, 0), (800, 0)], aeroway="runway", ref="09/27", width="30")
        plan.area((-1000, -500), (1000, 500), aeroway="aerodrome", icao="XSEA")
        plan.way([(-6000, -1000), (6000, -1000)], natural="coastline")
        plan.area((100, -1700), (500, -1400), natural="coastline")
        plan.way([(-1000, 300), (1000, 300)], highway="service", width="8")
        folder, _ = made("coast", plan.write("coast.osm"))
        _, found = blocks(folder)
        west, east, south, _ = AirportMap(FOLDER / "coast.osm").rectangle
        self.assertAlmostEqual(plan_area(found["Water"][1]), (east - west) * (-1000 - south) - 400 * 300,
                               delta=0.004 * (east - west) * 1000)  # a box of degrees
        shut = siting.read_outlines(folder / "exclusions.geojson",
                                    al.load_scene(folder / "airport.lidarscene.json").geodetic_origin)
        for place, free in (((0, 250), True), ((0, 302), False), ((0, 600), False), ((1100, 0), False),
                            ((-1100, 0), False), ((0, -600), False)):
            near = [siting.is_near(np.array([place]), outline, 0.0)[0] for outline in shut]
            self.assertEqual(not any(near), free, place)
        lidar = json.loads((folder / "airport.lidarscene.json").read_text())["lidar"]["position"]
        self.assertLess(max(abs(lidar[0]) - 1000, abs(lidar[1]) - 500), 0)
        self.assertLess(json.loads((folder / "siting.coverage.json").read_text())["siting"]["spacing"], 200)
        open_ = Map()
        open_.way([(-800, 0), (800, 0)], aeroway="runway", ref="09/27", width="30")
        open_.way([(-500, -1000), (500, -1000)], natural="coastline")
        self.assertIn("its coastlines do not part the scene",
                      run("airport", open_.write("open_coast.osm"), "-o", fresh("open_coast"))[1])

    def test_wrong_heights_and_records_are_named(self):
        plan = Map()
        plan.way([(-800, 0), (800, 0)], aeroway="runway", ref="09/27", width="30")
        plan.area((300, 300), (340, 340), building="yes", height="eleven")
        file = plan.write("none.osm")
        folder, _ = made("none", file)
        mapped = json.loads((folder / "airport.geojson").read_text())
        row = next(one["properties"] for one in mapped["features"] if one["properties"]["kind"] == "building")
        self.assertEqual(row["height"], 8.0)
        self.assertIn("assumed: height is 'eleven'", (folder / "assumed.csv").read_text())
        for edit, words in (({"height": 0}, "height is 0, expected metres above 0"),
                            ({"height": True}, "height is True, expected metres"),
                            ({"height": [12]}, r"height is \[12\], expected metres"),
                            ({"height": None}, "height is None, expected metres"),
                            ({"min_height": True}, "min_height is True, expected metres"),
                            ({"min_height": -1}, "min_height is -1, expected metres"),
                            ({"min_height": 9}, "min_height is 9 m, expected less than the height, 8 m")):
            row.update({"height": 8.0, "min_height": 0, **edit})
            (folder / "airport.geojson").write_text(json.dumps(mapped))
            code, said = run("airport", file, "-o", folder)
            self.assertEqual(code, 2)
            self.assertRegex(said, rf"airport.geojson: features\[1\] \(building 8\): {words}")
        # A record of checksums that is damaged: the remedy of the message works.
        for text in ("[]", "{", '{"README.txt": 1}', "{}"):
            (folder / "made.json").write_text(text)
            code, said = run("airport", file, "-o", folder)
            self.assertEqual(code, 2)
            self.assertIn("choose another folder, or empty this one to have all files made again", said)
        for path in folder.iterdir():
            path.unlink()
        self.assertEqual(run("airport", file, "-o", folder)[0], 0)

    def test_a_long_name(self):
        """A title of thousands of letters is wider than a picture can be."""
        plan = crossing()
        file = FOLDER / "long.geojson"
        gdal.VectorTranslate(str(file), str(plan.write("long.osm")), layers=["lines"])
        text = json.loads(file.read_text("utf-8"))
        text["features"] += features(
            ({"aeroway": "aerodrome", "name": 5000 * "N"}, {"type": "Point", "coordinates": [13.3, 53.6]}),
            ({"man_made": "mast", "name": 5000 * "M", "height": "9"},
             {"type": "Point", "coordinates": [13.301, 53.603]}))["features"]
        file.write_text(json.dumps(text))
        folder, said = made("long", file)
        self.assertIn(f"{80 * 'N'}..., 2 runways", said)
        self.assertTrue((folder / "airport.png").exists())

    def test_one_of_two_airports(self):
        plan = crossing()
        plan.way([(12000, 0), (13000, 0)], aeroway="runway", ref="01/19", width="20")
        plan.point(12500, 100, aeroway="aerodrome", icao="XBBB")
        file = plan.write("two.osm")
        code, words = run("airport", file, "-o", fresh("two"))
        self.assertEqual(code, 2)
        self.assertIn("runways of 2 airports: XAAA Crossing, XBBB", words)
        self.assertFalse((FOLDER / "two").exists())
        self.assertIn("but: XAAA Crossing, XBBB", run("airport", file, "--icao", "EDDF", "-o", FOLDER / "two")[1])
        made("two", file, "--icao", "xbbb")
        lon, lat, _ = siting.to_geodetic([(12500, 0, 0)], HERE)[0]
        bounds = (lon - 0.02, lat - 0.01, lon + 0.02, lat + 0.01)
        made("bounds", file, "--bounds", *bounds)
        for name in ("two", "bounds"):
            scene, found = blocks(FOLDER / name)
            np.testing.assert_allclose(scene.geodetic_origin[:2], (lat, lon), atol=1e-6)
            self.assertEqual([one for one in found if "/" in one], ["01/19"])
        self.assertIn("holds none of its runways",
                      run("airport", file, "--bounds", 1, 1, 2, 2, "-o", fresh("bounds"))[1])


class Terrains(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(5)
        self.x = np.arange(-1500, 1501, 10.0)
        x, y = np.meshgrid(self.x, self.x)
        self.heights = 50 + 20 * np.sin(x / 300) * np.cos(y / 400) + random.normal(0, 0.1, x.shape)

    def above(self, surface, places):
        """How far places lie above a terrain, m."""
        scene = al.Scene(surface, material="Wall")
        return places[:, 2] - siting.ground_of(scene, places[:, :2])

    def test_triangles_keep_to_the_heights(self):
        """2 km every 10 m: at all posts, on the ellipsoid that GeographicLib has."""
        from vtkmodules.util.numpy_support import vtk_to_numpy
        origin = (*HERE[:2], 50.0)
        self.x, self.heights = self.x[:201], self.heights[:201, :201]
        surface, ground = _ground.terrain(self.heights - 50.0, (-1500.0, -1500.0), 10.0, origin, 0.25)
        x, y = np.meshgrid(self.x, self.x)
        places = np.column_stack([x.ravel(), y.ravel(),
                                  (self.heights - 50.0).ravel() - _ground.curvature(origin, x, y).ravel()])
        inner = np.abs(places[:, :2] + 500).max(axis=1) < 999
        self.assertLess(np.abs(self.above(surface, places[inner][::37])).max(), 0.25 + 1e-6)
        self.assertLess(surface.GetNumberOfPolys(), len(self.x) ** 2)
        vertices = vtk_to_numpy(surface.GetPoints().GetData())
        exact = siting.to_geodetic(vertices, origin)[:, 2]
        columns, rows = (np.round((vertices[:, i] + 1500) / 10).astype(int) for i in (0, 1))
        np.testing.assert_allclose(exact, self.heights[rows, columns], atol=1e-3)
        rough, above = _ground.terrain(np.random.default_rng(1).normal(0, 1, (20, 30)), (0.0, 0.0), 10.0, origin, 0.01)
        self.assertEqual(rough.GetNumberOfPolys(), 2 * 19 * 29)  # all posts
        # The heights of its triangles, as rays find them.
        for mesh, at, (low, high) in ((surface, ground, ((-1490, -1490), (490, 490))),
                                      (rough, above, ((1, 1), (289, 189)))):
            places = np.random.default_rng(2).uniform(low, high, (300, 2))
            np.testing.assert_allclose(siting.ground_of(al.Scene(mesh, material="Wall"), places), at(places), atol=1e-6)

    def test_heights_of_files(self):
        """GeoTIFF and ASCII grid alike; what they do not hold is level, and fades."""
        rectangle = (-2500.0, 2500.0, -1000.0, 1000.0)
        smooth = 50 + 0.01 * np.broadcast_to(self.x, self.heights.shape)
        found = []
        for name, driver in (("part.tif", "GTiff"), ("part.asc", "AAIGrid")):
            file = write_heights(name, smooth, (-1500, -1500), 10.0, driver)
            posts, spacing, here, words, *_ = _ground.read_heights(file, HERE, rectangle, KNOWN)
            found.append(posts)
            self.assertAlmostEqual(spacing, 10.0, delta=0.01)
            self.assertAlmostEqual(here, 50.0, delta=0.01)
            self.assertIn("assumed", words)
            # no step of 15 m
            self.assertLess(np.abs(np.diff(posts, axis=1)).max(), 1.5 * 15.0 * spacing / KNOWN["feather"] + 0.2)
            x = -2500.0 + spacing * np.arange(posts.shape[1])
            inner = np.abs(x) < 1200
            np.testing.assert_allclose(posts[50, inner], 50 + 0.01 * x[inner], atol=0.02)
            outer = np.abs(x) > 1800
            self.assertLess(np.ptp(posts[:, outer]), 1e-6)
        np.testing.assert_allclose(found[0], found[1], atol=1e-3)
        holed = smooth.copy()
        holed[140:160, 140:160] = np.nan  # filled from around it
        posts, spacing, here, *_ = _ground.read_heights(write_heights("holed.tif", holed, (-1500, -1500), 10.0), HERE,
                                                       (-1000.0, 1000.0, -1000.0, 1000.0), KNOWN)
        self.assertAlmostEqual(here, 50.0, delta=1.0)  # as the border is


class Wrong(unittest.TestCase):
    def test_extracts_that_are_wrong(self):
        FOLDER.mkdir(parents=True, exist_ok=True)
        plan = Map()
        plan.area((0, 0), (10, 10), building="yes")
        across, beside, nothing = Map((-17.0, 179.999, 0.0)), Map((-17.0, 179.99, 0.0)), Map()
        for one in (across, beside):
            one.way([(-600, 0), (600, 0)], aeroway="runway")
        nothing.way([(0, 0), (0, 0)], aeroway="runway")
        files = [(across.write("across.osm"), "cross the meridian of 180 degrees"),
                 (beside.write("beside.osm"), "would reach over the meridian of 180"),
                 (nothing.write("nothing.osm"), "holds no runway"), (plan.write("none.osm"), "holds no runway"),
                 (FOLDER / "missing.osm", "no such file"), (FOLDER, "is not an extract by its name")]
        for name, content, said in (
                ("text.gpkg", "no map", "GDAL cannot"),
                *((f"{at}.geojson", json.dumps(features(({"aeroway": "runway"}, {
                    "type": "LineString", "coordinates": [[at, at], [at, at + 1]]}))),
                   f"{at}.geojson: holds no runway, expected lines or areas with the tag aeroway=runway; left out: "
                   "coordinates that are not degrees") for at in (95, 5940000)),
                ("cut.geojson", '{"type": "FeatureCollection", "features": [', "GDAL cannot read")):
            (FOLDER / name).write_text(content)
            files.append((FOLDER / name, said))
        large = FOLDER / "large.osm"
        with open(large, "wb") as stream:
            stream.truncate(500 << 20)  # takes no place on the disk
        self.addCleanup(large.unlink)
        files.append((large, "holds 500 MiB, expected at most 256: cut the extract"))
        # Heights beside an extract that is right.
        gdal.GetDriverByName("GTiff").CreateCopy(str(FOLDER / "nowhere.tif"),
                                                 gdal.GetDriverByName("MEM").Create("", 4, 4, 1, gdal.GDT_Float32))
        far = write_heights("far.tif", np.ones((10, 10)), (90000, 90000), 10.0)
        (FOLDER / "text.tif").write_text("no raster")
        for dem, said in ((FOLDER / "nowhere.tif", "does not say its coordinate reference system"),
                          (far, "holds no heights from -500 to 9,000 m at the airport"),
                          (FOLDER / "text.tif", "GDAL cannot read it as heights"),
                          (FOLDER / "none.tif", "no such file")):
            files.append(((FOLDER / "whole.osm", "--heights", dem), said))
        crossing().write("whole.osm")
        for file, said in files:
            code, words = run("airport", *(file if isinstance(file, tuple) else (file,)), "-o", fresh("bad"))
            self.assertEqual(code, 2, (file, words))
            self.assertIn(said, words)
            self.assertEqual(words.count("\n"), 1, words)
            self.assertFalse((FOLDER / "bad").exists())

    def test_a_run_that_was_stopped_edits_nothing(self):
        """Before each file and each record in turn, and then from another input."""
        def made(kept, text):
            for name in ("airport.geojson", "terrain.vtp"):
                kept.put(name, lambda: (name + text).encode())
            return {name: (kept.folder / name).read_text() for name in ("airport.geojson", "terrain.vtp")}

        for stop, begun in ((stop, begun) for stop in range(4) for begun in (False, True)):
            folder = fresh("stopped")
            folder.mkdir()
            if begun:
                made(airport.Kept(folder), "1")
            write = unittest.mock.Mock(side_effect=[*stop * [None], KeyboardInterrupt])
            stopped = unittest.mock.patch.object(airport, "write_whole", lambda path, content: (
                write(path) or path.write_bytes(content)))
            with stopped, self.assertRaises(KeyboardInterrupt):
                made(airport.Kept(folder), "2")
            kept = airport.Kept(folder)
            self.assertEqual((made(kept, "3"), kept.edited),
                             ({"airport.geojson": "airport.geojson3", "terrain.vtp": "terrain.vtp3"}, []))


class StandsOn(unittest.TestCase):
    """The key `on` of footprints."""

    def scene(self, **more):
        FOLDER.mkdir(parents=True, exist_ok=True)
        (FOLDER / "plane.obj").write_text("v -50 -50 -5\nv 50 -50 5\nv 50 50 5\nv -50 50 -5\nf 1 2 3\nf 1 3 4\n")
        shapes = [{"type": "Polygon", "coordinates": [[[-10, -10], [10, -10], [10, 10], [-10, 10], [-10, -10]]]},
                  {"type": "Polygon", "coordinates": [[[90, 90], [95, 90], [95, 95], [90, 90]]]},
                  {"type": "Point", "coordinates": [20, 0]}]
        (FOLDER / "shapes.geojson").write_text(json.dumps(features(*(({}, shape) for shape in shapes))))
        return {"version": 1, "objects": [{"name": "Plane", "file": str(FOLDER / "plane.obj"), "material": "Wall"},
                                          {"name": "Things", "footprints": str(FOLDER / "shapes.geojson"),
                                           "crs": "local", "material": "Wall", "on": "Plane", **more}]}

    def triangles(self, **more):
        scene = al.Scene(self.scene(**more))
        return next(triangles for name, _, triangles in airport_pages.parts_of(scene) if name == "Things"), scene

    def test_solids_areas_columns(self):
        solid, scene = self.triangles(height=4)
        self.assertAlmostEqual(solid[:, :, 2].min(), -1.0, delta=1e-12)
        self.assertAlmostEqual(solid[:, :, 2].max(), 3.0, delta=1e-12)
        report = "\n".join(field_values(scene.surfaces.GetBlock(0))["scene_report"])
        self.assertIn("1 areas and points beyond Plane were left out", report)
        self.assertIn("1 points were left out", report)
        column, _ = self.triangles(height=4, width=2)
        far = column[column[:, :, 0].min(axis=1) > 15]
        np.testing.assert_allclose(far.reshape(-1, 3).min(axis=0), [19.0, -1.0, 1.9], atol=1e-12)
        self.assertTrue(is_closed(far))
        flat, _ = self.triangles(flat=True, base=0.5)
        np.testing.assert_allclose(flat[:, :, 2], 0.1 * flat[:, :, 0] + 0.5, atol=1e-12)
        self.assertAlmostEqual(plan_area(flat), 400.0, delta=1e-9)

    def stood_on(self, ground, shape, **more):
        """Triangles of a footprint on a ground (OBJ)."""
        scene = self.scene(**more)
        (FOLDER / "plane.obj").write_text(ground)
        (FOLDER / "shapes.geojson").write_text(json.dumps(features(({}, shape))))
        return next(triangles for name, _, triangles in airport_pages.parts_of(al.Scene(scene)) if name == "Things")

    def test_a_closed_body_is_not_a_terrain(self):
        corners = [(x, y, z) for z in (0, 10) for y in (-50, 50) for x in (-50, 50)]
        sides = "1 3 4,1 4 2,5 6 8,5 8 7,1 2 6,1 6 5,3 7 8,3 8 4,1 5 7,1 7 3,2 4 8,2 8 6".split(",")
        points = "".join("v %g %g %g\n" % corner for corner in corners)
        shape = {"type": "Polygon", "coordinates": [[[0, 0], [10, 0], [10, 10], [0, 0]]]}
        with self.assertRaisesRegex(RuntimeError, "Plane has triangles that face up and others that face down"):
            self.stood_on(points + "".join(f"f {side}\n" for side in sides), shape, flat=True, base=0.5)
        for open_below in (sides[2:], sides[:2] + sides[4:]):  # walls, and a roof or a floor
            flat = self.stood_on(points + "".join(f"f {side}\n" for side in open_below), shape, flat=True, base=0.5)
            self.assertAlmostEqual(plan_area(flat), 50.0, delta=1e-9)

    def test_errors(self):
        for more, said in (({"on": "Nothing", "height": 1}, "is Nothing, expected the name of a mesh further up"),
                           ({"on": "Things", "height": 1}, "is Things, expected the name of a mesh"),
                           ({"height": 1, "position": [0, 0, 1]}, "stands beside on"),
                           ({"height": 1, "scale": 2}, "stands beside on")):
            with self.assertRaisesRegex(RuntimeError, said):
                al.Scene(self.scene(**more))


@unittest.skipUnless(DATA, "AVIANLIDAR_DATA_DIR is not set")
class RealAirports(unittest.TestCase):
    def test_hongqiao(self):
        """Areas as its source states them; heights are those of the extract."""
        folder, words = made("hongqiao", pathlib.Path(DATA) / "airport_zsss" / "osm" / "ZSSS_osm.geojson")
        _, found = blocks(folder)
        for name, area in (("Terminal 1", 54459), ("Terminal 2", 139673)):
            self.assertAlmostEqual(plan_area(found[name][1]), area, delta=area * 1e-4)
            z = found[name][1][:, :, 2]
            self.assertAlmostEqual(z.max() - z.min(), 25.0, delta=1e-9)
        runways = {one.name: one for one in siting.read_runways(folder / "airport.geojson", (31.1979, 121.3363, 0.0))}
        self.assertEqual([round(runways[name].axis()[1]) for name in ("18L/36R", "18R/36L")], [3398, 3292])
        self.assertGreater(plan_area(found["18L/36R"][1]), 57.6 * 3398)
        self.assertNotIn("says no height", words)
        self.assertIn("default of origin tool, not surveyed", (folder / "README.txt").read_text("utf-8"))
