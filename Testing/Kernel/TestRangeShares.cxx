// SPDX-License-Identifier: BSD-3-Clause
// Which path put how much into which range units: shares add up to their units, and are the same
// bits however and however often they are asked for.
#include "LaneSums.h"
#include "RandomContributions.h"

#include <gtest/gtest.h>

#include <map>
#include <vector>

using namespace avianlidar;
using echotest::nanosecond;
using echotest::randomContributions;

namespace
{
struct Share
{
  double energy;
  double pathLength;
  std::uint32_t contribution;
};

/// What is not nothing.
std::vector<Share> sharesOf(
  RangeUnitAccumulator& accumulator, std::int64_t first, std::int64_t last)
{
  const RangeShares shares = accumulator.sharesOf(first, last);
  std::vector<Share> list;
  for (std::size_t s = 0; s < shares.count; ++s)
  {
    const std::size_t c = shares.contribution(s);
    if (shares.energies[s] > 0.0)
    {
      list.push_back(
        { shares.energies[s], accumulator.pathLengths()[c], static_cast<std::uint32_t>(c) });
    }
  }
  return list;
}
}

TEST(RangeShares, ADeltaPulseHasOne)
{
  RangeUnitAccumulator accumulator(nanosecond, 0.0, 1000.0);
  accumulator.add({ 200.0, 3.0 });
  accumulator.accumulate();
  const std::vector<Share> shares = sharesOf(accumulator, 667, 668);
  ASSERT_EQ(shares.size(), 1u);
  EXPECT_EQ(shares[0].contribution, 0u);
  EXPECT_EQ(shares[0].pathLength, 200.0);
  EXPECT_EQ(shares[0].energy, 3.0);
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
    std::vector<Share> shares;
    for (const RangeUnit& unit : accumulator.units())
    {
      shares = sharesOf(accumulator, unit.index, unit.index + 1);
      EXPECT_EQ(shares.size(), unit.paths);
      double sum = 0.0;
      for (std::size_t s = 0; s < shares.size(); ++s)
      {
        sum += shares[s].energy;
        ofPath[shares[s].contribution] += shares[s].energy;
        EXPECT_EQ(shares[s].pathLength, list[shares[s].contribution].pathLength);
        EXPECT_TRUE(s == 0 || shares[s - 1].contribution < shares[s].contribution);
      }
      EXPECT_NEAR(sum / unit.energy, 1.0, 1e-14) << width;
    }
    for (std::size_t c = 0; c < list.size(); ++c)
    {
      EXPECT_NEAR(ofPath[c], list[c].energy, 1e-20) << width;
    }
    // All units but the first three, at once.
    const std::int64_t third = accumulator.units()[3].index;
    shares = sharesOf(accumulator, third, accumulator.units().back().index + 1);
    double expected = 0.0;
    double sum = 0.0;
    for (std::size_t u = 3; u < accumulator.units().size(); ++u)
    {
      expected += accumulator.units()[u].energy;
    }
    for (const Share& share : shares)
    {
      sum += share.energy;
    }
    EXPECT_NEAR(sum / expected, 1.0, 1e-13) << width;
  }
}

class RangeSharesOfWidth : public testing::TestWithParam<double>
{
};
INSTANTIATE_TEST_SUITE_P(RangeShares, RangeSharesOfWidth, testing::Values(0.0, 0.6, 1.0, 1.7));

TEST_P(RangeSharesOfWidth, AreTheSameHoweverOftenTheyAreAskedFor)
{
  RangeUnitAccumulator accumulator(nanosecond, GetParam() * nanosecond, 1000.0);
  for (const Contribution& c : randomContributions(300, 20.0, 60.0))
  {
    accumulator.add(c);
  }
  accumulator.accumulate();
  const std::int64_t middle = accumulator.units()[accumulator.units().size() / 2].index;
  std::vector<Share> first;
  std::vector<Share> again;
  first = sharesOf(accumulator, middle - 2, middle + 3);
  for (int i = 0; i < 20; ++i)
  {
    sharesOf(accumulator, middle, middle + 1 + i % 2); // something else, or the last are kept
    again = sharesOf(accumulator, middle - 2, middle + 3);
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t s = 0; s < first.size(); ++s)
    {
      EXPECT_EQ(first[s].energy, again[s].energy);
      EXPECT_EQ(first[s].contribution, again[s].contribution);
    }
  }
}

TEST_P(RangeSharesOfWidth, SumsAreTheSameBitsHoweverTheSharesAreGiven)
{
  RangeUnitAccumulator accumulator(nanosecond, GetParam() * nanosecond, 1000.0);
  for (const Contribution& c : randomContributions(301, 20.0, 60.0))
  {
    accumulator.add(c);
  }
  accumulator.accumulate();
  const std::int64_t middle = accumulator.units()[accumulator.units().size() / 2].index;
  const double* const values = accumulator.pathLengths().data();
  const RangeShares all = accumulator.sharesOf(middle - 9, middle + 9);
  ASSERT_EQ(all.which, nullptr);
  const WeightedSum sum = sumShares(all, values, 30.0);
  const double rest = sumSharesFrom(all, 150);
  double energy = 0.0;
  double moment = 0.0;
  double energyOfRest = 0.0;
  for (std::size_t c = 0; c < all.count; ++c)
  {
    energy += all.energies[c];
    moment += all.energies[c] * (values[c] - 30.0);
    energyOfRest += c >= 150 ? all.energies[c] : 0.0;
  }
  EXPECT_NEAR(sum.energy / energy, 1.0, 1e-14);
  EXPECT_NEAR(sum.moment / moment, 1.0, 1e-12);
  EXPECT_NEAR(rest / energyOfRest, 1.0, 1e-14);
  for (int i = 0; i < 20; ++i)
  {
    accumulator.sharesOf(middle, middle + 1 + i % 2);
  }
  const RangeShares few = accumulator.sharesOf(middle - 9, middle + 9);
  ASSERT_NE(few.which, nullptr);
  EXPECT_EQ(sumShares(few, values, 30.0).energy, sum.energy);
  EXPECT_EQ(sumShares(few, values, 30.0).moment, sum.moment);
  EXPECT_EQ(sumSharesFrom(few, 150), rest);
}
