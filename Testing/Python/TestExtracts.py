# SPDX-License-Identifier: BSD-3-Clause
"""Extracts of maps as tools write them: which features become part of an airport's scene, and which are counted as left
out. Surveyed obstacles beside them."""
import contextlib
import csv
import itertools
import json
import math
import re
import unittest
import warnings
from unittest import mock

import numpy as np
from osgeo import gdal, ogr, osr

import avianlidar as al
import TestAirport as ta
from avianlidar import siting
from avianlidar.apps.airport import _aixm as aixm, _extract as extract, _obstacles as obstacles, _osm
from avianlidar.apps.airport import _pages as airport_pages
from avianlidar.apps.airport._map import AirportMap
from avianlidar.apps.inputs._json import packaged
from avianlidar.apps.places import _features, _gdal

KNOWN = packaged("places/airport.json")
ta.FOLDER.mkdir(parents=True, exist_ok=True)


def tagged(text):
    """Tags from a text such as `building=yes, min_height=10 m`."""
    return dict(tag.split("=", 1) for tag in text.split(", ") if tag)


def in_metres(shape):
    """A copy of a shape in metres about HERE."""
    shape = shape.Clone()
    shape.Transform(osr.CoordinateTransformation(_gdal.degrees(), ta.coordinate_system(ta.HERE)))
    return shape


def things(file):
    """Each feature that the rules take: kind, form, name, and its area (m2) or length (m)."""
    found = []
    for one in _osm.read_extract(file, KNOWN).features:
        shape = in_metres(one.shape)
        form = _gdal.form_of(shape)
        size = {"area": shape.Area, "line": shape.Length, "point": lambda: 0}[form]()
        found.append((one.kind, form, one.tags.get("name", ""), round(size)))
    return sorted(found)


def left(file):
    """How many features are left out, by kind and reason."""
    found = {}
    for one in _osm.read_extract(file, KNOWN).left:
        found[one.kind, one.reason] = found.get((one.kind, one.reason), 0) + one.count
    return found


def runway(**tags):
    plan = ta.Map()
    plan.way([(-800, 0), (800, 0)], aeroway="runway", ref="09/27", width="45", **tags)
    return plan


def raw(name, places, ways, relations=(), more=""):
    """A map of a runway and of raw objects. @param places steps of 1e-4 degrees, by number of the node @param ways
    number, nodes, tags @param relations number, members (way and role), tags @param more other objects"""
    def rest(tags, kind):
        return "".join(f'<tag k="{key}" v="{value}"/>' for key, value in tagged(tags).items()) + f"</{kind}>"

    plan = runway()
    plan.rows += [f'<node id="{i}" version="1" lat="{53.603 + 1e-4 * x}" lon="{13.301 + 1e-4 * y}"/>'
                  for i, (x, y) in places.items()]
    plan.ways += [f'<way id="{number}" version="1">' + "".join(f'<nd ref="{i}"/>' for i in nodes) + rest(tags, "way")
                  for number, nodes, tags in ways]
    plan.relations += [f'<relation id="{number}" version="1">'
                       + "".join(f'<member type="way" ref="{way}" role="{role}"/>' for way, role in members)
                       + rest(tags, "relation") for number, members, tags in relations] + [more]
    return plan.write(name)


def geojson(name, *features):
    """GeoJSON of a runway and features. @param features properties and geometries"""
    file = ta.FOLDER / name
    gdal.VectorTranslate(str(file), str(runway().write("whole.osm")), layers=["lines"])
    whole = json.loads(file.read_text("utf-8"))
    whole["features"] += ta.features(*features)["features"]
    file.write_text(json.dumps(whole).replace("Infinity", "1e400"), "utf-8")
    return file


def shaped(kind, coordinates):
    return {"type": kind, "coordinates": coordinates}


def square(x, y=53.603, size=1e-3):
    """A ring from its south-west corner, degrees."""
    return [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]


def fenced():
    """Closed ways that are areas by some tags, lines by others, and both."""
    plan = runway()
    plan.area((-1500, -700), (1500, 700), aeroway="aerodrome", icao="XFEN", barrier="fence", height="3")
    for number, tags in enumerate((
            "man_made=storage_tank", "landuse=military, barrier=wall", "landuse=grass, barrier=hedge",
            "building=yes, height=9", "building:part=yes, height=12", "amenity=parking, area=yes",
            "highway=footway, surface=asphalt", "highway=service, area=yes", "building=construction")):
        plan.area((60 * number, 300), (60 * number + 30 + number, 340), name=str(number), **tagged(tags))
    plan.way([(100, 100), (400, 100), (400, 200), (100, 200)], True, aeroway="taxiway")
    plan.way([(-400, 100), (-100, 100), (-100, 200), (-400, 200)], True, highway="service")
    plan.relation([plan.area((-600, 300), (-500, 400))], [plan.area((-570, 330), (-530, 370))],
                  **tagged("building=hangar, height=12, name=ring"))
    plan.relation([plan.area((-900, 300), (-800, 400), natural="wood")], [plan.area((-880, 320), (-820, 380))],
                  natural="wood", name="glade")
    plan.point(0, 500, man_made="mast", height="25")
    return plan


