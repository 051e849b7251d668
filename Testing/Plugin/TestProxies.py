# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy against its C++ class: properties, labels, defaults, choices, help and units. Nothing is listed here that
a class says. A writer's class is that of its core, a proxy within the one of Save Data."""

import inspect
import math
import os
import pathlib
import re
import tempfile
import unittest

import avianlidar
import avianlidar.vtkAvianLidar as module
from avianlidar import _suffixes
from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import reference, vtkDataArray
from vtkmodules.vtkCommonExecutionModel import vtkPolyDataAlgorithm

from plugin_testing import SOURCE_DIR, load_plugin
from echotools import box, scan, sensor  # by the path that plugin_testing adds

SENSOR_FOLDER = os.path.join(SOURCE_DIR, "Filters", "Sensors")
# Each sensor that is built in is a source of its own: that of its file.
SENSORS = sorted(file.split(".")[0] for file in os.listdir(SENSOR_FOLDER) if file.endswith(".lidarsensor.json"))
PRESETS = {"AvianLidar" + name.replace("_", ""): "SetPresetTo" + name for name in SENSORS}
WRITERS = {*_suffixes.WRITERS.values()}
ABSTRACT = {"vtkAvianLidarCloudWriter", "vtkAvianLidarScanFilter"}
READERS = ("AvianLidarSceneReader", "AvianLidarPointCloudReader", "AvianLidarSensorReader", "AvianLidarSequenceReader")
# Methods of classes that are not properties: for programs, or the same value in another unit.
NOT_SHOWN = {"Controller", "Frequency", "Text", "NumberOfChannelElevations", "ChannelElevation", "HeightLimit"}
# Properties without a pair of Set and Get: buttons, lists, time steps, a preset's tables.
NO_PAIR = {"Advise", "KnownSpecies", "Reload", "TimestepValues", "TablesOfPreset", "ErrorsAsData", "EnergyArray"}
# of the class, where a proxy cannot have the same
OTHER_NAMES = {"MeteorologicalVisibility": "Visibility", "ObjectName": "NameOfObject"}
# Properties with any number of values: the method that counts them, the one that gives them.
LISTS = {"ChannelElevations": ("GetNumberOfChannelElevations", "GetChannelElevation"),
         "HeightLimits": ("GetNumberOfHeightLimits", "GetHeightLimit"),
         "AvianLidarPointCloudReader.FileName": ("GetNumberOfFileNames", "GetScanFileName")}
FREE_TEXTS = ("GivenFileName", "ObjectName", "BlockNamePattern", "Name", "SensorAddress")


def listed(name, prop):
    """The methods of a list of any length."""
    return LISTS.get(name, LISTS.get(prop))


def made(name):
    """The class of a proxy, with the preset's values."""
    if name in PRESETS:
        instance = module.vtkAvianLidarBeamSource()
        getattr(instance, PRESETS[name])()
        return instance
    if name == "AvianLidarMediumInSurface":
        instance = module.vtkAvianLidarMedium()
        instance.SetShapeToSurface()
        return instance
    return getattr(module, "vtk" + name.replace("Core", ""))()


def core_of(writer):
    """The proxy of a writer's class."""
    smproxy = servermanager.ProxyManager().NewProxy("internal_writers", writer[len("vtk"):] + "Core")
    smproxy.UpdateVTKObjects()
    return servermanager._getPyProxy(smproxy)


def pairs(instance):
    """The properties of a class that Set and Get have."""
    methods = set(dir(instance)) - set(dir(vtkPolyDataAlgorithm))
    found = {name[3:] for name in methods if name.startswith("Set") and "Get" + name[3:] in methods}
    return found - NOT_SHOWN - NO_PAIR


