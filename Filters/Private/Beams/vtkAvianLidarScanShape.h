// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanShape.h
 * @brief Passes columns and channels of a whole scan through the pipeline, before any execution.
 * Not installed.
 *
 * The beam source publishes its pattern under a key. Filters downstream pass the pattern on. So the
 * size of a range image is known before any execution, and is the same for all steps of a
 * revolution.
 */
#ifndef vtkAvianLidarScanShape_h
#define vtkAvianLidarScanShape_h

#include "ScanGrid.h"
#include "ScanPattern.h"

#include <vector>

class vtkInformation;

namespace vtkAvianLidarScanShape
{
/// Publish the pattern, in RequestInformation of the sensor, unless the pattern is bad or its beams
/// do not form a grid (tables of beams, prisms).
void Publish(const avianlidar::ScanPattern& pattern, vtkInformation* output);

/// Remove the pattern from an output, in RequestInformation, if the input has no pattern.
void Follow(vtkInformation* input, vtkInformation* output);

/// Angles of all beams of the sensor, by beam_id, deg.
struct WholeScan
{
  avianlidar::ScanGrid Grid; ///< empty if the pipeline has no pattern
  std::vector<double> Azimuths;
  std::vector<double> Elevations;
};

/// The scan of the published pattern. Throws avianlidar::MemoryError for more beams than fit into
/// memory.
/// @param beams information of an input
WholeScan Read(vtkInformation* beams);
}

#endif
