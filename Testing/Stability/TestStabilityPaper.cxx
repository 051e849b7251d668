// SPDX-License-Identifier: BSD-3-Clause
// Preset Paper at the extremes: two boxes a node, independent rays, one descent per beam, both
// constraints, a point for each range unit.
#include "GeometryTestScene.h"
#include "ScanTestTown.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using avianlidar::OneBeamTracer;
using stability::record;
using stability::Worst;

namespace
{
constexpr TreeOptions PaperTree{ SplitRule::Median, BoundingVolumeType::BinaryAABB, 1 };
constexpr LightEnergyThreshold Readings[] = { LightEnergyThreshold::Limit,
  LightEnergyThreshold::LimitPerRay };

EchoSettings paper(LightEnergyThreshold threshold)
{
  EchoSettings settings;
  settings.beamSamples = BeamSampleSource::Rays;
  settings.sampling = Sampling::MonteCarlo;
  settings.returnMode = ReturnMode::RangeUnits;
  settings.traceMode = TraceMode::Beams;
  settings.lightEnergyThreshold = threshold;
  return settings;
}

/// A corner of a metal and a matt wall, 100 m away: mirror paths and connections.
Scene corner()
{
  Scene scene;
  for (const int side : { -1, 1 })
  {
    const Vec3 along = 10.0 * Vec3(-1.0, side, 0.0);
    scene.plate(
      Vec3(100.0, 0.0, 0.0) + along, along, Vec3(0.0, 0.0, 20.0), side > 0 ? Metal : Wall, side);
  }
  return scene;
}

Sensor intoTheCorner()
{
  Sensor sensor;
  sensor.halfBeamwidth = 0.05;
  sensor.lowerEnergyLimit = 1e-8;
  return sensor;
}

double secondEnergy(const ScanResult& result)
{
  double sum = 0.0;
  for (const Echo& echo : result.echoes)
  {
    sum += echo.energyReceived * echo.secondaryShare;
  }
  return sum;
}
}

TEST(StabilityPaper, HitsAreThoseOfBruteForce)
{
  using namespace geometrytest;
  Numbers random(701);
  std::size_t wrong = 0;
  std::size_t compared = 0;
  for (int round = 0; round < 24; ++round)
  {
    // Up to 1e8 m from the origin; triangles of many sizes, some of them needles.
    const Vec3 apex = std::pow(10.0, round % 12 - 3) * random.direction();
    TriangleMesh mesh;
    for (int i = 0; i < 150; ++i)
    {
      const double size = random.logUniform(1e-2, 1e3);
      const Vec3 middle = apex + 3.0 * size * random.direction();
      const Vec3 a = middle + random.inCube(size);
      const Vec3 b = middle + random.inCube(size);
      addTriangle(
        mesh, a, b, i % 3 ? middle + random.inCube(size) : b + 1e-6 * size * random.direction());
    }
    const auto shared = std::make_shared<TriangleMesh>(mesh);
    const auto tree = buildVolumeTree(shared, PaperTree);
    OneBeamTracer tracer(*tree);
    for (const double width : { 1e-6, 1e-4, 5.6e-3, 0.1, 1.0 })
    {
      const BeamFrame frame = avianlidar::makeBeamFrame(apex, random.direction(), width);
      const BeamRays rays = raysInDisc(random, 40);
      tracer.setBeam(frame);
      std::vector<Hit> hits;
      tracer.trace(rays, TraceMode::Beams, hits);
      for (std::size_t i = 0; i < rays.size(); ++i)
      {
        const OracleHit oracle =
          bruteForce(mesh, apex, rayDirection(frame, rays.x[i], rays.y[i]), 32.0L * 0x1p-53L);
        compared += !oracle.nearEdge;
        wrong += !oracle.nearEdge && hits[i].valid() != (oracle.triangle != avianlidar::NoTriangle);
      }
    }
  }
  ASSERT_GT(compared, 4000u);
  record(
    { "Preset Paper: coordinates", "1e-3 to 1e8 m from the origin, sizes 1e-2 to 1e3 m, needles",
      "paper", "hits unlike brute force in long double", 0.0, static_cast<double>(wrong) });
}

