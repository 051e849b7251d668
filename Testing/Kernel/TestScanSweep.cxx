// SPDX-License-Identifier: BSD-3-Clause
// A scan of which more and more beams are asked for, as a sweep does: what is known of a beam stays
// known while it is away, and every picture is that of a fresh scan, bit for bit.
#include "ScanTestTown.h"

#include <gtest/gtest.h>

using namespace echotest;

namespace
{
struct Sweep
{
  ScanSetup setup = makeSetup(town(), Sensor{}, usual());
  ScanBeams all = horizon(90, 4);
  TraceCache cache;
  ScanResult result;
  std::size_t maximum = std::size_t(1) << 30;

  Sweep()
  {
    this->setup.settings.beamSamples = BeamSampleSource::Rays; // which always trace something
    finishSetup(this->setup);
  }

  /// Rays traced for beams [begin, end).
  std::uint64_t show(std::size_t begin, std::size_t end)
  {
    const ScanBeams beams = chosen(this->all, begin, end);
    EXPECT_TRUE(simulateScan(this->setup, beams, 2, this->cache, this->maximum, {}, this->result));
    expectSame(this->result, runScan(this->setup, beams));
    return this->result.raysTraced;
  }
};
}

TEST(ScanSweep, NoRayIsTracedTwice)
{
  Sweep sweep;
  const std::uint64_t whole = runScan(sweep.setup, sweep.all).raysTraced;
  ASSERT_GT(whole, 0u);
  constexpr std::size_t steps = 9;
  for (int revolution = 0; revolution < 3; ++revolution)
  {
    std::uint64_t rays = 0;
    for (std::size_t step = 1; step <= steps; ++step)
    {
      rays += sweep.show(0, sweep.all.size() * step / steps);
    }
    EXPECT_EQ(rays, revolution == 0 ? whole : 0u);
  }
}

TEST(ScanSweep, NothingAskedForForgetsNothing)
{
  Sweep sweep;
  ASSERT_GT(sweep.show(0, sweep.all.size()), 0u);
  EXPECT_EQ(sweep.show(0, 0), 0u);
  EXPECT_EQ(sweep.show(0, sweep.all.size()), 0u);
}

TEST(ScanSweep, OtherBeamsTakeThePlaceOfThoseKnown)
{
  Sweep sweep;
  const std::size_t half = sweep.all.size() / 2;
  const std::uint64_t first = sweep.show(0, half);
  ASSERT_GT(first, 0u);
  sweep.show(half, sweep.all.size());
  EXPECT_TRUE(sweep.cache.absent.empty());
  EXPECT_EQ(sweep.show(0, half), first);
  // A beam of the same number that points elsewhere is another beam.
  for (Vec3& direction : sweep.all.directions)
  {
    direction.z += 1e-4;
  }
  EXPECT_GT(sweep.show(0, half), 0u);
  EXPECT_TRUE(sweep.cache.absent.empty());
}

TEST(ScanSweep, BeamsThatAreAwayGiveWayWhereMemoryIsShort)
{
  Sweep sweep;
  const std::size_t all = sweep.all.size();
  sweep.show(0, all);
  const std::size_t needed = sweep.cache.bytes();
  sweep.maximum = needed / 4;
  sweep.show(0, 8);
  EXPECT_TRUE(sweep.cache.absent.empty());
  EXPECT_LE(sweep.cache.bytes(), sweep.maximum + 8 * sizeof(KeptBeam));
  sweep.maximum = needed * 2;
  EXPECT_GT(sweep.show(0, all), 0u);
  sweep.show(0, 8);
  EXPECT_EQ(sweep.cache.absent.size(), all - 8);
  EXPECT_LE(sweep.cache.bytes(), sweep.maximum);
}
