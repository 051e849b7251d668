// SPDX-License-Identifier: BSD-3-Clause
// Times and steps of revolutions, and the beams that a step and a piece have.
#include "PrismTestPattern.h"
#include "ScanClock.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

using namespace avianlidar;

namespace
{
ScanMoment at(const ScanClock& clock, double time)
{
  ScanMoment moment{ -77, -77 };
  EXPECT_EQ(momentAt(clock, time, moment), "") << time;
  return moment;
}

void expectAt(const ScanClock& clock, double time, int revolution, int step)
{
  const ScanMoment moment = at(clock, time);
  EXPECT_EQ(moment.revolution, revolution) << time << " s at " << clock.rotationRate << " Hz";
  EXPECT_EQ(moment.step, step) << time << " s at " << clock.rotationRate << " Hz";
}

const double rates[] = { 0.3, 1.0 / 3.0, 0.5, 10.0, 20.0, 1e-20, 1e20, 0.7, 29.97 };
}

TEST(ScanClock, ATimeComputedForAStepIsThatStep)
{
  for (const double rate : rates)
  {
    for (const int steps : { 1, 3, 36, 960 })
    {
      const ScanClock clock{ rate, 1, steps };
      for (const int k :
        { -2147483647 - 1, -1000000, -7, -1, 0, 1, 2, 3, 7, 49, 1000, 1000003, 2147483647 })
      {
        for (const int j : { 0, 1, steps / 2, steps - 1 })
        {
          if (j < steps)
          {
            expectAt(clock, timeOf(clock, { k, j }), k, j);
          }
        }
        // As scripts and animations compute it.
        expectAt(clock, k / rate, k, 0);
        expectAt(clock, k * (1.0 / rate), k, 0);
      }
    }
  }
}

TEST(ScanClock, BetweenStepsTheEarlierOneStands)
{
  for (const double rate : rates)
  {
    const ScanClock clock{ rate, 1, 4 };
    for (const int k : { -3, 0, 5 })
    {
      expectAt(clock, (k + 0.2499) / rate, k, 0);
      expectAt(clock, (k + 0.26) / rate, k, 1);
      expectAt(clock, (k + 0.9999) / rate, k, 3);
      // A millionth of a step before the next is before it, a tenth of a billionth is not.
      expectAt(clock, (k + 1.0 - 0.25e-6) / rate, k, 3);
      expectAt(clock, (k + 1.0 - 0.25e-10) / rate, k + 1, 0);
    }
  }
}

TEST(ScanClock, TimesBeyondWhatAnIntCountsAreNamed)
{
  ScanMoment moment;
  for (const double time : { 1e300, -1e300, 2147483648.0, -2147483649.0,
         std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN() })
  {
    const std::string wrong = momentAt({ 1.0, 1, 1 }, time, moment);
    statistics::expectSays(wrong, "RotationRate");
  }
  EXPECT_NE(momentAt({ 1e20, 1, 1000 }, 1e300, moment), "");
}

TEST(ScanClock, StepsToPlay)
{
  EXPECT_EQ(timesOf({ 0.5, 1, 1 }), std::vector<double>{ 0.0 });
  EXPECT_EQ(timesOf({ 0.5, 3, 1 }), (std::vector<double>{ 0.0, 2.0, 4.0 }));
  EXPECT_EQ(timesOf({ 0.5, 2, 2 }), (std::vector<double>{ 0.0, 1.0, 2.0, 3.0 }));
  for (const double rate : rates)
  {
    const std::vector<double> times = timesOf({ rate, 1000, 1000 });
    EXPECT_EQ(times.size(), 1000000u);
    EXPECT_EQ(
      std::adjacent_find(times.begin(), times.end(), std::greater_equal<double>()), times.end());
  }
  // A bad clock has the one step; the error is made when the beams are.
  for (const ScanClock& bad : { ScanClock{ 0.0, 5, 5 }, ScanClock{ std::nan(""), 5, 5 },
         ScanClock{ 0.5, 0, 5 }, ScanClock{ 0.5, 5, -1 }, ScanClock{ 0.5, 2147483647, 2 } })
  {
    EXPECT_EQ(timesOf(bad), std::vector<double>{ 0.0 });
  }
}

TEST(ScanClock, BadClocksAreNamed)
{
  const ScanPattern pattern;
  const auto names = [&pattern](const ScanClock& clock, const char* name)
  { return checkClock(clock, pattern).find(name) != std::string::npos; };
  EXPECT_EQ(checkClock({ 0.5, 1041, 960 }, pattern), "");
  EXPECT_TRUE(names({ 0.5, 0, 1 }, "NumberOfRevolutions is 0"));
  EXPECT_TRUE(names({ 0.5, 1, 0 }, "StepsPerRevolution is 0"));
  EXPECT_TRUE(names({ 0.5, 1, 961 }, "the 960 columns"));
  EXPECT_TRUE(names({ 0.5, 1042, 960 }, "1e6 steps"));
}

TEST(ScanClock, StepsAndPiecesShowWhatHasBeenFired)
{
  std::vector<ScanPattern> patterns;
  ScanPattern pattern;
  pattern.channels = 5;
  pattern.azimuthStep = 10.0;                         // 36 columns
  for (const double interval : { 0.0, 0.004, 0.011 }) // a column has 55.6 ms
  {
    pattern.firingInterval = interval;
    patterns.push_back(pattern);
  }
  pattern = twoPrisms();
  pattern.channels = 3;
  pattern.elevationStep = 0.1;
  patterns.push_back(pattern);
  for (const ScanPattern& of : patterns)
  {
    ASSERT_EQ(checkPattern(of), "");
    const ScanGenerator scan(of);
    for (const int steps : { 1, 2, 7, 35, 36 })
    {
      std::size_t before = 0;
      for (int step = 0; step < steps; ++step)
      {
        const std::vector<std::int64_t> beams = beamsOf(of, { 0, 1, step, steps });
        const double end = (step + 1.0) / steps / of.rotationRate;
        std::vector<std::int64_t> expected;
        for (std::int64_t beam = 0; beam < scan.size(); ++beam)
        {
          if (scan.beam(beam).time < end - 1e-12)
          {
            expected.push_back(beam);
          }
        }
        EXPECT_EQ(beams, expected) << step << " of " << steps;
        EXPECT_GT(beams.size(), before) << "something new at each step";
        before = beams.size();
      }
      EXPECT_EQ(before, static_cast<std::size_t>(scan.size()));
    }
  }
  patterns.push_back(ScanPattern());
  for (const ScanPattern& of : patterns)
  {
    for (const int pieces : { 1, 2, 3, 7, 960, 5000 })
    {
      for (const int step : { 0, 2, 4 })
      {
        std::vector<std::int64_t> all;
        std::size_t most = 0;
        std::size_t least = 1000000;
        for (int piece = 0; piece < pieces; ++piece)
        {
          const std::vector<std::int64_t> beams = beamsOf(of, { piece, pieces, step, 5 });
          EXPECT_TRUE(std::is_sorted(beams.begin(), beams.end()));
          all.insert(all.end(), beams.begin(), beams.end());
          most = std::max(most, beams.size());
          least = std::min(least, beams.size());
        }
        std::sort(all.begin(), all.end());
        EXPECT_EQ(all, beamsOf(of, { 0, 1, step, 5 }));
        EXPECT_LE(most - least, static_cast<std::size_t>(of.channels)) << "no more than a column";
      }
    }
  }
}
