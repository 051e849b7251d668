// SPDX-License-Identifier: BSD-3-Clause
// Rotating prisms: refraction by a ray trace by angles and rotations, and scans as windows of time.
// Fields of view are TestPrismSensors.py's.
#include "GeometryTestScene.h"
#include "PrismTestPattern.h"
#include "Prisms.h"
#include "Statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

namespace
{
using namespace avianlidar;
using Real = long double;
using Wide = geometrytest::Vec3L;
using geometrytest::unit;

constexpr Real RealPi = 3.14159265358979323846264338327950288L;
constexpr Real Degree = RealPi / 180;

/// Rodrigues' rotation about an axis of any length.
Wide turned(const Wide& v, const Wide& axis, Real angle)
{
  const Wide k = unit(axis);
  return std::cos(angle) * v + std::sin(angle) * cross(k, v) +
    (dot(k, v) * (1 - std::cos(angle))) * k;
}

/// Snell's law by angles: the ray is turned about the normal of the plane of incidence.
Wide refracted(const Wide& d, const Wide& normal, Real before, Real behind)
{
  const Wide axis = cross(normal, d);
  const Real sine = std::sqrt(dot(axis, axis));
  if (sine < 1e-18L)
  {
    return d;
  }
  const Real incidence = std::atan2(sine, dot(d, normal));
  return turned(d, axis, std::asin(before / behind * std::sin(incidence)) - incidence);
}

/// Light through prisms whose faces are turned one by one.
Wide traced(const PrismTrain& train, Real time, Wide d)
{
  const Wide forward{ 0, 1, 0 };
  for (std::size_t i = 0; i < train.wedgeAngles.size(); ++i)
  {
    const Real phase = train.phases.empty() ? 0 : train.phases[i];
    const Real angle = 2 * RealPi * train.rotationRates[i] * time + phase * Degree;
    // The inclined face of a prism whose thick end is up leans by the wedge angle about x; then the
    // prism turns about y, clockwise as seen along it: a right-handed rotation.
    const Wide leaning = turned(forward, { 1, 0, 0 }, -train.wedgeAngles[i] * Degree);
    const Wide inclined = turned(leaning, forward, angle);
    const bool enters = train.wedgeAngles[i] < 0;
    d = refracted(d, enters ? inclined : forward, 1, train.refractiveIndices[i]);
    d = refracted(d, enters ? forward : inclined, train.refractiveIndices[i], 1);
  }
  return d;
}

TEST(Prisms, RefractAsARayTraceByAnglesDoes)
{
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int passed = 0;
  double difference = 0.0;
  for (int k = 0; k < 20000; ++k)
  {
    PrismTrain train;
    const int prisms = 1 + k % 3;
    for (int i = 0; i < prisms; ++i)
    {
      train.wedgeAngles.push_back(25.0 * uniform(random));
      train.refractiveIndices.push_back(1.5 + 0.3 * uniform(random));
      train.rotationRates.push_back(120.0 * uniform(random));
      train.phases.push_back(360.0 * uniform(random));
    }
    const double time = 5.0 * (1.0 + uniform(random));
    const Real a = 5 * uniform(random) * Degree, e = 5 * uniform(random) * Degree;
    const Wide enters{ std::cos(e) * std::sin(a), std::cos(e) * std::cos(a), std::sin(e) };
    const Vec3 narrow(
      static_cast<double>(enters.x), static_cast<double>(enters.y), static_cast<double>(enters.z));
    const Wide expected = traced(train, time, enters);
    if (!(expected.y > 0.1L)) // NaN where light is totally reflected
    {
      EXPECT_TRUE(std::isnan(static_cast<double>(expected.y)) || expected.y > 0.0L);
      continue;
    }
    const auto d = steer(train, 0.0, time, narrow);
    const Wide off = geometrytest::wide(d) - expected;
    difference = std::max(difference, static_cast<double>(std::sqrt(dot(off, off))));
    ++passed;
  }
  EXPECT_GT(passed, 19000);
  EXPECT_LT(difference, 2e-11); // 240 turns a second for 10 s are rounded to 1e-13 turns
}

TEST(Prisms, LightThatDoesNotPassIsAnError)
{
  PrismTrain train;
  train.wedgeAngles = { 45.0 };
  train.refractiveIndices = { 1.5 };
  train.rotationRates = { 1.0 };
  statistics::expectSays(
    checkPrisms(train, { Vec3(0.0, 1.0, 0.0) }), "the light of channel 0 is totally");
  EXPECT_THROW(steer(train, 0.0, 0.0, Vec3(0.0, 1.0, 0.0)), std::runtime_error);
  EXPECT_NE(checkPrisms(train, { Vec3(0.0, -1.0, 0.0) }), ""); // from behind
  train.wedgeAngles = { 41.0 };
  EXPECT_EQ(checkPrisms(train, { Vec3(0.0, 1.0, 0.0) }), "");
}

TEST(Prisms, AScanGoesOnWhereTheLastOneEnded)
{
  ScanPattern pattern = twoPrisms();
  ScanPattern longer = pattern;
  longer.rotationRate = 0.5;
  const ScanGenerator all(longer);
  ASSERT_EQ(all.size(), 200000);
  double difference = 0.0;
  for (const int revolution : { 0, 1, 7, 19 })
  {
    const ScanGenerator scan(pattern, revolution);
    for (std::int64_t i = 0; i < scan.size(); i += 13)
    {
      const ScanBeam one = scan.beam(i), same = all.beam(10000 * revolution + i);
      EXPECT_NEAR(one.time + 0.1 * revolution, same.time, 1e-12);
      EXPECT_GT(one.time, -1e-15);
      EXPECT_LT(one.time, 0.1);
      for (int k = 0; k < 3; ++k)
      {
        difference = std::max(difference, std::abs(one.direction[k] - same.direction[k]));
      }
    }
  }
  EXPECT_LT(difference, 1e-11);
  // Another window, other directions; before time 0, too.
  for (const int revolution : { -3, 1, 2 })
  {
    const auto a = ScanGenerator(pattern).beam(0).direction;
    const auto b = ScanGenerator(pattern, revolution).beam(0).direction;
    EXPECT_GT(std::hypot(a[0] - b[0], a[2] - b[2]), 0.05) << revolution;
  }
  // Whole turns in a window: all are alike.
  pattern.prisms.rotationRates = { -50.0, 70.0 };
  for (const int revolution : { -2000000000, -3, 1, 2000000000 })
  {
    const auto a = ScanGenerator(pattern).beam(77).direction;
    const auto b = ScanGenerator(pattern, revolution).beam(77).direction;
    EXPECT_NEAR(a[0], b[0], 1e-5) << revolution;
  }
}

TEST(Prisms, LasersAxisAndOrientation)
{
  ScanPattern pattern = twoPrisms();
  pattern.elevations = { -1.0, 0.0, 1.0 };
  pattern.azimuthOffsets = { 0.0, 0.5, 0.0 };
  pattern.prisms.refractiveIndices = { 1.0, 1.0 }; // glass as air: lasers alone
  pattern.prisms.axisElevation = 30.0;
  pattern.prisms.axisRotationRate = 2.5; // 90 deg in a scan
  ASSERT_EQ(checkPattern(pattern), "");
  EXPECT_EQ(numberOfColumns(pattern), 3333); // 10,000 firings of three, 10 us left over
  EXPECT_EQ(numberOfFirings(pattern), 9999);
  const ScanGenerator scan(pattern);
  for (const std::int64_t column : { 0, 1000, 3332 })
  {
    const ScanBeam low = scan.beam(3 * column), high = scan.beam(3 * column + 2);
    EXPECT_NEAR(low.elevation, 29.0, 1e-9);
    EXPECT_NEAR(high.elevation, 31.0, 1e-9);
    EXPECT_NEAR(high.azimuth, 900.0 * high.time, 1e-9);
    EXPECT_EQ(high.channel, 2);
    EXPECT_NEAR(low.time, 3e-5 * column, 1e-15);
    EXPECT_NEAR(scan.beam(3 * column + 1).time - low.time, 2e-5, 1e-15); // staggered: 0, 2, 1
  }
  // The whole sensor upside down and about.
  const ScanBeam plain = scan.beam(4);
  pattern.yaw = 90.0;
  pattern.roll = 180.0;
  const auto d = ScanGenerator(pattern).beam(4).direction;
  EXPECT_NEAR(d[0], plain.direction[1], 1e-15);
  EXPECT_NEAR(d[1], plain.direction[0], 1e-15);
  EXPECT_NEAR(d[2], -plain.direction[2], 1e-15);
  pattern.firingTimes = { 0.0, 0.0, 0.0 };
  ASSERT_EQ(checkPattern(pattern), "");
  EXPECT_EQ(ScanGenerator(pattern).beam(5).time, ScanGenerator(pattern).beam(3).time);
}

TEST(Prisms, LasersBelowATurningMirrorStandStill)
{
  // Glass as air below a vertical axis: lasers that turn against the axis do not move.
  PrismTrain train;
  train.wedgeAngles = train.rotationRates = { 0.0 };
  train.refractiveIndices = { 1.0 };
  train.axisElevation = 90.0;
  train.axisRotationRate = train.laserRotationRate = 2.5;
  const Vec3 enters(std::sin(0.02), std::cos(0.02), 0.0);
  for (const double time : { 0.0, 0.03, 0.1, 7.7 })
  {
    const Vec3 d = steer(train, 1.0, time, enters);
    EXPECT_NEAR(d.z, enters.y, 1e-15);
    EXPECT_NEAR(d.x, steer(train, 1.0, 0.0, enters).x, 1e-13) << time;
  }
  // On a level axis a quarter turn takes light from the right to below, clockwise.
  train.axisElevation = train.axisRotationRate = 0.0;
  const Vec3 below = steer(train, 0.0, 0.1, enters);
  EXPECT_NEAR(below.z, -enters.x, 1e-15);
  EXPECT_NEAR(below.x, 0.0, 1e-15);
}

TEST(Prisms, BadValuesAreNamed)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  struct Case
  {
    void (*spoil)(ScanPattern&, double);
    double value;
    const char* names;
  };
  const Case cases[] = {
    { [](ScanPattern& p, double v) { p.prisms.wedgeAngles[1] = v; }, 61.0,
      "PrismWedgeAngles is 61" },
    { [](ScanPattern& p, double v) { p.prisms.wedgeAngles[1] = v; }, nan, "PrismWedgeAngles is" },
    { [](ScanPattern& p, double v) { p.prisms.refractiveIndices[0] = v; }, 0.9,
      "PrismRefractiveIndices is 0.9" },
    { [](ScanPattern& p, double v) { p.prisms.refractiveIndices.push_back(v); }, 1.5,
      "PrismRefractiveIndices has 3 values, expected one for each of the 2 prisms" },
    { [](ScanPattern& p, double v) { p.prisms.rotationRates[0] = v; }, 2e6,
      "PrismRotationRates is 2000000" },
    { [](ScanPattern& p, double v) { p.prisms.rotationRates.resize(1, v); }, 0.0,
      "PrismRotationRates has 1 values" },
    { [](ScanPattern& p, double v) {
       p.prisms.phases = { v, 0.0 };
     },
      -361.0, "PrismPhases is -361" },
    { [](ScanPattern& p, double v) { p.prisms.phases = { v }; }, 0.0, "PrismPhases has 1 values" },
    { [](ScanPattern& p, double v) { p.prisms.axisElevation = v; }, 91.0,
      "PrismAxisElevation is 91" },
    { [](ScanPattern& p, double v) { p.prisms.axisRotationRate = v; }, nan,
      "PrismAxisRotationRate is" },
    { [](ScanPattern& p, double v) { p.prisms.laserRotationRate = v; }, 2e6,
      "PrismLaserRotationRate is 2000000" },
    { [](ScanPattern& p, double v) { p.prisms.wedgeAngles.resize(4, v); }, 1.0,
      "PrismWedgeAngles has 4 values, expected at most 3" },
    { [](ScanPattern& p, double) { p.prisms.wedgeAngles.clear(); }, 0.0,
      "PrismWedgeAngles is empty" },
    { [](ScanPattern& p, double v) { p.prisms.wedgeAngles.assign(2, v); }, 45.0,
      "the light of channel 0 is totally reflected" },
    { [](ScanPattern& p, double v) {
       p.blankedSectors = { 0.0, v };
     },
      90.0, "BlankedSectors has values, expected none with prisms" },
    { [](ScanPattern& p, double v) { p.firingInterval = v; }, 0.0, "FiringInterval is 0" },
    { [](ScanPattern& p, double v) { p.firingInterval = v; }, 0.11,
      "FiringInterval is 0.11 s, so the 1 firings of a column take 0.11 s" },
    { [](ScanPattern& p, double v) { p.firingInterval = v; }, 1e-11,
      "the number of beams is 1000" },
    { [](ScanPattern& p, double v) { p.rotationRate = v; }, 0.0, "RotationRate is 0" },
    { [](ScanPattern& p, double v) { p.firingTimes = { v }; }, 2e-5, "ChannelFiringTimes is 2.0" },
    { [](ScanPattern& p, double v) { p.channels = static_cast<int>(v); }, 0.0,
      "NumberOfChannels is 0" },
  };
  for (const Case& c : cases)
  {
    ScanPattern pattern = twoPrisms();
    c.spoil(pattern, c.value);
    statistics::expectSays(checkPattern(pattern), c.names);
  }
  ScanPattern pattern = twoPrisms();
  pattern.azimuthStep = 0.0; // no matter
  EXPECT_EQ(checkPattern(pattern), "");
  pattern.firingInterval = 0.1;
  EXPECT_EQ(checkPattern(pattern), "");
  EXPECT_EQ(numberOfColumns(pattern), 1);
}
}
