// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hue.h
 * @brief Colour of an echo in the HSB mode (paper, Sec. 2.5, Eq. 13): Qlow is blue, Qhigh is red.
 */
#ifndef avianlidar_Hue_h
#define avianlidar_Hue_h

#include <array>

namespace avianlidar
{
constexpr double LargestHue = 240.0; // deg, blue, at Qlow

/// Hue in degrees, 240 at the lower limit to 0 at the upper one (paper, Eq. 13; the sentence before
/// it swaps the ends). Energies (J) outside the limits take the nearer end; lower == upper: 0. NaN
/// stays NaN.
double hueOfEnergy(double energy, double lower, double upper);

/// Red, green, blue in [0, 1] of a hue (degrees, any) at saturation and brightness 1.
std::array<double, 3> colorOfHue(double hue);
}

#endif
