// SPDX-License-Identifier: BSD-3-Clause
/**
 * @file vtkAvianLidarCells.h
 * @brief Makes cells, and checks cells of inputs: filters rely on valid point ids, but cells of
 * files and scripts may have any ids. Not installed.
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

/// Cells of `corners` points each. The points are 0, 1, 2 and so on.
template <class Ids = vtkTypeInt64Array>
vtkSmartPointer<vtkCellArray> vtkAvianLidarMakeCells(vtkIdType cells, vtkIdType corners)
{
  vtkNew<Ids> offsets;
  vtkAvianLidarArrays::SetTuples(offsets.Get(), cells + 1);
  vtkNew<Ids> points;
  vtkAvianLidarArrays::SetTuples(points.Get(), cells * corners);
  for (vtkIdType cell = 0; cell <= cells; ++cell)
  {
    offsets->SetValue(cell, static_cast<typename Ids::ValueType>(cell * corners));
  }
  std::iota(points->GetPointer(0), points->GetPointer(cells * corners), 0);
  auto array = vtkSmartPointer<vtkCellArray>::New();
  array->SetData(offsets, points);
  return array;
}

/// Call f(ids, count) with the point ids of all cells, one cell after the other, in 32 or 64 bits.
/// An iterator would take more time than the work on the cells of a small block.
template <class F>
auto vtkAvianLidarPointIds(vtkCellArray* cells, F&& f)
{
  const vtkIdType count = cells->GetNumberOfConnectivityIds();
  return cells->IsStorage64Bit() ? f(cells->GetConnectivityArray64()->GetPointer(0), count)
                                 : f(cells->GetConnectivityArray32()->GetPointer(0), count);
}

/// Cells of triangles with three point ids each. Ids that fit into 32 bits are stored in 32 bits,
/// which takes half the memory. @param cellOf function from the number of a triangle to the number
/// of its cell
template <class Triangles, class F>
vtkSmartPointer<vtkCellArray> vtkAvianLidarMakeTriangles(const Triangles& triangles, F cellOf)
{
  constexpr std::size_t most = VTK_TYPE_INT32_MAX;
  const bool fits = triangles.size() <= most / 3 &&
    std::all_of(triangles.begin(), triangles.end(),
      [](const auto& triangle) {
        return static_cast<std::size_t>(*std::max_element(triangle.begin(), triangle.end())) <=
          most;
      });
  const auto count = static_cast<vtkIdType>(triangles.size());
  auto cells =
    fits ? vtkAvianLidarMakeCells<vtkTypeInt32Array>(count, 3) : vtkAvianLidarMakeCells<>(count, 3);
  vtkAvianLidarPointIds(cells,
    [&](auto* ids, vtkIdType)
    {
      for (std::size_t i = 0; i < triangles.size(); ++i)
      {
        std::copy(triangles[i].begin(), triangles[i].end(), ids + 3 * cellOf(i));
      }
    });
  return cells;
}

/// An error text if the offsets of cells are bad, else an empty string. The time is proportional to
/// the number of cells.
inline std::string vtkAvianLidarOffsetsError(vtkCellArray* cells)
{
  return !cells || cells->GetNumberOfCells() == 0 || cells->IsValid()
    ? ""
    : "the offsets of its cells do not fit their points";
}

/// An error text if cells are bad for `points` points, else an empty string. The time is
/// proportional to the number of point ids in the cells.
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
