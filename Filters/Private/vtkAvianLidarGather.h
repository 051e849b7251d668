// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarGather.h
 * @brief Points of all ranks on each of them. Not installed.
 */
#ifndef vtkAvianLidarGather_h
#define vtkAvianLidarGather_h

#include "vtkSmartPointer.h"

class vtkAvianLidarRanks;
class vtkPointSet;
class vtkPolyData;

namespace vtkAvianLidarGather
{
/// The points of all ranks with the point arrays that all have, one rank's after the other's; alone
/// one's own. All ranks must call it. Throws on all if they are more than 2 GiB together.
vtkSmartPointer<vtkPolyData> Points(const vtkAvianLidarRanks& ranks, vtkPointSet* mine);

/// The coordinates alone of the points of all ranks.
vtkSmartPointer<vtkPolyData> Coordinates(const vtkAvianLidarRanks& ranks, vtkPointSet* mine);
}

#endif
