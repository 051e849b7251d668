// SPDX-License-Identifier: BSD-3-Clause
// Range units: pulse overlap, sums unit by unit, shares of the paths, memory, and the gate.
#include "Memory.h"
#include "Random.h"
#include "RangeShares.h"
#include "Sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

using namespace avianlidar;

namespace
{
constexpr double nanosecond = 1e-9; // s

/// @param nearest, farthest m, of path lengths
std::vector<Contribution> randomContributions(std::size_t count, double nearest, double farthest)
{
  std::vector<Contribution> list;
  for (std::size_t n = 0; n < count; ++n)
  {
    const auto u = uniformPair(8, 0, n, RandomPurpose::Rays);
    list.push_back({ nearest + (farthest - nearest) * u[0], 1e-6 * u[1] });
  }
  return list;
}

double totalOf(const RangeUnitAccumulator& accumulator)
{
  double sum = accumulator.energyBeyondGate();
  for (const RangeUnit& unit : accumulator.units())
  {
    sum += unit.energy;
  }
  return sum;
}
}

TEST(RangeUnits, PulsesAreSummedUnitByUnitInTheirOrder)
{
  // Near together and far apart, so that the table of sums is moved on, across pulses and over
  // gaps. Added one by one, after other paths, and all at once.
  for (const double farthest : { 100.0, 4e3, 2e5 })
  {
    for (const double pulseWidth : { 0.0, 1.3e-9, 40e-9, 1000e-9 })
    {
      const double gate = 0.4 * farthest;
      const double width = pulseWidth / nanosecond;
      RangeUnitAccumulator accumulator(nanosecond, pulseWidth, gate);
      RangeUnitAccumulator atOnce(nanosecond, pulseWidth, gate);
      accumulator.add({ 1.0, 1.0 });
      accumulator.accumulate();
      accumulator.clear();
      std::vector<double> ranges;
      std::vector<double> energies;
      std::map<std::int64_t, double> sums;
      std::map<std::int64_t, std::uint32_t> paths;
      double beyond = 0.0;
      const double end = static_cast<double>(unitsInsideGate(nanosecond, gate));
      for (const Contribution& c : randomContributions(400, 0.0, farthest))
      {
        accumulator.add(c);
        ranges.push_back(0.5 * c.pathLength);
        energies.push_back(c.energy);
        const double delay = c.pathLength / (SpeedOfLight * nanosecond);
        const double begin = delay - 0.5 * width;
        const double pulse = (delay + 0.5 * width) - begin;
        const double first = std::max(0.0, std::floor(pulse > 0.0 ? begin : delay));
        const double last = pulse > 0.0 ? std::floor(delay + 0.5 * width) : first;
        double before = 0.0;
        const bool isLate = c.pathLength > 2.0 * gate;
        for (double unit = first; !isLate && unit <= last && unit < end; unit += 1.0)
        {
          const double after = unit < last ? (unit + 1.0 - begin) / pulse : 1.0;
          if (after > before)
          {
            sums[static_cast<std::int64_t>(unit)] += c.energy * (after - before);
            ++paths[static_cast<std::int64_t>(unit)];
          }
          before = after;
        }
        beyond += c.energy * (1.0 - before);
      }
      atOnce.add(ranges.data(), energies.data(), ranges.size());
      for (RangeUnitAccumulator* one : { &accumulator, &atOnce })
      {
        one->accumulate();
        ASSERT_EQ(one->units().size(), sums.size());
        EXPECT_NEAR(one->energyBeyondGate(), beyond, 1e-12 * beyond);
        auto expected = sums.begin();
        for (const RangeUnit& unit : one->units())
        {
          ASSERT_EQ(unit.index, expected->first);
          ASSERT_EQ(unit.energy, expected->second);
          ASSERT_EQ(unit.paths, paths[unit.index]);
          ++expected;
        }
      }
    }
  }
}

TEST(RangeUnits, TheStrongestUnitAroundAPathIsAmongThoseThatItMeets)
{
  RangeUnitAccumulator accumulator(nanosecond, 3.5e-9, 40.0);
  const std::vector<Contribution> all = randomContributions(60, 0.0, 100.0);
  for (const Contribution& c : all)
  {
    accumulator.add(c);
  }
  accumulator.accumulate();
  for (std::size_t n = 0; n < all.size(); ++n)
  {
    const double delay = all[n].pathLength / (SpeedOfLight * nanosecond);
    double most = 0.0; // 0 beyond the gate
    for (const RangeUnit& unit : accumulator.units())
    {
      const auto index = static_cast<double>(unit.index);
      const bool meets = index + 1.0 > delay - 1.75 && index <= delay + 1.75;
      most = meets ? std::max(most, unit.energy) : most;
    }
    EXPECT_EQ(accumulator.mostAround(n), most) << n;
  }
}

