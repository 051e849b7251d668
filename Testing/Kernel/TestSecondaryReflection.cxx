// SPDX-License-Identifier: BSD-3-Clause
// Paths with two reflections: the known ones, and the bound on what a ray returns.
#include "GivenHits.h"
#include "MediumTestScene.h"
#include "Sanitized.h"
#include "SecondaryTestScene.h"

#include "OneBeamTracer.h"
#include "SecondaryReflection.h"
#include "Statistics.h"
#include "VolumeTree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>

using namespace echotest;

TEST(SecondaryReflection, OneSpecularPath)
{
  // P1 = (100, 0, 0) sends the axis ray to P2 = (100, 0.5, 0), which sends it back to the lidar.
  Scene scene;
  scene.plate(Vec3(100.0, 0.0, 0.0), 0.1 * Vec3(1.0, 1.0, 0.0), Vec3(0.0, 0.0, 0.1), Metal, 0);
  scene.plate(Vec3(100.0, 0.5, 0.0), 0.1 * Vec3(-1.0, 1.0, 0.0), Vec3(0.0, 0.0, 0.1), Metal, 1);
  EchoSettings settings = secondarySettings(100, 0);
  settings.attenuationCoefficient = 3.5e-5;
  // The ray on the axis alone, 1 of 100: its energy is 3.6e-6 J.
  GivenHits hits(makeSetup(scene, openSensor(), settings), 100);
  hits.hit(7, 0, Vec3(100.0, 0.0, 0.0), Vec3(-1.0, 1.0, 0.0) / std::sqrt(2.0));
  double lost = 0.0;
  const std::vector<SecondaryPath> paths = hits.collect(&lost, true);
  ASSERT_EQ(paths.size(), 1u);
  EXPECT_NEAR(paths[0].length, 200.50125, 1e-6);
  EXPECT_NEAR(paths[0].energy, 1.439978941e-6, 1e-15);
  EXPECT_GE(paths[0].triangle, 2u);
  EXPECT_EQ(lost, 0.0);
}

namespace
{
statistics::Moments secondaryOfSeeds(ScanSetup setup, int seeds)
{
  statistics::Moments energies;
  for (int seed = 0; seed < seeds; ++seed)
  {
    setup.settings.seed = seed;
    energies.add(secondaryOf(runScan(setup, oneBeam())));
  }
  return energies;
}
}

TEST(SecondaryReflection, DiffuseConnectionsOfAnOpenV)
{
  // Mean of cos(theta1) cos(theta2) over all ordered pairs of the cone.
  constexpr double product = 0.1238769844;
  constexpr double exact = 3.6e-4 * 0.146 * 0.146 * product;
  EXPECT_NEAR(exact, 9.506022479e-7, 1e-15);
  const Scene scene = groove(45.0 * Degree, { 0.146, 0.0, 0.0 }, 0.1, 300.0);
  // The same mean for few rays, where a stratum's own partner is a large part of all, for odd N,
  // and for few connections.
  constexpr int fewer = IsSanitized ? 16 : 1; // seeds, and so four times the spread
  const std::tuple<int, int, int, double> cases[] = { { 1000, 999, 40, 0.005 },
    { 100, 8, 1000, 0.01 }, { 7, 2, 20000, 0.01 }, { 6, 5, 20000, 0.01 }, { 2, 1, 20000, 0.02 } };
  for (Sampling sampling : { Sampling::MonteCarlo, Sampling::Stratified })
  {
    for (const auto& [rays, connections, seeds, precision] : cases)
    {
      EchoSettings settings = secondarySettings(rays, connections);
      settings.sampling = sampling;
      const statistics::Moments energies =
        secondaryOfSeeds(makeSetup(scene, openSensor(), settings), std::max(seeds / fewer, 4));
      const double allowed = sampling == Sampling::MonteCarlo ? 2.0 * precision : precision;
      EXPECT_LT(energies.error(), std::sqrt(fewer) * allowed * exact) << rays;
      EXPECT_NEAR(energies.mean(), exact, 4.0 * energies.error()) << rays;
    }
  }
}

