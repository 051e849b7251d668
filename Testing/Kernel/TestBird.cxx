// SPDX-License-Identifier: BSD-3-Clause
// Birds: closed surfaces, effective areas of body and wings alone against integrals over the ideal
// shapes, birds before walls, and tables of species. Areas of whole birds are TestEffectiveArea's,
// what a lidar receives of them is TestMovedBeams'.
#include "BirdTestScene.h"
#include "EchoTestScene.h"
#include "GeometryTestScene.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <map>

using namespace birdtest;
using namespace echotest;
using geometrytest::Numbers;

namespace
{
const BirdPart Parts[] = { BirdPart::Body, BirdPart::LeftWing, BirdPart::RightWing };

/// Silhouette weighted by the cosine of incidence, of a convex mesh seen from a direction, m^2.
double convexArea(const TriangleMesh& mesh, const Vec3& towards)
{
  double sum = 0.0;
  for (std::uint32_t t = 0; t < mesh.size(); ++t)
  {
    const Vec3 n = 0.5 *
      glm::cross(mesh.corner(t, 1) - mesh.corner(t, 0), mesh.corner(t, 2) - mesh.corner(t, 0));
    const double seen = glm::dot(n, towards);
    sum += seen > 0.0 ? seen * seen / glm::length(n) : 0.0;
  }
  return sum;
}

/// The same of an ellipsoid of revolution about y, by the midpoint rule.
double ellipsoidArea(double diameter, double length, const Vec3& towards)
{
  const double b = 0.5 * diameter;
  const double a = 0.5 * length;
  constexpr int n = 400;
  double sum = 0.0;
  for (int i = 0; i < n; ++i)
  {
    const double u = Pi * (i + 0.5) / n;
    for (int k = 0; k < n; ++k)
    {
      const double v = 2.0 * Pi * (k + 0.5) / n;
      // Normal times area of the element.
      const Vec3 normal = std::sin(u) *
        Vec3(a * b * std::sin(u) * std::cos(v), b * b * std::cos(u),
          a * b * std::sin(u) * std::sin(v));
      const double seen = glm::dot(normal, towards);
      sum += seen > 0.0 ? seen * seen / glm::length(normal) : 0.0;
    }
  }
  return sum * Pi / n * 2.0 * Pi / n;
}
}

TEST(Bird, PartsAreClosedAndTurnedOutwards)
{
  for (const BirdSpecies& species : shippedSpecies())
  {
    EXPECT_EQ(wholeBird(BirdShape(species), 0.0).size(), 72u);
    for (const BirdPart part : Parts)
    {
      const TriangleMesh mesh = birdPart(BirdShape(species), part, wingAngle(0.2, false));
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
      double volume = 0.0;
      for (std::uint32_t t = 0; t < mesh.size(); ++t)
      {
        volume +=
          glm::dot(mesh.corner(t, 0), glm::cross(mesh.corner(t, 1), mesh.corner(t, 2))) / 6.0;
        for (int c = 0; c < 3; ++c)
        {
          ++edges[{ mesh.triangles[t][c], mesh.triangles[t][(c + 1) % 3] }];
        }
      }
      for (const auto& [edge, count] : edges)
      {
        EXPECT_EQ(count, 1);
        EXPECT_EQ((edges.count({ edge.second, edge.first })), 1u);
      }
      const BirdShape shape(species);
      const double expected = part == BirdPart::Body
        ? Pi / 6.0 * shape.bodyDiameter * shape.bodyDiameter * shape.bodyLength
        : shape.wingLength * shape.wingChord * shape.wingThickness;
      EXPECT_NEAR(volume / expected, 1.0, part == BirdPart::Body ? 0.1 : 1e-9);
    }
  }
}

TEST(Bird, HasTheFrontalAreaOfItsFormula)
{
  const std::map<std::string, double> areas = { { "starling", 0.0027 }, { "kestrel", 0.0027 },
    { "pigeon", 0.0040 }, { "crow", 0.0079 }, { "herring gull", 0.0079 },
    { "Canada goose", 0.0211 } };
  const auto all = shippedSpecies();
  EXPECT_EQ(all.size(), 6u);
  for (const BirdSpecies& species : all)
  {
    const double d = BirdShape(species).bodyDiameter;
    EXPECT_NEAR(0.25 * Pi * d * d, areas.at(species.name), 5.1e-5) << species.name;
  }
}

