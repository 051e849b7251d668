// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file Hue.h
 * @brief Energy to hue (paper, Eq. 13).
 */
#ifndef avianlidar_Hue_h
#define avianlidar_Hue_h

namespace avianlidar
{
/**
 * Hue in degrees of an energy within the dynamic range [lower, upper], all three in joules:
 * 240 (blue) at the lower limit, 0 (red) at the upper one, linear in between (paper, Eq. 13; the
 * sentence before it names the two colours the other way round, the equation holds).
 * An energy outside the range gets the hue of the nearer end; an empty range (lower == upper) gives 0.
 */
double hueOfEnergy(double energy, double lower, double upper);
}

#endif