class Formats(unittest.TestCase):
    def test_one_map_in_four_formats(self):
        """PBF; a GeoPackage in UTM with GDAL's own areas; GeoJSON with each closed way twice, as by osmium, and with
        tags in one object."""
        file = fenced().write("fenced.osm")
        expected = things(file)
        kinds = [kind for kind, *_ in expected]
        once = "runway fence wall hedge tank mast grass building part parking wood taxiway hangar".split()
        self.assertEqual(sorted(kinds), sorted([*once, "road", "road"]))
        sizes = {(kind, name): size for kind, _, name, size in expected}
        for which, size in ((("tank", "0"), 30 * 40), (("wall", "1"), 2 * (31 + 40)), (("grass", "2"), 32 * 40),
                            (("hedge", "2"), 2 * (32 + 40)), (("hangar", "ring"), 1e4 - 40**2),
                            (("wood", "glade"), 1e4 - 60**2), (("taxiway", ""), 800), (("fence", ""), 2 * 4400)):
            self.assertAlmostEqual(sizes[which] / size, 1.0, delta=1e-3, msg=which)
        geopackage, twice, nested = map(ta.FOLDER.joinpath, ("fenced.gpkg", "fenced-twice.geojson",
                                                                        "fenced-nested.geojson"))
        geopackage.unlink(missing_ok=True)
        gdal.VectorTranslate(str(geopackage), str(file), format="GPKG", dstSRS="EPSG:32633")
        lines, nest = [], []
        whole = _osm.read_extract(file, KNOWN)
        for one in [*whole.features, *whole.aerodromes]:
            tags = {name: value for name, value in one.tags.items() if not name.startswith("osm_")}
            shape = json.loads(one.shape.ExportToJson())
            corners = shape["coordinates"]
            lines.append((tags, shape))
            if shape["type"] == "Polygon" and len(corners) == 1:
                lines[-1:] = [(tags, shaped("LineString", corners[0])), (tags, shaped("MultiPolygon", [corners]))]
            elif shape["type"] == "LineString" and corners[0] == corners[-1]:
                lines.insert(-1, (tags, shaped("Polygon", [corners])))
            nest.append(({"type": "way", "id": 1, "tags": tags}, shape))
        for out, all_ in ((twice, lines), (nested, nest)):
            out.write_text(json.dumps(ta.features(*all_)))
        for other in (ta.pbf(file), geopackage, twice, nested):
            found = things(other)
            self.assertEqual([row[:3] for row in found], [row[:3] for row in expected], other)
            if other.suffix in (".gpkg", ".pbf"):  # in the GeoPackage, GDAL drops the outer way of the wood
                drawn_twice = {("wood", extract.TWICE): 1} if other != geopackage else {}
                self.assertEqual(left(other), {("building", "not built"): 1, **drawn_twice}, other)
            np.testing.assert_allclose([row[3] for row in found], [row[3] for row in expected], atol=1.5)

    def test_orders_of_xml(self):
        """Nodes from last to first, after ways, with negative ids, places in ways, and objects that an editor has
        deleted."""
        plan = fenced()
        file = plan.write("order.osm")
        expected = things(file)
        nodes, ways, relations = ("".join(of) for of in (plan.rows, plan.ways, plan.relations))
        places = dict(re.findall(r'<node id="(\d+)" version="1" (lat="\S+" lon="\S+")>', nodes))
        deleted = "".join(f'<node id="{i}" action="delete" lat="1" lon="{i}"/>' for i in (90001, 90002)) + (
            '<way id="90003" action="delete"><nd ref="90001"/><nd ref="90002"/><tag k="barrier" v="fence"/></way>')
        in_ways = re.sub(r'<nd ref="(\d+)"/>', lambda found: f'<nd ref="{found[1]}" {places[found[1]]}/>', ways)
        tags = "".join(row for row in plan.rows if "<tag" in row)
        for name, body in (("backwards", "".join(plan.rows[::-1] + plan.ways[::-1]) + relations),
                           ("after", relations + ways + nodes), ("geometry", tags + in_ways + relations),
                           ("negative", re.sub(r'(id|ref)="', r'\1="-', nodes + ways + relations)),
                           ("repeated", (nodes + plan.rows[-1] + 2 * ways).replace('version="1"', "") + 2 * relations),
                           ("deleted", deleted + nodes + ways + relations)):
            other = ta.FOLDER / f"{name}.osm"
            other.write_text(f'<?xml version="1.0"?><osm version="0.6">{body}</osm>', "utf-8")
            self.assertEqual(things(other), expected, name)

    def test_objects_that_the_border_cuts(self):
        """Closed ways with one, two and three of their four nodes, a way without nodes, and a relation whose way is
        missing."""
        places = {900: (0, 0), 901: (1, 0), 903: (1, 1), 902: (0, 1)}
        ways = [(910 + k, nodes, "building=yes") for k, nodes in enumerate((
            (900, 991, 992, 993, 900), (900, 901, 992, 993, 900), (900, 901, 903, 993, 900), (991, 992, 993, 991),
            (991, 901, 903, 902, 991), (900,)))]
        wood = "type=multipolygon, natural=wood"
        relation, bare = (920, ((910, "outer"), (999, "outer")), wood), [(916, (), "building=yes"), (921, (), wood)]

        def cut(name, *empty):
            file = raw(name, places, ways + [*empty[:1]], [relation, *empty[1:]])
            text = file.read_text("utf-8")  # the runway goes on beyond the border
            file.write_text(text.replace('<tag k="aeroway"', '<nd ref="995"/><tag k="aeroway"'), "utf-8")
            return file

        # The test's own writer of PBF cannot write objects without members.
        for one, empty in ((cut("cut.osm", *bare), {("way", "no nodes"): 2, ("relation", "no ways"): 1}),
                           (ta.pbf(cut("packed.osm")), {("way", "no nodes"): 1})):
            self.assertEqual([kind for kind, *_ in things(one)], ["runway"], one)
            self.assertEqual(left(one), {("building", extract.CUT): 4, ("way", extract.CUT): 1,
                                         ("relation", extract.CUT): 1, **empty}, one)
        said = ta.run("airport", ta.FOLDER / "cut.osm", "-o", ta.fresh("cut"))[1]
        self.assertIn("a runway is cut by the extract's border", said)

    def test_areas_that_enclose_nothing(self):
        """A way there and back as a building, as the outer way of a wood, and as a hole and a second part of another
        wood."""
        places = {900 + i: place for i, place in enumerate(((0, 0), (2, 0), (2, 2), (0, 2), (1, 1), (3, 3)))}
        ways = [(910 + k, [900 + i for i in nodes], "" if k else "building=yes") for k, nodes in enumerate((
            (0, 1, 2, 1, 0), (0, 1, 2, 1, 0), (0, 1, 2, 3, 0), (0, 4, 0), (2, 5, 2)))]
        wood = "type=multipolygon, natural=wood"
        file = raw("back.osm", places, ways, [
            (920, ((911, "outer"),), wood), (921, ((912, "outer"), (913, "inner"), (914, "outer")), wood)])
        self.assertEqual([kind for kind, *_ in things(file)], ["runway", "wood"])
        self.assertEqual(left(file), {("building", "no extent"): 1, ("wood", "no extent"): 1})
        ta.run("airport", file, "-o", ta.fresh("back"))

    def test_crossing_rings_are_named(self):
        """A bow tie is two triangles, and is said to be repaired; a sound building beside it is not."""
        corners = ((0, 0), (2, 2), (2, 0), (0, 2), (5, 0), (6, 0), (6, 1), (5, 1), (8, 0), (10, 2), (10, 0), (8, 2))
        ways = [(910 + k, [900 + 4 * k + i for i in (0, 1, 2, 3, 0)], name and f"building=yes, name={name}")
                for k, name in enumerate(("Bow", "Sound", ""))]
        file = raw("bow.osm", {900 + i: place for i, place in enumerate(corners)}, ways,
                   [(920, ((912, "outline"),), "type=building, building=yes, name=Of parts")])
        folder = ta.fresh("bow")
        ta.run("airport", file, "-o", folder)
        self.assertRegex((folder / "README.txt").read_text("utf-8"), f"  2 {extract.CROSSING}: "
                         "(building Bow, building Of parts|building Of parts, building Bow)\n")
        features = json.loads((folder / "airport.geojson").read_text("utf-8"))["features"]
        ground = {one["properties"]["name"]: ogr.CreateGeometryFromJson(json.dumps(one["geometry"])).Area()
                  for one in features if one["properties"]["kind"] == "building"}
        self.assertAlmostEqual(ground["Bow"], 2 * ground["Sound"], delta=1e-11)  # square degrees: 2e-8 and 1e-8

    def test_rings_given_twice_and_inside_others(self):
        """Equal rings are one area. A polygon inside another polygon of GeoJSON is not a hole. Corners that are not
        numbers cost one feature."""
        one, other, inside = square(13.301), square(13.305), square(13.3013, 53.6033, 4e-4)
        for kind, coordinates, area in (
                ("MultiPolygon", [[one], [one]], 1), ("MultiPolygon", [[one], [one[2:] + one[1:3]], [other]], 2),
                ("MultiPolygon", [[one], [inside]], 1), ("MultiPolygon", [[one, inside], [inside]], 1),
                ("MultiPolygon", [[one, inside], [other]], 1.84), ("Polygon", [[["13.301", 53.6], *one[1:]]], None),
                ("Polygon", [[one[0], "x", *one[1:]]], None), ("Polygon", [[[None, 53.6], *one[1:]]], None)):
            features = [(tagged("building=yes, name=A"), shaped(kind, coordinates)),
                        (tagged("building=yes, name=B"), shaped("Polygon", [square(13.31)]))]
            for order in (features, features[::-1]):
                found = _osm.read_extract(geojson("equal.geojson", *order), KNOWN)
                areas = {one.name: round(one.shape.Area() * 1e6, 6) for one in found.features if one.kind == "building"}
                self.assertEqual(areas, {"A": area, "B": 1.0} if area else {"B": 1.0}, coordinates)
                self.assertEqual([(one.name, one.reason) for one in found.left],
                                 [] if area else [("A", "without a geometry")], coordinates)
        corners = [(0, 300), (40, 300), (40, 340), (0, 340)]
        for second in (None, (0, 1, 2, 3), (2, 3, 0, 1), (3, 2, 1, 0)):
            plan = runway()
            way = plan.way(corners, True)
            plan.relation([way, plan.way([corners[i] for i in second], True) if second else way], [], building="yes")
            self.assertEqual([row for row in things(plan.write("equal.osm")) if row[0] == "building"],
                             [("building", "area", "", 1600)], second)

    def test_rings_of_too_few_corners(self):
        """Alone, as a hole, and beside a good part, in GeoJSON, where nothing closes or checks a ring."""
        corner, other, good = [13.301, 53.603], [13.302, 53.603], square(13.301)[:3] + square(13.301)[:1]
        for tags, ring in itertools.product(
                ("building=yes", "natural=wood", "aeroway=aerodrome", "building=yes, start_date=2999"),
                ([], [corner], [corner, corner], [corner, other], [corner, other, corner])):
            shapes = [shaped("Polygon", [ring])]
            if "building" in tags and ring:
                shapes += [shaped("Polygon", [good, ring]), shaped("MultiPolygon", [[ring], [good]])]
            for number, shape in enumerate(shapes):
                got = things(geojson("short.geojson", (tagged(tags), shape)))
                self.assertEqual(len(got), 1 + (number > 0 and "start_date" not in tags), (tags, shape))

    def test_single_features_that_end_nothing(self):
        """Found by random features: lines of one corner alone and among others, areas with such rings, a corner at 0 N
        0 E, features on the far side of the Earth."""
        a, b, c, zero, pole = [13.301, 53.603], [13.302, 53.603], [13.302, 53.604], [0, 0], [180, 90]
        tags = ("building=yes", "barrier=fence", "natural=coastline", "aeroway=aerodrome", "aeroway=threshold",
                "aeroway=runway", "natural=tree, location=roof")
        for shape in (shaped("LineString", [a]), shaped("MultiLineString", [[a], [a, b], []]),
                      shaped("Polygon", [[a, b, c, a], [a], [a, b]]), shaped("MultiPoint", [a, b]), shaped("Point", []),
                      shaped("LineString", [a, zero]), shaped("Polygon", [[a, b, zero, a]]),
                      shaped("LineString", [pole, [180, 89.999]]), shaped("Point", pole),
                      {"type": "GeometryCollection", "geometries": []}, None):
            whole = geojson("single.geojson", *((tagged(one), shape) for one in tags))
            with warnings.catch_warnings(), _gdal.quiet():
                warnings.simplefilter("ignore")
                made = AirportMap(whole)
                made.mapped(made.chosen(made.heights()))
            self.assertIn("09/27", {one.name for one in made.runways}, shape)
            reasons = {one.reason for one in made.left}
            self.assertEqual("[0, 0]" in json.dumps(shape), extract.TOO_LONG in reasons, shape)

    def test_rings_and_corners_in_wrong_places(self):
        """Holes beside their outline and far away, and coordinates that are not degrees, are counted as left out."""
        house, inner = square(13.301), square(13.3013, 53.6033, 4e-4)
        for number, (coordinates, holes, reason) in enumerate((
                ([house, square(13.303)], 0, extract.STRAY), ([inner, house], 1, ""),
                ([house, square(14, 54), inner, inner[:2]], 1, extract.STRAY),
                ([[*house[:2], [13.302, 1e400], *house[3:]]], 0, extract.NO_DEGREES),
                ([square(387000, 5940000)], 0, extract.NO_DEGREES))):
            whole = geojson("strays.geojson", (tagged("building=yes"), shaped("Polygon", coordinates)))
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = [one.shape for one in _osm.read_extract(whole, KNOWN).features if one.kind == "building"]
            self.assertEqual(left(whole), {("building", reason): 1} if reason else {}, number)
            self.assertEqual(len(found), reason != extract.NO_DEGREES, number)
            for shape in found:
                self.assertAlmostEqual(shape.Area() * 1e6, 1.0 - 0.16 * holes, delta=1e-6, msg=str(number))

    def test_incomplete_extracts_are_named(self):
        whole = fenced().write("whole.osm")

        def system(**crs):
            return json.dumps({"type": "FeatureCollection", "crs": crs, "features": []}).encode()

        for name, content, words in (
                ("none.osm", b"", "is empty"), ("wide.osm", "<osm/>".encode("utf-16"), "is in UTF-16"),
                ("page.osm", b"\n<html><body>too many requests</body></html>", "is a web page"),
                ("own.geojson", b'{"version": 0.6, "generator": "Overpass API", "elements": []}',
                 "is Overpass's own JSON"), ("half.osm", whole.read_bytes()[:6000], "cannot be read to its end"),
                ("nodes.osm", whole.read_bytes().replace(b'lat="53.', b'lat="53,'),
                 "holds no runway.*; node 1: lat is '53,"),
                ("system.geojson", system(type="name", properties={"name": "EPSG:99999999"}),
                 "the coordinate system is 'EPSG:99999999'"),
                ("link.geojson", system(type="link", properties={"href": "utm.prj", "type": "esriwkt"}),
                 "the coordinate system is 'a link to utm.prj'"),
                ("half.osm.pbf", ta.pbf(whole).read_bytes()[:-200], "cannot be read to its end")):
            file = ta.FOLDER / name
            file.write_bytes(content)
            with self.assertRaisesRegex(RuntimeError, f"{name}: {words}.*expected"):
                AirportMap(file)

    def test_nodes_at_no_place(self):
        """One node that no way has, and one of a fence, a wood by relation, a building and each end of a second
        runway."""
        def edited(plan, change):
            file = plan.write("nowhere.osm")
            whole = [row[:2] for row in things(file)]
            file.write_text(change(file.read_text("utf-8")), "utf-8")
            return file, whole

        for word in ("200", "53,602", "abc", "nan", "5_3", ""):
            plan = runway()
            spare = plan.point(50, 50, natural="tree", height="9")
            other = plan.way([(-800, 500), (800, 500)], aeroway="runway", ref="09R/27L")
            fence = plan.way([(0, 99), (50, 99), (99, 99)], barrier="fence")
            building, wood = plan.area((0, 300), (8, 310), building="yes"), plan.area((0, 400), (9, 410))
            plan.relation([wood], [], natural="wood")
            wrong = {spare, other - 1, fence - 2, building - 1, wood - 3}
            file, whole = edited(plan, lambda text: re.sub(
                r'(<node id="(\d+)"[^>]*lat=)"[^"]*"',
                lambda found: f'{found[1]}"{word}"' if int(found[2]) in wrong else found[0], text))
            found = _osm.read_extract(file, KNOWN)
            self.assertEqual(sorted(int(one.id) for one in found.left if one.kind == "node"), sorted(wrong), word)
            self.assertIn(f"lat is {word!r}", {one.name for one in found.left})
            self.assertEqual({(one.kind, one.reason) for one in found.left if one.kind != "node"},
                             {(kind, extract.NO_DEGREES) for kind in ("way", "building", "wood")}, word)
            self.assertEqual([row[:2] for row in things(file)],
                             [row for row in whole if row[0] in ("runway", "fence")][:2], word)
        plan = runway()
        plan.area((0, 300), (8, 310), building="yes")
        nameless = ('<node lat="200" lon="13"/><node lat="53" lon="13"/><node id="x1" lat="53" lon="13"/><way id=""/>')
        file, whole = edited(plan, lambda text: text.replace("<node ", nameless + "<node ", 1))
        self.assertEqual([row[:2] for row in things(file)], whole)
        lost = [(one.kind, one.id, one.reason) for one in _osm.read_extract(file, KNOWN).left]
        self.assertEqual(sorted(lost), sorted((kind, name, _osm.NO_ID) for kind, name in (
            ("node", ""), ("node", ""), ("node", "x1"), ("way", ""))))
        plan = runway()
        plan.way([(-800, 500), (0, 500), (800, 500)], aeroway="runway", ref="09R/27L")
        file, _ = edited(plan, lambda text: text.replace('<node id="4" version="1" lat="', '<node id="4" lat="2'))
        self.assertRegex(ta.run("airport", file, "-o", ta.fresh("nowhere"))[1],
                         "a runway has nodes with coordinates that are not degrees.*mend these nodes")

    def test_values_that_are_lists(self):
        """One list makes lists of a whole column in GDAL."""
        for values, expected in (((12, [15]), (12, 15)), ((12.5, [9, 15.5]), (12.5, 15.5)),
                                 (("12 m", ["15 m"]), (12, 15)), (("12", [15]), (12, 15)), ((12, []), (12, 8)),
                                 ((12, {"max": 3}), (12, 8)), (([[1]], "9"), (8, 9))):
            whole = geojson("lists.geojson", *(({"building": "yes", "height": value}, shaped("Polygon", [square(x)]))
                                               for x, value in zip((13.301, 13.311), values)))
            found = [_features.properties_of(one, KNOWN)["height"] for one in _osm.read_extract(whole, KNOWN).features
                     if one.kind == "building"]
            self.assertEqual(tuple(found), expected, values)

    def test_features_drawn_twice(self):
        """Parts above one another are two. At one place the highest feature counts; others are counted as left out."""
        plan = runway()
        for tags in ("height=10", "height=60, min_height=40", "height=60, min_height=45"):
            plan.area((0, 300), (40, 340), building__part="yes", **tagged(tags))
        for height in ("30", "55", "40"):
            plan.point(100, 300, man_made="mast", height=height)
        plan.relation([plan.area((200, 300), (240, 340), building="yes", height="9")], [],
                      building="yes", name="relation")
        file = plan.write("twice.osm")
        found = sorted((one.kind, float(one.tags["height"]), one.name)
                       for one in _osm.read_extract(file, KNOWN).features if one.kind != "runway")
        self.assertEqual(found, [("building", 9, "relation"), ("mast", 55, ""), ("part", 10, ""), ("part", 60, "")])
        self.assertEqual(left(file), {(kind, extract.TWICE): count
                                      for kind, count in (("part", 1), ("mast", 2), ("building", 1))})


