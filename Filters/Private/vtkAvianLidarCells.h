// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCells.h
 * @brief Are the points of cells there? Filters take it for granted, files and scripts may say
 * anything. Not installed.
 */
#ifndef vtkAvianLidarCells_h
#define vtkAvianLidarCells_h

#include "vtkCellArray.h"
#include "vtkDataArray.h"

#include <string>

/// What is wrong with the places where cells begin; empty if nothing is. O(cells).
inline std::string vtkAvianLidarOffsetsError(vtkCellArray* cells)
{
  return !cells || cells->GetNumberOfCells() == 0 || cells->IsValid()
    ? ""
    : "the offsets of its cells do not fit their points";
}

/// What is wrong with cells over so many points; empty if nothing is. O(points of cells).
inline std::string vtkAvianLidarCellsComplaint(vtkCellArray* cells, vtkIdType points)
{
  if (!cells || cells->GetNumberOfCells() == 0)
  {
    return {};
  }
  const std::string wrong = vtkAvianLidarOffsetsError(cells);
  if (!wrong.empty())
  {
    return wrong;
  }
  double range[2] = { 0.0, -1.0 };
  if (cells->GetNumberOfConnectivityIds() > 0)
  {
    cells->GetConnectivityArray()->GetRange(range, 0);
  }
  if (range[0] >= 0.0 && range[1] < static_cast<double>(points))
  {
    return {};
  }
  return "a cell has a point id outside 0 to " + std::to_string(points - 1);
}

#endif
