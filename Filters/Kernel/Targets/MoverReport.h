// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MoverReport.h
 * @brief What the beams of a scan receive of each mover, and where it is then.
 *
 * Source: none.
 * Valid: movers and beams of one scan; the same for any number of threads.
 * Test: TestMovedBeams.cxx.
 */
#ifndef avianlidar_MoverReport_h
#define avianlidar_MoverReport_h

#include "Mover.h"
#include "ScanBeams.h"
#include "ScanSetup.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace avianlidar
{
/// What the beams of a scan receive of one mover.
struct MoverReport
{
  bool present = false; ///< at the time of `pose`; nothing else is known without
  Pose pose;            ///< when the beam is fired that receives most of it, else in the middle
  /// When the first and the last beam are fired that hold its origin or receive something of it;
  /// else `pose`. A whole revolution apart where it crosses from the last column to the first.
  Pose first, last;
  std::size_t beam = 0;       ///< that beam, if any may touch it
  Vec3 origin{ 0.0 };         ///< where it starts, m
  double range = 0.0;         ///< m
  double effectiveArea = 0.0; ///< m^2, see Silhouette.h; NaN from inside it
  bool touched = false;       ///< some beam may touch it
  std::uint32_t beams = 0;    ///< whose cones hold its origin
  double energy = 0.0;        ///< J, largest of MoverSight::energy
  double probability = 0.0;   ///< that any beam perceives it
};

/// Reports in the order of the movers. Their effective areas take most of the time. Throws
/// WorkStopped. @param sights of a scan of these beams @param threads > 0, or 0 for loopThreads(0)
/// @param wanted called now and then, on the calling thread; if it returns false, the work stops
std::vector<MoverReport> reportMovers(const ScanSetup& setup, const ScanBeams& beams,
  const std::vector<MoverSight>& sights, int threads, const std::function<bool()>& wanted = {});
}

#endif
