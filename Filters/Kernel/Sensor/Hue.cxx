// SPDX-License-Identifier: BSD-3-Clause
#include "Hue.h"

#include <algorithm>
#include <cmath>

namespace avianlidar
{
double hueOfEnergy(double energy, double lower, double upper)
{
  if (std::isnan(energy))
  {
    return energy;
  }
  if (!(upper > lower))
  {
    return 0.0;
  }
  return (upper - std::clamp(energy, lower, upper)) / (upper - lower) * LargestHue;
}

std::array<double, 3> colorOfHue(double hue)
{
  const double turned = std::fmod(hue, 360.0);
  const double sixths = (turned < 0.0 ? turned + 360.0 : turned) / 60.0;
  const auto channel = [sixths](double centre)
  {
    const double off = std::abs(sixths - centre);
    return std::clamp(2.0 - std::min(off, 6.0 - off), 0.0, 1.0);
  };
  return { channel(0.0), channel(2.0), channel(4.0) };
}
}
