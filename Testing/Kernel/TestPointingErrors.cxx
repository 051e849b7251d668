// SPDX-License-Identifier: BSD-3-Clause
// Mast sway and encoder jitter: their size, spectrum and independence, and what they do to a beam.
#include "PointingErrors.h"
#include "ScanPattern.h"
#include "Statistics.h"
#include "Vector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

using namespace avianlidar;

namespace
{
constexpr double FullTurn = 2.0 * 3.14159265358979323846;
const Vec3 Up(0.0, 0.0, 1.0);

PointingErrors sway(double amplitude, double frequency = 0.5, std::int32_t seed = 0)
{
  PointingErrors errors;
  errors.swayAmplitude = amplitude;
  errors.swayFrequency = frequency;
  errors.seed = seed;
  return errors;
}

PointingErrors jitter(double rms, std::int32_t seed = 0)
{
  PointingErrors errors;
  errors.encoderJitter = rms;
  errors.seed = seed;
  return errors;
}

// The beams of a revolution.
std::vector<Vec3> directionsOf(
  const ScanPattern& pattern, const PointingErrors& errors, int revolution)
{
  const ScanGenerator scan(pattern);
  const Pointing pointing(errors, scan.rotor());
  std::vector<Vec3> all;
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    const ScanBeam beam = scan.beam(i);
    all.push_back(pointing.direction(
      beam.direction, scan.column(i), revolution, revolution / pattern.rotationRate + beam.time));
  }
  return all;
}
}

TEST(PointingErrors, TiltHasTheRmsAboutEachAxis)
{
  // Over seeds at one time: of a sum of K tones the variance of x^2 is (2 - 1.5/K) rms^4.
  const int count = 20000;
  for (const double time : { 0.0, 1.7, -3.0, 1e6 })
  {
    statistics::Moments axes[2];
    double product = 0.0;
    for (int seed = 0; seed < count; ++seed)
    {
      const auto tilt = Pointing(sway(0.02, 0.5, seed), Up).tilt(time);
      axes[0].add(tilt[0]);
      axes[1].add(tilt[1]);
      product += tilt[0] * tilt[1];
    }
    const double variance = 0.02 * RadiansPerDegree * 0.02 * RadiansPerDegree;
    const double error = std::sqrt((2.0 - 1.5 / SwayTones) / count) * variance;
    for (const statistics::Moments& axis : axes)
    {
      EXPECT_NEAR(axis.squares / count, variance, 3.0 * error);
      EXPECT_NEAR(axis.mean(), 0.0, 3.0 * std::sqrt(variance / count));
    }
    EXPECT_NEAR(product / count, 0.0, 3.0 * variance / std::sqrt(count)); // independent axes
  }
}

TEST(PointingErrors, TiltSwingsNearTheFrequency)
{
  for (const double frequency : { 0.05, 0.5, 10.0 })
  {
    const Pointing pointing(sway(0.1, frequency, 3), Up);
    // A periodogram of 100 periods, 8 samples each, with Hann's window.
    const int samples = 800;
    std::vector<double> tilts(samples);
    for (int i = 0; i < samples; ++i)
    {
      tilts[i] =
        pointing.tilt(i / (8.0 * frequency))[0] * (0.5 - 0.5 * std::cos(FullTurn * i / samples));
    }
    double inside = 0.0;
    double all = 0.0;
    for (int bin = 1; bin < samples / 2; ++bin)
    {
      std::complex<double> sum;
      for (int i = 0; i < samples; ++i)
      {
        sum += tilts[i] * std::polar(1.0, -FullTurn * bin * i / samples);
      }
      all += std::norm(sum);
      inside += std::abs(bin / 100.0 - 1.0) < SwayBandwidth + 0.03 ? std::norm(sum) : 0.0;
    }
    EXPECT_GT(inside, 0.999 * all) << frequency;
  }
}

