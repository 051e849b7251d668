# SPDX-License-Identifier: BSD-3-Clause
"""Every proxy against the contract and against its C++ class: names, labels, defaults, choices, help and units."""

import json
import math
import os
import re
import unittest

import avianlidar.vtkAvianLidar as module
from avianlidar import _suffixes
from paraview import servermanager, simple
from vtkmodules.vtkCommonCore import reference

from plugin_testing import SOURCE_DIR, load_plugin

SENSOR_FOLDER = os.path.join(SOURCE_DIR, "Filters", "Sensors")
SENSOR_FILE = ".lidarsensor.json"

# The contract: what scripts rely on. Inputs are marked by None, results by RESULTS; the steps to play, which have no
# place in a panel, by "steps"; otherwise the unit as the tooltip says it, "" for names, counts, choices and switches.
BEAM_SOURCE = {
    "Position": "metres",
    "Orientation": "degrees",
    "NumberOfChannels": "",
    "MinimumElevation": "degrees",
    "ElevationStep": "degrees",
    "ChannelElevations": "degrees",
    "AzimuthRange": "degrees",
    "AzimuthStep": "degrees",
    "HalfBeamwidth": "radians",
    "BeamwidthMilliradians": "milliradians",
    "HalfBeamwidthAcross": "radians",
    "BeamOutline": "",
    "BeamRotation": "degrees",
    "BeamProfile": "",
    "GaussianTruncation": "",
    "ThresholdLaw": "",
    "RotationRate": "hertz",
    "FiringInterval": "seconds",
    "NumberOfRevolutions": "",
    "StepsPerRevolution": "",
    "SwayAmplitude": "degrees",
    "SwayFrequency": "hertz",
    "EncoderJitter": "degrees",
    "MotionSeed": "",
    "TimestepValues": "steps",
    "PulseEnergy": "joules",
    "PulseWidth": "seconds",
    "Wavelength": "nanometres",
    "SamplingInterval": "seconds",
    "RangeGate": "metres",
    "NoisePhotonRate": "hertz",
    "LowerEnergyLimit": "joules",
    "UpperEnergyLimit": "joules",
    "ReceiverAperture": "square metres",
    "ReceiverModel": "",
    "ReceiverEfficiency": "",
    "FilterBandwidth": "nanometres",
    "BackgroundRadiance": "W/(m2 sr nm)",
    "AmplifierNoise": "electrons",
    "ExcessNoiseFactor": "",
    "FalseAlarmsPerScan": "",
    "DynamicRange": "decibels",
    "RangeNoise": "metres",
    "RangeNoiseExponent": "",
    "RangeNoiseFloor": "metres",
    "RangeWalk": "metres",
    "Sunlight": "W/(m2 nm)",
    "SunAzimuth": "degrees",
    "SunElevation": "degrees",
    "MinimumRange": "metres",
    "OverlapRange": "metres",
    "DefocusRange": "metres",
    "RangeQuantum": "metres",
    "DisplayLength": "metres",
}
# Each sensor that is built in is a source of its own: that of its file.
SENSORS = {file[: -len(SENSOR_FILE)]: json.load(open(os.path.join(SENSOR_FOLDER, file), encoding="utf-8"))
           for file in sorted(os.listdir(SENSOR_FOLDER)) if file.endswith(SENSOR_FILE)}
