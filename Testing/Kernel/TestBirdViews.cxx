// SPDX-License-Identifier: BSD-3-Clause
// Views of birds against effective areas and probabilities of poses drawn at random.
#include "BirdTestScene.h"
#include "BirdViews.h"
#include "Search905.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

using namespace birdtest;

namespace
{
double meanArea(const TargetPoses& poses)
{
  return std::accumulate(poses.begin(), poses.end(), 0.0,
           [](double sum, const Silhouette& pose) { return sum + pose.all().area; }) /
    static_cast<double>(poses.size());
}
}

TEST(BirdViews, HaveTheMeanAreaOfTheBird)
{
  for (const bool gliding : { false, true })
  {
    const double area = meanEffectiveArea(HerringGull, gliding);
    const TargetViews views = birdViews(HerringGull, gliding, area);
    EXPECT_NEAR(meanArea(*views.from(3.0 * Pi / 180.0)), 1.0, 0.015);
    // A larger bird shows the same of its area.
    const BirdShape large = HerringGull.scaled(2.0);
    EXPECT_NEAR(meanEffectiveArea(large, gliding), 4.0 * area, 1e-6 * area);
    EXPECT_NEAR(
      meanArea(*birdViews(large, gliding, 4.0 * area).from(0.2)), meanArea(*views.from(0.2)), 1e-5);
  }
}

TEST(BirdViews, NothingLiesBeyondTheirReach)
{
  for (const double size : { 0.3, 1.0 })
  {
    const TargetViews views = birdViews(HerringGull.scaled(size), false, 1.0);
    for (const double elevation : { -1.57, -0.3, 0.0, 0.4, 1.57 })
    {
      const TargetPoses poses = *views.from(elevation);
      EXPECT_EQ(poses.size(), BirdHeadings * BirdPhases);
      for (const Silhouette& pose : poses)
      {
        EXPECT_LE(pose.reach(), views.reach);
        EXPECT_GT(pose.all().area, 0.0);
      }
    }
  }
}

TEST(BirdViews, APoseIsSeenFromTheSideThatItsHeadingSays)
{
  // A bird that heads to the right of the line of sight has its body across: it reaches as far as
  // from the left, and is the mirror image.
  const TargetPoses poses = *birdViews(HerringGull, true, 1.0).from(0.1);
  const std::size_t n = GlidingHeadings;
  for (std::size_t k = 0; k < n; ++k)
  {
    const BeamAtTarget right{ 0.2, 0.3, 0.0 };
    const BeamAtTarget left{ 0.2, -0.3, 0.0 };
    EXPECT_NEAR(poses[k].litBy(right).area, poses[n - 1 - k].litBy(left).area, 1e-4);
  }
}

TEST(BirdViews, HaveTheProbabilitiesOfPosesDrawnAtRandom)
{
  const Sensor sensor = echotest::search905();
  const double mean = meanEffectiveArea(HerringGull, false);
  const TargetViews views = birdViews(HerringGull, false, mean);
  const DetectionLaw law(sensor, views, 0.0, 0.2, 1);
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (const double elevation : { 0.0, 0.05, 0.12 })
  {
    TargetPoses drawn;
    for (int i = 0; i < 1500; ++i)
    {
      const double heading = 2.0 * Pi * uniform(random);
      drawn.emplace_back(wholeBird(HerringGull, wingAngle(uniform(random), false)),
        Vec3(std::cos(elevation) * std::sin(heading), std::cos(elevation) * std::cos(heading),
          std::sin(elevation)),
        mean);
    }
    const DetectionLaw ofDrawn(sensor, viewsOf(drawn, views.reach), 0.0, 0.0, 1);
    for (const double range : { 350.0, 450.0, 550.0, 650.0 })
    {
      const double energy = energyFromTarget(sensor, range, mean, 0.3, 8.9e-5);
      const double wanted = ofDrawn.probability(energy, 1);
      const double found = law.probability(energy, 1, law.betweenAt(elevation));
      EXPECT_NEAR(found, wanted, 0.03) << range << " m, " << elevation; // by chance: 0.012
      // Narrow beams.
      const BeamAtTarget beam{ 0.1, 0.05, 0.05 };
      EXPECT_NEAR(law.probability(energy, 1.0, &beam, 1, law.betweenAt(elevation)),
        ofDrawn.probability(energy, 1.0, &beam, 1), 0.05)
        << range << " m, " << elevation;
    }
  }
}
