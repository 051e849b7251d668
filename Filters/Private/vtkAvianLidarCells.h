// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCells.h
 * @brief Are the points of cells there? Filters take it for granted, files and scripts may say
 * anything. Not installed.
 */
#ifndef vtkAvianLidarCells_h
#define vtkAvianLidarCells_h

#include "vtkCellArray.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <string>

/// f(ids, their number): the points of all cells, one cell after the other, whatever integers hold
/// them. Without an iterator, which costs a small block more than its cells.
template <class F>
auto vtkAvianLidarPointIds(vtkCellArray* cells, F&& f)
{
  const vtkIdType count = cells->GetNumberOfConnectivityIds();
  return cells->IsStorage64Bit() ? f(cells->GetConnectivityArray64()->GetPointer(0), count)
                                 : f(cells->GetConnectivityArray32()->GetPointer(0), count);
}

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
  const bool inside = vtkAvianLidarPointIds(cells,
    [points](const auto* ids, vtkIdType count) {
      return std::all_of(ids, ids + count, [points](auto id) { return id >= 0 && id < points; });
    });
  return inside  ? ""
    : points > 0 ? "a cell has a point id outside 0 to " + std::to_string(points - 1)
                 : "its cells have points, and there are none";
}

#endif
