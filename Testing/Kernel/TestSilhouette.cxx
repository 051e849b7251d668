// SPDX-License-Identifier: BSD-3-Clause
// Silhouettes against closed forms, exact effective areas, and rays cast one by one.
#include "BirdTestScene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace birdtest;

namespace
{
const Vec3 SeenAlong = glm::normalize(Vec3(0.6, 0.75, 0.1));
}

TEST(Silhouette, OfAPlateIsItsAreaTimesTheSquareOfTheCosine)
{
  for (const double slope : { 0.0, 0.5, 1.0 })
  {
    const double width = 0.8;
    const double height = 0.3;
    const Silhouette shown(plateOfSlope(width, height, slope), Vec3(0.0, 1.0, 0.0), 2.0);
    const double cosine = 1.0 / std::sqrt(1.0 + slope * slope);
    EXPECT_NEAR(shown.all().area, 0.5 * width * height * cosine, 2e-3 * width * height);
    EXPECT_NEAR(shown.all().depth, 0.0, 2e-3);
    EXPECT_NEAR(shown.all().spread, slope * width / std::sqrt(12.0), 2e-3);
    EXPECT_NEAR(shown.reach(), 0.5 * std::hypot(width, height), 1e-12);
    // A beam that the plate fills, and one that sees its right end alone.
    const LitPart filled = shown.litBy({ 0.1, 0.05, 0.0 });
    EXPECT_NEAR(filled.area, 0.5 * Pi * 0.01 * cosine, 0.02 * Pi * 0.01);
    EXPECT_NEAR(filled.depth, slope * 0.05, 2e-3);
    EXPECT_NEAR(filled.spread, slope * 0.05, 4e-3);
    EXPECT_NEAR(shown.litBy({ 0.5, 0.8, 0.0 }).depth, slope * 0.35, 0.01 + 0.02 * slope);
    EXPECT_EQ(shown.litBy({ 0.5, 1.0, 0.0 }).area, 0.0);
  }
}

TEST(Silhouette, OfBirdsIsTheirEffectiveArea)
{
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  double sum = 0.0;
  for (int k = 0; k < 30; ++k)
  {
    const TriangleMesh bird = wholeBird(HerringGull, 0.6 * uniform(random));
    const Vec3 d = glm::normalize(Vec3(uniform(random), uniform(random), 0.2 * uniform(random)));
    const double wanted = effectiveArea(bird, d);
    const double found = Silhouette(bird, d, 1.0).all().area;
    EXPECT_NEAR(found, wanted, 0.02 * wanted + 5e-5);
    sum += found / wanted / 30.0;
  }
  EXPECT_NEAR(sum, 1.0, 4e-3);
}