TEST(Bird, BodyHasTheEffectiveAreaOfAnEllipsoid)
{
  Numbers random(1);
  for (const BirdSpecies& species : shippedSpecies())
  {
    const BirdShape shape(species);
    const TriangleMesh mesh = birdPart(shape, BirdPart::Body, 0.0);
    for (int k = 0; k < 20; ++k)
    {
      const Vec3 towards =
        unitVector(Vec3(random(-1.0, 1.0), random(-1.0, 1.0), random(-1.0, 1.0)));
      EXPECT_NEAR(
        convexArea(mesh, towards) / ellipsoidArea(shape.bodyDiameter, shape.bodyLength, towards),
        1.0, 1e-4)
        << species.name;
    }
  }
}

TEST(Bird, WingsHaveTheEffectiveAreaOfPlates)
{
  // Their edges add a little where a plate is seen at a grazing angle.
  Numbers random(2);
  for (const BirdSpecies& species : shippedSpecies())
  {
    const BirdShape shape(species);
    const double plate = shape.wingLength * shape.wingChord;
    EXPECT_NEAR(2.0 * plate, 0.85 * species.wingArea, 1e-12);
    double meshes = 0.0;
    double plates = 0.0;
    for (int k = 0; k < 2000; ++k)
    {
      const double angle = wingAngle(random(0.0, 1.0), false);
      const double yaw = random(0.0, 2.0 * Pi); // 3 degrees below the bird's plane
      const Vec3 towards(std::cos(3.0 * Degree) * std::cos(yaw),
        std::cos(3.0 * Degree) * std::sin(yaw), -std::sin(3.0 * Degree));
      for (const double side : { -1.0, 1.0 })
      {
        // Turned by the angle of attack about x, then by that of the wing about y.
        const double attack = 6.0 * Degree;
        const Vec3 normal(-side * std::sin(angle) * std::cos(attack), -std::sin(attack),
          std::cos(angle) * std::cos(attack));
        const double cosine = glm::dot(normal, towards);
        plates += plate * cosine * cosine;
        meshes += convexArea(
          birdPart(shape, side < 0.0 ? BirdPart::LeftWing : BirdPart::RightWing, angle), towards);
      }
    }
    EXPECT_NEAR(meshes / plates, 1.0, 0.01) << species.name;
    EXPECT_GT(meshes, plates);
  }
}

