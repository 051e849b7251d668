// SPDX-License-Identifier: BSD-3-Clause
// Means and standard errors against their formulas and repeated draws, and strike heights.
#include "CoverageShares.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

using namespace avianlidar;

TEST(CoverageShares, OfEqualWeightsAreTheUsualMeanAndError)
{
  WeightedMean mean;
  for (const double v : { 1.0, 2.0, 4.0, 9.0 })
  {
    mean.add(2.0, v);
  }
  EXPECT_DOUBLE_EQ(mean.mean(), 4.0);
  // Variance of a sample: (9 + 4 + 0 + 25)/3.
  EXPECT_NEAR(mean.stdError(), std::sqrt(38.0 / 3.0 / 4.0), 1e-12);
  EXPECT_TRUE(std::isnan(WeightedMean().mean()));
  WeightedMean one;
  one.add(1.0, 0.5);
  EXPECT_EQ(one.mean(), 0.5);
  EXPECT_TRUE(std::isnan(one.stdError()));
}

TEST(CoverageShares, ErrorsOfWeightedMeansAreThoseOfRepeatedDraws)
{
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  statistics::Moments means;
  double errors = 0.0;
  constexpr int repeats = 2000;
  for (int r = 0; r < repeats; ++r)
  {
    WeightedMean mean;
    for (int i = 0; i < 200; ++i)
    {
      const double x = uniform(random);
      mean.add(0.2 + x, uniform(random) < x ? 1.0 : 0.0);
    }
    means.add(mean.mean());
    errors += mean.stdError();
  }
  const double spread = std::sqrt(means.variance());
  EXPECT_NEAR(means.mean(), (0.1 + 1.0 / 3.0) / 0.7, 0.003);
  EXPECT_NEAR(errors / repeats, spread, 0.06 * spread);
}

TEST(CoverageShares, StrikeHeightsAreDolbeers)
{
  constexpr double foot = 0.3048;
  double below = 0.0;
  double all = 0.0;
  double from1500 = 0.0; // feet, and the same 1,000 feet higher
  double from2500 = 0.0;
  for (double feet = 0.5; feet < 60000.0; feet += 1.0)
  {
    const double share = strikeHeightDensity(feet * foot) * foot;
    all += share;
    below += feet < 500.0 ? share : 0.0;
    from1500 += feet > 1500.0 && feet < 2500.0 ? share : 0.0;
    from2500 += feet > 2500.0 && feet < 3500.0 ? share : 0.0;
  }
  EXPECT_NEAR(all, 1.0, 1e-4);
  EXPECT_NEAR(below, 0.74, 1e-9);
  EXPECT_NEAR(from2500 / from1500, 0.68, 1e-6);
  EXPECT_EQ(strikeHeightDensity(-1.0), 0.0);
}
