# SPDX-License-Identifier: BSD-3-Clause
"""Rasters of heights that are not what they seem: holes, bands and pictures, files that lead to servers, files that
declare more than they hold, coordinates that PROJ does not know well; and how far the scene's ground is from the file's
heights."""
import os
import pathlib
import re
import shutil
import sqlite3
import struct
import time
import unittest
import unittest.mock

import numpy as np
from osgeo import gdal, ogr, osr

import avianlidar as al
import exampletools
from avianlidar.apps.airport import _ground
from avianlidar.apps.airport._osm import read_extract
from avianlidar.apps.inputs._json import packaged
from avianlidar.apps.places._gdal import coordinate_system, open_file, quiet
from helpertools import Server, warned

HERE = (53.6, 13.3, 0.0)  # latitude, longitude, height
AROUND = (-1000.0, 1000.0, -1000.0, 1000.0)
FOLDER = pathlib.Path(exampletools.OUTPUT) / "TestRasters"
KNOWN = packaged("places/airport.json")
SLOPE = np.tile(50 + 0.1 * np.arange(-150, 151), (301, 1))  # 10 m apart
HOLE = (slice(140, 160), slice(140, 160))
gdal.UseExceptions()


def write(name, *bands, kind=gdal.GDT_Float32, spacing=10.0, system=None, low=(-1500.0, -1500.0), driver="GTiff",
          colours=(), options=(), **settings):
    """A raster about HERE, rows from south to north. @param settings of the bands, one value for each"""
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows, columns = bands[0].shape
    image = gdal.GetDriverByName("MEM").Create("", columns, rows, len(bands), kind)
    image.SetGeoTransform((low[0] - spacing / 2, spacing, 0, low[1] + (rows - 0.5) * spacing, 0, -spacing))
    image.SetProjection(system or coordinate_system(HERE).ExportToWkt())
    for number, values in enumerate(bands, 1):
        band = image.GetRasterBand(number)
        band.WriteArray(values[::-1])
        for key, of_bands in settings.items():
            getattr(band, f"Set{key}")(of_bands[number - 1])
        if colours:
            band.SetColorInterpretation(colours[number - 1])
    gdal.GetDriverByName(driver).CreateCopy(str(FOLDER / name), image, options=list(options))
    return FOLDER / name


def degrees():
    """The system of latitudes and longitudes, in this order."""
    system = osr.SpatialReference()
    system.ImportFromEPSG(4326)
    return system


def read(file, origin=HERE, around=AROUND):
    """Its heights, and its warnings."""
    found, heard = warned(lambda: _ground.read_heights(pathlib.Path(file), origin, around, KNOWN))
    return found, " ".join(heard)


