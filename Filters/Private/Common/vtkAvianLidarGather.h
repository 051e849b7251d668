// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGather.h
 * @brief Points of all ranks on each of them. Not installed.
 */
#ifndef vtkAvianLidarGather_h
#define vtkAvianLidarGather_h

#include "vtkAvianLidarRanks.h"

#include "vtkSmartPointer.h"

class vtkAlgorithm;
class vtkPointSet;
class vtkPolyData;

namespace vtkAvianLidarGather
{
/// The points of all ranks with the point arrays that all have, one rank's after the other's;
/// `mine` itself for one process. All ranks must call it. Throws on all if the points are 2 GiB or
/// more together.
vtkSmartPointer<vtkPolyData> Points(
  const vtkAvianLidarRanks& ranks, vtkAlgorithm* self, vtkPolyData* mine);

/// Only the coordinates of the points of all ranks; `mine` itself for one process.
vtkSmartPointer<vtkPointSet> Coordinates(
  const vtkAvianLidarRanks& ranks, vtkAlgorithm* self, vtkPointSet* mine);
}

#endif
