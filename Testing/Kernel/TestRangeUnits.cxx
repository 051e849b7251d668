// SPDX-License-Identifier: BSD-3-Clause
// Range units: pulse overlap, conservation of energy, order of summation, and a waveform in closed
// form.
#include "Air.h"
#include "RandomContributions.h"
#include "Sensor.h"

#include <gtest/gtest.h>

#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <map>

using namespace avianlidar;
using echotest::nanosecond;
using echotest::randomContributions;

namespace
{
double energyOf(const RangeUnitAccumulator& accumulator, std::int64_t index)
{
  for (const RangeUnit& unit : accumulator.units())
  {
    if (unit.index == index)
    {
      return unit.energy;
    }
  }
  return 0.0;
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

/// Bytes handed out and not given back, also in large pieces; 0 where a sanitizer counts for
/// itself.
std::size_t heapInUse()
{
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}
}

TEST(RangeUnits, PulseCentredOnItsDelay)
{
  // r = 100 m, 2 r/c = 667.128 ns, units and pulse of 1 ns.
  RangeUnitAccumulator accumulator(nanosecond, nanosecond, 1000.0);
  accumulator.add({ 200.0, 1.0 });
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 2u);
  EXPECT_NEAR(energyOf(accumulator, 666), 0.3718096037, 1e-10);
  EXPECT_NEAR(energyOf(accumulator, 667), 0.6281903963, 1e-10);
  // A pulse that starts at the delay would be the same half a pulse later.
  accumulator.clear();
  accumulator.add({ 200.0 + 0.5 * nanosecond * SpeedOfLight, 1.0 });
  accumulator.accumulate();
  EXPECT_NEAR(energyOf(accumulator, 667), 0.8718096037, 1e-10);
  EXPECT_NEAR(energyOf(accumulator, 668), 0.1281903963, 1e-10);
}

TEST(RangeUnits, DeltaPulseFallsIntoOneUnit)
{
  RangeUnitAccumulator accumulator(nanosecond, 0.0, 1000.0);
  accumulator.add({ 200.0, 3.0 });
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 1u);
  EXPECT_EQ(accumulator.units()[0].index, 667);
  EXPECT_EQ(accumulator.units()[0].energy, 3.0);
}

TEST(RangeUnits, WidePulseIsFlat)
{
  RangeUnitAccumulator accumulator(nanosecond, 1000.0 * nanosecond, 1000.0);
  accumulator.add({ 1000.0, 1.0 });
  accumulator.accumulate();
  EXPECT_EQ(accumulator.units().size(), 1001u);
  EXPECT_NEAR(energyOf(accumulator, 3335), 1e-3, 1e-15);
  EXPECT_NEAR(energyOf(accumulator, 2900), 1e-3, 1e-15);
  EXPECT_NEAR(totalOf(accumulator), 1.0, 1e-14);
}

TEST(RangeUnits, EnergyIsConserved)
{
  for (const double width : { 0.0, 1e-15, 0.3, 1.0, 2.5, 77.0, 1000.0 })
  {
    for (const double gate : { 50.0, 4000.0 })
    {
      RangeUnitAccumulator accumulator(nanosecond, width * nanosecond, gate);
      double sum = 0.0;
      for (const Contribution& c : randomContributions(500, 0.0, 300.0))
      {
        accumulator.add(c);
        sum += c.energy;
      }
      accumulator.accumulate();
      EXPECT_NEAR(totalOf(accumulator) / sum, 1.0, 1e-13) << width << ' ' << gate;
      EXPECT_EQ(accumulator.energyBeyondGate() > 0.0, gate == 50.0);
    }
  }
}

TEST(RangeUnits, ManyPathsAtOnceAreTheSamePaths)
{
  RangeUnitAccumulator one(nanosecond, 0.8 * nanosecond, 1000.0);
  RangeUnitAccumulator many(nanosecond, 0.8 * nanosecond, 1000.0);
  std::vector<double> ranges;
  std::vector<double> energies;
  for (const Contribution& c : randomContributions(100, 20.0, 60.0))
  {
    one.add(c);
    ranges.push_back(0.5 * c.pathLength);
    energies.push_back(c.energy);
  }
  many.add(ranges.data(), energies.data(), ranges.size());
  one.accumulate();
  many.accumulate();
  ASSERT_EQ(one.units().size(), many.units().size());
  for (std::size_t u = 0; u < one.units().size(); ++u)
  {
    EXPECT_EQ(one.units()[u].energy, many.units()[u].energy);
  }
}

