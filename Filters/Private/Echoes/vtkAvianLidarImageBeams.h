// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarImageBeams.h
 * @brief Reads the beams of a range image and the grid that the beams form. Not installed.
 */
#ifndef vtkAvianLidarImageBeams_h
#define vtkAvianLidarImageBeams_h

#include "vtkAvianLidarScanShape.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <unordered_map>

class vtkPolyData;

namespace vtkAvianLidarImageBeams
{
/// The beams of an image.
struct Beams
{
  avianlidar::ScanGrid Grid; ///< columns and rows of the image, and the cell of each beam
  std::unordered_map<vtkIdType, vtkIdType> IndexOfId;
};

/// Read beams. The grid is the grid of the whole scan if all beams belong to that scan or if there
/// are no beams. Otherwise the beams form their own grid. Throws std::runtime_error.
Beams Read(vtkPolyData* input, const vtkAvianLidarScanShape::WholeScan& whole);

/// The beams in the order of their ids, if they have ids.
vtkSmartPointer<vtkPolyData> InOrder(vtkPolyData* input);
}

#endif
