# SPDX-License-Identifier: BSD-3-Clause
"""Extracts of maps as tools write them: what of them becomes part of an airport's scene, and what is counted as left
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


def things(file):
    """Each feature that the rules take: kind, form, name, and its area (m2) or length (m)."""
    found = []
    for one in _osm.read_extract(file, KNOWN).features:
        shape = one.shape.Clone()
        shape.Transform(to_local())
        form = _gdal.form_of(shape)
        found.append((one.kind, form, one.tags.get("name", ""),
                      round({"area": shape.Area, "line": shape.Length}[form]() if form != "point" else 0)))
    return sorted(found)


def to_local():
    return osr.CoordinateTransformation(_gdal.degrees(), ta.coordinate_system(ta.HERE))


def left(file):
    """How many features are left out, by kind and reason."""
    found = {}
    for one in _osm.read_extract(file, KNOWN).left:
        found[one.kind, one.reason] = found.get((one.kind, one.reason), 0) + one.count
    return found


def rows(folder):
    return [feature["properties"]
            for feature in json.loads((folder / "airport.geojson").read_text(encoding="utf-8"))["features"]]


def runway(plan, **tags):
    plan.way([(-800, 0), (800, 0)], aeroway="runway", ref="09/27", width="45", **tags)
    return plan


def fenced():
    """Closed ways that are areas by some tags, lines by others, and both."""
    plan = runway(ta.Map())
    plan.area((-1500, -700), (1500, 700), aeroway="aerodrome", icao="XFEN", barrier="fence", height="3")
    for number, tags in enumerate(({"man_made": "storage_tank"}, {"landuse": "military", "barrier": "wall"},
                                   {"landuse": "grass", "barrier": "hedge"}, {"building": "yes", "height": "9"},
                                   {"building__part": "yes", "height": "12"}, {"amenity": "parking", "area": "yes"},
                                   {"highway": "footway", "surface": "asphalt"}, {"highway": "service", "area": "yes"},
                                   {"building": "construction"})):
        plan.area((60 * number, 300), (60 * number + 30 + number, 340), name=str(number), **tags)
    plan.way([(100, 100), (400, 100), (400, 200), (100, 200)], True, aeroway="taxiway")
    plan.way([(-400, 100), (-100, 100), (-100, 200), (-400, 200)], True, highway="service")
    plan.relation([plan.area((-600, 300), (-500, 400))], [plan.area((-570, 330), (-530, 370))], building="hangar",
                  height="12", name="ring")
    plan.relation([plan.area((-900, 300), (-800, 400), natural="wood")], [plan.area((-880, 320), (-820, 380))],
                  natural="wood", name="glade")
    plan.point(0, 500, man_made="mast", height="25")
    return plan


class Formats(unittest.TestCase):
    def test_one_map_in_four_formats(self):
        """PBF; GDAL's own idea of areas in a GeoPackage, in UTM; GeoJSON with each closed way twice, as by osmium, and
        with tags in one object."""
        file = fenced().write("fenced.osm")
        expected = things(file)
        kinds = [kind for kind, *_ in expected]
        self.assertEqual({kind: kinds.count(kind) for kind in set(kinds)},
                         {"runway": 1, "fence": 1, "wall": 1, "hedge": 1, "tank": 1, "mast": 1, "grass": 1,
                          "building": 1, "part": 1, "parking": 1, "wood": 1, "taxiway": 1, "road": 2, "hangar": 1})
        sizes = {(kind, name): size for kind, _, name, size in expected}
        for which, size in ((("tank", "0"), 30 * 40), (("wall", "1"), 2 * (31 + 40)), (("grass", "2"), 32 * 40),
                            (("hedge", "2"), 2 * (32 + 40)), (("hangar", "ring"), 1e4 - 40**2),
                            (("wood", "glade"), 1e4 - 60**2), (("taxiway", ""), 800),
                            (("fence", ""), 2 * (3000 + 1400))):
            self.assertAlmostEqual(sizes[which] / size, 1.0, delta=1e-3, msg=which)
        geopackage, twice, nested = (ta.FOLDER / f"fenced{name}"
                                     for name in (".gpkg", "-twice.geojson", "-nested.geojson"))
        geopackage.unlink(missing_ok=True)
        gdal.VectorTranslate(str(geopackage), str(file), format="GPKG", dstSRS="EPSG:32633")
        lines, nest = [], []
        for one in [*_osm.read_extract(file, KNOWN).features, *_osm.read_extract(file, KNOWN).aerodromes]:
            tags = {name: value for name, value in one.tags.items() if not name.startswith("osm_")}
            shape = json.loads(one.shape.ExportToJson())
            if shape["type"] == "Polygon" and len(shape["coordinates"]) == 1:
                ring = {"type": "LineString", "coordinates": shape["coordinates"][0]}
                lines += [(tags, ring), (tags, {"type": "MultiPolygon", "coordinates": [shape["coordinates"]]})]
            elif shape["type"] == "LineString" and shape["coordinates"][0] == shape["coordinates"][-1]:
                lines += [(tags, {"type": "Polygon", "coordinates": [shape["coordinates"]]}), (tags, shape)]
            else:
                lines.append((tags, shape))
            nest.append(({"type": "way", "id": 1, "tags": tags}, shape))
        for out, all_ in ((twice, lines), (nested, nest)):
            out.write_text(json.dumps({"type": "FeatureCollection", "features": [
                {"type": "Feature", "properties": tags, "geometry": shape} for tags, shape in all_]}))
        for other in (ta.pbf(file), geopackage, twice, nested):
            found = things(other)
            self.assertEqual([row[:3] for row in found], [row[:3] for row in expected], other)
            if other in (geopackage, ta.FOLDER / "fenced.osm.pbf"):
                twice = {("wood", extract.TWICE): 1} if other != geopackage else {}  # GDAL drops the outer way
                self.assertEqual(left(other), {("building", "not built"): 1, **twice}, other)
            np.testing.assert_allclose([row[3] for row in found], [row[3] for row in expected], atol=1.5,
                                       err_msg=str(other))

    def test_orders_of_xml(self):
        """Nodes from last to first, after ways, with negative ids, places in ways, and what an editor has deleted."""
        plan = fenced()
        file = plan.write("order.osm")
        expected = things(file)
        text = file.read_text(encoding="utf-8")
        places = dict(re.findall(r'<node id="(\d+)" version="1" (lat="\S+" lon="\S+")>', text))
        deleted = "".join(f'<node id="{i}" action="delete" lat="1" lon="{i}"/>' for i in (90001, 90002)) + (
            '<way id="90003" action="delete"><nd ref="90001"/><nd ref="90002"/><tag k="barrier" v="fence"/></way>')
        relations = "".join(plan.relations)
        in_ways = re.sub(r'<nd ref="(\d+)"/>', lambda found: f'<nd ref="{found[1]}" {places[found[1]]}/>',
                         "".join(plan.ways))
        tagged = "".join(row for row in plan.rows if "<tag" in row)
        for name, body in (("backwards", "".join(plan.rows[::-1] + plan.ways[::-1]) + relations),
                           ("after", relations + "".join(plan.ways + plan.rows)),
                           ("negative", re.sub(r'(id|ref)="', r'\1="-', "".join(plan.rows + plan.ways) + relations)),
                           ("geometry", tagged + in_ways + relations),
                           ("repeated",
                            "".join(row.replace('version="1"', "") for row in plan.rows + plan.rows[-1:] + plan.ways
                                    + plan.ways) + relations + relations),
                           ("deleted", deleted + "".join(plan.rows + plan.ways) + relations)):
            other = ta.FOLDER / f"{name}.osm"
            other.write_text(f'<?xml version="1.0"?><osm version="0.6">{body}</osm>', encoding="utf-8")
            self.assertEqual(things(other), expected, name)

    def test_what_the_border_cuts(self):
        """Closed ways of which one, two and three nodes of four are there, a way of none, and a relation of a way that
        is not."""
        plan = runway(ta.Map())
        text = plan.write("cut.osm").read_text(encoding="utf-8")
        nodes = "".join(f'<node id="{i}" lat="{53.603 + 1e-4 * (i % 2)}" lon="{13.301 + 1e-4 * (i // 2 % 2)}" '
                        'version="1"/>' for i in (900, 901, 903, 902))
        ways = "".join(f'<way id="{number}" version="1">' + "".join(f'<nd ref="{i}"/>' for i in refs)
                       + '<tag k="building" v="yes"/></way>'
                       for number, refs in ((910, (900, 991, 992, 993, 900)), (911, (900, 901, 992, 993, 900)),
                                            (912, (900, 901, 903, 993, 900)), (913, (991, 992, 993, 991)),
                                            (914, (991, 901, 903, 902, 991))))
        ways += '<way id="915"><nd ref="900"/><tag k="building" v="yes"/></way><way id="916"><tag k="building" v="yes"/></way>'
        relation = ('<relation id="920" version="1"><member type="way" ref="910" role="outer"/><member type="way" '
                    'ref="999" role="outer"/><tag k="type" v="multipolygon"/><tag k="natural" '
                    'v="wood"/></relation><relation id="921"><tag k="type" v="multipolygon"/><tag k="natural" '
                    'v="wood"/></relation>')
        # the runway goes on beyond the border
        text = text.replace('<tag k="aeroway"', '<nd ref="995"/><tag k="aeroway"')
        file = ta.FOLDER / "cut.osm"
        file.write_text(text.replace("<way", nodes + ways + "<way", 1).replace("</osm>", relation + "</osm>"),
                        encoding="utf-8")
        packed = ta.FOLDER / "packed.osm"  # nothing empty, which the test's own writer of PBF cannot write
        packed.write_text(re.sub('<way id="916">.*?</way>|<relation id="921">.*?</relation>', "",
                                 file.read_text(encoding="utf-8")), encoding="utf-8")
        for one in (file, ta.pbf(packed)):
            self.assertEqual([kind for kind, *_ in things(one)], ["runway"], one)
            self.assertEqual(left(one), {("building", extract.CUT): 4, ("way", extract.CUT): 1,
                                         ("relation", extract.CUT): 1,
                                         **({("way", "no nodes"): 2, ("relation", "no ways"): 1} if one is file
                                            else {("way", "no nodes"): 1})}, one)
        self.assertIn("a runway is cut by the extract's border", ta.run("airport", file, "-o", ta.fresh("cut"))[1])

    def test_areas_that_enclose_nothing(self):
        """A way there and back as a building, as the outer way of a wood, and as a hole and a second part of another
        wood."""
        text = runway(ta.Map()).write("back.osm").read_text(encoding="utf-8")
        nodes = "".join(f'<node id="{900 + i}" lat="{53.603 + 1e-4 * x}" lon="{13.301 + 1e-4 * y}"/>'
                        for i, (x, y) in enumerate(((0, 0), (2, 0), (2, 2), (0, 2), (1, 1), (3, 3))))
        ways = "".join(f'<way id="{number}">' + "".join(f'<nd ref="{900 + i}"/>' for i in refs) + tag + "</way>"
                       for number, refs, tag in ((910, (0, 1, 2, 1, 0), '<tag k="building" v="yes"/>'),
                                                 (911, (0, 1, 2, 1, 0), ""), (912, (0, 1, 2, 3, 0), ""),
                                                 (913, (0, 4, 0), ""), (914, (2, 5, 2), "")))
        relations = "".join(f'<relation id="{number}">'
                            + "".join(f'<member type="way" ref="{way}" role="{role}"/>' for way, role in members)
                            + '<tag k="type" v="multipolygon"/><tag k="natural" v="wood"/></relation>'
                            for number, members in ((920, ((911, "outer"),)),
                                                    (921, ((912, "outer"), (913, "inner"), (914, "outer")))))
        file = ta.FOLDER / "back.osm"
        file.write_text(text.replace("<way", nodes + ways + "<way", 1).replace("</osm>", relations + "</osm>"),
                        encoding="utf-8")
        self.assertEqual([kind for kind, *_ in things(file)], ["runway", "wood"])
        self.assertEqual(left(file), {("building", "no extent"): 1, ("wood", "no extent"): 1})
        ta.run("airport", file, "-o", ta.fresh("back"))

    def test_crossing_rings_are_named(self):
        """A bow tie is two triangles, and is said to be repaired; a sound building beside it is not."""
        text = runway(ta.Map()).write("bow.osm").read_text(encoding="utf-8")
        corners = ((0, 0), (2, 2), (2, 0), (0, 2), (5, 0), (6, 0), (6, 1), (5, 1), (8, 0), (10, 2), (10, 0), (8, 2))
        nodes = "".join(f'<node id="{900 + i}" lat="{53.603 + 1e-4 * x}" lon="{13.301 + 1e-4 * y}"/>'
                        for i, (x, y) in enumerate(corners))
        ways = "".join(f'<way id="{910 + k}">' + "".join(f'<nd ref="{900 + 4 * k + i}"/>' for i in (0, 1, 2, 3, 0))
                       + f'<tag k="building" v="yes"/><tag k="name" v="{name}"/>' * bool(name) + "</way>"
                       for k, name in enumerate(("Bow", "Sound", "")))
        relation = '<relation id="920"><member type="way" ref="912" role="outline"/><tag k="type" v="building"/><tag k="building" v="yes"/><tag k="name" v="Of parts"/></relation>'
        file = ta.FOLDER / "bow.osm"
        file.write_text(text.replace("<way", nodes + ways + "<way", 1).replace("</osm>", relation + "</osm>"),
                        encoding="utf-8")
        folder = ta.fresh("bow")
        ta.run("airport", file, "-o", folder)
        readme = (folder / "README.txt").read_text(encoding="utf-8")
        self.assertRegex(readme,
                         f"  2 {extract.CROSSING}: (building Bow, building Of parts|building Of parts, building Bow)\n")
        ground = {one["properties"]["name"]: ogr.CreateGeometryFromJson(json.dumps(one["geometry"])).Area()
                  for one in json.loads((folder / "airport.geojson").read_text(encoding="utf-8"))["features"]
                  if one["properties"]["kind"] == "building"}
        self.assertAlmostEqual(ground["Bow"], 2 * ground["Sound"], delta=1e-11)  # square degrees: 2e-8 and 1e-8

    def test_rings_given_twice_and_inside_others(self):
        """Equal rings are one area. A polygon inside another polygon of GeoJSON is no hole. Corners that are not
        numbers cost one feature."""
        whole = ta.FOLDER / "equal.geojson"
        gdal.VectorTranslate(str(whole), str(runway(ta.Map()).write("equal.osm")), layers=["lines"])
        text = json.loads(whole.read_text(encoding="utf-8"))

        def square(x, size=1e-3):
            return [[x, 53.603], [x + size, 53.603], [x + size, 53.603 + size], [x, 53.603 + size], [x, 53.603]]

        one, other, inside = square(13.301), square(13.305), [[x + 3e-4, y + 3e-4] for x, y in square(13.301, 4e-4)]
        for kind, coordinates, area in (
                ("MultiPolygon", [[one], [one]], 1), ("MultiPolygon", [[one], [one[2:] + one[1:3]], [other]], 2),
                ("MultiPolygon", [[one], [inside]], 1), ("MultiPolygon", [[one, inside], [inside]], 1),
                ("MultiPolygon", [[one, inside], [other]], 1.84), ("Polygon", [[["13.301", 53.6], *one[1:]]], None),
                ("Polygon", [[one[0], "x", *one[1:]]], None), ("Polygon", [[[None, 53.6], *one[1:]]], None)):
            features = [{"type": "Feature", "properties": {"building": "yes", "name": name},
                         "geometry": {"type": which, "coordinates": at}}
                        for name, which, at in (("A", kind, coordinates), ("B", "Polygon", [square(13.31)]))]
            for order in (features, features[::-1]):
                whole.write_text(json.dumps({**text, "features": [*order, *text["features"]]}), encoding="utf-8")
                found = _osm.read_extract(whole, KNOWN)
                areas = {one.name: round(one.shape.Area() * 1e6, 6) for one in found.features if one.kind == "building"}
                self.assertEqual(areas, {"A": area, "B": 1.0} if area else {"B": 1.0}, coordinates)
                self.assertEqual([(one.name, one.reason) for one in found.left],
                                 [] if area else [("A", "without a geometry")], coordinates)
        for second in (None, (0, 1, 2, 3), (2, 3, 0, 1), (3, 2, 1, 0)):
            plan = runway(ta.Map())
            corners = [(0, 300), (40, 300), (40, 340), (0, 340)]
            way = plan.way(corners, True)
            plan.relation([way, way if second is None else plan.way([corners[i] for i in second], True)], [],
                          building="yes")
            self.assertEqual([row for row in things(plan.write("equal.osm")) if row[0] == "building"],
                             [("building", "area", "", 1600)], second)

    def test_rings_of_too_few_corners(self):
        """Alone, as a hole, and beside a good part, in GeoJSON, where nothing closes or checks a ring."""
        whole = ta.FOLDER / "rings.geojson"
        gdal.VectorTranslate(str(whole), str(runway(ta.Map()).write("rings.osm")), layers=["lines"])
        text = json.loads(whole.read_text(encoding="utf-8"))
        expected = things(whole)
        corner, other = [13.301, 53.603], [13.302, 53.603]
        good = [[13.301, 53.603], [13.302, 53.603], [13.302, 53.604], [13.301, 53.603]]
        short = ([], [corner], [corner, corner], [corner, other], [corner, other, corner])
        for properties in ({"building": "yes"}, {"natural": "wood"}, {"aeroway": "aerodrome"},
                           {"building": "yes", "start_date": "2999"}):
            for ring in short:
                shapes = [{"type": "Polygon", "coordinates": [ring]}]
                if "building" in properties and ring:
                    shapes += [{"type": "Polygon", "coordinates": [good, ring]},
                               {"type": "MultiPolygon", "coordinates": [[ring], [good]]}]
                for number, shape in enumerate(shapes):
                    file = ta.FOLDER / "short.geojson"
                    features = [*text["features"], {"type": "Feature", "properties": properties, "geometry": shape}]
                    file.write_text(json.dumps({**text, "features": features}), encoding="utf-8")
                    got = things(file)
                    self.assertEqual(len(got), len(expected) + (number > 0 and "start_date" not in properties),
                                     (properties, shape))

    def test_single_features_that_end_nothing(self):
        """Found by random features: lines of one corner alone and among others, areas with such rings, a corner at 0 N
        0 E, features on the far side of the Earth."""
        whole = ta.FOLDER / "single.geojson"
        gdal.VectorTranslate(str(whole), str(runway(ta.Map()).write("single.osm")), layers=["lines"])
        text = json.loads(whole.read_text(encoding="utf-8"))
        a, b, c, zero, pole = [13.301, 53.603], [13.302, 53.603], [13.302, 53.604], [0, 0], [180, 90]
        tags = ({"building": "yes"}, {"barrier": "fence"}, {"natural": "coastline"}, {"aeroway": "aerodrome"},
                {"aeroway": "threshold"}, {"aeroway": "runway"}, {"natural": "tree", "location": "roof"})
        for shape in ({"type": "LineString", "coordinates": [a]},
                      {"type": "MultiLineString", "coordinates": [[a], [a, b], []]},
                      {"type": "Polygon", "coordinates": [[a, b, c, a], [a], [a, b]]},
                      {"type": "MultiPoint", "coordinates": [a, b]}, {"type": "Point", "coordinates": []},
                      {"type": "LineString", "coordinates": [a, zero]},
                      {"type": "Polygon", "coordinates": [[a, b, zero, a]]},
                      {"type": "LineString", "coordinates": [pole, [180, 89.999]]},
                      {"type": "Point", "coordinates": pole}, {"type": "GeometryCollection", "geometries": []}, None):
            features = [{"type": "Feature", "properties": one, "geometry": shape} for one in tags]
            whole.write_text(json.dumps({**text, "features": [*text["features"], *features]}), encoding="utf-8")
            with warnings.catch_warnings(), _gdal.quiet():
                warnings.simplefilter("ignore")
                made = AirportMap(whole)
                made.mapped(made.chosen(made.heights()))
            self.assertIn("09/27", {one.name for one in made.runways}, shape)
            self.assertEqual("[0, 0]" in json.dumps(shape), extract.TOO_LONG in {one.reason for one in made.left},
                             shape)

    def test_rings_and_corners_in_wrong_places(self):
        """Holes beside their outline and far away, and coordinates that are not degrees, are counted as left out."""
        whole = ta.FOLDER / "strays.geojson"
        gdal.VectorTranslate(str(whole), str(runway(ta.Map()).write("strays.osm")), layers=["lines"])
        text = json.loads(whole.read_text(encoding="utf-8"))

        def ring(x, y, size=1e-3):
            return [[x, y], [x + size, y], [x + size, y + size], [x, y + size], [x, y]]

        house, inner = ring(13.301, 53.603), ring(13.3013, 53.6033, 4e-4)
        for number, (coordinates, holes, reason) in enumerate(
                (([house, ring(13.303, 53.603)], 0, extract.STRAY),
                 ([house, ring(14, 54), inner, inner[:2]], 1, extract.STRAY), ([inner, house], 1, ""),
                 ([[*house[:2], [13.302, 1e400], *house[3:]]], 0, extract.NO_DEGREES),
                 ([ring(387000, 5940000)], 0, extract.NO_DEGREES))):
            feature = {"type": "Feature", "properties": {"building": "yes"},
                       "geometry": {"type": "Polygon", "coordinates": coordinates}}
            whole.write_text(json.dumps({**text,
                                         "features": [*text["features"], feature]}).replace("Infinity", "1e400"),
                             encoding="utf-8")
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                found = [one.shape for one in _osm.read_extract(whole, KNOWN).features if one.kind == "building"]
            self.assertEqual(left(whole), {("building", reason): 1} if reason else {}, number)
            self.assertEqual(len(found), reason != extract.NO_DEGREES, number)
            for shape in found:
                self.assertAlmostEqual(shape.Area() * 1e6, 1.0 - 0.16 * holes, delta=1e-6, msg=str(number))

    def test_what_is_not_a_whole_extract(self):
        whole = fenced().write("whole.osm")
        system = b'{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "EPSG:99999999"}}, "features": []}'
        link = b'{"type": "FeatureCollection", "crs": {"type": "link", "properties": {"href": "utm.prj", "type": "esriwkt"}}, "features": []}'
        for name, content, words in (("none.osm", b"", "is empty"),
                                     ("page.osm", b"\n<html><body>too many requests</body></html>", "is a web page"),
                                     ("own.geojson", b'{"version": 0.6, "generator": "Overpass API", "elements": []}',
                                      "is Overpass's own JSON"),
                                     ("wide.osm", "<osm/>".encode("utf-16"), "is in UTF-16"),
                                     ("half.osm", whole.read_bytes()[:6000], "cannot be read to its end"),
                                     ("nodes.osm", re.sub(b'lat="53[.]', b'lat="53,', whole.read_bytes()),
                                      "holds no runway.*; node 1: lat is '53,"),
                                     ("system.geojson", system, "the coordinate system is 'EPSG:99999999'"),
                                     ("link.geojson", link, "the coordinate system is 'a link to utm.prj'"),
                                     ("half.osm.pbf", ta.pbf(whole).read_bytes()[:-200], "cannot be read to its end")):
            file = ta.FOLDER / name
            file.write_bytes(content)
            with self.assertRaisesRegex(RuntimeError, f"{name}: {words}.*expected"):
                AirportMap(file)

    def test_nodes_at_no_place(self):
        """One node that no way has, and one of a fence, a wood by relation, a building and each end of a second
        runway."""
        for word in ("200", "53,602", "abc", "nan", "5_3", ""):
            plan = runway(ta.Map())
            spare = plan.point(50, 50, natural="tree", height="9")
            other = plan.way([(-800, 500), (800, 500)], aeroway="runway", ref="09R/27L")
            fence = plan.way([(0, 99), (50, 99), (99, 99)], barrier="fence")
            building, wood = plan.area((0, 300), (8, 310), building="yes"), plan.area((0, 400), (9, 410))
            plan.relation([wood], [], natural="wood")
            file = plan.write("nowhere.osm")
            whole = things(file)
            wrong = {spare, other - 1, fence - 2, building - 1, wood - 3}
            file.write_text(re.sub(r'(<node id="(\d+)"[^>]*lat=)"[^"]*"',
                                   lambda found: f'{found[1]}"{word}"' if int(found[2]) in wrong else found[0],
                                   file.read_text(encoding="utf-8")), encoding="utf-8")
            found = _osm.read_extract(file, KNOWN)
            self.assertEqual(sorted(int(one.id) for one in found.left if one.kind == "node"), sorted(wrong), word)
            self.assertIn(f"lat is {word!r}", {one.name for one in found.left})
            self.assertEqual({(one.kind, one.reason) for one in found.left if one.kind != "node"},
                             {(kind, extract.NO_DEGREES) for kind in ("way", "building", "wood")}, word)
            self.assertEqual([row[:2] for row in things(file)],
                             [row[:2] for row in whole if row[0] in ("runway", "fence")][:2], word)
        plan = runway(ta.Map())
        plan.area((0, 300), (8, 310), building="yes")
        file = plan.write("nameless.osm")
        whole = things(file)
        file.write_text(file.read_text(encoding="utf-8").replace("<node ",
                                                                 '<node lat="200" lon="13"/><node lat="53" '
                                                                 'lon="13"/><node id="x1" lat="53" lon="13"/><way '
                                                                 'id=""/><node ', 1), encoding="utf-8")
        self.assertEqual([row[:2] for row in things(file)], [row[:2] for row in whole])
        lost = [(one.kind, one.id, one.reason) for one in _osm.read_extract(file, KNOWN).left]
        self.assertEqual(sorted(lost),
                         sorted([*2 * [("node", "", _osm.NO_ID)], ("node", "x1", _osm.NO_ID), ("way", "", _osm.NO_ID)]))
        plan = runway(ta.Map())
        plan.way([(-800, 500), (0, 500), (800, 500)], aeroway="runway", ref="09R/27L")
        file = plan.write("nowhere.osm")
        file.write_text(file.read_text(encoding="utf-8").replace('<node id="4" version="1" lat="53',
                                                                 '<node id="4" version="1" lat="253'), encoding="utf-8")
        self.assertRegex(ta.run("airport", file, "-o", ta.fresh("nowhere"))[1],
                         "a runway has nodes with coordinates that are not degrees.*mend these nodes")

    def test_values_that_are_lists(self):
        """One list makes lists of a whole column in GDAL."""
        whole = ta.FOLDER / "lists.geojson"
        gdal.VectorTranslate(str(whole), str(runway(ta.Map()).write("lists.osm")), layers=["lines"])
        text = json.loads(whole.read_text(encoding="utf-8"))
        for values, expected in (((12, [15]), (12, 15)), ((12.5, [9, 15.5]), (12.5, 15.5)),
                                 (("12 m", ["15 m"]), (12, 15)), (("12", [15]), (12, 15)), ((12, []), (12, 8)),
                                 ((12, {"max": 3}), (12, 8)), (([[1]], "9"), (8, 9))):
            features = [{"type": "Feature", "properties": {"building": "yes", "height": value},
                         "geometry": {"type": "Polygon", "coordinates": [
                                          [[13.301 + x, 53.603], [13.302 + x, 53.603], [13.302 + x, 53.604],
                                           [13.301 + x, 53.603]]]}} for x, value in zip((0, 0.01), values)]
            whole.write_text(json.dumps({**text, "features": [*text["features"], *features]}), encoding="utf-8")
            found = [_features.properties_of(one, KNOWN)["height"] for one in _osm.read_extract(whole, KNOWN).features
                     if one.kind == "building"]
            self.assertEqual(tuple(found), expected, values)

    def test_what_is_drawn_twice(self):
        """Parts above one another are two; of what stands in one place the higher counts, and the other is counted as
        left out."""
        plan = runway(ta.Map())
        for tags in ({"height": "10"}, {"height": "60", "min_height": "40"}, {"height": "60", "min_height": "45"}):
            plan.area((0, 300), (40, 340), building__part="yes", **tags)
        for height in ("30", "55", "40"):
            plan.point(100, 300, man_made="mast", height=height)
        plan.relation([plan.area((200, 300), (240, 340), building="yes", height="9")], [], building="yes",
                      name="relation")
        file = plan.write("twice.osm")
        found = sorted((one.kind, float(one.tags["height"]), one.name)
                       for one in _osm.read_extract(file, KNOWN).features if one.kind != "runway")
        self.assertEqual(found, [("building", 9, "relation"), ("mast", 55, ""), ("part", 10, ""), ("part", 60, "")])
        self.assertEqual(left(file),
                         {("part", extract.TWICE): 1, ("mast", extract.TWICE): 2, ("building", extract.TWICE): 1})


class Runways(unittest.TestCase):
    def runways(self, *pieces, **more):
        plan = ta.Map()
        for points, tags in pieces:
            plan.way(points, **{"aeroway": "runway", **tags})
        for x, y in more.get("thresholds", ()):
            plan.point(x, y, aeroway="threshold")
        for tags in more.get("areas", ()):
            plan.area((-300, 450), (300, 650), **tags)
        made = AirportMap(plan.write("pieces.osm"))
        found = []
        for one in made.runways:
            line = one.shape.Clone()
            line.Transform(to_local())
            heading = math.degrees(math.atan2(line.GetX(1) - line.GetX(0), line.GetY(1) - line.GetY(0))) % 360
            found.append((one.tags.get("ref"), round(line.Length()), round(heading), one.tags.get("width"),
                          *(round(float(one.tags.get(f"displaced_{end}", 0))) for end in ("start", "end"))))
        return sorted(found, key=str), [one.reason for one in made.left]

    def test_pieces_of_one_runway(self):
        ref = {"ref": "09/27", "width": "45"}
        a, b, c = [(-900, 0), (-500, 0)], [(-480, 0), (200, 0.5)], [(200, 0.5), (900, 0)]
        for pieces in ((a, b, c), (c, a[::-1], b), (b[::-1], c, a), (a[::-1], b[::-1], c[::-1])):
            self.assertEqual(self.runways(*((piece, ref) for piece in pieces))[0], [("09/27", 1800, 90, "45", 0, 0)],
                             pieces)
        # Pieces that are named by one end each
        for refs in (("09", "27", "09"), ("09L", "27R", ""), ("9", "27", "09/27")):
            found, _ = self.runways(*((piece, {"ref": ref} if ref else {}) for piece, ref in zip((a, b, c), refs)))
            self.assertEqual([row[:3] for row in found], [("09L/27R" if "L" in refs[0] else "09/27", 1800, 90)], refs)
        self.assertEqual(len(self.runways((a, {"ref": "09L"}), (b, {"ref": "27L"}))[0]), 2)
        # Parallel runways, and one that crosses, stay themselves; the last piece has no number.
        found, _ = self.runways((a, ref), (b, ref), (c, {}), ([(-900, 210), (900, 210)], {"ref": "09L/27R"}),
                                ([(0, 700), (0, -700)], {"ref": "18/36"}))
        self.assertEqual(found, [("09/27", 1800, 90, "45", 0, 0), ("09L/27R", 1800, 90, None, 0, 0),
                                 ("18/36", 1400, 180, None, 0, 0)])

    def test_areas_and_lines(self):
        """An area without a line along it is a runway: one that a line crosses, and one in three pieces. Pieces without
        a number go on."""
        def box(x0, x1):
            return [(x0, -22), (x1, -22), (x1, 22), (x0, 22), (x0, -22)]

        ref, area = {"ref": "09/27"}, {"area": "yes"}
        across = [(-310, -290), (-290, -310), (310, 290), (290, 310), (-310, -290)]
        line = ([(-900, 0), (900, 0)], ref)
        self.assertEqual(self.runways(line, (across, {"ref": "04/22", **area}))[0],
                         [("04/22", 849, 45, "28.3", 0, 0), ("09/27", 1800, 90, None, 0, 0)])
        self.assertEqual(self.runways(line, (box(-850, 900), area))[0], [("09/27", 1800, 90, None, 0, 0)])
        self.assertEqual(self.runways(*((box(x, x + 600), {**ref, **area}) for x in (-900, -300, 300)))[0],
                         [("09/27", 1800, 90, "44.0", 0, 0)])
        self.assertEqual(self.runways(([(-900, 0), (500, 0)], ref), ([(520, 0), (900, 0)], {}))[0],
                         [("09/27", 1800, 90, None, 0, 0)])

    def test_displaced_thresholds(self):
        main, ref = [(-600, 0), (800, 0)], {"ref": "9/27", "width": "30"}
        for tags in ({"runway": "displaced_threshold", "ref": "9/27"}, {"runway": "displaced_threshold"},
                     {"aeroway": "displaced_threshold"}):
            self.assertEqual(self.runways(([(-600, 0), (-900, 0)], tags), (main, ref))[0],
                             [("9/27", 1700, 90, "30", 300, 0)], tags)
        found, _ = self.runways(([(900, 0), (-900, 0)], {"ref": "09/27"}), thresholds=[(-890, 0), (700, 3), (500, 200)])
        self.assertEqual(found, [("09/27", 1800, 90, None, 0, 200)])

    def test_what_is_no_runway(self):
        real = ([(-800, 0), (800, 0)], {"ref": "09/27"})
        other = [(-200, 550), (200, 550)]
        for tags, reason in (({"access": "private"}, "private (access)"), ({"abandoned": "yes"}, "out of use"),
                             ({"runway": "disused"}, "out of use"), ({"end_date": "1999"}, "ruins, or gone"),
                             ({"disused__aeroway": "runway"}, "out of use"),
                             ({"proposed__aeroway": "runway"}, "not built"),
                             ({"operational_status": "closed"}, "out of use")):
            self.assertEqual(self.runways(real,
                                          (other, {name.replace("__", ":"): word for name, word in tags.items()}))[1],
                             [reason], tags)
        for prefix in ("disused", "abandoned", "closed", "was", "razed", "construction"):
            found, out = self.runways(real, (other, {"aeroway": "", f"{prefix}:aeroway": "runway"}))
            self.assertEqual((len(found), len(out)), (1, 1), prefix)
        for tags, reason in (({"surface": "water"}, "a runway on water"), ({"runway": "closed"}, "out of use"),
                             ({"disused": "yes"}, "out of use"), ({"sport": "model_aerodrome"}, "of a model airfield"),
                             ({"construction": "yes"}, "not built")):
            self.assertEqual(self.runways(real, (other, tags)), ([("09/27", 1600, 90, None, 0, 0)], [reason]), tags)
        short = [(-70, 550), (70, 550)]
        self.assertEqual(self.runways(real, (short, {}))[1], ["a runway shorter than 150 m"])
        strip, field = [(-100, 550), (100, 550)], {"leisure": "pitch", "sport": "model_aerodrome"}
        self.assertEqual(self.runways(real, (strip, {}), areas=[field])[1], ["of a model airfield"])
        self.assertEqual(len(self.runways(real, (strip, {}))[0]), 2)  # a short strip of its own
        with self.assertRaisesRegex(RuntimeError, "holds no runway.*left out: a runway on water"):
            self.runways((other, {"surface": "water"}))


class Heights(unittest.TestCase):
    def test_lengths(self):
        for text, metres in (("12.5 m", 12.5), ("12,5", 12.5), ("10 ft", 3.048), ("5'6\"", 1.6764),
                             ("5 ft 6 in", 1.6764), ("2;3", 3), ("12-15", 15), ("~9", 9), ("1,200 ft", 365.76),
                             ("1,234.5 ft", 376.2756), ("1 200 ft", 365.76), ("12,500", 12.5), ("0.012 km", 12),
                             ("350 cm", 3.5), ("2000 mm", 2), ("10 yd", 9.144), ("30 m AGL", 30), ("2 storeys", 6),
                             ("12\u00b11 m", 12), ("12m 50cm", 12.5), ("12 \u043c", 12), ("1'200", None),
                             ("120 m AMSL", None), ("\uff11\uff12", 12), ("9 m 4 in", None), ("three", None),
                             ("-3", None), ("0", None), ("5000", None), ("nan", None), ("", None), (None, None),
                             ("1" + " " * 100_000 + "x", None)):
            found = _features.length_of(text)
            self.assertEqual(found if found is None else round(found, 9), metres, text)
        for text, levels in (("2;3", 3), ("2,3", 3), ("1,5", 1.5), ("2-3", 3), ("3+1", 4), ("2 floors", 2), ("0", None),
                             ("ground", None), ("B1", None), ("1e3", None), ("250", None), (None, None)):
            self.assertEqual(_features.levels_of(text), levels, text)

    def test_heights_of_tags(self):
        def row(**tags):
            found = extract.Extract(KNOWN)
            shape = ogr.CreateGeometryFromWkt("POLYGON ((0 0, 1e-3 0, 1e-3 1e-3, 0 1e-3, 0 0))")
            found.take({key.replace("__", ":"): value for key, value in tags.items()}, shape)
            one, = found.done().features
            row = _features.properties_of(one, KNOWN)
            return row["kind"], row.get("height", row.get("top")), row.get("min_height"), "assumed" in row.get(
                "height_from", row.get("top_from"))

        for tags, expected in (
                ({"building": "yes", "building__levels": "2", "roof__height": "1.5"}, ("building", 7.5, None, True)),
                ({"building": "hangar", "building__levels": "3"}, ("hangar", 18, None, True)),
                ({"building": "yes", "height": "14", "min_height": "10 m"}, ("building", 14, 10, False)),
                ({"building__part": "yes", "building__levels": "6", "building__min_level": "2"}, ("part", 18, 6, True)),
                ({"building": "yes", "height": "5", "min_height": "9"}, ("building", 5, None, False)),
                ({"building": "no", "building__part": "yes", "height": "5"}, ("part", 5, None, False)),
                ({"building": "false", "man_made": "chimney", "height": "5"}, ("chimney", 5, None, False)),
                ({"building": "roof", "height": "8"}, ("canopy", 8, 7.5, False)),
                ({"building__part": "yes", "min_height": "40"}, ("part", 48, 40, True)),
                ({"aeroway": "jet_bridge", "area": "yes"}, ("jet_bridge", 7, 4, True)),
                ({"theme": "buildings", "type": "building", "class": "hangar", "height": "17.5"},
                 ("hangar", 17.5, None, False)),
                ({"power": "generator", "generator__source": "wind"}, ("turbine", 100, None, True)),
                ({"power": "generator", "height": "7"}, ("obstacle", 7, None, False))):
            self.assertEqual(row(**tags), expected, tags)

    def test_parts_stand_in_place_of_their_building(self):
        """A terminal of which a tower and a low part are drawn, one that is all parts, and a canopy that does not reach
        the ground."""
        plan = runway(ta.Map())
        plan.area((0, 200), (100, 300), building="terminal", height="20", name="Hall")
        plan.area((0, 200), (50, 300), building__part="yes", height="6")
        plan.area((60, 220), (70, 230), building__part="yes", height="35", min_height="20")
        plan.area((200, 200), (300, 300), building="yes", height="30", name="All parts")
        plan.area((200, 200), (300, 250), building__part="yes", height="30")
        plan.area((200, 250), (300, 300), building__part="yes", height="10")
        plan.area((400, 200), (450, 250), building="roof", height="8", min_height="6")
        plan.way([(500, 200), (540, 200)], aeroway="jet_bridge", width="4")
        folder, words = ta.made("parts", plan.write("parts.osm"))
        self.assertIn("1 drawn by its parts", words)
        scene, found = ta.blocks(folder)
        self.assertNotIn("All parts", found)
        z = {name: (triangles[:, :, 2].min(), triangles[:, :, 2].max()) for name, (_, triangles) in found.items()}
        for name, (low, high) in (("Hall", (0, 20)), ("Canopy", (6, 8)), ("Jet bridge", (4, 7))):
            np.testing.assert_allclose(z[name], (low, high), atol=0.1, err_msg=name)
        self.assertAlmostEqual(ta.plan_area(found["Hall"][1]), 5000, delta=5)
        self.assertAlmostEqual(ta.plan_area(found["Part"][1]), 5000 + 100 + 1e4, delta=15)
        self.assertAlmostEqual(siting.ground_of(scene, [(425.0, 225.0)])[0], 0.0, delta=0.1)  # below the canopy


class LeftOut(unittest.TestCase):
    def test_all_are_counted(self):
        """Each reason takes some of the buildings and obstacles."""
        plan, x = runway(ta.Map()), 0
        for tags in ({"building": "ruins"}, {"demolished__building": "yes"},
                     {"building": "yes", "end_date": "2001-05-01"}, {"proposed__building": "yes"},
                     {"building": "yes", "start_date": "2999"}, {"building": "yes", "level": "-2;-1"},
                     {"building": "yes", "location": "underground"}, {"building": "no"}, {"building": "yes"},
                     {"building": "yes", "height": "tall"}):
            plan.area((x, 300), (x + 8, 310), **tags)
            x += 12
        plan.way([(0, 400), (10, 400), (10, 410)], building="yes")
        plan.way([(0, 450), (0, 450), (0, 450), (0, 450)], True, building="yes")
        plan.point(20, 400, building="house")
        plan.area((9000, 0), (9010, 10), building="yes")
        plan.point(-100, 300, power="generator", height="30")
        plan.point(-120, 300, power="generator", generator__source="solar")
        plan.point(-140, 300, shop="kiosk")
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
        mast = next(row for row in rows(folder) if row["kind"] == "obstacle")
        self.assertEqual((mast["top"], mast["top_from"]), (30.0, "height"))

    def test_all_runways_come_first(self):
        for tags in KNOWN["kinds"]["runway"]["tags"]:
            said = " ".join(f"{name} {value}" for name, value in tags.items())
            self.assertTrue(any(word in said for word in _osm.FIRST), said)

    def test_what_lies_apart_makes_no_difference(self):
        """The scene is the same as if the rules had looked at everything, in XML and GeoJSON, with bounds and
        without."""
        plan = runway(ta.Map())
        for i, j in itertools.product(range(-8, 9), repeat=2):
            plan.area((500 * i, 500 * j + 60), (500 * i + 120, 500 * j + 90), building="yes", name=f"{i} {j}")
            plan.way([(500 * i, 500 * j), (500 * i + 900, 500 * j + 900)], barrier="wall", height="3")
        plan.way([(-9000, -1950), (9000, -1950)], barrier="fence", height="2")
        file = plan.write("apart.osm")
        whole = ta.FOLDER / "apart.geojson"
        gdal.VectorTranslate(str(whole), str(file), layers=["lines"])
        for source, bounds in ((file, None), (whole, None), (file, (13.28, 53.59, 13.36, 53.63)),
                               (whole, (13.2, 53.59, 13.3, 53.61))):
            kept = []
            for reads_all in (False, True):
                patch = mock.patch.object(_osm, "_lies_apart",
                                          lambda *_: False) if reads_all else contextlib.nullcontext()
                with warnings.catch_warnings(), patch, _gdal.quiet():
                    warnings.simplefilter("ignore")
                    airport = AirportMap(source, bounds=bounds)
                    kept.append(sorted((row["kind"], row.get("name", ""), shape.ExportToWkt())
                                       for row, shape in airport.mapped(airport.chosen(airport.heights()))))
                apart = sum(one.count for one in airport.left if one.kind == "any kind")
                self.assertEqual(apart > 100, not reads_all, (source, bounds))
            self.assertEqual(*kept, (source, bounds))
            self.assertGreater(len(kept[0]), 20)

    def test_numbers_that_are_not_understood(self):
        """Texts of heights, storeys and widths, of which -1 (as in Microsoft's footprints) says that the height is not
        known."""
        plan = runway(ta.Map())
        for x, (name, text) in enumerate([*(("height", text) for text in ("-5", "0", "-0.5", "-1.0")),
                                          *(("building__levels", text) for text in ("-1", "1e3", "B1", "0"))]):
            plan.area((20 * x, 300), (20 * x + 10, 310), building="yes", **{name: text})
        plan.point(0, 400, natural="tree", height="-3")
        for y, width in ((500, "-30"), (600, "0"), (700, "abc"), (800, "1e3"), (900, "61")):
            plan.way([(-800, y), (800, y)], aeroway="runway", width=width)
        folder, words = ta.made("strange", plan.write("strange.osm"))
        self.assertRegex(words,
                         "; 7 heights were not understood: '-5', '0', '-0.5', '-1'; 4 widths were not understood: "
                         "'-30', 'abc', '0', '1e3'\n")
        self.assertIn("strange.osm says no height of any building", words)
        self.assertNotIn("are from assumed", (folder / "README.txt").read_text(encoding="utf-8"))
        self.assertEqual(sorted(row["width"] for row in rows(folder) if row["kind"] == "runway"),
                         [45, 45, 45, 45, 45, 61])


    def test_storeys_and_layers(self):
        """`layer` orders drawings and is not a height; `level` is a storey; `indoor` is in a building. A feature with
        `building=no` does not become a building."""
        for tags, reason in (
                ({"building": "terminal", "layer": "-1"}, ""), ({"building__part": "yes", "layer": "-2"}, ""),
                ({"man_made": "chimney", "layer": "-1"}, ""), ({"building": "terminal", "level": "-1;0;1"}, ""),
                ({"building": "yes", "level": "-1"}, "below ground"),
                ({"building": "yes", "level": "-3--1"}, "below ground"),
                ({"building": "yes", "layer": "-1", "location": "underground"}, "below ground"),
                ({"building": "yes", "indoor": "room", "level": "1"}, "indoors"),
                ({"building__part": "yes", "indoor": "area"}, "indoors"),
                ({"building": "train_station", "indoor": "yes"}, ""),
                ({"man_made": "tower", "indoor": "yes"}, "indoors"), ({"building": "yes", "indoor": "no"}, ""),
                *(({"building": word}, "no building") for word in ("no", "No", "false", "0", "none")),
                ({"building": "no", "height": "9"}, "no building"), ({"building__part": "no", "building": "yes"}, "")):
            found = extract.Extract(KNOWN)
            found.take({key.replace("__", ":"): value for key, value in tags.items()},
                       ogr.CreateGeometryFromWkt("POLYGON ((0 0, 1e-3 0, 1e-3 1e-3, 0 1e-3, 0 0))"))
            self.assertEqual([one.reason for one in found.left], [reason] if reason else [], tags)
            self.assertEqual(len(found.done().features), not reason, tags)

    def test_roofs(self):
        """On the roof, or on the higher part below; from the ground by `min_height`; beside all roofs; also on a slope,
        on which the building stands on its lowest ground."""
        plan = runway(ta.Map())
        plan.area((0, 300), (40, 340), building="yes", height="20")
        plan.area((20, 300), (40, 340), building__part="yes", height="30")
        plan.area((200, 300), (240, 340), building="yes")
        for x, tags in ((10, {"man_made": "mast", "height": "6"}), (30, {"man_made": "antenna", "height": "6"}),
                        (5, {"man_made": "mast", "height": "26", "min_height": "20"}), (220, {"man_made": "mast"}),
                        (-0.5, {"man_made": "mast", "height": "5"}), (100, {"man_made": "mast", "height": "5"}),
                        (12, {"natural": "tree", "height": "4"})):
            plan.point(x, 320,
                       location={30: "rooftop", 10: "Roof", 5: "outdoor; roof", 220: "roof;outdoor"}.get(x, "on_roof"),
                       name=str(x), **tags)
        plan.area((2, 302), (8, 308), power="generator", height="2", location="roof", name="solar")
        x = np.arange(-3200, 3201, 50.0)
        dem = ta.write_heights("roofs.tif", np.broadcast_to(100 + 0.04 * x, (len(x), len(x))), (-3200, -3200), 50.0)
        for words, slope in (((), 0.0), (("--heights", dem), 0.04)):
            folder, said = ta.made("roofs", plan.write("roofs.osm"), *words)
            found = {row["name"]: (row.get("min_height", 0.0), row["top"]) for row in rows(folder) if "name" in row}
            for name, low, high, at in (("10", 20, 26, 10), ("30", 30, 36, 10), ("5", 20, 26, 0), ("220", 8, 28, 20),
                                        ("-0.5", 20, 25, -0.5), ("solar", 20, 22, 5)):
                np.testing.assert_allclose(found.pop(name), (low - slope * at, high - slope * at), atol=0.05,
                                           err_msg=name)
            self.assertEqual(found, {})
            self.assertIn("1 on a roof that the scene lacks", said)
            self.assertIn("1 a plant on a roof", said)
        mast = next(triangles
                    for name, _, triangles in airport_pages.parts_of(al.load_scene(folder / "airport.lidarscene.json"))
                    if name == "Mast")
        near = mast[np.abs(mast[:, :, 0].mean(axis=1) - 10) < 1]
        self.assertAlmostEqual(np.ptp(near[:, :, 2]), 6, delta=0.05)
        self.assertTrue({row["min_height_from"] for row in rows(folder) if row.get("name") == "220"}
                        == {"the roof, assumed"})


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


AIXM = """<?xml version="1.0"?><message:AIXMBasicMessage xmlns:message="http://www.aixm.aero/schema/5.1.1/message"
 xmlns:aixm="http://www.aixm.aero/schema/5.1.1" xmlns:gml="http://www.opengis.net/gml/3.2">{}</message:AIXMBasicMessage>"""
STRUCTURE = """<message:hasMember><aixm:VerticalStructure gml:id="{id}"><aixm:timeSlice><aixm:VerticalStructureTimeSlice gml:id="{id}T">
<aixm:interpretation>BASELINE</aixm:interpretation><aixm:name>{name}</aixm:name><aixm:type>{type}</aixm:type><aixm:part><aixm:VerticalStructurePart gml:id="{id}P">
{extent}{place}</aixm:VerticalStructurePart></aixm:part></aixm:VerticalStructureTimeSlice></aixm:timeSlice></aixm:VerticalStructure></message:hasMember>"""


class Surveyed(unittest.TestCase):
    def aixm(self, *structures):
        file = ta.FOLDER / "obstacles.xml"
        ta.FOLDER.mkdir(parents=True, exist_ok=True)
        file.write_text(AIXM.format("".join(STRUCTURE.format(**one) for one in structures)), encoding="utf-8")
        return file

    def test_aixm(self):
        point = ('<aixm:horizontalProjection_location><aixm:ElevatedPoint gml:id="E" '
                 'srsName="{}"><gml:pos>{}</gml:pos><aixm:elevation '
                 'uom="{}">{}</aixm:elevation></aixm:ElevatedPoint></aixm:horizontalProjection_location>')
        surface = ('<aixm:horizontalProjection_surfaceExtent><aixm:ElevatedSurface gml:id="S" '
                   'srsName="urn:ogc:def:crs:EPSG::4326"><gml:patches><gml:PolygonPatch><gml:exterior><gml:LinearRing><gml:posList>53.604 13.302 53.604 13.303 53.605 13.303 53.605 13.302 53.604 13.302</gml:posList></gml:LinearRing></gml:exterior></gml:PolygonPatch></gml:patches></aixm:ElevatedSurface></aixm:horizontalProjection_surfaceExtent>')
        urn = "urn:ogc:def:crs:EPSG::4326"
        file = self.aixm({"id": "A", "name": "MAST 1", "type": "ANTENNA",
                          "extent": '<aixm:verticalExtent uom="FT">150</aixm:verticalExtent>',
                          "place": point.format(urn, "53.603 13.302", "M", 81)},
                         {"id": "B", "name": "HOUSE", "type": "BUILDING",
                          "extent": '<aixm:verticalExtent uom="M">12</aixm:verticalExtent>', "place": surface},
                         {"id": "C", "name": "TOP", "type": "STACK", "extent": "",
                          "place": point.format("urn:ogc:def:crs:OGC:1.3:CRS84", "13.305 53.603", "FT", 400)},
                         {"id": "D", "name": "NOWHERE", "type": "POLE", "extent": "", "place": ""})
        found, out = obstacles.read_obstacles([file], KNOWN)
        self.assertEqual([(one.kind, one.id, _gdal.form_of(one.shape)) for one in found],
                         [("mast", "A", "point"), ("building", "B", "area"), ("chimney", "C", "point")])
        self.assertEqual([(one.kind, one.name, one.reason) for one in out], [("pole", "NOWHERE", obstacles.NO_PLACE)])
        self.assertEqual([found[i].shape.GetPoint_2D() for i in (0, 2)], [(13.302, 53.603), (13.305, 53.603)])
        self.assertAlmostEqual(float(found[0].tags["height"]), 45.72, delta=1e-3)
        # An elevation alone becomes a height above the ground of --heights, which rises by 4 % to the east.
        x = np.arange(-3200, 3201, 50.0)
        dem = ta.write_heights("survey.tif", np.broadcast_to(100 + 0.04 * x, (len(x), len(x))), (-3200, -3200), 50.0)
        plan = runway(ta.Map()).write("survey.osm")
        folder, _ = ta.made("survey", plan, "--heights", dem, "--obstacles", file)
        tops = {row["id"]: row for row in rows(folder) if row["id"] in "ABC"}
        east = siting.to_enu([(13.305, 53.603)], ta.HERE)[0, 0]
        self.assertAlmostEqual(tops["C"]["top"], 400 * 0.3048 - (100 + 0.04 * east), delta=0.1)
        self.assertEqual((tops["B"]["height"], tops["B"]["height_from"]), (12.0, "height: surveyed, obstacles.xml"))

    def test_csv(self):
        file = ta.FOLDER / "obstacles.csv"
        ta.FOLDER.mkdir(parents=True, exist_ok=True)

        def read(text):
            file.write_text(text, encoding="utf-8")
            found, out = obstacles.read_obstacles([file], KNOWN)
            return [(one.kind, *(round(c, 6) for c in one.shape.GetPoint_2D()), round(float(one.tags["height"]), 3),
                     one.tags["height_source"]) for one in found], [one.reason for one in out]

        said = "surveyed, obstacles.csv"
        for text, expected in (
                ("longitude,latitude,height,unit,kind\n13.302,53.603,45,m,CABLE CAR PYLON\n13.303,53.604,100,ft,12 "
                 "MAIN STREET\n", [("mast", 13.302, 53.603, 45, said), ("obstacle", 13.303, 53.604, 30.48, said)]),
                ("Longitude;Latitude;Height (ft)\n13,302;53,603;1,200\n13,302;53,603;100'\n13,302;53,603;30 m\n",
                 [("obstacle", 13.302, 53.603, m, said) for m in (365.76, 30.48, 30)]),
                ("lat\tlon\theight_m\tname\n53\u00b036'10.8\"N\t013\u00b018'07.2\"E\t45\tx\n",
                 [("obstacle", 13.302, 53.603, 45, said)]), (
                    "latitude,longitude,height,uom\n533610.8N,0131807.2W,45,M\n",
                    [("obstacle", -13.302, 53.603, 45, said)]), (
                    "longitude,latitude,height\n13.302,53.603,45\n",
                    [("obstacle", 13.302, 53.603, 45, said + ", m assumed")]),
                ("OAS,LATDEC,LONDEC,TYPE,QUANTITY,AGL,AMSL\n01-1,53.603,13.302,BLDG-TWR,1,00120,00240\n",
                 [("tower", 13.302, 53.603, 36.576, said)])):
            self.assertEqual(read(text), (expected, []), text)
        pylons = "# obstacles\n# of a State\nlongitude,latitude,height,kind\n13.302,53.603,45,TRANSMISSION_LINE\n13.303,53.603,45,T-L\n"
        self.assertEqual([one[0] for one in read(pylons)[0]], ["mast", "mast"])
        twice = "longitude,latitude,height,unit,kind\n13.302,53.603,100,ft,mast\n13.302,53.603,30.48,m,mast\n13.302,53.603,31,m,mast\n"
        self.assertEqual(read(twice)[1], [aixm.TWICE])
        kinds = "longitude,latitude,height,unit,kind\n" + "".join(
            f"13.3{n},53.603,45,{unit},{kind}\n"
            for n, (unit, kind) in enumerate((("m", "mast"), ("furlong", "mast"), ("m", "BALLOON"),
                                              ("m", "Natural high point"), ("m", "URBAN"), ("km", "mast"))))
        self.assertEqual(read(kinds)[1], ["height in 'furlong', expected m or ft", "a balloon", "a part of the ground",
                                          "a group of obstacles without places", "height above 1,000 m"])
        with self.assertWarnsRegex(RuntimeWarning,
                                   "obstacles.csv: none of its obstacles can stand in the scene: 1 a wire"):
            read("longitude,latitude,height,kind\n13.302,53.603,45,wire\n")
        self.assertEqual(read("longitude,latitude,height,unit,kind\n13.302,53.603,,m,mast\n13.302,,45,m,mast\n13.302,99,45,m,mast\n\n")[1],
                         [obstacles.NO_PLACE] * 3)
        for name, text, words in (
                ("obstacles.csv", "a,b,c\n1,2,3\n", "expected the columns longitude"),
                ("obstacles.csv", 'longitude,latitude,height\n1,2,3\n"1,2,3\n1,2,3\n',
                 "obstacles.csv: line 3: is not CSV"),
                ("obstacles.csv", 'longitude,latitude,height\n"1,2,3\n"1",2,3\n', "obstacles.csv: line 2: is not CSV"),
                ("bad.xml", "<a>", "cannot be read as AIXM 5.1"), ("other.xml", "<a/>", "holds no VerticalStructure"),
                ("x.txt", "", "is not a file of obstacles by its name")):
            (ta.FOLDER / name).write_text(text)
            with self.assertRaisesRegex(RuntimeError, words):
                obstacles.read_obstacles([ta.FOLDER / name], KNOWN)


def pos(lat=53.603, lon=13.302):
    return f'<aixm:horizontalProjection_location><aixm:ElevatedPoint srsName="urn:ogc:def:crs:EPSG::4326"><gml:pos>{lat} {lon}</gml:pos>{{}}</aixm:ElevatedPoint></aixm:horizontalProjection_location>'


def surface(ring):
    return ('<aixm:horizontalProjection_surfaceExtent><aixm:ElevatedSurface '
            f'srsName="urn:ogc:def:crs:EPSG::4326"><gml:patches><gml:PolygonPatch><gml:exterior>{ring}'
            '</gml:exterior></gml:PolygonPatch></gml:patches>{}</aixm:ElevatedSurface></aixm:horizontalProjection_surfaceExtent>')


SQUARE = "53.603 13.302 53.603 13.3026 53.6033 13.3026 53.6033 13.302"
LINEAR = f"<gml:LinearRing><gml:posList>{SQUARE} 53.603 13.302</gml:posList></gml:LinearRing>"
LINE = ('<aixm:horizontalProjection_linearExtent><aixm:ElevatedCurve '
        'srsName="urn:ogc:def:crs:EPSG::4326"><gml:segments><gml:GeodesicString><gml:posList>53.603 13.302 53.604 '
        '13.303</gml:posList></gml:GeodesicString></gml:segments>{}</aixm:ElevatedCurve></aixm:horizontalProjection_linearExtent>')
LAMP = '<aixm:lighting><aixm:LightElement><aixm:type>{}</aixm:type></aixm:LightElement></aixm:lighting>'
PERIOD = "<gml:validTime><gml:TimePeriod><gml:beginPosition>{}</gml:beginPosition><gml:endPosition>{}</gml:endPosition></gml:TimePeriod></gml:validTime>"


def part(height="45", place=pos(), elevation="", kind="", uom="M", light="", more=""):
    """A VerticalStructurePart. @param elevation of the top, m"""
    place = place.format(f'<aixm:elevation uom="M">{elevation}</aixm:elevation>' if elevation else "")
    return ("<aixm:part><aixm:VerticalStructurePart>"
            + (f'<aixm:verticalExtent uom="{uom}">{height}</aixm:verticalExtent>' if height else "")
            + (f"<aixm:type>{kind}</aixm:type>" if kind else "") + more + place + (LAMP.format(light) if light else "")
            + "</aixm:VerticalStructurePart></aixm:part>")


def piece(parts=part(), kind="TOWER", interpretation="BASELINE", sequence="1", correction="0", valid=("2019-01-01", ""),
          more="", name="x"):
    """A time slice. @param valid first and last day, or XML of gml:validTime"""
    valid = valid if isinstance(valid, str) else PERIOD.format(*valid)
    return (f"<aixm:timeSlice><aixm:VerticalStructureTimeSlice>{valid}<aixm:interpretation>{interpretation}</aixm:interpretation><aixm:sequenceNumber>{sequence}</aixm:sequenceNumber><aixm:correctionNumber>{correction}</aixm:correctionNumber><aixm:name>{name}</aixm:name>"
            + (f"<aixm:type>{kind}</aixm:type>" if kind else "") + more + parts
            + "</aixm:VerticalStructureTimeSlice></aixm:timeSlice>")


class Published(unittest.TestCase):
    """What States publish in AIXM 5.1 (eTOD)."""

    def read(self, *structures, more=()):
        """What stands: kind, form, least height and height (m); and the reasons of what does not. @param structures
        time slices @param more structures of a second file"""
        ta.FOLDER.mkdir(parents=True, exist_ok=True)
        files = []
        for name, some in (("one.xml", structures), ("two.xml", more)):
            members = ('<message:hasMember><aixm:VerticalStructure '
                       f'gml:id="{number}">{one}</aixm:VerticalStructure></message:hasMember>'
                       for number, one in enumerate(some))
            (ta.FOLDER / name).write_text(AIXM.format("".join(members)), encoding="utf-8")
            files += [ta.FOLDER / name] * bool(some)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found, out = obstacles.read_obstacles(files, KNOWN)
        return [(one.kind, _gdal.form_of(one.shape), float(one.tags.get("min_height", 0)),
                 float(one.tags.get("height", 0))) for one in found], [one.reason for one in out]

    def test_kinds(self):
        """The type of a part, else of the structure, and never of a light; areas and lines of plants; what is not
        modelled."""
        group, no_places = "<aixm:group>YES</aixm:group>", [obstacles.GROUP]
        area, line = part(place=surface(LINEAR)), part(place=LINE)
        for slices, expected in (
                (piece(part(light="OTHER:FLASHING"), "ANTENNA"), "mast point"),
                (piece(part(place=surface(LINEAR), light="ICAO_MIA"), "BUILDING"), "building area"),
                (piece(part(kind="OTHER:CHIMNEY"), "BUILDING"), "chimney point"),
                (piece(part(kind="OTHER"), "CRANE"), "crane point"),
                (piece(part(), "", name="WATER TOWER"), "tower point"),
                (piece(part(), "", name="Balloon hill"), "obstacle point"), (piece(area, "VEGETATION"), "wood area"),
                (piece(area, "VEGETATION", more=group), "wood area"), (piece(line, "TREE"), "tree line"),
                (piece(part(), "TREE", more=group), "tree point"), (piece(line, "FENCE"), "fence line"),
                (piece(line, "DAM"), "wall line"), (piece(line, "BUILDING"), "wall line"),
                (piece(line, "OTHER:X"), "wall line"), (piece(area, "COOLING_TOWER"), "tower area"),
                (piece(area, "BRIDGE"), "skybridge area"), (piece(part(), "WINDMILL_FARMS"), "turbine point"),
                (piece(part(), "ANTENNA", more=group), "mast point"),
                (piece(part(), "NATURAL_GAS_SYSTEM"), "obstacle point"),
                (piece(part(), "OTHER:WINDSOCK"), "pole point"), (piece(area, "POWER_PLANT"), "building area"),
                (piece(area, "POWER_PLANT", more=group), no_places),
                (piece(area, "WINDMILL_FARMS", more=group), no_places), (piece(area, "WINDMILL_FARMS"), no_places),
                (piece(line, "WINDMILL_FARMS"), no_places), (piece(area, "URBAN"), no_places),
                (piece(part(), "URBAN"), no_places), (piece(line, "POLE"), [obstacles.NO_WALL]),
                (piece(line, "BRIDGE"), [obstacles.NO_WALL]), (piece(line, "CATENARY"), ["a wire"]),
                (piece(part(), "NATURAL_HIGHPOINT"), ["a part of the ground"]),
                (piece(part("900"), "TETHERED_BALLOON"), ["a balloon"]),
                (piece(part(more="<aixm:mobile>YES</aixm:mobile>"), "CRANE"), [aixm.MOBILE]),
                (piece(part(more="<aixm:mobile>NO</aixm:mobile>"), "CRANE"), "crane point")):
            found, out = self.read(slices)
            self.assertEqual(" ".join(found[0][:2]) if found else out, expected, slices)
            self.assertEqual(len(found) + len(out), 1)

    def test_lengths(self):
        for slices, expected in ((part("100", uom="FT"), 30.48), (part("45", uom="m"), 45),
                                 (part("4500", uom="CM"), 45), (part("1,200", uom="FT"), 365.76),
                                 (part("45", uom="FL"), "height in 'fl', expected m or ft"),
                                 (part("5000"), "height above 1,000 m"), (part("45", elevation="GND"), 45),
                                 (part("0"), obstacles.NO_PLACE), (part("-5"), obstacles.NO_PLACE),
                                 (part("tall"), obstacles.NO_PLACE), (part(""), obstacles.NO_PLACE),
                                 (part("", elevation="-3"), 0), (part("45", place=""), obstacles.NO_PLACE),
                                 ("", obstacles.NO_PLACE), (part("45").replace(' uom="M"', ""), 45),
                                 (part("45", elevation="9").replace('elevation uom="M"', 'elevation uom="FL"'), 45)):
            found, out = self.read(piece(slices))
            self.assertEqual(found[0][3] if found else out[0], expected, slices)

    def test_extents_of_points(self):
        """A radius, or a length and a width, of buildings and trees are their own; that of a mast is of its wires."""
        def extent(**lengths):
            return "".join(f'<aixm:{name} uom="M">{length}</aixm:{name}>' for name, length in lengths.items())

        for kind, lengths, area, width in (
                ("STADIUM", {"radius": 90}, math.pi * 90**2, None),
                ("BUILDING", {"length": 23, "width": 12}, 276, None), ("TREE", {"radius": 4}, 0, "8.000"),
                ("VEGETATION", {"radius": 200}, math.pi * 200**2, None), ("STACK", {"radius": 5}, math.pi * 25, None),
                ("TOWER", {"radius": 60}, 0, None), ("ANTENNA", {"radius": 60}, 0, None),
                ("WINDMILL", {"radius": 50}, 0, None), ("POLE", {"radius": 9.3}, 0, None),
                ("BUILDING", {"length": 23}, 0, None)):
            ta.FOLDER.mkdir(parents=True, exist_ok=True)
            (ta.FOLDER / "extent.xml").write_text(
                AIXM.format('<aixm:VerticalStructure '
                            f'gml:id="a">{piece(kind=kind, more=extent(**lengths))}</aixm:VerticalStructure>'))
            (one,), out = obstacles.read_obstacles([ta.FOLDER / "extent.xml"], KNOWN)
            shape = one.shape.Clone()
            shape.Transform(to_local())
            self.assertAlmostEqual(shape.Area(), area, delta=0.01 * area, msg=(kind, lengths))
            self.assertEqual((one.tags.get("width"), out), (width, []), (kind, lengths))
            self.assertEqual("a disc of its extent" in one.tags["height_source"], area > 0)
        group = piece(kind="ANTENNA", more=extent(radius=60) + "<aixm:group>YES</aixm:group>")
        self.assertEqual(self.read(group), ([], [obstacles.GROUP]))

    def test_time_slices(self):
        """Heights of 1, 2 and 3 m in slices, and which of them is the state of today."""
        def at(height, interpretation="BASELINE", sequence="1", correction="0", begin="2019-01-01", end="", **more):
            return piece(part(str(height)) if height else "", interpretation=interpretation, sequence=sequence,
                         correction=correction, valid=more.pop("valid", (begin, end)), **more)

        lifetime = "<aixm:featureLifetime><gml:TimePeriod><gml:beginPosition>2009-01-01</gml:beginPosition><gml:endPosition>{}</gml:endPosition></gml:TimePeriod></aixm:featureLifetime>"
        instant = "<gml:validTime><gml:TimeInstant><gml:timePosition>2019-01-01T00:00:00Z</gml:timePosition></gml:TimeInstant></gml:validTime>"
        nil = '<gml:validTime xsi:nil="true" nilReason="inapplicable" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"/>'
        now, later, delta = "2019-01-01", "2999-01-01", {"interpretation": "PERMDELTA"}
        temporary = {"interpretation": "TEMPDELTA"}
        for slices, expected in (
                ((at(1), at(2, correction="1")), 2), ((at(2, correction="1"), at(1)), 2),
                ((at(1, correction="9"), at(2, correction="10")), 2), ((at(1), at(2, sequence="2")), 2),
                ((at(1), at(2, sequence="2", begin=later)), 1),
                ((at(1, end="2019-06-01"), at(2, sequence="2", begin="2019-06-01")), 2),
                ((at(1, end="2019-06-01T12:00:00Z"),), aixm.ENDED), ((at(1, end=later),), 1),
                ((at(1, begin=later),), aixm.FUTURE), ((at(1, end="01.06.2019"),), aixm.NO_DATE),
                ((at(1, end="2019-06-01"), at(2, sequence="2", begin=later)), aixm.FUTURE),
                ((at(1, valid=instant, interpretation="SNAPSHOT", sequence="", correction=""),), 1),
                ((at(1), at(2, valid=nil, correction="1")), aixm.ENDED), ((at(1, valid=""),), 1),
                ((at(1, more=lifetime.format("2019-06-01")),), aixm.ENDED), ((at(1, more=lifetime.format(later)),), 1),
                ((at(1), at(2, **delta, sequence="2", valid=instant)), 2), ((at(2, **delta, sequence="2"), at(1)), 2),
                ((at(1), at(2, **delta, sequence="2", begin=later)), 1),
                ((at(1), at(2, **delta, sequence="2"), at(3, **delta, sequence="2", correction="1")), 3),
                ((at(1, **delta, sequence="1"), at(2, sequence="2"), at(3, **delta, sequence="2")), 2),
                ((at(1), at(0, **delta, sequence="2", more=lifetime.format("2019-06-01"))), aixm.ENDED),
                ((at(1), at(0, **delta, sequence="2", kind="CRANE")), 1), ((at(1), at(2, **temporary, end=later)), 2),
                ((at(1), at(2, **temporary, end="2019-06-01")), 1), ((at(2, **delta),), 2),
                ((at(0, **delta),), aixm.NO_BASELINE), ((at(2, **temporary, end="2019-06-01"),), aixm.ENDED),
                ((), obstacles.NO_PLACE)):
            found, out = self.read("".join(slices))
            self.assertEqual((found[0][3], out) if found else out, (expected, []) if found else [expected], slices)

    def test_structures_in_several_files(self):
        """Slices of one structure belong together; what is equal stands once."""
        uuid = '<gml:identifier codeSpace="urn:uuid:">{}0c</gml:identifier>'.format
        update = uuid("a") + piece(part("2"), interpretation="PERMDELTA", sequence="2")
        for one, more, expected in ((uuid("a") + piece(), update, ([2], [])), (update, uuid("a") + piece(), ([2], [])),
                                    (uuid("a") + piece(), uuid("b") + piece(part("2")), ([45, 2], [])),
                                    (uuid("a") + piece(), uuid("a") + piece(), ([45], [aixm.TWICE])),
                                    (piece(), piece(name="y"), ([45], [aixm.TWICE])),
                                    (piece(), piece(part("147.638", uom="FT")), ([45], [aixm.TWICE])),
                                    (piece(), piece(part(place=pos(53.604))), ([45, 45], []))):
            found, out = self.read(one, more=(more,))
            self.assertEqual(([row[3] for row in found], out), expected, more)

    def test_parts_on_parts(self):
        """The height of a part is above its bottom, as of an antenna on a roof; two turbines stand on the ground."""
        roof = part("20", surface(LINEAR), "70", "BUILDING")
        for parts, expected in ((roof + part("6", pos(53.6031, 13.3022), "76", "ANTENNA"), [(0, 20), (20, 26)]),
                                (part("6", pos(53.6031, 13.3022), "", "ANTENNA") + roof, [(20, 26), (0, 20)]),
                                (roof + part("30", pos(53.6031, 13.3022), "80", "TOWER"), [(0, 20), (0, 30)]),
                                (roof + part("6", pos(53.61), "76", "ANTENNA"), [(0, 20), (0, 6)]),
                                (part("120", pos(), "170") + part("15", pos(), "185") + part("2", pos(), "187"),
                                 [(0, 120), (120, 135), (135, 137)]),
                                (part("120", pos(), "170") + part("120", pos(53.61), "190"), [(0, 120), (0, 120)]),
                                (roof + part("", pos(53.6031, 13.3022), "76"), [(0, 20), (0, 0)])):
            found, out = self.read(piece(parts))
            self.assertEqual(([row[2:] for row in found], out), (expected, []), parts)

    def test_geometries(self):
        """Rings that are open, in pieces, in three dimensions; those that cannot be read are left out alone."""
        def ring(*posLists, segment="GeodesicString", more=""):
            return "<gml:Ring>" + "".join(
                f"<gml:curveMember><gml:Curve><gml:segments><gml:{segment}>{more}<gml:posList>{one}</gml:posList></gml:{segment}></gml:segments></gml:Curve></gml:curveMember>"
                for one in posLists) + "</gml:Ring>"

        circle = '<gml:Ring><gml:curveMember><gml:Curve><gml:segments><gml:CircleByCenterPoint numArc="1"><gml:pos>53.603 13.302</gml:pos><gml:radius uom="M">90</gml:radius></gml:CircleByCenterPoint></gml:segments></gml:Curve></gml:curveMember></gml:Ring>'
        sound, metres = piece(part("9", pos(53.61))), 33.4 * 39.7
        words = SQUARE.split()
        for one, expected in (
                (LINEAR, metres), (ring(f"{SQUARE} 53.603 13.302"), metres),
                (ring(f"{SQUARE} 53.6030009 13.3020001"), metres), (ring(SQUARE), metres),
                (LINEAR.replace(" 53.603 13.302<", "<"), metres), (
                    ring(f"{SQUARE} 53.6030009 13.302").replace("Geodesic", "LineStringX").replace(
                        "LineStringXString", "LineStringSegment"), metres), (circle, math.pi * 90**2),
                (ring(" ".join(words[:4]), " ".join(words[2:]) + " 53.603 13.302"), metres),
                (ring(" ".join(words[:4]), "53.60300001 13.3026 " + " ".join(words[4:]) + " 53.603 13.302"), metres),
                (ring(" ".join(
                            f"{word} 100" if number % 2 else word
                            for number, word in enumerate(
                                words))).replace("<gml:posList", '<gml:posList srsDimension="3"'), metres),
                ("<gml:LinearRing>" + "".join(f"<gml:pos>{a} {b}</gml:pos>" for a, b in zip(words[::2], words[1::2]))
                    + "</gml:LinearRing>", metres),
                (ring("53.603 13.302 53.6033 13.3026 53.603 13.3026 53.6033 13.302"), metres / 2),
                (ring("53.603 13.302 53.6033 13.3026"), aixm.UNREADABLE),
                (ring("53.603 13.302 53.6033"), aixm.UNREADABLE),
                (ring("53.603 13.302 53.6033 13.3026 53.603 13.302"), extract.NO_EXTENT),
                (ring(SQUARE.replace("53.6033", "north")), aixm.UNREADABLE),
                (ring(SQUARE.replace("53.6033", "nan")), (aixm.UNREADABLE, extract.NO_DEGREES)),
                (ring(SQUARE.replace("53.6033", "253.6")), extract.NO_DEGREES),
                ('<gml:Ring><gml:curveMember xlink:href="#c" xmlns:xlink="http://www.w3.org/1999/xlink"/></gml:Ring>',
                    obstacles.NO_PLACE)):
            structures = piece(part("7", surface(one)), "BUILDING"), sound
            found, out = self.read(*structures)
            self.assertIn(("tower", "point", 0, 9), found, one)
            if isinstance(expected, float):
                self.assertEqual(out, [], one)
                one_found = obstacles.read_obstacles([ta.FOLDER / "one.xml"], KNOWN)[0][0]
                self.assertEqual(extract.CROSSING in one_found.tags, expected == metres / 2, one)
                shape = one_found.shape
                shape.Transform(to_local())
                self.assertAlmostEqual(shape.Area(), expected, delta=0.02 * expected, msg=one)
            else:
                self.assertEqual((len(found), len(out)), (1, 1), one)
                self.assertIn(out[0], (expected,) if isinstance(expected, str) else expected, one)
        for place, reason in ((pos(99), extract.NO_DEGREES), (pos("north"), aixm.UNREADABLE),
                              (pos(53.603, ""), aixm.UNREADABLE), (pos().replace("::4326", "::99999999"),
                                                                   "the unknown coordinate system "
                                                                   "'urn:ogc:def:crs:EPSG::99999999'"),
                              (LINE.replace("53.604 13.303", "53.603 13.302"), extract.NO_EXTENT)):
            self.assertEqual(self.read(piece(part(place=place)), sound), ([("tower", "point", 0, 9)], [reason]), place)


class Areas(unittest.TestCase):
    def test_courtyards_that_touch_keep_their_area(self):
        """Random cells of a grid as courtyards, also given as islands, which GDAL makes of some. Expected: the cells by
        counting."""
        random, side = np.random.default_rng(8), 6
        for turn in range(40):
            cells = [(x, y) for x in range(1, side - 1) for y in range(1, side - 1) if random.random() < 0.5]
            rings = ["((0 0, {0} 0, {0} {0}, 0 {0}, 0 0)".format(side)] + [
                f"({x} {y}, {x} {y + 1}, {x + 1} {y + 1}, {x + 1} {y}, {x} {y})" for x, y in cells]
            islands = turn % 3 == 0
            text = "MULTIPOLYGON (" + ", ".join(
                [f"{rings[0]})",
                 *(f"({ring})" for ring in rings[1:])]) + ")" if islands else f"POLYGON {', '.join(rings)})"
            shape = ogr.CreateGeometryFromWkt(text)
            self.assertAlmostEqual(_gdal.valid(shape, nested=islands).Area(),
                                   side * side - len(cells) if cells else side * side, delta=1e-9, msg=text)
        apart = ogr.CreateGeometryFromWkt("MULTIPOLYGON (((0 0, 4 0, 4 4, 0 4, 0 0)), ((3 3, 6 3, 6 6, 3 6, 3 3)))")
        self.assertAlmostEqual(_gdal.valid(apart).Area(), 16 + 9 - 1, delta=1e-9)
        self.assertEqual(_gdal.valid(ogr.CreateGeometryFromWkt("LINESTRING (0 0, 1 1)")).Length(), math.sqrt(2.0))


