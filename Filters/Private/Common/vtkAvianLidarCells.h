// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCells.h
 * @brief Makes cells, and checks those of others: filters take it for granted that the points of
 * cells are there, files and scripts may say anything. Not installed.
 */
#ifndef vtkAvianLidarCells_h
#define vtkAvianLidarCells_h

#include "vtkAvianLidarArrays.h"

#include "vtkCellArray.h"
#include "vtkNew.h"
#include "vtkTypeInt32Array.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <numeric>
#include <string>

/// Cells of as many points each; their points are 0, 1, 2 and so on.
inline vtkSmartPointer<vtkCellArray> vtkAvianLidarMakeCells(vtkIdType cells, vtkIdType corners)
{
  vtkNew<vtkTypeInt64Array> offsets;
  vtkAvianLidarArrays::SetTuples(offsets.Get(), cells + 1);
  for (vtkIdType cell = 0; cell <= cells; ++cell)
  {
    offsets->SetValue(cell, cell * corners);
  }
  vtkNew<vtkTypeInt64Array> points;
  vtkAvianLidarArrays::SetTuples(points.Get(), cells * corners);
  std::iota(points->GetPointer(0), points->GetPointer(cells * corners), 0);
  auto array = vtkSmartPointer<vtkCellArray>::New();
  array->SetData(offsets, points);
  return array;
}

/// Triangles from three point ids each.
template <class Triangles>
vtkSmartPointer<vtkCellArray> vtkAvianLidarMakeTriangles(const Triangles& triangles)
{
  auto cells = vtkAvianLidarMakeCells(static_cast<vtkIdType>(triangles.size()), 3);
  auto* ids = cells->GetConnectivityArray64()->GetPointer(0);
  for (const auto& triangle : triangles)
  {
    ids = std::copy(triangle.begin(), triangle.end(), ids);
  }
  return cells;
}

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
inline std::string vtkAvianLidarCellsError(vtkCellArray* cells, vtkIdType points)
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