// From a share of the beam of 1e-5 on, before a wall of so many parts that the beam is divided into
// cells, or its rays go through the tree. Alone it is integrated. The wall is turned, as cells are
// finer about the middle of a lobe.
class BirdBeforeAWall : public testing::TestWithParam<int>
{
};
INSTANTIATE_TEST_SUITE_P(Parts, BirdBeforeAWall, testing::Values(12, 50));
TEST_P(BirdBeforeAWall, IsFoundWithItsArea)
{
  Numbers random(23);
  const Sensor sensor = openSensor();
  const double tangent = std::tan(sensor.halfBeamwidth);
  const Material black{ 0.0, 0.0, 1.0 };
  int all = 0;
  int off = 0;
  double squares = 0.0;
  for (const BirdSpecies& species : shippedSpecies())
  {
    const BirdShape shape(species);
    for (int k = 0; k < 60; ++k)
    {
      const double share = std::pow(10.0, random(-5.0, -2.0));
      const double silhouette = 0.25 * Pi * shape.bodyDiameter * shape.bodyLength;
      const double range = std::sqrt(silhouette / (Pi * share)) / tangent;
      const double across = tangent * range;
      const TriangleMesh bird = wholeBird(shape, wingAngle(random(0.0, 1.0), false));
      const double heading = random(0.0, 2.0 * Pi);
      const Vec3 ahead(std::cos(heading), std::sin(heading), 0.0);
      const Vec3 aside(-ahead.y, ahead.x, 0.0);
      const double place = random(0.0, 2.0 * Pi);
      const double away = std::sqrt(random(0.0, 0.95)) * across;
      const Vec3 at(range, away * std::cos(place), away * std::sin(place));
      Scene alone;
      for (std::uint32_t t = 0; t < bird.size(); ++t)
      {
        const auto corner = [&](int c)
        {
          const Vec3 p = bird.corner(t, c);
          return at + p.x * aside + p.y * ahead + p.z * Vec3(0.0, 0.0, 1.0);
        };
        alone.triangle(corner(0), corner(1), corner(2), { 0.5, 0.0, 1.0 }, 7);
      }
      Scene scene = copyOf(alone);
      const int parts = GetParam();
      for (int i = 0; i < parts * parts; ++i)
      {
        const double half = 2.4 * across / parts;
        const Vec3 one = half * Vec3(0.4, 0.9, 0.1);
        const Vec3 two = half * Vec3(-0.2, 0.0, 1.0);
        scene.plate(Vec3(2.0 * range, 0.0, 0.0) + (2.0 * (i % parts) - parts + 1.0) * one +
            (2.0 * (i / parts) - parts + 1.0) * two,
          one, two, black, 1);
      }
      const double wanted = received(alone, sensor, inCells(100, k));
      const double found = received(scene, sensor, inCells(100, k));
      if (wanted >= 1e-5 * 0.5 * sensor.pulseEnergy)
      {
        EXPECT_GT(found, 0.0) << species.name << " " << share;
        ++all;
        off += std::fabs(found / wanted - 1.0) > 0.05 ? 1 : 0;
        squares += std::pow(found / wanted - 1.0, 2);
      }
    }
  }
  std::printf("birds: %.2f %% rms, %d of %d more than 5 %% off\n", 100.0 * std::sqrt(squares / all),
    off, all);
  EXPECT_GT(all, 300);
  EXPECT_LE(off, all / 200);
}

TEST(Bird, BeatsItsWingsAsPennycuickSays)
{
  for (const BirdSpecies& species : shippedSpecies())
  {
    if (species.name == "herring gull")
    {
      EXPECT_NEAR(wingbeatFrequency(species), 3.6, 0.1);
    }
  }
  EXPECT_DOUBLE_EQ(wingAngle(0.25, false), 35.0 * Degree);
  EXPECT_DOUBLE_EQ(wingAngle(0.75, false), -35.0 * Degree);
  EXPECT_DOUBLE_EQ(wingAngle(0.75, true), 5.0 * Degree);
}

TEST(Bird, TablesThatAreWrongSayWhere)
{
  const std::string header =
    "species,mass [kg],length [m],span [m],wing area [m2],passerine,airspeed [m/s]\n";
  const auto errorOf = [](const std::string& text)
  { return statistics::errorOf([&]() { readSpecies(text, "own.csv"); }); };
  EXPECT_EQ(errorOf(header + "\n# swifts\nswift,0.04,0.17,0.42,0.016,no,10\n"), "");
  EXPECT_EQ(errorOf("\xEF\xBB\xBF" + header + "swift,0.04,0.17,0.42,0.016,no,10\n"), "");
  const std::pair<std::string, std::string> cases[] = {
    { header, "own.csv: holds no species" },
    { "name\n", "own.csv: line 1: is not the header" },
    { header + "swift,0.04,0.17\n", "line 2: has 3 columns, expected 7" },
    { header + "swift,-1,0.17,0.42,0.016,no,10\n", "line 2: mass is '-1', expected 0.001 to 100" },
    { header + "swift,0.04,0.17,0.42,0.016,maybe,10\n",
      "passerine is 'maybe', expected yes or no" },
    { header + "swift,0.04,0.17,nan,0.016,no,10\n", "span is 'nan'" },
    { header + "swift,90,0.17,0.42,0.016,no,10\n", "smaller than the body" },
    { header + "swift,0.04,0.17,0.1,0.016,no,10\n", "broader than the bird" },
    { header + ",0.04,0.17,0.42,0.016,no,10\n", "no name" },
  };
  for (const auto& [text, message] : cases)
  {
    statistics::expectSays(errorOf(text), message);
  }
}
