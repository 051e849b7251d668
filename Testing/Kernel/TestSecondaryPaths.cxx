// SPDX-License-Identifier: BSD-3-Clause
// Single paths with two reflections, for hits that are given and not drawn: lengths, energies, and
// each of the rules by which a path does not count.
#include "GivenHits.h"
#include "SecondaryTestScene.h"

#include <gtest/gtest.h>

using namespace echotest;

namespace
{
EchoSettings pathSettings(int connections, double attenuation = 0.0)
{
  EchoSettings settings = secondarySettings(2, connections);
  settings.attenuationCoefficient = attenuation;
  return settings;
}

/// Small square plate in space with a normal in the plane z = 0. The triangles of plate p are 2p
/// and 2p + 1.
void square(Scene& scene, const Vec3& center, const Vec3& normal, const Material& m, double half)
{
  const Vec3 along(-normal.y, normal.x, 0.0);
  scene.plate(center, half * along, Vec3(0.0, 0.0, half), m);
}

/// Paths of the axis ray, mirrored at P1 towards a metal plate about P2; a third plate may stand in
/// the way, square to the beam.
std::vector<SecondaryPath> mirrorPaths(const Vec3& p1, const Vec3& p2, const Vec3& normal2,
  const Material& m2, bool beamConstraint, const Vec3* third = nullptr)
{
  Scene scene;
  const Vec3 normal1 = glm::normalize(glm::normalize(p2 - p1) - Vec3(1.0, 0.0, 0.0));
  square(scene, p1, normal1, Metal, 0.1);
  square(scene, p2, normal2, m2, 0.05);
  if (third)
  {
    square(scene, *third, Vec3(-1.0, 0.0, 0.0), Wall, 0.05);
  }
  EchoSettings settings = pathSettings(0);
  settings.beamConstraint = beamConstraint;
  GivenHits beam(makeSetup(scene, openSensor(), settings), 2);
  beam.hit(0, 0, p1, normal1);
  return beam.collect();
}
}

TEST(SecondaryPaths, TwoConnectionsBetweenTwoPoints)
{
  // Both rays are the other's only partner, with weight 1: Q/2 kd1 cos(theta1) kd2 cos(theta2)
  // exp(-mu (r1 + L + r2)), with theta2 at the plate where the path ends.
  const double mu = 2e-3;
  const Vec3 p1(100.0, 0.0, 0.0);
  const Vec3 p2(99.8, 0.5, 0.0);
  const Vec3 n1(-Cosine45, Cosine45, 0.0);
  const Vec3 n2(-Cosine45, -Cosine45, 0.0);
  const double kd1 = 0.2;
  const double kd2 = 0.5;
  Scene scene;
  square(scene, p1, n1, { kd1, 0.0, 0.0 }, 0.1);
  square(scene, p2, n2, { kd2, 0.0, 0.0 }, 0.1);
  GivenHits beam(makeSetup(scene, openSensor(), pathSettings(1, mu)), 2);
  beam.hit(0, 0, p1, n1);
  beam.hit(1, 2, p2, n2);
  const std::vector<SecondaryPath> paths = beam.collect();
  ASSERT_EQ(paths.size(), 2u);
  const double length = 100.0 + std::hypot(0.2, 0.5) + std::hypot(99.8, 0.5);
  const double air = 1.8e-4 * kd1 * kd2 * std::exp(-mu * length);
  // The step from P1 to P2 is (-0.2, 0.5) m: cosines of arrival 0.3 and 0.7 over sqrt(2) L.
  const double root = std::sqrt(2.0) * std::hypot(0.2, 0.5);
  const double energies[] = { air * Cosine45 * 0.3 / root,
    air * (99.8 + 0.5) / (std::sqrt(2.0) * std::hypot(99.8, 0.5)) * 0.7 / root };
  for (int n : { 0, 1 })
  {
    EXPECT_NEAR(paths[n].length, length, 1e-9);
    EXPECT_NEAR(paths[n].energy, energies[n], 1e-12 * energies[n]);
    EXPECT_EQ(paths[n].triangle, n == 0 ? 2u : 0u);
    EXPECT_NEAR(paths[n].cosIncidence, (n == 0 ? 0.3 : 0.7) / root, 1e-12);
  }
}

TEST(SecondaryPaths, AMirrorPathEndsWhereTheLidarSees)
{
  const Vec3 p1(100.0, 0.0, 0.0);
  const Vec3 p2(100.0, 0.5, 0.0);
  const Vec3 n2(-Cosine45, -Cosine45, 0.0);
  // Cosine45-way between the lidar and P2; and aside, where it blocks nothing.
  const Vec3 between(50.0, 0.25, 0.0);
  const Vec3 aside(50.0, -0.25, 0.0);
  for (bool constraint : { true, false })
  {
    EXPECT_EQ(mirrorPaths(p1, p2, n2, Metal, constraint, &between).size(), 0u);
    EXPECT_EQ(mirrorPaths(p1, p2, n2, Metal, constraint, &aside).size(), 1u);
  }
}

TEST(SecondaryPaths, AMirrorPathEndsInTheCone)
{
  // The cone is 100 tan(5.6 mrad) = 0.560006 m wide at the plates.
  const Vec3 p1(100.0, 0.0, 0.0);
  const Vec3 n2(-Cosine45, -Cosine45, 0.0);
  for (bool constraint : { true, false })
  {
    EXPECT_EQ(mirrorPaths(p1, Vec3(100.0, 0.5599, 0.0), n2, Metal, constraint).size(), 1u);
    EXPECT_EQ(mirrorPaths(p1, Vec3(100.0, 0.5601, 0.0), n2, Metal, constraint).size(), 0u);
  }
}

