// SPDX-License-Identifier: BSD-3-Clause
// Beams of a scan: counts, order, angles, orientation, clock, and what is refused.
#include "ScanClock.h"
#include "ScanPattern.h"
#include "Sensor.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

using namespace avianlidar;

namespace
{
constexpr double Radian = 3.14159265358979323846 / 180.0;

ScanPattern corridor()
{
  ScanPattern p;
  p.minimumElevation = -15.0;
  p.elevationStep = 2.0;
  p.azimuthStep = 2.0;
  p.rotationRate = 10.0;
  p.firingInterval = 5e-6;
  return p;
}

// A pattern of one beam at the given azimuth and elevation.
ScanPattern single(double azimuth, double elevation)
{
  ScanPattern p;
  p.channels = 1;
  p.minimumElevation = elevation;
  p.azimuthStart = azimuth;
  p.azimuthEnd = azimuth + 1.0;
  p.azimuthStep = 1.0;
  return p;
}

void expectVector(const Vec3& v, double x, double y, double z, double tolerance = 1e-15)
{
  EXPECT_NEAR(v[0], x, tolerance);
  EXPECT_NEAR(v[1], y, tolerance);
  EXPECT_NEAR(v[2], z, tolerance);
}
}

TEST(ScanPattern, EndOfAzimuthRangeIsExcluded)
{
  ScanPattern p;
  p.azimuthStart = 0.0;
  p.azimuthStep = 0.1; // 0.1 is not a binary fraction: no column may appear at the end
  for (int n = 1; n <= 3600; ++n)
  {
    p.azimuthEnd = n * 0.1;
    ASSERT_EQ(numberOfColumns(p), n);
  }
  p.azimuthEnd = 0.25; // 0, 0.1, 0.2
  EXPECT_EQ(numberOfColumns(p), 3);
}

TEST(ScanPattern, ColumnsThenChannels)
{
  const ScanPattern p;
  const ScanGenerator scan(p);
  const ScanBeam beam = scan.beam(16 * 10 + 3);
  EXPECT_EQ(beam.channel, 3);
  EXPECT_EQ(beam.azimuth, 3.75);
  EXPECT_EQ(beam.elevation, 1.125);
  const double az = 3.75 * Radian, el = 1.125 * Radian;
  expectVector(
    beam.direction, std::cos(el) * std::sin(az), std::cos(el) * std::cos(az), std::sin(el));
}

TEST(ScanPattern, OrientationsTurnBeams)
{
  // Cardinal directions are exact. Yaw turns clockwise, pitch lifts the nose, roll lowers the right
  // side. Roll is applied first and yaw last: roll by 90 degrees turns right to down, pitch by 90
  // turns down to forward, yaw by 90 turns forward to right.
  const double c = std::cos(10.0 * Radian), s = std::sin(10.0 * Radian);
  const struct
  {
    double azimuth, elevation;
    double yaw, pitch, roll;
    Vec3 direction;
    double azimuthThen, elevationThen;
    double tolerance;
  } cases[] = { { 0.0, 0.0, 0.0, 0.0, 0.0, { 0.0, 1.0, 0.0 }, 0.0, 0.0, 0.0 },
    { 90.0, 0.0, 0.0, 0.0, 0.0, { 1.0, 0.0, 0.0 }, 90.0, 0.0, 0.0 },
    { 180.0, 0.0, 0.0, 0.0, 0.0, { 0.0, -1.0, 0.0 }, 180.0, 0.0, 0.0 },
    { 270.0, 0.0, 0.0, 0.0, 0.0, { -1.0, 0.0, 0.0 }, 270.0, 0.0, 0.0 },
    { 0.0, 90.0, 0.0, 0.0, 0.0, { 0.0, 0.0, 1.0 }, 0.0, 90.0, 1e-15 },
    { 350.0, 0.0, 100.0, 0.0, 0.0, { 1.0, 0.0, 0.0 }, 90.0, 0.0, 1e-15 },
    { 0.0, 0.0, 0.0, 10.0, 0.0, { 0.0, c, s }, 0.0, 10.0, 1e-15 },
    { 90.0, 0.0, 0.0, 0.0, 10.0, { c, 0.0, -s }, 90.0, -10.0, 1e-15 },
    { 90.0, 0.0, 90.0, 90.0, 90.0, { 1.0, 0.0, 0.0 }, 90.0, 0.0, 1e-15 } };
  for (const auto& of : cases)
  {
    SCOPED_TRACE(testing::Message() << of.azimuth << ' ' << of.yaw << ' ' << of.pitch);
    ScanPattern p = single(of.azimuth, of.elevation);
    p.yaw = of.yaw;
    p.pitch = of.pitch;
    p.roll = of.roll;
    const ScanBeam beam = ScanGenerator(p).beam(0);
    expectVector(beam.direction, of.direction.x, of.direction.y, of.direction.z, of.tolerance);
    EXPECT_NEAR(beam.azimuth, of.azimuthThen, 1e-13);
    EXPECT_NEAR(beam.elevation, of.elevationThen, 1e-13);
  }
}