TEST(Silhouette, ABeamLightsWhatRaysInItMeet)
{
  const TriangleMesh bird = wholeBird(HerringGull, 0.3);
  const Silhouette shown(bird, SeenAlong, 1.0);
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  constexpr double step = 0.004;
  const std::vector<Pixel> rays = imageOf(bird, SeenAlong, step);
  struct Shape
  {
    double ratio; ///< ratio of the sides
    bool isRectangle;
    BeamProfile profile;
    double truncation;
  };
  for (const Shape& shape : { Shape{ 1.0, false, BeamProfile::Uniform, 1.0 },
         { 1.0, false, BeamProfile::Gaussian, 1.0 }, { 1.0, false, BeamProfile::Gaussian, 2.0 },
         { 0.3, false, BeamProfile::Uniform, 1.0 }, { 0.3, false, BeamProfile::Gaussian, 1.5 },
         { 0.4, true, BeamProfile::Uniform, 1.0 }, { 0.4, true, BeamProfile::Gaussian, 1.0 } })
  {
    for (const double radius : { 0.03, 0.08, 0.2, 0.6, 2.0 })
    {
      if (radius * shape.ratio < 0.02)
      {
        continue;
      }
      double bias = 0.0;
      constexpr int Beams = 40;
      for (int k = 0; k < Beams; ++k)
      {
        const double away = std::min(0.5, radius + 0.1) * uniform(random);
        const double angle = 2.0 * Pi * uniform(random);
        const double turn = 2.0 * Pi * uniform(random);
        BeamAtTarget beam{ radius, away * std::cos(angle), away * std::sin(angle), shape.profile };
        beam.across = shape.ratio * radius;
        beam.cosine = std::cos(turn);
        beam.sine = std::sin(turn);
        beam.isRectangle = shape.isRectangle;
        const double fall = 2.0 * shape.truncation * shape.truncation;
        const double side = std::sqrt(fall); // of exp(-side^2 u^2), u from -1 to 1
        const double mean = shape.isRectangle
          ? std::pow(0.5 * std::sqrt(Pi) * std::erf(side) / side, 2)
          : -std::expm1(-fall) / fall;
        beam.fall = fall;
        beam.most = 1.0 / mean;
        const bool isUniform = shape.profile == BeamProfile::Uniform;
        double area = 0.0;
        double depth = 0.0;
        for (const Pixel& ray : rays)
        {
          const double x = ray.x - beam.x;
          const double y = ray.y - beam.y;
          const double u = (std::cos(turn) * x + std::sin(turn) * y) / radius;
          const double v = (std::cos(turn) * y - std::sin(turn) * x) / (shape.ratio * radius);
          const double light =
            shape.profile == BeamProfile::Gaussian ? std::exp(-fall * (u * u + v * v)) / mean : 1.0;
          const bool isLit =
            shape.isRectangle ? std::max(std::fabs(u), std::fabs(v)) < 1.0 : u * u + v * v < 1.0;
          const double lit = isLit ? step * step * ray.cosine * light : 0.0;
          area += lit;
          depth += lit * ray.depth;
        }
        const LitPart lit = shown.litBy(beam);
        const double scale = (isUniform ? 1.0 : std::max(1.0, 0.5 * beam.most)) *
          std::min(
            (shape.isRectangle ? 4.0 : Pi) * shape.ratio * radius * radius, shown.all().area);
        EXPECT_NEAR(lit.area, area, 0.12 * scale) << radius;
        if (area > 0.2 * scale)
        {
          EXPECT_NEAR(lit.depth, depth / area, 0.03) << radius;
        }
        bias += (lit.area - area) / scale / Beams;
      }
      EXPECT_NEAR(bias, 0.0, 0.03) << radius;
    }
  }
}

TEST(Silhouette, OfAPointIsInOrOut)
{
  const Silhouette point(0.7);
  EXPECT_EQ(point.litBy({ 1.0, 0.99, 0.0 }).area, 0.7);
  EXPECT_EQ(point.litBy({ 1.0, 0.0, 1.01 }).area, 0.0);
  EXPECT_NEAR(point.litBy({ 1.0, 0.0, 0.0, BeamProfile::Gaussian }).area,
    0.7 * 2.0 / -std::expm1(-2.0), 1e-12);
  EXPECT_EQ(point.reach(), 0.0);
}

TEST(Silhouette, OfNothingAndOfBeamsBeyondMeasure)
{
  EXPECT_EQ(Silhouette(TriangleMesh(), SeenAlong, 1.0).all().area, 0.0);
  TriangleMesh none = plateOfSlope(1.0, 1.0, 0.0);
  none.points[0].x = NAN;
  EXPECT_FALSE(Silhouette(none, SeenAlong, 1.0).all().area > 0.0);
  const Silhouette shown(plateOfSlope(1.0, 1.0, 0.0), Vec3(0.0, 1.0, 0.0), 1.0);
  EXPECT_NEAR(shown.litBy({ 1e12, 0.0, 0.0 }).area, 1.0, 1e-2);
  EXPECT_EQ(shown.litBy({ 1e-3, 1e15, -1e15 }).area, 0.0);
  EXPECT_NEAR(shown.litBy({ 1e-6, 0.0, 0.0 }).area, Pi * 1e-12, 0.05 * Pi * 1e-12);
}