namespace
{
// A lobe so wide that it would send light to the lidar from a plate met on its far side.
const Material WideLobe{ 0.0, 0.5, 1.0 };
const Vec3 Behind(101.0, 0.0, 0.0);
const Vec3 Before(100.1, 0.436, 0.0);
/// Facing the lidar, and away from / towards the point `Behind`.
const Vec3 Away = glm::normalize(Vec3(-0.1, 0.995, 0.0));
const Vec3 Towards = glm::normalize(Vec3(-0.1, -0.995, 0.0));
}

TEST(SecondaryPaths, AMirrorPathEndsOnASideThatLooksToTheLidar)
{
  for (bool constraint : { true, false })
  {
    EXPECT_EQ(mirrorPaths(Behind, Before, Away, WideLobe, constraint).size(), 0u);
    EXPECT_EQ(mirrorPaths(Behind, Before, Towards, WideLobe, constraint).size(), 1u);
  }
}

TEST(SecondaryPaths, AConnectionEndsOnASideThatLooksToTheLidar)
{
  for (bool facing : { false, true })
  {
    const Vec3 normal1(-1.0, 0.0, 0.0);
    const Vec3 normal2 = facing ? Towards : Away;
    Scene scene;
    square(scene, Behind, normal1, { 0.2, 0.0, 0.0 }, 0.1);
    square(scene, Before, normal2, WideLobe, 0.05);
    GivenHits beam(makeSetup(scene, openSensor(), pathSettings(1)), 2);
    beam.hit(0, 0, Behind, normal1);
    beam.hit(1, 2, Before, normal2);
    // Nothing comes from the diffuse component that the second plate does not have.
    EXPECT_EQ(beam.collect().size(), facing ? 1u : 0u);
  }
}

namespace
{
/// The path from P1 to P2 through an aperture; both surfaces are diffuse with kd = 0.2 and 0.5.
double throughApertureEnergy(const Vec3& p1, const Vec3& n1, const Vec3& p2, const Vec3& n2,
  double aperture, double roughness = 0.0)
{
  Scene scene;
  square(scene, p1, n1, { 0.2, 0.0, 0.0, roughness }, 0.01);
  square(scene, p2, n2, { 0.5, 0.0, 0.0, roughness }, 0.01);
  Sensor sensor = openSensor();
  sensor.receiverAperture = aperture;
  EchoSettings settings = pathSettings(1);
  settings.reflectanceModel = ReflectanceModel::OrenNayar; // Lambert's, not rough
  GivenHits beam(makeSetup(scene, sensor, settings), 2);
  beam.hit(0, 0, p1, n1);
  beam.hit(1, 2, p2, n2);
  for (const SecondaryPath& path : beam.collect())
  {
    if (path.triangle == 2u || path.triangle == 3u)
    {
      return path.energy;
    }
  }
  return 0.0;
}
}

TEST(SecondaryPaths, ThroughAnApertureTheFormFactor)
{
  const double aperture = 0.01;
  const double coneAngle = 4.0 * Pi * std::pow(std::sin(2.8e-3), 2);
  const Vec3 p1(100.0, 0.0, 0.0);
  const Vec3 n1(-Cosine45, Cosine45, 0.0);
  const Vec3 n2(-Cosine45, -Cosine45, 0.0);
  struct
  {
    Vec3 p2;
    bool capped;
  } const cases[] = { { Vec3(99.2, 1.0, 0.0), false }, { Vec3(100.0, 0.5, 0.0), false },
    { Vec3(100.0, 0.4, 0.0), true }, { Vec3(100.0, 0.05, 0.0), true } };
  for (const auto& [p2, capped] : cases)
  {
    const Vec3 step = p2 - p1;
    const double length = glm::length(step);
    const double range = glm::length(p2);
    const double cosOut = glm::dot(n1, step) / length;
    const double cosIn = -glm::dot(n2, step) / length;
    const double cosBack = -glm::dot(n2, p2) / range;
    const double form =
      cosOut * cosIn * range * range * coneAngle / (Pi * length * length * cosBack);
    EXPECT_EQ(form > 1.0, capped);
    const double energy =
      1.8e-4 * 0.2 * std::min(1.0, form) * 0.5 * cosBack * aperture / (Pi * range * range);
    EXPECT_NEAR(throughApertureEnergy(p1, n1, p2, n2, aperture), energy, 1e-9 * energy);
    // Rough surfaces: P1 and P2 send more than Lambert's there, or less.
    const auto unlikeLambert = [](const Vec3& in, const Vec3& out, const Vec3& normal)
    {
      return reflectance(ReflectanceModel::OrenNayar, { 1.0, 0.0, 0.0, 0.8 },
               reflectionGeometry(in, out, normal))
               .diffuse /
        -glm::dot(in, normal);
    };
    const double first = unlikeLambert(glm::normalize(p1), step / length, n1);
    const double second = unlikeLambert(step / length, -p2 / range, n2);
    const double rough = energy * first * second;
    EXPECT_NEAR(throughApertureEnergy(p1, n1, p2, n2, aperture, 0.8), rough, 1e-9 * rough);
  }
}
