// SPDX-License-Identifier: BSD-3-Clause
// Effective areas against an image of each object, and what follows for its detection.
#include "BirdTestScene.h"
#include "BirdViews.h"
#include "DetectionLaw.h"
#include "Search905.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

using namespace birdtest;
using statistics::meanOf;

namespace
{
constexpr int Headings = 24; // of a whole turn

/// Probability that one beam of Search905 detects a gull `range` m away, for each wing phase and
/// heading, seen from `elevation` degrees below. Daylight, air of 8.9e-5/m, reflectance 0.3; the
/// gull is a point that shows its effective area.
std::vector<double> detectionByPose(double range, double elevation, bool gliding)
{
  const Sensor sensor = echotest::search905();
  const DetectionLaw law(sensor, viewsOf({ Silhouette() }));
  const double up = -std::sin(elevation * Pi / 180.0);
  const double side = std::sqrt(1.0 - up * up);
  const int phases = gliding ? 1 : 24;
  std::vector<double> found;
  for (int phase = 0; phase < phases; ++phase)
  {
    const auto bird = wholeBird(HerringGull, wingAngle((phase + 0.5) / phases, gliding));
    for (int heading = 0; heading < Headings; ++heading)
    {
      const double angle = 2.0 * Pi * (heading + 0.5) / Headings;
      const double area =
        effectiveArea(bird, Vec3(-side * std::sin(angle), -side * std::cos(angle), -up));
      found.push_back(law.probability(energyFromTarget(sensor, range, area, 0.3, 8.9e-5), 1));
    }
  }
  return found;
}

}

TEST(EffectiveArea, OfNothingAndOfALineIsZero)
{
  EXPECT_EQ(effectiveArea(TriangleMesh(), Vec3(1.0, 0.0, 0.0)), 0.0);
  TriangleMesh line;
  line.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 2, 0, 0 } };
  line.triangles = { { 0, 1, 2 } };
  EXPECT_EQ(effectiveArea(line, Vec3(1.0, 0.0, 0.0)), 0.0);
  EXPECT_EQ(effectiveArea(line, Vec3(0.0, 0.0, 1.0)), 0.0);
}

TEST(EffectiveArea, OfABirdIsThatOfAnImage)
{
  constexpr double pixel = 0.002; // m
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int k = 0; k < 12; ++k)
  {
    const auto bird = wholeBird(HerringGull, 0.6 * uniform(random));
    const Vec3 d = glm::normalize(Vec3(uniform(random), uniform(random), 0.3 * uniform(random)));
    double wanted = 0.0; // silhouette weighted by the cosine of incidence
    for (const Pixel& seen : imageOf(bird, d, pixel))
    {
      wanted += seen.cosine * pixel * pixel;
    }
    EXPECT_NEAR(effectiveArea(bird, d), wanted, 0.01 * wanted + 1e-5);
  }
}

TEST(EffectiveArea, OfABirdThatHasNoneIsNoNumber)
{
  BirdShape none = HerringGull;
  none.wingLength = NAN;
  EXPECT_TRUE(std::isnan(meanEffectiveArea(none, false)));
}

// The numbers of both tests stand in Documentation/guide/coverage.md.
TEST(EffectiveArea, OfOneBirdForTwoSensorsIsNotIndependent)
{
  // What two sensors detect together, less what two independent ones would, by the angle between
  // their lines of sight in steps of 15 degrees.
  const auto moreThanStated = [](double range, bool gliding)
  {
    const std::vector<double> p = detectionByPose(range, 3.0, gliding);
    const double missedByOne = 1.0 - meanOf(p);
    std::vector<double> more;
    for (std::size_t turn = 0; turn <= Headings / 2; ++turn)
    {
      double missed = 0.0;
      for (std::size_t i = 0; i < p.size(); ++i)
      {
        const std::size_t other = i - i % Headings + (i + turn) % Headings;
        missed += (1.0 - p[i]) * (1.0 - p[other]) / static_cast<double>(p.size());
      }
      more.push_back(missedByOne * missedByOne - missed);
      std::printf("%s gull at %.0f m, %3zu degrees apart: %+.3f of %.3f\n",
        gliding ? "gliding" : "flapping", range, 15 * turn, more.back(),
        1.0 - missedByOne * missedByOne);
    }
    return more;
  };
  const std::vector<double> flapping = moreThanStated(550.0, false);
  EXPECT_NEAR(flapping.front(), -0.18, 0.01);
  EXPECT_NEAR(flapping[Headings / 8], -0.01, 0.01);
  EXPECT_NEAR(flapping[Headings / 4], 0.09, 0.01);
  EXPECT_NEAR(flapping.back(), -0.18, 0.01);
  EXPECT_NEAR(moreThanStated(500.0, true)[Headings / 4], 0.15, 0.01);
}

TEST(EffectiveArea, FromOtherElevationsChangesTheProbability)
{
  for (const bool gliding : { false, true })
  {
    double low = 0.0;
    double high = 0.0;
    for (const double range : { 450.0, 500.0, 550.0 })
    {
      const double usual = meanOf(detectionByPose(range, 3.0, gliding));
      const double level = meanOf(detectionByPose(range, 0.0, gliding)) - usual;
      const double below = meanOf(detectionByPose(range, 5.0, gliding)) - usual;
      std::printf("%s gull at %.0f m: %.3f from 3 degrees, %+.3f from 0, %+.3f from 5\n",
        gliding ? "gliding" : "flapping", range, usual, level, below);
      low = std::min(low, level);
      high = std::max(high, below);
    }
    EXPECT_NEAR(low, gliding ? -0.04 : -0.02, 0.006);
    EXPECT_NEAR(high, gliding ? 0.05 : 0.03, 0.006);
  }
}
