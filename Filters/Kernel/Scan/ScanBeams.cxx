// SPDX-License-Identifier: BSD-3-Clause
#include "ScanBeams.h"

#include "BoundingVolume.h"
#include "ValueError.h"

namespace avianlidar
{
std::string checkPosition(const Vec3& position)
{
  for (int axis = 0; axis < 3; ++axis)
  {
    if (!(std::fabs(position[axis]) <= MaximumCoordinate))
    {
      return "position has a coordinate that is not finite or beyond 1e30, expected metres";
    }
  }
  return {};
}

std::string checkDisplayLength(double length)
{
  return length > 0.0 && length <= MaximumCoordinate
    ? std::string()
    : valueError("display_length", length, "more than 0 and at most 1e30 m");
}
}