TEST(RangeUnits, MemoryOfWidePulsesFollowsTheUnitsThatTheyMeet)
{
  // Pulses that each meet a thousand units, 5000 of them in all: a list of what each of a million
  // puts where would take 48 GB.
  RangeUnitAccumulator accumulator(nanosecond, 1000.0 * nanosecond, 1000.0);
  constexpr std::size_t count = 100000;
  const auto list = randomContributions(count, 300.0, 1500.0);
  const std::size_t before = benchmarks::heapBytes();
  double sum = 0.0;
  for (const Contribution& c : list)
  {
    accumulator.add(c);
    sum += c.energy;
  }
  accumulator.accumulate();
  EXPECT_LT(benchmarks::heapBytes() - before, 200 * count);
  EXPECT_LT(accumulator.units().size(), 5100u);
  EXPECT_NEAR(totalOf(accumulator) / sum, 1.0, 1e-9);
}

TEST(RangeUnits, UnitsBeyondTheGateAreDropped)
{
  const double unit = 0.5 * SpeedOfLight * nanosecond;
  EXPECT_EQ(unitsInsideGate(nanosecond, 10.0 * unit), 10);
  EXPECT_EQ(unitsInsideGate(nanosecond, 10.2 * unit), 11);
  EXPECT_EQ(unitsInsideGate(1.0, 1e-3), 1);
  EXPECT_EQ(unitsInsideGate(5e-9, 4000.0), 5338);
  RangeUnitAccumulator accumulator(nanosecond, nanosecond, 10.0 * unit);
  EXPECT_EQ(accumulator.gateUnits(), 10);
  accumulator.add({ 2.0 * unit * 9.75, 4.0 });  // a quarter of its pulse beyond
  accumulator.add({ 2.0 * unit * 10.25, 8.0 }); // its range beyond, a quarter of its pulse before
  accumulator.add({ 2.0 * unit * 10.75, 1.0 }); // all of it
  accumulator.add({ 2.0 * unit * 1e30, 1.0 });  // farther than an integer can say
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 1u);
  EXPECT_EQ(accumulator.units()[0].index, 9);
  EXPECT_NEAR(accumulator.units()[0].energy, 3.0, 1e-12);
  EXPECT_NEAR(accumulator.energyBeyondGate(), 11.0, 1e-12);
}

TEST(RangeUnits, PathsBeforeTheGateAreDropped)
{
  RangeUnitAccumulator accumulator(nanosecond, nanosecond, 100.0, 2.0);
  const double ranges[] = { 1.9, 2.0, 5.0 };
  const double energies[] = { 7.0, 2.0, 1.0 };
  accumulator.add(ranges, energies, 3);
  accumulator.add({ 3.99, 4.0 });
  accumulator.accumulate();
  EXPECT_NEAR(totalOf(accumulator), 3.0, 1e-12);
  EXPECT_EQ(accumulator.energyBeforeGate(), 11.0);
  accumulator.clear();
  EXPECT_EQ(accumulator.energyBeforeGate(), 0.0);
  EXPECT_EQ(firstUnitInsideGate(5e-9, 0.7), 0);
  EXPECT_EQ(firstUnitInsideGate(5e-9, 0.8), 1);
}

TEST(RangeUnits, NothingAndZeroEnergyGiveNoUnit)
{
  RangeUnitAccumulator accumulator(nanosecond, nanosecond, 100.0);
  accumulator.accumulate();
  EXPECT_TRUE(accumulator.units().empty());
  accumulator.add({ 10.0, 0.0 });
  accumulator.accumulate();
  EXPECT_TRUE(accumulator.units().empty());
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
    ShareFinder finder;
    finder.begin(accumulator);
    ASSERT_GT(accumulator.units().size(), 20u);
    for (const RangeUnit& unit : accumulator.units())
    {
      const RangeShares shares = finder.sharesOf(unit.index, unit.index + 1);
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
    const RangeShares rest = finder.sharesOf(third, accumulator.units().back().index + 1);
    double expected = 0.0;
    for (std::size_t u = 3; u < accumulator.units().size(); ++u)
    {
      expected += accumulator.units()[u].energy;
    }
    EXPECT_NEAR(sumShares(rest, [](std::size_t) { return 1.0; }).energy / expected, 1.0, 1e-13);
  }
}
