// SPDX-License-Identifier: BSD-3-Clause
// Scenes at the edge of geometry: planes through the lidar or nearly so, triangles twice, without
// area or turned over, a lidar on a surface, on a vertex, and grazing incidence. Faces that
// coincide are TestCoincidentFaces', bounds of energy in any scene TestGeometryProperties'.
#include "CollisionTreeBuilder.h"
#include "GeometryTestScene.h"
#include "ScanTestTown.h"
#include "StabilityScenes.h"
#include "StabilityTable.h"

#include <gtest/gtest.h>

using namespace echotest;
using namespace stability;

namespace
{
/// Two reflections; without noise, which alarms where the limit is 0.
EchoSettings quiet()
{
  EchoSettings settings = usual();
  settings.noise = false;
  return settings;
}

/// Number of echoes of `a` without a counterpart in the same beam of `b`: none nearer than `unit`,
/// or an energy of the strongest range unit that differs by more than three stated standard errors.
std::size_t echoesThatDisagree(const ScanResult& a, const ScanResult& b, double unit)
{
  std::size_t alone = 0;
  for (std::size_t i = 0; i < a.echoes.size(); ++i)
  {
    const Echo& x = a.echoes[i];
    bool agrees = false;
    for (std::size_t k = 0; k < b.echoes.size() && !agrees; ++k)
    {
      const Echo& y = b.echoes[k];
      const double limit =
        3.0 * std::hypot(x.energyStdError, y.energyStdError) + 1e-9 * x.energyReceived;
      agrees = a.beamOfEcho[i] == b.beamOfEcho[k] && std::fabs(y.range - x.range) <= unit &&
        std::fabs(y.energyReceived - x.energyReceived) <= limit;
    }
    alone += !agrees;
  }
  return alone;
}
}

TEST(StabilityDegenerate, PlanesThroughTheLidarAreNotHit)
{
  geometrytest::Numbers random(201);
  std::size_t echoes = 0;
  for (int round = 0; round < 100; ++round)
  {
    // In a coordinate plane through the lidar, which may be far out; and a triangle whose plane
    // holds it because the lidar is on the line of a side.
    const Vec3 apex =
      round % 3 == 0 ? Vec3(0.0) : std::round(random(-1e6, 1e6)) * Vec3(1.0, 2.0, -1.0);
    const int axis = static_cast<int>(random.index(3));
    Scene scene;
    for (int i = 0; i < 20; ++i)
    {
      Vec3 corner[3];
      for (Vec3& c : corner)
      {
        c = random.inCube(30.0);
        c[axis] = 0.0;
        c = apex + c;
        c[axis] = apex[axis];
      }
      scene.triangle(corner[0], corner[1], corner[2], Wall, i);
      const Vec3 along(random.index(8) + 1.0, random.index(8) - 4.0, random.index(8) - 4.0);
      scene.triangle(
        apex + along, apex + 3.0 * along, apex + Vec3(7.0, -3.0, random.index(9)), Wall, i);
      scene.mesh->points.back() = apex + 2.0 * along; // on that line: no area either
    }
    Vec3 direction = random.direction();
    direction[axis] = 0.0;
    for (const double t : { 1e-6, 5.6e-3, 0.5 })
    {
      for (const BeamSampleSource source : BothSources)
      {
        EchoSettings settings = quiet();
        settings.beamSamples = source;
        echoes += runScan(makeSetup(scene, openSensor(t), settings), oneBeam(direction, apex))
                    .echoes.size();
      }
    }
  }
  record({ "Coplanar with the lidar", "exactly: 4,000 triangles in planes through it", "both",
    "echoes", 0.0, static_cast<double>(echoes) });
}