class Runways(unittest.TestCase):
    def runways(self, *pieces, thresholds=(), areas=()):
        """Reference, length (m), heading (deg), width and displaced thresholds of each runway, and reasons of what is
        left out. @param pieces points (m), tags"""
        plan = ta.Map()
        for points, tags in pieces:
            plan.way(points, **{"aeroway": "runway", **tagged(tags)})
        for x, y in thresholds:
            plan.point(x, y, aeroway="threshold")
        for tags in areas:
            plan.area((-300, 450), (300, 650), **tagged(tags))
        made = AirportMap(plan.write("pieces.osm"))
        found = []
        for one in made.runways:
            line = in_metres(one.shape)
            heading = math.degrees(math.atan2(line.GetX(1) - line.GetX(0), line.GetY(1) - line.GetY(0))) % 360
            found.append((one.tags.get("ref"), round(line.Length()), round(heading), one.tags.get("width"),
                          *(round(float(one.tags.get(f"displaced_{end}", 0))) for end in ("start", "end"))))
        return sorted(found, key=str), [one.reason for one in made.left]

    def test_pieces_of_one_runway(self):
        ref, first = "ref=09/27, width=45", ("09/27", 1800, 90, "45", 0, 0)
        a, b, c = [(-900, 0), (-500, 0)], [(-480, 0), (200, 0.5)], [(200, 0.5), (900, 0)]
        for pieces in ((a, b, c), (c, a[::-1], b), (b[::-1], c, a), (a[::-1], b[::-1], c[::-1])):
            self.assertEqual(self.runways(*((piece, ref) for piece in pieces))[0], [first], pieces)
        # Pieces that are named by one end each
        for refs in (("09", "27", "09"), ("09L", "27R", ""), ("9", "27", "09/27")):
            found, _ = self.runways(*((piece, one and f"ref={one}") for piece, one in zip((a, b, c), refs)))
            self.assertEqual([row[:3] for row in found], [("09L/27R" if "L" in refs[0] else "09/27", 1800, 90)], refs)
        self.assertEqual(len(self.runways((a, "ref=09L"), (b, "ref=27L"))[0]), 2)
        # Parallel runways, and one that crosses, stay themselves; the last piece has no number.
        found, _ = self.runways((a, ref), (b, ref), (c, ""), ([(-900, 210), (900, 210)], "ref=09L/27R"),
                                ([(0, 700), (0, -700)], "ref=18/36"))
        self.assertEqual(found, [first, ("09L/27R", 1800, 90, None, 0, 0), ("18/36", 1400, 180, None, 0, 0)])

    def test_areas_and_lines(self):
        """An area without a line along it is a runway: one that a line crosses, and one in three pieces. Pieces without
        a number go on."""
        def box(x0, x1):
            return [(x0, -22), (x1, -22), (x1, 22), (x0, 22), (x0, -22)]

        ref, area, first = "ref=09/27", "area=yes", ("09/27", 1800, 90, None, 0, 0)
        across = ([(-310, -290), (-290, -310), (310, 290), (290, 310), (-310, -290)], "ref=04/22, area=yes")
        line = ([(-900, 0), (900, 0)], ref)
        for pieces, expected in (((line, across), [("04/22", 849, 45, "28.3", 0, 0), first]),
                                 ((line, (box(-850, 900), area)), [first]),
                                 ([(box(x, x + 600), f"{ref}, {area}") for x in (-900, -300, 300)],
                                  [("09/27", 1800, 90, "44.0", 0, 0)]),
                                 ((([(-900, 0), (500, 0)], ref), ([(520, 0), (900, 0)], "")), [first])):
            self.assertEqual(self.runways(*pieces)[0], expected)

    def test_displaced_thresholds(self):
        main = [(-600, 0), (800, 0)], "ref=9/27, width=30"
        for tags in ("runway=displaced_threshold, ref=9/27", "runway=displaced_threshold",
                     "aeroway=displaced_threshold"):
            self.assertEqual(self.runways(([(-600, 0), (-900, 0)], tags), main)[0],
                             [("9/27", 1700, 90, "30", 300, 0)], tags)
        found, _ = self.runways(([(900, 0), (-900, 0)], "ref=09/27"), thresholds=[(-890, 0), (700, 3), (500, 200)])
        self.assertEqual(found, [("09/27", 1800, 90, None, 0, 200)])

    def test_runways_that_are_left_out(self):
        real = ([(-800, 0), (800, 0)], "ref=09/27")
        other, strip, short = ([(-x, 550), (x, 550)] for x in (200, 100, 70))
        for reason, points, several, areas in (
                ("private (access)", other, ("access=private",), ()), ("ruins, or gone", other, ("end_date=1999",), ()),
                ("out of use", other, ("abandoned=yes", "runway=disused", "disused:aeroway=runway", "disused=yes",
                                       "operational_status=closed", "runway=closed"), ()),
                ("not built", other, ("proposed:aeroway=runway", "construction=yes"), ()),
                ("a runway on water", other, ("surface=water",), ()), ("a runway shorter than 150 m", short, ("",), ()),
                ("of a model airfield", other, ("sport=model_aerodrome",), ()),
                ("of a model airfield", strip, ("",), ("leisure=pitch, sport=model_aerodrome",))):
            for tags in several:
                self.assertEqual(self.runways(real, (points, tags), areas=areas),
                                 ([("09/27", 1600, 90, None, 0, 0)], [reason]), tags)
        for prefix in ("disused", "abandoned", "closed", "was", "razed", "construction"):
            found, out = self.runways(real, (other, f"aeroway=, {prefix}:aeroway=runway"))
            self.assertEqual((len(found), len(out)), (1, 1), prefix)
        self.assertEqual(len(self.runways(real, (strip, ""))[0]), 2)  # a short strip of its own
        with self.assertRaisesRegex(RuntimeError, "holds no runway.*left out: a runway on water"):
            self.runways((other, "surface=water"))