TEST(ScanPattern, AnglesOfARotationGiveItBack)
{
  for (const double pitch : { -90.0, -89.9999999, -30.0, 0.0, 60.0, 90.0 })
  {
    for (const double roll : { -170.0, 0.0, 20.0 })
    {
      const glm::dmat3 rotation = rotationOf(250.0, pitch, roll);
      const Vec3 angles = anglesOf(rotation);
      const glm::dmat3 again = rotationOf(angles.x, angles.y, angles.z);
      for (int axis = 0; axis < 3; ++axis)
      {
        expectVector(again[axis], rotation[axis].x, rotation[axis].y, rotation[axis].z, 4e-15);
      }
    }
  }
  const Vec3 angles = anglesOf(rotationOf(-60.0, 30.0, 20.0));
  expectVector(angles / 60.0, -1.0, 0.5, 1.0 / 3.0, 4e-15);
}

TEST(ScanPattern, DurationEndsWithTheLastFiring)
{
  ScanPattern p = corridor();
  const ScanGenerator scan(p);
  double last = 0.0;
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    last = std::max(last, scan.beam(i).time);
  }
  EXPECT_EQ(durationOf(p), last);
  auto table = std::make_shared<BeamTable>();
  table->directions = { Vec3(0.0, 1.0, 0.0), Vec3(1.0, 0.0, 0.0) };
  table->times = { 0.07, 0.05 };
  p.table = table;
  EXPECT_EQ(durationOf(p), 0.07);
}

TEST(ScanPattern, DirectionsAreUnitAndAgreeWithTheirAngles)
{
  ScanPattern p = corridor();
  p.yaw = 33.0;
  p.pitch = -7.0;
  p.roll = 4.0;
  const ScanGenerator scan(p);
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    const ScanBeam beam = scan.beam(i);
    const auto& d = beam.direction;
    ASSERT_NEAR(std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), 1.0, 1e-15);
    ASSERT_GE(beam.azimuth, 0.0);
    ASSERT_LT(beam.azimuth, 360.0);
    const double az = beam.azimuth * Radian, el = beam.elevation * Radian;
    expectVector(d, std::cos(el) * std::sin(az), std::cos(el) * std::cos(az), std::sin(el), 2e-15);
  }
}

TEST(ScanPattern, FiringOrderIsStaggered)
{
  // Channels in the order in which they fire.
  for (const std::vector<int>& order :
    { std::vector<int>{ 0, 2, 1, 3 }, std::vector<int>{ 0, 3, 1, 4, 2 },
      std::vector<int>{ 0, 8, 1, 9, 2, 10, 3, 11, 4, 12, 5, 13, 6, 14, 7, 15 },
      std::vector<int>{ 0 } })
  {
    for (std::size_t slot = 0; slot < order.size(); ++slot)
    {
      EXPECT_EQ(firingSlot(order[slot], static_cast<int>(order.size())), static_cast<int>(slot));
    }
  }
}

TEST(ScanPattern, TimesAreUniqueAndOneSweepLong)
{
  const ScanPattern p;
  const ScanGenerator scan(p);
  EXPECT_EQ(scan.beam(0).time, 0.0);
  EXPECT_DOUBLE_EQ(scan.beam(8).time, 30e-6);      // channel 8 is the second to fire
  EXPECT_DOUBLE_EQ(scan.beam(1).time, 60e-6);      // channel 1 the third
  EXPECT_DOUBLE_EQ(scan.beam(16 * 480).time, 1.0); // half a turn at 0.5 Hz
  std::set<double> times;
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    times.insert(scan.beam(i).time);
  }
  EXPECT_EQ(times.size(), 15360u);
  EXPECT_LT(*times.rbegin(), 2.0);
}

