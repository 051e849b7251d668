// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarImageBeams.h
 * @brief The beams of a range image and the grid that they form. Not installed.
 */
#ifndef vtkAvianLidarImageBeams_h
#define vtkAvianLidarImageBeams_h

#include "vtkAvianLidarScanShape.h"

#include "vtkSmartPointer.h"
#include "vtkType.h"

#include <string>
#include <unordered_map>

class vtkPolyData;

namespace vtkAvianLidarImageBeams
{
/// The beams as an image wants them. `Problem` is set when the input was bad.
struct Beams
{
  avianlidar::ScanGrid Grid; ///< columns and rows of the image, and the cell of each beam
  std::unordered_map<vtkIdType, vtkIdType> IndexOfId;
  std::string Problem;
};

/// Read beams. Their grid is that of the whole scan if all of them (or none: there are no beams)
/// are beams of it, else their own.
Beams Read(vtkPolyData* input, const vtkAvianLidarScanShape::WholeScan& whole);

/// The same beams in the order of their ids, if they have ids.
vtkSmartPointer<vtkPolyData> InOrder(vtkPolyData* input);
}

#endif