TEST(StabilityDegenerate, PlanesNearlyThroughTheLidar)
{
  Worst error;
  Worst excess;
  for (double height = 1e-15; height < 2e3; height *= 10.0)
  {
    for (const double t : { 1e-6, 5.6e-3, 0.3 })
    {
      Scene scene;
      const double reach = 1e7 * height / t; // infinite but for a ten-millionth
      scene.plate(Vec3(0.0, 0.0, -height), Vec3(reach, 0.0, 0.0), Vec3(0.0, reach, 0.0), Diffuse);
      Sensor sensor = openSensor(t);
      sensor.rangeGate = 1e13;
      sensor.samplingInterval = 1.0;
      EchoSettings settings = directSettings(20000);
      const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
      double deviation = 0.0;
      for (const Echo& echo : result.echoes)
      {
        deviation += echo.energyStdError;
      }
      // Qs kd (t - sin t cos t)/Omega, whatever the height.
      const double half = std::sin(0.5 * t);
      const double right =
        Qs * Diffuse.kd * (t - std::sin(t) * std::cos(t)) / (4.0 * Pi * half * half);
      error.see(std::fabs(receivedFrom(result) - right) / (deviation + 1e-7 * right));
      excess.see(receivedFrom(result) / (0.146 * sensor.pulseEnergy * std::sin(t)));
    }
  }
  const std::string range = "nearly: a plane 1e-15 to 1e3 m below, half-beamwidth 1e-6 to 0.3 rad";
  record({ "Coplanar with the lidar", range, "rays",
    "deviation from the closed form, in stated standard errors", 5.0, error.value() });
  record({ "Coplanar with the lidar", range, "rays",
    "energy over its bound Qs kd sin(half-beamwidth)", 1.0, excess.value() });
}

TEST(StabilityDegenerate, DuplicatesAndTrianglesWithoutArea)
{
  const Scene plain = town();
  Scene more = copyOf(plain);
  const auto add = [&more](const std::array<std::uint32_t, 3>& t, std::size_t like)
  {
    more.mesh->triangles.push_back(t);
    more.materials.push_back(more.materials[like]);
    more.objects.push_back(1000);
  };
  const std::size_t count = plain.mesh->size();
  for (std::size_t i = 0; i < count; ++i)
  {
    const auto t = plain.mesh->triangles[i];
    add(t, i);                                                                    // twice
    add({ t[1], t[0], t[2] }, i);                                                 // and turned over
    add({ t[2], t[0], t[1] }, i);                                                 // and renumbered
    add({ t[0], t[0], t[1] }, i);                                                 // a side
    add({ t[1], t[1], t[1] }, i);                                                 // a point
    add({ t[0], static_cast<std::uint32_t>(more.mesh->points.size()), t[1] }, i); // a middle
    more.mesh->points.push_back(0.5 * (more.mesh->points[t[0]] + more.mesh->points[t[1]]));
  }
  Scene turned = copyOf(plain);
  for (auto& t : turned.mesh->triangles)
  {
    std::swap(t[1], t[2]);
  }
  const ScanBeams beams = horizon(180, 4);
  EchoSettings settings = quiet();
  settings.beamSamples = BeamSampleSource::Rays; // integrals are rounded otherwise
  Sensor sensor;
  sensor.lowerEnergyLimit = 1e-8;
  const ScanResult usually = runScan(makeSetup(plain, sensor, settings), beams);
  ASSERT_GT(usually.echoes.size(), 200u);
  const auto differing = [&](const Scene& scene)
  {
    return static_cast<double>(
      differingEchoes(usually, runScan(makeSetup(scene, sensor, settings), beams)));
  };
  const std::string promise = "echoes, with two reflections, that change by a bit";
  const std::string limits = "share of echoes, with two reflections, that change by more than "
                             "three stated standard errors";
  EchoSettings byDefault = quiet();
  const ScanResult seen = runScan(makeSetup(plain, sensor, byDefault), beams);
  const double unit = 0.5 * SpeedOfLight * sensor.samplingInterval;
  const auto disagreeing = [&](const Scene& scene)
  {
    const ScanResult other = runScan(makeSetup(scene, sensor, byDefault), beams);
    const std::size_t unlike =
      echoesThatDisagree(seen, other, unit) + echoesThatDisagree(other, seen, unit);
    return static_cast<double>(unlike) / static_cast<double>(seen.echoes.size());
  };
  record(
    { "Duplicated, zero-area", "every triangle three more times, and three without area beside it",
      "default", limits, 0.01, disagreeing(more) });
  record(
    { "Inverted", "every triangle turned over", "default", limits, 0.01, disagreeing(turned) });
  record(
    { "Duplicated, zero-area", "every triangle three more times, and three without area beside it",
      "rays", promise, 0.0, differing(more) });
  record({ "Inverted", "every triangle turned over", "rays", promise, 0.0, differing(turned) });
}