def taken(tags):
    """An extract of one area."""
    found = extract.Extract(KNOWN)
    found.take(tagged(tags), ogr.CreateGeometryFromWkt("POLYGON ((0 0, 1e-3 0, 1e-3 1e-3, 0 1e-3, 0 0))"))
    return found


class Heights(unittest.TestCase):
    def test_lengths(self):
        for text, metres in (
                ("12.5 m", 12.5), ("12,5", 12.5), ("10 ft", 3.048), ("5'6\"", 1.6764), ("5 ft 6 in", 1.6764),
                ("2;3", 3), ("12-15", 15), ("~9", 9), ("1,200 ft", 365.76), ("1,234.5 ft", 376.2756),
                ("1 200 ft", 365.76), ("12,500", 12.5), ("0.012 km", 12), ("350 cm", 3.5), ("2000 mm", 2),
                ("10 yd", 9.144), ("30 m AGL", 30), ("2 storeys", 6), ("12\xb11 m", 12), ("12m 50cm", 12.5),
                ("12 \u043c", 12), ("\uff11\uff12", 12),
                *((text, None) for text in ("1'200", "120 m AMSL", "9 m 4 in", "three", "-3", "0", "5000", "nan", "",
                                            None, "1" + " " * 100_000 + "x"))):
            found = _features.length_of(text)
            self.assertEqual(found if found is None else round(found, 9), metres, text)
        for text, levels in (("2;3", 3), ("2,3", 3), ("1,5", 1.5), ("2-3", 3), ("3+1", 4), ("2 floors", 2),
                             *((text, None) for text in ("0", "ground", "B1", "1e3", "250", None))):
            self.assertEqual(_features.levels_of(text), levels, text)

    def test_heights_of_tags(self):
        for tags, *expected in (
                ("building=yes, building:levels=2, roof:height=1.5", "building", 7.5, None, True),
                ("building=hangar, building:levels=3", "hangar", 18, None, True),
                ("building=yes, height=14, min_height=10 m", "building", 14, 10, False),
                ("building:part=yes, building:levels=6, building:min_level=2", "part", 18, 6, True),
                ("building=yes, height=5, min_height=9", "building", 5, None, False),
                ("building=no, building:part=yes, height=5", "part", 5, None, False),
                ("building=false, man_made=chimney, height=5", "chimney", 5, None, False),
                ("building=roof, height=8", "canopy", 8, 7.5, False),
                ("building:part=yes, min_height=40", "part", 48, 40, True),
                ("aeroway=jet_bridge, area=yes", "jet_bridge", 7, 4, True),
                ("theme=buildings, type=building, class=hangar, height=17.5", "hangar", 17.5, None, False),
                ("power=generator, generator:source=wind", "turbine", 100, None, True),
                ("power=generator, height=7", "obstacle", 7, None, False)):
            one, = taken(tags).done().features
            row = _features.properties_of(one, KNOWN)
            assumed = "assumed" in row.get("height_from", row.get("top_from"))
            self.assertEqual([row["kind"], row.get("height", row.get("top")), row.get("min_height"), assumed], expected,
                             tags)

    def test_parts_stand_in_place_of_their_building(self):
        """A terminal of which a tower and a low part are drawn, one that is all parts, and a canopy that does not reach
        the ground."""
        plan = runway()
        for low, high, tags in (((0, 200), (100, 300), "building=terminal, height=20, name=Hall"),
                                ((0, 200), (50, 300), "building:part=yes, height=6"),
                                ((60, 220), (70, 230), "building:part=yes, height=35, min_height=20"),
                                ((200, 200), (300, 300), "building=yes, height=30, name=All parts"),
                                ((200, 200), (300, 250), "building:part=yes, height=30"),
                                ((200, 250), (300, 300), "building:part=yes, height=10"),
                                ((400, 200), (450, 250), "building=roof, height=8, min_height=6")):
            plan.area(low, high, **tagged(tags))
        plan.way([(500, 200), (540, 200)], aeroway="jet_bridge", width="4")
        folder, words = ta.made("parts", plan.write("parts.osm"))
        self.assertIn("1 drawn by its parts", words)
        scene, found = ta.blocks(folder)
        self.assertNotIn("All parts", found)
        for name, low, high in (("Hall", 0, 20), ("Canopy", 6, 8), ("Jet bridge", 4, 7)):
            z = found[name][1][:, :, 2]
            np.testing.assert_allclose((z.min(), z.max()), (low, high), atol=0.1, err_msg=name)
        self.assertAlmostEqual(ta.plan_area(found["Hall"][1]), 5000, delta=5)
        self.assertAlmostEqual(ta.plan_area(found["Part"][1]), 5000 + 100 + 1e4, delta=15)
        self.assertAlmostEqual(siting.ground_of(scene, [(425.0, 225.0)])[0], 0.0, delta=0.1)  # below the canopy


