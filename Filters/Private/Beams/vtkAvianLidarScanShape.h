// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarScanShape.h
 * @brief Columns and channels of a whole scan in the pipeline, before anything executes. Not
 * installed.
 *
 * The beam source publishes its pattern under a key of its own; filters between pass it on. So a
 * range image knows how large it is without any beam, and stays as large while a scan sweeps.
 */
#ifndef vtkAvianLidarScanShape_h
#define vtkAvianLidarScanShape_h

#include "ScanGrid.h"
#include "ScanPattern.h"

#include <vector>

class vtkInformation;

namespace vtkAvianLidarScanShape
{
/// In RequestInformation of the sensor: publish the pattern, unless it is bad,
/// a table of beams or one of prisms, whose beams form no grid.
void Publish(const avianlidar::ScanPattern& pattern, vtkInformation* output);

/// In RequestInformation of a filter: what its input does not know, its output does not either.
void Follow(vtkInformation* input, vtkInformation* output);

/// All beams of the sensor, by beam_id; angles in degrees.
struct WholeScan
{
  avianlidar::ScanGrid Grid; ///< empty where the pipeline does not know the sensor
  std::vector<double> Azimuths;
  std::vector<double> Elevations;
};

/// What the pipeline knows. Throws avianlidar::MemoryError for more beams than there is memory for.
/// @param beams information of an input
WholeScan Read(vtkInformation* beams);
}

#endif