TEST(SecondaryReflection, NoGrooveReturnsMoreThanItReflects)
{
  const Material materials[] = { { 1.0, 0.0, 1.0 }, { 0.0, 1.0, 0.0 }, { 0.0, 1.0, 1e6 },
    { 0.5, 0.5, 3.0 }, Wall, Metal, Glass };
  Sensor sensor = openSensor();
  for (const Material& m : materials)
  {
    for (double half = 5.0; half < 90.0; half += 5.0)
    {
      for (int rays : { 2, 3, 100 })
      {
        EchoSettings settings = secondarySettings(rays, rays == 3 ? 1 : 8);
        for (const double aperture : { 0.0, 1e-4, 0.01, 1e4, 1e9 })
        {
          sensor.receiverAperture = aperture;
          // All of the light at most, through an aperture.
          const double most = aperture > 0.0 ? 1.0 : m.kd + m.ks;
          const ScanResult result =
            runScan(makeSetup(groove(half * Degree, m), sensor, settings), oneBeam());
          EXPECT_LE(receivedFrom(result), most * 3.6e-4 * (1.0 + 1e-12))
            << half << " " << m.kd << " " << aperture;
        }
      }
    }
  }
}

namespace
{
/// An upright plate between two points of the plane z = 0.
struct Upright
{
  Vec3 a, b;
  Material material;
};

Scene uprights(const std::vector<Upright>& plates)
{
  Scene scene;
  for (const Upright& of : plates)
  {
    const int object = static_cast<int>(scene.objects.size()) / 2;
    scene.plate(
      0.5 * (of.a + of.b), 0.5 * (of.b - of.a), Vec3(0.0, 0.0, 30.0), of.material, object);
  }
  return scene;
}

/// Two plates that meet at 100 m and open towards the lidar, each `half` from the plane y = 0.
Scene corner(const Material& one, const Material& two, double half = 45.0 * Degree)
{
  const Vec3 edge(100.0, 0.0, 0.0);
  const Vec3 along = 10.0 * Vec3(-std::cos(half), std::sin(half), 0.0);
  return uprights(
    { { edge, edge + along * Vec3(1.0, -1.0, 1.0), one }, { edge, edge + along, two } });
}

Sensor gatheringSensor()
{
  Sensor sensor = openSensor();
  sensor.receiverAperture = 0.0025 * Pi;
  return sensor;
}
}

