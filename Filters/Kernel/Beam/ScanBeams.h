// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBeams.h
 * @brief The beams of a scan, and checks of their positions.
 *
 * Source: none.
 * Valid: coordinates up to 1e30 m.
 * Test: TestScanReport.cxx; checks: Testing/Stability/TestStabilitySweep.cxx,
 * Testing/Cxx/TestBeamSource.cxx.
 */
#ifndef avianlidar_ScanBeams_h
#define avianlidar_ScanBeams_h

#include "AABB.h"
#include "ValueError.h"
#include "Vector.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace avianlidar
{
struct ScanBeams
{
  std::vector<std::uint64_t> ids; ///< unique ids, keys of the beams' random numbers
  std::vector<Vec3> origins;      ///< origins, m, coordinates of at most MaximumCoordinate
  std::vector<Vec3> directions;   ///< directions, finite, not zero, of any length
  std::vector<double> times;      ///< firing times, s; may be empty if nothing moves
  std::uint64_t checksum = 0;     ///< result of checksumOf(); 0: not computed yet
  std::size_t size() const { return this->ids.size(); }
  double timeOf(std::size_t beam) const { return this->times.empty() ? 0.0 : this->times[beam]; }
};

/// Check the origin of a beam. @return empty, or a sentence with the error and the expected values
inline std::string checkPosition(const Vec3& position)
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

/// Check display_length, the length of the lines that show beams, m. @return empty, or a sentence
/// with the error and the expected values
inline std::string checkDisplayLength(double length)
{
  return length > 0.0 && length <= MaximumCoordinate
    ? std::string()
    : valueError("display_length", length, "more than 0 and at most 1e30 m");
}
}

#endif
