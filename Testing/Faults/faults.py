#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Plants faults of different kinds, one at a time, and says which tests see each: so one knows what a cut of the tests loses.

    Testing/Faults/faults.py build/paraview -o faults.csv                  # all; hours
    Testing/Faults/faults.py build/paraview --only rain_half --tests Kernel

For each it patches a source file, builds, runs ctest, and restores the file. A fault that does not compile, or whose text is not found
exactly once, is an error. A row of the table: fault, kind, layer, the number of tests that fail, their names."""
import argparse
import collections
import csv
import pathlib
import re
import subprocess
import sys

SOURCE = pathlib.Path(__file__).resolve().parents[2]
Fault = collections.namedtuple("Fault", "name kind file old new")

FAULTS = [Fault(*fault) for fault in (
    # The kernel.
    ("mirror_sign", "a sign", "Filters/Kernel/Scene/Reflectance.cxx", "return incident - 2.0 * glm::dot(incident, normal) * normal;",
     "return incident + 2.0 * glm::dot(incident, normal) * normal;"),
    ("rain_half", "a missing factor of two", "Filters/Kernel/Scene/Medium.cxx", "perVolume * 2.0 / (lambda * lambda * lambda)",
     "perVolume / (lambda * lambda * lambda)"),
    ("background_without_aperture", "a missing factor", "Filters/Kernel/Sensor/PhotonReceiver.cxx",
     "sensor.solidAngle() * sensor.receiverAperture * sensor.samplingInterval", "sensor.solidAngle() * sensor.samplingInterval"),
    ("pulse_border", "an off-by-one at a border", "Filters/Kernel/Sensor/RangeUnits.cxx", "const bool meets = (pulseFirst < last) & (pulseLast >= first)",
     "const bool meets = (pulseFirst < last) & (pulseLast > first)"),
    ("nearest_axis", "a swapped index", "Filters/Kernel/Core/PointTree.cxx", "size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;\n"
     "  const std::size_t middle = range.begin + (range.end - range.begin) / 2;",
     "size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;\n  const std::size_t middle = range.begin + (range.end - range.begin) / 3;"),
    ("tie_order", "another choice among equals", "Filters/Kernel/Core/PointTree.cxx", "std::tie(low.x, low.y, low.z, index) <", "std::tie(low.x, low.z, low.y, index) <"),
    ("gate_fold", "a missing factor of two", "Filters/Kernel/Sensor/RangeErrors.cxx", "std::max(begin, 2.0 * sensor.rangeGate - range)",
     "std::max(begin, sensor.rangeGate - range)"),
    ("walk_of_upper_limit", "an exchanged member", "Filters/Kernel/Sensor/RangeErrors.cxx", "sensor.rangeWalk * std::min(1.0, sensor.lowerEnergyLimit / energy)",
     "sensor.rangeWalk * std::min(1.0, sensor.upperEnergyLimit / energy)"),
    ("square_profile", "a wrong constant", "Filters/Kernel/Sensor/BeamShape.cxx", "this->Fall = 4.0 * k * k;", "this->Fall = 2.0 * k * k;"),
    ("air_one_way", "a missing factor of two", "Filters/Kernel/Light/Throughput.cxx", "return transmission(attenuation, 2.0 * nearest) * SurelyAbove;",
     "return transmission(attenuation, 4.0 * nearest) * SurelyAbove;"),
    ("flap_bound", "a bound that is too small", "Filters/Kernel/Scene/Mover.cxx", "distance = safeLength(p - hinge) + safeLength(hinge - sphere.center);",
     "distance = safeLength(p - hinge);"),
    ("mover_hash", "a member that a checksum leaves out", "Filters/Kernel/Scene/Mover.cxx", "flap.amplitude, flap.frequency, flap.phase });",
     "flap.amplitude, flap.frequency });"),
    ("data_race", "a data race", "Filters/Kernel/Core/ParallelLoop.cxx", "const std::size_t begin = this->NextBlock.fetch_add(1) * this->Block;",
     "const std::size_t begin = this->NextBlock.load() * this->Block;\n    this->NextBlock.store(begin / this->Block + 1);"),
    ("utm_south", "a sign", "Filters/Kernel/Core/GeodeticFrame.cxx", "return { { x + FalseEasting, y + this->NorthingOffset, p[2] } };",
     "return { { x + FalseEasting, y - this->NorthingOffset, p[2] } };"),
    ("wing_area", "a wrong constant", "Filters/Kernel/Targets/Bird.cxx", "sum.across += 0.5 * (n.x * n.x + n.z * n.z) / area;",
     "sum.across += (n.x * n.x + n.z * n.z) / area;"),
    # The filters.
    ("seconds_for_microseconds", "a wrong unit", "Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx",
     "Add<vtkDoubleArray>(poly, time, [&](std::size_t i) { return 1e6 * poseOf(i).time; });",
     "Add<vtkDoubleArray>(poly, time, [&](std::size_t i) { return 1e3 * poseOf(i).time; });"),
    ("exchanged_arrays", "an exchanged array name", "Filters/Private/Common/vtkAvianLidarNames.h", 'constexpr Name EnergyReceived{ "energy_received", "J" };',
     'constexpr Name EnergyReceived{ "energy_recieved", "J" };'),
    ("intensity_of_none", "an offset", "Filters/Private/Echoes/vtkAvianLidarEchoOutput.cxx",
     "255.0 * std::min(1.0, std::max(0.0, (energy - sensor.lowerEnergyLimit) / width))", "255.0 * std::min(1.0, std::max(0.0, energy / width))"),
    ("lost_warning", "a lost warning", "Filters/vtkAvianLidarHSBColorMap.cxx", "++withoutNumber;", ";"),
    ("origin_of_the_whole", "a fallback that is gone", "Filters/vtkAvianLidarGeodeticTransform.cxx",
     "array = array ? array : this->Whole->GetFieldData()->GetArray(Arrays::GeodeticOrigin.name);", ""),
    ("leak", "a leak", "Filters/vtkAvianLidarGeodeticTransform.cxx", "auto converted = vtkSmartPointer<vtkPointSet>::Take(leaf->NewInstance());",
     "vtkSmartPointer<vtkPointSet> converted(leaf->NewInstance());"),
    # Readers and writers.
    ("not_initialised", "a member without a value", "IO/vtkAvianLidarKITTIWriter.cxx", "  : WriteLabels(true)\n  , LabelSource", "  : LabelSource"),
    ("las_seconds", "a wrong unit", "IO/Private/LasReading.cxx", "1e6 * load<double>(bytes + this->Record.time)", "load<double>(bytes + this->Record.time)"),
    ("las_colour_index", "a swapped index", "IO/Private/LasReading.cxx", "this->Colours[3 * i + c] = load<std::uint16_t>(bytes + this->Record.rgb + 2 * c);",
     "this->Colours[3 * i + 2 - c] = load<std::uint16_t>(bytes + this->Record.rgb + 2 * c);"),
    ("obstacle_feet", "a wrong unit", "IO/Private/Footprints.cxx", '(attribute == "AGL" || attribute == "AMSL") ? 0.3048 : 1.0', 'attribute == "AGL" ? 0.3048 : 1.0'),
    ("pcd_warning", "a lost warning", "IO/Private/PcdReading.cxx", "      hasMore = hasOneMoreRow(source, header);", "      hasMore = false;"),
    ("ply_of_255", "an off-by-one at a border", "IO/Private/PlyWriting.cxx", "if (points.size() > 255 || beyond)", "if (points.size() > 256 || beyond)"),
    ("kitti_left", "a sign", "IO/Private/KittiFormat.cxx", "storeAs(Scalar::Float32, -p[0], at + 4);", "storeAs(Scalar::Float32, p[0], at + 4);"),
    ("facade_hole", "geometry that is left out", "IO/Private/Extrusion.cxx", "  AddTriangle(mesh, f.bottomLeft, upper.front(), f.topLeft, wall);\n", ""),
    # Python.
    ("ospa_order", "a wrong power", "Python/avianlidar/apps/_scores.py", "missing = cutoff ** order * (most - least) / most",
     "missing = cutoff * (most - least) / most"),
    ("switch_twice", "an off-by-one", "Python/avianlidar/apps/_scores.py", "return sum(a != b for a, b in zip(had, had[1:]))", "return sum(a != b for a, b in zip(had, had[2:]))"),
    ("image_axes", "a swapped axis", "Python/avianlidar/_coverage.py", "values.reshape(data.GetDimensions()[::-1] + values.shape[1:])",
     "values.reshape(data.GetDimensions() + values.shape[1:])"),
    # ParaView's panels.
    ("panel_default", "a wrong default in a panel", "Plugin/Filters/AvianLidarBeamSource.xml", 'number_of_elements="1" default_values="4000">',
     'number_of_elements="1" default_values="400">'),
    ("panel_command", "a wrong command in a panel", "Plugin/IO/AvianLidarPointCloudReader.xml", 'command="SetSensorAddress"', 'command="SetFileName"'),
)]


def layer(fault):
    return "Kernel" if "/Kernel/" in fault.file else fault.file.split("/", 1)[0]


def ctest(build, tests):
    """Names of the tests that fail."""
    done = subprocess.run(["ctest", "--test-dir", build, "-j2", "--timeout", "900", "--output-on-failure", "-LE", "nightly|bare|install|more",
                           *(["-R", tests] if tests else [])], capture_output=True, text=True, check=False)
    if not re.search(r"tests passed", done.stdout):
        sys.exit(f"ctest: {done.stdout[-2000:]}{done.stderr[-2000:]}")
    return re.findall(r"^\s*\d+ - (\S+) \(", done.stdout, re.M)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", help="a build folder of this source, with tests")
    parser.add_argument("-o", "--out", type=pathlib.Path, default=pathlib.Path("faults.csv"), help="table, to which rows are added")
    parser.add_argument("--only", nargs="+", metavar="NAME", help="faults; default: all")
    parser.add_argument("--tests", metavar="REGEX", help="of ctest; default: the suite of Testing/run.sh")
    parser.add_argument("--list", action="store_true", help="only list them, and check that each text is there once")
    options = parser.parse_args()
    chosen = [fault for fault in FAULTS if not options.only or fault.name in options.only]
    for fault in chosen:
        found = (SOURCE / fault.file).read_text(encoding="utf-8").count(fault.old)
        if found != 1:
            sys.exit(f"{fault.name}: its text is {found} times in {fault.file}, expected once")
        if options.list:
            print(f"{fault.name:28} {layer(fault):8} {fault.kind:36} {fault.file}")
    if options.list:
        return
    before = ctest(options.build, options.tests)
    if before:
        sys.exit(f"without a fault {', '.join(before)} fail, expected that all pass")
    for fault in chosen:
        file = SOURCE / fault.file
        text = file.read_text(encoding="utf-8")
        try:
            file.write_text(text.replace(fault.old, fault.new), encoding="utf-8")
            if subprocess.run(["cmake", "--build", options.build], stdout=subprocess.DEVNULL, check=False).returncode:
                sys.exit(f"{fault.name} does not compile")
            failed = ctest(options.build, options.tests)
        finally:
            file.write_text(text, encoding="utf-8")
        with open(options.out, "a", newline="", encoding="utf-8") as stream:
            csv.writer(stream).writerow([fault.name, fault.kind, layer(fault), len(failed), " ".join(failed)])
        print(f"{fault.name}: {len(failed)} tests see it", flush=True)


if __name__ == "__main__":
    main()
