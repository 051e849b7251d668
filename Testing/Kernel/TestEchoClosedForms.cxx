// SPDX-License-Identifier: BSD-3-Clause
// Received energies against closed forms (values by 30-digit quadrature): plane, glint, sphere, cut
// footprint, corner, waveform of a grazing ground plane, Gaussian profile.
#include "IntegrationTestScene.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

using namespace echotest;

namespace
{
constexpr int Rays = 100000;

/// Plane whose normal makes the angle `tilt` with the axis x, at perpendicular distance `distance`.
Scene plane(double distance, double tilt, const Material& m, double size = 0.0)
{
  const Vec3 normal(std::cos(tilt), std::sin(tilt), 0.0);
  const Vec3 along(-std::sin(tilt), std::cos(tilt), 0.0);
  const double reach = size > 0.0 ? size : 1e3 * distance;
  Scene scene;
  scene.plate(distance * normal, reach * along, Vec3(0.0, 0.0, reach), m);
  return scene;
}

/// Within five stated standard errors of the closed form, and these are no excuse.
void expectEnergy(const Echo& echo, double expected, double largestStdError)
{
  EXPECT_LE(echo.energyStdError, largestStdError * expected);
  EXPECT_NEAR(echo.returnEnergy, expected, 5.0 * echo.energyStdError + 1e-9 * expected);
}

/// By rays as above. Integrated to a millionth, and to the bound that is stated (the oracles have
/// ten digits).
void expectEnergy(const Scene& scene, const Sensor& sensor, double expected, double largestStdError,
  double attenuation = 0.0)
{
  EchoSettings settings = directSettings(Rays);
  settings.attenuationCoefficient = attenuation;
  expectEnergy(onlyEcho(scene, sensor, settings), expected, largestStdError);
  settings = integrating();
  settings.attenuationCoefficient = attenuation;
  const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
  ASSERT_TRUE(isIntegrated(result));
  ASSERT_EQ(result.echoes.size(), 1u);
  const Echo& echo = result.echoes[0];
  EXPECT_NEAR(echo.returnEnergy, expected, 1e-6 * expected);
  EXPECT_NEAR(echo.returnEnergy, expected, echo.energyStdError + 2e-9 * expected);
  EXPECT_LE(echo.energyStdError, 1e-5 * expected);
  EXPECT_EQ(echo.labelShare, 1.0);
}

Material diffuse(double kd)
{
  return { kd, 0.0, 0.0 };
}
}

TEST(EchoClosedForms, PlaneAtNormalIncidenceForBeamwidthsFrom1e9ToOneRadian)
{
  const std::map<double, double> cases = { { 1e-9, 5.256e-5 }, { 1e-4, 5.255999987e-5 },
    { 5.6e-3, 5.255958793e-5 }, { 0.1, 5.242870946e-5 }, { 0.5, 4.934286973e-5 },
    { 1.0, 4.047914460e-5 } };
  for (const auto& [t, energy] : cases)
  {
    for (double h : { 1.0, 500.0 })
    {
      // The strata leave so little to chance that the value by rays is exact to a millionth.
      const Scene scene = plane(h, 0.0, diffuse(0.146));
      expectEnergy(scene, openSensor(t), energy, t <= 0.1 ? 2e-7 : 1e-4);
    }
  }
}

TEST(EchoClosedForms, PlaneWithSpecularLobeAndAttenuation)
{
  const std::tuple<Material, double, double> cases[] = { { Wall, 5.6e-3, 6.945739522e-5 },
    { Wall, 0.1, 5.809126810e-5 }, { Glass, 5.6e-3, 2.395239383e-4 },
    { diffuse(0.146), 5.6e-3, 5.075180886e-5 } };
  for (const auto& [material, t, energy] : cases)
  {
    expectEnergy(plane(500.0, 0.0, material), openSensor(t), energy, 1e-3, 3.5e-5);
  }
}

TEST(EchoClosedForms, GlintNarrowerThanTheBeam)
{
  const Material mirror{ 0.0, 0.852, 1e6 };
  expectEnergy(plane(500.0, 0.0, mirror), openSensor(), 4.890315235e-6, 0.02);
}