TEST(StabilityPaper, PowersOfTwoKeepBits)
{
  const ScanBeams beams = horizon(90, 4);
  const Scene scene = town();
  std::size_t differing = 0;
  std::size_t echoes = 0;
  for (const LightEnergyThreshold threshold : Readings)
  {
    EchoSettings settings = paper(threshold);
    settings.noise = false;
    settings.attenuationCoefficient = 0.0;
    const ScanResult plain = runScan(makeSetup(scene, Sensor(), settings, PaperTree), beams);
    echoes += plain.echoes.size();
    for (const int exponent : { -20, -10, -1, 1, 10, 20 })
    {
      const double factor = std::ldexp(1.0, exponent);
      Sensor sensor;
      for (double* const length : { &sensor.samplingInterval, &sensor.pulseWidth, &sensor.rangeGate,
             &sensor.pulseEnergy, &sensor.lowerEnergyLimit, &sensor.upperEnergyLimit })
      {
        *length *= factor;
      }
      const ScanResult result =
        runScan(makeSetup(scaled(scene, factor), sensor, settings, PaperTree), beams);
      differing += plain.echoes.size() != result.echoes.size();
      for (std::size_t i = 0; i < std::min(plain.echoes.size(), result.echoes.size()); ++i)
      {
        const Echo& a = plain.echoes[i];
        const Echo& b = result.echoes[i];
        differing += !(a.range * factor == b.range && a.returnEnergy * factor == b.returnEnergy);
      }
    }
  }
  ASSERT_GT(echoes, 100u);
  record({ "Preset Paper: scale", "scene, pulse, gate and energies times 2^-20 to 2^20", "paper",
    "echoes that change other than by the power of two", 0.0, static_cast<double>(differing) });
}

TEST(StabilityPaper, ThresholdsOfAnySize)
{
  // A threshold drops what is below it, so light only grows as the limit falls; with a limit of 0
  // all of it is there.
  Worst gained;
  std::size_t unlike = 0;
  for (const LightEnergyThreshold threshold : Readings)
  {
    for (const int rays : { 1, 2, 100, 10000 })
    {
      EchoSettings settings = paper(threshold);
      settings.noise = false;
      settings.raysPerBeam = rays;
      Sensor sensor = intoTheCorner();
      sensor.lowerEnergyLimit = 0.0;
      EchoSettings without = settings;
      without.lightEnergyConstraint = false;
      const ScanResult all = runScan(makeSetup(corner(), sensor, without, PaperTree), oneBeam());
      unlike +=
        differingEchoes(all, runScan(makeSetup(corner(), sensor, settings, PaperTree), oneBeam()));
      double before = secondEnergy(all);
      ASSERT_TRUE(before > 0.0 || rays < 100);
      for (double limit = 1e-40; limit < 1e-3; limit *= 10.0)
      {
        sensor.lowerEnergyLimit = limit;
        const double now =
          secondEnergy(runScan(makeSetup(corner(), sensor, settings, PaperTree), oneBeam()));
        gained.see(now - before * (1.0 + 1e-12));
        before = now;
      }
    }
  }
  record({ "Preset Paper: threshold", "1 to 10,000 rays, limits Qlow and Qlow/N, Qlow = 0", "paper",
    "echoes unlike those without the light-energy constraint", 0.0, static_cast<double>(unlike) });
  record({ "Preset Paper: threshold", "1 to 10,000 rays, limits Qlow and Qlow/N, Qlow to 1e-3 J",
    "paper", "energy after two reflections gained as the limit rises, J", 0.0, gained.value() });
}

TEST(StabilityPaper, EnergiesOfAnyBeamwidthAndDistance)
{
  Worst deviation;
  for (const double t : { 1e-9, 1e-6, 5.6e-3, 0.1, 0.9 })
  {
    for (const double distance : { 1e-3, 1.0, 1e3, 1e6 })
    {
      Scene scene;
      scene.plate(Vec3(distance, 0.0, 0.0), Vec3(0.0, 1e3 * distance, 0.0),
        Vec3(0.0, 0.0, 1e3 * distance), { 0.146, 0.0, 0.0 });
      EchoSettings settings = paper(LightEnergyThreshold::LimitPerRay);
      settings.noise = false;
      settings.attenuationCoefficient = 0.0;
      Sensor sensor = openSensor(t);
      sensor.samplingInterval = 4.0 * distance; // all in one range unit
      sensor.pulseWidth = 0.0;
      sensor.rangeGate = 1e9 * distance;
      const ScanResult result = runScan(makeSetup(scene, sensor, settings, PaperTree), oneBeam());
      ASSERT_EQ(result.echoes.size(), 1u);
      const double half = std::sin(0.5 * t);
      const double right = 3.6e-4 * 0.146 * (1.0 - half * half);
      const Echo& echo = result.echoes[0];
      deviation.see(std::fabs(echo.energyReceived - right) / (echo.energyStdError + 1e-12 * right));
    }
  }
  record({ "Preset Paper: half-beamwidth", "1e-9 to 0.9 rad, wall at 1e-3 to 1e6 m, 100 rays",
    "paper", "deviation from the closed form, in stated standard errors", 5.0, deviation.value() });
}