PRESETS = {"AvianLidar" + name.replace("_", ""): "SetPresetTo" + name for name in SENSORS}
# What an execution leaves for scripts, and the unit in the tooltip.
RESULTS = {"result in metres": "metres", "result, a count": "count", "result, a pure number": ""}
MEDIUM = {
    "Kind": "",
    "MeteorologicalVisibility": "metres",
    "RainRate": "millimetres",
    "LeafAreaDensity": "square metres",
    "Extinction": "1/m",
    "BackscatterRatio": "sr",
    "RenewedShare": "",
    "Shape": "",
    "Bottom": "metres",
    "Top": "metres",
    "Softness": "metres",
    "Center": "metres",
    "Lengths": "metres",
    "Heading": "degrees",
    "Velocity": "m/s",
    "Name": "",
    "DisplaySize": "metres",
}
CONTRACT = {
    "AvianLidarBeamSource": BEAM_SOURCE,
    **{name: BEAM_SOURCE for name in PRESETS},
    "AvianLidarBeamView": {
        "Beams": None,
        "Surfaces": None,
        "Movers": None,
        "BeamId": "",
        "RaysPerBeam": "",
        "AttenuationCoefficient": "1/m",
        "MeteorologicalVisibility": "metres",
        "AirBackscatter": "",
        "RainRate": "millimetres",
        "ReflectanceModel": "",
    },
    "AvianLidarBirdSource": {
        "Species": "",
        "SpeciesFileName": "",
        "WingPhase": "",
        "Gliding": "",
        "Position": "metres",
        "Heading": "degrees",
        "Bank": "degrees",
        "Reflectance": "",
        "ObjectId": "",
    },
    "AvianLidarMedium": MEDIUM,
    "AvianLidarMediumInSurface": {"Input": None, **MEDIUM},
    "AvianLidarTracks": {
        "Lines": None,
        "Pattern": "",
        "FileName": "",
        "Origin": "degrees",
        "Species": "",
        "SpeciesFileName": "",
        "NumberOfBirds": "",
        "Seed": "",
        "TimeRange": "seconds",
        "Center": "metres",
        "Radius": "metres",
        "Heights": "metres",
        "ThresholdPosition": "metres",
        "ThresholdHeading": "degrees",
        "Reflectance": "",
        "FirstObjectId": "",
    },
    "AvianLidarMaterial": {
        "Input": None,
        "Material": "",
        "Kd": "",
        "Ks": "",
        "Kp": "",
        "Roughness": "radians",
        "ObjectId": "",
        "ObjectName": "",
        "BlockNamePattern": "",
    },
    "AvianLidarCollisionTree": {
        "Input": None,
        "SplitRule": "",
        "BoundingVolume": "",
        "MaximumLeafSize": "",
        "DisplayLevel": "",
    },
    "AvianLidarEchoFilter": {
        "Beams": None,
        "Surfaces": None,
        "Movers": None,
        "Preset": "",
        "RaysPerBeam": "",
        "Sampling": "",
        "BeamSamples": "",
        "Seed": "",
        "AttenuationCoefficient": "1/m",
        "MeteorologicalVisibility": "metres",
        "AirBackscatter": "",
        "RainRate": "millimetres",
        "ReflectanceModel": "",
        "NumberOfReflections": "",
        "BeamConstraint": "",
        "LightEnergyConstraint": "",
        "LightEnergyFraction": "",
        "LightEnergyThreshold": "",
        "BatchCollisionDetection": "",
        "Noise": "",
        "FullModel": "",
        "ReturnMode": "",
        "NumberOfConnections": "",
        "ReportMovers": "",
        "NumberOfThreads": "",
        "MaximumCacheSize": "MiB",
        "NumberOfTracedRays": "result, a count",
    },
    "AvianLidarCoverage": {
        "Beams": None,
        "Surfaces": None,
        "Places": None,
        "Bounds": "metres",
        "Spacing": "metres",
        "Species": "",
        "SpeciesFileName": "",
        "Gliding": "",
        "EffectiveArea": "square metres",
        "Reflectance": "",
        "MeteorologicalVisibility": "metres",
        "AirBackscatter": "",
        "RainRate": "millimetres",
        "AttenuationCoefficient": "1/m",
        "Clutter": "",
        "RequiredDetections": "",
        "NumberOfScans": "",
        "HeightLimits": "metres",
        "StrikeHeightWeights": "",
        "AllSpecies": "",
        "PoseProbabilities": "",
        "Preset": "",
        "RaysPerBeam": "",
        "Seed": "",
        "NumberOfThreads": "",
        "MaximumCacheSize": "MiB",
        "NumberOfTracedPlaces": "result, a count",
    },
    "AvianLidarHSBColorMap": {"Input": None, "EnergyArray": "joules", "UseFieldDataRange": "", "EnergyRange": "joules"},
    "AvianLidarGeodeticTransform": {
        "Input": None,
        "SourceFrame": "metres",
        "TargetFrame": "metres",
        "MovePoints": "",
        "UseFieldDataOrigin": "",
        "Origin": "degrees",
        "UTMZone": "",
    },
    "AvianLidarTracker": {
        "Input": None,
        "ClusterDistance": "metres",
        "ClusterAngle": "degrees",
        "RangeError": "metres",
        "HalfBeamwidth": "radians",
        "TargetExtent": "metres",
        "SensorPosition": "metres",
        "MotionModel": "",
        "AccelerationDensity": "m2/s3",
        "TurnRateDensity": "deg2/s3",
        "MaximumSpeed": "m/s",
        "MaximumClimbRate": "m/s",
        "MaximumTurnRate": "degrees a second",
        "GateProbability": "",
        "ConfirmHits": "",
        "ConfirmScans": "",
        "MinimumSpeed": "m/s",
        "MaximumMisses": "",
        "MaximumPause": "seconds",
        "HistoryLength": "",
        "KeepTime": "seconds",
    },
    "AvianLidarRangeImage": {"Echoes": None, "Beams": None, "Columns": "", "Rows": ""},
    "AvianLidarClutterFilter": {
        "Input": None,
        "Table": None,
        "ClutterThreshold": "",
        "Learning": "",
        "Window": "",
        "WarmUp": "",
        "RangeStep": "metres",
        "AzimuthStep": "degrees",
        "ElevationStep": "degrees",
        "RangeTolerance": "",
        "AngularTolerance": "",
        "SensorPosition": "metres",
    },
    "AvianLidarCloudComparison": {
        "Simulated": None,
        "Reference": None,
        "HausdorffDistance": "result in metres",
        "HausdorffSimulatedToReference": "result in metres",
        "HausdorffReferenceToSimulated": "result in metres",
        "RMSESimulatedToReference": "result in metres",
        "RMSEReferenceToSimulated": "result in metres",
        "ChamferAlpha": "1/m",
        "DensityAwareChamferDistance": "result, a pure number",
        "DensityAwareChamferSimulatedToReference": "result, a pure number",
        "DensityAwareChamferReferenceToSimulated": "result, a pure number",
    },
    "AvianLidarSceneReader": {"FileName": ""},
    "AvianLidarPointCloudReader": {"FileName": "", "LocalCoordinates": "", "SensorAddress": "", "TimestepValues": "steps"},
    "AvianLidarSequenceReader": {"FileName": "", "TimestepValues": "steps"},
    "AvianLidarSensorReader": {"FileName": "", **{name: BEAM_SOURCE[name] for name in (
        "Position", "Orientation", "NumberOfRevolutions", "StepsPerRevolution")}},
    "AvianLidarUnitNames": {"Input": None},
}
# What every proxy has, and no panel.
INTERNAL = "ErrorsAsData"
CHOICES = {
    "Preset": ["Custom", "Draft", "Standard", "Reference"],
    "BeamOutline": ["Ellipse", "Rectangle"],
    "BeamProfile": ["Uniform", "Gaussian"],
    "ThresholdLaw": ["Fixed", "FollowsAir"],
    "ReceiverModel": ["EnergyLimits", "Photons"],
    "Material": ["Wall", "Glass", "Metal", "Wood", "Concrete", "Asphalt", "Grass", "Plumage", "Custom"],
    "SplitRule": ["Halves", "Median", "PrincipalPlane", "SurfaceAreaHeuristic"],
    "BoundingVolume": ["AABB", "OBB", "Sphere"],
    "BeamSamples": ["Cells", "Rays"],
    "Sampling": ["MonteCarlo", "Stratified"],
    "LightEnergyThreshold": ["ShareOfLimit", "Limit"],
    "ReflectanceModel": ["LambertBlinnPhong", "Phong", "Microfacet", "OrenNayar"],
    "ReturnMode": ["All", "Strongest", "First", "Last", "RangeUnits"],
    "BatchCollisionDetection": ["Rays", "Groups", "Beams"],
    "SourceFrame": ["ENU", "Geodetic", "ECEF", "UTM"],
    "TargetFrame": ["ENU", "Geodetic", "ECEF", "UTM"],
    "Kind": ["Haze", "Fog", "Drizzle", "Rain", "Snow", "Foliage", "Custom"],
    "Shape": ["Everywhere", "Layer", "Box", "Ellipsoid"],
    "MotionModel": ["ConstantVelocity", "CoordinatedTurn"],
    "Pattern": ["Crossings", "Circles", "Flock", "Approach", "File", "Lines"],
}
OTHER_NAMES = {"MeteorologicalVisibility": "Visibility"}  # of the class, where a proxy cannot have the same
SCALED = {"BeamwidthMilliradians": ("HalfBeamwidth", 2000)}  # a property of the class in another unit
# Groups of more than one unit.
MIXED = ("Frames (deg, m)", "Material (pure numbers, rad)", "Origin: latitude, longitude, height (deg, deg, m)")
OUTPUTS = {
    "AvianLidarBeamSource": ["Beams", "Rays"],
    **{name: ["Beams", "Rays"] for name in PRESETS},
    "AvianLidarBeamView": ["Surfaces", "Beam", "Shares"],
    "AvianLidarSequenceReader": ["Points", "Boxes"],
    "AvianLidarSensorReader": ["Beams", "Rays"],
    "AvianLidarTracker": ["Tracks", "Points"],
    "AvianLidarTracks": ["Movers", "Trails"],
    "AvianLidarCollisionTree": ["Surfaces", "Bounding Volumes"],
    "AvianLidarEchoFilter": ["Echoes", "Beam Report", "Mover Report"],
    "AvianLidarCoverage": ["Coverage", "Shares", "Clutter"],
    "AvianLidarCloudComparison": ["Simulated", "Reference"],
    "AvianLidarClutterFilter": ["Scan", "Table"],
}
# The values of the contract that are not only the class's business.
DEFAULTS = {
    "AvianLidarEchoFilter": {
        "Preset": "Custom",
        "RaysPerBeam": 100,
        "Sampling": "Stratified",
        "BeamSamples": "Cells",
        "Seed": 0,
        "AttenuationCoefficient": 3.5e-5,
        "MeteorologicalVisibility": 0,
        "AirBackscatter": 0,
        "RainRate": 0,
        "ReflectanceModel": "LambertBlinnPhong",
        "NumberOfReflections": 2,
        "BeamConstraint": 1,
        "LightEnergyConstraint": 1,
        "LightEnergyFraction": 1e-3,
        "LightEnergyThreshold": "ShareOfLimit",
        "BatchCollisionDetection": "Groups",
        "Noise": 1,
        "FullModel": 0,
        "ReturnMode": "All",
        "NumberOfConnections": 2,
        "ReportMovers": 1,
        "MaximumCacheSize": 1024,
    },
    "AvianLidarAirport16": {"NumberOfChannels": 16, "PulseEnergy": 3.6e-4, "RangeGate": 4000, "RotationRate": 0.5},
    "AvianLidarAirport32": {"NumberOfChannels": 32, "ElevationStep": 0.1875, "AzimuthStep": 0.1875},
    "AvianLidarSearch905": {"ReceiverModel": "Photons", "Wavelength": 905},
    "AvianLidarSearch1550": {"ReceiverModel": "Photons", "NumberOfChannels": 32, "PulseEnergy": 1e-3},
    "AvianLidarAutomotive16": {"ReceiverModel": "Photons", "AzimuthStep": 0.09, "RangeGate": 300},
    "AvianLidarCorridorC16": {"PulseEnergy": 2.5e-4, "RangeGate": 200, "RotationRate": 10, "FiringInterval": 5e-6},
}
READERS = ("AvianLidarSceneReader", "AvianLidarPointCloudReader", "AvianLidarSensorReader", "AvianLidarSequenceReader")
# Their proxies are no sources; TestWriters.py looks at them.
WRITERS = {*_suffixes.WRITERS.values()}
ABSTRACT = {"vtkAvianLidarCloudWriter", "vtkAvianLidarScanFilter"}
# What a button runs: TestAdvise.py.
BEHIND_BUTTONS = {"vtkAvianLidarAdvisor"}
# Properties that are buttons.
BUTTONS = {"AvianLidarEchoFilter": ["Advise"], **{name: ["Reload"] for name in READERS}}
# Properties with any number of values: the method that counts them, the one that gives them.
LISTS = {
    "ChannelElevations": ("GetNumberOfChannelElevations", "GetChannelElevation"),
    "HeightLimits": ("GetNumberOfHeightLimits", "GetHeightLimit"),
}