TEST(EchoClosedForms, ObliquePlane)
{
  const std::tuple<double, double, double> cases[] = { { 60.0, 5.6e-3, 2.627979397e-5 },
    { 80.0, 5.6e-3, 9.126876663e-6 }, { 60.0, 0.1, 2.621435473e-5 } };
  for (const auto& [alpha, t, energy] : cases)
  {
    const Scene scene = plane(10.0, alpha * Degree, diffuse(0.146));
    expectEnergy(scene, openSensor(t), energy, 1e-3);
    const Echo echo = onlyEcho(scene, openSensor(t), directSettings(Rays));
    EXPECT_NEAR(echo.incidenceAngle / Degree, alpha, 3.0 * t);
  }
}

TEST(EchoClosedForms, ObliquePlaneSpecularAlone)
{
  const std::tuple<Material, double, double> cases[] = {
    { { 0.0, 0.054, 112.0 }, 2.0, 1.475545869e-5 }, { { 0.0, 0.852, 8046.0 }, 0.3, 1.713101409e-4 },
    { { 0.0, 0.852, 8046.0 }, 0.6, 6.063547230e-5 }
  };
  for (const auto& [material, alpha, energy] : cases)
  {
    expectEnergy(plane(10.0, alpha * Degree, material), openSensor(), energy, 0.01);
  }
}

TEST(EchoClosedForms, MeanRangeOnAGrazingPlaneLiesOnTheAxis)
{
  const Scene scene = plane(3.0, 89.0 * Degree, diffuse(0.146));
  EXPECT_NEAR(onlyEcho(scene, openSensor(), directSettings(Rays)).range, 171.8974132, 171.9 * 1e-5);
  EXPECT_NEAR(onlyEcho(scene, openSensor(), integrating()).range, 171.8974132, 1e-7);
  // The axis itself, by the same geometry: all but no beam about it. The mean is 1/((1 + cos t)/2)
  // of that.
  const Echo axis = onlyEcho(scene, openSensor(1e-9), directSettings(2));
  EXPECT_NEAR(axis.range, 171.8960655, 1e-5);
  EXPECT_NEAR(171.8974132 * std::pow(std::cos(2.8e-3), 2), 171.8960655, 1e-7);
}

namespace
{
/// Latitude-longitude sphere about (distance, 0, 0) with its poles on the axis x.
Scene sphere(double radius, double distance, int rings, int sectors)
{
  Scene scene;
  TriangleMesh& mesh = *scene.mesh;
  for (int i = 0; i <= rings; ++i)
  {
    const double theta = Pi * i / rings;
    for (int j = 0; j < sectors; ++j)
    {
      const double phi = 2.0 * Pi * j / sectors;
      mesh.points.push_back(Vec3(distance, 0.0, 0.0) +
        radius *
          Vec3(-std::cos(theta), std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi)));
    }
  }
  const auto at = [sectors](int i, int j)
  { return static_cast<std::uint32_t>(i * sectors + j % sectors); };
  for (int i = 0; i < rings; ++i)
  {
    for (int j = 0; j < sectors; ++j)
    {
      mesh.triangles.push_back({ at(i, j), at(i + 1, j), at(i + 1, j + 1) });
      mesh.triangles.push_back({ at(i, j), at(i + 1, j + 1), at(i, j + 1) });
    }
  }
  scene.materials.assign(mesh.size(), diffuse(0.146));
  scene.objects.assign(mesh.size(), 0);
  return scene;
}
}

TEST(EchoClosedForms, Sphere)
{
  const std::tuple<double, double, double, double> cases[] = {
    { 5.0, 1000.0, 5.6e-3, 2.793388614e-5 }, { 10.0, 1000.0, 5.6e-3, 4.819374383e-5 },
    { 50.0, 30.0, 5.6e-3, 5.255985166e-5 }, { 50.0, 30.0, 1.0, 4.869371082e-5 }
  };
  for (const auto& [radius, distance, t, energy] : cases)
  {
    const Scene scene = sphere(radius, distance, 400, 400);
    const Echo echo = onlyEcho(scene, openSensor(t), directSettings(Rays));
    EXPECT_LE(echo.energyStdError, 2e-3 * energy);
    // 400 facets around: their chords cost (2 pi/400)^2/24 at most, beside the sampling error.
    EXPECT_NEAR(echo.returnEnergy, energy, 5.0 * echo.energyStdError + 5e-5 * energy) << radius;
  }
}

