// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MoverReport.h
 * @brief What the beams of a scan receive of each mover, and where the mover is at that time.
 *
 * Source: none.
 * Valid: movers and beams of one scan; the same result for any number of threads.
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
  bool present = false; ///< true if it exists at the time of `pose`; the rest is valid only then
  Pose pose; ///< when the beam that receives most of it fires, or mid-scan if none touches it
  /// Poses when the first and the last beam fire that contain its origin or receive energy of it,
  /// otherwise `pose`. They are a revolution apart if it crosses from the last column to the first.
  Pose first, last;
  std::size_t beam = 0;       ///< beam that receives most of it, 0 if none may touch it
  Vec3 origin{ 0.0 };         ///< origin of this beam, m
  double range = 0.0;         ///< from this origin to `pose`, m
  double effectiveArea = 0.0; ///< m^2, see Silhouette.h; NaN from inside its bounding sphere
  bool touched = false;       ///< true if a beam may touch it
  std::uint32_t beams = 0;    ///< beams that contain its origin
  double energy = 0.0;        ///< largest of MoverSight::energy, J
  double probability = 0.0;   ///< probability that any beam perceives it
};

/// One report for each mover. Effective areas take most of the time. Throws WorkStopped.
/// @param sights of a scan of these beams @param threads > 0, or 0 for loopThreads(0)
/// @param wanted called now and then, on the calling thread; the work stops if it returns false
std::vector<MoverReport> reportMovers(const ScanSetup& setup, const ScanBeams& beams,
  const std::vector<MoverSight>& sights, int threads, const std::function<bool()>& wanted = {});
}

#endif