TEST(SecondaryReflection, ThroughAnApertureLightComesBackBothWays)
{
  // Energies after two reflections, J, by a ray tracer in NumPy that shares nothing with this one:
  // 1.6 million rays in strata of the cone. Each is followed once into a direction drawn from the
  // whole lobe cos^kp, and once into one drawn from cos theta. What the lidar sees where that ends
  // returns the matt part and the lobe of f through the aperture. What goes wall, mirror, lidar is
  // the integral over the rays that the receiver looks along of the lobe of the mirror, the matt
  // part of the wall, and the density of the beam there. Standard errors are below 0.4 %. What goes
  // mirror, wall, the same mirror is added, both ways by the lobe (mirror_lobes.py; errors below
  // 0.4 %). For metal and between the mirrors it is the light on the wall in the mirror's image.
  const Material matt{ 0.8, 0.0, 1.0 };
  const Material rough{ 0.8, 0.0, 1.0, 0.5 };
  const Material concrete{ 0.3104, 0.0, 1.0 };
  const Material half{ 0.5, 0.0, 1.0 };
  // A mirror that the beam meets at 4.8 degrees, before a wall.
  const Scene grazing = uprights({ { Vec3(94.0, -0.15, 0.0), Vec3(100.0, 0.35, 0.0), Glass },
    { Vec3(100.0, -5.0, 0.0), Vec3(100.0, 5.0, 0.0), concrete } });
  // A mirror at 96 m that shows a wall between 95 m and 103 m.
  const Scene unlike = uprights({ { Vec3(96.0, -0.5, 0.0), Vec3(96.25, 0.3, 0.0), Glass },
    { Vec3(95.0, 0.7, 0.0), Vec3(103.0, -0.9, 0.0), half } });
  // A rough mirror that the beam meets at 1 degree, before a wall that stands on the mirror.
  const double c = std::cos(Degree);
  const double s = std::sin(Degree);
  const Vec3 shore(171.9, 0.0, 0.0);
  const Scene water = uprights({ { shore - 170.0 * Vec3(c, s, 0.0), shore, { 0.02, 0.6, 500.0 } },
    { shore, shore + 20.0 * Vec3(-s, c, 0.0), { 0.3, 0.0, 1.0 } } });
  // Two mirrors that stand open towards the lidar, with a wall between them.
  const Scene between = uprights({ { Vec3(100.0, -0.3, 0.0), Vec3(98.0, -0.9, 0.0), Glass },
    { Vec3(100.0, 0.3, 0.0), Vec3(98.0, 0.9, 0.0), Metal },
    { Vec3(100.0, -0.3, 0.0), Vec3(100.0, 0.3, 0.0), half } });
  const struct
  {
    const char* name;
    Scene scene;
    double energy; ///< after two reflections, J
    double again;  ///< by the mirror, the wall and the mirror, J
    bool gaussian;
  } cases[] = {
    { "glass and wall", corner(Glass, half), 2.691e-11, 1.128e-11, false },
    { "glass and concrete", corner(Glass, concrete), 1.671e-11, 7.003e-12, false },
    { "metal and wall", corner(Metal, { 0.146, 0.0, 1.0 }), 5.972e-12, 1.854e-12, false },
    { "grazing", grazing, 6.156e-12, 9.767e-12, false },
    { "grazing, Gaussian beam", grazing, 5.427e-12, 1.210e-11, true }, // 3.743e-12 and 1.681e-12
    { "unlike distances", unlike, 2.404e-13, 5.871e-12, false },
    { "sharp corner", corner(Glass, half, 30.0 * Degree), 1.928e-11, 1.611e-11, false },
    { "rough and grazing", water, 2.112e-12, 3.280e-13, false },
    { "wall between mirrors", between, 2.377e-11, 7.430e-12, false },
    { "two mirrors", corner(Glass, Metal), 7.945e-8, 0.0, false },
    { "matt", corner(matt, matt), 9.491e-12, 0.0, false },
    { "rough", corner(rough, rough), 5.829e-12, 0.0, false },
  };
  for (const auto& of : cases)
  {
    SCOPED_TRACE(of.name);
    Sensor sensor = gatheringSensor();
    sensor.beamProfile = of.gaussian ? BeamProfile::Gaussian : BeamProfile::Uniform;
    EchoSettings settings = secondarySettings(100, 2, BeamSampleSource::Cells);
    settings.reflectanceModel = ReflectanceModel::OrenNayar; // Lambert's and Phong's, not rough
    settings.numberOfReflections = 1;
    ScanSetup setup = makeSetup(of.scene, sensor, settings);
    const double truth = receivedFrom(runScan(setup, oneBeam())) + of.energy + of.again;
    setup.settings.numberOfReflections = 3;
    finishSetup(setup);
    constexpr int seeds = 40;
    int held = 0;
    double sum = 0.0, squares = 0.0, stated = 0.0;
    for (setup.settings.seed = 0; setup.settings.seed < seeds; ++setup.settings.seed)
    {
      const ScanResult result = runScan(setup, oneBeam());
      ASSERT_EQ(result.echoes.size(), 1u);
      const double off = result.echoes[0].energyReceived - truth;
      held += std::fabs(off) <= 1.96 * result.echoes[0].energyStdError;
      sum += off;
      squares += off * off;
      stated += result.echoes[0].energyStdError / seeds;
    }
    EXPECT_GE(held, 34);
    const double deviation = std::sqrt((squares - sum * sum / seeds) / (seeds - 1));
    EXPECT_LE(stated, 2.0 * deviation);
    EXPECT_LE(std::fabs(sum / seeds), 0.01 * truth + 4.0 * deviation / std::sqrt(seeds));
  }
}

