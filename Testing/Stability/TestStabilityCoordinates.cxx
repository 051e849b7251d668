// SPDX-License-Identifier: BSD-3-Clause
// Coordinates and sizes: far from the origin, near it, large and small triangles in one scene,
// needles; the same scene moved, scaled and turned.
#include "CollisionTreeBuilder.h"
#include "HitComparison.h"
#include "ScanTestTown.h"
#include "StabilityScenes.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace stability;
using namespace geometrytest;
using echotest::Degree;

namespace
{
/// Bound of a range's error in units of RangeUnit(): the tracer's own statement is "a few".
constexpr double RangeBar = 32.0;

/// Beams through the default tree and that of the preset Paper.
void compareBeams(
  const TriangleMesh& triangles, const Vec3& apex, Numbers& random, int beams, HitComparison& sum)
{
  const auto mesh = std::make_shared<TriangleMesh>(triangles);
  compareBeams({ buildCollisionTree(mesh, TreeOptions()), buildVolumeTree(mesh, PaperTree) }, apex,
    random, beams, 20, sum);
}

/// The rows that every comparison gives.
void recordComparison(
  const std::string& extreme, const std::string& range, const HitComparison& sum)
{
  record({ extreme, range, "rays",
    "hits unlike brute force in long double, or unlike one descent per ray, of " +
      std::to_string(sum.compared) + " rays",
    0.0, static_cast<double>(sum.wrong + sum.otherBits[0]) });
  record({ extreme, range, "rays",
    "error of range, in 2^-53 times the triangle's farthest corner / cos(incidence)", RangeBar,
    sum.rangeError });
}

Vec3 farAway(double distance)
{
  return distance * glm::normalize(Vec3(0.6, -0.5, 0.62));
}

TriangleMesh moved(TriangleMesh mesh, const Vec3& offset)
{
  for (Vec3& p : mesh.points)
  {
    p += offset;
  }
  return mesh;
}

/// Scenes, pulses and energies that are multiplied by powers of two.
struct Scaling
{
  Row row; ///< receives the number of echoes that change by a bit but for the power of two
  echotest::Scene scene;
  avianlidar::ScanBeams beams;
  avianlidar::Sensor sensor;
  std::vector<avianlidar::EchoSettings> settings;
  TreeOptions tree;
  std::vector<int> exponents;
  bool ofLengths, ofEnergies; ///< what is multiplied
};

/// Number of echoes whose bits are not those of the plain ones times the factors.
std::size_t echoesNotScaled(const avianlidar::ScanResult& plain,
  const avianlidar::ScanResult& result, double lengths, double energies)
{
  std::size_t differing = result.echoes.size() != plain.echoes.size();
  for (std::size_t i = 0; i < std::min(result.echoes.size(), plain.echoes.size()); ++i)
  {
    const avianlidar::Echo& a = plain.echoes[i];
    const avianlidar::Echo& b = result.echoes[i];
    differing +=
      !(a.energy * energies == b.energy && a.energyReceived * energies == b.energyReceived &&
        a.returnEnergy * energies == b.returnEnergy && a.range * lengths == b.range &&
        a.energyStdError * energies == b.energyStdError && a.secondaryShare == b.secondaryShare);
  }
  return differing;
}
}

