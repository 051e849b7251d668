// SPDX-License-Identifier: BSD-3-Clause
// Fixed scenes through the kernel's public doors, every number printed with all its bits, for
// compare_instruction_sets.py, which runs this program on several processors.
//
// Scenes are made without libm, whose results depend on the processor: what differs then differs
// inside the kernel.
#include "LaneMath.h"
#include "RoomTestScene.h"
#include "VolumeTree.h"

#include <cstdio>
#include <string>

using namespace echotest;
using geometrytest::Numbers;

namespace
{
// Chosen by the mechanism, and for the instruction sets, of Multiversion.h.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
__attribute__((target("default"))) const char* instructionSet()
{
  return "x86-64";
}
__attribute__((target("arch=x86-64-v3"))) const char* instructionSet()
{
  return "x86-64-v3";
}
__attribute__((target("arch=x86-64-v4"))) const char* instructionSet()
{
  return "x86-64-v4";
}
#else
const char* instructionSet()
{
  return "the compiler's target";
}
#endif

struct Case
{
  std::string name;
  Scene scene;
  ScanBeams beams;
  double halfBeamwidth = 5.6e-3;
};

/// Boxes on level ground about `at`. Beams in four rows of neighbours meet several of them at once.
Case street(const std::string& name, const Vec3& at)
{
  Numbers random(7);
  const Material materials[] = { Wall, Glass, Metal, Wood };
  Case result{ name, {}, {}, 1.2e-2 };
  result.scene.plate(at - Vec3(0.0, 0.0, 2.0), { 400.0, 0.0, 0.0 }, { 0.0, 400.0, 0.0 }, Wall, 0);
  for (int i = 1; i <= 60; ++i)
  {
    const Vec3 half(random(2.0, 8.0), random(2.0, 8.0), random(3.0, 12.0));
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 center(side * random(20.0, 90.0), random(-150.0, 150.0), half.z - 2.0);
    result.scene.box(at + center, half, materials[i % 4], i);
  }
  for (int i = 0; i < 48; ++i)
  {
    double east = 0.0, north = 0.0;
    lanes::cosSinOfTurns(0.25 * (i / 12) + 0.004 * (i % 12), east, north);
    addBeam(result.beams, unitVector({ east, north, 0.03 * (i % 4) - 0.03 }), at);
  }
  return result;
}

/// A bumpy ball whose triangles are finer than the spacing of few rays, coarser than that of many.
Case ball()
{
  Case result{ "ball", {}, {}, 0.15 };
  *result.scene.mesh = geometrytest::closedSurface(
    5, [](const Vec3& p) { return 10.0 + 1.5 * p.x * p.y - p.z * p.z * p.x; });
  const Material materials[] = { Wall, Metal, Glass };
  for (std::uint32_t t = 0; t < result.scene.mesh->size(); ++t)
  {
    const Vec3 corner = result.scene.mesh->corner(t, 0);
    result.scene.objects.push_back((corner.x > 0.0) + 2 * (corner.y > 0.0));
    result.scene.materials.push_back(materials[result.scene.objects.back() % 3]);
  }
  Numbers random(8);
  for (int i = 0; i < 12; ++i)
  {
    const Vec3 from = 25.0 * unitVector(random.inCube(1.0));
    addBeam(result.beams, unitVector(random.inCube(7.0) - from), from);
  }
  return result;
}

/// A room of boxes and slivers about the lidar.
Case roomOf(unsigned seed)
{
  Numbers random(seed);
  Case result{ "room " + std::to_string(seed), room(seed), {}, 0.06 };
  for (int i = 0; i < 36; ++i)
  {
    addBeam(result.beams, unitVector(random.inCube(1.0)));
  }
  return result;
}

/// A wall of panes, whose sides are shared: beams lie on one, or on several.
Case panes()
{
  Numbers random(11);
  Case result{ "panes", {}, {}, 2e-2 };
  const Material materials[] = { Glass, Wall, Metal };
  constexpr int n = 10;
  Vec3 points[n + 1][n + 1];
  for (int i = 0; i <= n; ++i)
  {
    for (int j = 0; j <= n; ++j)
    {
      const double x = 2.0 * (i - n / 2) + random(-0.7, 0.7);
      points[i][j] = Vec3(x, 50.0 + 0.5 * x, 2.0 * (j - n / 2) + random(-0.7, 0.7));
    }
  }
  for (int i = 0; i < n; ++i)
  {
    for (int j = 0; j < n; ++j)
    {
      const Material& m = materials[random.index(3)];
      result.scene.triangle(points[i][j], points[i + 1][j], points[i + 1][j + 1], m, i);
      result.scene.triangle(points[i][j], points[i + 1][j + 1], points[i][j + 1], m, i);
    }
  }
  for (int i = 0; i < 40; ++i)
  {
    addBeam(result.beams, unitVector({ random(-6.0, 6.0), 50.0, random(-6.0, 6.0) }));
  }
  return result;
}

/// Whole numbers are compared as they are, the others with a tolerance where libm differs. NaN is
/// printed without its sign, which says nothing.
void printRow(std::initializer_list<long long> whole, std::initializer_list<double> real)
{
  for (long long value : whole)
  {
    std::printf("%lld ", value);
  }
  std::printf("|");
  for (double value : real)
  {
    std::printf(" %a", std::isnan(value) ? std::fabs(value) : value);
  }
  std::printf("\n");
}

/// FNV-1a of the bytes of elements without padding.
template <class T>
void include(std::uint64_t& hash, const std::vector<T>& elements)
{
  const auto* const bytes = reinterpret_cast<const unsigned char*>(elements.data());
  for (std::size_t i = 0; i < elements.size() * sizeof(T); ++i)
  {
    hash = (hash ^ bytes[i]) * 1099511628211u;
  }
}

/// Trees are the same numbers whatever libm does.
void printTrees(const Case& c)
{
  std::printf("section trees %s: hash\n", c.name.c_str());
  for (const TreeOptions& options : geometrytest::allTreeOptions({ 4 }))
  {
    const auto tree = buildVolumeTree(c.scene.mesh, options);
    const auto binary = volumesOf(*tree);
    std::uint64_t hash = 14695981039346656037u;
    include(hash, binary->nodes);
    include(hash, tree->order);
    std::visit([&](const auto& volumes) { include(hash, volumes); }, binary->volumes);
    include(hash, tree->wide.nodes);
    printRow({ static_cast<long long>(hash) }, {});
  }
}

void printHits(const Case& c, const CollisionTree& tree, std::size_t numberOfRays,
  std::size_t numberOfBeams, TraceMode mode)
{
  std::printf("section hits %s: triangle | range\n", c.name.c_str());
  const StrataPartition strata(numberOfRays);
  OneBeamTracer tracer(tree);
  BeamRays rays;
  std::vector<Hit> hits;
  for (std::size_t i = 0; i < c.beams.size(); i += c.beams.size() / numberOfBeams)
  {
    tracer.setBeam(makeBeamFrame(c.beams.origins[i], c.beams.directions[i], c.halfBeamwidth));
    sampleBeam(5, i, numberOfRays, { c.halfBeamwidth, BeamProfile::Uniform }, Sampling::Stratified,
      &strata, rays);
    tracer.trace(rays, mode, hits);
    for (const Hit& hit : hits)
    {
      printRow({ hit.triangle }, { hit.range });
    }
  }
}

void printEchoes(const Case& c, const Sensor& sensor, const EchoSettings& settings)
{
  const ScanResult result = runScan(makeSetup(c.scene, sensor, settings), c.beams);
  std::printf(
    "section echoes %s: beam return returns object material | range energyReceived energy "
    "returnEnergy energyStdError labelShare incidenceAngle secondaryShare\n",
    c.name.c_str());
  for (std::size_t i = 0; i < result.echoes.size(); ++i)
  {
    const Echo& e = result.echoes[i];
    printRow({ static_cast<long long>(result.beamOfEcho[i]), e.returnNumber, e.numberOfReturns,
               e.objectId, e.materialId },
      { e.range, e.energyReceived, e.energy, e.returnEnergy, e.energyStdError, e.labelShare,
        e.incidenceAngle, e.secondaryShare });
  }
  std::printf("section beams %s: status rays | range lost\n", c.name.c_str());
  for (const BeamReport& r : result.reports)
  {
    printRow({ static_cast<long long>(r.status), static_cast<long long>(r.counters.raysTraced) },
      { r.range, r.lost });
  }
}

/// Every loop of lighting and receiving: all models, profiles, samplings, noise with and without
/// alarms, pulses as short as nothing and longer than a range unit.
void printScans(const Case& c)
{
  Sensor sensor;
  sensor.halfBeamwidth = c.halfBeamwidth;
  sensor.lowerEnergyLimit = 2e-8;
  EchoSettings settings;
  settings.raysPerBeam = 3; // beams of so few rays are traced together
  printEchoes(c, sensor, settings);
  settings.raysPerBeam = 40;
  printEchoes(c, sensor, settings);

  sensor.beamProfile = BeamProfile::Gaussian;
  sensor.pulseWidth = 12e-9;
  sensor.noisePhotonRate = 1e19; // 11 nJ a unit, where 20 nJ are perceived
  settings.raysPerBeam = 16;
  settings.sampling = Sampling::MonteCarlo;
  settings.reflectanceModel = ReflectanceModel::Phong;
  settings.attenuationCoefficient = 2e-3;
  settings.lightEnergyConstraint = false;
  settings.returnMode = ReturnMode::RangeUnits;
  printEchoes(c, sensor, settings);

  sensor.pulseWidth = 0.0;
  sensor.noisePhotonRate = 1e9; // 5 photons a unit
  sensor.lowerEnergyLimit = 14.0 * sensor.photonEnergy();
  settings.raysPerBeam = 25;
  settings.sampling = Sampling::Stratified;
  settings.reflectanceModel = ReflectanceModel::Microfacet;
  settings.lightEnergyConstraint = true;
  settings.returnMode = ReturnMode::All;
  printEchoes(c, sensor, settings);
}

/// Planes that fill beams, of one surface and of several.
void printIntegrals()
{
  const Case c = panes();
  EchoSettings settings;
  settings.beamSamples = BeamSampleSource::Cells;
  for (const BeamProfile profile : { BeamProfile::Uniform, BeamProfile::Gaussian })
  {
    for (const ReflectanceModel model :
      { ReflectanceModel::LambertBlinnPhong, ReflectanceModel::Microfacet })
    {
      Sensor sensor;
      sensor.halfBeamwidth = c.halfBeamwidth;
      sensor.lowerEnergyLimit = 2e-8;
      sensor.samplingInterval = 1e-9;
      sensor.pulseWidth = 2e-9;
      sensor.beamProfile = profile;
      settings.reflectanceModel = model;
      printEchoes(c, sensor, settings);
    }
  }
}
}

int main()
{
  std::printf("%s\n", instructionSet());
  for (const Case& c : { street("street", Vec3(0.0)), street("far", Vec3(3.2e5, 4.1e6, 40.0)),
         ball(), roomOf(3), roomOf(8) })
  {
    printTrees(c);
    const auto tree = buildVolumeTree(c.scene.mesh, TreeOptions{});
    const auto unfolded = buildVolumeTree(
      c.scene.mesh, { SplitRule::SurfaceAreaHeuristic, BoundingVolumeType::OBB, 4 });
    printHits(c, *tree, 1, c.beams.size(), TraceMode::Automatic);
    printHits(c, *tree, 16, c.beams.size(), TraceMode::Automatic);
    printHits(c, *tree, 16, c.beams.size(), TraceMode::SingleRays);
    printHits(c, *unfolded, 16, 12, TraceMode::Automatic);
    printHits(c, *tree, 100, 12, TraceMode::Automatic);
    printHits(c, *tree, 1000, 3, TraceMode::Automatic);
    printScans(c);
  }
  printIntegrals();
}