TEST(EchoClosedForms, FootprintCutByAStraightEdge)
{
  const std::pair<double, double> cases[] = { { 0.0, 2.627979397e-5 }, { 2e-3, 1.458876452e-5 },
    { 5e-3, 1.088415956e-6 } };
  for (const auto& [epsilon, energy] : cases)
  {
    Scene scene;
    const double edge = 100.0 * std::tan(epsilon);
    scene.plate(
      Vec3(100.0, edge + 50.0, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), diffuse(0.146));
    expectEnergy(onlyEcho(scene, openSensor(), directSettings(Rays)), energy, 0.01);
  }
}

TEST(EchoClosedForms, MonteCarloErrorOfAHalfCoveredFootprint)
{
  Scene scene;
  scene.plate(Vec3(100.0, 50.0, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), diffuse(0.146));
  EchoSettings settings = directSettings(100);
  settings.sampling = Sampling::MonteCarlo;
  double sum = 0.0;
  double squares = 0.0;
  double stated = 0.0;
  constexpr int seeds = 4000;
  for (int seed = 0; seed < seeds; ++seed)
  {
    settings.seed = seed;
    const Echo echo = onlyEcho(scene, openSensor(), settings);
    sum += echo.returnEnergy;
    squares += echo.returnEnergy * echo.returnEnergy;
    stated += echo.energyStdError;
  }
  const double mean = sum / seeds;
  const double deviation = std::sqrt(squares / seeds - mean * mean);
  const double exact = 3.6e-4 * 0.146 * 0.05;
  EXPECT_NEAR(mean, 2.627979397e-5, 4.0 * exact / std::sqrt(seeds));
  EXPECT_NEAR(deviation, exact, 0.05 * exact);
  EXPECT_NEAR(stated / seeds, exact, 0.05 * exact);
}

TEST(EchoClosedForms, DihedralCornerConcaveAndConvex)
{
  const std::pair<double, double> cases[] = { { 1.0, 3.725357255e-5 }, { -1.0, 3.707690953e-5 } };
  for (const auto& [open, energy] : cases)
  {
    // Plates x = 100 -+ |y|: the edge is farthest (concave) or nearest (convex).
    Scene scene;
    for (int side : { -1, 1 })
    {
      const Vec3 along = 10.0 * Vec3(-open, side, 0.0);
      scene.plate(Vec3(100.0, 0.0, 0.0) + along, along, Vec3(0.0, 0.0, 20.0), diffuse(0.146), side);
    }
    expectEnergy(onlyEcho(scene, openSensor(), directSettings(Rays)), energy, 1e-3);
  }
}

namespace
{
/// Energies by range unit of the ground seen from 3 m at an axis `depression` below the horizon.
std::map<std::int64_t, Echo> groundWaveform(
  double depression, double pulseWidth, double attenuation)
{
  Scene scene;
  scene.plate(Vec3(0.0, 0.0, -3.0), Vec3(2e5, 0.0, 0.0), Vec3(0.0, 2e5, 0.0), diffuse(0.146));
  Sensor sensor = openSensor();
  sensor.samplingInterval = 5e-9;
  sensor.pulseWidth = pulseWidth;
  EchoSettings settings = directSettings(1000000);
  settings.attenuationCoefficient = attenuation;
  settings.returnMode = ReturnMode::RangeUnits;
  const ScanResult result = runScan(makeSetup(scene, sensor, settings),
    oneBeam({ std::cos(depression), 0.0, -std::sin(depression) }));
  std::map<std::int64_t, Echo> units;
  for (const Echo& echo : result.echoes)
  {
    units[static_cast<std::int64_t>(std::floor(echo.range / sensor.rangeUnitLength()))] = echo;
  }
  return units;
}
}