class LeftOut(unittest.TestCase):
    def test_all_are_counted(self):
        """Each reason takes some of the buildings and obstacles."""
        plan = runway()
        for x, tags in enumerate((
                "building=ruins", "demolished:building=yes", "building=yes, end_date=2001-05-01",
                "proposed:building=yes", "building=yes, start_date=2999", "building=yes, level=-2;-1",
                "building=yes, location=underground", "building=no", "building=yes", "building=yes, height=tall")):
            plan.area((12 * x, 300), (12 * x + 8, 310), **tagged(tags))
        plan.way([(0, 400), (10, 400), (10, 410)], building="yes")
        plan.way([(0, 450), (0, 450), (0, 450), (0, 450)], True, building="yes")
        plan.area((9000, 0), (9010, 10), building="yes")
        for x, y, tags in ((20, 400, "building=house"), (-100, 300, "power=generator, height=30"),
                           (-120, 300, "power=generator, generator:source=solar"), (-140, 300, "shop=kiosk")):
            plan.point(x, y, **tagged(tags))
        folder, words = ta.made("left", plan.write("left.osm"))
        line = next(line for line in words.splitlines() if "features were read" in line)
        self.assertTrue(line.startswith("18 features were read, 4 are in the scene, 14 were left out: "), line)
        self.assertTrue(line.endswith("; 1 height was not understood: 'tall'"), line)
        for part in ("1 outside the scene", "3 ruins, or gone", "2 not built", "2 below ground", "2 unknown kind",
                     "1 unclosed", "1 no extent", "1 no building", "1 a point without an outline"):
            self.assertIn(part, line)
        with open(folder / "assumed.csv", encoding="utf-8", newline="") as stream:
            table = list(csv.reader(stream))[1:]
        counted = {what: sum(int(row[4]) for row in table if row[3] == what) for what in ("left out", "in the scene")}
        self.assertEqual(counted, {"left out": 14, "in the scene": 4})
        self.assertIn("assumed: no rule knows power=generator", [row[5] for row in table])
        mast = next(row for row in ta.rows(folder) if row["kind"] == "obstacle")
        self.assertEqual((mast["top"], mast["top_from"]), (30.0, "height"))

    def test_all_runways_come_first(self):
        for tags in KNOWN["kinds"]["runway"]["tags"]:
            said = " ".join(f"{name} {value}" for name, value in tags.items())
            self.assertTrue(any(word in said for word in _osm.FIRST), said)

    def test_distant_features_make_no_difference(self):
        """The scene is the same as if the rules had looked at everything, in XML and GeoJSON, with bounds and
        without."""
        plan = runway()
        for i, j in itertools.product(range(-8, 9), repeat=2):
            plan.area((500 * i, 500 * j + 60), (500 * i + 120, 500 * j + 90), building="yes", name=f"{i} {j}")
            plan.way([(500 * i, 500 * j), (500 * i + 900, 500 * j + 900)], barrier="wall", height="3")
        plan.way([(-9000, -1950), (9000, -1950)], barrier="fence", height="2")
        file, whole = plan.write("apart.osm"), ta.FOLDER / "apart.geojson"
        gdal.VectorTranslate(str(whole), str(file), layers=["lines"])
        for source, bounds in ((file, None), (whole, None), (file, (13.28, 53.59, 13.36, 53.63)),
                               (whole, (13.2, 53.59, 13.3, 53.61))):
            kept = []
            for reads_all in (False, True):
                all_ = mock.patch.object(_osm, "_lies_apart", lambda *_: False)
                with warnings.catch_warnings(), all_ if reads_all else contextlib.nullcontext(), _gdal.quiet():
                    warnings.simplefilter("ignore")
                    airport = AirportMap(source, bounds=bounds)
                    kept.append(sorted((row["kind"], row.get("name", ""), shape.ExportToWkt())
                                       for row, shape in airport.mapped(airport.chosen(airport.heights()))))
                apart = sum(one.count for one in airport.left if one.kind == "any kind")
                self.assertEqual(apart > 100, not reads_all, (source, bounds))
            self.assertEqual(*kept, (source, bounds))
            self.assertGreater(len(kept[0]), 20)

    def test_numbers_that_are_not_understood(self):
        """Texts of heights, storeys and widths. A height of -1, as in Microsoft's footprints, means that the height is
        not known."""
        plan = runway()
        for x, tag in enumerate(("height=-5", "height=0", "height=-0.5", "height=-1.0", "building:levels=-1",
                                 "building:levels=1e3", "building:levels=B1", "building:levels=0")):
            plan.area((20 * x, 300), (20 * x + 10, 310), building="yes", **tagged(tag))
        plan.point(0, 400, natural="tree", height="-3")
        for y, width in ((500, "-30"), (600, "0"), (700, "abc"), (800, "1e3"), (900, "61")):
            plan.way([(-800, y), (800, y)], aeroway="runway", width=width)
        folder, words = ta.made("strange", plan.write("strange.osm"))
        self.assertIn("; 7 heights were not understood: '-5', '0', '-0.5', '-1'; 4 widths were not understood: "
                      "'-30', 'abc', '0', '1e3'\n", words)
        self.assertIn("strange.osm says no height of any building", words)
        self.assertNotIn("are from assumed", (folder / "README.txt").read_text("utf-8"))
        self.assertEqual(sorted(row["width"] for row in ta.rows(folder) if row["kind"] == "runway"), 5 * [45] + [61])

    def test_storeys_and_layers(self):
        """`layer` orders drawings and is not a height; `level` is a storey; `indoor` is in a building. A feature with
        `building=no` does not become a building."""
        for reason, *several in (
                ("", "building=terminal, layer=-1", "building:part=yes, layer=-2", "man_made=chimney, layer=-1",
                 "building=terminal, level=-1;0;1", "building=train_station, indoor=yes", "building=yes, indoor=no",
                 "building:part=no, building=yes"),
                ("below ground", "building=yes, level=-1", "building=yes, level=-3--1",
                 "building=yes, layer=-1, location=underground"),
                ("indoors", "building=yes, indoor=room, level=1", "building:part=yes, indoor=area",
                 "man_made=tower, indoor=yes"),
                ("no building", *(f"building={word}" for word in ("no", "No", "false", "0", "none", "no, height=9")))):
            for tags in several:
                found = taken(tags)
                self.assertEqual([one.reason for one in found.left], [reason] if reason else [], tags)
                self.assertEqual(len(found.done().features), not reason, tags)

    def test_roofs(self):
        """On the roof, or on the higher part below; from the ground by `min_height`; beside all roofs; also on a slope,
        on which the building stands on its lowest ground."""
        plan = runway()
        plan.area((0, 300), (40, 340), building="yes", height="20")
        plan.area((20, 300), (40, 340), building__part="yes", height="30")
        plan.area((200, 300), (240, 340), building="yes")
        for x, where, tags in ((10, "Roof", "man_made=mast, height=6"), (30, "rooftop", "man_made=antenna, height=6"),
                               (5, "outdoor; roof", "man_made=mast, height=26, min_height=20"),
                               (220, "roof;outdoor", "man_made=mast"), (-0.5, "on_roof", "man_made=mast, height=5"),
                               (100, "on_roof", "man_made=mast, height=5"), (12, "on_roof", "natural=tree, height=4")):
            plan.point(x, 320, location=where, name=str(x), **tagged(tags))
        plan.area((2, 302), (8, 308), **tagged("power=generator, height=2, location=roof, name=solar"))
        dem, file = ta.slope("roofs.tif"), plan.write("roofs.osm")
        for words, rise in (((), 0.0), (("--heights", dem), 0.04)):
            folder, said = ta.made("roofs", file, *words)
            found = {row["name"]: (row.get("min_height", 0.0), row["top"]) for row in ta.rows(folder) if "name" in row}
            for name, low, high, at in (("10", 20, 26, 10), ("30", 30, 36, 10), ("5", 20, 26, 0), ("220", 8, 28, 20),
                                        ("-0.5", 20, 25, -0.5), ("solar", 20, 22, 5)):
                np.testing.assert_allclose(found.pop(name), np.array((low, high)) - rise * at, atol=0.05, err_msg=name)
            self.assertEqual(found, {})
            self.assertIn("1 on a roof that the scene lacks", said)
            self.assertIn("1 a plant on a roof", said)
        parts = airport_pages.parts_of(al.load_scene(folder / "airport.lidarscene.json"))
        mast = next(triangles for name, _, triangles in parts if name == "Mast")
        near = mast[np.abs(mast[:, :, 0].mean(axis=1) - 10) < 1]
        self.assertAlmostEqual(np.ptp(near[:, :, 2]), 6, delta=0.05)
        self.assertEqual({row["min_height_from"] for row in ta.rows(folder) if row.get("name") == "220"},
                         {"the roof, assumed"})