def cxx_object(name):
    """The class of a proxy, with the preset's values."""
    if name in PRESETS:
        instance = module.vtkAvianLidarBeamSource()
        getattr(instance, PRESETS[name])()
        return instance
    if name == "AvianLidarMediumInSurface":
        instance = module.vtkAvianLidarMedium()
        instance.SetShapeToSurface()
        return instance
    return getattr(module, "vtk" + name)()


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
    """(minimum, maximum) of a range domain; infinite where there is none."""
    there = reference(0)
    low = domain.GetMinimum(i, there)
    low = low if there.get() else -math.inf
    high = domain.GetMaximum(i, there)
    return low, high if there.get() else math.inf


def overridden():
    """The properties that some preset changes, as field data tell: no value of it is left as it was."""
    own = {"RaysPerBeam": 11, "Sampling": 0, "NumberOfReflections": 1}
    own.update({"NumberOfConnections": 3, "ReflectanceModel": 1, "Noise": 0, "ReturnMode": 1, "Seed": 5})
    contract = CONTRACT["AvianLidarEchoFilter"]
    switches = [p for p in contract if contract[p] == "" and p not in (*own, "Preset", "NumberOfThreads", "ReportMovers")]
    plane = simple.Plane()
    found = set()
    for value in (0, 1):
        settings = {**own, **dict.fromkeys(switches, value)}
        for preset in CHOICES["Preset"][1:]:
            beams = simple.AvianLidarBeamSource(AzimuthStep=90)
            echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=plane, Preset=preset)
            for prop, setting in settings.items():
                echoes.SMProxy.GetProperty(prop).SetElement(0, setting)
            echoes.SMProxy.UpdateVTKObjects()
            echoes.UpdatePipeline()
            for prop, setting in settings.items():
                snake = re.sub("(?<!^)(?=[A-Z])", "_", prop).lower()
                if echoes.FieldData[snake].GetRange(0)[0] != setting:
                    found.add(prop)
            simple.Delete(echoes)
            simple.Delete(beams)
    simple.Delete(plane)
    return found