TEST(StabilityCoordinates, HitsAreThoseOfBruteForce)
{
  Numbers random(101);
  HitComparison far;
  for (int decade = -3; decade <= 8; ++decade)
  {
    const Vec3 apex = farAway(std::pow(10.0, decade));
    compareBeams(moved(randomTriangles(random, 200, 100.0, 20.0), apex), apex, random, 25, far);
  }
  recordComparison("Coordinates", "scene of 200 m, 1e-3 to 1e8 m from the origin", far);
  HitComparison tiny;
  for (const double distance : { 0.0, 1e-3, 1.0, 1e3, 1e6 })
  {
    const Vec3 apex = farAway(distance); // a millimetre across, seen from its middle
    compareBeams(moved(randomTriangles(random, 200, 1e-3, 1e-6), apex), apex, random, 40, tiny);
  }
  recordComparison("Coordinates", "triangles of 1e-6 m, up to 1e6 m from the origin", tiny);
  HitComparison sizes;
  HitComparison needles;
  for (int round = 0; round < 4; ++round)
  {
    TriangleMesh mixed;
    TriangleMesh thin;
    for (int i = 0; i < 200; ++i)
    {
      const double size = random.logUniform(1e-6, 1e5);
      const Vec3 center = 3.0 * size * random.direction() * (1.0 + random());
      const Vec3 a = center + random.inCube(size);
      const Vec3 b = center + random.inCube(size);
      addTriangle(mixed, a, b, center + random.inCube(size));
      // Needles (third corner beside an end) and flat ones (beside the middle).
      const double length = random.logUniform(0.1, 100.0);
      const Vec3 from = random.inCube(50.0);
      const Vec3 along = length * random.direction();
      const Vec3 aside = glm::normalize(glm::cross(along, random.direction()));
      const Vec3 foot = from + (i % 2 ? 1.0 : random()) * along;
      addTriangle(thin, from, from + along, foot + length / random.logUniform(1.0, 1e8) * aside);
    }
    compareBeams(mixed, Vec3(0.0), random, 60, sizes);
    compareBeams(thin, Vec3(0.0), random, 60, needles);
  }
  recordComparison("Sizes", "triangles of 1e-6 to 1e5 m in one scene", sizes);
  recordComparison("Aspect ratio", "1 to 1e8, needles and flat ones", needles);
  record(
    { "Preset Paper: coordinates", "1e-3 to 1e8 m from the origin, sizes 1e-6 to 1e5 m, needles",
      "paper", "hits unlike brute force in long double", 0.0,
      static_cast<double>(
        far.otherBits[1] + tiny.otherBits[1] + sizes.otherBits[1] + needles.otherBits[1]) });
  for (const HitComparison* sum : { &far, &tiny, &sizes, &needles })
  {
    EXPECT_GT(sum->hits, 400u);
    EXPECT_LT(sum->undecided, sum->compared / 50);
  }
}

TEST(StabilityCoordinates, SceneMovedByWhatRoundsNothingKeepsItsBits)
{
  using namespace echotest;
  const double grid = 0x1p-20;
  const ScanBeams beams = horizon(90, 4);
  const ScanResult here = runScan(makeSetup(town(Vec3(0.0), grid), Sensor(), usual()), beams);
  ASSERT_GT(here.echoes.size(), 50u);
  std::size_t differing = 0;
  for (const double distance : { 0x1p-10, 1.0, 1e3, 1e6, 1e7, 1e8 })
  {
    const Vec3 at(distance, -distance, distance);
    const ScanResult there =
      runScan(makeSetup(town(at, grid), Sensor(), usual()), horizon(90, 4, at));
    differing += differingEchoes(here, there);
  }
  record({ "Coordinates", "scene moved by 1e-3 to 1e8 m along each axis, double points", "default",
    "echoes that change by a bit", 0.0, static_cast<double>(differing) });
}