TEST(EchoClosedForms, WaveformOfAGrazingGroundPlane)
{
  const auto units = groundWaveform(1.0 * Degree, 0.0, 0.0);
  const std::pair<int, double> cases[] = { { 173, 5.549252487e-10 }, { 174, 3.538478918e-9 },
    { 190, 1.069046563e-8 }, { 194, 1.079361529e-8 }, { 200, 1.061714625e-8 },
    { 250, 5.876652661e-9 }, { 300, 2.381221932e-9 }, { 337, 1.092043096e-10 } };
  for (const auto& [m, energy] : cases)
  {
    const Echo& echo = units.at(m);
    EXPECT_LE(echo.energyStdError, 0.1 * energy) << m;
    EXPECT_NEAR(echo.energyReceived, energy, 5.0 * echo.energyStdError) << m;
  }
  EXPECT_EQ(units.begin()->first, 173);
  EXPECT_EQ(units.rbegin()->first, 337);
  double total = 0.0;
  for (const auto& unit : units)
  {
    total += unit.second.energyReceived;
  }
  EXPECT_NEAR(total, 9.172912907e-7, 1e-4 * total);
}

TEST(EchoClosedForms, EndsOfTheWaveformOfAGrazingGroundPlane)
{
  // h / sin(depression +- t): beams of no width along the two rims, and a wide one in between.
  Scene scene;
  scene.plate(Vec3(0.0, 0.0, -3.0), Vec3(2e5, 0.0, 0.0), Vec3(0.0, 2e5, 0.0), diffuse(0.146));
  const auto range = [&](double depression)
  {
    return onlyEcho(scene, openSensor(1e-9), directSettings(2),
      { std::cos(depression), 0.0, -std::sin(depression) })
      .range;
  };
  EXPECT_NEAR(range(1.0 * Degree + 5.6e-3), 130.1447826, 5e-5);
  EXPECT_NEAR(range(1.0 * Degree - 5.6e-3), 253.1001615, 5e-5);

  // Of a million rays in the beam none leaves these ends, and the outermost are close to them.
  Sensor sensor = openSensor();
  sensor.samplingInterval = 1e-9;
  EchoSettings settings = directSettings(1000000);
  settings.returnMode = ReturnMode::RangeUnits;
  const ScanResult result = runScan(makeSetup(scene, sensor, settings),
    oneBeam({ std::cos(1.0 * Degree), 0.0, -std::sin(1.0 * Degree) }));
  double near = 1e9;
  double far = 0.0;
  for (const Echo& echo : result.echoes)
  {
    near = std::min(near, echo.range);
    far = std::max(far, echo.range);
  }
  const double unit = sensor.rangeUnitLength(); // echoes are at the centres of their units
  EXPECT_NEAR(near, 130.1447826, unit);
  EXPECT_NEAR(far, 253.1001615, unit);
  EXPECT_GT(near, 130.1447826 - 0.5 * unit);
  EXPECT_LT(far, 253.1001615 + 0.5 * unit);
}

TEST(EchoClosedForms, WaveformWithPulseWidthAndAttenuation)
{
  const auto units = groundWaveform(1.0 * Degree, 5e-9, 3.5e-5);
  for (const auto& [m, energy] :
    { std::pair<int, double>{ 173, 7.014949967e-10 }, { 200, 1.050578974e-8 } })
  {
    const Echo& echo = units.at(m);
    EXPECT_LE(echo.energyStdError, 0.1 * energy) << m;
    EXPECT_NEAR(echo.energyReceived, energy, 5.0 * echo.energyStdError) << m;
  }
  EXPECT_EQ(units.count(172), 0u);
}

TEST(EchoClosedForms, FlatGroundIsNeverPerceivedByTheLowestChannel)
{
  double total = 0.0;
  for (const auto& unit : groundWaveform(0.0, 0.0, 0.0))
  {
    total += unit.second.energyReceived;
  }
  EXPECT_NEAR(total, 6.245981059e-8, 0.005 * 6.245981059e-8);
}

