// SPDX-License-Identifier: BSD-3-Clause
#include "Medium.h"

#include "ValueError.h"
#include "Vector.h"

#include <cmath>

namespace avianlidar
{
Medium rainOf(double rate, double backscatterRatio)
{
  const double perVolume = 8000.0;                               // N0, 1/(m^3 mm)
  const double fall = 4.1 * std::pow(rate, -0.21);               // Lambda, 1/mm
  const double squares = perVolume * 2.0 / (fall * fall * fall); // mm^2/m^3, sum of D^2
  return { 2.0 * 0.25 * Pi * squares * 1e-6, backscatterRatio, perVolume / fall };
}

std::string checkMedium(const Medium& medium)
{
  if (!(medium.extinction >= 0.0 && medium.extinction <= 1e30))
  {
    return valueError("extinction", medium.extinction, "0 to 1e30 1/m");
  }
  if (!(medium.backscatterRatio >= 1e-3 && medium.backscatterRatio <= 1e9))
  {
    return valueError("backscatter_ratio", medium.backscatterRatio, "1e-3 to 1e9 sr");
  }
  return {};
}
}