def words(name):
    """NumberOfRays -> Number Of Rays, UTMZone -> UTM Zone."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", name)


def values_of(smproperty):
    return [smproperty.GetElement(i) for i in range(smproperty.GetNumberOfElements())]


def domains_of(smproperty):
    iterator = smproperty.NewDomainIterator()
    iterator.UnRegister(None)
    domains = []
    iterator.Begin()
    while not iterator.IsAtEnd():
        domains.append(iterator.GetDomain())
        iterator.Next()
    return domains


def bounds_of(domain, i):
    """(minimum, maximum) of a range domain; infinite without a range domain."""
    there = reference(0)
    low = domain.GetMinimum(i, there)
    low = low if there.get() else -math.inf
    high = domain.GetMaximum(i, there)
    return low, high if there.get() else math.inf


def overridden():
    """The properties that some preset changes, as field data tell: no value of it is left as it was."""
    own = {"RaysPerBeam": 11, "Sampling": 0, "NumberOfReflections": 1}
    own.update({"NumberOfConnections": 3, "ReflectanceModel": 1, "Noise": 0, "ReturnMode": 1, "Seed": 5})
    amounts = {"Visibility", "AttenuationCoefficient", "RainRate", "MaximumCacheSize", "NumberOfThreads",
               "ReportMovers", "Preset"}
    switches = sorted(pairs(module.vtkAvianLidarEchoFilter()) - amounts - {*own})
    found = set()
    for value in (0, 1):
        settings = {**own, **dict.fromkeys(switches, value)}
        for preset in (1, 2, 3):
            echoes = scan(box((50, 0, 0), (1, 60, 10), "Wall"), sensor(4, 1), **settings, Preset=preset)
            echoes.Update()
            for prop, setting in settings.items():
                snake = re.sub("(?<!^)(?=[A-Z])", "_", prop).lower()
                if echoes.GetOutput().GetFieldData().GetArray(snake).GetComponent(0, 0) != setting:
                    found.add(prop)
    return found


def text_of(documentation):
    return " ".join((documentation or "").split())


class TestProxies(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.source = simple.AvianLidarBeamSource()
        cls.proxies = {}
        for name in sorted(word for word in vars(simple) if word.startswith("AvianLidar")):
            known = servermanager.ProxyManager()
            prototype = known.GetPrototypeProxy("filters", name) or known.GetPrototypeProxy("sources", name)
            if prototype and prototype.GetVTKClassName() not in ("", "vtkAvianLidar", *WRITERS):
                cls.proxies[name] = getattr(simple, name)()
        cls.cores = {writer[len("vtk"):] + "Core": core_of(writer) for writer in WRITERS}
        cls.inputs = {name: {prop for prop in proxy.ListProperties()
                             if proxy.SMProxy.GetProperty(prop).IsA("vtkSMProxyProperty")}
                      for name, proxy in (*cls.proxies.items(), *cls.cores.items())}

    def each_property(self, with_results=False):
        """(name, object of the class, property of the server manager, its name) of every property with a value."""
        for name, proxy in (*self.proxies.items(), *self.cores.items()):
            instance = made(name)
            for prop in sorted({*proxy.ListProperties()} - self.inputs[name] - NO_PAIR):
                smproperty = proxy.SMProxy.GetProperty(prop)
                if with_results or not smproperty.GetInformationOnly():
                    yield f"{name}.{prop}", instance, smproperty, prop

    def test_every_class_is_a_proxy(self):
        classes = {c for c in dir(module) if c.startswith("vtkAvianLidar")}
        found = {proxy.SMProxy.GetVTKClassName() for proxy in (*self.proxies.values(), *self.cores.values())}
        self.assertEqual(classes, found | ABSTRACT)

    def test_properties_are_those_of_the_class(self):
        for name, proxy in (*self.proxies.items(), *self.cores.items()):
            with self.subTest(name):
                shown = {OTHER_NAMES.get(prop, prop)
                         for prop in proxy.ListProperties()} - self.inputs[name] - NO_PAIR - set(LISTS)
                shown -= {prop for prop in shown if proxy.SMProxy.GetProperty(prop)
                          and proxy.SMProxy.GetProperty(prop).GetInformationOnly()}
                instance = made(name)
                expected = pairs(instance)
                # what they inherit is not all theirs
                if name in ("AvianLidarBeamView", "AvianLidarCoverage", "AvianLidarSensorReader"):
                    expected = {prop for prop in expected if prop in shown or "Set" + prop in vars(type(instance))}
                if name in self.cores:
                    expected -= {"FileName"}
                    writer = servermanager.ProxyManager().GetPrototypeProxy("writers", name.replace("Core", ""))
                    self.assertTrue(all(writer.GetProperty(prop) for prop in shown - {"GivenFileName"}))
                self.assertEqual(shown, expected)

    def test_writers(self):
        for suffix, writer in _suffixes.WRITERS.items():
            proxy = servermanager.ProxyManager().GetPrototypeProxy("writers", writer[len("vtk"):])
            self.assertIn(suffix[1:],
                          proxy.GetHints().FindNestedElementByName("WriterFactory").GetAttribute("extensions").split())
            self.check_words(writer[len("vtk"):], proxy)

    def test_the_advisor_is_an_echo_filter_with_a_question(self):
        advisor = servermanager.ProxyManager().NewProxy("internal_avian_lidar", "AvianLidarAdvisor")
        defaults = [parameter.default
                    for parameter in inspect.signature(avianlidar.Scan.advise).parameters.values()][1:5]
        for prop, default in zip(("EnergyError", "RangeError", "MissedShare", "SampleBeams"), defaults):
            self.assertEqual(values_of(advisor.GetProperty(prop)), [default], prop)
        for prop in self.proxies["AvianLidarEchoFilter"].ListProperties():
            self.assertTrue(prop in NO_PAIR or advisor.GetProperty(prop), prop)

    def test_errors_are_data_in_paraview_and_failures_in_vtk(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                self.assertTrue(proxy.SMProxy.GetClientSideObject().GetErrorsAsData())
                self.assertFalse(made(name).GetErrorsAsData())

    def test_labels_and_help(self):
        for name, _, smproperty, prop in self.each_property(with_results=True):
            with self.subTest(name):
                self.assertEqual(smproperty.GetXMLLabel(), words(prop))
                self.assertGreater(len(text_of(smproperty.GetDocumentation().GetDescription())), 20)

    def test_default_is_that_of_the_class(self):
        for name, instance, smproperty, prop in self.each_property():
            with self.subTest(name):
                if listed(name, prop):
                    count, value = (getattr(instance, method) for method in listed(name, prop))
                    expected = [value(i) for i in range(count())]
                elif prop == "BeamwidthMilliradians":
                    expected = [round(2000 * instance.GetHalfBeamwidth(), 9)]
                else:
                    expected = getattr(instance, "Get" + OTHER_NAMES.get(prop, prop))()
                    expected = "" if expected is None else expected
                    expected = list(expected) if isinstance(expected, tuple) else [expected]
                self.assertEqual(values_of(smproperty), expected)
        self.assertEqual(list(self.proxies["AvianLidarHSBColorMap"].EnergyArray), ["POINTS", "energy"])

    def test_a_value_reaches_the_class(self):
        fresh = {name: getattr(simple, name)().SMProxy for name in self.proxies if name not in PRESETS}
        fresh.update((writer[len("vtk"):] + "Core", core_of(writer).SMProxy) for writer in WRITERS)
        for name, _, smproperty, prop in self.each_property():
            proxy = fresh.get(name.split(".")[0])
            if proxy and not listed(name, prop) and prop != "BeamwidthMilliradians" and smproperty.GetCommand():
                smproperty = proxy.GetProperty(prop)
                last = values_of(smproperty)[-1]
                value = last + "x" if isinstance(last, str) else last + 1 if last != 1 else 0
                with self.subTest(name):
                    smproperty.SetElement(smproperty.GetNumberOfElements() - 1, value)
                    proxy.UpdateProperty(prop)
                    found = getattr(proxy.GetClientSideObject(), "Get" + OTHER_NAMES.get(prop, prop))()
                    self.assertEqual(found[-1] if isinstance(found, tuple) else found, value)

    def test_choices_are_the_constants_of_the_class(self):
        found = 0
        for name, instance, smproperty, prop in self.each_property():
            choices = {method[len(f"Set{prop}To"):] for method in dir(instance) if method.startswith(f"Set{prop}To")}
            domains = [domain for domain in domains_of(smproperty) if domain.GetClassName() == "vtkSMEnumerationDomain"]
            with self.subTest(name):
                self.assertEqual(len(domains), bool(choices) and name != "AvianLidarMediumInSurface.Shape")
                for domain in domains:
                    texts = [domain.GetEntryText(i) for i in range(domain.GetNumberOfEntries())]
                    self.assertEqual({*texts}, choices - {"Surface"})  # a shape with a proxy of its own
                    for i, text in enumerate(texts):
                        found += 1
                        getattr(instance, f"Set{prop}To{text}")()
                        self.assertEqual(getattr(instance, "Get" + prop)(), domain.GetEntryValue(i), text)
        self.assertGreater(found, 100)

    def test_every_property_has_a_domain_that_holds_its_default(self):
        for name, _, smproperty, prop in self.each_property():
            with self.subTest(name):
                self.assertTrue(domains_of(smproperty) or prop in FREE_TEXTS)
                for domain in domains_of(smproperty):
                    if domain.GetClassName() in ("vtkSMIntRangeDomain", "vtkSMDoubleRangeDomain"):
                        for i, value in enumerate(values_of(smproperty)):
                            low, high = bounds_of(domain, i)
                            self.assertTrue(low <= value <= high, (low, value, high))
                    elif domain.GetClassName() == "vtkSMEnumerationDomain":
                        self.assertTrue(smproperty.IsInDomains())

    def groups_of(self, name):
        """{property: heading of its group}"""
        smproxy = self.proxies[name].SMProxy
        groups = [smproxy.GetPropertyGroup(i) for i in range(smproxy.GetNumberOfPropertyGroups())]
        return {smproxy.GetPropertyName(group.GetProperty(j)): group.GetXMLLabel() for group in groups
                for j in range(group.GetNumberOfProperties())}

    def test_units_are_those_of_the_data(self):
        """In the heading of the group, where field data say the unit."""
        found = 0
        for name, proxy in self.proxies.items():
            groups = self.groups_of(name)
            for heading in groups.values():
                self.assertRegex(heading, r" \(.+\)$")
            for prop in {*proxy.ListProperties()} - self.inputs[name] - NO_PAIR - {"FileName"}:
                self.assertIn(prop, groups, name)
            if self.inputs[name] - {"Trajectory"} or name in READERS:
                continue
            proxy.UpdatePipeline()
            fields = servermanager.Fetch(proxy).GetFieldData()
            for prop, heading in groups.items():
                array = fields.GetAbstractArray(re.sub("(?<!^)(?=[A-Z])", "_", prop).lower())
                unit = array and array.GetInformation().Get(vtkDataArray.UNITS_LABEL())
                if unit and unit != "1":
                    with self.subTest(f"{name}.{prop}", unit=unit):
                        found += 1
                        self.assertIn(unit, re.search(r"\((.*)\)$", heading)[1].split(", "))
        self.assertGreater(found, 100)

    def test_what_a_preset_overrides_is_hidden_and_nothing_else(self):
        proxy = self.proxies["AvianLidarEchoFilter"].SMProxy
        hidden = set()
        for prop in self.proxies["AvianLidarEchoFilter"].ListProperties():
            hints = proxy.GetProperty(prop).GetHints()
            decorator = hints.FindNestedElementByName("PropertyWidgetDecorator") if hints else None
            if decorator:
                found = {name: decorator.GetAttribute(name) for name in ("type", "mode", "property", "value")}
                self.assertEqual(
                    found, {"type": "GenericDecorator", "mode": "visibility", "property": "Preset", "value": "0"}
                )
                hidden.add(prop)
        self.assertEqual(hidden, overridden())

    def check_words(self, name, smproxy):
        documentation = smproxy.GetDocumentation()
        for text in (documentation.GetDescription(), documentation.GetShortHelp(), documentation.GetLongHelp()):
            self.assertGreater(len(text_of(text)), 20)
        self.assertEqual(smproxy.GetXMLLabel().replace(" ", ""), name)

    def test_species_are_a_list(self):
        """The built-in species and, after an execution, the species of the user's table. A value that is not known
        stays."""
        table = pathlib.Path(SOURCE_DIR, "Filters", "Birds", "species.csv").read_text("utf-8").splitlines()
        built_in = [line.split(",")[0] for line in table if not line.startswith("#")][1:]
        with tempfile.TemporaryDirectory() as folder:
            own = pathlib.Path(folder, "own.csv")
            own.write_text("\n".join(table).replace("pigeon", "barn owl"), "utf-8")
            for name, empty in (("AvianLidarBirdSource", []), ("AvianLidarTracks", [""]), ("AvianLidarCoverage", [""])):
                simple.SetActiveSource(None)
                source = getattr(simple, name)()
                (domain,) = domains_of(source.SMProxy.GetProperty("Species"))
                strings = lambda: [domain.GetString(i) for i in range(domain.GetNumberOfStrings())]
                source.UpdatePropertyInformation()
                self.assertEqual(strings(), empty + built_in)
                source.Species = "albatross"
                self.assertEqual(strings(), [*empty, *built_in, "albatross"])
                source.Species, source.SpeciesFileName = "barn owl", str(own)
                source.UpdatePropertyInformation()
                self.assertEqual(strings(), [*empty, *built_in, "barn owl"])

    def test_menus_and_help(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                smproxy = proxy.SMProxy
                self.check_words(name, smproxy)
                if name not in READERS and name not in PRESETS:
                    menu = smproxy.GetHints().FindNestedElementByName("ShowInMenu")
                    self.assertEqual(menu.GetAttribute("category"), "Avian Lidar")

    def test_a_named_material_shows_its_coefficients(self):
        """As unchecked values, which the panel shows and Apply takes over; custom ones begin with them."""
        proxy = self.proxies["AvianLidarMaterial"].SMProxy
        material, shown = proxy.GetProperty("Material"), [proxy.GetProperty(name) for name in ("Kd", "Ks", "Kp")]
        # of the sliders
        self.assertEqual([bounds_of(domains_of(prop)[0], 0) for prop in shown], [(0, 1), (0, 1), (0, 10000)])
        choices, last = domains_of(material)[0], None
        for text in (choices.GetEntryText(i) for i in range(choices.GetNumberOfEntries())):
            value = choices.GetEntryValueForText(text)
            expected = [module.vtkAvianLidarMaterial.GetMaterialCoefficient(value, i) for i in range(3)]
            self.assertEqual(module.vtkAvianLidarMaterial.GetMaterialName(value), text if text != "Custom" else None)
            material.SetUncheckedElement(0, value)
            found = [prop.GetUncheckedElement(0) for prop in shown]
            if text == "Custom":
                self.assertEqual(found, last)
                continue
            plane = simple.AvianLidarMaterial(Input=self.source, Material=text)
            plane.UpdatePipeline()
            last = [plane.CellData[name].GetRange(0)[0] for name in ("kd", "ks", "kp")]
            self.assertEqual((found, last), (expected, expected), text)
            simple.Delete(plane)

    def test_one_beamwidth_in_two_units(self):
        """What one property is set to is the other, in scripts and as the panel shows it; the last bit stays."""
        for name in ("AvianLidarAirport16", "AvianLidarSearch905"):
            proxy = getattr(simple, name)(HalfBeamwidthAcross=0)  # else the least is another
            half, full = (proxy.SMProxy.GetProperty(prop) for prop in ("HalfBeamwidth", "BeamwidthMilliradians"))
            for value in (0.007 / 3, 1e-9):
                proxy.HalfBeamwidth = value
                self.assertEqual((values_of(half), round(proxy.BeamwidthMilliradians / (2000 * value), 12)),
                                 ([value], 1))
                proxy.BeamwidthMilliradians = 3000 * value
                self.assertEqual((values_of(full), round(proxy.HalfBeamwidth / (1.5 * value), 12)), ([3000 * value], 1))
            proxy.UpdatePipeline()
            self.assertEqual(proxy.FieldData["half_beamwidth"].GetRange(0)[0], proxy.HalfBeamwidth)
            # As in the panel, before Apply.
            for one, other, factor in ((half, full, 2000), (full, half, 1 / 2000)):
                one.SetUncheckedElement(0, 0.5)
                self.assertAlmostEqual(other.GetUncheckedElement(0), 0.5 * factor, delta=1e-9)
                self.assertNotEqual(one.GetElement(0), 0.5)

    def test_sensors_are_those_of_their_files(self):
        """The beams and all that they say are those of the class. TestWindow.py looks at the menus."""
        for name, preset in PRESETS.items():
            with self.subTest(name):
                instance, proxy = made(name), self.proxies[name]
                instance.Update()
                proxy.UpdatePipeline()
                ours, theirs = avianlidar.Cloud(instance.GetOutput()), avianlidar.Cloud(servermanager.Fetch(proxy))
                self.assertEqual({**ours, **theirs}.keys(), ours.keys() & theirs.keys())
                self.assertTrue(all(ours[array].tobytes() == theirs[array].tobytes() for array in ours))
                self.assertEqual(repr(theirs.fields), repr(ours.fields))

    def test_output_ports_are_named(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                smproxy = proxy.SMProxy
                names = [smproxy.GetOutputPortName(i) for i in range(smproxy.GetNumberOfOutputPorts())]
                self.assertTrue(len(names) == 1 or not any(one.startswith("Output") for one in names), names)

    def test_a_list_of_any_length(self):
        beams = simple.AvianLidarBeamSource(ChannelElevations=[0.5, 1])
        for channels in (2, 16):
            beams.UpdatePipeline()
            self.assertEqual(beams.GetDataInformation(0).GetNumberOfPoints(), 960 * channels)
            beams.ChannelElevations = []

    def test_inputs_that_do_not_fit_are_refused(self):
        beams = simple.AvianLidarBeamSource()
        plain = simple.Plane()
        multiblock = simple.GroupDatasets(Input=[plain, plain])
        image = simple.Wavelet()
        mesh = simple.Sphere()  # normals are arrays of three components, too
        echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=plain)
        for source in (plain, beams, multiblock, image, mesh, echoes):
            source.UpdatePipeline()
        filter_, coverage, range_image = (servermanager.ProxyManager().NewProxy("filters", "AvianLidar" + name)
                                          for name in ("EchoFilter", "Coverage", "RangeImage"))

        def fits(port, source, proxy=filter_, output=0):
            smproperty = proxy.GetProperty(port)
            smproperty.RemoveAllUncheckedProxies()
            smproperty.AddUncheckedInputConnection(source.SMProxy, output)
            return bool(smproperty.IsInDomains())

        for proxy in (filter_, coverage, range_image):
            self.assertTrue(fits("Beams", beams, proxy))
            self.assertFalse(fits("Beams", mesh, proxy))
            if proxy is not range_image:
                self.assertFalse(fits("Beams", echoes, proxy))
            self.assertEqual(fits("Beams", echoes, proxy, 1), proxy is range_image)  # the beam report
        for port, proxy, good, bad in (("Beams", filter_, (), (image, multiblock)),
                                       ("Surfaces", filter_, (mesh, plain, multiblock), (image,)),
                                       ("Places", coverage, (plain, image), (multiblock,))):
            self.assertEqual([fits(port, source, proxy) for source in (*good, *bad)],
                             [True] * len(good) + [False] * len(bad), port)

    def test_what_a_panel_shows_first_and_what_opens_a_file(self):
        tracks, shown = simple.AvianLidarTracks(), {}
        for name in ("NumberOfBirds", "Center", "Heights", "Radius", "ThresholdPosition", "ThresholdHeading",
                     "FileName"):
            one = tracks.SMProxy.GetProperty(name).GetHints().FindNestedElementByName("PropertyWidgetDecorator")
            shown[name] = one.GetAttribute("value") or one.GetAttribute("values")
        self.assertEqual(shown, {"NumberOfBirds": "0 1 2 3", "Center": "0 1 2", "Heights": "0 1 2", "Radius": "0 1 2 3",
                                 "ThresholdPosition": "3", "ThresholdHeading": "3", "FileName": "4"})
        cover = simple.AvianLidarCoverage()
        first = {n for n in cover.ListProperties() if cover.SMProxy.GetProperty(n).GetPanelVisibility() == "default"}
        self.assertEqual(first, set("Beams Surfaces Places Bounds Spacing Species Reflectance EffectiveArea "
                                    "MeteorologicalVisibility RequiredDetections NumberOfScans HeightLimits".split()))
        hints = simple.AvianLidarPointCloudReader(FileName="x.pcd").SMProxy.GetHints()
        factory = hints.FindNestedElementByName("ReaderFactory")
        self.assertEqual({"." + one for one in factory.GetAttribute("extensions").split()}, set(_suffixes.READERS))


if __name__ == "__main__":
    load_plugin()
    unittest.main()