TEST(RangeUnits, WhatWasSummedBeforeChangesNoBitAndTheOrderRoundingAlone)
{
  // Near together (a table of units) and kilometres apart (sorting).
  for (const double farthest : { 60.0, 6e6 })
  {
    auto list = randomContributions(300, 50.0, farthest);
    RangeUnitAccumulator first(nanosecond, 1.7 * nanosecond, 1e7);
    RangeUnitAccumulator again(nanosecond, 1.7 * nanosecond, 1e7);
    RangeUnitAccumulator backward(nanosecond, 1.7 * nanosecond, 1e7);
    again.add({ 1.0, 1.0 }); // another beam before
    again.accumulate();
    again.clear();
    for (const Contribution& c : list)
    {
      first.add(c);
      again.add(c);
    }
    std::reverse(list.begin(), list.end());
    for (const Contribution& c : list)
    {
      backward.add(c);
    }
    first.accumulate();
    again.accumulate();
    backward.accumulate();
    ASSERT_EQ(first.units().size(), again.units().size());
    ASSERT_EQ(first.units().size(), backward.units().size());
    for (std::size_t u = 0; u < first.units().size(); ++u)
    {
      const double energy = first.units()[u].energy;
      EXPECT_EQ(first.units()[u].index, again.units()[u].index);
      EXPECT_EQ(first.units()[u].index, backward.units()[u].index);
      EXPECT_EQ(energy, again.units()[u].energy);
      EXPECT_NEAR(energy, backward.units()[u].energy, 1e-13 * energy);
      EXPECT_TRUE(u == 0 || first.units()[u - 1].index < first.units()[u].index);
    }
  }
}

TEST(RangeUnits, MemoryFollowsHitsNotRange)
{
  RangeUnitAccumulator accumulator(1e-15, 0.0, 1e9);
  accumulator.add({ 1.0, 1.0 });
  accumulator.add({ 1e9, 1.0 });
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 2u);
  EXPECT_EQ(accumulator.units()[1].index, static_cast<std::int64_t>(1e9 / (SpeedOfLight * 1e-15)));
}