class Values(unittest.TestCase):
    def assert_filled(self, file, what):
        found, _ = read(file)
        self.assertIn("have no height in the file", found.words, what)
        self.assertAlmostEqual(found.here, 50.0, delta=1.0, msg=what)
        self.assertTrue(35.0 < found.posts.min() and found.posts.max() < 65.0, what)

    def test_holes_of_an_alpha_band_and_of_a_mask(self):
        holed = SLOPE.copy()
        holed[HOLE] = 0.0
        for kind, full in ((gdal.GDT_Float32, 255), (gdal.GDT_Float32, 1), (gdal.GDT_UInt16, 65535),
                           (gdal.GDT_Int16, 255)):
            alpha = np.full(SLOPE.shape, full)
            alpha[HOLE] = 0
            self.assert_filled(write("alpha.tif", holed, alpha, kind=kind,
                                     colours=(gdal.GCI_GrayIndex, gdal.GCI_AlphaBand)), (kind, full))
            self.assert_filled(write("first.tif", alpha, holed, kind=kind,
                                     colours=(gdal.GCI_AlphaBand, gdal.GCI_Undefined)), (kind, full))
        gdal.Translate(str(FOLDER / "alpha.vrt"), str(FOLDER / "alpha.tif"))
        self.assert_filled(FOLDER / "alpha.vrt", "of a mosaic")
        with gdal.config_option("GDAL_TIFF_INTERNAL_MASK", "NO") if hasattr(gdal, "config_option") else quiet():
            masked = gdal.Open(str(write("masked.tif", holed)), gdal.GA_Update)
            masked.CreateMaskBand(gdal.GMF_PER_DATASET)
            masked.GetRasterBand(1).GetMaskBand().WriteArray(np.where(alpha[::-1] > 0, 255, 0))
            del masked
        self.assertTrue((FOLDER / "masked.tif.msk").exists())
        self.assert_filled(FOLDER / "masked.tif", "beside it")

    def test_customary_values_of_holes_in_any_unit(self):
        """32767 and other values stand for holes, also in dm and cm; their neighbours are heights."""
        units = {"m": 1.0, "ft": 0.3048, "dm": 0.1, "cm": 0.01, "mm": 0.001}
        for (unit, metres), value in ((one, value) for one in units.items()
                                      for value in (32767, -32768, -32767, -9999, 9999, 65535, 99999)):
            holed = np.round(SLOPE / metres)
            holed[HOLE] = value
            self.assert_filled(write("unit.tif", holed, kind=gdal.GDT_Int32, UnitType=[unit]), (unit, value))
        level = np.full(SLOPE.shape, 32766)
        self.assertAlmostEqual(read(write("near.tif", level, kind=gdal.GDT_Int16, UnitType=["cm"]))[0].here, 327.66,
                               delta=1e-9)
        self.assertAlmostEqual(read(write("near.tif", level, kind=gdal.GDT_Int16, Scale=[0.01],
                                          Offset=[-300.0]))[0].here, 27.66, delta=1e-9)
        with self.assertRaisesRegex(al.Error, "holds no heights"):
            read(write("all.tif", level + 1, kind=gdal.GDT_Int16, UnitType=["dm"]))

    def test_values_that_no_ground_has(self):
        for value, unit, metres, declared in ((-501.0, "m", 1.0, {}), (9001.0, "", 1.0, {"NoDataValue": [-9998.0]}),
                                              (np.nan, "", 1.0, {}), (30000.0, "ft", 0.3048, {})):
            holed = SLOPE / metres
            holed[HOLE] = value
            self.assert_filled(write("unit.tif", holed, UnitType=[unit], **declared), (value, unit))

    def test_units(self):
        """Units of the band and of a compound system, and a scale."""
        plain = coordinate_system(HERE).ExportToWkt()

        def above_geoid(name, unit, metres, values):
            """GeoTIFF has no word for such a system."""
            file = write(f"{name}.tif", values, kind=gdal.GDT_Float64, UnitType=["m" if name == "two" else ""])
            system = (f'COMPD_CS["with heights",{plain},VERT_CS["EGM96 height",VERT_DATUM["EGM96 geoid",2005],'
                      f'UNIT["{unit}",{metres!r}],AXIS["Up",UP]]]')
            gdal.Translate(str(FOLDER / f"{name}.vrt"), str(file), outputSRS=system)
            return FOLDER / f"{name}.vrt"

        units = {"ft": 0.3048, "yd": 0.9144, "Foot_US": 1200 / 3937, "decimetres": 0.1, "km": 1000.0}
        truth, _ = read(write("metres.tif", SLOPE, kind=gdal.GDT_Float64))
        for file in (*(write(f"{unit}.tif", SLOPE / metres, kind=gdal.GDT_Float64, UnitType=[unit])
                       for unit, metres in units.items()),
                     write("scaled.tif", np.round(1000 * (SLOPE - 20)), kind=gdal.GDT_Int32, Scale=[0.001],
                           Offset=[20.0]), above_geoid("metre", "metre", 1.0, SLOPE),
                     above_geoid("yard", "Indian yard", 0.9144, SLOPE / 0.9144)):
            found, _ = read(file)
            np.testing.assert_allclose(found.posts, truth.posts, atol=2e-3, err_msg=str(file))
            self.assertAlmostEqual(found.here, truth.here, delta=1e-3)
            self.assertIn("40.0 to 60.0 m", found.words)
        for file, said in ((write("furlong.tif", SLOPE, UnitType=["furlong"]), "'furlong'"),
                           (above_geoid("two", "foot", 0.3048, SLOPE),
                            "heights in 'm' and its vertical system in 'foot'")):
            with self.assertRaisesRegex(al.Error, said):
                read(file)
        plane, foot = osr.SpatialReference(), 1200 / 3937
        plane.ImportFromWkt(plain)
        plane.SetLinearUnitsAndUpdateParameters("US survey foot", foot)
        found, said = read(write("plane.tif", SLOPE, kind=gdal.GDT_Float64, system=plane.ExportToWkt(),
                                 spacing=10.0 / foot, low=(-1500.0 / foot, -1500.0 / foot)))
        self.assertRegex(said, "says no unit of its heights, .* are likely in US survey foot")
        np.testing.assert_allclose(found.posts[:200, :200], truth.posts[:200, :200], atol=2e-3)

    def test_a_tile_of_srtm(self):
        image = gdal.GetDriverByName("MEM").Create("", 1201, 1201, 1, gdal.GDT_Int16)
        image.SetGeoTransform((13 - 1 / 2400, 1 / 1200, 0, 54 + 1 / 2400, 0, -1 / 1200))
        image.SetProjection(degrees().ExportToWkt())
        image.GetRasterBand(1).WriteArray(np.full((1201, 1201), 77, np.int16))
        FOLDER.mkdir(parents=True, exist_ok=True)
        gdal.GetDriverByName("SRTMHGT").CreateCopy(str(FOLDER / "N53E013.hgt"), image)
        self.assertAlmostEqual(read(FOLDER / "N53E013.hgt")[0].here, 77.0, delta=1e-6)

    def test_the_band_of_heights(self):
        """By names of bands, as BAG's; no picture, whatever its bits."""
        other = np.full(SLOPE.shape, 0.5)
        for names, at in ((("elevation", "uncertainty"), 0), (("uncertainty", "elevation"), 1),
                          (("Uncertainty", ""), 1), (("", "standard deviation of height"), 0),
                          (("density", "Vertical Uncertainty", "depth"), 2), (("B1", ""), 1), (("", ""), 0)):
            bands = [SLOPE if number == at else other for number in range(len(names))]
            found, said = read(write("named.tif", *bands, Description=names))
            self.assertAlmostEqual(found.here, 50.0, delta=1e-3, msg=names)
            self.assertEqual("2 bands without names" in said, not any(names), (names, said))
        gray, undefined = gdal.GCI_GrayIndex, gdal.GCI_Undefined
        colours = (gdal.GCI_RedBand, gdal.GCI_GreenBand, gdal.GCI_BlueBand, gdal.GCI_AlphaBand)
        table = gdal.ColorTable()
        table.SetColorEntry(50, (1, 2, 3, 255))
        sixteen, eight = {"kind": gdal.GDT_UInt16}, {"kind": gdal.GDT_Byte}
        for count, said, settings in ((3, r"colours \(Red\) of UInt16 in 3 bands", {**sixteen, "colours": colours}),
                                      (4, "colours", {**sixteen, "colours": colours}),
                                      (1, "a palette of UInt16 in 1 band,", {**sixteen, "ColorTable": [table]}),
                                      (3, "numbers of UInt16", {**sixteen, "colours": (gray, undefined, undefined)}),
                                      (1, "colours", {"colours": colours[1:2]}), (1, "bytes in 1 band", eight),
                                      (2, "bytes", {**eight, "colours": (gray, colours[3])}),
                                      (1, "complex numbers", {"kind": gdal.GDT_CFloat32}),
                                      (1, "classes of Int16", {"kind": gdal.GDT_Int16, "CategoryNames": [["a", "b"]]}),
                                      (3, "holds B2, B3, B4, expected one band of heights",
                                       {"Description": ["B2", "B3", "B4"]}),
                                      (1, "holds uncertainty, expected", {"Description": ["uncertainty"]})):
            with self.assertRaisesRegex(al.Error, said):
                read(write("picture.tif", *[SLOPE] * count, **settings))

    def test_the_ground_is_compared_with_the_file(self):
        """At posts that are far apart, the difference that is said is that of the triangles' heights at the file's
        posts."""
        random = np.random.default_rng(3)
        for spacing, count in ((300.0, 11), (10.0, 301)):
            rough = 50 + random.normal(0.0, 20.0, (count, count))
            low = 3.7 - spacing * (count // 2)
            found, _ = read(write("rough.tif", rough, spacing=spacing, low=(low, low)))
            _, ground = _ground.terrain(found.posts, (-1000.0, -1000.0), found.spacing, HERE, 0.25)
            words = _ground.difference(found, 0.0, HERE, ground)
            x = low + spacing * np.arange(count)
            x = x[np.abs(x) <= 1000.0]
            inside = np.abs(low + spacing * np.arange(count)) <= 1000.0
            places = np.array([(east, north) for north in x for east in x])
            off = ground(places) - rough[np.ix_(inside, inside)].ravel() + _ground.curvature(HERE, *places.T)
            rms, most, posts = (float(text.replace(",", ""))
                                for text in re.search(r"by ([\d.]+) m rms and by at most ([\d.]+) m at its ([\d,]+) "
                                                      r"posts", words).groups())
            self.assertEqual(posts, len(x) ** 2)
            self.assertAlmostEqual(rms / np.sqrt(np.mean(off * off)), 1.0, delta=0.06)
            self.assertAlmostEqual(most / np.abs(off).max(), 1.0, delta=0.06)
            self.assertLess(rms, 3.0 if spacing > 100.0 else 20.0)

    def test_means_of_fine_pixels(self):
        """The mean of each square of pixels, in pieces of any size; holes do not count."""
        random = np.random.default_rng(4)
        fine = 50 + random.normal(0.0, 1.0, (2200, 2200))
        fine[random.random(fine.shape) < 0.1] = -9999.0
        file = write("fine.tif", fine, spacing=1.0, low=(-1100.0, -1100.0), NoDataValue=[-9999.0])
        whole = read(file)[0]
        with unittest.mock.patch.object(_ground, "IN_CHUNK", 50_000):
            np.testing.assert_array_equal(read(file)[0].posts, whole.posts)
        self.assertAlmostEqual(whole.spacing, 4.0, delta=0.1)
        x = np.round(-1000.0 + whole.spacing * np.arange(10, 490, 60) + 1100.0).astype(int)
        truth = np.where(fine < 0.0, np.nan, fine)
        means = [[np.nanmean(truth[row - 2:row + 3, column - 2:column + 3]) for column in x] for row in x]
        np.testing.assert_allclose(whole.posts[10:490:60, 10:490:60], means, atol=0.7)  # squares that do not coincide
        self.assertAlmostEqual(whole.posts.std(), 0.26, delta=0.06)

    def test_the_accuracy_of_coordinates(self):
        """PROJ without the grid of the British National Grid: 2 m; unknown for a datum without a name; none to speak of
        for UTM."""
        for code, origin, said in ((27700, (52.0, -1.0, 0.0), r"PROJ transforms OSGB.* to WGS84 is (2|1\.5) m"),
                                   (32633, HERE, ""), ("+proj=tmerc +lat_0=53.6 +lon_0=13.3 +ellps=bessel +units=m",
                                                       HERE, "is unknown here")):
            system = osr.SpatialReference()
            system.SetFromUserInput(code if isinstance(code, str) else f"EPSG:{code}")
            system.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
            x, y, _ = osr.CoordinateTransformation(degrees(), system).TransformPoint(*origin[:2])
            found, heard = read(write("grid.tif", SLOPE, low=(x - 1500, y - 1500), system=system.ExportToWkt()), origin)
            self.assertRegex(heard, said or "^$")
            self.assertEqual(("accuracy" in found.words, "accuracy" in heard), (bool(said),) * 2, code)
            # Maps give the same warning.
            file = FOLDER / "grid.gpkg"
            file.unlink(missing_ok=True)
            base = ogr.GetDriverByName("GPKG").CreateDataSource(str(file))
            layer = base.CreateLayer("a", system)
            runway = ogr.Feature(layer.GetLayerDefn())
            runway.SetGeometry(ogr.CreateGeometryFromWkt(f"LINESTRING({x} {y},{x + 900} {y})"))
            layer.CreateFeature(runway)
            del runway, layer, base
            self.assertRegex(" ".join(warned(lambda: read_extract(file, KNOWN))[1]), said or "^$")


def mosaic(source, more="", srs="EPSG:4326", start="", relative=0):
    return (f'<VRTDataset rasterXSize="100" rasterYSize="100">{start}<SRS>{srs}</SRS>'
            '<GeoTransform>13.2,.002,0,53.7,0,-.002</GeoTransform><VRTRasterBand dataType="Float32" band="1">'
            f'<SimpleSource><SourceFilename relativeToVRT="{relative}">{source}</SourceFilename>'
            f'<SourceBand>1</SourceBand></SimpleSource>{more}</VRTRasterBand></VRTDataset>')


class Files(unittest.TestCase):
    def setUp(self):
        shutil.rmtree(FOLDER, ignore_errors=True)

    def refused(self, name, content, *said, file=None):
        FOLDER.mkdir(parents=True, exist_ok=True)
        file = file or FOLDER / name
        if content is not None:
            file.write_bytes(content if isinstance(content, bytes) else content.encode())
        start = time.monotonic()
        with self.assertRaisesRegex((al.Error, OSError), ".*".join((re.escape(str(file)), *said))) as error:
            read(file)
        self.assertLess(time.monotonic() - start, 10.0, name)
        return str(error.exception)

    def test_no_raster_uses_the_network(self):
        """Whatever the suffix: mosaics, services, what lies beside a raster or in its metadata, systems, maps."""
        server, good = Server(), write("good.tif", SLOPE)
        url = server.url
        window = "".join(f"<{name}>{value}</{name}>" for name, value in (
            ("UpperLeftX", 13), ("UpperLeftY", 54), ("LowerRightX", 14), ("LowerRightY", 53), ("SizeX", 99),
            ("SizeY", 99)))
        service = (f'<GDAL_WMS><Service name="TMS"><ServerUrl>{url}/${{z}}/${{x}}/${{y}}</ServerUrl></Service>'
                   f'<DataWindow>{window}</DataWindow><Projection>EPSG:4326</Projection><BandsCount>1</BandsCount>'
                   '</GDAL_WMS>')
        remote = f"/vsicurl/{url}/x.tif"
        (FOLDER / "hidden.vrt").write_text(mosaic(remote))
        (FOLDER / "hidden.tif").write_text(mosaic(remote))
        (FOLDER / "wms.tif").write_text(service)
        texts = {"vrt": mosaic(remote), "wms": service, "url": url + "/x.tif"}
        for name, text in texts.items():
            for suffix in (".tif", ".asc", ".hgt", ".vrt", ".TIF", ".xml", ".txt", ".jp2", ""):
                self.refused(f"{name}{suffix}", text)
        for name, text in (
                ("service", mosaic(service.replace("<", "&lt;"))), ("http", mosaic(url + "/x.tif")),
                ("hidden", mosaic(FOLDER / "hidden.tif")), ("nested", mosaic(FOLDER / "hidden.vrt")),
                ("stream", mosaic(remote.replace("vsicurl", "vsicurl_streaming"))), ("s3", mosaic("/vsis3/b/x.tif")),
                ("zip", mosaic("/vsizip/" + str(good))), ("netcdf", mosaic(f"NETCDF:{url}/x.nc:z")),
                ("srs", mosaic(good, srs=url + "/crs")),
                ("open", mosaic(good, "<SimpleSource><SourceFilename>a.tif</SourceFilename><OpenOptions/>"
                                "</SimpleSource>")),
                ("python", mosaic(good).replace('band="1"', 'band="1" subClass="VRTDerivedRasterBand"')),
                ("entity", "<!DOCTYPE a [<!ENTITY b 'c'>]>" + mosaic(good)),
                ("warped", mosaic(good).replace("<VRTDataset ", '<VRTDataset subClass="VRTWarpedDataset" ')),
                ("options", mosaic(good, start=f"<GDALWarpOptions><SourceDataset>{remote}</SourceDataset>"
                                   "</GDALWarpOptions>"))):
            self.refused(f"{name}.vrt", text, ".")
        for suffix in (".tif.msk", ".msk", ".tif.ovr", ".tif.aux.xml"):
            beside = write("beside.tif", SLOPE)
            (FOLDER / ("beside" + suffix)).write_text(
                mosaic(remote) if "xml" not in suffix
                else '<PAMDataset><Metadata domain="OVERVIEWS"><MDI '
                     f'key="OVERVIEW_FILE">{remote}</MDI></Metadata></PAMDataset>')
            self.refused("", None, "belongs together with", file=beside)
            self.refused("of_beside.vrt", mosaic(beside), "beside.tif: belongs together with")
            (FOLDER / ("beside" + suffix)).unlink()
        tagged = gdal.Open(str(write("tagged.tif", SLOPE)), gdal.GA_Update)
        tagged.SetMetadata({"OVERVIEW_FILE": remote}, "OVERVIEWS")
        tagged.SetMetadata({"X_DATASET": remote, "Y_DATASET": remote}, "GEOLOCATION")
        del tagged
        self.assertAlmostEqual(read(FOLDER / "tagged.tif")[0].here, 50.0, delta=1e-3)
        with quiet():
            gdal.BuildVRT(str(FOLDER / "tagged.vrt"), [str(FOLDER / "tagged.tif")])
        self.assertAlmostEqual(read(FOLDER / "tagged.vrt")[0].here, 50.0, delta=1e-3)
        # Maps, and what GDAL would do within them.
        (FOLDER / "map.geojson").write_text(
            '{"type": "FeatureCollection", "crs": {"type": "name", "properties": {"name": "%s/crs"}}, "features": []}'
            % url)
        with self.assertRaises(al.Error):
            read_extract(FOLDER / "map.geojson", KNOWN)
        (FOLDER / "map.gpkg").unlink(missing_ok=True)
        ogr.GetDriverByName("GPKG").CreateDataSource(str(FOLDER / "map.gpkg")).CreateLayer("a")
        with sqlite3.connect(FOLDER / "map.gpkg") as base:
            base.execute("CREATE VIEW g AS SELECT 1 AS fid, ogr_geocode('x', 'geometry', "
                         f"'QUERY_TEMPLATE={url}/?q=%s') AS geom")
            base.execute("INSERT INTO gpkg_contents(table_name, data_type, identifier, srs_id) VALUES('g', 'features', "
                         "'g', 4326)")
        with quiet(), self.assertRaises((al.Error, RuntimeError)):
            [*open_file(FOLDER / "map.gpkg", "a map", ["GPKG"], gdal.OF_VECTOR).GetLayerByName("g")]
        # The second line of defence: what GDAL is led to does not leave the machine.
        with quiet():
            for name in (remote, remote.replace("vsicurl", "vsicurl_streaming"), url + "/x.tif", service):
                with self.subTest(name), self.assertRaises(RuntimeError):
                    gdal.Open(name).ReadAsArray()
            with self.assertRaises(RuntimeError):
                osr.SpatialReference().SetFromUserInput(url + "/crs")
        self.assertIsNone(gdal.GetThreadLocalConfigOption("GDAL_HTTP_PROXY"))
        self.assertEqual(server.asked(), 1)

    def test_limits_hold_before_the_work(self):
        """What a file of some hundred bytes declares, is not done."""
        def tiff(name, width, height, options):
            image = gdal.GetDriverByName("GTiff").Create(str(FOLDER / name), width, height, 1, gdal.GDT_Float32,
                                                         [*options, "SPARSE_OK=TRUE", "BIGTIFF=YES"])
            image.SetGeoTransform((13.2, 0.2 / width, 0, 53.7, 0, -0.2 / height))
            image.SetProjection(osr_wkt)
            del image

        degrees = osr.SpatialReference()
        degrees.ImportFromEPSG(4326)
        osr_wkt = degrees.ExportToWkt()
        FOLDER.mkdir(parents=True, exist_ok=True)
        for name, width, height, options, said in (
                ("sparse.tif", 1_000_000, 1_000_000, ["TILED=YES"], "pixels would have to be read"),
                ("deflate.tif", 300_000, 300_000,
                 ["TILED=YES", "COMPRESS=DEFLATE", "BLOCKXSIZE=4096", "BLOCKYSIZE=4096"],
                 "pixels would have to be read"),
                ("strips.tif", 100, 100_000_000, ["BLOCKYSIZE=16"], "pixels would have to be read"),
                ("strip.tif", 20_000, 20_000, ["COMPRESS=DEFLATE", "BLOCKYSIZE=20000"],
                 "its blocks have 20,000 x 20,000 pixels")):
            tiff(name, width, height, options)
            self.refused("", None, said, file=FOLDER / name)
            picture = (f'<SrcRect xOff="0" yOff="0" xSize="{width}" ySize="{height}"/>'
                       '<DstRect xOff="0" yOff="0" xSize="100" ySize="100"/></SimpleSource>')
            self.refused(f"of_{name}.vrt", mosaic(FOLDER / name).replace("</SimpleSource>", picture), said)
        tiff("plain.tif", 4000, 4000, ["TILED=YES"])
        source = re.search("<SimpleSource>.*</SimpleSource>", mosaic(FOLDER / "plain.tif"))[0]
        self.refused("many.vrt", mosaic(FOLDER / "plain.tif", source * 10_000), "pixels would have to be read")
        header = "ncols {}\nnrows {}\nxllcorner 13.2\nyllcorner 53.5\ncellsize {}\n"
        (FOLDER / "grid.prj").write_text(osr_wkt)
        for columns, rows in ((10**6, 10**6), (2 * 10**9, 1), (1, 2 * 10**9), (10**30, 5), (-1, 5)):
            self.refused("grid.asc", header.format(columns, rows, 0.2 / max(columns, rows)) + "1 2 3\n")
        self.refused("huge.vrt", b"<VRTDataset>" + b" " * (17 << 20), "holds more than 16 MiB")
        self.refused("deep.vrt", "<VRTDataset>" * 100_000, ".")
        self.refused("self.vrt", mosaic("self.vrt", relative=1), "names")
        os.path.lexists(FOLDER / "pipe.prj") or os.mkfifo(FOLDER / "pipe.prj")
        self.refused("pipe.asc", header.format(3, 1, 0.1) + "1 2 3\n",
                     "belongs together with pipe.prj, which is not a regular file")

    def test_a_mosaic_of_files(self):
        """As gdalbuildvrt makes it of files in other folders, one of them far away."""
        (FOLDER / "west").mkdir(parents=True, exist_ok=True)
        west, east = write("west/w.tif", SLOPE[:, :150]), write("e.tif", SLOPE[:, 150:], low=(0.0, -1500.0))
        far = write("far.tif", SLOPE, low=(1e5, -1500.0))
        gdal.BuildVRT(str(FOLDER / "both.vrt"), [str(west), str(east), str(far)])
        whole, part = read(write("whole.tif", SLOPE))[0], read(FOLDER / "both.vrt")[0]
        np.testing.assert_allclose(part.posts, whole.posts, atol=1e-9)

    def test_warnings_of_gdal_are_ours(self):
        """Nothing is printed by GDAL itself."""
        content = bytearray(write("odd.tif", SLOPE).read_bytes())
        at = content.index(struct.pack("<HHI", 256, 3, 1))
        content[at:at + 24] = content[at + 12:at + 24] + content[at:at + 12]  # tags that are not in order
        (FOLDER / "odd.tif").write_bytes(content)
        found, heard = read(FOLDER / "odd.tif")
        self.assertAlmostEqual(found.here, 50.0, delta=1e-3)
        self.assertRegex(heard, "odd.tif: GDAL warns: .*not sorted")