TEST(ScanPattern, TheNextPulseEndsTheUnambiguousRange)
{
  ScanPattern p;
  p.firingInterval = 15e-6;
  EXPECT_EQ(pulseInterval(p), 15e-6);
  EXPECT_NEAR(unambiguousRange(pulseInterval(p)), 2248.4, 0.1);
  Sensor sensor;
  sensor.rangeGate = 2248.0;
  EXPECT_EQ(warningOnAmbiguity(sensor, pulseInterval(p)), "");
  sensor.rangeGate = 2249.0;
  EXPECT_EQ(warningOnAmbiguity(sensor, pulseInterval(p)).find("range_gate is 2249 m"), 0u);
  // Channels that fire together, that have times of their own, or one alone: a column, 2 s/960.
  p.firingInterval = 0.0;
  EXPECT_DOUBLE_EQ(pulseInterval(p), 2.0 / 960.0);
  p.firingInterval = 15e-6;
  p.firingTimes.assign(16, 0.0);
  EXPECT_DOUBLE_EQ(pulseInterval(p), 2.0 / 960.0);
  p.firingTimes.clear();
  p.channels = 1;
  EXPECT_DOUBLE_EQ(pulseInterval(p), 2.0 / 960.0);
  p.table = std::make_shared<BeamTable>();
  EXPECT_TRUE(std::isinf(pulseInterval(p)));
}

// What is not finite in any property is refused by TestBadInput.py. Azimuths and times of each
// channel are TestPhotonReceiver.py's.
TEST(ScanPattern, BadValuesAreNamed)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case
  {
    const char* names;
    std::function<void(ScanPattern&)> spoil;
  };
  const Case cases[] = {
    { "NumberOfChannels", [](ScanPattern& p) { p.channels = 0; } },
    { "MinimumElevation", [](ScanPattern& p) { p.minimumElevation = -90.5; } },
    { "channel 15", [](ScanPattern& p) { p.minimumElevation = 85.0; } },
    { "ElevationStep", [](ScanPattern& p) { p.elevationStep = 0.0; } },
    { "ElevationStep", [](ScanPattern& p) { p.elevationStep = -1.0; } },
    { "channel 1",
      [](ScanPattern& p) {
        p.elevations = { 0.0, 91.0 };
      } },
    { "channel 0", [&](ScanPattern& p) { p.elevations = { nan }; } },
    { "end of AzimuthRange", [](ScanPattern& p) { p.azimuthEnd = 0.0; } },
    { "end of AzimuthRange", [](ScanPattern& p) { p.azimuthEnd = 361.0; } },
    { "AzimuthStep", [](ScanPattern& p) { p.azimuthStep = 0.0; } },
    { "AzimuthStep", [](ScanPattern& p) { p.azimuthStep = -0.375; } },
    { "AzimuthStep", [](ScanPattern& p) { p.azimuthStep = 1e-9; } }, // more than 1e9 beams
    { "RotationRate", [](ScanPattern& p) { p.rotationRate = 0.0; } },
    { "FiringInterval", [](ScanPattern& p) { p.firingInterval = -1e-6; } },
    { "FiringInterval",
      [](ScanPattern& p) { p.rotationRate = 5.0; } }, // 480 us of firings in 208 us
  };
  for (const Case& c : cases)
  {
    ScanPattern p;
    c.spoil(p);
    statistics::expectSays(checkPattern(p), c.names);
  }
}

TEST(ScanPattern, ColumnFilledToTheLastFiringIsGood)
{
  ScanPattern p;
  p.firingInterval = 1.0 / (960 * 0.5) / 16;
  EXPECT_TRUE(checkPattern(p).empty()) << checkPattern(p);
}

