// SPDX-License-Identifier: BSD-3-Clause
// A scan by rotating prisms.
#ifndef PrismTestPattern_h
#define PrismTestPattern_h

#include "ScanPattern.h"

namespace avianlidar
{
/// The lidar of Brazeal et al. 2021.
inline ScanPattern twoPrisms()
{
  ScanPattern pattern;
  pattern.channels = 1;
  pattern.rotationRate = 10.0;
  pattern.firingInterval = 1e-5;
  pattern.prisms.wedgeAngles = { 18.0, -18.0 };
  pattern.prisms.refractiveIndices = { 1.5095, 1.5095 };
  pattern.prisms.rotationRates = { -4664.0 / 60.0, 7294.0 / 60.0 };
  return pattern;
}
}

#endif
