// SPDX-License-Identifier: BSD-3-Clause
// Attenuation in air (paper, Eq. 9) and the haze formula.
#include "Propagation.h"

#include <gtest/gtest.h>

#include <limits>

using namespace avianlidar;

TEST(Propagation, WallAtFiveHundredMetres)
{
  EXPECT_NEAR(transmission(3.5e-5, 1000.0), 0.9656054163, 1e-10);
}

TEST(Propagation, LegsMultiply)
{
  EXPECT_NEAR(
    transmission(8.8e-5, 120.0) * transmission(8.8e-5, 340.0), transmission(8.8e-5, 460.0), 1e-15);
}

TEST(Propagation, EndsOfTheRange)
{
  EXPECT_EQ(transmission(0.0, 1e9), 1.0);
  EXPECT_EQ(transmission(0.0, std::numeric_limits<double>::infinity()), 1.0);
  EXPECT_EQ(transmission(1.0, 0.0), 1.0);
  EXPECT_EQ(transmission(1.0, 1e9), 0.0);
}

TEST(Propagation, HazeAtTheWavelengthOfThePaper)
{
  EXPECT_NEAR(hazeAttenuation(23e3, 905e-9), 0.08902241127e-3, 1e-14);
}

TEST(Propagation, HazeExponentsMeetAtTheirLimits)
{
  // Continuous at 6, 1 and 0.5 km; at 50 km Kim's exponent jumps from 1.3 to 1.6.
  for (const double visibility : { 6e3, 1e3, 0.5e3 })
  {
    const double below = hazeAttenuation(visibility * (1.0 - 1e-12), 905e-9);
    const double above = hazeAttenuation(visibility * (1.0 + 1e-12), 905e-9);
    EXPECT_NEAR(below / above, 1.0, 1e-10) << visibility;
  }
  EXPECT_NEAR(hazeAttenuation(60e3, 1100e-9), 3.912 / 60e3 * std::pow(2.0, -1.6), 1e-16);
  EXPECT_NEAR(hazeAttenuation(200.0, 1550e-9), 3.912 / 200.0, 1e-16);
}

TEST(Propagation, HazeOfNonsenseIsNotANumber)
{
  EXPECT_TRUE(std::isnan(hazeAttenuation(0.0, 905e-9)));
  EXPECT_TRUE(std::isnan(hazeAttenuation(23e3, -1.0)));
  EXPECT_TRUE(std::isnan(hazeAttenuation(std::nan(""), 905e-9)));
}
