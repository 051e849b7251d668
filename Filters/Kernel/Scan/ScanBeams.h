// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBeams.h
 * @brief The beams of a scan, the checks of their positions, and the report on each.
 *
 * Source: none.
 * Valid: coordinates up to 1e30 m.
 * Test: TestScanReport.cxx; checks: Testing/Stability/TestStabilitySweep.cxx,
 * Testing/Cxx/TestBeamSource.cxx.
 */
#ifndef avianlidar_ScanBeams_h
#define avianlidar_ScanBeams_h

#include "AABB.h"
#include "BeamTracer.h"
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
  std::vector<double> times;  ///< s, when each is fired; used, and needed, where something moves
  std::uint64_t checksum = 0; ///< checksumOf(); 0: not computed yet
  std::size_t size() const { return this->ids.size(); }
  double timeOf(std::size_t beam) const { return this->times.empty() ? 0.0 : this->times[beam]; }
};

/// Empty if a beam can start there; otherwise what is wrong and what was expected.
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

/// The same for display_length, m, the length of the lines that show beams: more than 0, at most
/// 1e30.
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
  OutsideGate = 4 ///< direct echoes arrive, all of them outside the gate
};

/// How the direct echo of a beam is found.
enum class DirectEcho : std::uint8_t
{
  Unknown = 0,  ///< it was not traced yet
  Nothing = 1,  ///< no surface enters the beam
  Polygons = 2, ///< integrated over the polygons that it sees
  Cells = 3,    ///< by the strips of its cells
  Rays = 4      ///< by its N rays
};

struct BeamReport
{
  DirectEcho direct = DirectEcho::Unknown;
  bool isCrowded = false; ///< too many triangles enter for lists: the rays of its cells were traced
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< range of the strongest return, m; NaN without one
  TraceCounters counters;          ///< cost of all tracing for what is kept of the beam
  std::uint64_t raysTracedNow = 0; ///< in this run; 0 if everything was kept
  std::uint32_t skipped = 0;       ///< SkippedPart (ScanSetup.h), but for noise
  /// Sum of the bounds of what was left out, J, except paths known to lead nowhere. For a beam left
  /// out as a whole, the most that it can bring back: less than Qlow.
  double lost = 0.0;
};

/// What one beam receives of one mover: direct light without noise, whatever lies behind it.
struct MoverSight
{
  std::uint32_t mover;
  std::size_t beam;
  double energy;      ///< J, of its strongest range unit
  double probability; ///< that a unit is perceived for this light alone
  double offAxis;     ///< rad, from the beam's axis to the mover
  bool held;          ///< its position lies in the beam
};
}

#endif
