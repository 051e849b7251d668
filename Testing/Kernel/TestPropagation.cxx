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