class Holes(unittest.TestCase):
    def test_is_near(self):
        """Holes are free, with their margin: a moat around an airport, a clearing in a wood."""
        ring = np.array([(0, 0), (100, 0), (100, 100), (0, 100)], float)
        hole = ring * 0.6 + 20
        for outline in ([ring, hole], [ring, hole[::-1]]):
            near = siting.is_near([(50, 50), (10, 50), (50, 25), (-5, 50), (150, 50)], outline)
            self.assertEqual(near.tolist(), [False, True, False, False, False])
            self.assertEqual(siting.is_near([(50, 50), (50, 25), (-5, 50)], outline, 10.0).tolist(),
                             [False, True, True])


class Tables(unittest.TestCase):
    """Surveyed obstacles in CSV."""

    def read(self, text):
        file = ta.FOLDER / "obstacles.csv"
        file.write_text(text, "utf-8")
        found, out = obstacles.read_obstacles([file], KNOWN)
        return [(one.kind, *(round(c, 6) for c in one.shape.GetPoint_2D()), round(float(one.tags["height"]), 3),
                 one.tags["height_source"]) for one in found], [one.reason for one in out]

    def test_columns_and_units(self):
        for text, *expected in (
                ("longitude,latitude,height,unit,kind\n13.302,53.603,45,m,CABLE CAR PYLON\n"
                 "13.303,53.604,100,ft,12 MAIN STREET\n", ("mast", 13.302, 53.603, 45),
                 ("obstacle", 13.303, 53.604, 30.48)),
                ("Longitude;Latitude;Height (ft)\n13,302;53,603;1,200\n13,302;53,603;100'\n13,302;53,603;30 m\n",
                 *(("obstacle", 13.302, 53.603, m) for m in (365.76, 30.48, 30))),
                ("lat\tlon\theight_m\tname\n53\u00b036'10.8\"N\t013\u00b018'07.2\"E\t45\tx\n",
                 ("obstacle", 13.302, 53.603, 45)),
                ("latitude,longitude,height,uom\n533610.8N,0131807.2W,45,M\n", ("obstacle", -13.302, 53.603, 45)),
                ("longitude,latitude,height\n13.302,53.603,45\n", ("obstacle", 13.302, 53.603, 45)),
                ("OAS,LATDEC,LONDEC,TYPE,QUANTITY,AGL,AMSL\n01-1,53.603,13.302,BLDG-TWR,1,00120,00240\n",
                 ("tower", 13.302, 53.603, 36.576))):
            said = "surveyed, obstacles.csv" + ", m assumed" * text.startswith("longitude,latitude,height\n")
            self.assertEqual(self.read(text), ([(*one, said) for one in expected], []), text)
        pylons = "# obstacles\n# of a State\nlongitude,latitude,height,kind\n13.302,53.603,45,{}\n13.303,53.603,45,{}\n"
        found, _ = self.read(pylons.format("TRANSMISSION_LINE", "T-L"))
        self.assertEqual([one[0] for one in found], ["mast", "mast"])

    def test_obstacles_that_are_left_out(self):
        for text, expected in (("13.302,53.603,100,ft,mast\n13.302,53.603,30.48,m,mast\n13.302,53.603,31,m,mast",
                                [aixm.TWICE]),
                               ("13.302,53.603,45,m,mast\n13.303,53.603,45,furlong,mast\n13.304,53.603,45,m,BALLOON\n"
                                "13.305,53.603,45,m,Natural high point\n13.306,53.603,45,m,URBAN\n"
                                "13.307,53.603,45,km,mast",
                                ["height in 'furlong', expected m or ft", "a balloon", "a part of the ground",
                                 "a group of obstacles without places", "height above 1,000 m"]),
                               ("13.302,53.603,,m,mast\n13.302,,45,m,mast\n13.302,99,45,m,mast\n",
                                3 * [obstacles.NO_PLACE])):
            self.assertEqual(self.read(f"longitude,latitude,height,unit,kind\n{text}\n")[1], expected)
        with self.assertWarnsRegex(RuntimeWarning,
                                   "obstacles.csv: none of its obstacles can stand in the scene: 1 a wire"):
            self.read("longitude,latitude,height,kind\n13.302,53.603,45,wire\n")

    def test_wrong_files_are_named(self):
        head = "longitude,latitude,height\n"
        for name, text, words in (
                ("obstacles.csv", "a,b,c\n1,2,3\n", "expected the columns longitude"),
                ("obstacles.csv", head + '1,2,3\n"1,2,3\n1,2,3\n', "obstacles.csv: line 3: is not CSV"),
                ("obstacles.csv", head + '"1,2,3\n"1",2,3\n', "obstacles.csv: line 2: is not CSV"),
                ("bad.xml", "<a>", "cannot be read as AIXM 5.1"), ("other.xml", "<a/>", "holds no VerticalStructure"),
                ("x.txt", "", "is not a file of obstacles by its name")):
            (ta.FOLDER / name).write_text(text)
            with self.assertRaisesRegex(RuntimeError, words):
                obstacles.read_obstacles([ta.FOLDER / name], KNOWN)


def within(path, content=""):
    """A content within elements of XML, from the outer to the inner, with attributes as in `a b@uom=M`."""
    for word in reversed(path.split()):
        name, *pairs = word.split("@")
        attributes = "".join(' {}="{}"'.format(*pair.split("=", 1)) for pair in pairs)
        content = f"<{name}{attributes}>{content}</{name}>"
    return content


NAMES = "xmlns:{0}=http://www.aixm.aero/schema/5.1.1{1}".format
ROOT = (f"message:AIXMBasicMessage@{NAMES('message', '/message')}@{NAMES('aixm', '')}"
        "@xmlns:gml=http://www.opengis.net/gml/3.2")
URN = "urn:ogc:def:crs:EPSG::4326"


def pos(lat=53.603, lon=13.302, system=URN):
    return within(f"aixm:horizontalProjection_location aixm:ElevatedPoint@srsName={system}",
                  f"<gml:pos>{lat} {lon}</gml:pos>{{}}")


def surface(ring):
    return within(f"aixm:horizontalProjection_surfaceExtent aixm:ElevatedSurface@srsName={URN}",
                  within("gml:patches gml:PolygonPatch gml:exterior", ring) + "{}")


SQUARE = "53.603 13.302 53.603 13.3026 53.6033 13.3026 53.6033 13.302"
LINEAR = within("gml:LinearRing gml:posList", f"{SQUARE} 53.603 13.302")
LINE = within(f"aixm:horizontalProjection_linearExtent aixm:ElevatedCurve@srsName={URN}",
              within("gml:segments gml:GeodesicString gml:posList", "53.603 13.302 53.604 13.303") + "{}")
GROUP = within("aixm:group", "YES")


def period(path, begin, end):
    return within(f"{path} gml:TimePeriod", within("gml:beginPosition", begin) + within("gml:endPosition", end))


def part(height="45", place=pos(), elevation="", kind="", uom="M", light="", more=""):
    """A VerticalStructurePart. @param elevation of the top, m, or with @ and the unit"""
    top, _, unit = elevation.partition("@")
    place = place.format(within(f"aixm:elevation@uom={unit or 'M'}", top) if elevation else "")
    return within("aixm:part aixm:VerticalStructurePart", (
        (within("aixm:verticalExtent" + f"@uom={uom}" * bool(uom), height) if height else "")
        + (within("aixm:type", kind) if kind else "") + more + place
        + (within("aixm:lighting aixm:LightElement aixm:type", light) if light else "")))


def piece(parts=part(), kind="TOWER", interpretation="BASELINE", sequence="1", correction="0", valid=("2019-01-01", ""),
          more="", name="x"):
    """A time slice. @param valid first and last day, or XML of gml:validTime"""
    return within("aixm:timeSlice aixm:VerticalStructureTimeSlice",
                  (valid if isinstance(valid, str) else period("gml:validTime", *valid)) + "".join(
                      within(f"aixm:{word}", value) for word, value in (
                          ("interpretation", interpretation), ("sequenceNumber", sequence),
                          ("correctionNumber", correction), ("name", name), ("type", kind)) if word != "type" or value)
                  + more + parts)


