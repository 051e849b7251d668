// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanArrays.h
 * @brief Makes vtkPolyData of the beams of a scan. Not installed.
 */
#ifndef vtkAvianLidarScanArrays_h
#define vtkAvianLidarScanArrays_h

#include "PointingErrors.h"
#include "ScanClock.h"

class vtkPolyData;

namespace vtkAvianLidarScanArrays
{
/// Give `output` one vertex per beam of the part, at `position` plus the origin of the beam, with
/// the point arrays of vtkAvianLidarBeamSource. Throws if the memory, which is estimated first,
/// does not suffice. @param position position of the sensor, m
void FillBeams(const avianlidar::ScanPattern& pattern, const avianlidar::PointingErrors& errors,
  const avianlidar::ScanPart& part, int revolution, const double position[3], vtkPolyData* output);

/// Give `output` one line of `length`, m, per beam, with `beam_id`, `laser_id` and `timestamp`.
void FillRays(vtkPolyData* beams, double length, vtkPolyData* output);
}

#endif
