// SPDX-License-Identifier: BSD-3-Clause
// Colours of hues, and the hue of an empty range; others are TestHSBColorMap.cxx's.
#include "Hue.h"

#include <gtest/gtest.h>

#include <array>

using namespace avianlidar;

TEST(Hue, EmptyRangeIsRed)
{
  EXPECT_EQ(hueOfEnergy(1.0, 1.0, 1.0), 0.0);
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