TEST(SecondaryReflection, CornersOfMattWallsAreNotCut)
{
  // As above. Near the edge the form factor of two points has no bound.
  const Material matt{ 0.8, 0.0, 1.0 };
  for (const auto& [rays, connections, seeds] :
    { std::tuple(100, 2, 2000), std::tuple(10, 1, 20000), std::tuple(200, 20, 200) })
  {
    const ScanSetup setup =
      makeSetup(corner(matt, matt), gatheringSensor(), secondarySettings(rays, connections));
    const statistics::Moments energies = secondaryOfSeeds(setup, seeds);
    EXPECT_LT(energies.error(), 0.01 * 9.491e-12) << rays;
    EXPECT_NEAR(energies.mean(), 9.491e-12, 4.0 * energies.error()) << rays;
  }
}

TEST(SecondaryReflection, LightOfTheWayBackIsLabelledByTheMirror)
{
  // The mirror returns nothing by itself. Light that it returns last: one half of that after two
  // reflections, and all after three, which is 0.85 times that half.
  const Scene scene = corner({ 0.0, 0.85, 1e6 }, { 0.5, 0.0, 1.0 });
  EchoSettings settings = secondarySettings(100, 2);
  settings.numberOfReflections = 3;
  settings.beamSamples = BeamSampleSource::Cells;
  const ScanResult result = runScan(makeSetup(scene, gatheringSensor(), settings), oneBeam());
  ASSERT_EQ(result.echoes.size(), 1u);
  EXPECT_EQ(result.echoes[0].objectId, 1);
  EXPECT_GT(result.echoes[0].secondaryShare, 0.5);
  const double last = 1.85 / 2.85 * result.echoes[0].secondaryShare;
  EXPECT_NEAR(result.echoes[0].labelShare, 1.0 - last, 2e-3);
}

TEST(SecondaryReflection, FogBeforeAWallLeavesWhatTheMirrorShows)
{
  // Fog that no light passes lies before the wall, not before the mirror: of three ways over both,
  // the one there and back by the mirror is left.
  Medium fog;
  fog.extinction = 1e3;
  fog.backscatterRatio = 1e9;
  ScanSetup setup = inMedium(corner(Glass, { 0.5, 0.0, 1.0 }), gatheringSensor(), fog,
    boxOf(Vec3(50.0, 0.5, 0.0), Vec3(1.0, 0.5, 5.0)));
  setup.settings.numberOfReflections = 2;
  finishSetup(setup);
  EXPECT_LT(secondaryOfSeeds(setup, 8).mean(), 0.03 * 1.128e-11);
  setup.settings.numberOfReflections = 3;
  finishSetup(setup);
  const statistics::Moments energies = secondaryOfSeeds(setup, 40);
  EXPECT_NEAR(energies.mean(), 1.128e-11, 0.02 * 1.128e-11 + 4.0 * energies.error());
}

TEST(SecondaryReflection, APlateInBetweenBlocksThePath)
{
  const Scene open = groove(45.0 * Degree, { 0.146, 0.0, 0.0 }, 0.1, 300.0);
  Scene closed = groove(45.0 * Degree, { 0.146, 0.0, 0.0 }, 0.1, 300.0);
  // A wall in the plane of symmetry, seen edge-on by the lidar: it takes no light, but parts the
  // plates.
  closed.plate(
    Vec3(90.0, 0.0, 0.0), Vec3(20.0, 0.0, 0.0), Vec3(0.0, 0.0, 20.0), { 0.0, 0.0, 0.0 }, 2);
  EXPECT_GT(
    secondaryOf(runScan(makeSetup(open, openSensor(), secondarySettings(200)), oneBeam())), 0.0);
  EXPECT_EQ(
    secondaryOf(runScan(makeSetup(closed, openSensor(), secondarySettings(200)), oneBeam())), 0.0);
}