def text_of(documentation):
    return " ".join((documentation or "").split())


class TestProxies(unittest.TestCase):
    def setUp(self):
        self.source = simple.AvianLidarBeamSource()
        self.proxies = {}
        for name, properties in CONTRACT.items():
            inputs = {prop: self.source for prop, unit in properties.items() if unit is None}
            self.proxies[name] = getattr(simple, name)(**inputs)

    def tearDown(self):
        for proxy in (*self.proxies.values(), self.source):
            simple.Delete(proxy)

    def each_property(self):
        """(proxy's name, property of the server manager, its name, its unit) of every property."""
        for name, proxy in self.proxies.items():
            for prop, unit in CONTRACT[name].items():
                yield name, proxy.SMProxy.GetProperty(prop), prop, unit

    def test_every_class_is_a_proxy(self):
        classes = {c for c in dir(module) if c.startswith("vtkAvianLidar")}
        made = {proxy.SMProxy.GetVTKClassName() for proxy in self.proxies.values()}
        self.assertEqual(classes, made | WRITERS | ABSTRACT | BEHIND_BUTTONS)

    def test_properties_are_those_of_the_contract(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                internal = [INTERNAL, *BUTTONS.get(name, [])]
                internal += ["TablesOfPreset"] if CONTRACT[name] is BEAM_SOURCE else []
                self.assertEqual(sorted(proxy.ListProperties()), sorted([*CONTRACT[name], *internal]))

    def test_the_advisor_is_an_echo_filter_with_a_question(self):
        advisor = servermanager.ProxyManager().NewProxy("internal_avian_lidar", "AvianLidarAdvisor")
        instance = module.vtkAvianLidarAdvisor()
        for prop in ("EnergyError", "RangeError", "MissedShare", "SampleBeams"):
            self.assertEqual(values_of(advisor.GetProperty(prop)), [getattr(instance, "Get" + prop)()], prop)
        for prop in CONTRACT["AvianLidarEchoFilter"]:
            self.assertIsNotNone(advisor.GetProperty(prop), prop)

    def test_errors_are_data_in_paraview_and_failures_in_vtk(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                self.assertTrue(proxy.SMProxy.GetClientSideObject().GetErrorsAsData())
                self.assertFalse(cxx_object(name).GetErrorsAsData())

    def test_label_is_the_name_in_words(self):
        for name, smproperty, prop, _ in self.each_property():
            with self.subTest(f"{name}.{prop}"):
                self.assertIsNotNone(smproperty)
                self.assertEqual(smproperty.GetXMLLabel(), words(prop))

    def test_default_is_that_of_the_class(self):
        for name, smproperty, prop, unit in self.each_property():
            with self.subTest(f"{name}.{prop}"):
                if unit is None or unit in RESULTS or unit == "steps" or prop == "EnergyArray":
                    continue
                instance = cxx_object(name)
                if prop in LISTS:
                    count, value = (getattr(instance, method) for method in LISTS[prop])
                    expected = [value(i) for i in range(count())]
                elif prop in SCALED:
                    other, factor = SCALED[prop]
                    expected = [round(factor * getattr(instance, "Get" + other)(), 9)]
                else:
                    expected = getattr(instance, "Get" + OTHER_NAMES.get(prop, prop))()
                    expected = "" if expected is None else expected
                    expected = list(expected) if isinstance(expected, tuple) else [expected]
                self.assertEqual(values_of(smproperty), expected)

    def test_default_is_that_of_the_contract(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                for prop, value in DEFAULTS.get(name, {}).items():
                    self.assertEqual(proxy.GetPropertyValue(prop), value, prop)

    def test_energy_array_is_that_of_the_class(self):
        self.assertEqual(list(self.proxies["AvianLidarHSBColorMap"].EnergyArray), ["POINTS", "energy"])

    def test_choices_are_the_constants_of_the_class(self):
        found = set()
        for name, smproperty, prop, _ in self.each_property():
            with self.subTest(f"{name}.{prop}"):
                for domain in domains_of(smproperty):
                    if domain.GetClassName() != "vtkSMEnumerationDomain":
                        continue
                    found.add(prop)
                    texts = [domain.GetEntryText(i) for i in range(domain.GetNumberOfEntries())]
                    self.assertEqual(texts, CHOICES[prop])
                    instance = cxx_object(name)
                    for i, text in enumerate(texts):
                        getattr(instance, f"Set{prop}To{text}")()
                        self.assertEqual(getattr(instance, "Get" + prop)(), domain.GetEntryValue(i), text)
        self.assertEqual(found, set(CHOICES))

    def test_every_property_has_a_domain_that_holds_its_default(self):
        for name, smproperty, prop, unit in self.each_property():
            with self.subTest(f"{name}.{prop}"):
                if unit in RESULTS or unit == "steps":
                    continue
                if prop not in ("ObjectName", "BlockNamePattern", "Species", "Name", "SensorAddress"):
                    self.assertTrue(domains_of(smproperty))
                for domain in domains_of(smproperty):
                    if domain.GetClassName() in ("vtkSMIntRangeDomain", "vtkSMDoubleRangeDomain"):
                        for i, value in enumerate(values_of(smproperty)):
                            low, high = bounds_of(domain, i)
                            self.assertTrue(low <= value <= high, (low, value, high))
                    elif domain.GetClassName() == "vtkSMEnumerationDomain":
                        self.assertTrue(smproperty.IsInDomains())

    def test_every_property_has_help_and_says_its_unit(self):
        for name, smproperty, prop, unit in self.each_property():
            with self.subTest(f"{name}.{prop}"):
                help_text = text_of(smproperty.GetDocumentation().GetDescription())
                self.assertGreater(len(help_text), 20)
                unit = "seconds" if unit == "steps" else unit
                if unit:
                    self.assertIn(RESULTS.get(unit, unit), help_text)

    def test_every_property_is_in_a_group_that_says_its_unit(self):
        symbols = {
            "metres": "m",
            "degrees": "deg",
            "radians": "rad",
            "milliradians": "mrad",
            "millimetres": "mm/h",
            "hertz": "Hz",
            "seconds": "s",
            "joules": "J",
            "square metres": "m2",
            "nanometres": "nm",
            "decibels": "dB",
            "electrons": "electrons",
            "W/(m2 sr nm)": "W/(m2 sr nm)",
            "W/(m2 nm)": "W/(m2 nm)",
            "1/m": "1/m",
            "sr": "sr",
            "m/s": "m/s",
            "m2/s3": "m2/s3",
            "deg2/s3": "deg2/s3",
            "degrees a second": "deg/s",
            "MiB": "MiB",
        }
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                smproxy = proxy.SMProxy
                groups = {}
                for i in range(smproxy.GetNumberOfPropertyGroups()):
                    group = smproxy.GetPropertyGroup(i)
                    for j in range(group.GetNumberOfProperties()):
                        groups[smproxy.GetPropertyName(group.GetProperty(j))] = group.GetXMLLabel()
                    units = re.search(r" \((.+)\)$", group.GetXMLLabel())
                    self.assertTrue(units, group.GetXMLLabel())
                    self.assertEqual("," in units.group(1), group.GetXMLLabel() in MIXED, group.GetXMLLabel())
                for prop, unit in CONTRACT[name].items():
                    if unit in (None, "steps") or prop == "FileName":
                        continue
                    self.assertIn(prop, groups)
                    unit = RESULTS.get(unit, unit)
                    if unit and unit != "count":
                        in_heading = re.search(r"\((.*)\)$", groups[prop]).group(1).split(", ")
                        self.assertIn(symbols[unit], in_heading, prop)

    def test_sensors_say_what_is_assumed(self):
        for name, preset in PRESETS.items():
            with self.subTest(name):
                lists = []
                instance = cxx_object(name)
                instance.Update()
                proxy = self.proxies[name]
                proxy.UpdatePipeline()
                for data in (instance.GetOutput(), simple.servermanager.Fetch(proxy)):
                    array = data.GetFieldData().GetAbstractArray("assumed")
                    lists.append(array and [array.GetValue(i) for i in range(array.GetNumberOfValues())])
                self.assertEqual(*lists)
                self.assertEqual(lists[0] is None, preset[11:] in ("Airport16", "Airport32", "CorridorC16"))

    def test_what_a_preset_overrides_is_hidden_and_nothing_else(self):
        proxy = self.proxies["AvianLidarEchoFilter"].SMProxy
        hidden = set()
        for prop in CONTRACT["AvianLidarEchoFilter"]:
            hints = proxy.GetProperty(prop).GetHints()
            decorator = hints.FindNestedElementByName("PropertyWidgetDecorator") if hints else None
            if decorator:
                found = {name: decorator.GetAttribute(name) for name in ("type", "mode", "property", "value")}
                self.assertEqual(
                    found, {"type": "GenericDecorator", "mode": "visibility", "property": "Preset", "value": "0"}
                )
                hidden.add(prop)
        self.assertEqual(hidden, overridden())

    def test_menus_and_help(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                smproxy = proxy.SMProxy
                documentation = smproxy.GetDocumentation()
                for text in (documentation.GetDescription(), documentation.GetShortHelp(), documentation.GetLongHelp()):
                    self.assertGreater(len(text_of(text)), 20)
                self.assertEqual(smproxy.GetXMLLabel().replace(" ", ""), name)
                if name not in READERS and name not in PRESETS:
                    menu = smproxy.GetHints().FindNestedElementByName("ShowInMenu")
                    self.assertEqual(menu.GetAttribute("category"), "Avian Lidar")

    def test_a_named_material_shows_its_coefficients(self):
        """As unchecked values, which the panel shows and Apply takes over; custom ones begin with them."""
        proxy = self.proxies["AvianLidarMaterial"].SMProxy
        material = proxy.GetProperty("Material")
        for i, text in enumerate(CHOICES["Material"]):
            value = domains_of(material)[0].GetEntryValueForText(text)
            expected = [module.vtkAvianLidarMaterial.GetMaterialCoefficient(value, i) for i in range(3)]
            named = not any(map(math.isnan, expected))
            self.assertEqual((named, module.vtkAvianLidarMaterial.GetMaterialName(value)),
                             (text != "Custom", text if text != "Custom" else None))
            material.SetUncheckedElement(0, value)
            found = [proxy.GetProperty(name).GetUncheckedElement(0) for name in ("Kd", "Ks", "Kp")]
            ranges = [bounds_of(domains_of(proxy.GetProperty(name))[0], 0) for name in ("Kd", "Ks", "Kp")]
            self.assertEqual(ranges, [(0, 1), (0, 1), (0, 10000)])  # of the sliders
            if named:
                plane = simple.AvianLidarMaterial(Input=self.source, Material=text)
                plane.UpdatePipeline()
                written = [plane.CellData[name].GetRange(0)[0] for name in ("kd", "ks", "kp")]
                self.assertEqual((found, written), (expected, expected), text)
                simple.Delete(plane)
                last = found
            else:
                self.assertEqual(found, last)

    def test_one_beamwidth_in_two_units(self):
        """What one property is set to is the other, in scripts and as the panel shows it; the last bit stays."""
        for name in PRESETS:
            proxy = self.proxies[name]
            proxy.HalfBeamwidthAcross = 0  # else the least is another
            half, full = (proxy.SMProxy.GetProperty(prop) for prop in ("HalfBeamwidth", "BeamwidthMilliradians"))
            for value in (0.0031, 0.007 / 3, 1e-9):
                proxy.HalfBeamwidth = value
                self.assertEqual(values_of(half), [value])
                self.assertAlmostEqual(proxy.BeamwidthMilliradians / (2000 * value), 1, delta=1e-12)
                proxy.BeamwidthMilliradians = 3000 * value
                self.assertEqual(proxy.BeamwidthMilliradians, 3000 * value)
                self.assertAlmostEqual(proxy.HalfBeamwidth / (1.5 * value), 1, delta=1e-12)
            proxy.UpdatePipeline()
            self.assertEqual(proxy.FieldData["half_beamwidth"].GetRange(0)[0], proxy.HalfBeamwidth)
            self.assertEqual([bounds_of(domains_of(prop)[0], 0) for prop in (half, full)], [(0, 0.02), (0, 40)])
            # As in the panel, before Apply.
            for one, other, factor in ((half, full, 2000), (full, half, 1 / 2000)):
                one.SetUncheckedElement(0, 0.5)
                self.assertAlmostEqual(other.GetUncheckedElement(0), 0.5 * factor, delta=1e-9)
                self.assertNotEqual(one.GetElement(0), 0.5)

    def test_sensors_are_those_of_their_files(self):
        """Also what has no property: the beams and all that they say are those of the class, and the menu has the makers."""
        for name, preset in PRESETS.items():
            with self.subTest(name):
                instance, proxy = cxx_object(name), self.proxies[name]
                instance.Update()
                proxy.UpdatePipeline()
                ours, theirs = instance.GetOutput(), servermanager.Fetch(proxy)
                for kind in ("GetPointData", "GetFieldData"):
                    ours_of, theirs_of = getattr(ours, kind)(), getattr(theirs, kind)()
                    self.assertEqual(ours_of.GetNumberOfArrays(), theirs_of.GetNumberOfArrays())
                    for i in range(ours_of.GetNumberOfArrays()):
                        one = ours_of.GetAbstractArray(i)
                        other = theirs_of.GetAbstractArray(one.GetName())
                        values = [[array.GetVariantValue(k).ToString() if array.IsA("vtkStringArray") else array.GetTuple(k)
                                   for k in range(0, array.GetNumberOfTuples(), max(1, array.GetNumberOfTuples() // 50))]
                                  for array in (one, other)]
                        self.assertEqual(*values, one.GetName())
                sensor = SENSORS[preset[len("SetPresetTo"):]]
                menu = proxy.SMProxy.GetHints().FindNestedElementByName("ShowInMenu").GetAttribute("category")
                maker = sensor.get("maker")
                self.assertEqual(menu, "Avian Lidar" + (f": {maker[0].upper() + maker[1:]}" if maker else ""))
                text = proxy.SMProxy.GetHints().FindNestedElementByName("AvianLidarMenu")
                self.assertEqual(text and text.GetAttribute("text"),
                                 f"{maker} {sensor['model']}" if maker not in (None, "assumed") else None)
        makers = {sensor.get("maker") for sensor in SENSORS.values()}
        self.assertEqual(makers, {None, "assumed", "Hesai", "Livox", "Ouster", "RoboSense", "Velodyne"})

    def test_every_sensor_fits_the_filters_that_take_beams(self):
        for name in PRESETS:
            proxy = self.proxies[name]
            proxy.UpdatePipeline()
            for taker in ("AvianLidarEchoFilter", "AvianLidarCoverage", "AvianLidarBeamView"):
                beams = servermanager.ProxyManager().GetPrototypeProxy("filters", taker).GetProperty("Beams")
                for source, fits in ((proxy, True), (self.proxies["AvianLidarBirdSource"], False)):
                    source.UpdatePipeline()
                    beams.RemoveAllUncheckedProxies()
                    beams.AddUncheckedInputConnection(source.SMProxy, 0)
                    self.assertEqual(bool(beams.IsInDomains()), fits, (name, taker))
                    beams.RemoveAllUncheckedProxies()

    def test_output_ports_are_named(self):
        for name, proxy in self.proxies.items():
            with self.subTest(name):
                smproxy = proxy.SMProxy
                if name not in OUTPUTS:
                    continue
                names = [smproxy.GetOutputPortName(i) for i in range(smproxy.GetNumberOfOutputPorts())]
                self.assertEqual(names, OUTPUTS[name])

    def test_constructors_take_every_property(self):
        beams = simple.AvianLidarBeamSource(Position=[1, 2, 3], ChannelElevations=[0.5, 1], BeamProfile="Gaussian")
        beams.UpdatePipeline()
        self.assertEqual(beams.GetDataInformation(0).GetNumberOfPoints(), 960 * 2)
        self.assertEqual(beams.FieldData["beam_profile"].GetRange(0), (1, 1))
        beams.ChannelElevations = []
        beams.UpdatePipeline()
        self.assertEqual(beams.GetDataInformation(0).GetNumberOfPoints(), 960 * 16)

    def test_inputs_that_do_not_fit_are_refused(self):
        beams = simple.AvianLidarBeamSource()
        plain = simple.Plane()
        multiblock = simple.GroupDatasets(Input=[plain, plain])
        image = simple.Wavelet()
        mesh = simple.Sphere()  # normals are arrays of three components, too
        echoes = simple.AvianLidarEchoFilter(Beams=beams, Surfaces=plain)
        for source in (plain, beams, multiblock, image, mesh, echoes):
            source.UpdatePipeline()
        filter_ = servermanager.ProxyManager().NewProxy("filters", "AvianLidarEchoFilter")
        coverage = servermanager.ProxyManager().NewProxy("filters", "AvianLidarCoverage")

        range_image = servermanager.ProxyManager().NewProxy("filters", "AvianLidarRangeImage")

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
        self.assertTrue(fits("Surfaces", mesh))
        self.assertFalse(fits("Beams", image))
        self.assertFalse(fits("Beams", multiblock))
        self.assertTrue(fits("Surfaces", plain))
        self.assertTrue(fits("Surfaces", multiblock))
        self.assertFalse(fits("Surfaces", image))
        self.assertTrue(fits("Places", plain, coverage))
        self.assertTrue(fits("Places", image, coverage))
        self.assertFalse(fits("Places", multiblock, coverage))


if __name__ == "__main__":
    load_plugin()
    unittest.main()
