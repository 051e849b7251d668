// SPDX-License-Identifier: BSD-3-Clause
// The grid of a scan: full circle, sector across north, unequal elevations, pieces, tilted sensor,
// no grid.
#include "ScanGrid.h"
#include "ScanPattern.h"

#include <gtest/gtest.h>

#include <set>

using namespace avianlidar;

namespace
{
struct Beams
{
  std::vector<double> azimuths;
  std::vector<double> elevations;
  std::vector<int> channels;
};

Beams beamsOf(const ScanPattern& pattern, std::int64_t first = 0, std::int64_t last = -1)
{
  const ScanGenerator scan(pattern);
  Beams beams;
  for (std::int64_t i = first; i < (last < 0 ? scan.size() : last); ++i)
  {
    const ScanBeam beam = scan.beam(i);
    beams.azimuths.push_back(beam.azimuth);
    beams.elevations.push_back(beam.elevation);
    beams.channels.push_back(beam.channel);
  }
  return beams;
}

ScanGrid gridOf(const Beams& b)
{
  return makeScanGrid(b.azimuths, b.elevations, b.channels);
}

// Every cell belongs to one beam.
bool covers(const ScanGrid& grid)
{
  std::set<std::pair<int, int>> cells;
  for (std::size_t i = 0; i < grid.column.size(); ++i)
  {
    cells.emplace(grid.column[i], grid.row[i]);
  }
  return cells.size() == grid.column.size() &&
    cells.size() == grid.azimuths.size() * grid.elevations.size();
}
}

TEST(ScanGrid, YawWithRoundingStillFallsOnColumns)
{
  ScanPattern p;
  p.azimuthStep = 0.1;
  p.yaw = 77.7;
  const ScanGrid grid = gridOf(beamsOf(p));
  EXPECT_EQ(grid.azimuths.size(), 3600u);
  EXPECT_TRUE(covers(grid));
}

TEST(ScanGrid, PieceThatEndsWithinAColumn)
{
  const ScanGrid grid = gridOf(beamsOf(ScanPattern(), 0, 16 * 5 + 3));
  EXPECT_EQ(grid.azimuths.size(), 6u);
  EXPECT_EQ(grid.elevations.size(), 16u);
  EXPECT_EQ(grid.column.back(), 5);
}

TEST(ScanGrid, TiltedSensorFallsBackToChannels)
{
  ScanPattern p;
  p.pitch = 3.0;
  p.roll = -2.0;
  const ScanGrid grid = gridOf(beamsOf(p));
  EXPECT_TRUE(grid.byChannel);
  EXPECT_EQ(grid.azimuths.size(), 960u);
  EXPECT_EQ(grid.elevations.size(), 16u);
  EXPECT_TRUE(covers(grid));
  EXPECT_EQ(grid.row[16 * 7 + 3], 3);
}

TEST(ScanGrid, ScatteredBeamsHaveNone)
{
  const std::vector<double> azimuths{ 0.0, 1.3, 2.1, 8.0 }, elevations{ 0.0, 1.0, -2.0, 3.0 };
  EXPECT_TRUE(makeScanGrid(azimuths, elevations, {}).empty());
  EXPECT_TRUE(makeScanGrid(azimuths, elevations, { 0, 0, 0, 1 }).empty());
  EXPECT_TRUE(makeScanGrid({}, {}, {}).empty());
}

TEST(ScanGrid, OneBeamIsAGrid)
{
  const ScanGrid grid = makeScanGrid({ 359.99999999 }, { 2.0 }, {});
  EXPECT_EQ(grid.azimuths, std::vector<double>{ 0.0 });
  double origin, spacing;
  EXPECT_TRUE(equallySpaced(grid.elevations, origin, spacing));
  EXPECT_EQ(origin, 2.0);
  EXPECT_EQ(spacing, 1.0);
}