TEST(ScanPattern, BlankedSectorsHaveNoBeams)
{
  ScanPattern pattern;
  pattern.azimuthStep = 10.0;
  pattern.blankedSectors = { 350.0, 370.0, 90.0, 91.0, -100.0, -80.0 }; // 350, 0; 90; 260, 270
  ASSERT_EQ(checkPattern(pattern), "");
  for (std::int64_t column = 0; column < numberOfColumns(pattern); ++column)
  {
    const bool blanked = column == 35 || column == 0 || column == 9 || column == 26 || column == 27;
    EXPECT_EQ(isBlanked(pattern, column), blanked) << column;
  }
  EXPECT_EQ(numberOfBeams(pattern), 36 * 16);
  EXPECT_EQ(numberOfFirings(pattern), 31 * 16);
  ScanPart part;
  EXPECT_EQ(beamsOf(pattern, part).size(), 31u * 16u);
  part.pieces = 3;
  std::size_t sum = 0;
  for (part.piece = 0; part.piece < 3; ++part.piece)
  {
    sum += beamsOf(pattern, part).size();
  }
  EXPECT_EQ(sum, 31u * 16u);
}

TEST(ScanPattern, BadTablesAreNamed)
{
  const auto says = [](auto table, std::vector<double> values, const char* words)
  {
    ScanPattern pattern;
    pattern.channels = 2;
    pattern.*table = std::move(values);
    statistics::expectSays(checkPattern(pattern), words);
  };
  says(&ScanPattern::azimuthOffsets, { 1.0 },
    "ChannelAzimuthOffsets has 1 values, expected one for each of the 2 channels");
  says(&ScanPattern::azimuthOffsets, { 1.0, 181.0 }, "ChannelAzimuthOffsets is 181");
  says(&ScanPattern::firingTimes, { 0.0, 0.0, 0.0 }, "ChannelFiringTimes has 3 values");
  says(&ScanPattern::firingTimes, { 0.0, 1.0 }, "ChannelFiringTimes is 1, expected 0 s to the");
  says(&ScanPattern::firingTimes, { 0.0, -1.0 }, "ChannelFiringTimes is -1");
  says(&ScanPattern::blankedSectors, { 0.0, 10.0, 20.0 }, "an odd number of values");
  says(&ScanPattern::blankedSectors, { 10.0, 10.0 }, "the end of BlankedSectors is 10");
  says(&ScanPattern::blankedSectors, { 400.0, 410.0 }, "the start of BlankedSectors is 400");
}

TEST(ScanPattern, ATableOfBeamsIsTurnedAndTimed)
{
  auto table = std::make_shared<BeamTable>();
  table->directions = { Vec3(0.0, 1.0, 0.0), Vec3(1.0, 0.0, 0.0), Vec3(0.0, 0.0, 1.0) };
  table->origins = { Vec3(0.0, 2.0, 0.0), Vec3(0.0, 0.0, 0.0), Vec3(0.0, 0.0, 3.0) };
  table->times = { 0.0, 0.05, 0.1 };
  ScanPattern p = corridor();
  p.elevationStep = -1.0; // no matter
  p.blankedSectors = { 0.0, 360.0 };
  p.table = table;
  p.yaw = 90.0;
  ASSERT_EQ(checkPattern(p), "");
  EXPECT_EQ(numberOfBeams(p), 3);
  EXPECT_EQ(numberOfChannels(p), 1);
  EXPECT_EQ(numberOfFirings(p), 3);
  const ScanGenerator scan(p);
  expectVector(scan.beam(0).direction, 1.0, 0.0, 0.0);
  expectVector(scan.beam(0).origin, 2.0, 0.0, 0.0);
  EXPECT_EQ(scan.beam(0).azimuth, 90.0);
  EXPECT_EQ(scan.beam(2).elevation, 90.0);
  EXPECT_EQ(scan.beam(1).time, 0.05);
  // By pieces and by time.
  EXPECT_EQ(beamsOf(p, { 1, 2, 0, 1 }), (std::vector<std::int64_t>{ 1 }));
  EXPECT_EQ(beamsOf(p, { 0, 1, 0, 2 }), (std::vector<std::int64_t>{ 0 }));
  EXPECT_EQ(beamsOf(p, { 0, 1, 1, 2 }), (std::vector<std::int64_t>{ 0, 1, 2 }));
  // The last may fire as the scan ends, not later.
  p.rotationRate = 11.0;
  statistics::expectSays(checkPattern(p), "the time of beam 2 is 0.1");
}
