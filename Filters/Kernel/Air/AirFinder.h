// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file AirFinder.h
 * @brief Finds the air along a beam: the volumes that the beam meets, and the columns that it
 * needs.
 *
 * Source: none.
 * Valid: see BeamAir.h.
 * Test: TestBeamAir.cxx.
 */
#ifndef avianlidar_AirFinder_h
#define avianlidar_AirFinder_h

#include "BeamAir.h"

#include <vector>

namespace avianlidar
{
/// Each thread needs its own object. The ScanAir must outlive the object.
class AirFinder
{
public:
  explicit AirFinder(const ScanAir& scan)
    : Scan(scan)
  {
  }

  /// The air along a beam. @param seconds time at which the pulse is sent, s
  BeamAir along(const BeamFrame& frame, double seconds);

  /// The air along a beam that has one direction. @param direction unit vector @param seconds time
  /// at which the pulse is sent, s
  BeamAir alongRay(const Vec3& origin, const Vec3& direction, double seconds);

private:
  void divide(const BeamFrame& frame, BeamAir& air);
  bool rimAgrees(const BeamAir& air) const;
  static void mergeRows(const BeamFrame& frame, const Vec3& up, std::vector<AirColumn>& columns);
  void findParts(const BeamFrame& frame, BeamAir& air);
  void findParts(AirColumn& column, const Vec3& origin, const Vec3& direction, BeamAir& air);
  void findAlone(BeamAir& air) const;

  const ScanAir& Scan;
  MediumCrosser Crosser;
  std::vector<MediumCrossing> Found;
};
}

#endif
