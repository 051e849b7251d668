// SPDX-License-Identifier: BSD-3-Clause
// The same scene scaled and turned. Moved ones are TestScan's, hits of triangles of any size and
// place TestBeamTracer's and TestGeometryProperties'.
#include "GeometryTestScene.h"
#include "ScanTestTown.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using geometrytest::Numbers;
using stability::record;
using stability::Worst;

TEST(StabilityCoordinates, SceneScaledByPowersOfTwoKeepsItsBits)
{
  EchoSettings settings = usual();
  settings.attenuationCoefficient = 0.0;
  settings.noise = false;
  const ScanBeams beams = horizon(90, 4);
  const Scene scene = town();
  std::size_t differing = 0;
  for (const bool integrated : { true, false })
  {
    settings.beamSamples = integrated ? BeamSampleSource::Cells : BeamSampleSource::Rays;
    const ScanResult plain = runScan(makeSetup(scene, Sensor(), settings), beams);
    ASSERT_GT(plain.echoes.size(), 50u);
    for (const int exponent : { -30, -20, -10, -1, 1, 10, 20 })
    {
      const double factor = std::ldexp(1.0, exponent);
      Scene scaled = scene;
      scaled.mesh = std::make_shared<TriangleMesh>(*scene.mesh);
      for (Vec3& p : scaled.mesh->points)
      {
        p *= factor;
      }
      Sensor sensor;
      sensor.samplingInterval *= factor;
      sensor.pulseWidth *= factor;
      sensor.rangeGate *= factor;
      const ScanResult result = runScan(makeSetup(scaled, sensor, settings), beams);
      differing += plain.echoes.size() != result.echoes.size();
      for (std::size_t i = 0; i < std::min(plain.echoes.size(), result.echoes.size()); ++i)
      {
        differing += !(sameBits(plain.echoes[i].range * factor, result.echoes[i].range) &&
          sameBits(plain.echoes[i].returnEnergy, result.echoes[i].returnEnergy));
      }
    }
  }
  record({ "Scale", "scene, pulse and gate times 2^-30 to 2^20",
    "echoes whose scaled range or whose energy changes by a bit", 0.0,
    static_cast<double>(differing) });
}

TEST(StabilityCoordinates, SceneTurnedKeepsRangesAndEnergies)
{
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
  record({ "Rotation", "400 random ones, plates at 1e-3 to 1e5 m, tilted up to 89 deg",
    "relative error of range times cos(incidence), half-beamwidth 1e-9 rad", 2e-9, range.value() });
  record({ "Rotation", "400 random ones, plates at 1e-3 to 1e5 m, tilted up to 89 deg",
    "relative error of energy times cos(incidence), half-beamwidth 1e-9 rad", 2e-9,
    energy.value() });
}