TEST(PointingErrors, JitterHasTheRmsAndIsIndependent)
{
  const Pointing pointing(jitter(0.05), Up);
  const double rms = 0.05 * RadiansPerDegree;
  const int columns = 40000;
  statistics::Moments all;
  double neighbours = 0.0;
  double revolutions = 0.0;
  double fourth = 0.0;
  for (int column = 0; column < columns; ++column)
  {
    const double x = pointing.azimuthError(column, 5);
    all.add(x);
    fourth += x * x * x * x;
    neighbours += x * pointing.azimuthError(column + 1, 5);
    revolutions += x * pointing.azimuthError(column, 6);
  }
  const double error = 1.0 / std::sqrt(columns);
  EXPECT_NEAR(all.mean() / rms, 0.0, 3.0 * error);
  EXPECT_NEAR(all.squares / columns / (rms * rms), 1.0, 3.0 * std::sqrt(2.0) * error);
  EXPECT_NEAR(fourth / columns / std::pow(rms, 4), 3.0, 3.0 * std::sqrt(96.0) * error); // normal
  EXPECT_NEAR(neighbours / columns / (rms * rms), 0.0, 3.0 * error);
  EXPECT_NEAR(revolutions / columns / (rms * rms), 0.0, 3.0 * error);
  EXPECT_NE(Pointing(jitter(0.05, 1), Up).azimuthError(7, 5), pointing.azimuthError(7, 5));
}

TEST(PointingErrors, JitterTurnsAColumnAsAWhole)
{
  ScanPattern pattern;
  pattern.azimuthStep = 10.0;
  for (const double pitch : { 0.0, 20.0 })
  {
    pattern.pitch = pitch;
    const ScanGenerator scan(pattern);
    const Pointing pointing(jitter(0.3), scan.rotor());
    const auto directions = directionsOf(pattern, jitter(0.3), -2);
    for (std::int64_t i = 0; i < scan.size(); ++i)
    {
      // The same scan with another azimuth of this column.
      ScanPattern other = pattern;
      other.azimuthStart += pointing.azimuthError(scan.column(i), -2) / RadiansPerDegree;
      const auto expected = ScanGenerator(other).beam(i).direction;
      for (int k = 0; k < 3; ++k)
      {
        ASSERT_NEAR(directions[i][k], expected[k], 4e-15) << i;
      }
    }
  }
}

TEST(PointingErrors, SwayTurnsAllBeamsOfAMomentAlike)
{
  const Pointing pointing(sway(3.0, 0.5, 11), Up);
  const auto tilt = pointing.tilt(12.5);
  const double angle = std::hypot(tilt[0], tilt[1]);
  // A beam along the axis of the tilt stays; one across turns by the whole angle, straight up to
  // the right-hand side of the axis.
  const Vec3 along(tilt[0] / angle, tilt[1] / angle, 0.0);
  const auto still = pointing.direction(along, 0, 0, 12.5);
  const auto up = pointing.direction(Up, 4, 1, 12.5);
  const double expected[3] = { std::sin(angle) * along[1], -std::sin(angle) * along[0],
    std::cos(angle) };
  for (int k = 0; k < 3; ++k)
  {
    EXPECT_NEAR(still[k], along[k], 1e-15);
    EXPECT_NEAR(up[k], expected[k], 1e-15);
  }
}

TEST(PointingErrors, NoneIsExactlyOff)
{
  const ScanPattern pattern;
  const ScanGenerator scan(pattern);
  EXPECT_TRUE(sway(0.0).none());
  EXPECT_FALSE(sway(1e-9).none());
  EXPECT_FALSE(jitter(1e-9).none());
  const auto directions = directionsOf(pattern, sway(0.0, 7.0, 5), 3);
  for (std::int64_t i = 0; i < scan.size(); ++i)
  {
    ASSERT_EQ(directions[i], scan.beam(i).direction);
  }
}

TEST(PointingErrors, AnyTimeGivesANumber)
{
  const Pointing pointing(sway(10.0, 1e6, -2147483647 - 1), Up);
  for (const double time : { 0.0, -1e-300, 2e29, -2e29 })
  {
    const auto d = pointing.direction(Vec3(0.0, 1.0, 0.0), std::int64_t(1) << 40, -5, time);
    EXPECT_NEAR(std::hypot(d[0], d[1], d[2]), 1.0, 1e-14) << time;
  }
}
