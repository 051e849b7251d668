// SPDX-License-Identifier: BSD-3-Clause
// Which path put how much into which range units: shares add up to their units.
#include "RandomContributions.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

using namespace avianlidar;
using echotest::nanosecond;
using echotest::randomContributions;

TEST(RangeShares, ADeltaPulseHasOne)
{
  RangeUnitAccumulator accumulator(nanosecond, 0.0, 1000.0);
  accumulator.add({ 200.0, 3.0 });
  accumulator.accumulate();
  const RangeShares shares = accumulator.sharesOf(667, 668);
  ASSERT_EQ(shares.count, 1u);
  EXPECT_EQ(shares.contribution[0], 0u);
  EXPECT_EQ(shares.energies[0], 3.0);
  accumulator.clear();
  EXPECT_EQ(accumulator.sharesOf(667, 668).count, 0u);
}

TEST(RangeShares, AddUpToTheirUnits)
{
  // Pulses narrower than a unit, wider, and as wide as many; more units than requests that look at
  // every path.
  for (const double width : { 0.0, 0.6, 1.0, 2.5, 40.0 })
  {
    RangeUnitAccumulator accumulator(nanosecond, width * nanosecond, 4000.0);
    std::map<std::uint32_t, double> ofPath; // contributions are those of the list, in its order
    const auto list = randomContributions(200, 0.0, 25.0);
    for (const Contribution& c : list)
    {
      accumulator.add(c);
    }
    accumulator.accumulate();
    ASSERT_GT(accumulator.units().size(), 20u);
    for (const RangeUnit& unit : accumulator.units())
    {
      const RangeShares shares = accumulator.sharesOf(unit.index, unit.index + 1);
      EXPECT_EQ(shares.count, unit.paths);
      double sum = 0.0;
      double moment = 0.0;
      for (std::size_t s = 0; s < shares.count; ++s)
      {
        const std::uint32_t c = shares.contribution[s];
        EXPECT_GT(shares.energies[s], 0.0);
        EXPECT_TRUE(s == 0 || shares.contribution[s - 1] < c);
        sum += shares.energies[s];
        moment += shares.energies[s] * list[c].pathLength;
        ofPath[c] += shares.energies[s];
      }
      EXPECT_NEAR(sum / unit.energy, 1.0, 1e-14) << width;
      const WeightedSum sums = sumShares(
        shares, [&](std::size_t s) { return accumulator.pathLengths()[shares.contribution[s]]; });
      EXPECT_EQ(sums.energy, sum);
      EXPECT_EQ(sums.moment, moment);
    }
    for (std::size_t c = 0; c < list.size(); ++c)
    {
      EXPECT_NEAR(ofPath[c], list[c].energy, 1e-20) << width;
    }
    // All units but the first three, at once.
    const std::int64_t third = accumulator.units()[3].index;
    const RangeShares rest = accumulator.sharesOf(third, accumulator.units().back().index + 1);
    double expected = 0.0;
    for (std::size_t u = 3; u < accumulator.units().size(); ++u)
    {
      expected += accumulator.units()[u].energy;
    }
    EXPECT_NEAR(sumShares(rest, [](std::size_t) { return 1.0; }).energy / expected, 1.0, 1e-13);
  }
}
