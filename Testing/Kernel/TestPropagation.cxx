// SPDX-License-Identifier: BSD-3-Clause
// Attenuation in air (paper, Eq. 9).
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

TEST(Propagation, OfHaze)
{
  EXPECT_NEAR(attenuationOfVisibility(23e3, 905e-9), 8.9e-5, 0.02e-5);
  EXPECT_NEAR(attenuationOfVisibility(23e3, 550e-9), 3.912 / 23e3, 1e-12);
  EXPECT_NEAR(attenuationOfVisibility(200.0, 1550e-9), 3.912 / 200.0, 1e-12); // fog: all colours
  double before = 1.0;
  for (double visibility = 100.0; visibility < 1e5; visibility *= 1.01)
  {
    const double now = attenuationOfVisibility(visibility, 1550e-9);
    EXPECT_LT(now, before) << visibility;
    before = now;
  }
}