TEST(RangeUnits, WidePulsesOverManyUnitsAreSummedInTheirOrder)
{
  // Near together and far apart, so that the table of sums is moved on, across pulses and over
  // gaps.
  for (const double farthest : { 100.0, 4e3, 2e5 })
  {
    for (const double pulseWidth : { 0.0, 1.3e-9, 40e-9, 1000e-9 })
    {
      const double gate = 0.4 * farthest;
      const double width = pulseWidth / nanosecond;
      RangeUnitAccumulator accumulator(nanosecond, pulseWidth, gate);
      std::map<std::int64_t, double> sums;
      std::map<std::int64_t, std::uint32_t> paths;
      double beyond = 0.0;
      const double end = static_cast<double>(unitsInsideGate(nanosecond, gate));
      for (const Contribution& c : randomContributions(400, 0.0, farthest))
      {
        accumulator.add(c);
        const double delay = c.pathLength / (SpeedOfLight * nanosecond);
        const double begin = delay - 0.5 * width;
        const double pulse = (delay + 0.5 * width) - begin;
        const double first = std::max(0.0, std::floor(pulse > 0.0 ? begin : delay));
        const double last = pulse > 0.0 ? std::floor(delay + 0.5 * width) : first;
        double before = 0.0;
        for (double unit = first; unit <= last && unit < end; unit += 1.0)
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
      accumulator.accumulate();
      ASSERT_EQ(accumulator.units().size(), sums.size());
      EXPECT_EQ(accumulator.energyBeyondGate(), beyond);
      auto expected = sums.begin();
      for (const RangeUnit& unit : accumulator.units())
      {
        ASSERT_EQ(unit.index, expected->first);
        ASSERT_EQ(unit.energy, expected->second);
        ASSERT_EQ(unit.paths, paths[unit.index]);
        ++expected;
      }
    }
  }
}

TEST(RangeUnits, MemoryOfWidePulsesFollowsTheUnitsThatTheyMeet)
{
  // Pulses that each meet a thousand units, 5000 of them in all: a list of what each of a million
  // puts where would take 48 GB.
  RangeUnitAccumulator accumulator(nanosecond, 1000.0 * nanosecond, 1000.0);
  constexpr std::size_t count = 100000;
  const auto list = randomContributions(count, 300.0, 1500.0);
  const std::size_t before = heapInUse();
  double sum = 0.0;
  for (const Contribution& c : list)
  {
    accumulator.add(c);
    sum += c.energy;
  }
  accumulator.accumulate();
  EXPECT_LT(heapInUse() - before, 200 * count);
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
  accumulator.add({ 2.0 * unit * 10.75, 1.0 }); // all of it
  accumulator.add({ 2.0 * unit * 1e30, 1.0 });  // farther than an integer can say
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 1u);
  EXPECT_EQ(accumulator.units()[0].index, 9);
  EXPECT_NEAR(accumulator.units()[0].energy, 3.0, 1e-12);
  EXPECT_NEAR(accumulator.energyBeyondGate(), 3.0, 1e-12);
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

TEST(RangeUnits, NothingArrivesBeforeThePulseIsSent)
{
  RangeUnitAccumulator accumulator(nanosecond, 2.0 * nanosecond, 100.0);
  accumulator.add({ 0.0, 1.0 });
  accumulator.accumulate();
  ASSERT_EQ(accumulator.units().size(), 1u);
  EXPECT_EQ(accumulator.units()[0].index, 0);
  EXPECT_EQ(accumulator.units()[0].energy, 1.0);
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

namespace
{
/// Echo of a ground plane 3 m below, axis 1 degree below the horizon: dE/dr in closed form, summed
/// as paths.
void addGroundWaveform(RangeUnitAccumulator& accumulator, double mu, int nodes)
{
  const double h = 3.0;
  const double t = 5.6e-3;
  const double eta = Pi / 180.0;
  const double solidAngle = 4.0 * Pi * std::sin(0.5 * t) * std::sin(0.5 * t);
  const double nearest = h / std::sin(eta + t);
  const double farthest = h / std::sin(eta - t);
  for (int n = 0; n < nodes; ++n)
  {
    const double s = (n + 0.5) / nodes;
    const double r = nearest + (farthest - nearest) * s * s * (3.0 - 2.0 * s);
    const double dr = (farthest - nearest) * 6.0 * s * (1.0 - s) / nodes;
    const double sine = h / r;
    const double c =
      (std::cos(t) - sine * std::sin(eta)) / (std::sqrt(1.0 - sine * sine) * std::cos(eta));
    const double density =
      2.0 * 3.6e-4 * 0.146 * h * h * std::acos(std::min(1.0, c)) / (solidAngle * r * r * r);
    accumulator.add({ 2.0 * r, density * dr * transmission(mu, 2.0 * r) });
  }
  accumulator.accumulate();
}
}

TEST(RangeUnitsWaveform, GroundWithDeltaPulses)
{
  RangeUnitAccumulator accumulator(5e-9, 0.0, 4000.0);
  addGroundWaveform(accumulator, 0.0, 1000000);
  EXPECT_NEAR(totalOf(accumulator) / 9.172912907e-7, 1.0, 1e-8);
  EXPECT_EQ(accumulator.units().front().index, 173);
  EXPECT_EQ(accumulator.units().back().index, 337);
  const struct
  {
    std::int64_t unit;
    double energy;
  } cases[] = { { 173, 5.549252487e-10 }, { 174, 3.538478918e-9 }, { 190, 1.069046563e-8 },
    { 194, 1.079361529e-8 }, { 200, 1.061714625e-8 }, { 250, 5.876652661e-9 },
    { 300, 2.381221932e-9 }, { 337, 1.092043096e-10 } };
  for (const auto& item : cases)
  {
    // A node or so on the wrong side of a unit's end.
    EXPECT_NEAR(energyOf(accumulator, item.unit) / item.energy, 1.0, 1e-3) << item.unit;
  }
}

TEST(RangeUnitsWaveform, GroundWithFiniteSpreadPulses)
{
  RangeUnitAccumulator accumulator(5e-9, 5e-9, 4000.0);
  addGroundWaveform(accumulator, 3.5e-5, 1000000);
  EXPECT_EQ(energyOf(accumulator, 172), 0.0);
  EXPECT_NEAR(energyOf(accumulator, 173) / 7.014949967e-10, 1.0, 1e-7);
  EXPECT_NEAR(energyOf(accumulator, 200) / 1.050578974e-8, 1.0, 1e-7);
}