TEST(StabilityDegenerate, WideBeamOnASlantedWall)
{
  // 0.5 rad at 60 degrees of incidence: faint units far along the wall, where cells are coarse.
  constexpr double Half = 0.5;
  constexpr double Distance = 50.0;
  const Vec3 normal(-0.5, std::sqrt(0.75), 0.0);
  Scene scene;
  scene.plate(Vec3(Distance, 0.0, 0.0), 1e4 * Vec3(normal.y, -normal.x, 0.0),
    1e4 * Vec3(0.0, 0.0, 1.0), Diffuse);
  Sensor sensor = openSensor(Half);
  sensor.samplingInterval = 5e-9;
  sensor.rangeGate = 1e4;
  const double unit = 0.5 * SpeedOfLight * sensor.samplingInterval;
  // Midpoints of rings and sectors of equal solid angle.
  constexpr int Rings = 3000;
  constexpr int Sectors = 3000;
  std::vector<double> right(static_cast<std::size_t>(sensor.rangeGate / unit) + 1);
  for (int i = 0; i < Rings; ++i)
  {
    const double cosine = 1.0 - (1.0 - std::cos(Half)) * (i + 0.5) / Rings;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (int k = 0; k < Sectors; ++k)
    {
      const double turn = 2.0 * Pi * (k + 0.5) / Sectors;
      const Vec3 ray(cosine, sine * std::cos(turn), sine * std::sin(turn));
      const double facing = -glm::dot(normal, ray);
      const double range = -Distance * normal.x / facing;
      if (facing > 0.0 && range < sensor.rangeGate)
      {
        right[static_cast<std::size_t>(range / unit)] +=
          sensor.pulseEnergy * Diffuse.kd * facing / (double(Rings) * Sectors);
      }
    }
  }
  for (const BeamSampleSource source : { BeamSampleSource::Rays, BeamSampleSource::Cells })
  {
    EchoSettings settings = directSettings(source == BeamSampleSource::Rays ? 20000 : 100);
    settings.beamSamples = source;
    settings.returnMode = ReturnMode::RangeUnits;
    const ScanResult result = runScan(makeSetup(scene, sensor, settings), oneBeam());
    std::size_t beyond = 0;
    for (const Echo& echo : result.echoes)
    {
      const double expected = right[static_cast<std::size_t>(echo.range / unit)];
      const double off = std::fabs(echo.energyReceived - expected);
      beyond += off > 3.0 * echo.energyStdError + 1e-3 * expected;
    }
    ASSERT_GT(result.echoes.size(), 50u);
    const std::string view = source == BeamSampleSource::Rays ? "rays" : "default";
    record({ "Wide beam on a slanted wall", "half-beamwidth 0.5 rad at 60 deg", view,
      "share of range units beyond three stated standard errors", 0.02,
      static_cast<double>(beyond) / static_cast<double>(result.echoes.size()) });
  }
}