class Published(unittest.TestCase):
    """What States publish in AIXM 5.1 (eTOD)."""

    def features(self, *structures, more=()):
        """@param structures time slices @param more structures of a second file"""
        files = []
        for name, some in (("one.xml", structures), ("two.xml", more)):
            members = (within(f"message:hasMember aixm:VerticalStructure@gml:id={'ABCDEFG'[number]}", one)
                       for number, one in enumerate(some))
            (ta.FOLDER / name).write_text(within(ROOT, "".join(members)), "utf-8")
            files += [ta.FOLDER / name] * bool(some)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return obstacles.read_obstacles(files, KNOWN)

    def read(self, *structures, more=()):
        """What stands: kind, form, least height and height (m); and the reasons of what does not."""
        found, out = self.features(*structures, more=more)
        return [(one.kind, _gdal.form_of(one.shape), float(one.tags.get("min_height", 0)),
                 float(one.tags.get("height", 0))) for one in found], [one.reason for one in out]

    def test_places_and_heights_above_the_sea(self):
        """An elevation alone becomes a height above the ground of --heights, which rises by 4 % to the east."""
        found, out = self.features(
            piece(part("150", uom="FT", elevation="81"), "ANTENNA"), piece(part("12", surface(LINEAR)), "BUILDING"),
            piece(part("", pos(13.305, 53.603, "urn:ogc:def:crs:OGC:1.3:CRS84"), "400@FT"), "STACK"),
            piece(part("", ""), "POLE", name="NOWHERE"))
        self.assertEqual([(one.kind, one.id, _gdal.form_of(one.shape)) for one in found],
                         [("mast", "A", "point"), ("building", "B", "area"), ("chimney", "C", "point")])
        self.assertEqual([(one.kind, one.name, one.reason) for one in out], [("pole", "NOWHERE", obstacles.NO_PLACE)])
        self.assertEqual([found[i].shape.GetPoint_2D() for i in (0, 2)], [(13.302, 53.603), (13.305, 53.603)])
        self.assertAlmostEqual(float(found[0].tags["height"]), 45.72, delta=1e-3)
        folder, _ = ta.made("survey", runway().write("survey.osm"), "--heights", ta.slope("survey.tif"),
                            "--obstacles", ta.FOLDER / "one.xml")
        tops = {row["id"]: row for row in ta.rows(folder) if row["id"] in "ABC"}
        east = siting.to_enu([(13.305, 53.603)], ta.HERE)[0, 0]
        self.assertAlmostEqual(tops["C"]["top"], 400 * 0.3048 - (100 + 0.04 * east), delta=0.1)
        self.assertEqual((tops["B"]["height"], tops["B"]["height_from"]), (12.0, "height: surveyed, one.xml"))

    def test_kinds(self):
        """The type of a part, else of the structure, and never of a light. In the table, + marks a group."""
        forms = {"point": part(), "area": part(place=surface(LINEAR)), "line": part(place=LINE)}
        for form, kinds, expected in (
                ("area", "VEGETATION VEGETATION+", "wood"), ("area", "COOLING_TOWER", "tower"),
                ("area", "BRIDGE", "skybridge"), ("area", "POWER_PLANT", "building"), ("line", "TREE", "tree"),
                ("line", "FENCE", "fence"), ("line", "DAM BUILDING OTHER:X", "wall"), ("point", "TREE+", "tree"),
                ("point", "WINDMILL_FARMS", "turbine"), ("point", "ANTENNA+", "mast"),
                ("point", "NATURAL_GAS_SYSTEM", "obstacle"), ("point", "OTHER:WINDSOCK", "pole"),
                ("area", "POWER_PLANT+ WINDMILL_FARMS+ WINDMILL_FARMS URBAN", [obstacles.GROUP]),
                ("line", "WINDMILL_FARMS", [obstacles.GROUP]), ("point", "URBAN", [obstacles.GROUP]),
                ("line", "POLE BRIDGE", [obstacles.NO_WALL]), ("line", "CATENARY", ["a wire"]),
                ("point", "NATURAL_HIGHPOINT", ["a part of the ground"]), ("point", "TETHERED_BALLOON", ["a balloon"])):
            for kind in kinds.split():
                found, out = self.read(piece(forms[form], kind.rstrip("+"), more=GROUP * kind.endswith("+")))
                self.assertEqual([one[:2] for one in found] or out,
                                 expected if isinstance(expected, list) else [(expected, form)], (form, kind))
                self.assertEqual(len(found) + len(out), 1)
        for one, expected in (
                (piece(part(light="OTHER:FLASHING"), "ANTENNA"), ["mast"]),
                (piece(part(place=surface(LINEAR), light="ICAO_MIA"), "BUILDING"), ["building"]),
                (piece(part(kind="OTHER:CHIMNEY"), "BUILDING"), ["chimney"]),
                (piece(part(kind="OTHER"), "CRANE"), ["crane"]), (piece(part(), "", name="WATER TOWER"), ["tower"]),
                (piece(part(), "", name="Balloon hill"), ["obstacle"]),
                (piece(part(more=within("aixm:mobile", "YES")), "CRANE"), [aixm.MOBILE]),
                (piece(part(more=within("aixm:mobile", "NO")), "CRANE"), ["crane"])):
            found, out = self.read(one)
            self.assertEqual([row[0] for row in found] + out, expected, one)

    def test_lengths(self):
        for one, expected in (
                (part("100", uom="FT"), 30.48), (part("45", uom="m"), 45), (part("4500", uom="CM"), 45),
                (part("1,200", uom="FT"), 365.76), (part("45", uom="FL"), "height in 'fl', expected m or ft"),
                (part("5000"), "height above 1,000 m"), (part("45", elevation="GND"), 45), (part("45", uom=""), 45),
                (part("", elevation="-3"), 0), (part("45", elevation="9@FL"), 45),
                *((one, obstacles.NO_PLACE) for one in (part("0"), part("-5"), part("tall"), part(""), "",
                                                        part("45", place="")))):
            found, out = self.read(piece(one))
            self.assertEqual(found[0][3] if found else out[0], expected, one)

    def test_extents_of_points(self):
        """A radius, or a length and a width, of buildings and trees are their own; the radius of a mast is of its
        wires."""
        def extent(**lengths):
            return "".join(within(f"aixm:{name}@uom=M", length) for name, length in lengths.items())

        for kind, lengths, area, width in (
                ("STADIUM", {"radius": 90}, math.pi * 90**2, None), ("TREE", {"radius": 4}, 0, "8.000"),
                ("BUILDING", {"length": 23, "width": 12}, 276, None), ("BUILDING", {"length": 23}, 0, None),
                ("VEGETATION", {"radius": 200}, math.pi * 200**2, None), ("STACK", {"radius": 5}, math.pi * 25, None),
                ("TOWER", {"radius": 60}, 0, None), ("ANTENNA", {"radius": 60}, 0, None),
                ("WINDMILL", {"radius": 50}, 0, None), ("POLE", {"radius": 9.3}, 0, None)):
            (one,), out = self.features(piece(kind=kind, more=extent(**lengths)))
            self.assertAlmostEqual(in_metres(one.shape).Area(), area, delta=0.01 * area, msg=(kind, lengths))
            self.assertEqual((one.tags.get("width"), out), (width, []), (kind, lengths))
            self.assertEqual("a disc of its extent" in one.tags["height_source"], area > 0)
        self.assertEqual(self.read(piece(kind="ANTENNA", more=extent(radius=60) + GROUP)), ([], [obstacles.GROUP]))

    def test_time_slices(self):
        """Heights of 1, 2 and 3 m in slices, and which of them is the state of today. In the table, D marks changes for
        good (PERMDELTA) and T temporary ones (TEMPDELTA)."""
        def at(height, sequence="1", correction="0", begin="2019-01-01", end="", mark="", **more):
            interpretation = {"": "BASELINE", "D": "PERMDELTA", "T": "TEMPDELTA", "S": "SNAPSHOT"}[mark]
            return piece(part(str(height)) if height else "", interpretation=interpretation, sequence=sequence,
                         correction=correction, valid=more.pop("valid", (begin, end)), **more)

        def lives(end):
            return {"more": period("aixm:featureLifetime", "2009-01-01", end)}

        instant = within("gml:validTime gml:TimeInstant gml:timePosition", "2019-01-01T00:00:00Z")
        nil = within("gml:validTime@xsi:nil=true@nilReason=inapplicable"
                     "@xmlns:xsi=http://www.w3.org/2001/XMLSchema-instance")
        then, later = "2019-06-01", "2999-01-01"
        for slices, expected in (
                ((at(1), at(2, correction="1")), 2), ((at(2, correction="1"), at(1)), 2), ((at(1), at(2, "2")), 2),
                ((at(1, correction="9"), at(2, correction="10")), 2), ((at(1), at(2, "2", begin=later)), 1),
                ((at(1, end=then), at(2, "2", begin=then)), 2), ((at(1, end=later),), 1), ((at(1, valid=""),), 1),
                ((at(1, end=then + "T12:00:00Z"),), aixm.ENDED), ((at(1, begin=later),), aixm.FUTURE),
                ((at(1, end="01.06.2019"),), aixm.NO_DATE), ((at(1, "", "", valid=instant, mark="S"),), 1),
                ((at(1, end=then), at(2, "2", begin=later)), aixm.FUTURE), ((at(1, **lives(then)),), aixm.ENDED),
                ((at(1), at(2, valid=nil, correction="1")), aixm.ENDED), ((at(1, **lives(later)),), 1),
                ((at(1), at(2, "2", valid=instant, mark="D")), 2), ((at(2, "2", mark="D"), at(1)), 2),
                ((at(1), at(2, "2", begin=later, mark="D")), 1), ((at(1), at(0, "2", kind="CRANE", mark="D")), 1),
                ((at(1), at(2, "2", mark="D"), at(3, "2", "1", mark="D")), 3), ((at(2, mark="D"),), 2),
                ((at(1, mark="D"), at(2, "2"), at(3, "2", mark="D")), 2), ((at(0, mark="D"),), aixm.NO_BASELINE),
                ((at(1), at(0, "2", mark="D", **lives(then))), aixm.ENDED), ((at(1), at(2, end=later, mark="T")), 2),
                ((at(1), at(2, end=then, mark="T")), 1), ((at(2, end=then, mark="T"),), aixm.ENDED),
                ((), obstacles.NO_PLACE)):
            found, out = self.read("".join(slices))
            self.assertEqual((found[0][3], out) if found else out, (expected, []) if found else [expected], slices)

    def test_structures_in_several_files(self):
        """Slices of one structure belong together; what is equal stands once."""
        a, b = (f'<gml:identifier codeSpace="urn:uuid:">{name}0c</gml:identifier>' for name in "ab")
        update = a + piece(part("2"), interpretation="PERMDELTA", sequence="2")
        for one, more, *expected in (
                (a + piece(), update, [2], []), (update, a + piece(), [2], []),
                (a + piece(), b + piece(part("2")), [45, 2], []), (a + piece(), a + piece(), [45], [aixm.TWICE]),
                (piece(), piece(name="y"), [45], [aixm.TWICE]),
                (piece(), piece(part("147.638", uom="FT")), [45], [aixm.TWICE]),
                (piece(), piece(part(place=pos(53.604))), [45, 45], [])):
            found, out = self.read(one, more=(more,))
            self.assertEqual([[row[3] for row in found], out], expected, more)

    def test_parts_on_parts(self):
        """The height of a part is above its bottom, as of an antenna on a roof; two turbines stand on the ground."""
        roof, on_it = part("20", surface(LINEAR), "70", "BUILDING"), pos(53.6031, 13.3022)
        for parts, expected in (
                (roof + part("6", on_it, "76", "ANTENNA"), [(0, 20), (20, 26)]),
                (part("6", on_it, "", "ANTENNA") + roof, [(20, 26), (0, 20)]),
                (roof + part("30", on_it, "80", "TOWER"), [(0, 20), (0, 30)]),
                (roof + part("6", pos(53.61), "76", "ANTENNA"), [(0, 20), (0, 6)]),
                (part("120", pos(), "170") + part("15", pos(), "185") + part("2", pos(), "187"),
                 [(0, 120), (120, 135), (135, 137)]),
                (part("120", pos(), "170") + part("120", pos(53.61), "190"), [(0, 120), (0, 120)]),
                (roof + part("", on_it, "76"), [(0, 20), (0, 0)])):
            found, out = self.read(piece(parts))
            self.assertEqual(([row[2:] for row in found], out), (expected, []), parts)

    def test_geometries(self):
        """Rings that are open, in pieces, in three dimensions; those that cannot be read are left out alone."""
        curve = "gml:curveMember gml:Curve gml:segments"

        def ring(*pieces, segment="GeodesicString"):
            return within("gml:Ring", "".join(within(f"{curve} gml:{segment} gml:posList", one) for one in pieces))

        circle = within(f"gml:Ring {curve} gml:CircleByCenterPoint@numArc=1",
                        within("gml:pos", "53.603 13.302") + within("gml:radius@uom=M", 90))
        words, end, metres = SQUARE.split(), " 53.603 13.302", 33.4 * 39.7
        half, rest = " ".join(words[:4]), " ".join(words[4:]) + end
        above = " ".join(f"{word} 100" if number % 2 else word for number, word in enumerate(words))
        unreadable, no_degrees = (aixm.UNREADABLE,), (extract.NO_DEGREES,)
        for one, expected in (
                (LINEAR, metres), (ring(SQUARE + end), metres), (ring(SQUARE + " 53.6030009 13.3020001"), metres),
                (ring(SQUARE), metres), (LINEAR.replace(end + "<", "<"), metres), (circle, math.pi * 90**2),
                (ring(SQUARE + " 53.6030009 13.302", segment="LineStringSegment"), metres),
                (ring(half, " ".join(words[2:4]) + " " + rest), metres),
                (ring(half, "53.60300001 13.3026 " + rest), metres),
                (ring(above).replace("<gml:posList", '<gml:posList srsDimension="3"'), metres),
                (within("gml:LinearRing", "".join(within("gml:pos", f"{a} {b}")
                                                  for a, b in zip(words[::2], words[1::2]))), metres),
                (ring("53.603 13.302 53.6033 13.3026 53.603 13.3026 53.6033 13.302"), metres / 2),
                (ring("53.603 13.302 53.6033 13.3026"), unreadable), (ring("53.603 13.302 53.6033"), unreadable),
                (ring("53.603 13.302 53.6033 13.3026 53.603 13.302"), (extract.NO_EXTENT,)),
                (ring(SQUARE.replace("53.6033", "north")), unreadable),
                (ring(SQUARE.replace("53.6033", "nan")), unreadable + no_degrees),
                (ring(SQUARE.replace("53.6033", "253.6")), no_degrees),
                (within("gml:Ring gml:curveMember@xlink:href=#c@xmlns:xlink=http://www.w3.org/1999/xlink"),
                 (obstacles.NO_PLACE,))):
            found, out = self.features(piece(part("7", surface(one)), "BUILDING"), piece(part("9", pos(53.61))))
            self.assertEqual((found[-1].kind, found[-1].tags["height"]), ("tower", "9.000"), one)
            if isinstance(expected, float):
                self.assertEqual((len(found), out), (2, []), one)
                self.assertEqual(extract.CROSSING in found[0].tags, expected == metres / 2, one)
                self.assertAlmostEqual(in_metres(found[0].shape).Area(), expected, delta=0.02 * expected, msg=one)
            else:
                self.assertEqual((len(found), len(out)), (1, 1), one)
                self.assertIn(out[0].reason, expected, one)
        for place, reason in (
                (pos(99), extract.NO_DEGREES), (pos("north"), aixm.UNREADABLE), (pos(53.603, ""), aixm.UNREADABLE),
                (pos(system="urn:ogc:def:crs:EPSG::99999999"),
                 "the unknown coordinate system 'urn:ogc:def:crs:EPSG::99999999'"),
                (LINE.replace("53.604 13.303", "53.603 13.302"), extract.NO_EXTENT)):
            self.assertEqual(self.read(piece(part(place=place)), piece(part("9", pos(53.61)))),
                             ([("tower", "point", 0, 9)], [reason]), place)


