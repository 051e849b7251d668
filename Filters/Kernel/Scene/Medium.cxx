// SPDX-License-Identifier: BSD-3-Clause
#include "Medium.h"

#include "ValueError.h"
#include "Vector.h"

#include <cmath>

namespace avianlidar
{
Medium rainOf(double rate, double backscatterRatio, double perVolume, double fall)
{
  const double lambda = fall * std::pow(rate, -0.21);                  // 1/mm
  const double squares = perVolume * 2.0 / (lambda * lambda * lambda); // mm^2/m^3, sum of D^2
  return { 2.0 * 0.25 * Pi * squares * 1e-6, backscatterRatio, perVolume / lambda };
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
  if (!(medium.drops >= 0.0 && medium.drops <= 1e12))
  {
    return valueError("drops", medium.drops, "0 to 1e12 1/m3");
  }
  if (!(medium.renewed >= 0.0 && medium.renewed <= 1.0))
  {
    return valueError("renewed", medium.renewed, "0 to 1");
  }
  return {};
}
}
