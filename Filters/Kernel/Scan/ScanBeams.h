// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBeams.h
 * @brief The beams of a scan, and what is reported of each.
 */
#ifndef avianlidar_ScanBeams_h
#define avianlidar_ScanBeams_h

#include "BeamTracer.h"
#include "BoundingVolume.h"
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
  std::vector<std::uint64_t> ids; ///< unique; key of the beam's random numbers
  std::vector<Vec3> origins;      ///< m, coordinates of at most MaximumCoordinate
  std::vector<Vec3> directions;   ///< finite, not zero; need not be normalised
  std::uint64_t checksum = 0;     ///< checksumOf() them; 0: not known
  std::size_t size() const { return this->ids.size(); }
};

/// Empty if a beam can start there; otherwise what is wrong, and what was expected.
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

/// Likewise for the length (m) of lines that show beams, display_length: more than 0, at most 1e30.
inline std::string checkDisplayLength(double length)
{
  return length > 0.0 && length <= MaximumCoordinate
    ? std::string()
    : valueError("display_length", length, "more than 0 and at most 1e30 m");
}

enum class BeamStatus
{
  Echo = 0,
  NoSurface = 1,
  BelowLimit = 2,
  Saturated = 3,
  OutsideGate = 4 ///< direct echoes that are not dropped, all of them beyond
};

struct BeamReport
{
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< m, of the strongest return; NaN without one
  TraceCounters counters;          ///< of all tracing that the beam's geometry has cost
  std::uint64_t raysTracedNow = 0; ///< in this run: 0 when everything was known
  std::uint32_t skipped = 0;       ///< what was left out: SkippedPart (ScanSetup.h), but for noise
  /// J, sum of the bounds of what was left out, as far as it is not known to lead nowhere. Of a
  /// beam that was left out as a whole the most that it can bring back: less than Qlow.
  double lost = 0.0;
  /// Small objects beyond the MaximumTargets largest (SmallTargets.h), if the beam meets anything.
  std::uint32_t targetsLeftOut = 0;
};
}

#endif
