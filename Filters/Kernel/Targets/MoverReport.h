// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file MoverReport.h
 * @brief Light that the beams of a scan receive from each mover, and the mover's pose at the time
 * of this light.
 *
 * Source: none.
 * Valid: movers and beams of one scan. The result does not depend on the number of threads.
 * Test: TestMovedBeams.cxx.
 */
#ifndef avianlidar_MoverReport_h
#define avianlidar_MoverReport_h

#include "BeamReport.h"
#include "Mover.h"
#include "ScanBeams.h"
#include "ScanSetup.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace avianlidar
{
/// Light that the beams of a scan receive from one mover.
struct MoverReport
{
  /// True if the mover exists at the time of `pose`. If `present` is false, all other members are
  /// invalid.
  bool present = false;
  Pose pose; ///< pose at the time of `beam`; if `touched` is false, in the middle of the scan
  /// Poses at the times of the first and the last beam that contains the mover's origin or receives
  /// energy from the mover; `pose` if there is no such beam. The two poses are a revolution apart
  /// if the mover crosses from the last column to the first column.
  Pose first, last;
  std::size_t beam = 0; ///< beam with most of the mover's light, 0 if no beam may touch the mover
  Vec3 origin{ 0.0 };   ///< origin of `beam`, m
  double range = 0.0;   ///< range from `origin` to `pose`, m
  double effectiveArea = 0.0; ///< effective area, m^2; NaN if the mover's sphere holds `origin`
  bool touched = false;       ///< true if a beam may touch the mover
  std::uint32_t beams = 0;    ///< number of beams that contain the mover's origin
  double energy = 0.0;        ///< largest of MoverLight::energy, J
  double probability = 0.0;   ///< probability that any beam perceives the mover
};

/// One report for each mover. Effective areas take most of the time. Throws WorkStopped if `wanted`
/// returns false.
/// @param sights sights of a scan of these beams @param threads number of threads, > 0; 0:
/// loopThreads(0)
/// @param wanted function called repeatedly on the calling thread; may be empty
std::vector<MoverReport> reportMovers(const ScanSetup& setup, const ScanBeams& beams,
  const std::vector<MoverLight>& sights, int threads, const std::function<bool()>& wanted = {});
}

#endif
