// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hue.h
 * @brief Colour of an echo in the HSB mode: Qlow is blue, Qhigh is red.
 *
 * Source: paper, Sec. 2.5, Eq. 13.
 * Differs: the paper's sentence before Eq. 13 swaps the two ends. The code follows the equation.
 * Valid: all energies. An energy outside the limits has the hue of the nearer limit.
 * Test: TestHSBColorMap.cxx.
 */
#ifndef avianlidar_Hue_h
#define avianlidar_Hue_h

#include <algorithm>
#include <array>
#include <cmath>

namespace avianlidar
{
constexpr double LargestHue = 240.0; // hue of blue, at Qlow, deg

/// Hue, deg, from 240 at the lower limit to 0 at the upper limit (paper, Eq. 13). An energy (J)
/// outside the limits has the hue of the nearer limit. The hue is 0 if the limits are equal, and
/// NaN if the energy is NaN.
inline double hueOfEnergy(double energy, double lower, double upper)
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

/// Red, green and blue, in [0, 1], of a hue (any angle, deg) at saturation and brightness 1.
inline std::array<double, 3> colorOfHue(double hue)
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

#endif