TEST(StabilityCoordinates, PowersOfTwoKeepBits)
{
  using namespace echotest;
  std::vector<EchoSettings> ways(2, usual());
  for (std::size_t i = 0; i < 2; ++i)
  {
    ways[i].beamSamples = BothSources[i];
    ways[i].attenuationCoefficient = 0.0;
    ways[i].noise = false;
  }
  std::vector<EchoSettings> papers = { paper(Readings[0]), paper(Readings[1]) };
  papers[0].attenuationCoefficient = papers[1].attenuationCoefficient = 0.0;
  std::vector<int> ofEnergies;
  for (int exponent = -88; exponent <= 22; exponent += 5)
  {
    ofEnergies.push_back(exponent);
  }
  const Scaling scalings[] = {
    { { "Energies", "pulse and limits times 2^-88 to 2^22 (1e-30 to 1.5e3 J), two reflections",
        "both", "echoes that change by a bit but for the power of two", 0.0, 0.0 },
      corner(), oneBeam(), intoTheCorner(), ways, {}, ofEnergies, false, true },
    { { "Scale", "scene, pulse and gate times 2^-30 to 2^20", "both",
        "echoes whose scaled range or whose energy changes by a bit", 0.0, 0.0 },
      town(), horizon(90, 4), Sensor(), ways, {}, { -30, -20, -10, -1, 1, 10, 20 }, true, false },
    { { "Preset Paper: scale", "scene, pulse, gate and energies times 2^-20 to 2^20", "paper",
        "echoes that change other than by the power of two", 0.0, 0.0 },
      town(), horizon(90, 4), Sensor(), papers, PaperTree, { -20, -10, -1, 1, 10, 20 }, true, true }
  };
  for (const Scaling& of : scalings)
  {
    Row row = of.row;
    for (const EchoSettings& settings : of.settings)
    {
      const ScanResult plain = runScan(makeSetup(of.scene, of.sensor, settings, of.tree), of.beams);
      ASSERT_GE(plain.echoes.size(), of.ofLengths ? 50u : 1u);
      ASSERT_TRUE(of.ofLengths || plain.echoes[0].secondaryShare > 0.0);
      for (const int exponent : of.exponents)
      {
        const double lengths = std::ldexp(1.0, of.ofLengths ? exponent : 0);
        const double energies = std::ldexp(1.0, of.ofEnergies ? exponent : 0);
        Sensor sensor = of.sensor;
        sensor.samplingInterval *= lengths;
        sensor.pulseWidth *= lengths;
        sensor.rangeGate *= lengths;
        sensor.pulseEnergy *= energies;
        sensor.lowerEnergyLimit *= energies;
        sensor.upperEnergyLimit *= energies;
        const Scene scene = changed(of.scene, [=](const Vec3& p) { return lengths * p; });
        row.worst += static_cast<double>(echoesNotScaled(plain,
          runScan(makeSetup(scene, sensor, settings, of.tree), of.beams), lengths, energies));
      }
    }
    record(row);
  }
}

TEST(StabilityCoordinates, SceneTurnedKeepsRangesAndEnergies)
{
  using namespace echotest;
  Numbers random(106);
  Worst range;
  Worst energy;
  for (int round = 0; round < 400; ++round)
  {
    // A beam that is a line, on a plate that fills it.
    const double tilt = random(0.0, 89.0 * Degree);
    const double distance = random.logUniform(1e-3, 1e5);
    const Vec3 normal(std::cos(tilt), std::sin(tilt), 0.0);
    const Vec3 along(-std::sin(tilt), std::cos(tilt), 0.0);
    const BeamFrame turn = avianlidar::makeBeamFrame(Vec3(0.0), random.direction(), 0.1);
    const auto turned = [&](const Vec3& v)
    { return v.x * turn.axis + v.y * turn.e1 + v.z * turn.e2; };
    Scene scene;
    scene.plate(turned(Vec3(distance, 0.0, 0.0)), turned(0.3 * distance * along),
      turned(Vec3(0.0, 0.0, 0.3 * distance)), { 0.146, 0.0, 0.0 });
    const Echo echo =
      onlyEcho(scene, openSensor(1e-9), directSettings(2), turned(Vec3(1.0, 0.0, 0.0)));
    range.see(std::fabs(echo.range / distance - 1.0) * std::cos(tilt));
    energy.see(
      std::fabs(echo.returnEnergy / (3.6e-4 * 0.146 * std::cos(tilt)) - 1.0) * std::cos(tilt));
  }
  record({ "Rotation", "400 random ones, plates at 1e-3 to 1e5 m, tilted up to 89 deg", "rays",
    "relative error of range times cos(incidence), half-beamwidth 1e-9 rad", 2e-9, range.value() });
  record({ "Rotation", "400 random ones, plates at 1e-3 to 1e5 m, tilted up to 89 deg", "rays",
    "relative error of energy times cos(incidence), half-beamwidth 1e-9 rad", 2e-9,
    energy.value() });
}
