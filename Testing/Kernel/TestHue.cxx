// SPDX-License-Identifier: BSD-3-Clause
// Hue of an energy (paper, Eq. 13): both ends, the middle, and outside.
#include "Hue.h"

#include <gtest/gtest.h>

using avianlidar::hueOfEnergy;

TEST(Hue, EndsAndMiddle)
{
  EXPECT_DOUBLE_EQ(hueOfEnergy(1e-9, 1e-9, 3e-9), 240.0);
  EXPECT_DOUBLE_EQ(hueOfEnergy(3e-9, 1e-9, 3e-9), 0.0);
  EXPECT_NEAR(hueOfEnergy(2e-9, 1e-9, 3e-9), 120.0, 1e-12);
}

TEST(Hue, OutsideTheRangeIsTheNearerEnd)
{
  EXPECT_DOUBLE_EQ(hueOfEnergy(0.0, 1.0, 2.0), 240.0);
  EXPECT_DOUBLE_EQ(hueOfEnergy(9.0, 1.0, 2.0), 0.0);
}

TEST(Hue, EmptyRangeIsRed)
{
  EXPECT_DOUBLE_EQ(hueOfEnergy(1.0, 1.0, 1.0), 0.0);
}
