#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plants faults of different kinds and says which tests see each: so one knows what a cut of the tests loses.

    Testing/Faults/faults.py build/paraview -o faults.csv                # all: half an hour
    Testing/Faults/faults.py build/paraview --only rain_half --suite     # one, against the suite of Testing/run.sh

Each fault names the tests that should see it. Faults whose tests differ are planted at the same time, so that five
builds serve all: it patches source files, builds, runs these tests, and restores the files. A fault that does not
compile, or whose text is not found exactly once, is an error. A row of the table: fault, kind, layer, the number of
tests that fail, their names."""
import argparse
import collections
import contextlib
import csv
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
Fault = collections.namedtuple("Fault", "name kind tests file old new")

FAULTS = [Fault(*fault) for fault in (
    # The kernel.
    ("mirror_sign", "a sign", "Kernel-Test(Reflectance|MirrorRegions)|Python-TestMoreReflections",
     "Filters/Kernel/Scene/Reflectance.cxx", "return incident - 2.0 * glm::dot(incident, normal) * normal;",
     "return incident + 2.0 * glm::dot(incident, normal) * normal;"),
    ("rain_half", "a missing factor of two", "Kernel-Test(MediumVolume|Air)$|Python-TestMedium$",
     "Filters/Kernel/Air/Air.cxx", "perVolume * 2.0 / (lambda * lambda * lambda)",
     "perVolume / (lambda * lambda * lambda)"),
    ("background_without_aperture", "a missing factor",
     "Kernel-Test(PhotonReceiver|Background)|Python-Test(PhotonReceiver|Bench)$",
     "Filters/Kernel/Sensor/PhotonReceiver.cxx", "solidAngle() * sensor.receiverAperture *", "solidAngle() *"),
    ("pulse_border", "an off-by-one at a border", "Kernel-Test(RangeUnits|Receiver|PolygonUnits)$|Python-TestBeamView$",
     "Filters/Kernel/Light/Energy/RangeShares.cxx", "const bool meets = (pulseFirst < last) & (pulseLast >= first)",
     "const bool meets = (pulseFirst < last) & (pulseLast > first)"),
    ("nearest_axis", "a swapped index", "Python-TestCloudComparison$",
     "Filters/vtkAvianLidarCloudComparison.cxx", "Place(p[0], p[1], p[2])", "Place(p[0], p[2], p[1])"),
    ("tie_order", "another choice among equals", "Python-TestCloudComparison$",
     "Filters/vtkAvianLidarCloudComparison.cxx", "std::min(number, other.second)", "std::max(number, other.second)"),
    ("gate_fold", "a missing factor of two", "Kernel-Test(RangeErrors|Noise|Receiver)$|Python-TestRangeNoise$",
     "Filters/Kernel/Receive/RangeErrors.cxx", "std::max(begin, 2.0 * sensor.rangeGate - range)",
     "std::max(begin, sensor.rangeGate - range)"),
    ("walk_of_upper_limit", "an exchanged member", "Kernel-Test(RangeErrors|Noise)$|Python-TestRangeNoise$",
     "Filters/Kernel/Receive/RangeErrors.cxx", "sensor.rangeWalk * std::min(1.0, sensor.lowerEnergyLimit / energy)",
     "sensor.rangeWalk * std::min(1.0, sensor.upperEnergyLimit / energy)"),
    ("square_profile", "a wrong constant", "Kernel-Test(BeamShape|EffectiveArea)$|Python-TestOracles$",
     "Filters/Kernel/Beam/BeamShape.cxx", "this->Fall = 4.0 * k * k;", "this->Fall = 2.0 * k * k;"),
    ("air_one_way", "a missing factor of two", "Kernel-TestSecondaryConstraints$",
     "Filters/Kernel/Light/Energy/Throughput.cxx", "return transmission(attenuation, 2.0 * nearest) * SurelyAbove;",
     "return transmission(attenuation, 4.0 * nearest) * SurelyAbove;"),
    ("flap_bound", "a bound that is too small", "Kernel-Test(Mover|MovedBeams|Flight)$|Python-Test(Movers|BirdTracks)$",
     "Filters/Kernel/Scene/Mover.cxx", "distance = safeLength(p - hinge) + safeLength(hinge - sphere.center);",
     "distance = safeLength(p - hinge);"),
    ("mover_hash", "a member that a checksum leaves out", "Kernel-Test(Mover|MovedBeams)$",
     "Filters/Kernel/Scene/Mover.cxx", "flap.amplitude, flap.frequency, flap.phase });",
     "flap.amplitude, flap.frequency });"),
    ("data_race", "a data race", "Kernel-Test(ParallelLoop|Scan|CollisionTreeBuilder)$",
     "Filters/Kernel/Core/ParallelLoop.cxx", "const std::size_t begin = next.fetch_add(size);",
     "const std::size_t begin = next.load();\n        next.store(begin + size);"),
    ("utm_south", "a sign", "Kernel-TestGeodeticFrame$|Python-Test(GeodeticTransform|Site)$",
     "Filters/Kernel/Core/GeodeticFrame.cxx", "return { { x + FalseEasting, y + this->NorthingOffset, p[2] } };",
     "return { { x + FalseEasting, y - this->NorthingOffset, p[2] } };"),
    ("wing_area", "a wrong constant", "Kernel-Test(Bird|BirdViews)$|Python-TestBirdSource$",
     "Filters/Kernel/Targets/Bird.cxx", "sum.across += 0.5 * (n.x * n.x + n.z * n.z) / area;",
     "sum.across += (n.x * n.x + n.z * n.z) / area;"),
    # The filters.
    ("seconds_for_microseconds", "a wrong unit", "Python-TestMovers$",
     "Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx",
     "Add<vtkDoubleArray>(poly, time, [&](std::size_t i) { return 1e6 * poseOf(i).time; });",
     "Add<vtkDoubleArray>(poly, time, [&](std::size_t i) { return 1e3 * poseOf(i).time; });"),
    ("intensity_of_none", "an offset", "Python-TestEchoPipeline$",
     "Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx",
     "std::max(0.0, (energy - sensor.lowerEnergyLimit) / width)", "std::max(0.0, energy / width)"),
    ("lost_warning", "a lost warning", "Cxx-TestHSBColorMap|Python-TestBadInput$",
     "Filters/vtkAvianLidarHSBColorMap.cxx", "++withoutNumber;", ";"),
    ("origin_of_the_whole", "a fallback that is gone", "Python-Test(GeodeticTransform|BadInput)$",
     "Filters/vtkAvianLidarGeodeticTransform.cxx",
     "array = array ? array : this->Whole->GetFieldData()->GetArray(Arrays::GeodeticOrigin.name);", ""),
    ("leak", "a leak", "Prober-leaks$",
     "Filters/vtkAvianLidarGeodeticTransform.cxx",
     "auto converted = vtkSmartPointer<vtkPointSet>::Take(leaf->NewInstance());",
     "vtkSmartPointer<vtkPointSet> converted(leaf->NewInstance());"),
    # Readers and writers.
    ("not_initialised", "a member without a value", "Python-TestKITTIWriter$|Plugin-TestProxies$",
     "IO/vtkAvianLidarKITTIWriter.h", "Macro(WriteLabels, true)", "Macro(WriteLabels, WriteLabels)"),
    ("las_seconds", "a wrong unit", "Python-Test(LASWriter|PointCloudReader)$",
     "IO/Clouds/LasReading.cxx", "1e6 * load<double>(at + place)", "load<double>(at + place)"),
    ("las_colour_index", "a swapped index", "Python-Test(LASWriter|Laz|PointCloudReader)$",
     "IO/Clouds/LasReading.cxx", "t>(at + place + 2 * c)", "t>(at + place + 4 - 2 * c)"),
    ("obstacle_feet", "a wrong unit", "Python-TestSceneObjects$",
     "IO/Scenes/FootprintFeatures.cxx", '(attribute == "AGL" || attribute == "AMSL") ?', 'attribute == "AGL" ?'),
    ("pcd_warning", "a lost warning", "Python-Test(PCD|InputFiles)$",
     "IO/Clouds/PcdFormat.cxx", "hasOneMoreRow(source, header, readRows(source, header, targets, keepGoing))",
     "readRows(source, header, targets, keepGoing) == 0"),
    ("ply_of_255", "an off-by-one at a border", "Python-Test(PLY|MeshFiles)$",
     "IO/Clouds/PlyFormat.cxx", "points.size() > 255, \"polygon", "points.size() > 256, \"polygon"),
    ("kitti_left", "a sign", "Python-Test(KITTIWriter|PointCloudReader)$",
     "IO/vtkAvianLidarKITTIWriter.cxx", "storeAs(formats::Scalar::Float32, -p[0], bytes + 4);",
     "storeAs(formats::Scalar::Float32, p[0], bytes + 4);"),
    ("facade_hole", "geometry that is left out", "Python-Test(SceneObjects|MeshFiles|Boxes)$|Kernel-TestWatertight",
     "IO/Scenes/Extrusion.cxx", "  AddTriangle(mesh, f.bottomLeft, upper.front(), f.topLeft, wall);\n", ""),
    # Python.
    ("ospa_order", "a wrong power", "Python-Test(Scores|Tracks)$",
     "Python/avianlidar/apps/sequences/_scores.py", "missing = cutoff ** order * (most - least) / most",
     "missing = cutoff * (most - least) / most"),
    ("switch_twice", "an off-by-one", "Python-Test(Scores|Tracks)$",
     "Python/avianlidar/apps/sequences/_scores.py", "zip(had, had[1:])", "zip(had, had[2:])"),
    ("image_axes", "a swapped axis", "Python-TestCoverageMaps$",
     "Python/avianlidar/_coverage.py", "data.GetDimensions()[::-1] if isinstance(data, vtkImageData)",
     "data.GetDimensions() if isinstance(data, vtkImageData)"),
    # ParaView's panels.
    ("panel_default", "a wrong default in a panel", "Plugin-TestProxies$",
     "Plugin/Filters/AvianLidarBeamSource.xml", 'RangeGate" default_values="4000"', 'RangeGate" default_values="400"'),
    ("panel_command", "a wrong command in a panel", "Plugin-TestProxies$",
     "Plugin/IO/AvianLidarPointCloudReader.xml", 'name="SensorAddress"', 'name="SensorAddress" command="SetFileName"'),
    ("exchanged_arrays", "an exchanged array name",
     "Python-Test(EchoFiles|Glossary|PCD|EchoPipeline)$|Cxx-TestEchoFilter",
     "Filters/Private/Arrays/vtkAvianLidarNames.h", 'constexpr Name EnergyReceived{ "energy_received"',
     'constexpr Name EnergyReceived{ "energy_recieved"'),
)]


def layer(fault):
    return "Kernel" if "/Kernel/" in fault.file else fault.file.split("/", 1)[0]


def ctest(build, *arguments, left_out="bare|install"):
    return subprocess.run(["ctest", "--test-dir", build, "-LE", left_out, *arguments], capture_output=True, text=True,
                          check=False).stdout


def failing(build, names):
    """Names of the tests that fail or run out of time."""
    printed = ctest(build, "-j2", "--timeout", "900", "-R", f"^({'|'.join(map(re.escape, sorted(names)))})$")
    if "tests passed" not in printed:
        sys.exit(f"ctest: {printed[-2000:]}")
    return set(re.findall(r"^\s*\d+ - (\S+) \(", printed, re.M))


def groups(faults, tests):
    """Faults in groups of at most eight, of which no two change one file or have a test in common."""
    packed = []
    for fault in faults:
        for group in packed:
            if len(group) < 8 and all(fault.file != other.file and not tests[fault.name] & tests[other.name]
                                      for other in group):
                group.append(fault)
                break
        else:
            packed.append([fault])
    return packed


@contextlib.contextmanager
def planted(patches):
    """Files with replaced texts, which are restored afterwards. @param patches file, old and new text"""
    texts = {SOURCE / file: (SOURCE / file).read_text("utf-8") for file, *_ in patches}
    try:
        for file, old, new in patches:
            text = (SOURCE / file).read_text("utf-8")
            if text.count(old) != 1:
                sys.exit(f"the text to replace is {text.count(old)} times in {file}, expected once: {old}")
            (SOURCE / file).write_text(text.replace(old, new), "utf-8")
        yield
    finally:
        for file, text in texts.items():
            file.write_text(text, "utf-8")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="a build folder of this source, with tests")
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path("faults.csv"),
                        help="table, to which rows are added")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="faults; default: all")
    parser.add_argument("--suite", action="store_true",
                        help="run the whole suite for each, one fault at a time; default: the tests that each names")
    parser.add_argument("--short", action="store_true", help="only tests of Testing/run.sh")
    parser.add_argument("--list", action="store_true", help="only list them, and check that each text is there once")
    options = parser.parse_args()
    chosen = [fault for fault in FAULTS if not options.only or fault.name in options.only]
    for fault in chosen:
        found = (SOURCE / fault.file).read_text("utf-8").count(fault.old)
        if found != 1:
            sys.exit(f"{fault.name}: its text is {found} times in {fault.file}, expected once")
        if options.list:
            print(f"{fault.name:28} {layer(fault):8} {fault.kind:36} {fault.file}")
    if options.list:
        return
    left_out = "bare|install" + ("|nightly|more" if options.short or options.suite else "")
    known = re.findall(r"Test +#\d+: (\S+)$", ctest(options.build, "-N", left_out=left_out), re.M)
    tests = {fault.name: {name for name in known if options.suite or re.search(fault.tests, name)} for fault in chosen}
    for fault in chosen:
        if not tests[fault.name]:
            sys.exit(f"{fault.name}: no test of {options.build} has a name like {fault.tests}")
    for group in groups(chosen, tests):
        with planted([(fault.file, fault.old, fault.new) for fault in group]):
            if subprocess.run(["cmake", "--build", options.build], stdout=subprocess.DEVNULL, check=False).returncode:
                sys.exit(f"one of {', '.join(fault.name for fault in group)} does not compile")
            failed = failing(options.build, set().union(*(tests[fault.name] for fault in group)))
        with open(options.out, "a", newline="", encoding="utf-8") as stream:
            for fault in group:
                seen = sorted(failed & tests[fault.name])
                csv.writer(stream).writerow([fault.name, fault.kind, layer(fault), len(seen), " ".join(seen)])
                print(f"{fault.name}: {len(seen)} tests see it", flush=True)


if __name__ == "__main__":
    main()
