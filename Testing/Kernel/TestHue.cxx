// SPDX-License-Identifier: BSD-3-Clause
// Hue of an energy (paper, Eq. 13): both ends, the middle, outside, and its colour.
#include "Hue.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace avianlidar;

TEST(Hue, EndsAndMiddle)
{
  EXPECT_EQ(hueOfEnergy(2e-6, 2e-6, 6.25e-5), 240.0);
  EXPECT_EQ(hueOfEnergy(6.25e-5, 2e-6, 6.25e-5), 0.0);
  EXPECT_NEAR(hueOfEnergy(3.225e-5, 2e-6, 6.25e-5), 120.0, 1e-12);
}

TEST(Hue, DiffuseWallAtFiveHundredMetres)
{
  const double energy = 3.6e-4 * 0.146 * std::exp(-0.035);
  EXPECT_NEAR(hueOfEnergy(energy, 2e-6, 6.25e-5), 46.60276094, 1e-8);
}

TEST(Hue, OutsideTheRangeIsTheNearerEnd)
{
  EXPECT_EQ(hueOfEnergy(0.0, 1.0, 2.0), 240.0);
  EXPECT_EQ(hueOfEnergy(9.0, 1.0, 2.0), 0.0);
}

TEST(Hue, EmptyRangeIsRed)
{
  EXPECT_EQ(hueOfEnergy(1.0, 1.0, 1.0), 0.0);
}

TEST(Hue, NotANumberStaysSo)
{
  EXPECT_TRUE(std::isnan(hueOfEnergy(std::nan(""), 1.0, 2.0)));
}

TEST(HueColor, CornersAndEdgesOfTheHexagon)
{
  const struct
  {
    double hue;
    std::array<double, 3> rgb;
  } cases[] = { { 0.0, { 1.0, 0.0, 0.0 } }, { 30.0, { 1.0, 0.5, 0.0 } },
    { 60.0, { 1.0, 1.0, 0.0 } }, { 120.0, { 0.0, 1.0, 0.0 } }, { 180.0, { 0.0, 1.0, 1.0 } },
    { 240.0, { 0.0, 0.0, 1.0 } }, { 300.0, { 1.0, 0.0, 1.0 } }, { 360.0, { 1.0, 0.0, 0.0 } },
    { -120.0, { 0.0, 0.0, 1.0 } } };
  for (const auto& item : cases)
  {
    for (int c = 0; c < 3; ++c)
    {
      EXPECT_NEAR(colorOfHue(item.hue)[c], item.rgb[c], 1e-15) << item.hue << " channel " << c;
    }
  }
}