class Areas(unittest.TestCase):
    def test_courtyards_that_touch_keep_their_area(self):
        """Random cells of a grid as courtyards, also given as islands, which GDAL makes of some. Expected: the cells by
        counting."""
        random, side = np.random.default_rng(8), 6
        for turn in range(40):
            cells = [(x, y) for x in range(1, side - 1) for y in range(1, side - 1) if random.random() < 0.5]
            ring, *holes = [f"((0 0, {side} 0, {side} {side}, 0 {side}, 0 0)"] + [
                f"({x} {y}, {x} {y + 1}, {x + 1} {y + 1}, {x + 1} {y}, {x} {y})" for x, y in cells]
            text = f"POLYGON {', '.join([ring, *holes])})"
            if turn % 3 == 0:
                text = f"MULTIPOLYGON ({', '.join([ring + ')', *(f'({hole})' for hole in holes)])})"
            shape = _gdal.valid(ogr.CreateGeometryFromWkt(text), nested=turn % 3 == 0)
            self.assertAlmostEqual(shape.Area(), side * side - len(cells), delta=1e-9, msg=text)
        apart = ogr.CreateGeometryFromWkt("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4, 0 0)), ((3 3, 6 3, 6 6, 3 6, 3 3)))")
        self.assertAlmostEqual(_gdal.valid(apart).Area(), 16 + 9 - 1, delta=1e-9)
        self.assertEqual(_gdal.valid(ogr.CreateGeometryFromWkt("LINESTRING (0 0, 1 1)")).Length(), math.sqrt(2.0))
