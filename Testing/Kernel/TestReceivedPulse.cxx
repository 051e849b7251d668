// SPDX-License-Identifier: BSD-3-Clause
// Shapes of pulses against closed forms.
#include "RangeUnits.h"
#include "ReceivedPulse.h"
#include "Sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

using namespace avianlidar;

namespace
{
double below(double z)
{
  return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

Sensor shaped(PulseShape shape, double width, double response = 0.0)
{
  Sensor sensor;
  sensor.pulseShape = shape;
  sensor.pulseWidth = width;
  sensor.responseTime = response;
  return sensor;
}

TEST(ReceivedPulse, GaussianIsAnErrorFunction)
{
  for (const auto& [width, response] : { std::pair(5e-9, 0.0), std::pair(3e-9, 4e-9) })
  {
    const ReceivedPulse pulse(shaped(PulseShape::Gaussian, width, response), 1e-9);
    const double deviation = 1e9 * std::hypot(width, response) / WidthOfGaussian;
    EXPECT_FALSE(pulse.isRectangle());
    for (double place = -12.0; place <= 12.0; place += 0.37)
    {
      EXPECT_NEAR(pulse.shareBefore(place), below(place / deviation), 3e-6) << place; // what is cut
    }
    EXPECT_EQ(pulse.shareOf(0.0), 0.0);
    EXPECT_NEAR(pulse.shareOf(1.0), 1.0, 1e-15);
  }
}

TEST(ReceivedPulse, RectangleBehindAResponse)
{
  const double width = 5.0;
  const double deviation = 2.0 / WidthOfGaussian;
  const ReceivedPulse pulse(shaped(PulseShape::Rectangle, 5e-9, 2e-9), 1e-9);
  for (double place = -6.0; place <= 6.0; place += 0.31)
  {
    double mean = 0.0; // over the places of the pulse's parts
    constexpr int parts = 2000;
    for (int k = 0; k < parts; ++k)
    {
      mean += below((place - width * ((k + 0.5) / parts - 0.5)) / deviation) / parts;
    }
    EXPECT_NEAR(pulse.shareBefore(place), mean, 3e-6) << place;
  }
  EXPECT_TRUE(ReceivedPulse(shaped(PulseShape::Rectangle, 5e-9), 1e-9).isRectangle());
}

TEST(ReceivedPulse, SamplesAreStraightLinesAboutTheirMean)
{
  Sensor sensor = shaped(PulseShape::Samples, 0.0);
  sensor.pulseSamples = { 7e-9, 0.0, 10e-9, 4.0, 11e-9,
    0.0 }; // a triangle: mean (7 + 10 + 11)/3 ns
  ASSERT_EQ(checkPulseSamples(sensor), "");
  const ReceivedPulse pulse(sensor, 1e-9);
  const double mean = 28.0 / 3.0;
  EXPECT_NEAR(pulse.before(), mean - 7.0, 1e-12);
  EXPECT_NEAR(pulse.after(), 11.0 - mean, 1e-12);
  for (double t = 7.0; t <= 11.0; t += 0.21)
  {
    const double share =
      t < 10.0 ? (t - 7.0) * (t - 7.0) / 12.0 : 1.0 - (11.0 - t) * (11.0 - t) / 4.0;
    EXPECT_NEAR(pulse.shareBefore(t - mean), share, 1e-6) << t;
  }
  // A response keeps the mean, and adds its variance.
  sensor.responseTime = 3e-9;
  const ReceivedPulse smooth(sensor, 1e-9);
  double first = 0.0;
  double second = 0.0;
  for (double t = -smooth.before(); t < smooth.after(); t += 0.01)
  {
    const double share = smooth.shareBefore(t + 0.01) - smooth.shareBefore(t);
    first += share * (t + 0.005);
    second += share * (t + 0.005) * (t + 0.005);
  }
  const double own = (49.0 + 100.0 + 121.0 - 70.0 - 77.0 - 110.0) / 18.0;
  const double added = 9.0 / (WidthOfGaussian * WidthOfGaussian);
  EXPECT_NEAR(first, 0.0, 1e-4);
  EXPECT_NEAR(second, own + added, 1e-3 * (own + added));
}

TEST(ReceivedPulse, UnitsGetAllOfTheEnergy)
{
  for (const PulseShape shape : { PulseShape::Rectangle, PulseShape::Gaussian })
  {
    for (const double response : { 0.0, 1.3e-9 })
    {
      RangeUnitAccumulator units(shaped(shape, 4e-9, response), 3.0);
      const double lengths[] = { 100.0, 100.4, 231.7 };
      for (const double length : lengths)
      {
        units.add({ length, 0.5 * length });
      }
      units.accumulate();
      const double sum = std::accumulate(units.units().begin(), units.units().end(), 0.0,
        [](double all, const RangeUnit& unit) { return all + unit.energy; });
      EXPECT_NEAR(sum, 0.5 * (100.0 + 100.4 + 231.7), 1e-12 * sum);
    }
  }
}
}
