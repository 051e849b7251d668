// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file ScanBeams.h
 * @brief The beams of a scan, checks of their positions, and the report on each beam.
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

enum class BeamStatus
{
  Echo = 0,
  NoSurface = 1,
  BelowLimit = 2,
  Saturated = 3,
  OutsideGate = 4 ///< surfaces are met, all of them outside the range gate
};

/// Method that gives the direct echo of a beam.
enum class DirectEcho : std::uint8_t
{
  Unknown = 0,  ///< the beam has not been traced yet
  Nothing = 1,  ///< no surface enters the beam within the range gate
  Polygons = 2, ///< integral over the polygons that the beam sees
  Cells = 3,    ///< sum over the strips of the beam's cells
  Rays = 4      ///< sum over the beam's N rays
};

struct BeamReport
{
  DirectEcho direct = DirectEcho::Unknown;
  bool isCrowded = false; ///< true if more triangles enter the beam than lists hold
  BeamStatus status = BeamStatus::NoSurface;
  double range = 0.0;              ///< range of the strongest return, m; NaN without a return
  TraceCounters counters;          ///< cost of tracing the beam in this run and in earlier runs
  std::uint64_t raysTracedNow = 0; ///< number of rays traced in this run; 0 if all parts were kept
  std::uint32_t skipped = 0;       ///< bits of SkippedPart, except noise
  /// Bound of the energy that was left out, J. Paths without energy do not count. For a beam left
  /// out as a whole, the value is a bound, below Qlow, of the energy of the strongest range unit.
  double lost = 0.0;
};

/// Light, without noise, that one beam receives from one mover on paths with one reflection.
struct MoverSight
{
  std::uint32_t mover;
  std::size_t beam;
  double energy;      ///< energy of the strongest range unit, J
  double probability; ///< probability that a range unit with only this light is perceived
  double offAxis;     ///< angle from the beam's axis to the mover's position, rad
  bool held;          ///< whether the mover's position lies in the beam
};
}

#endif