TEST(StabilityDegenerate, LidarOnASurfaceAnEdgeOrAVertex)
{
  // What touches the lidar has no solid angle: the rest of the scene is seen as without it.
  std::size_t differing = 0;
  std::size_t echoes = 0;
  for (const double far : { 0.0, 1e6 })
  {
    const Vec3 at(far, -far, far);
    const double grid = 0x1p-20;
    const Scene bare = town(at, grid);
    for (int kind = 0; kind < 3; ++kind)
    {
      Scene scene = copyOf(bare);
      // Triangles in planes through the lidar: it lies inside, on a side, on a corner.
      const Vec3 corner[3][3] = { { { -1, -1, 0 }, { 3, -1, 0 }, { -1, 3, 0 } },
        { { -1, 0, 0 }, { 1, 0, 0 }, { 0, 0, 5 } }, { { 0, 0, 0 }, { 2, 0, 1 }, { 0, 2, 1 } } };
      for (int i = 0; i < 4; ++i)
      {
        const auto turned = [i](const Vec3& v)
        {
          return i == 0 ? v
            : i == 1    ? Vec3(-v.x, v.y, v.z)
            : i == 2    ? Vec3(-v.y, v.x, v.z)
                        : Vec3(v.y, v.z, v.x);
        };
        scene.triangle(at + turned(corner[kind][0]), at + turned(corner[kind][1]),
          at + turned(corner[kind][2]), Metal, 999);
      }
      EchoSettings settings = usual();
      settings.numberOfReflections = 1;
      const ScanBeams beams = horizon(90, 4, at);
      for (const BeamSampleSource source : BothSources)
      {
        settings.beamSamples = source;
        const ScanResult without = runScan(makeSetup(bare, Sensor(), settings), beams);
        echoes += without.echoes.size();
        differing += differingEchoes(without, runScan(makeSetup(scene, Sensor(), settings), beams));
      }
    }
  }
  ASSERT_GT(echoes, 400u);
  record({ "Lidar on a surface, an edge, a vertex", "at the origin and 1e6 m away, exactly", "both",
    "echoes of the rest of the scene that change by a bit", 0.0, static_cast<double>(differing) });
}

TEST(StabilityDegenerate, LidarALittleAboveASurface)
{
  Worst error;
  for (double height = 1e-12; height < 1e4; height *= 10.0)
  {
    Scene scene;
    scene.plate(
      Vec3(0.0, 0.0, -height), Vec3(1e4 * height, 0.0, 0.0), Vec3(0.0, 1e4 * height, 0.0), Diffuse);
    Sensor sensor = openSensor(1e-4);
    sensor.samplingInterval = 4.0 * height / SpeedOfLight;
    const Echo echo = onlyEcho(scene, sensor, directSettings(1000), { 0.0, 0.6, -0.8 });
    error.see(std::fabs(echo.returnEnergy / (Qs * Diffuse.kd * 0.8) - 1.0));
    error.see(std::fabs(echo.range / (1.25 * height) - 1.0));
  }
  record({ "Lidar above a surface", "1e-12 to 1e3 m", "rays",
    "relative error of energy and range, incidence 37 deg", 1e-5, error.value() });
}

TEST(StabilityDegenerate, GrazingIncidence)
{
  Worst energy;
  Worst range;
  for (const double degrees : { 0.0, 45.0, 80.0, 89.0, 89.9, 89.99, 89.999, 89.9999 })
  {
    const double cosine = std::sin((90.0 - degrees) * Degree);
    const double sine = std::cos((90.0 - degrees) * Degree);
    const double distance = 100.0;
    const double t = 1e-3 * cosine;
    Scene scene;
    scene.plate(
      Vec3(distance, 0.0, 0.0), 50.0 * Vec3(-sine, cosine, 0.0), Vec3(0.0, 0.0, 50.0), Diffuse);
    EchoSettings settings = directSettings(1000);
    Sensor sensor = openSensor(t);
    sensor.samplingInterval = 1e-6;
    const Echo echo = onlyEcho(scene, sensor, settings);
    const double right = Qs * Diffuse.kd * cosine * std::pow(std::cos(0.5 * t), 2);
    energy.see(std::fabs(echo.returnEnergy / right - 1.0));
    range.see(std::fabs(echo.range / distance - 1.0));
  }
  record({ "Grazing incidence", "0 to 89.9999 deg, half-beamwidth 1e-3 cos(incidence)", "rays",
    "relative error of energy", 1e-5, energy.value() });
  record({ "Grazing incidence", "0 to 89.9999 deg, half-beamwidth 1e-3 cos(incidence)", "rays",
    "relative error of range", 1e-5, range.value() });
}