TEST(EchoClosedForms, GaussianProfileOnAPlane)
{
  for (const auto& [t, energy] :
    { std::pair<double, double>{ 5.6e-3, 5.255971692e-5 }, { 0.5, 5.034994502e-5 } })
  {
    Sensor sensor = openSensor(t);
    sensor.beamProfile = BeamProfile::Gaussian;
    expectEnergy(plane(100.0, 0.0, diffuse(0.146)), sensor, energy, 1e-3);
  }
}

TEST(EchoClosedForms, GaussianProfileBeyondAnEdge)
{
  Scene scene;
  const double edge = 100.0 * std::tan(2e-3);
  scene.plate(
    Vec3(100.0, edge + 50.0, 0.0), Vec3(0.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), diffuse(0.146));
  Sensor sensor = openSensor();
  sensor.beamProfile = BeamProfile::Gaussian;
  // At normal incidence the energy is the share times kd Qs but for cos theta, within t^2/2 of 1.
  expectEnergy(onlyEcho(scene, sensor, directSettings(Rays)), 0.2116880303 * 3.6e-4 * 0.146, 0.01);
}

namespace
{
/// A square of 0.15 m2 across the axis.
Scene smallTarget(double range)
{
  Scene scene;
  const double half = 0.5 * std::sqrt(0.15);
  scene.plate(Vec3(range, 0.0, 0.0), Vec3(0.0, half, 0.0), Vec3(0.0, 0.0, half), diffuse(0.146));
  return scene;
}
}

TEST(EchoClosedForms, SmallTargetFarAway)
{
  EchoSettings settings = directSettings(1000000);
  settings.attenuationCoefficient = 0.0;
  // It fills 0.15/(pi t^2 10^6) of the beam.
  expectEnergy(onlyEcho(smallTarget(1000.0), openSensor(), settings), 8.002428893e-8, 0.05);
}

TEST(EchoClosedForms, SmallTargetIsMissedByMostRandomBeams)
{
  EchoSettings settings = directSettings(100);
  settings.sampling = Sampling::MonteCarlo;
  ScanSetup setup = makeSetup(smallTarget(1000.0), openSensor(), settings);
  constexpr int seeds = 20000;
  int missed = 0;
  for (int seed = 0; seed < seeds; ++seed)
  {
    setup.settings.seed = seed;
    missed += runScan(setup, oneBeam()).echoes.empty();
  }
  const double share = 0.8586711696;
  EXPECT_NEAR(missed / double(seeds), share, 4.0 * std::sqrt(share * (1.0 - share) / seeds));
}

TEST(EchoClosedForms, SmallTargetIsPerceivedUpToTwoHundredMetres)
{
  Sensor sensor = openSensor();
  sensor.lowerEnergyLimit = 2e-6;
  EchoSettings settings = directSettings(400000);
  settings.lightEnergyConstraint = false;
  const double farthest = 200.0303589;
  EXPECT_EQ(
    runScan(makeSetup(smallTarget(0.99 * farthest), sensor, settings), oneBeam()).echoes.size(),
    1u);
  EXPECT_EQ(
    runScan(makeSetup(smallTarget(1.01 * farthest), sensor, settings), oneBeam()).echoes.size(),
    0u);
}

TEST(EchoClosedForms, EnergyOverRangeUnitsIsConserved)
{
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), Vec3(50.0, 50.0, 0.0), Vec3(0.0, 0.0, 50.0), Wall);
  EchoSettings settings = directSettings(1000);
  settings.returnMode = ReturnMode::RangeUnits;
  const double whole = onlyEcho(scene, openSensor(), settings).returnEnergy;
  for (double width : { 0.0, 1e-10, 3e-9, 5e-9, 1e-7 })
  {
    Sensor sensor = openSensor();
    sensor.samplingInterval = 1e-9;
    sensor.pulseWidth = width;
    double sum = 0.0;
    for (const Echo& echo : runScan(makeSetup(scene, sensor, settings), oneBeam()).echoes)
    {
      sum += echo.energyReceived;
    }
    EXPECT_NEAR(sum, whole, 1e-12 * whole) << width;
  }
}
