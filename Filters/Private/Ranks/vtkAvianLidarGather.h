// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGather.h
 * @brief Gathers the points of all ranks on each rank. Not installed.
 */
#ifndef vtkAvianLidarGather_h
#define vtkAvianLidarGather_h

#include "vtkAvianLidarRanks.h"

#include "vtkSmartPointer.h"

class vtkPointSet;
class vtkPolyData;

namespace vtkAvianLidarGather
{
/// The points of all ranks, rank by rank, with the point arrays that all ranks have; `mine` itself
/// for one process. All ranks must call this function. Throws on all ranks if the points together
/// take 2 GiB or more.
vtkSmartPointer<vtkPolyData> Points(const vtkAvianLidarRanks& ranks, vtkPolyData* mine);

/// Only the coordinates of the points of all ranks; `mine` itself for one process.
vtkSmartPointer<vtkPointSet> Coordinates(const vtkAvianLidarRanks& ranks, vtkPointSet* mine);
}

#endif
