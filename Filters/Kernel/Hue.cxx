// SPDX-License-Identifier: BSD-3-Clause
#include "Hue.h"

#include <algorithm>

namespace avianlidar
{
double hueOfEnergy(double energy, double lower, double upper)
{
  if (!(upper > lower))
  {
    return 0.0;
  }
  const double share = (upper - energy) / (upper - lower);
  return 240.0 * std::clamp(share, 0.0, 1.0);
}
}
